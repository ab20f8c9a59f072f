#!/bin/bash
# SPDX-License-Identifier: Apache-2.0
# ffmpeg's haldclut with an identity picture leaves packed RGB as it is. With planar RGB of whole numbers in both inputs, such
# as gbrp and gbrp16le, it gives green for red, blue for green and red for blue; gbrpf32le is right. Exits with 1 if that
# changes.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
# shellcheck source=findings/lib/packages.bash
source "$(dirname "$0")/lib/packages.bash" "$folder" ffmpeg=7:5.1.9-0+deb12u1
run ffmpeg -version | head -1 | cut -d' ' -f1-3
python3 -c 'import sys
open(sys.argv[1], "wb").write(b"P6\n8 8\n255\n" + bytes([200, 100, 50]) * 64)' "$folder/in.ppm"
run ffmpeg -v error -y -f lavfi -i haldclutsrc=level=4 -frames:v 1 -pix_fmt rgb24 "$folder/hald.ppm"
rc=0
for format in rgb24 gbrp gbrp16le gbrpf32le; do
    run ffmpeg -v error -y -i "$folder/in.ppm" -i "$folder/hald.ppm" \
        -lavfi "[0]format=${format}[a];[1]format=${format}[b];[a][b]haldclut" -f rawvideo -pix_fmt rgb24 "$folder/out.raw"
    seen=$(head -c 3 "$folder/out.raw" | od -An -tu1 | awk '{print $1, $2, $3}')
    echo "200 100 50 in $format: $seen"
    # Results are cut to whole numbers, so 200 may be 199.
    case $format in rgb24) want="200 100 50" ;; gbrp) want="100 50 200" ;; gbrp16le) want="100 50 199" ;; *) want="199 100 50" ;; esac
    [ "$seen" = "$want" ] || rc=1
done
exit $rc
