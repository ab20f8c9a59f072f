#!/bin/bash
# SPDX-License-Identifier: Apache-2.0
# oiiotool --reorient of a picture with the Exif/TIFF orientation 5 or 7 gives the upright picture turned by 180 degrees.
# 6 and 8 are right. libvips turns all four as TIFF 6.0 says. Exits with 1 if that changes.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
# shellcheck source=findings/lib/packages.bash
source "$(dirname "$0")/lib/packages.bash" "$folder" openimageio-tools=2.4.7.1+dfsg-2 libvips-tools=8.14.1-3+deb12u3
echo "oiiotool $(run oiiotool --version); $(run vips --version)"
# Upright: 3 x 2 gray pixels, 10 20 30 over 40 50 60. Stored as the orientation says (TIFF 6.0, tag 274).
python3 - "$folder" <<'P'
import struct, sys
rows = [[10, 20, 30], [40, 50, 60]]
flip = lambda a: [row[::-1] for row in a]
turn = lambda a: [list(row) for row in zip(*a)]
stored = {5: turn(rows), 6: turn(flip(rows)), 7: flip(turn(rows))[::-1], 8: turn(rows[::-1])}
for orientation, a in stored.items():
    width, height, data = len(a[0]), len(a), bytes(v for row in a for v in row)
    tags = [(256, 3, width), (257, 3, height), (258, 3, 8), (259, 3, 1), (262, 3, 1), (273, 4, 0), (274, 3, orientation),
            (277, 3, 1), (278, 3, height), (279, 4, len(data))]
    at = 8 + 2 + 12 * len(tags) + 4
    ifd = struct.pack("<H", len(tags)) + b"".join(struct.pack("<HHII", n, k, 1, at if n == 273 else v) for n, k, v in tags)
    open(f"{sys.argv[1]}/{orientation}.tif", "wb").write(struct.pack("<2sHI", b"II", 42, 8) + ifd + bytes(4) + data)
P
values() { tr '\n' ' ' <"$1" | awk '{for (i = NF - 5; i < NF; ++i) printf "%s ", $i; print $NF}'; }  # the last six numbers of a PGM as text
upright="10 20 30 40 50 60" turned="60 50 40 30 20 10" rc=0
for orientation in 5 6 7 8; do
    run oiiotool "$folder/$orientation.tif" --reorient -o "$folder/o.ppm" 2>/dev/null
    run oiiotool "$folder/o.ppm" --ch 0 --attrib pnm:binary 0 -o "$folder/o.pgm"
    run vips autorot "$folder/$orientation.tif" "$folder/v.pgm[ascii]"
    oiio=$(values "$folder/o.pgm") vips=$(values "$folder/v.pgm")
    echo "orientation $orientation: oiiotool $oiio; libvips $vips"
    case $orientation in 5 | 7) want=$turned ;; *) want=$upright ;; esac
    [ "$oiio" = "$want" ] && [ "$vips" = "$upright" ] || rc=1
done
exit $rc
