#!/bin/bash
# SPDX-License-Identifier: Apache-2.0
# Channels of the type UINT in OpenEXR files hold whole numbers, such as object IDs; the format does not scale them. oiiotool
# divides them by 2^32 - 1 when it converts to float, so an ID of 5 is 1.2e-9. ffmpeg shifts them to 16 bits, where it is 0.
# libvips and pfstools give 5. Exits with 1 if that changes.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
# shellcheck source=findings/lib/packages.bash
source "$(dirname "$0")/lib/packages.bash" "$folder" openimageio-tools=2.4.7.1+dfsg-2 ffmpeg=7:5.1.9-0+deb12u1 \
    libvips-tools=8.14.1-3+deb12u3 pfstools=2.2.0-5+b1
echo "oiiotool $(run oiiotool --version); $(run ffmpeg -version | head -1 | cut -d' ' -f1-3); $(run vips --version); pfstools 2.2.0"
PYTHONPATH=$(dirname "$0")/lib PYTHONDONTWRITEBYTECODE=1 python3 - "$folder" <<'P'
import sys, exr
exr.write(f"{sys.argv[1]}/in.exr", {name: (exr.UINT, 5) for name in "RGB"}, (0, 0, 7, 7))
P
run oiiotool "$folder/in.exr" -d float -o "$folder/out.exr"
oiio=$(run oiiotool --dumpdata "$folder/out.exr" | awk '/Pixel \(0, 0\)/ {print $4}')
run ffmpeg -v error -y -i "$folder/in.exr" -f rawvideo "$folder/out.raw"
ffmpeg=$(head -c 2 "$folder/out.raw" | od -An -tu2 | tr -d ' ')
vips=$(run vips getpoint "$folder/in.exr" 0 0 | cut -d' ' -f1)
run pfsinexr "$folder/in.exr" | run pfsoutpfm "$folder/out.pfm"
pfs=$(tail -c 4 "$folder/out.pfm" | od -An -tf4 | awk '{printf "%.2f", $1}')
echo "5: oiiotool $oiio; ffmpeg $ffmpeg; libvips $vips; pfstools $pfs"
[ "$ffmpeg $vips $pfs" = "0 5 5.00" ]
python3 -c 'import sys; sys.exit(not abs(float(sys.argv[1])) < 2e-9)' "$oiio"  # 5/(2^32 - 1) is 1.2e-9, printed with 9 digits
