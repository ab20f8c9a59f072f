#!/bin/bash
# SPDX-License-Identifier: Apache-2.0
# libvips 8.14 says that Radiance, OpenEXR, PFM and float TIFF pictures are scRGB, where 1.0 is white. "vips copy" to PNG or
# JPEG nevertheless writes the float as it is, so light of 1.0 becomes 1 of 255 and the picture is black. vipsthumbnail and
# "vips colourspace" convert. Exits with 1 if that changes.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
# shellcheck source=findings/lib/packages.bash
source "$(dirname "$0")/lib/packages.bash" "$folder" libvips-tools=8.14.1-3+deb12u3
run vips --version
python3 -c 'import sys
open(sys.argv[1], "wb").write(b"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 64 +X 64\n" + bytes([128, 128, 128, 129]) * 4096)' "$folder/in.hdr"
says=$(run vipsheader -f interpretation "$folder/in.hdr" | tr -d '()' | awk '{print $NF}')
run vips copy "$folder/in.hdr" "$folder/copy.png"
run vips colourspace "$folder/in.hdr" "$folder/srgb.png" srgb
copy=$(run vips getpoint "$folder/copy.png" 32 32 | tr -d '\n') srgb=$(run vips getpoint "$folder/srgb.png" 32 32 | tr -d '\n')
echo "white of 1.0, $says: vips copy gives $copy; vips colourspace gives $srgb"
[ "$says; $copy; $srgb" = "VIPS_INTERPRETATION_scRGB; 1 1 1 ; 255 255 255 " ]
