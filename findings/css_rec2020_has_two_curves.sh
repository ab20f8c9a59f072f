#!/bin/bash
# SPDX-License-Identifier: Apache-2.0
# CSS color(rec2020 ...) had the camera curve of BT.2020; CSS Color 4 now has the power 2.4 of displays (BT.1886). culori 4.0.2
# still decodes by the old one and colorjs.io 0.7.1 by the new one, so the same text is another color: 0.5 is 0.260 and 0.189 in
# linear light. Exits with 1 if that changes.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
# shellcheck source=findings/lib/npm.bash
source "$(dirname "$0")/lib/npm.bash" "$folder" culori@4.0.2 colorjs.io@0.7.1
cat >"$folder/read.mjs" <<'J'
import {converter} from 'culori';
import Color from 'colorjs.io';
const text = 'color(rec2020 0.5 0.5 0.5)';
console.log(converter('lrgb')(text).g.toFixed(4), new Color(text).to('srgb-linear').coords[1].toFixed(4));
J
seen=$(node "$folder/read.mjs")
python3 -c 'print("BT.2020 camera curve: %.4f; power 2.4: %.4f" % (((0.5 + 0.09929682680944) / 1.09929682680944) ** (1 / 0.45), 0.5 ** 2.4))'
echo "culori, colorjs.io: $seen"
[ "$seen" = "0.2597 0.1895" ]
