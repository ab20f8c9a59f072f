#!/bin/bash
# SPDX-License-Identifier: Apache-2.0
# oiiotool writes an OpenEXR picture of one channel in ZIP where DWAA is asked for, and says nothing: a mask or a depth is
# several times as large as its user planned. A copy of a DWAA file does not keep its level either: 1000 becomes 45, OpenEXR's
# default. Exits with 1 if that changes.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
# shellcheck source=findings/lib/packages.bash
source "$(dirname "$0")/lib/packages.bash" "$folder" openimageio-tools=2.4.7.1+dfsg-2
echo "oiiotool $(run oiiotool --version)"
said() { run iinfo -v "$1" | awk -F': ' '/^ *compression:/ {gsub("\"", "", $2); printf "%s", $2} /dwaCompressionLevel/ {printf " %s", $2}'; }
run oiiotool --pattern noise:seed=1 64x64 1 --chnames Y -d half --compression dwaa -o "$folder/gray.exr"
run oiiotool --pattern noise:seed=1 64x64 3 -d half --compression dwaa -o "$folder/color.exr"
run oiiotool --pattern noise:seed=1 64x64 3 -d half --compression dwaa:1000 -o "$folder/level.exr"
run oiiotool "$folder/level.exr" -o "$folder/copy.exr"
gray=$(said "$folder/gray.exr")
color=$(said "$folder/color.exr")
level=$(said "$folder/level.exr")
copy=$(said "$folder/copy.exr")
echo "--compression dwaa: one channel $gray, three channels $color"
echo "--compression dwaa:1000: $level; its copy: $copy"
[ "$gray, $color, $level, $copy" = "zip, dwaa 45, dwaa 1000, dwaa 45" ]
