#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Cross-compiles the core library for 64-bit Windows with MinGW-w64 and compares what it writes in Wine with what this
# processor writes: LUTs, shaders, numbers.
#   windows.sh SOURCE_TREE BUILD_FOLDER core_files
set -euo pipefail
tree=$1 native=$3
skip() { echo "skipped: $*"; exit 77; }
# Wine's package has a script of this name, which says that 32-bit programs need another package.
wine=$(command -v /usr/lib/wine/wine64 wine64 | head -1) || true
compiler=x86_64-w64-mingw32-g++-posix
if [ -z "$wine" ] || ! command -v $compiler >/dev/null; then
    skip "no Wine or no $compiler (Debian: wine64 g++-mingw-w64-x86-64-posix)"
fi
command -v apt-get >/dev/null || skip "apt-get is missing; it downloads the sources of Debian's libraries"
# shellcheck source=tests/platforms/core_files.sh
source "$(dirname "$0")/core_files.sh"
mkdir -p "$2"
build=$(realpath "$2")
toolchain=(-G Ninja -DCMAKE_BUILD_TYPE=Release -DCMAKE_INSTALL_PREFIX="$build/prefix"
    -DCMAKE_TOOLCHAIN_FILE="$(realpath "$tree")/tests/platforms/windows.cmake" -DCMAKE_FIND_ROOT_PATH="$build/prefix")

# Debian has neither Highway nor fmt nor expat for Windows: the sources of its packages are compiled.
if [ ! -f "$build/prefix/complete-2" ]; then
    mkdir -p "$build"/apt/{lists/partial,archives/partial} "$build/prefix/include"
    : >"$build/apt/status"
    list=/etc/apt/sources.list.d/debian.sources
    [ -f $list ] || list=/etc/apt/sources.list
    sed 's/^Types:.*/Types: deb-src/; s/^deb /deb-src /' $list >"$build/apt/${list##*/}"
    apt=(apt-get -qq -o APT::Sandbox::User=root -o Acquire::Retries=3 -o Acquire::Languages=none -o Dir::State="$build/apt"
        -o Dir::State::status="$build/apt/status" -o Dir::Cache="$build/apt" -o Dir::Etc::SourceParts=/dev/null
        -o Dir::Etc::SourceList="$build/apt/${list##*/}")
    # Without security updates: the sources of upstream are the same, and mirrors drop the others.
    release=$(. /etc/os-release; echo "${VERSION_CODENAME:-sid}")
    { "${apt[@]}" update && (cd "$build/apt" && "${apt[@]}" source --download-only -t "$release" highway fmtlib expat); } ||
        skip "apt-get cannot download the sources of highway, fmtlib and expat"
    for library in highway fmtlib expat; do
        rm -rf "${build:?}/$library"
        mkdir "$build/$library"
        tar -C "$build/$library" --strip-components=1 -xf "$build"/apt/${library}_*.orig.tar.*
        folder=$build/$library
        [ -f "$folder/CMakeLists.txt" ] || folder=$folder/$library
        cmake -S "$folder" -B "$build/$library/build" "${toolchain[@]}" -DBUILD_TESTING=OFF -DHWY_ENABLE_CONTRIB=OFF \
            -DHWY_ENABLE_EXAMPLES=OFF -DFMT_TEST=OFF -DFMT_DOC=OFF -DEXPAT_BUILD_TOOLS=OFF -DEXPAT_BUILD_TESTS=OFF \
            -DEXPAT_SHARED_LIBS=OFF >"$build/log" || { cat "$build/log"; exit 1; }
        cmake --build "$build/$library/build" --target install >"$build/log" || { cat "$build/log"; exit 1; }
    done
    # Highway 1.0.3 has no file for find_package(); toml++ is headers.
    mkdir -p "$build/prefix/lib/cmake/hwy"
    cat >"$build/prefix/lib/cmake/hwy/hwyConfig.cmake" <<'END'
add_library(hwy::hwy STATIC IMPORTED)
set_target_properties(hwy::hwy PROPERTIES IMPORTED_LOCATION ${CMAKE_CURRENT_LIST_DIR}/../../libhwy.a
  INTERFACE_INCLUDE_DIRECTORIES ${CMAKE_CURRENT_LIST_DIR}/../../../include)
END
    cp -r /usr/include/toml++ "$build/prefix/include/"
    touch "$build/prefix/complete-2"
fi

cmake -S "$tree" -B "$build/core" "${toolchain[@]}" -DBUILD_SHARED_LIBS=OFF -DTONEWRIGHT_BUILD_TESTS=OFF \
    -DTONEWRIGHT_BUILD_OCIO=OFF -DTONEWRIGHT_BUILD_IMAGE=OFF -DTONEWRIGHT_WITH_ICC=OFF
cmake --build "$build/core" --target tonewright_core
$compiler -std=c++20 -O1 -I"$tree/src" -I"$tree/src/include" -I"$build/prefix/include" \
    "$tree/tests/platforms/core_files.cpp" "$build/core/src/libtonewright_core.a" \
    -L"$build/prefix/lib" -lhwy -lfmt -lexpat -static -o "$build/core_files.exe"
export WINEPREFIX=$build/wine WINEDEBUG=-all WINEDLLOVERRIDES='mscoree,mshtml='
compare_core_files "$native" "$wine" "$build/core_files.exe"
