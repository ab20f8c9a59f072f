#!/bin/bash
# SPDX-License-Identifier: Apache-2.0
# ffmpeg inserts swscale where the format of a filter differs. Its conversion of 16-bit RGB to float is not exact: back in 16
# bits, most of the 65536 codes are others, by up to 7. zscale gives all codes back. Exits with 1 if that changes.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
# shellcheck source=findings/lib/packages.bash
source "$(dirname "$0")/lib/packages.bash" "$folder" ffmpeg=7:5.1.9-0+deb12u1
run ffmpeg -version | head -1 | cut -d' ' -f1-3
python3 -c 'import struct, sys
open(sys.argv[1], "wb").write(b"P6\n256 256\n65535\n" + b"".join(struct.pack(">3H", v, v, v) for v in range(65536)))' "$folder/in.ppm"
rc=0
for filters in format=gbrpf32le,format=gbrp16le zscale,format=gbrpf32le,zscale=dither=none,format=gbrp16le; do
    run ffmpeg -v error -y -i "$folder/in.ppm" -vf "$filters" -f rawvideo -pix_fmt rgb48le "$folder/out.raw"
    python3 - "$folder/out.raw" "$filters" <<'P' || rc=1
import struct, sys
data = open(sys.argv[1], "rb").read()
off = [abs(v - i) for i, v in enumerate(struct.unpack("<%dH" % (len(data) // 2), data)[::3])]
count, most = sum(d > 0 for d in off), max(off)
print(f"{sys.argv[2]}: {count} codes differ, by up to {most}")
sys.exit(count > 0 if sys.argv[2].startswith("zscale") else count < 32768 or most < 2)
P
done
exit $rc
