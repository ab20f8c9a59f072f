// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>

#include "tonewright/registry.h"
#include "tonewright/view.h"

/// Options of tone mapping, without OpenImageIO. @see tonemap.h
TONEWRIGHT_NAMESPACE_BEGIN

/// The input of a picture whose metadata states its color. @see TonemapOptions::input
inline constexpr std::string_view kAutoInput = "auto";

/// Options of tone mapping. Names of inputs and displays are those of the command line.
struct TonemapOptions {
    /// Treatment of associated color. A curve needs un-premultiplied color.
    enum class Unpremult : unsigned char {
        /// Divides by alpha before and multiplies after, unless `oiio:UnassociatedAlpha` is set.
        /// Emission (point 3 of tonemap()) is not divided.
        automatic,
        /// Divides by alpha before and multiplies after, also emission.
        yes,
        /// Leaves color as it is.
        no,
    };
    /// Source of the parameters that come from a picture (its largest luminance, ...), if neither
    /// the operator's settings nor its preset set them.
    enum class Statistics : unsigned char {
        /// measure_scene(), which takes one more pass. Other operators skip it.
        from_picture,
        /// The defaults, the same for every picture.
        defaults,
    };

    /// The operator with its settings and look: resolve_picture_operator("agx_blender"). Local
    /// operators are accepted (local.h). Its file is not read again.
    ResolvedOperator op = {};
    /// Exposure before the operator, in stops, [-64, 64].
    double exposure_stops = 0;
    /// Color of the source: a name that find_source_color() knows, or `auto`: what the metadata
    /// says, in the order of the picture's format (docs/conventions.md), else the default of the
    /// format. Of a picture without a format, the first of these counts: `oiio:ColorSpace`, unless
    /// it is linear Rec.709; `colorInteropID`; ACES2065-1 if `acesImageContainerFlag` is set;
    /// linear light of `chromaticities`; linear Rec.709.
    std::string input = std::string(kAutoInput);
    /// Display (id, title or alias), or `linear`, or `native`.
    std::string display = "srgb";
    /// Luminance of scene-linear 1.0 in absolute sources (PQ, HLG, cd/m2) and on an HDR display,
    /// cd/m2, [50, 1000]. Other pictures on other displays accept the default only.
    double reference_white = kUnitLuminance;
    /// Units of the source's decoded numbers. Those in cd/m2 are divided by `reference_white`.
    InputUnits input_units = InputUnits::relative;
    /// Share of the operator, [0, 1]: the rest is a plain clamp (operator `clamp`) of the same
    /// view. Both are blended in code values, as a mix node does. Not for local operators and
    /// `native`.
    double mix = 1;
    Unpremult unpremult = Unpremult::automatic;
    /// Dithers 8-bit files by half a code value: sets `oiio:dither`, which OIIO's writers follow.
    bool dither = false;
    Statistics statistics = Statistics::from_picture;
};

TONEWRIGHT_NAMESPACE_END
