#!/bin/bash
# SPDX-License-Identifier: Apache-2.0
# TIFF 6.0 and its technical notes have half floats: 16 bits a sample and SampleFormat 3. G'MIC and netpbm look at the size
# only, and read the bits as whole numbers, without a message: 0.25, 0.5, 1.0 become 13312, 14336, 15360. oiiotool reads the
# numbers. Exits with 1 if that changes.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
# shellcheck source=findings/lib/packages.bash
source "$(dirname "$0")/lib/packages.bash" "$folder" gmic=2.9.4-4+b4 netpbm=2:11.01.00-2 openimageio-tools=2.4.7.1+dfsg-2
echo "oiiotool $(run oiiotool --version); gmic $(run gmic -v - version 2>&1 | grep -oE '[0-9]+\.[0-9]+\.[0-9]+' | head -1);" \
    "$(run tifftopnm --version 2>&1 | grep -oE 'Netpbm [0-9.]+')"
python3 - "$folder/in.tif" <<'P'
import struct, sys
data = struct.pack("<3e", 0.25, 0.5, 1.0) * 16
tags = [(256, 3, 1, 4), (257, 3, 1, 4), (258, 3, 3, "bits"), (259, 3, 1, 1), (262, 3, 1, 2), (273, 4, 1, "data"), (277, 3, 1, 3),
        (278, 3, 1, 4), (279, 4, 1, len(data)), (339, 3, 3, "formats")]
end = 8 + 2 + 12 * len(tags) + 4
place = {"bits": end, "formats": end + 6, "data": end + 12}
ifd = b"".join(struct.pack("<HHII", tag, kind, count, place.get(value, value)) for tag, kind, count, value in tags)
open(sys.argv[1], "wb").write(struct.pack("<2sHIH", b"II", 42, 8, len(tags)) + ifd + bytes(4) + struct.pack("<6H", 16, 16, 16, 3, 3, 3) + data)
P
oiio=$(run oiiotool --dumpdata "$folder/in.tif" | awk '/Pixel \(0, 0\)/ {print $4 + 0, $5 + 0, $6 + 0}')
gmic=$(run gmic -v - "$folder/in.tif" echo_stdout "{I(0,0,0,0)}" | tail -1 | tr , " ")
netpbm=$(run tifftopnm "$folder/in.tif" 2>/dev/null | tail -c 6 | od -An -tu2 --endian=big | awk '{print $1, $2, $3}')
echo "oiiotool $oiio; G'MIC $gmic; netpbm $netpbm"
[ "$oiio; $gmic; $netpbm" = "0.25 0.5 1; 13312 14336 15360; 13312 14336 15360" ]
