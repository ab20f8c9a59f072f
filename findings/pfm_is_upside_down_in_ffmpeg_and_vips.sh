#!/bin/bash
# SPDX-License-Identifier: Apache-2.0
# The rows of a PFM file go from the bottom of the picture to its top (Debevec; netpbm's pfm(5), which notes that Photoshop's go
# the other way). libvips and ffmpeg take the first row for the top, so a PFM of another HDR program is upside down. G'MIC and
# OpenImageIO turn it. Exits with 1 if that changes.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
# shellcheck source=findings/lib/packages.bash
source "$(dirname "$0")/lib/packages.bash" "$folder" openimageio-tools=2.4.7.1+dfsg-2 libvips-tools=8.14.1-3+deb12u3 \
    ffmpeg=7:5.1.9-0+deb12u1 gmic=2.9.4-4+b4
echo "oiiotool $(run oiiotool --version); $(run vips --version); $(run ffmpeg -version | head -1 | cut -d' ' -f1-3);" \
    "gmic $(run gmic -v - version 2>&1 | grep -oE '[0-9]+\.[0-9]+\.[0-9]+' | head -1)"
# The upper half is 1.0, the lower half 0.25.
python3 -c 'import struct, sys
open(sys.argv[1], "wb").write(b"PF\n8 8\n-1.0\n" + struct.pack("<192f", *[0.25] * 96, *[1.0] * 96))' "$folder/in.pfm"
run ffmpeg -v error -y -i "$folder/in.pfm" -f rawvideo -pix_fmt gbrpf32le "$folder/ffmpeg.raw"
oiio=$(run oiiotool --dumpdata "$folder/in.pfm" | awk '/Pixel \(0, 0\)/ {printf "%.2f", $4}')
gmic=$(run gmic -v - "$folder/in.pfm" echo_stdout "{i(0,0)}" | awk '{printf "%.2f", $NF}')
vips=$(run vips getpoint "$folder/in.pfm" 0 0 | awk '{printf "%.2f", $1}')
ffmpeg=$(head -c 4 "$folder/ffmpeg.raw" | od -An -tf4 | awk '{printf "%.2f", $1}')
echo "pixel at the top: oiiotool $oiio; G'MIC $gmic; libvips $vips; ffmpeg $ffmpeg"
[ "$oiio $gmic $vips $ffmpeg" = "1.00 1.00 0.25 0.25" ]
