#!/bin/bash
# SPDX-License-Identifier: Apache-2.0
# PFM holds linear light in HDR programs (Debevec); pfstools write it from a Radiance picture without an encoding. cjxl 0.7
# takes its numbers for sRGB code values, and says so in the JPEG XL file. Light of 0.5 then has the code value 0.5
# instead of 0.735. Exits with 1 if that changes.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
# shellcheck source=findings/lib/packages.bash
source "$(dirname "$0")/lib/packages.bash" "$folder" libjxl-tools=0.7.0-10+deb12u1 pfstools=2.2.0-5+b1 \
    libvips-tools=8.14.1-3+deb12u3
echo "$(run cjxl --version | head -1); pfstools 2.2.0; $(run vips --version)"
python3 -c 'import sys
open(sys.argv[1], "wb").write(b"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 64 +X 64\n" + bytes([128, 128, 128, 128]) * 4096)' "$folder/in.hdr"
run pfsinrgbe "$folder/in.hdr" | run pfsoutpfm "$folder/in.pfm"
light=$(tail -c 4 "$folder/in.pfm" | od -An -tf4 | awk '{printf "%.3f", $1}')
run cjxl "$folder/in.pfm" "$folder/out.jxl" -d 0 2>/dev/null
says=$(run jxlinfo "$folder/out.jxl" | grep -oE '[A-Za-z]+ transfer function')
run djxl "$folder/out.jxl" "$folder/out.png" --bits_per_sample=16 2>/dev/null
level=$(run vips getpoint "$folder/out.png" 32 32 | awk '{printf "%.3f", $1 / 65535}')
echo "Radiance 0.5 is $light in the PFM; jxlinfo says $says, and the code value is $level"
[ "$light; $says; $level" = "0.500; sRGB transfer function; 0.500" ]
