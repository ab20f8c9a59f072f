// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "tonewright/ocio.h"

TONEWRIGHT_NAMESPACE_BEGIN

/// A config with comments and an order of its own, which must stay.
inline const std::string kOwn = R"(ocio_profile_version: 2.1
# Of a studio.
search_path: luts
roles: {scene_linear: lin, default: lin, aces_interchange: aces, cie_xyz_d65_interchange: xyz, data: raw}
file_rules:
  - !<Rule> {name: Default, colorspace: lin}
displays:
  sRGB:
    - !<View> {name: Raw, colorspace: raw}   # the first
    - !<View> {name: Plain, view_transform: plain, display_colorspace: sRGB}
view_transforms:
  - !<ViewTransform>
    name: plain
    from_scene_reference: !<RangeTransform> {min_in_value: 0, min_out_value: 0, max_in_value: 1, max_out_value: 1}
display_colorspaces:
  - !<ColorSpace> {name: xyz, encoding: display-linear}
  - !<ColorSpace> {name: sRGB, encoding: sdr-video, from_display_reference: !<BuiltinTransform> {style: DISPLAY - CIE-XYZ-D65_to_sRGB}}
colorspaces:
  - !<ColorSpace> {name: lin, encoding: scene-linear, to_scene_reference: !<BuiltinTransform> {style: ACEScg_to_ACES2065-1}}
  - !<ColorSpace> {name: aces, encoding: scene-linear}
  - !<ColorSpace> {name: raw, isdata: true, encoding: data}
)";

inline ConfigOptions hable_view() {
    ConfigOptions options;
    options.views = {"hable"};
    return options;
}

TONEWRIGHT_NAMESPACE_END
