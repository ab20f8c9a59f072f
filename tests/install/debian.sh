#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# The Debian packages in a clean Debian 12: installs them, runs the cookbook and debian/tests with them, removes them,
# upgrades to them from an older version, and finds no trace of them.
# debian.sh FOLDER_OF_PACKAGES [WORK_FOLDER]
set -euo pipefail
source=$(cd "$(dirname "$0")/../.." && pwd)
packages=$(cd "$1" && pwd)
work=${2:-$(mktemp -d)}
skip() { echo "skipped: $*"; exit 77; }
command -v mmdebstrap >/dev/null || skip "mmdebstrap is not installed (Debian: mmdebstrap)"
[ "$(id -u)" -eq 0 ] || skip "a clean root needs the rights of root"
unshare -m true 2>/dev/null || skip "this system has no mount namespaces"
debs=("$packages"/*.deb)
[ -e "${debs[0]}" ] || { echo "no packages in $packages; expected those of dpkg-buildpackage"; exit 1; }
mkdir -p "$work"
root=$work/root
rm -rf --one-file-system "$root"
trap 'rm -rf --one-file-system "$root"' EXIT
# The next run in this folder begins with the same root.
if [ ! -f "$work/clean.tar" ]; then
    mmdebstrap --quiet --variant=apt bookworm "$work/new.tar" >"$work/log" 2>&1 || { cat "$work/log"; skip "no Debian mirror"; }
    mv "$work/new.tar" "$work/clean.tar"
fi
mkdir "$root"
tar -C "$root" --exclude='./dev/*' -xf "$work/clean.tar"

# What runs in the root sees processes, devices and processors, and stays the only one that does.
inside() {
    # shellcheck disable=SC2016 # the inner shell expands
    unshare -m bash -c 'mount --make-rprivate /; root=$1; shift
        mount -t proc proc "$root/proc"; mount --rbind /dev "$root/dev"; mount --rbind /sys "$root/sys"
        exec chroot "$root" /usr/bin/env -i PATH=/usr/sbin:/usr/bin:/sbin:/bin HOME=/tmp/home LC_ALL=C.UTF-8 TMPDIR=/tmp \
            DEBIAN_FRONTEND=noninteractive PYTHONDONTWRITEBYTECODE=1 "$@"' _ "$root" "$@"
}
failed=0
expect() { # WHAT COMMAND...
    local what=$1 begin=$SECONDS
    shift
    if "$@" >"$work/log" 2>&1; then
        printf 'ok: %s (%d s)\n' "$what" $((SECONDS - begin))
    else
        echo "FAILED: $what" && tail -60 "$work/log" && failed=1
    fi
}
apt() { inside apt-get -q -y --no-install-recommends "$@"; }

cp /etc/resolv.conf "$root/etc/resolv.conf"
mkdir -p "$root/tmp/home" "$root/tmp/packages"
cp "${debs[@]}" "$root/tmp/packages"
# Documents in packages count here: minimal images of Debian leave them out.
rm -f "$root"/etc/dpkg/dpkg.cfg.d/*

# What the packages and their tests need is there first, so that everything else that appears is the packages'.
names=$(for deb in "${debs[@]}"; do dpkg-deb -f "$deb" Package; done)
needed=$(for deb in "${debs[@]}"; do dpkg-deb -f "$deb" Depends | tr ',' '\n'; done |
    sed 's/^ *//; /^$/d' | grep -vwFf <(echo "$names") | sort -u)
tests=$(sed -n 's/^ \([a-z].*\),$/\1/p' "$source"/debian/tests/control | grep -vwFf <(echo "$names") | sort -u)
expect "apt-get update" apt update
# shellcheck disable=SC2086 # one package a word
expect "dependencies" apt satisfy "$(paste -sd, <<<"$needed"$'\n'"$tests")"
[ $failed -eq 0 ] || exit 1

# dpkg's own records, logs and caches change with every package.
files() {
    (cd "$root" && find . -xdev \( -path ./tmp -o -path ./var/lib/dpkg -o -path ./var/lib/apt -o -path ./var/log \
        -o -path ./var/cache -o -path ./proc -o -path ./dev -o -path ./sys \) -prune -o -print | sort)
}
files >"$work/before"
expect "apt install of ${#debs[@]} packages" inside bash -c 'apt-get -q -y install /tmp/packages/*.deb'
expect "dpkg --verify" inside bash -c "dpkg --verify $(paste -sd' ' <<<"$names")"

# Only what the tests read: nothing of a build can help.
mkdir -p "$root/tmp/source"
tar -C "$source" --exclude=__pycache__ -cf - debian tests docs python_check | tar -C "$root/tmp/source" -xf -
for test in "$source"/debian/tests/*; do
    [ -x "$test" ] || continue
    expect "debian/tests/${test##*/}" inside sh -c "cd /tmp/source && debian/tests/${test##*/}"
    [ "${test##*/}" != cookbook ] || sed -n 's/^skipped/  &/p; $s/^/  /p' "$work/log"
done
expect "apt install again" inside bash -c 'apt-get -q -y install --reinstall /tmp/packages/*.deb'
# shellcheck disable=SC2086 # one package a word
expect "apt remove" apt remove $names
# shellcheck disable=SC2086
expect "dpkg --purge" inside dpkg --purge $names
files >"$work/after"
expect "no trace is left" diff "$work/before" "$work/after"

# Repacked with a lower version and a file that is gone in the new one.
version=$(dpkg-deb -f "${debs[0]}" Version)
mkdir -p "$root/tmp/older"
for deb in "${debs[@]}"; do
    name=$(dpkg-deb -f "$deb" Package)
    dpkg-deb --raw-extract "$deb" "$work/older"
    sed -i "s/^Version: .*/&~older/; s/(= $version)/(= $version~older)/g" "$work/older/DEBIAN/control"
    mkdir -p "$work/older/usr/share/tonewright-older"
    touch "$work/older/usr/share/tonewright-older/$name"
    dpkg-deb --root-owner-group -Znone --build "$work/older" "$root/tmp/older/" >/dev/null
    rm -rf "$work/older"
done
versions() { # VERSION: that of each package
    # shellcheck disable=SC2086 # one package a word
    [ "$(inside dpkg-query -W -f='${Version}\n' $names | sort -u)" = "$1" ]
}
expect "apt install of older packages" inside bash -c 'apt-get -q -y install /tmp/older/*.deb'
expect "they are $version~older" versions "$version~older"
expect "upgrade" inside bash -c 'apt-get -q -y install /tmp/packages/*.deb'
expect "they are $version" versions "$version"
expect "the file of the old version is gone" test ! -e "$root/usr/share/tonewright-older"
expect "dpkg --verify after the upgrade" inside bash -c "dpkg --verify $(paste -sd' ' <<<"$names")"
expect "the command after the upgrade" inside tonewright list agx_blender
# shellcheck disable=SC2086
expect "dpkg --purge after the upgrade" inside dpkg --purge $names
files >"$work/after"
expect "no trace is left after the upgrade" diff "$work/before" "$work/after"
exit $failed
