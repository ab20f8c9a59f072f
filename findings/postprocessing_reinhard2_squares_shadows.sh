#!/bin/bash
# SPDX-License-Identifier: Apache-2.0
# REINHARD2 of the package postprocessing multiplies the color by the compressed luminance itself, and does not divide by the
# luminance as Reinhard et al. (2002) do. Near black the picture is therefore the square of the light: 0.02 becomes 0.00024,
# where the equation gives 0.0119. Exits with 1 if that changes.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
# shellcheck source=findings/lib/npm.bash
source "$(dirname "$0")/lib/npm.bash" "$folder" three@0.187.0 postprocessing@6.39.6
cat >"$folder/read.mjs" <<'J'
import {readFileSync} from 'fs';
const text = readFileSync(new URL(import.meta.resolve('postprocessing')), 'utf8');
const shader = /vec3 Reinhard2ToneMapping\(vec3 color\)\{([\s\S]*?return clamp\([^;]*;)\}/.exec(text)[1];
const defaults = text.split('ToneMappingEffect = class')[1].slice(0, 4000);
const [white, gray] = ['maxLuminance', 'middleGrey'].map(name => Number(new RegExp(name + ' = ([\\d.]+)').exec(defaults)[1]));
// For grays, vectors are numbers.
const body = shader.replace(/#if[\s\S]*?#else/, '').replace('#endif', '').replace(/float /g, 'let ');
const f = new Function('color', 'toneMappingExposure', 'averageLuminance', 'middleGrey', 'whitePoint', 'luminance', 'max', 'clamp', body);
const map = v => f(v, 1, 1, gray, white, x => x, Math.max, (x, lo, hi) => Math.min(Math.max(x, lo), hi));
console.log(`white ${white}, gray ${gray}; 0.02, 0.18, 1: ${[0.02, 0.18, 1].map(v => map(v).toFixed(6)).join(' ')}`);
J
seen=$(node "$folder/read.mjs")
echo "$seen"
python3 -c 'L = lambda v: 0.6 * v * (1 + 0.6 * v / 16) / (1 + 0.6 * v)
print("the equation: %.6f %.6f %.6f" % tuple(map(L, (0.02, 0.18, 1))))'
[ "$seen" = "white 4, gray 0.6; 0.02, 0.18, 1: 0.000237 0.017664 0.389063" ]
