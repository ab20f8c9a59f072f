// SPDX-License-Identifier: Apache-2.0
#include "pipeline/encoded_spaces.h"

#include <array>
#include <cmath>

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

/// ARRI, "LogC4 Logarithmic Color Space, Specification", 2022, section 4.1.
LogCurve arri_logc4() {
    const double a = (std::exp2(18) - 16) / 117.45;
    const double b = (1023.0 - 95) / 1023;
    const double c = 95.0 / 1023;
    LogCurve curve;
    curve.log_slope = b / 14;
    curve.log_offset = c - 6 * b / 14;
    curve.linear_slope = a;
    curve.linear_offset = 64;
    curve.linear_break = (std::exp2(14 * (-c / b) + 6) - 64) / a;
    return curve;
}

/// Blackmagic Design, "DaVinci Resolve 17 Wide Gamut Intermediate", 2021.
LogCurve davinci_intermediate() {
    constexpr double kB = 7;
    constexpr double kC = 0.07329248;
    LogCurve curve;
    curve.log_slope = kC;
    curve.log_offset = kB * kC;
    curve.linear_offset = 0.0075;
    curve.linear_break = 0.00262409;
    return curve;
}

/// Kodak, "Conversion of 10-bit Log Film Data To 8-bit Linear or Video Data for The Cineon Digital
/// Film System", 1995: 0.002 density a code, film gamma 0.6, black at 95, white at 685.
LogCurve cineon() {
    constexpr double kGamma = 0.6;
    constexpr double kDensityOfCode = 0.002;
    constexpr double kBlack = 95;
    constexpr double kWhite = 685;
    const double black = std::pow(10, (kBlack - kWhite) * kDensityOfCode / kGamma);
    LogCurve curve;
    curve.base = 10;
    curve.log_slope = kGamma / kDensityOfCode / 1023;
    curve.log_offset = kWhite / 1023;
    curve.linear_slope = 1 - black;
    curve.linear_offset = black;
    return curve;
}

CurveStage curve_of(Expr (*decode)(const Expr&)) { return curve_stage(decode(Expr::input())); }

Pipeline of(Expr (*decode)(const Expr&)) { return {curve_of(decode)}; }

/// OpenColorIO's ACEScc_to_ACES2065-1 ends with a limit at 0, and pictures here are those of the
/// config.
Pipeline acescc_to_aces() {
    return {curve_of(acescc_decode), MatrixStage{rgb_to_rgb(kAP1, kAP0)}, ClampStage{0, kHalfMax}};
}

/// A point of the table of ST 2065-2, channel-independent density -> log10 of relative exposure.
struct DensityPoint {
    double density;
    double exposure;
};

/// SMPTE ST 2065-2:2012 and the Academy's ACEScsc.Academy.ADX10_to_ACES.a1.0.3: the last segment is
/// the straight line of slope 1/0.55 through printing density 0.7 at exposure 0.18.
Expr log_exposure_of_density(const Expr& density) {
    constexpr std::array<DensityPoint, 11> kTable = {{{-0.190, -6.000000000000000},
                                                      {0.010, -2.721718645000000},
                                                      {0.028, -2.521718645000000},
                                                      {0.054, -2.321718645000000},
                                                      {0.095, -2.121718645000000},
                                                      {0.145, -1.921718645000000},
                                                      {0.220, -1.721718645000000},
                                                      {0.300, -1.521718645000000},
                                                      {0.400, -1.321718645000000},
                                                      {0.500, -1.121718645000000},
                                                      {0.600, -0.926545676714876}}};
    constexpr double kFilmSlope = 100.0 / 55;
    // A polyline is a straight line and a change of slope at each point.
    const auto slope_after = [&](std::size_t i) {
        if (i + 1 == kTable.size()) return kFilmSlope;
        return (kTable[i + 1].exposure - kTable[i].exposure) /
               (kTable[i + 1].density - kTable[i].density);
    };
    Expr exposure = (density - kTable[0].density) * slope_after(0) + kTable[0].exposure;
    for (std::size_t i = 1; i < kTable.size(); ++i) {
        exposure =
            exposure + max(density - kTable[i].density, 0) * (slope_after(i) - slope_after(i - 1));
    }
    // OpenColorIO's limits: far below black, and the largest half.
    return min(max(exposure, -10), std::log10(kHalfMax));
}

