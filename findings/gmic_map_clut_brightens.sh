#!/bin/bash
# SPDX-License-Identifier: Apache-2.0
# G'MIC's command map_clut looks up a value v of 0 to 255 in a table of n nodes at v n/256, not at v (n - 1)/255, and its last
# node is at 255 only for 256 nodes. With a table of 16 nodes that changes nothing, 200 becomes 212.5. GraphicsMagick leaves it
# at 200 with the same picture. Exits with 1 if that changes.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
# shellcheck source=findings/lib/packages.bash
source "$(dirname "$0")/lib/packages.bash" "$folder" gmic=2.9.4-4+b4 graphicsmagick=1.4+really1.3.40-4+deb12u1
echo "gmic $(run gmic -v - version 2>&1 | grep -oE '[0-9]+\.[0-9]+\.[0-9]+' | head -1); $(run gm version | head -1 | cut -d' ' -f1-2)"
# A Hald picture of level 4, 64 x 64 pixels: 16 nodes, red fastest.
python3 - "$folder" <<'P'
import itertools, sys
nodes = b"".join(bytes(17 * i for i in node[::-1]) for node in itertools.product(range(16), repeat=3))
open(f"{sys.argv[1]}/hald.ppm", "wb").write(b"P6\n64 64\n255\n" + nodes)
open(f"{sys.argv[1]}/in.ppm", "wb").write(b"P6\n8 8\n255\n" + bytes([200, 100, 50]) * 64)
P
gmic=$(run gmic -v - "$folder/in.ppm" "$folder/hald.ppm" "resize[1]" 16,16,16,3,-1 "map_clut[0]" "[1]" \
    echo_stdout "{0,I(0,0,0,0)}" | tail -1 | tr , " ")
run gm convert "$folder/in.ppm" -hald-clut "$folder/hald.ppm" "$folder/out.ppm"
gm=$(tail -c 3 "$folder/out.ppm" | od -An -tu1 | awk '{print $1, $2, $3}')
echo "200 100 50: G'MIC $gmic; GraphicsMagick $gm"
[ "$gmic; $gm" = "212.5 106.25 53.125; 200 100 50" ]
