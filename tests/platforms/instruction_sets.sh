#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Processors with AVX2 and with no more than SSE4 write the bytes that this one writes: in QEMU, which stands in for both the
# engine and the C library's math. QEMU 7.2 has no AVX-512.
#   instruction_sets.sh core_files
set -euo pipefail
native=$1
[ "$(uname -m)" = x86_64 ] || { echo "skipped: this is no x86-64 processor"; exit 77; }
command -v qemu-x86_64-static >/dev/null || { echo "skipped: qemu-x86_64-static is not installed (Debian: qemu-user-static)"; exit 77; }
# shellcheck source=tests/platforms/core_files.sh
source "$(dirname "$0")/core_files.sh"
failed=0
echo "This processor: $(grep -ow -m1 -E 'avx512f' /proc/cpuinfo | head -1)"
for processor in Haswell Westmere; do
    compare_core_files "$native" qemu-x86_64-static -cpu $processor "$native" 2> >(grep -v "TCG doesn't support" >&2) || failed=1
done
exit $failed