/// Film density -> ACES2065-1, the Academy's "unbuild".
/// @param slope, offset  code value -> channel-dependent density
Pipeline adx_to_aces(double slope, double offset) {
    constexpr Matrix3 kDependentToIndependent = {
        {{0.75573, 0.22197, 0.02230}, {0.05901, 0.96928, -0.02829}, {0.16134, 0.07406, 0.76460}}};
    constexpr Matrix3 kExposureToAces = {
        {{0.72286, 0.12630, 0.15084}, {0.11923, 0.76418, 0.11659}, {0.01427, 0.08213, 0.90359}}};
    const Expr x = Expr::input();
    return {curve_stage(x * slope + offset), MatrixStage{kDependentToIndependent},
            curve_stage(exp2(log_exposure_of_density(x) * std::log2(10.0))),
            MatrixStage{kExposureToAces}};
}

// Sony states these matrices to ACES2065-1, and no primaries: the Academy's
// CSC.Sony.Venice_SLog3_SGamut3_to_ACES.a2.v1 and CSC.Sony.Venice_SLog3_SGamut3Cine_to_ACES.a2.v1.
constexpr Matrix3 kVeniceSGamut3 = {{{0.7933297411, 0.0890786256, 0.1175916333},
                                     {0.0155810585, 1.0327123069, -0.0482933654},
                                     {-0.0188647478, 0.0127694121, 1.0060953358}}};
constexpr Matrix3 kVeniceSGamut3Cine = {{{0.6742570921, 0.2205717359, 0.1051711720},
                                         {-0.0093136061, 1.1059588614, -0.0966452553},
                                         {-0.0382090673, -0.0179383766, 1.0561474439}}};

Pipeline venice_to_aces(const Matrix3& to_aces) {
    return {curve_of(sony_slog3_decode), MatrixStage{to_aces}};
}

/// Spaces with built-in transforms in OpenColorIO 2.0; names and aliases as in the ACES configs.
EncodedSpace builtin(std::string title, std::vector<std::string> aliases, std::string family,
                     std::string description, std::string style, std::string interop_id,
                     const Primaries& primaries, Pipeline decode) {
    return {.kind = EncodedSpace::Kind::builtin,
            .title = std::move(title),
            .aliases = std::move(aliases),
            .family = std::move(family),
            .description = std::move(description),
            .interop_id = std::move(interop_id),
            .primaries = primaries,
            .decode = std::move(decode),
            .style = std::move(style)};
}

EncodedSpace log_space(std::string title, std::vector<std::string> aliases, std::string family,
                       std::string description, const Primaries& primaries, const LogCurve& curve,
                       Pipeline decode, std::string interop_id) {
    return {.kind = EncodedSpace::Kind::log,
            .title = std::move(title),
            .aliases = std::move(aliases),
            .family = std::move(family),
            .description = std::move(description),
            .interop_id = std::move(interop_id),
            .primaries = primaries,
            .decode = std::move(decode),
            .curve = curve};
}

EncodedSpace texture(std::string title, std::vector<std::string> aliases, std::string_view display,
                     const Primaries& primaries, std::string interop_id) {
    const Display& curve = find_display(display);
    return {.kind = EncodedSpace::Kind::texture,
            .title = std::move(title),
            .aliases = std::move(aliases),
            .family = "Utility/Texture",
            .description = "Pictures and textures with " + std::string(primaries.name) +
                           " primaries in the code values of " + curve.source +
                           ", decoded to scene-linear.",
            .interop_id = std::move(interop_id),
            .primaries = primaries,
            .decode = curve.decode,
            .display = curve.id};
}

}  // namespace

