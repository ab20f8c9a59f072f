#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# "An operator is one new file": drops one into a copy of the tree, touches nothing else, builds the
# command and uses the operator in every form. What stays as it is, the tree's own build has compiled.
# new_operator.sh SOURCE_TREE BUILD WORK_FOLDER
set -euo pipefail
source=$1 build=$2 work=$3
mkdir -p "$work/tree"
# Only what the command is built from; unchanged files keep their times, so a second run is short.
(cd "$source" && tar cf - CMakeLists.txt src) | (cd "$work/tree" && tar xf -)
mkdir -p "$work/tree/tests" && : >"$work/tree/tests/CMakeLists.txt"
cp -p "$source/tests/install/new_operator/toy.cpp" "$work/tree/src/operators/toy.cpp"
as_built() { sed -n "s/^$1:[A-Z]*=//p" "$build/CMakeCache.txt"; }
cmake -S "$work/tree" -B "$work/build" -G Ninja -DCMAKE_BUILD_TYPE="$(as_built CMAKE_BUILD_TYPE)" \
    -DCMAKE_CXX_FLAGS="$(as_built CMAKE_CXX_FLAGS)" -DTONEWRIGHT_BUILD_TESTS=OFF -DTONEWRIGHT_BUILD_BENCH=OFF \
    -DCMAKE_CXX_COMPILER_LAUNCHER="$source/tests/install/reuse_object.sh;$build;$source;$work/tree" \
    >"$work/build.log" 2>&1 &&
    cmake --build "$work/build" --target tonewright-cli >>"$work/build.log" 2>&1 ||
    { tail -40 "$work/build.log"; exit 1; }
tonewright=$work/build/bin/tonewright

failed=0
expect() { # WHAT EXPECTED ACTUAL
    if [ "$2" = "$3" ]; then echo "ok: $1"; else echo "FAILED: $1: $3; expected $2" && failed=1; fi
}
# x/(x + 2) and x/(x + 5): 1/3, 1/6; luminance 0.2126 r alone: r/(0.2126 r + 2).
for engine in reference simd ocio; do
    expect "eval --engine $engine" "0.333 0.500 0.000" "$(echo 1 2 0 |
        "$tonewright" eval toy --display native --engine $engine | awk '{printf "%.3f %.3f %.3f", $1, $2, $3}')"
done
expect preset 0.166666667 "$(echo 1 1 1 | "$tonewright" eval toy:soft --display native | cut -d' ' -f1)"
expect "apply=luminance" 0.451956974 "$(echo 1 0 0 |
    "$tonewright" eval toy --set apply=luminance --display native | cut -d' ' -f1)"
expect "list" "toy: Toy" "$("$tonewright" list toy | head -1)"
expect "list --views" "toy	Toy" "$("$tonewright" list --views | grep '^toy	')"
"$tonewright" bake toy --format cube --size 17 -o "$work/toy.cube"
expect "bake" 4913 "$(grep -c '^[-0-9]' "$work/toy.cube")"
code=0
message=$(echo 1 1 1 | "$tonewright" eval toy --set knee=11 2>&1 >/dev/null) || code=$?
expect "a bad parameter" "2 tonewright: toy: knee is 11; expected [0.1, 10] scene-linear" "$code $message"
exit $failed
