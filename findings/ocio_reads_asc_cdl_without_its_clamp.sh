#!/bin/bash
# SPDX-License-Identifier: Apache-2.0
# ASC CDL 1.2 limits the result of slope, offset and power to 0 to 1 (its saturation, too). OpenColorIO 2 reads the same .cc
# file of the ASC without limits, while its ASC_CDL operator in a CLF file has them (style Fwd). A grade shows other colors in
# programs that follow the ASC. Exits with 1 if that changes.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
# shellcheck source=findings/lib/packages.bash
source "$(dirname "$0")/lib/packages.bash" "$folder" opencolorio-tools=2.1.2+dfsg1-4+b3
echo "OpenColorIO 2.1.2"
sop='<SOPNode><Slope>1 1 1</Slope><Offset>0.5 0 -0.5</Offset><Power>1 1 1</Power></SOPNode>'
sat='<SatNode><Saturation>1</Saturation></SatNode>'
echo "<ColorCorrection id=\"look\">$sop$sat</ColorCorrection>" >"$folder/look.cc"
cat >"$folder/look.clf" <<X
<?xml version="1.0" encoding="UTF-8"?>
<ProcessList id="look" compCLFversion="3"><ASC_CDL id="c" inBitDepth="32f" outBitDepth="32f" style="Fwd">$sop$sat</ASC_CDL></ProcessList>
X
cc=$(run ociochecklut "$folder/look.cc" 0.7 0.5 0.2 | tail -1)
clf=$(run ociochecklut "$folder/look.clf" 0.7 0.5 0.2 | tail -1)
echo "0.7 0.5 0.2 with offsets 0.5, 0 and -0.5: .cc $cc; .clf $clf"
[ "$cc; $clf" = "1.2 0.5 -0.3; 1 0.5 0" ]
