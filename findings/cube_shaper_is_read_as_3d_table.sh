#!/bin/bash
# SPDX-License-Identifier: Apache-2.0
# A .cube file of DaVinci Resolve may have a 1D shaper and a 3D table: LUT_1D_SIZE and LUT_3D_SIZE, then both tables.
# OpenColorIO reads both. ffmpeg and the LUTCubeLoader of three.js take the rows of the shaper for the first nodes of the 3D
# table, without a message. Exits with 1 if that changes.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
# shellcheck source=findings/lib/packages.bash
source "$(dirname "$0")/lib/packages.bash" "$folder" opencolorio-tools=2.1.2+dfsg1-4+b3 ffmpeg=7:5.1.9-0+deb12u1
# shellcheck source=findings/lib/npm.bash
source "$(dirname "$0")/lib/npm.bash" "$folder" three@0.187.0
echo "OpenColorIO 2.1.2; $(run ffmpeg -version | head -1 | cut -d' ' -f1-3)"
# The shaper and the 3D table are identities, so the file changes no color.
python3 - "$folder" <<'P'
import itertools, struct, sys
shaper = "".join(f"{i / 8} {i / 8} {i / 8}\n" for i in range(9))
nodes = "".join("%d %d %d\n" % node[::-1] for node in itertools.product((0, 1), repeat=3))
open(f"{sys.argv[1]}/in.cube", "w").write(f"LUT_1D_SIZE 9\nLUT_3D_SIZE 2\n{shaper}{nodes}")
open(f"{sys.argv[1]}/in.pfm", "wb").write(b"PF\n8 8\n-1.0\n" + struct.pack("<192f", *[1.0] * 192))
P
cat >"$folder/read.mjs" <<'J'
import {readFileSync} from 'fs';
import {FloatType} from 'three';
import {LUTCubeLoader} from 'three/examples/jsm/loaders/LUTCubeLoader.js';
const {size, texture3D} = new LUTCubeLoader().setType(FloatType).parse(readFileSync(process.argv[2], 'utf8'));
console.log(size, texture3D.image.data.slice(-4, -1).join(' '));
J
ocio=$(run ociochecklut "$folder/in.cube" 1 1 1 | tail -1)
run ffmpeg -v error -y -i "$folder/in.pfm" -vf "lut3d=$folder/in.cube" -pix_fmt gbrpf32le -f rawvideo "$folder/out.raw"
ffmpeg=$(head -c 4 "$folder/out.raw" | od -An -tf4 | tr -d ' ')
three=$(node "$folder/read.mjs" "$folder/in.cube")
echo "white: OpenColorIO $ocio; ffmpeg $ffmpeg; three.js, size and last node: $three"
[ "$ocio; $ffmpeg; $three" = "1 1 1; 0.875; 2 0.875 0.875 0.875" ]
