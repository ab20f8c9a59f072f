#!/bin/bash
# SPDX-License-Identifier: Apache-2.0
# Adobe's .cube specification has DOMAIN_MIN and DOMAIN_MAX: which inputs the first and the last node stand for. With an
# identity table of 0 to 0.5, OpenColorIO gives 0.5 for 0.25; ffmpeg ignores a domain shorter than 1 and gives 0.25; G'MIC
# scales the table itself, so its white is 510 of 255. Exits with 1 if that changes.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
# shellcheck source=findings/lib/packages.bash
source "$(dirname "$0")/lib/packages.bash" "$folder" opencolorio-tools=2.1.2+dfsg1-4+b3 ffmpeg=7:5.1.9-0+deb12u1 gmic=2.9.4-4+b4
echo "OpenColorIO 2.1.2; $(run ffmpeg -version | head -1 | cut -d' ' -f1-3);" \
    "gmic $(run gmic -v - version 2>&1 | grep -oE '[0-9]+\.[0-9]+\.[0-9]+' | head -1)"
python3 - "$folder" <<'P'
import itertools, struct, sys
nodes = "".join("%d %d %d\n" % node[::-1] for node in itertools.product((0, 1), repeat=3))
for name, domain in (("whole", 1), ("half", 0.5)):
    open(f"{sys.argv[1]}/{name}.cube", "w").write(f"DOMAIN_MIN 0 0 0\nDOMAIN_MAX {domain} {domain} {domain}\nLUT_3D_SIZE 2\n{nodes}")
open(f"{sys.argv[1]}/in.pfm", "wb").write(b"PF\n8 8\n-1.0\n" + struct.pack("<192f", *[0.25] * 192))
P
rc=0
for name in whole half; do
    ocio=$(run ociochecklut "$folder/$name.cube" 0.25 0.25 0.25 | tail -1 | cut -d' ' -f1)
    run ffmpeg -v error -y -i "$folder/in.pfm" -vf "lut3d=$folder/$name.cube" -pix_fmt gbrpf32le -f rawvideo "$folder/out.raw"
    ffmpeg=$(head -c 4 "$folder/out.raw" | od -An -tf4 | tr -d ' ')
    gmic=$(run gmic -v - "$folder/$name.cube" echo_stdout "{iM}" | tail -1)
    echo "$name: 0.25 is $ocio in OpenColorIO and $ffmpeg in ffmpeg; the white of the table in G'MIC is $gmic"
    case $name in whole) want="0.25 0.25 255" ;; *) want="0.5 0.25 510" ;; esac
    [ "$ocio $ffmpeg $gmic" = "$want" ] || rc=1
done
exit $rc
