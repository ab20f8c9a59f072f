#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Builds libraries, command and plugin with Clang, warnings as errors; then runs clang-tidy over an eighth of the
# sources, picked by the commit (all of them take clang-tidy about an hour of processor time).
#   clang.sh SOURCE_TREE BUILD_FOLDER
set -euo pipefail
source=$1 build=$2
for program in clang++ clang-tidy; do
    command -v $program >/dev/null || { echo "skipped: $program is not installed (Debian: clang clang-tidy)"; exit 77; }
done
cmake -S "$source" -B "$build" -G Ninja -DCMAKE_BUILD_TYPE=Release -DCMAKE_CXX_COMPILER=clang++ \
    -DTONEWRIGHT_BUILD_TESTS=OFF -DTONEWRIGHT_BUILD_BENCH=OFF -DTONEWRIGHT_WARNINGS_AS_ERRORS=ON
cmake --build "$build"
shares=8
share=${TONEWRIGHT_TEST_SHARE:-$((16#$(git -C "$source" rev-parse HEAD | cut -c1-8)))}
share=$((share % shares))
echo "clang-tidy: share $share of $shares (TONEWRIGHT_TEST_SHARE=$share)"
find "$source/src" -name '*.cpp' | sort | awk -v shares=$shares -v share=$share 'NR % shares == share' |
    xargs -n 1 -P "$(nproc)" clang-tidy -p "$build" --quiet
