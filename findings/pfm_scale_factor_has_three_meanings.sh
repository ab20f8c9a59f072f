#!/bin/bash
# SPDX-License-Identifier: Apache-2.0
# The third line of a PFM file is a scale factor, whose sign says the order of bytes. For samples of 2.0 and a factor of 4,
# OpenImageIO gives 8 (multiplied), libvips 2 (ignored), and ffmpeg 0.5 (divided). Exits with 1 if that changes.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
# shellcheck source=findings/lib/packages.bash
source "$(dirname "$0")/lib/packages.bash" "$folder" openimageio-tools=2.4.7.1+dfsg-2 libvips-tools=8.14.1-3+deb12u3 \
    ffmpeg=7:5.1.9-0+deb12u1
echo "oiiotool $(run oiiotool --version); $(run vips --version); $(run ffmpeg -version | head -1 | cut -d' ' -f1-3)"
for scale in 1 4; do
    python3 -c 'import struct, sys
open(sys.argv[1], "wb").write(b"PF\n8 8\n-%d.0\n" % int(sys.argv[2]) + struct.pack("<192f", *[2.0] * 192))' "$folder/in.pfm" $scale
    run vips copy "$folder/in.pfm" "$folder/vips.v"
    run ffmpeg -v error -y -i "$folder/in.pfm" -pix_fmt gbrpf32le -f rawvideo "$folder/ffmpeg.raw"
    oiio=$(run oiiotool --stats "$folder/in.pfm" | awk '/Stats Max/ {print $3}')
    vips=$(run vips getpoint "$folder/vips.v" 4 4 | cut -d' ' -f1)
    ffmpeg=$(head -c 4 "$folder/ffmpeg.raw" | od -An -tf4 | tr -d ' ')
    echo "factor $scale: oiiotool $oiio; libvips $vips; ffmpeg $ffmpeg"
    python3 -c 'import sys
want = {"1": (2, 2, 2), "4": (8, 2, 0.5)}[sys.argv[1]]
sys.exit(tuple(float(v) for v in sys.argv[2:]) != want)' $scale "$oiio" "$vips" "$ffmpeg"
done
