#!/bin/bash
# SPDX-License-Identifier: Apache-2.0
# CesiumJS offers MODIFIED_REINHARD and cites equation 4 of Reinhard et al. (2002), x (1 + x/white^2)/(1 + x). Its shader
# divides by white, not by its square, and the default white is 1, where the formula is x: no tone mapping at all. Exits with 1
# if that changes.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
# shellcheck source=findings/lib/npm.bash
source "$(dirname "$0")/lib/npm.bash" "$folder" @cesium/engine@26.3.0
cat >"$folder/read.mjs" <<'J'
import {readFileSync} from 'fs';
const base = process.argv[2] + '/node_modules/@cesium/engine/Source/';
const shader = readFileSync(base + 'Shaders/PostProcessStages/ModifiedReinhardTonemapping.glsl', 'utf8');
const curve = /color = (\(color \*.*white.*);/.exec(shader)[1];
const stage = readFileSync(base + 'Scene/PostProcessStageLibrary.js', 'utf8').split('createModifiedReinhardTonemappingStage')[1];
const white = /white: Color\.(\w+)/.exec(stage)[1];
const f = new Function('color', 'white', `return ${curve};`);  // for grays, vectors are numbers
console.log(curve);
console.log(`default white: Color.${white}; 0.18, 1, 4: ${[0.18, 1, 4].map(v => f(v, 1)).join(' ')}; 4 with white 4: ${f(4, 4)}`);
J
node "$folder/read.mjs" "$folder" | tee "$folder/seen"
echo "equation 4 with white 4 has 1.0 at 4"
[ "$(tail -1 "$folder/seen")" = "default white: Color.WHITE; 0.18, 1, 4: 0.18 1 4; 4 with white 4: 1.6" ]