const std::vector<EncodedSpace>& all_encoded_spaces() {
    static const std::vector<EncodedSpace> spaces = {
        builtin("ACEScct", {"acescct_ap1", "ACES - ACEScct"}, "ACES",
                "Academy S-2016-001: AP1, log with a linear toe; for grading.",
                "ACEScct_to_ACES2065-1", "ocio:acescct_ap1_scene", kAP1, of(acescct_decode)),
        builtin("ACEScc", {"acescc_ap1", "ACES - ACEScc"}, "ACES",
                "Academy S-2014-003: AP1, pure log; for grading.", "ACEScc_to_ACES2065-1",
                "ocio:acescc_ap1_scene", kAP0, acescc_to_aces()),
        builtin("ADX10", {"Input - ADX - ADX10"}, "Input/Film",
                "Film scans of 10 bits, SMPTE ST 2065-3, with the Academy's unbuild.",
                "ADX10_to_ACES2065-1", "ocio:adx10_apd_scene", kAP0,
                adx_to_aces(1023.0 / 500, -95.0 / 500)),
        builtin("ADX16", {"Input - ADX - ADX16"}, "Input/Film",
                "Film scans of 16 bits, SMPTE ST 2065-3, with the Academy's unbuild.",
                "ADX16_to_ACES2065-1", "ocio:adx16_apd_scene", kAP0,
                adx_to_aces(65535.0 / 8000, -1520.0 / 8000)),
        builtin("ARRI LogC3 (EI800)",
                {"arri_logc3_ei800", "logc3ei800_alexawide",
                 "Input - ARRI - V3 LogC (EI800) - Wide Gamut"},
                "Input/ARRI", "ARRI LogC3 of exposure index 800, ALEXA Wide Gamut.",
                "ARRI_ALEXA-LOGC-EI800-AWG_to_ACES2065-1", "ocio:arrilogc3_awg3_scene",
                kArriWideGamut3, of(arri_logc3_decode)),
        builtin("CanonLog2 CinemaGamut D55",
                {"canonlog2_cgamut_d55", "Input - Canon - Canon-Log2 - Cinema Gamut (Daylight)"},
                "Input/Canon", "Canon Log 2, Cinema Gamut, daylight.",
                "CANON_CLOG2-CGAMUT_to_ACES2065-1", "ocio:canonlog2_cgamutd55_scene", kCinemaGamut,
                of(canon_log2_decode)),
        builtin("CanonLog3 CinemaGamut D55",
                {"canonlog3_cgamut_d55", "Input - Canon - Canon-Log3 - Cinema Gamut (Daylight)"},
                "Input/Canon", "Canon Log 3, Cinema Gamut, daylight.",
                "CANON_CLOG3-CGAMUT_to_ACES2065-1", "ocio:canonlog3_cgamutd55_scene", kCinemaGamut,
                of(canon_log3_decode)),
        builtin("V-Log V-Gamut", {"vlog_vgamut", "Input - Panasonic - V-Log - V-Gamut"},
                "Input/Panasonic", "Panasonic V-Log, V-Gamut.",
                "PANASONIC_VLOG-VGAMUT_to_ACES2065-1", "ocio:vlog_vgamut_scene", kVGamut,
                of(panasonic_vlog_decode)),
        builtin("Log3G10 REDWideGamutRGB",
                {"log3g10_rwg", "Input - RED - REDLog3G10 - REDWideGamutRGB"}, "Input/RED",
                "RED Log3G10, REDWideGamutRGB.", "RED_LOG3G10-RWG_to_ACES2065-1",
                "ocio:redlog3g10_rwg_scene", kRedWideGamutRgb, of(red_log3g10_decode)),
        builtin("REDLogFilm REDWideGamutRGB", {"redlogfilm_rwg"}, "Input/RED",
                "REDlogFilm, REDWideGamutRGB.", "RED_REDLOGFILM-RWG_to_ACES2065-1", "",
                kRedWideGamutRgb, of(cineon_decode)),
        builtin("S-Log3 S-Gamut3", {"slog3_sgamut3", "Input - Sony - S-Log3 - S-Gamut3"},
                "Input/Sony", "Sony S-Log3, S-Gamut3.", "SONY_SLOG3-SGAMUT3_to_ACES2065-1",
                "ocio:slog3_sgamut3_scene", kSGamut3, of(sony_slog3_decode)),
        builtin("S-Log3 S-Gamut3.Cine",
                {"slog3_sgamut3cine", "Input - Sony - S-Log3 - S-Gamut3.Cine"}, "Input/Sony",
                "Sony S-Log3, S-Gamut3.Cine.", "SONY_SLOG3-SGAMUT3.CINE_to_ACES2065-1",
                "ocio:slog3_sgamut3cine_scene", kSGamut3Cine, of(sony_slog3_decode)),
        builtin("S-Log3 Venice S-Gamut3",
                {"slog3_sgamut3_venice", "Input - Sony - S-Log3 - Venice S-Gamut3"}, "Input/Sony",
                "Sony VENICE, S-Log3, S-Gamut3.", "SONY_SLOG3-SGAMUT3-VENICE_to_ACES2065-1",
                "ocio:slog3_sgamut3venice_scene", kAP0, venice_to_aces(kVeniceSGamut3)),
        builtin("S-Log3 Venice S-Gamut3.Cine",
                {"slog3_sgamut3cine_venice", "Input - Sony - S-Log3 - Venice S-Gamut3.Cine"},
                "Input/Sony", "Sony VENICE, S-Log3, S-Gamut3.Cine.",
                "SONY_SLOG3-SGAMUT3.CINE-VENICE_to_ACES2065-1",
                "ocio:slog3_sgamut3cinevenice_scene", kAP0, venice_to_aces(kVeniceSGamut3Cine)),
        log_space("ARRI LogC4", {"arri_logc4"}, "Input/ARRI", "ARRI LogC4, ARRI Wide Gamut 4.",
                  kArriWideGamut4, arri_logc4(), of(arri_logc4_decode),
                  "ocio:arrilogc4_awg4_scene"),
        log_space("DaVinci Intermediate WideGamut", {"davinci_intermediate_widegamut"},
                  "Input/Blackmagic", "DaVinci Intermediate, DaVinci Wide Gamut.",
                  kDaVinciWideGamut, davinci_intermediate(), of(davinci_intermediate_decode), ""),
        // OpenImageIO reports KodakLog for a DPX tagged as logarithmic, and for every Cineon file.
        log_space(
            kFilmSpace, {"cineon_film", "KodakLog", "Cineon Log"}, "Input/Film",
            "Kodak Cineon film scans (.cin, .dpx): black at code 95 of 1023, white at 685, Rec.709 "
            "primaries.",
            kRec709, cineon(), of(cineon_decode), ""),
        texture(kTextureSpace,
                {"srgb_tx", "Utility - sRGB - Texture", "sRGB Encoded Rec.709 (sRGB)"}, "srgb",
                kRec709, "srgb_rec709_scene"),
        texture("Gamma 2.2 Rec.709 - Texture", {"g22_rec709_tx", "Gamma 2.2 Encoded Rec.709"},
                "g22", kRec709, "g22_rec709_scene"),
        texture(kVideoSpace, {"g24_rec709_tx", "g24_rec709_scene", "Gamma 2.4 Encoded Rec.709"},
                "rec1886", kRec709, "ocio:g24_rec709_scene"),
        texture("sRGB Encoded AP1 - Texture", {"srgb_encoded_ap1_tx", "srgb_ap1"}, "srgb", kAP1,
                "srgb_ap1_scene"),
        texture("Gamma 2.2 AP1 - Texture", {"g22_ap1_tx", "Gamma 2.2 Encoded AP1"}, "g22", kAP1,
                "g22_ap1_scene"),
        texture("sRGB Encoded P3-D65 - Texture", {"srgb_encoded_p3d65_tx"}, "srgb", kP3D65,
                "srgb_p3d65_scene"),
        {.kind = EncodedSpace::Kind::data,
         .title = kDataSpace,
         .aliases = {"Utility - Raw", "Generic Data", "Non-Colour Data", "Raw"},
         .family = "Utility",
         .description = "Data that is not color (normals, depth, masks): never converted.",
         .interop_id = "data",
         .primaries = kRec709},
        {.kind = EncodedSpace::Kind::display_reference,
         .title = "CIE-XYZ-D65",
         .aliases = {"cie_xyz_d65_display"},
         .family = "Display",
         .description = "Display reference: CIE XYZ, D65, Y = 1 is display white.",
         .interop_id = "ocio:lin_ciexyzd65_display",
         .primaries = kRec709},
    };
    return spaces;
}

TONEWRIGHT_NAMESPACE_END
