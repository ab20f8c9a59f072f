#!/bin/bash
# SPDX-License-Identifier: Apache-2.0
# A .3dl file holds whole numbers, and its "Mesh 4 12" line says their depth: 12 bits, white 4095. OpenColorIO guesses the depth
# from the largest number instead, so a dark look of 12 bits with a white of 900 is taken for 10 bits and four times as bright.
# Babylon.js divides by the largest number: its white is 255 of 255. ffmpeg takes all files for 12 bits, so one of 16 bits is 16
# times as bright. Exits with 1 if that changes.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
# shellcheck source=findings/lib/packages.bash
source "$(dirname "$0")/lib/packages.bash" "$folder" opencolorio-tools=2.1.2+dfsg1-4+b3 ffmpeg=7:5.1.9-0+deb12u1
# shellcheck source=findings/lib/npm.bash
source "$(dirname "$0")/lib/npm.bash" "$folder" @babylonjs/core@9.35.0
echo "OpenColorIO 2.1.2; $(run ffmpeg -version | head -1 | cut -d' ' -f1-3)"
python3 - "$folder" <<'P'
import itertools, struct, sys
grid = " ".join(str(min(64 * i, 1023)) for i in range(17)) + "\n"
for name, white, mesh in (("dark12", 900, ""), ("dark12mesh", 900, "3DMESH\nMesh 4 12\n"), ("white16", 65535, "")):
    nodes = "".join(" ".join(str(white * i // 16) for i in node) + "\n" for node in itertools.product(range(17), repeat=3))
    open(f"{sys.argv[1]}/{name}.3dl", "w").write(mesh + grid + nodes)
open(f"{sys.argv[1]}/in.pfm", "wb").write(b"PF\n8 8\n-1.0\n" + struct.pack("<192f", *[1.0] * 192))
P
cat >"$folder/read.mjs" <<'J'
import {readFileSync} from 'fs';
import {ColorGradingTexture} from '@babylonjs/core/Materials/Textures/colorGradingTexture.js';
import {NullEngine} from '@babylonjs/core/Engines/nullEngine.js';
const engine = new NullEngine();
let texels;
engine.updateRawTexture = engine.updateRawTexture3D = (texture, data) => { texels = data; };
engine._loadFile = (url, loaded) => loaded(readFileSync(url, 'utf8'));
new ColorGradingTexture(process.argv[2], engine);
console.log(texels[texels.length - 4]);
J
ocio() { run ociochecklut "$folder/$1.3dl" 1 1 1 | tail -1 | awk '{printf "%.4f", $1}'; }
dark=$(ocio dark12) mesh=$(ocio dark12mesh)
babylon=$(node "$folder/read.mjs" "$folder/dark12.3dl" | tail -1)
run ffmpeg -v error -y -i "$folder/in.pfm" -vf "lut3d=$folder/white16.3dl" -pix_fmt gbrpf32le -f rawvideo "$folder/out.raw"
ffmpeg=$(head -c 4 "$folder/out.raw" | od -An -tf4 | awk '{printf "%.4f", $1}')
echo "white of 900 of 4095 (0.2198): OpenColorIO $dark, with a Mesh line $mesh; Babylon.js $babylon of 255"
echo "white of 65535: ffmpeg $ffmpeg"
[ "$dark $mesh $babylon $ffmpeg" = "0.8798 0.8798 255 15.9998" ]
