#!/bin/bash
# SPDX-License-Identifier: Apache-2.0
# heif-convert writes AVIF and HEIF of 10 and 12 bits as 16-bit PNG by shifting the bits, so white is 65472 and 65520 of 65535:
# PNG says that 65535 is white, and recommends scaling. avifdec scales. Exits with 1 if that changes.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
# shellcheck source=findings/lib/packages.bash
source "$(dirname "$0")/lib/packages.bash" "$folder" libheif-examples=1.15.1-1+deb12u1 libavif-bin=0.11.1-1+deb12u1 \
    libvips-tools=8.14.1-3+deb12u3
echo "heif-convert 1.15.1; $(run avifenc --version | head -1); $(run vips --version)"
python3 -c 'import struct, sys, zlib
chunk = lambda kind, data: struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))
open(sys.argv[1], "wb").write(b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", struct.pack(">IIBBBBB", 64, 64, 16, 2, 0, 0, 0))
    + chunk(b"IDAT", zlib.compress((b"\0" + b"\xff" * 384) * 64)) + chunk(b"IEND", b""))' "$folder/white.png"
rc=0
for depth in 10 12; do
    run avifenc --min 0 --max 0 -d $depth -y 444 -r full "$folder/white.png" "$folder/in.avif" >/dev/null 2>&1
    run heif-convert "$folder/in.avif" "$folder/heif.png" >/dev/null
    run avifdec -d 16 "$folder/in.avif" "$folder/avif.png" >/dev/null
    heif=$(run vips getpoint "$folder/heif.png" 32 32 | cut -d' ' -f1) avif=$(run vips getpoint "$folder/avif.png" 32 32 | cut -d' ' -f1)
    echo "white of $depth bits: heif-convert $heif; avifdec $avif"
    case $depth in 10) want="65472 65535" ;; *) want="65520 65535" ;; esac
    [ "$heif $avif" = "$want" ] || rc=1
done
exit $rc
