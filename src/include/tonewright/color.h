// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <string_view>

#include "tonewright/expr.h"

TONEWRIGHT_NAMESPACE_BEGIN

using Vector3 = std::array<double, 3>;
/// Row-major; acts on column vectors: y = M x.
using Matrix3 = std::array<std::array<double, 3>, 3>;

inline constexpr Matrix3 kIdentity3 = {{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};

[[nodiscard]] TONEWRIGHT_API Matrix3 multiply(const Matrix3& a, const Matrix3& b) noexcept;
[[nodiscard]] TONEWRIGHT_API Vector3 multiply(const Matrix3& m, const Vector3& v) noexcept;
[[nodiscard]] TONEWRIGHT_API Matrix3 scale(const Matrix3& m, double factor) noexcept;
/// @throws Error  the determinant is 0
[[nodiscard]] TONEWRIGHT_API Matrix3 inverse(const Matrix3& m);

/// CIE 1931 chromaticity.
struct Chromaticity {
    double x;
    double y;
    friend constexpr bool operator==(const Chromaticity& a, const Chromaticity& b) {
        return a.x == b.x && a.y == b.y;
    }
};

/// Chromaticities of red, green, blue and the whitepoint.
struct Primaries {
    std::string_view name;
    Chromaticity red, green, blue, whitepoint;
    friend bool operator==(const Primaries& a, const Primaries& b) {
        return a.red == b.red && a.green == b.green && a.blue == b.blue &&
               a.whitepoint == b.whitepoint;
    }
};

inline constexpr Chromaticity kD65 = {0.3127, 0.3290};          // ITU-R BT.709-6, table 1
inline constexpr Chromaticity kAcesWhite = {0.32168, 0.33767};  // SMPTE ST 2065-1, "D60"
/// ITU-R BT.709-6; also IEC 61966-2-1 (sRGB).
inline constexpr Primaries kRec709 = {"Rec.709", {0.64, 0.33}, {0.30, 0.60}, {0.15, 0.06}, kD65};
/// ITU-R BT.2020-2, table 3.
inline constexpr Primaries kRec2020 = {
    "Rec.2020", {0.708, 0.292}, {0.170, 0.797}, {0.131, 0.046}, kD65};
/// SMPTE EG 432-1 primaries with the D65 whitepoint (Display P3).
inline constexpr Primaries kP3D65 = {
    "P3-D65", {0.680, 0.320}, {0.265, 0.690}, {0.150, 0.060}, kD65};
/// SMPTE ST 2065-1 (ACES2065-1).
inline constexpr Primaries kAP0 = {
    "AP0", {0.7347, 0.2653}, {0.0, 1.0}, {0.0001, -0.0770}, kAcesWhite};
/// Academy S-2014-004 (ACEScg).
inline constexpr Primaries kAP1 = {
    "AP1", {0.713, 0.293}, {0.165, 0.830}, {0.128, 0.044}, kAcesWhite};
/// FilmLight E-Gamut, white paper "T-CAM and T-Log / E-Gamut", D65.
inline constexpr Primaries kEGamut = {
    "FilmLight E-Gamut", {0.8, 0.3177}, {0.18, 0.9}, {0.065, -0.0805}, kD65};

/// Adobe RGB (1998) Color Image Encoding, 2005, section 4.3.1.
inline constexpr Primaries kAdobeRgb = {
    "Adobe RGB", {0.64, 0.33}, {0.21, 0.71}, {0.15, 0.06}, kD65};

/// ARRI, "ALEXA Log C Curve, Usage in VFX", 2017: Wide Gamut 3.
inline constexpr Primaries kArriWideGamut3 = {
    "ARRI Wide Gamut 3", {0.6840, 0.3130}, {0.2210, 0.8480}, {0.0861, -0.1020}, kD65};
/// ARRI, "LogC4 Logarithmic Color Space, Specification", 2022: Wide Gamut 4.
inline constexpr Primaries kArriWideGamut4 = {
    "ARRI Wide Gamut 4", {0.7347, 0.2653}, {0.1424, 0.8576}, {0.0991, -0.0308}, kD65};
/// Sony, "Technical Summary for S-Gamut3.Cine/S-Log3 and S-Gamut3/S-Log3".
inline constexpr Primaries kSGamut3 = {
    "S-Gamut3", {0.730, 0.280}, {0.140, 0.855}, {0.100, -0.050}, kD65};
inline constexpr Primaries kSGamut3Cine = {
    "S-Gamut3.Cine", {0.766, 0.275}, {0.225, 0.800}, {0.089, -0.087}, kD65};
/// Blackmagic Design, "DaVinci Resolve 17 Wide Gamut Intermediate", 2021.
inline constexpr Primaries kDaVinciWideGamut = {
    "DaVinci Wide Gamut", {0.8000, 0.3130}, {0.1682, 0.9877}, {0.0790, -0.1155}, kD65};

/// Canon, "Canon Log Gamma Curves", 2018: Cinema Gamut.
inline constexpr Primaries kCinemaGamut = {
    "Cinema Gamut", {0.7400, 0.2700}, {0.1700, 1.1400}, {0.0800, -0.1000}, kD65};
/// Panasonic, "V-Log/V-Gamut Reference Manual", 2014.
inline constexpr Primaries kVGamut = {
    "V-Gamut", {0.730, 0.280}, {0.165, 0.840}, {0.100, -0.030}, kD65};
/// RED, "White Paper on REDWideGamutRGB and Log3G10", 2017.
inline constexpr Primaries kRedWideGamutRgb = {
    "REDWideGamutRGB", {0.780308, 0.304253}, {0.121595, 1.493994}, {0.095612, -0.084589}, kD65};

/// XYZ of a chromaticity with Y = 1.
[[nodiscard]] TONEWRIGHT_API Vector3 xyz_of(Chromaticity xy) noexcept;

/// Linear RGB with white (1,1,1) -> CIE XYZ of the same white with Y = 1 (SMPTE RP 177:1993). A
/// primary may have y = 0, like X and Z.
/// @throws Error  the primaries lie on one line
[[nodiscard]] TONEWRIGHT_API Matrix3 rgb_to_xyz(const Primaries& primaries);

/// Bradford chromatic adaptation of XYZ from one white to another (Lam 1985; ICC.1:2010 annex E).
[[nodiscard]] TONEWRIGHT_API Matrix3 bradford_adaptation(Chromaticity from, Chromaticity to);

/// Linear RGB -> linear RGB, with Bradford adaptation if the whites differ; rows sum to 1. Gamuts
/// of ARRI and Sony go through ACES2065-1 by their makers' matrices, which adapt white by CAT02. An
/// OpenColorIO config gives the same light for their logs.
[[nodiscard]] TONEWRIGHT_API Matrix3 rgb_to_rgb(const Primaries& from, const Primaries& to);

/// Linear RGB -> CIE XYZ under D65 (with Bradford adaptation if the white differs; see
/// rgb_to_rgb()).
[[nodiscard]] TONEWRIGHT_API Matrix3 rgb_to_xyz_d65(const Primaries& primaries);

/// Weights of relative luminance for Rec.709, as code and papers print them (ITU-R BT.709-6, item
/// 3.2). Derived from the primaries, they would be 0.2126390, 0.7151687, 0.0721923.
inline constexpr Vector3 kRec709Weights = {0.2126, 0.7152, 0.0722};

// ---------------------------------------------------------------------------------------------
// Transfer functions, as expressions of input 0. `encode` gives code values, `decode` light.

/// IEC 61966-2-1:1999 display light -> code value: 12.92 L up to 0.0031308, then
/// 1.055 L^(1/2.4) - 0.055. Negatives follow the straight part. Domain (-inf, inf).
[[nodiscard]] TONEWRIGHT_API Expr srgb_encode(const Expr& linear);
/// IEC 61966-2-1:1999 code value -> display light; threshold 0.04045.
[[nodiscard]] TONEWRIGHT_API Expr srgb_decode(const Expr& code);

/// max(L, 0)^(1/exponent): display light -> code value of a pure power display.
[[nodiscard]] TONEWRIGHT_API Expr power_encode(const Expr& linear, double exponent);
/// max(c, 0)^exponent.
[[nodiscard]] TONEWRIGHT_API Expr power_decode(const Expr& code, double exponent);

/// ITU-R BT.1886 with black at 0: the 2.4 power. Display light (1 = peak) -> code value.
[[nodiscard]] TONEWRIGHT_API Expr bt1886_encode(const Expr& linear);
[[nodiscard]] TONEWRIGHT_API Expr bt1886_decode(const Expr& code);

/// Inverse of ITU-R BT.709-6, item 1.2: code value of a camera -> scene light. Negatives follow the
/// straight part.
[[nodiscard]] TONEWRIGHT_API Expr bt709_inverse_oetf(const Expr& code);

// Further code values of ITU-T H.273 (07/2021), table 3, as light of a display.

/// SMPTE 240M (1999), the transfer characteristic of its reference reproducer. Negatives follow the
/// straight part.
[[nodiscard]] TONEWRIGHT_API Expr smpte_240m_decode(const Expr& code);
/// IEC 61966-2-4 (xvYCC) on a display of ITU-R BT.1886: its 2.4 power. Negatives mirror.
[[nodiscard]] TONEWRIGHT_API Expr xvycc_decode(const Expr& code);
/// ITU-R BT.1361, extended gamut, on a display of ITU-R BT.1886. Negatives mirror at a quarter of
/// the scale.
[[nodiscard]] TONEWRIGHT_API Expr bt1361_decode(const Expr& code);
/// Logarithmic: 10^(decades (c - 1)). Code 0 and below are 10^-decades, the largest light of that
/// code, so that the curve has no jump.
[[nodiscard]] TONEWRIGHT_API Expr log_range_decode(const Expr& code, double decades);
/// SMPTE ST 428-1: 52.37/48 c^2.6, where 1.0 is the reference white of 48 cd/m2.
[[nodiscard]] TONEWRIGHT_API Expr st428_decode(const Expr& code);

/// SMPTE ST 2084:2014 inverse EOTF: luminance in cd/m2 [0, 10000] -> code value [0, 1].
/// Negatives mirror.
[[nodiscard]] TONEWRIGHT_API Expr pq_encode_nits(const Expr& nits);
/// SMPTE ST 2084:2014 EOTF: code value -> cd/m2.
[[nodiscard]] TONEWRIGHT_API Expr pq_decode_nits(const Expr& code);

/// ITU-R BT.2100-2 table 5, HLG OETF: scene light [0, 1] -> code value [0, 1]. Negatives mirror.
[[nodiscard]] TONEWRIGHT_API Expr hlg_oetf(const Expr& scene_linear);
/// Its inverse.
[[nodiscard]] TONEWRIGHT_API Expr hlg_inverse_oetf(const Expr& code);

/// ITU-R BT.2100-2 table 5, HLG inverse OOTF of a display of 1000 cd/m2 (gamma 1.2): luminance of
/// display light (1 = peak) -> scene luminance L^(1/1.2). Below 1e-4/3^1.2 it is a straight line,
/// as in OpenColorIO's DISPLAY - CIE-XYZ-D65_to_REC.2100-HLG-1000nit, because the power is
/// infinitely steep at black.
[[nodiscard]] TONEWRIGHT_API Expr hlg_inverse_ootf_luminance(const Expr& display_luminance);
/// Its inverse, the OOTF: scene luminance -> display luminance.
[[nodiscard]] TONEWRIGHT_API Expr hlg_ootf_luminance(const Expr& scene_luminance);

/// Academy S-2016-001, ACEScct: AP1 scene-linear -> log code value. 1 is 222.86 scene-linear.
[[nodiscard]] TONEWRIGHT_API Expr acescct_encode(const Expr& linear);
/// Its inverse, without the standard's clamp at 65504.
[[nodiscard]] TONEWRIGHT_API Expr acescct_decode(const Expr& code);

/// Academy S-2014-003, ACEScc: log code value -> AP1 scene-linear, without the standard's clamp at
/// 65504.
[[nodiscard]] TONEWRIGHT_API Expr acescc_decode(const Expr& code);

// Scene-linear light -> log code value of cameras and grading systems, and the inverses. Below the
// toe they continue as straight lines.

/// ARRI LogC3 of exposure index 800, scene exposure: "ALEXA Log C Curve, Usage in VFX", 2017.
[[nodiscard]] TONEWRIGHT_API Expr arri_logc3_encode(const Expr& linear);
[[nodiscard]] TONEWRIGHT_API Expr arri_logc3_decode(const Expr& code);
/// "LogC4 Logarithmic Color Space, Specification", 2022.
[[nodiscard]] TONEWRIGHT_API Expr arri_logc4_encode(const Expr& linear);
[[nodiscard]] TONEWRIGHT_API Expr arri_logc4_decode(const Expr& code);
/// Sony, "Technical Summary for S-Gamut3.Cine/S-Log3 and S-Gamut3/S-Log3".
[[nodiscard]] TONEWRIGHT_API Expr sony_slog3_encode(const Expr& linear);
[[nodiscard]] TONEWRIGHT_API Expr sony_slog3_decode(const Expr& code);
/// Blackmagic Design, "DaVinci Resolve 17 Wide Gamut Intermediate", 2021.
[[nodiscard]] TONEWRIGHT_API Expr davinci_intermediate_encode(const Expr& linear);
[[nodiscard]] TONEWRIGHT_API Expr davinci_intermediate_decode(const Expr& code);
/// Canon, "Canon Log Gamma Curves", 2018: Canon Log 2 and Canon Log 3. The paper's formula has 1.0
/// at a reflectance of 90 %, so that its result counts 0.9. Codes below black mirror.
[[nodiscard]] TONEWRIGHT_API Expr canon_log2_decode(const Expr& code);
[[nodiscard]] TONEWRIGHT_API Expr canon_log3_decode(const Expr& code);
/// Panasonic, "V-Log/V-Gamut Reference Manual", 2014.
[[nodiscard]] TONEWRIGHT_API Expr panasonic_vlog_decode(const Expr& code);
/// RED, "White Paper on REDWideGamutRGB and Log3G10", 2017.
[[nodiscard]] TONEWRIGHT_API Expr red_log3g10_decode(const Expr& code);
/// Kodak, "Conversion of 10-bit Log Film Data To 8-bit Linear or Video Data for The Cineon Digital
/// Film System", 1995: 0.002 density a code, film gamma 0.6, black at code 95 of 1023 and white at
/// 685. REDlogFilm is the same curve.
[[nodiscard]] TONEWRIGHT_API Expr cineon_decode(const Expr& code);
/// Unity's LogC: ALEXA's for EI 1000, without the toe. Core render pipeline, Color.hlsl,
/// LinearToLogC.
[[nodiscard]] TONEWRIGHT_API Expr unity_logc_encode(const Expr& linear);
[[nodiscard]] TONEWRIGHT_API Expr unity_logc_decode(const Expr& code);
/// Unreal Engine, TonemapCommon.ush, LinToLog: 14 stops, gray 0.18 at code 444 of 1023. Clamped at
/// code 0.
[[nodiscard]] TONEWRIGHT_API Expr unreal_log_encode(const Expr& linear);
[[nodiscard]] TONEWRIGHT_API Expr unreal_log_decode(const Expr& code);

TONEWRIGHT_NAMESPACE_END
