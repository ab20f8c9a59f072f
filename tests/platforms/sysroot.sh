# SPDX-License-Identifier: Apache-2.0
# shellcheck shell=bash
# For cross-compilers: Debian's libraries of another architecture in a folder. The system gets no second architecture, and no
# package of its own changes.

# make_sysroot ARCHITECTURE FOLDER: exits with 77 where the packages cannot be downloaded
make_sysroot() {
    local architecture=$1 sysroot package apt link
    mkdir -p "$2"/apt/{lists/partial,archives/partial}
    sysroot=$(realpath "$2")
    [ ! -f "$sysroot/complete-3" ] || return 0
    local packages=(libhwy1 libhwy-dev libfmt9 libfmt-dev libexpat1 libexpat1-dev libgtest-dev libtomlplusplus-dev)
    : >"$sysroot/apt/status"
    apt=(apt-get -qq -o APT::Architecture="$architecture" -o APT::Architectures="$architecture" -o APT::Sandbox::User=root
        -o Acquire::Retries=3 -o Acquire::Languages=none -o Dir::State="$sysroot/apt"
        -o Dir::State::status="$sysroot/apt/status" -o Dir::Cache="$sysroot/apt")
    { "${apt[@]}" update && (cd "$sysroot/apt" && "${apt[@]}" download "${packages[@]}"); } ||
        { echo "skipped: apt-get cannot download for $architecture: ${packages[*]}"; exit 77; }
    for package in "$sysroot"/apt/*.deb; do dpkg -x "$package" "$sysroot"; done
    # Some packages have their libraries below /lib, which is /usr/lib, with absolute links to them.
    [ ! -d "$sysroot/lib" ] || cp -a "$sysroot/lib/." "$sysroot/usr/lib/"
    find "$sysroot/usr/lib" -type l -lname '/lib/*' | while read -r link; do
        ln -sf "$(basename "$(readlink "$link")")" "$link"
    done
    touch "$sysroot/complete-3"
}
