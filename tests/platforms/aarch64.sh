#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Cross-compiles the core library and its tests for 64-bit Arm, runs tests in QEMU's user mode, and prints the largest
# error of the NEON engine against the reference for each operator.
#   aarch64.sh SOURCE_TREE BUILD_FOLDER [core_files]
# core_files of this processor: LUTs, shaders and numbers of the reference have its bytes.
set -euo pipefail
tree=$1 build=$2 native=${3:-}
skip() { echo "skipped: $*"; exit 77; }
for program in aarch64-linux-gnu-g++ qemu-aarch64-static; do
    command -v $program >/dev/null ||
        skip "$program is not installed (Debian: g++-aarch64-linux-gnu qemu-user-static)"
done
command -v apt-get >/dev/null || skip "apt-get is missing; it downloads Debian's libraries for arm64"
# shellcheck source=tests/platforms/sysroot.sh
here=$(dirname "$0")
source "$here/sysroot.sh"
# shellcheck source=tests/platforms/core_files.sh
source "$here/core_files.sh"
make_sysroot arm64 "$build/sysroot"
sysroot=$(realpath "$build/sysroot")

cmake -S "$tree" -B "$build/core" -G Ninja -DCMAKE_BUILD_TYPE=Release \
    -DCMAKE_TOOLCHAIN_FILE="$tree/tests/platforms/aarch64.cmake" -DCMAKE_PREFIX_PATH="$sysroot/usr" \
    -DTONEWRIGHT_BUILD_OCIO=OFF -DTONEWRIGHT_BUILD_IMAGE=OFF -DTONEWRIGHT_WITH_ICC=OFF \
    -DTONEWRIGHT_WARNINGS_AS_ERRORS=ON
cmake --build "$build/core"

# QEMU takes ten to thirty times as long as a processor: small sample sets, whatever the caller asks for.
export TONEWRIGHT_TEST_ALL=0
run() { qemu-aarch64-static -L /usr/aarch64-linux-gnu "$build/core/bin/$1" --gtest_brief=1 "${@:2}"; }
bound='*/Law.SimdIsTotalAndWithinItsBound/*'
# These compare every view of every operator, fit LUTs or write all shaders: minutes each in QEMU. None of them depends on
# the vectors.
slow='Reference.IsEvaluateBitForBit:*Fit*:*Shipped*:*SimdOperator.IsTotal*:BakeLut.TheDefault*:Bake.AMaximalError*'
slow+=':Ringing.Repairs*:Shader.EveryVariant*:Shader.FiniteInFloat*:LiveParameters.*'
shares=16
share=${TONEWRIGHT_TEST_SHARE:-$((16#$(git -C "$tree" rev-parse HEAD | cut -c1-8)))}
share=$((share % shares))
cat <<TEXT
Left out: unit tests of ocio/ and image/ and of ICC files, whose libraries are not built; unit tests that take minutes
in QEMU ($slow); all but share $share of $shares of the other laws (TONEWRIGHT_TEST_SHARE=$share).
TEXT
failed=0
run unit_tests --gtest_filter="-$slow" & unit=$!
run law_tests --gtest_filter="$bound" --gtest_output="xml:$build/bound.xml" || failed=1
GTEST_TOTAL_SHARDS=$shares GTEST_SHARD_INDEX=$share run law_tests --gtest_filter="-$bound" || failed=1
wait $unit || failed=1

echo "Largest error of the NEON engine against the reference, in sRGB code values:"
tr -d '\n' <"$build/bound.xml" | sed 's/<testcase/\n&/g' |
    sed -n 's/.*name="SimdIsTotalAndWithinItsBound\/\([^"]*\)".*name="NEON" value="\([^"]*\)".*/\2 \1/p' |
    sort -rg | awk '{ printf "  %-8s %s\n", $1, $2; n++ } END { print n + 0, "operators, presets and looks"; exit n == 0 }' ||
    failed=1
if [ -n "$native" ]; then
    compare_core_files "$native" qemu-aarch64-static -L /usr/aarch64-linux-gnu "$build/core/bin/core_files" || failed=1
fi
exit $failed
