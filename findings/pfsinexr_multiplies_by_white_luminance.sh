#!/bin/bash
# SPDX-License-Identifier: Apache-2.0
# The attribute whiteLuminance of OpenEXR states the luminance of RGB 1, 1, 1 in cd/m2. pfsinexr multiplies all pixels by it, so
# a file with a value of 100 is 100 times as bright as in OpenImageIO and libvips, and as the same pixels without it. Exits with
# 1 if that changes.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
# shellcheck source=findings/lib/packages.bash
source "$(dirname "$0")/lib/packages.bash" "$folder" pfstools=2.2.0-5+b1 openimageio-tools=2.4.7.1+dfsg-2 \
    libvips-tools=8.14.1-3+deb12u3
echo "pfstools 2.2.0; oiiotool $(run oiiotool --version); $(run vips --version)"
PYTHONPATH=$(dirname "$0")/lib PYTHONDONTWRITEBYTECODE=1 python3 - "$folder" <<'P'
import struct, sys, exr
gray = {name: (exr.HALF, 0.5) for name in "RGB"}
exr.write(f"{sys.argv[1]}/plain.exr", gray, (0, 0, 7, 7))
exr.write(f"{sys.argv[1]}/white.exr", gray, (0, 0, 7, 7), more=exr.attribute("whiteLuminance", "float", struct.pack("<f", 100)))
P
rc=0
for name in plain white; do
    file=$folder/$name.exr
    run pfsinexr "$file" | run pfsoutpfm "$folder/out.pfm"
    pfs=$(tail -c 4 "$folder/out.pfm" | od -An -tf4 | awk '{printf "%.2f", $1}')
    oiio=$(run oiiotool --stats "$file" | awk '/Stats Max/ {printf "%.2f", $3}')
    vips=$(run vips getpoint "$file" 0 0 | awk '{printf "%.2f", $1}')
    echo "$name: pfsinexr $pfs; oiiotool $oiio; libvips $vips"
    case $name in plain) want="0.50 0.50 0.50" ;; *) want="50.00 0.50 0.50" ;; esac
    [ "$pfs $oiio $vips" = "$want" ] || rc=1
done
exit $rc
