#!/bin/bash
# SPDX-License-Identifier: Apache-2.0
# The size line of a Radiance picture, such as "-Y 16 +X 16", says in which order its rows and columns are. "+Y 16 +X 16" begins
# with the bottom row (Radiance file formats). libvips, pfstools and ImageMagick read it without an error and show it upside
# down; oiiotool notes an orientation, which --reorient applies. Exits with 1 if that changes.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
# shellcheck source=findings/lib/packages.bash
source "$(dirname "$0")/lib/packages.bash" "$folder" openimageio-tools=2.4.7.1+dfsg-2 libvips-tools=8.14.1-3+deb12u3 \
    pfstools=2.2.0-5+b1 imagemagick-6.q16hdri=8:6.9.11.60+dfsg-1.6+deb12u15
magick=${findings_root:?}/usr/lib/x86_64-linux-gnu/ImageMagick-6.9.11
export MAGICK_CODER_MODULE_PATH=$magick/modules-Q16HDRI/coders MAGICK_CONFIGURE_PATH=$magick/config-Q16HDRI:$findings_root/etc/ImageMagick-6
echo "oiiotool $(run oiiotool --version); $(run vips --version); pfstools 2.2.0;" \
    "$(run convert-im6.q16hdri -version | sed -n '1s/ https.*//p')"
# The upper half is 1.0, the lower half 0.25.
python3 - "$folder" <<'P'
import sys
rows = [bytes([128, 128, 128, 129]) * 16] * 8 + [bytes([128, 128, 128, 127]) * 16] * 8
for name, size, order in (("minus", "-Y 16 +X 16", rows), ("plus", "+Y 16 +X 16", rows[::-1])):
    open(f"{sys.argv[1]}/{name}.hdr", "wb").write(f"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n{size}\n".encode() + b"".join(order))
P
rc=0
for name in minus plus; do
    file=$folder/$name.hdr
    run vips rad2float "$file" "$folder/vips.v"
    vips=$(run vips getpoint "$folder/vips.v" 0 0 | awk '{printf "%.2f", $1}')
    run pfsinrgbe "$file" | run pfsoutpfm "$folder/pfs.pfm"
    pfs=$(tail -c 4 "$folder/pfs.pfm" | od -An -tf4 | awk '{printf "%.2f", $1}')  # the last row of a PFM is the top
    magick=$(run convert-im6.q16hdri "$file" -format '%[fx:p{0,0}.r]' info: | awk '{printf "%.2f", $1}')
    run oiiotool "$file" --reorient -o "$folder/oiio.exr"
    oiio=$(run oiiotool --dumpdata "$folder/oiio.exr" | awk '/Pixel \(0, 0\)/ {printf "%.2f", $4}')
    echo "$name Y, pixel at the top: libvips $vips; pfstools $pfs; ImageMagick $magick; oiiotool --reorient $oiio"
    case $name in minus) want="1.00 1.00 1.00 1.00" ;; *) want="0.25 0.25 0.25 1.00" ;; esac
    [ "$vips $pfs $magick $oiio" = "$want" ] || rc=1
done
exit $rc
