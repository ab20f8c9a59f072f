#!/bin/bash
# SPDX-License-Identifier: Apache-2.0
# Radiance pictures are RGBE or XYZE, and the FORMAT line says which (Radiance file formats). three.js, ImageMagick, pfstools
# and libvips (as scRGB) take X, Y and Z for red, green and blue, without a message, so all colors are wrong. OpenImageIO
# refuses the file. Exits with 1 if that changes.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
# shellcheck source=findings/lib/packages.bash
source "$(dirname "$0")/lib/packages.bash" "$folder" imagemagick-6.q16hdri=8:6.9.11.60+dfsg-1.6+deb12u15 pfstools=2.2.0-5+b1 \
    libvips-tools=8.14.1-3+deb12u3 openimageio-tools=2.4.7.1+dfsg-2
# shellcheck source=findings/lib/npm.bash
source "$(dirname "$0")/lib/npm.bash" "$folder" three@0.187.0
magick=${findings_root:?}/usr/lib/x86_64-linux-gnu/ImageMagick-6.9.11
export MAGICK_CODER_MODULE_PATH=$magick/modules-Q16HDRI/coders MAGICK_CONFIGURE_PATH=$magick/config-Q16HDRI:$findings_root/etc/ImageMagick-6
echo "$(run convert-im6.q16hdri -version | sed -n '1s/ https.*//p'); pfstools 2.2.0; $(run vips --version)"
python3 -c 'import sys
open(sys.argv[1], "wb").write(b"#?RADIANCE\nFORMAT=32-bit_rle_xyze\n\n-Y 8 +X 8\n" + bytes([128, 64, 32, 129]) * 64)' "$folder/in.hdr"
cat >"$folder/read.mjs" <<'J'
import {readFileSync} from 'fs';
import {FloatType} from 'three';
import {HDRLoader} from 'three/examples/jsm/loaders/HDRLoader.js';
const file = new Uint8Array(readFileSync(process.argv[2]));
console.log(Array.from(new HDRLoader().setDataType(FloatType).parse(file.buffer).data.slice(0, 3), v => v.toFixed(2)).join(' '));
J
three=$(node "$folder/read.mjs" "$folder/in.hdr")
magick=$(run convert-im6.q16hdri "$folder/in.hdr" -format '%[fx:p{0,0}.r] %[fx:p{0,0}.g] %[fx:p{0,0}.b]' info:)
run pfsinrgbe "$folder/in.hdr" | run pfsoutpfm "$folder/out.pfm"
run vips rad2float "$folder/in.hdr" "$folder/in.v"
pfs=$(tail -c 12 "$folder/out.pfm" | od -An -tf4 | awk '{printf "%.2f %.2f %.2f\n", $1, $2, $3}')
vips="$(run vipsheader -f interpretation "$folder/in.hdr" | tr -d '()' | awk '{print $NF}') $(run vips getpoint "$folder/in.v" 0 0)"
oiio=$(run oiiotool --info "$folder/in.hdr" 2>&1 | grep -c 'ERROR' || true)
echo "X 1, Y 0.5, Z 0.25: three.js RGB $three; ImageMagick RGB $magick; pfstools RGB $pfs; libvips $vips; oiiotool errors $oiio"
[ "$three; $magick; $pfs; $oiio" = "1.00 0.50 0.25; 1 0.5 0.25; 1.00 0.50 0.25; 1" ]
case $vips in *scRGB" 1.00391 0.50390"*) ;; *) exit 1 ;; esac
