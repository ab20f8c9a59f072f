#!/bin/bash
# SPDX-License-Identifier: Apache-2.0
# Radiance files may have the older run lengths, where a pixel 1 1 1 n repeats the one before it n times (Radiance file
# formats). three.js takes such a file as flat pixels, without an error: it has 32 wrong pixels where 256 equal ones are in the
# file. libvips reads it. Exits with 1 if that changes.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
# shellcheck source=findings/lib/packages.bash
source "$(dirname "$0")/lib/packages.bash" "$folder" libvips-tools=8.14.1-3+deb12u3
# shellcheck source=findings/lib/npm.bash
source "$(dirname "$0")/lib/npm.bash" "$folder" three@0.187.0
run vips --version
# 16 rows of 16 equal pixels: one pixel, and a run of 15.
python3 -c 'import sys
open(sys.argv[1], "wb").write(b"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 16 +X 16\n" + bytes([128, 128, 128, 129, 1, 1, 1, 15]) * 16)' \
    "$folder/in.hdr"
cat >"$folder/read.mjs" <<'J'
import {readFileSync} from 'fs';
import {FloatType} from 'three';
import {HDRLoader} from 'three/examples/jsm/loaders/HDRLoader.js';
const file = new Uint8Array(readFileSync(process.argv[2]));
const {data, width, height} = new HDRLoader().setDataType(FloatType).parse(file.buffer);
console.log(width, height, data.length / 4, [0, 1, 2].map(i => data[4 * i].toExponential(1)).join(' '));
J
run vips rad2float "$folder/in.hdr" "$folder/vips.v"
vips=$(for at in "0 0" "1 0" "2 0" "15 15"; do
    # shellcheck disable=SC2086
    run vips getpoint "$folder/vips.v" $at | awk '{printf "%.3f ", $1}'
done)
three=$(node "$folder/read.mjs" "$folder/in.hdr")
echo "red of pixels 1, 2, 3 and 256: libvips $vips"
echo "width, height, pixels, red of pixels 1, 2 and 3: three.js $three"
[ "$vips" = "1.004 1.004 1.004 1.004 " ] && [ "$three" = "16 16 32 1.0e+0 3.8e-37 1.0e+0" ]
