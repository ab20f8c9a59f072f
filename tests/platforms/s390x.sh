#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Cross-compiles the core library for IBM Z, which is big-endian, and compares what it writes in QEMU's user mode with what
# this processor writes: LUTs, shaders, numbers.
#   s390x.sh SOURCE_TREE BUILD_FOLDER core_files
set -euo pipefail
tree=$1 build=$2 native=$3
skip() { echo "skipped: $*"; exit 77; }
for program in s390x-linux-gnu-g++ qemu-s390x-static; do
    command -v $program >/dev/null || skip "$program is not installed (Debian: g++-s390x-linux-gnu qemu-user-static)"
done
command -v apt-get >/dev/null || skip "apt-get is missing; it downloads Debian's libraries for s390x"
here=$(dirname "$0")
# shellcheck source=tests/platforms/sysroot.sh
source "$here/sysroot.sh"
# shellcheck source=tests/platforms/core_files.sh
source "$here/core_files.sh"
make_sysroot s390x "$build/sysroot"
cmake -S "$tree" -B "$build/core" -G Ninja -DCMAKE_BUILD_TYPE=Release \
    -DCMAKE_TOOLCHAIN_FILE="$tree/tests/platforms/s390x.cmake" -DCMAKE_PREFIX_PATH="$(realpath "$build/sysroot")/usr" \
    -DTONEWRIGHT_BUILD_OCIO=OFF -DTONEWRIGHT_BUILD_IMAGE=OFF -DTONEWRIGHT_WITH_ICC=OFF
cmake --build "$build/core" --target core_files
compare_core_files "$native" qemu-s390x-static -L /usr/s390x-linux-gnu \
    -E LD_LIBRARY_PATH="$(realpath "$build/sysroot")/usr/lib/s390x-linux-gnu" "$build/core/bin/core_files"
