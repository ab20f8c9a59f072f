#!/bin/bash
# SPDX-License-Identifier: Apache-2.0
# Highway 1.0.3 (libhwy, which libjxl needs for JPEG XL) measures the resolution of the processor's clock whenever it is loaded,
# whether a program asks for it or not. So each start of each program that links it takes milliseconds longer: several times
# what `true` takes. Exits with 1 if that changes.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
# shellcheck source=findings/lib/packages.bash
source "$(dirname "$0")/lib/packages.bash" "$folder" libhwy1=1.0.3-3+deb12u1 coreutils=9.1-1
python3 - "$findings_root" <<'P'
import os, subprocess, sys

def processor_seconds(library):
    """Of the fastest of 30 starts of `true` with a library."""
    libraries = f"{sys.argv[1]}/usr/lib/x86_64-linux-gnu"
    taken = []
    for _ in range(30):
        with subprocess.Popen([f"{sys.argv[1]}/usr/lib64/ld-linux-x86-64.so.2", "--library-path", libraries, "--preload", library,
                               f"{sys.argv[1]}/usr/bin/true"]) as process:
            _, process.returncode, used = os.wait4(process.pid, 0)
        if process.returncode:
            sys.exit(1)
        taken.append(used.ru_utime + used.ru_stime)
    return min(taken)

base, highway = processor_seconds("libstdc++.so.6"), processor_seconds("libhwy.so.1")
print(f"true with libstdc++ {1000 * base:.1f} ms; with libhwy, which needs it, {1000 * highway:.1f} ms")
# The library has 39 KB of code: without the measurement it is loaded in a fraction of a millisecond.
sys.exit(highway < base + 0.001)
P
