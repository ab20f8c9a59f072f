#!/bin/bash
# SPDX-License-Identifier: Apache-2.0
# Pictures of digital cinema are X'Y'Z' of 12 bits, where SMPTE ST 428-1 puts 48 cd/m2 at 3960, so that the blue part of whites
# fits. ffmpeg's xyz12le has white at 4095 without that factor: Z of a D65 white is cut, and the white that comes back is
# yellow. Exits with 1 if that changes.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
# shellcheck source=findings/lib/packages.bash
source "$(dirname "$0")/lib/packages.bash" "$folder" ffmpeg=7:5.1.9-0+deb12u1
run ffmpeg -version | head -1 | cut -d' ' -f1-3
python3 -c 'import sys
open(sys.argv[1], "wb").write(b"P6\n64 64\n65535\n" + b"\xff" * (64 * 64 * 6))' "$folder/white.ppm"
run ffmpeg -v error -y -i "$folder/white.ppm" -pix_fmt xyz12le -f rawvideo "$folder/xyz.raw"
run ffmpeg -v error -y -f rawvideo -pix_fmt xyz12le -s 64x64 -i "$folder/xyz.raw" -pix_fmt rgb48le -f rawvideo "$folder/rgb.raw"
xyz=$(head -c 6 "$folder/xyz.raw" | od -An -tu2 | awk '{print $1 / 16, $2 / 16, $3 / 16}')
rgb=$(head -c 6 "$folder/rgb.raw" | od -An -tu2 | awk '{print $1, $2, $3}')
python3 -c 'print("ST 428-1, white of D65 at 48 cd/m2:", *(round(4095 * (48 / 52.37 * v) ** (1 / 2.6)) for v in (0.9505, 1, 1.0891)))'
echo "ffmpeg: $xyz; back in RGB of 16 bits: $rgb"
[ "$xyz; $rgb" = "4015 4095 4095; 65520 65408 62640" ]
