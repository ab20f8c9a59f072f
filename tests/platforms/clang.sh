#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Builds everything with Clang, without precompiled headers and with warnings as errors, and runs the unit tests.
#   clang.sh SOURCE_TREE BUILD_FOLDER
set -euo pipefail
source=$1 build=$2
command -v clang++ >/dev/null || { echo "skipped: clang++ is not installed (Debian: clang)"; exit 77; }
# A precompiled header would hide an #include that a file lacks.
cmake -S "$source" -B "$build" -G Ninja -DCMAKE_BUILD_TYPE=Release -DCMAKE_CXX_COMPILER=clang++ \
    -DCMAKE_DISABLE_PRECOMPILE_HEADERS=ON -DTONEWRIGHT_WARNINGS_AS_ERRORS=ON -DTONEWRIGHT_BUILD_BENCH=OFF >/dev/null
cmake --build "$build"
TONEWRIGHT_TEST_ALL=0 "$build/bin/unit_tests" --gtest_brief=1
