#!/bin/bash
# SPDX-License-Identifier: Apache-2.0
# A PNG with gAMA 1.0 and no other color chunk has linear samples (PNG specification). ImageMagick encodes 128 as 188, and cjxl
# tags the JPEG XL file as linear. avifenc tags the AVIF file as sRGB, and libvips and GraphicsMagick copy 128: they show a much
# darker picture. Exits with 1 if that changes.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
# shellcheck source=findings/lib/packages.bash
source "$(dirname "$0")/lib/packages.bash" "$folder" imagemagick-6.q16hdri=8:6.9.11.60+dfsg-1.6+deb12u15 \
    graphicsmagick=1.4+really1.3.40-4+deb12u1 libvips-tools=8.14.1-3+deb12u3 libjxl-tools=0.7.0-10+deb12u1 \
    libavif-bin=0.11.1-1+deb12u1
magick=${findings_root:?}/usr/lib/x86_64-linux-gnu/ImageMagick-6.9.11
export MAGICK_CODER_MODULE_PATH=$magick/modules-Q16HDRI/coders MAGICK_CONFIGURE_PATH=$magick/config-Q16HDRI:$findings_root/etc/ImageMagick-6
echo "$(run convert-im6.q16hdri -version | sed -n '1s/ https.*//p'); $(run gm version | head -1 | cut -d' ' -f1-2); $(run vips --version);" \
    "$(run cjxl --version | head -1); $(run avifenc --version | head -1)"
python3 -c 'import struct, sys, zlib
chunk = lambda kind, data: struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))
open(sys.argv[1], "wb").write(b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", struct.pack(">IIBBBBB", 64, 64, 8, 2, 0, 0, 0))
    + chunk(b"gAMA", struct.pack(">I", 100000)) + chunk(b"IDAT", zlib.compress((b"\0" + b"\x80" * 192) * 64)) + chunk(b"IEND", b""))' "$folder/in.png"
last() { tail -c 1 "$1" | od -An -tu1 | tr -d ' '; }
run convert-im6.q16hdri "$folder/in.png" -depth 8 "$folder/magick.ppm"
run gm convert "$folder/in.png" "$folder/gm.ppm"
run vips copy "$folder/in.png" "$folder/vips.ppm"
run cjxl "$folder/in.png" "$folder/out.jxl" -d 0 2>/dev/null
jxl=$(run jxlinfo "$folder/out.jxl" | grep -oE '[A-Za-z]+ transfer function')
run avifenc -l "$folder/in.png" "$folder/out.avif" >/dev/null 2>&1
avif=$(run avifdec --info "$folder/out.avif" | awk '/Transfer Char/ {print $NF}')
seen="$(last "$folder/magick.ppm") $(last "$folder/gm.ppm") $(last "$folder/vips.ppm"); $jxl; $avif"
echo "ImageMagick, GraphicsMagick, libvips; cjxl; avifenc (13 is sRGB, 8 is linear): $seen"
[ "$seen" = "188 128 128; Linear transfer function; 13" ]
