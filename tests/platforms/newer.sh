#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Debian sid in a root of its own: builds everything with its GCC, OpenImageIO and OpenColorIO, runs the unit tests, the
# command, the plugin and the committed config with them, and compiles the core library with its other compilers.
#   newer.sh SOURCE_TREE WORK_FOLDER [TEST...]
# TEST is one of all, g++-13, g++-14, ... clang++-NN; without one, all of them. WORK_FOLDER/root stays for the next run;
# remove it to see what has become of sid.
set -euo pipefail
source=$(realpath "$1") work=$2
shift 2
skip() { echo "skipped: $*"; exit 77; }
command -v mmdebstrap >/dev/null || skip "mmdebstrap is not installed (Debian: mmdebstrap)"
[ "$(id -u)" -eq 0 ] || skip "a clean root needs the rights of root"
unshare -m true 2>/dev/null || skip "this system has no mount namespaces"
mkdir -p "$work"
root=$(realpath "$work")/root

# What runs in the root sees processes, devices and this source, which it cannot write.
inside() {
    # shellcheck disable=SC2016 # the inner shell expands
    unshare -m bash -c 'mount --make-rprivate /; root=$1; mount --bind "$2" "$root/source"; shift 2
        mount -o remount,bind,ro "$root/source"; mount -t proc proc "$root/proc"; mount --rbind /dev "$root/dev"
        exec chroot "$root" /usr/bin/env -i PATH=/usr/sbin:/usr/bin:/sbin:/bin HOME=/tmp LC_ALL=C.UTF-8 TMPDIR=/tmp \
            DEBIAN_FRONTEND=noninteractive PYTHONDONTWRITEBYTECODE=1 "$@"' _ "$root" "$source" "$@"
}
numbered() { inside apt-cache pkgnames "$1-" | grep -E "^${1//+/\\+}-[0-9]+$" | sort -V; }

if [ ! -f "$root/complete-2" ]; then
    rm -rf --one-file-system "$root"
    # A mirror may be a copy of one day: its index is signed, but it is no longer valid.
    mmdebstrap --quiet --variant=apt --aptopt='Acquire::Check-Valid-Until "false"' sid "$work/root.tar" >"$work/log" 2>&1 ||
        { cat "$work/log"; skip "no Debian mirror"; }
    mkdir -p "$root/source"
    tar -C "$root" --exclude='./dev/*' -xf "$work/root.tar"
    rm "$work/root.tar"
    cp /etc/resolv.conf "$root/etc/resolv.conf"
    # shellcheck disable=SC2016 # the inner shell expands
    mapfile -t packages < <(bash -c 'source "$1/run" help >/dev/null; printf "%s\n" "${PACKAGES_DEMO[@]}"' _ "$source")
    inside apt-get -q update >"$work/log" 2>&1 || { cat "$work/log"; skip "no Debian mirror"; }
    mapfile -t compilers < <(numbered g++ | awk -F- '$2 >= 13'; numbered clang | tail -1)
    inside apt-get -q -y --no-install-recommends install "${packages[@]}" "${compilers[@]}" libgtest-dev opencolorio-tools git \
        libheif-plugin-x265 libheif-plugin-libde265 libheif-plugin-aomenc libheif-plugin-dav1d \
        python3-numpy python3-pytest python3-yaml python3-pyopencolorio python3-openimageio >"$work/log" 2>&1 ||
        { tail -60 "$work/log"; exit 1; }
    touch "$root/complete-2"
fi
default=$(readlink "$root/usr/bin/g++")
mapfile -t tests < <(cd "$root/usr/bin" && printf '%s\n' all g++-1[3-9] clang++-[0-9]* | grep -vxF "$default")
[ $# -eq 0 ] || tests=("$@")
inside dpkg-query -W "$default" libopenimageio-dev libopencolorio-dev libfmt-dev libhwy-dev cmake python3

configure() { # NAME OPTIONS...
    inside cmake -S /source -B "/build/$1" -G Ninja -Wno-dev -DCMAKE_BUILD_TYPE=Release -DTONEWRIGHT_WARNINGS_AS_ERRORS=ON \
        -DTONEWRIGHT_BUILD_BENCH=OFF "${@:2}" >"$work/log" || { cat "$work/log"; exit 1; }
}
failed=0
for test in "${tests[@]}"; do
    begin=$SECONDS options=()
    if [ "$test" != all ]; then
        options=(-DCMAKE_CXX_COMPILER="$test" -DTONEWRIGHT_BUILD_TESTS=OFF -DTONEWRIGHT_BUILD_OCIO=OFF
            -DTONEWRIGHT_BUILD_IMAGE=OFF -DTONEWRIGHT_WITH_ICC=OFF)
        # A precompiled header hides an #include that a file lacks; one compiler without says which.
        case $test in clang*) options+=(-DCMAKE_DISABLE_PRECOMPILE_HEADERS=ON) ;; esac
    fi
    configure "$test" "${options[@]}"
    inside cmake --build "/build/$test" -- -k 0 || { failed=1; continue; }
    echo "ok: $test is built ($((SECONDS - begin)) s)"
    [ "$test" = all ] || continue
    # Fits of an earlier run are not tested.
    rm -rf "$root/tmp/.cache"
    # Tests of what depends on the libraries. Each of the scripts finds what it needs here.
    scripts='^cli\.(pictures|python)$|^clients\.(plugin|oiiotool_luts)$|^parity\.(config|profiles|builtins|verify)$'
    inside env TONEWRIGHT_TEST_ALL=0 ctest --test-dir /build/all --output-on-failure -R "^unit|$scripts" |
        tee "$work/log" || failed=1
    ! grep -E '(cli|clients|parity)\..*Skipped' "$work/log" || failed=1
done
exit $failed
