#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Installs a build into a folder of its own, moves that folder, and uses it as people outside the tree do:
# through pkg-config and through CMake, core alone and all of it, and the command.
# Usage: run.sh BUILD_DIR WORK_DIR
set -euo pipefail
build=$1
work=$2
here=$(cd "$(dirname "$0")" && pwd)
rm -rf "$work"
cmake --install "$build" --prefix "$work/first" >/dev/null
mv "$work/first" "$work/prefix" # an installation finds its parts by its own place
prefix=$work/prefix
PKG_CONFIG_PATH=$(dirname "$(find "$prefix" -name tonewright-core.pc)")
LD_LIBRARY_PATH=$(dirname "$PKG_CONFIG_PATH")
export PKG_CONFIG_PATH
failed=0
expect() { # WHAT COMMAND...
    local what=$1
    shift
    if "$@" >"$work/log" 2>&1; then echo "ok: $what"; else echo "FAILED: $what" && cat "$work/log" && failed=1; fi
}
without() { # PROGRAM PATTERN: the program loads no library of that name
    local loaded
    loaded=$(LD_LIBRARY_PATH=$LD_LIBRARY_PATH ldd "$1") && ! grep -iE "$2|not found" <<<"$loaded"
}

# Every public header stands alone, in C++17: a third of them, by the commit.
commit=$(git -C "$here" rev-parse HEAD 2>/dev/null | cut -c9-16)
share=$((${TONEWRIGHT_TEST_SHARE:-0x${commit:-0}} % 3))
number=0
for header in "$prefix"/include/tonewright/*.h; do
    name=${header##*/}
    number=$((number + 1))
    [ "${TONEWRIGHT_TEST_ALL:-}" = 1 ] || [ $((number % 3)) -eq $share ] || continue
    # shellcheck disable=SC2046 # flags are words
    expect "$name is C++17" g++ -std=c++17 -Wall -Wextra -Wpedantic -fsyntax-only -x c++ \
        $(pkg-config --cflags tonewright-image) -include "$header" /dev/null
done

# shellcheck disable=SC2046
expect "core through pkg-config: compile" g++ "$here/core/main.cpp" \
    $(pkg-config --cflags --libs tonewright-core) -o "$work/plain"
expect "core through pkg-config: run" env LD_LIBRARY_PATH="$LD_LIBRARY_PATH" "$work/plain"
expect "core has no OpenImageIO, OpenColorIO, Qt, GDAL" without "$work/plain" 'OpenImageIO|OpenColorIO|Qt|gdal'

for consumer in core image; do
    expect "$consumer through CMake: configure" cmake -S "$here/$consumer" -B "$work/$consumer" \
        -DCMAKE_BUILD_TYPE=Debug -DCMAKE_PREFIX_PATH="$prefix"
    expect "$consumer through CMake: build" cmake --build "$work/$consumer"
    expect "$consumer through CMake: run" "$work/$consumer/${consumer}_consumer"
done
expect "core through CMake has no OpenImageIO, OpenColorIO" \
    without "$work/core/core_consumer" 'OpenImageIO|OpenColorIO'

expect "the command: chart" "$prefix/bin/tonewright" chart -o "$work/chart.exr" --width 320 --height 180
expect "the command: apply" "$prefix/bin/tonewright" apply "$work/chart.exr" "$work/chart.png" --operator hable
expect "the command: bake" "$prefix/bin/tonewright" bake hable -o "$work/hable.cube"
expect "the picture" test -s "$work/chart.png"

# Data and documents, each as it is in the tree, at its place by the FHS.
root=$(cd "$here/../.." && pwd)
data=$prefix/share/tonewright
documents=$prefix/share/doc/tonewright
for folder in ocio_config luts; do
    expect "$folder is installed whole" diff -r "$root/$folder" "$data/$folder"
done
expect "the license" cmp "$root/LICENSE" "$documents/LICENSE"
expect "documents" diff -r "$root/docs" "$documents/docs"
expect "README" cmp "$root/README.md" "$documents/README.md"
links() { # every relative link of the documents leads to a file, but those to sources
    local page target missing=0
    while IFS=: read -r page target; do
        target=${target%%#*}
        case $target in *src/* | *tests/* | *python_check/*) continue ;; esac
        [ -e "$(dirname "$page")/$target" ] || { echo "$page: $target" && missing=1; }
    done < <(grep -roE --include=*.md '\]\([^)#: ]+(#[^)]*)?\)' "$documents/README.md" "$documents/docs" |
        sed 's/](//; s/)$//')
    return $missing
}
expect "links of the documents" links
python=$(command -v /usr/bin/python3 || command -v python3)
if [ -x "$(command -v ociocheck)" ]; then
    expect "OpenColorIO takes the config" ociocheck --iconfig "$data/ocio_config/config.ocio"
fi
package=$(find "$prefix" -name _tonewright.pyi)
if [ -n "$package" ]; then
    site=$(dirname "$(dirname "$package")")
    expect "the Python module" env PYTHONPATH="$site" "$python" -c '
import tonewright
assert tonewright.__file__.startswith("'"$site"'"), tonewright.__file__
assert abs(tonewright.evaluate("clamp", [0.5, 0.5, 0.5], display="linear")[0] - 0.5) < 1e-12'
fi
plugin=$(find "$prefix" -name tonewright.imageio.so)
if [ -n "$plugin" ] && [ -x "$(command -v iinfo)" ]; then
    expect "the plugin" env -u LD_LIBRARY_PATH OIIO_LIBRARY_PATH="${plugin%/*}" iinfo "$work/chart.exr.tonewright?op=hable"
fi
exit $failed
