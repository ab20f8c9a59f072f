#!/bin/bash
# SPDX-License-Identifier: Apache-2.0
# A Radiance pixel has a mantissa m of 8 bits for each channel and a common exponent e. Radiance itself and libvips read (m +
# 0.5)/256 times 2^(e - 128), OpenImageIO m/256, three.js m/255, and hdrify (m + 0.5)/255. The same pixel is 0.8 % brighter in
# the last one than in OpenImageIO. Exits with 1 if that changes.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
# shellcheck source=findings/lib/packages.bash
source "$(dirname "$0")/lib/packages.bash" "$folder" openimageio-tools=2.4.7.1+dfsg-2 libvips-tools=8.14.1-3+deb12u3
# shellcheck source=findings/lib/npm.bash
source "$(dirname "$0")/lib/npm.bash" "$folder" three@0.187.0 hdrify@1.2.1
echo "oiiotool $(run oiiotool --version); $(run vips --version)"
python3 -c 'import sys
open(sys.argv[1], "wb").write(b"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 4 +X 4\n" + bytes([128, 128, 128, 129]) * 16)' "$folder/in.hdr"
cat >"$folder/read.mjs" <<'J'
import {readFileSync} from 'fs';
import {FloatType} from 'three';
import {HDRLoader} from 'three/examples/jsm/loaders/HDRLoader.js';
import {readHdr} from 'hdrify';
const file = new Uint8Array(readFileSync(process.argv[2]));
console.log(new HDRLoader().setDataType(FloatType).parse(file.buffer).data[0], readHdr(file).data[0]);
J
run vips rad2float "$folder/in.hdr" "$folder/vips.v"
oiio=$(run oiiotool --stats "$folder/in.hdr" | awk '/Stats Max/ {print $3}')
vips=$(run vips getpoint "$folder/vips.v" 0 0 | cut -d' ' -f1)
read -r three hdrify < <(node "$folder/read.mjs" "$folder/in.hdr")
echo "128 128 128 129: oiiotool $oiio; libvips $vips; three.js $three; hdrify $hdrify"
python3 -c 'import sys
want = (128 / 128, 128.5 / 128, 256 / 255, 257 / 255)
sys.exit(any(abs(float(v) - w) > 2e-5 for v, w in zip(sys.argv[1:], want)))  # printed with 6 digits or more' "$oiio" "$vips" "$three" "$hdrify"
