#!/bin/bash
# SPDX-License-Identifier: Apache-2.0
# libvips reads a PPM of 10 bits (largest value 1023) into 16 bits without scaling: white becomes 1023 of 65535, and a PNG
# of it is nearly black. oiiotool and ffmpeg scale. Exits with 1 if that changes.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
# shellcheck source=findings/lib/packages.bash
source "$(dirname "$0")/lib/packages.bash" "$folder" openimageio-tools=2.4.7.1+dfsg-2 libvips-tools=8.14.1-3+deb12u3 \
    ffmpeg=7:5.1.9-0+deb12u1
echo "oiiotool $(run oiiotool --version); $(run vips --version); $(run ffmpeg -version | head -1 | cut -d' ' -f1-3)"
python3 -c 'import struct, sys
open(sys.argv[1], "wb").write(b"P6\n8 8\n1023\n" + struct.pack(">192H", *[1023] * 192))' "$folder/white.ppm"
run vips copy "$folder/white.ppm" "$folder/vips.png"
run oiiotool "$folder/white.ppm" -o "$folder/oiio.png"
run ffmpeg -v error -y -i "$folder/white.ppm" -pix_fmt rgb48be "$folder/ffmpeg.png"
rc=0
for program in vips oiio ffmpeg; do
    value=$(run oiiotool --stats "$folder/$program.png" | awk '/Stats Max/ {print $3}')
    echo "$program: white of 1023 is $value of 65535"
    case $program in vips) want=1023 ;; *) want=65535 ;; esac
    [ "$value" = $want ] || rc=1
done
exit $rc
