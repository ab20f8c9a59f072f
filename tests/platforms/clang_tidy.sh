#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# clang-format over all sources, and clang-tidy over a quarter of the library's and the command's files, which the
# commit's hash picks: all of them take forty minutes on two processors. TONEWRIGHT_TEST_SHARE=N picks another quarter,
# TONEWRIGHT_TEST_SHARE=all takes all files.
#   clang_tidy.sh SOURCE_TREE BUILD_FOLDER [FILE...]
set -euo pipefail
source=$(realpath "$1") build=$2
shift 2
for program in clang++ clang-format clang-tidy; do
    command -v $program >/dev/null || { echo "skipped: $program is not installed (Debian: clang clang-format clang-tidy)"; exit 77; }
done
cd "$source"
git ls-files '*.cpp' '*.h' | xargs clang-format --dry-run --Werror

# GCC's precompiled headers are of no use to clang-tidy.
cmake -S . -B "$build" -G Ninja -DCMAKE_BUILD_TYPE=Release -DCMAKE_CXX_COMPILER=clang++ \
    -DCMAKE_DISABLE_PRECOMPILE_HEADERS=ON -DTONEWRIGHT_BUILD_TESTS=OFF -DTONEWRIGHT_BUILD_BENCH=OFF >/dev/null
files=("$@")
[ ${#files[@]} -gt 0 ] || mapfile -t files < <(git ls-files 'src/*.cpp')
# Other digits than CI's slice takes (.ci/run): all four shares meet this test.
share=${TONEWRIGHT_TEST_SHARE:-$((16#$(git rev-parse HEAD | cut -c9-16)))}
if [ $# -eq 0 ] && [ "$share" != all ]; then
    share=$((share % 4))
    mapfile -t files < <(printf '%s\n' "${files[@]}" | awk -v share=$share 'NR % 4 == share')
    echo "Share $share of 4: ${#files[@]} files (TONEWRIGHT_TEST_SHARE=$share)"
fi
# Standard error counts the messages of headers that are not ours.
printf '%s\n' "${files[@]}" | xargs -P "$(nproc)" -n 1 clang-tidy -p "$build" --quiet 2>/dev/null
