#!/bin/bash
# SPDX-License-Identifier: Apache-2.0
# The display window of an OpenEXR file is the frame, and the data window says where its pixels are. For a data window of 8 x 8 in
# the middle of a frame of 16 x 16, ffmpeg makes a picture of 16 x 16; libvips and three.js forget the frame; hdrify makes one of
# 8 x 8 and leaves half of its pixels at 0. Exits with 1 if that changes.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
# shellcheck source=findings/lib/packages.bash
source "$(dirname "$0")/lib/packages.bash" "$folder" ffmpeg=7:5.1.9-0+deb12u1 libvips-tools=8.14.1-3+deb12u3
# shellcheck source=findings/lib/npm.bash
source "$(dirname "$0")/lib/npm.bash" "$folder" three@0.187.0 hdrify@1.2.1
echo "$(run ffmpeg -version | head -1 | cut -d' ' -f1-3); $(run vips --version)"
PYTHONPATH=$(dirname "$0")/lib PYTHONDONTWRITEBYTECODE=1 python3 - "$folder" <<'P'
import sys, exr
exr.write(f"{sys.argv[1]}/in.exr", {name: (exr.HALF, 1.0) for name in "RGB"}, (4, 4, 11, 11), (0, 0, 15, 15))
P
cat >"$folder/read.mjs" <<'J'
import {readFileSync} from 'fs';
import {FloatType} from 'three';
import {EXRLoader} from 'three/examples/jsm/loaders/EXRLoader.js';
import {readExr} from 'hdrify';
const file = new Uint8Array(readFileSync(process.argv[2]));
for (const {width, height, data} of [new EXRLoader().setDataType(FloatType).parse(file.buffer), readExr(file)]) {
    let bright = 0;
    for (let i = 0; i < data.length; i += 4) bright += data[i] === 1;
    console.log(`${width}x${height} ${bright}`);
}
J
ffmpeg=$(run ffprobe -v error -show_entries stream=width,height -of csv=p=0:s=x "$folder/in.exr")
vips="$(run vipsheader -f width "$folder/in.exr")x$(run vipsheader -f height "$folder/in.exr")"
mapfile -t js < <(node "$folder/read.mjs" "$folder/in.exr")
echo "frame 16x16, data 8x8 with 64 pixels of 1.0: ffmpeg $ffmpeg; libvips $vips; three.js ${js[0]}; hdrify ${js[1]}"
[ "$ffmpeg $vips ${js[*]}" = "16x16 8x8 8x8 64 8x8 32" ]
