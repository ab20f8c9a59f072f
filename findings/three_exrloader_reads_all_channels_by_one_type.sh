#!/bin/bash
# SPDX-License-Identifier: Apache-2.0
# Each channel of an OpenEXR file has its own type; writers choose half for color and float for others. EXRLoader of three.js
# reads all channels by the type of one: with half red, green, blue and a float alpha of 1.0, alpha is 0 and 1.875 by turns.
# hdrify and libvips read the file. Exits with 1 if that changes.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
# shellcheck source=findings/lib/packages.bash
source "$(dirname "$0")/lib/packages.bash" "$folder" libvips-tools=8.14.1-3+deb12u3
# shellcheck source=findings/lib/npm.bash
source "$(dirname "$0")/lib/npm.bash" "$folder" three@0.187.0 hdrify@1.2.1
run vips --version
PYTHONPATH=$(dirname "$0")/lib PYTHONDONTWRITEBYTECODE=1 python3 - "$folder" <<'P'
import sys, exr
channels = {"R": (exr.HALF, 0.25), "G": (exr.HALF, 0.5), "B": (exr.HALF, 1.0), "A": (exr.FLOAT, 1.0)}
exr.write(f"{sys.argv[1]}/in.exr", channels, (0, 0, 7, 7))
P
cat >"$folder/read.mjs" <<'J'
import {readFileSync} from 'fs';
import {FloatType} from 'three';
import {EXRLoader} from 'three/examples/jsm/loaders/EXRLoader.js';
import {readExr} from 'hdrify';
const file = new Uint8Array(readFileSync(process.argv[2]));
for (const {data} of [new EXRLoader().setDataType(FloatType).parse(file.buffer), readExr(file)])
    console.log([data[3], data[data.length - 1]].join(' '));
J
mapfile -t js < <(node "$folder/read.mjs" "$folder/in.exr")
vips=$(run vips getpoint "$folder/in.exr" 7 7 | cut -d' ' -f4)
echo "alpha of two pixels: three.js ${js[0]}; hdrify ${js[1]}; alpha in libvips, where 255 is opaque: $vips"
[ "${js[0]}; ${js[1]}; $vips" = "0 1.875; 1 1; 255" ]
