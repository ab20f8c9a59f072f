#!/bin/bash
# SPDX-License-Identifier: Apache-2.0
# Pinned Debian packages and all that they need, in a folder of their own; nothing is installed. For the other scripts here:
#   source lib/packages.bash FOLDER PACKAGE=VERSION...
# defines run PROGRAM ARGUMENT..., which runs a program of those packages with their own loader and libraries. Scripts that run
# one after the other share the packages if FINDINGS_CACHE names a folder on the file system of their own ones.
findings_packages() {
    local apt=${FINDINGS_CACHE:-$1}/apt root=$1/root folder name unpacked
    mkdir -p "$apt"/{lists/partial,archives/partial,none/partial,state} "$root"
    : >"$apt/state/status"
    local options=(-o Dir::State="$apt/state" -o Dir::State::status="$apt/state/status" -o Dir::State::lists="$apt/lists"
        -o Dir::Cache="$apt" -o Dir::Cache::archives="$apt/archives" -o APT::Install-Recommends=false -o Debug::NoLocking=true
        -o Acquire::Languages=none -o Acquire::Check-Valid-Until=false -o APT::Sandbox::User=root)
    # Without an archive, the command after it says so.
    [ -e "$apt/updated" ] || { apt-get "${options[@]}" update -qq 2>/dev/null && touch "$apt/updated"; } || true
    # With an empty archive, apt-get lists all files. Those of other scripts may be there.
    apt-get "${options[@]}" -o Dir::Cache::archives="$apt/none" install -y -qq --print-uris "${@:2}" 2>"$apt/log" |
        cut -d' ' -f2 >"$1/files" || true
    if [ ! -s "$1/files" ] || ! (cd "$apt/archives" && xargs ls <"$1/files") >/dev/null 2>&1; then
        apt-get "${options[@]}" install -y -qq --download-only "${@:2}" >"$apt/log" 2>&1 ||
            { echo "these versions are not in the configured Debian archive:" "${@:2}"; tail -2 "$apt/log"; exit 2; }
    fi
    while read -r name; do
        unpacked=$apt/unpacked/$name
        if [ ! -e "$unpacked" ]; then
            rm -rf "$unpacked.part"
            mkdir -p "$unpacked.part/usr/"{bin,sbin,lib,lib64}
            for folder in bin sbin lib lib64; do ln -s "usr/$folder" "$unpacked.part/$folder"; done
            dpkg-deb --fsys-tarfile "$apt/archives/$name" | tar -x -C "$unpacked.part" --keep-directory-symlink \
                --exclude='./usr/share/doc' --exclude='./usr/share/man' --exclude='./usr/share/locale'
            mv "$unpacked.part" "$unpacked"
        fi
        cp -al "$unpacked/usr" "$root/"
        [ ! -e "$unpacked/etc" ] || cp -al "$unpacked/etc" "$root/"
    done <"$1/files"
}
run() {
    local libraries=$findings_root/usr/lib/x86_64-linux-gnu
    "$findings_root/usr/lib64/ld-linux-x86-64.so.2" --library-path \
        "$libraries:$libraries/blas:$libraries/lapack:$libraries/pulseaudio:$findings_root/usr/lib" "$findings_root/usr/bin/$1" "${@:2}"
}
findings_root=$1/root
findings_packages "$@"
