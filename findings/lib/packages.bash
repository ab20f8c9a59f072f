#!/bin/bash
# SPDX-License-Identifier: Apache-2.0
# Pinned Debian packages and all that they need, in a folder of their own; nothing is installed. For the other scripts here:
#   source lib/packages.bash FOLDER PACKAGE=VERSION...
# defines run PROGRAM ARGUMENT..., which runs a program of those packages with their own loader and libraries.
findings_packages() {
    local apt=$1/apt root=$1/root deb folder
    mkdir -p "$apt"/{lists/partial,archives/partial,state} "$root"
    : >"$apt/state/status"
    local options=(-o Dir::State="$apt/state" -o Dir::State::status="$apt/state/status" -o Dir::State::lists="$apt/lists"
        -o Dir::Cache="$apt" -o Dir::Cache::archives="$apt/archives" -o APT::Install-Recommends=false -o Debug::NoLocking=true
        -o Acquire::Languages=none -o Acquire::Check-Valid-Until=false -o APT::Sandbox::User=root)
    apt-get "${options[@]}" update -qq 2>/dev/null
    apt-get "${options[@]}" install -y -qq --download-only "${@:2}" >"$apt/log" 2>&1 ||
        { echo "these versions are not in the configured Debian archive:" "${@:2}"; tail -2 "$apt/log"; exit 2; }
    for folder in bin sbin lib lib64; do
        mkdir -p "$root/usr/$folder"
        ln -sfn "usr/$folder" "$root/$folder"
    done
    for deb in "$apt"/archives/*.deb; do
        dpkg-deb --fsys-tarfile "$deb" | tar -x -C "$root" --keep-directory-symlink --exclude='./usr/share/doc' --exclude='./usr/share/man'
    done
}
run() {
    local libraries=$findings_root/usr/lib/x86_64-linux-gnu
    "$findings_root/usr/lib64/ld-linux-x86-64.so.2" --library-path \
        "$libraries:$libraries/blas:$libraries/lapack:$libraries/pulseaudio" "$findings_root/usr/bin/$1" "${@:2}"
}
findings_root=$1/root
findings_packages "$@"
