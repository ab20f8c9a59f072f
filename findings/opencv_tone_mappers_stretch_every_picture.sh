#!/bin/bash
# SPDX-License-Identifier: Apache-2.0
# OpenCV's tone mappers stretch every picture from its own smallest to its largest value: a dim gray ramp of 0.1 to 0.2 comes
# out as 0 to 1. That of createTonemap(gamma 1) does, too, which the documents call a linear mapper with gamma correction.
# Frames of a film, or parts of a picture, therefore do not match. Exits with 1 if that changes.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
# shellcheck source=findings/lib/packages.bash
source "$(dirname "$0")/lib/packages.bash" "$folder" python3-opencv=4.6.0+dfsg-12
export PYTHONPATH=${findings_root:?}/usr/lib/python3/dist-packages
cat >"$folder/map.py" <<'P'
import cv2, numpy, sys
ramp = numpy.linspace(0.1, 0.2, 16, dtype=numpy.float32).reshape(4, 4, 1).repeat(3, 2)
print("OpenCV", cv2.__version__)
changed = False
for mapper in cv2.createTonemap(1.0), cv2.createTonemapDrago(1.0), cv2.createTonemapReinhard(1.0, 0.0, 0.0, 0.0), cv2.createTonemapMantiuk(1.0):
    result = mapper.process(ramp.copy())
    print(f"{type(mapper).__name__}: 0.1 to 0.2 is {result.min():.4f} to {result.max():.4f}")
    changed |= abs(result.min()) > 1e-4 or abs(result.max() - 1) > 1e-4  # four digits are shown
sys.exit(int(changed))
P
run python3.11 "$folder/map.py" 2>/dev/null
