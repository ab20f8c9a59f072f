#!/bin/bash
# SPDX-License-Identifier: Apache-2.0
# oiiotool 2.4 lists looks= among the options of --ociodisplay. With OpenColorIO 2 it has no effect: not with a look of the
# config, and a name that does not exist is no error. --ociolook applies the same look. Exits with 1 if that changes.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
# shellcheck source=findings/lib/packages.bash
source "$(dirname "$0")/lib/packages.bash" "$folder" openimageio-tools=2.4.7.1+dfsg-2
echo "oiiotool $(run oiiotool --version)"
run oiiotool --help | grep -o 'ociodisplay.*looks=' | tr -s ' '
cat >"$folder/config.ocio" <<'Y'
ocio_profile_version: 2
roles: {default: linear, scene_linear: linear}
file_rules:
  - !<Rule> {name: Default, colorspace: default}
displays:
  sRGB:
    - !<View> {name: Film, colorspace: film}
    - !<View> {name: Dim film, colorspace: film, looks: half}
active_displays: []
active_views: []
looks:
  - !<Look> {name: half, process_space: linear, transform: !<MatrixTransform> {matrix: [0.5,0,0,0, 0,0.5,0,0, 0,0,0.5,0, 0,0,0,1]}}
colorspaces:
  - !<ColorSpace> {name: linear, isdata: false, allocation: uniform}
  - !<ColorSpace> {name: film, isdata: false, allocation: uniform, from_scene_reference: !<ExponentTransform> {value: 2, direction: inverse}}
Y
value() { # ACTION...: what 1.0 becomes
    run oiiotool --colorconfig "$folder/config.ocio" --pattern constant:color=1,1,1 4x4 3 --iscolorspace linear "$@" -d float -o "$folder/out.exr"
    run oiiotool --stats "$folder/out.exr" | awk '/Stats Max/ {printf "%.4f", $3}'
}
plain=$(value --ociodisplay sRGB Film) looks=$(value --ociodisplay:looks=half sRGB Film)
missing=$(value --ociodisplay:looks=no_such_look sRGB Film) view=$(value --ociodisplay sRGB "Dim film")
look=$(value --ociolook half --ociodisplay sRGB Film)
echo "no look $plain; looks=half $looks; looks=no_such_look $missing; the look in the view $view; --ociolook $look"
[ "$plain $looks $missing $view $look" = "1.0000 1.0000 1.0000 0.7071 0.7071" ]
