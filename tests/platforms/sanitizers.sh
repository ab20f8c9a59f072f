#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Builds and tests a preset: `dev` (AddressSanitizer and UndefinedBehaviorSanitizer, the whole suite) or `tsan`
# (ThreadSanitizer, the tests that start threads).
#   sanitizers.sh SOURCE_TREE PRESET
set -euo pipefail
cd "$1"
cmake --preset "$2" >/dev/null
cmake --build --preset "$2"
ctest --preset "$2" -j "$(nproc)"
