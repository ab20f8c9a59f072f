// SPDX-License-Identifier: Apache-2.0
//
// Blender's AgX: the 3D LUTs of its configuration, computed, and the formula that they sample. For
// SDR displays of three gamuts, and for HDR displays of 1000 cd/m2.
//
// Source    E. Chow, AgX and AgX_LUT_Gen (github.com/EaryChow), 2023 to 2025; Blender 5.2,
//           release/datafiles/colormanagement: config.ocio, its views AgX and AgX - HDR 1000 nits
//           and its looks. Sigmoid: T. Sobotka, SB2383. Axes of the 3D LUTs: FilmLight E-Gamut.
// In        scene-linear RGB, working primaries Rec.2020, D65; domain (-inf, inf). Formula: colors
//           outside Rec.2020 are lifted until no channel is below 0, then scaled to compensate for
//           the added light. 3D LUT: limited to its axes, 10 stops below to 15 stops above mid gray
//           in E-Gamut.
// Out       display-linear RGB. range=sdr: primaries of `limit`, 1.0 = display peak; [0, 1]. The
//           source stores codes of a 2.4 power, which are decoded. range=hdr: Rec.2020, colors
//           within P3, 1.0 = 100 cd/m2; [0, 10].
// Kind      method=grid: 57^3 nodes, then a power, or the inverse of an HLG display. Formula:
//           3D, with c the scene color in the inset and f(c) its log, sigmoid and 2.4 power:
//             0.4 f(c) + 0.6 (f(min) + (f(max) - f(min)) (c - min)/(max - min)).
//           The source rotates the HSV hue of f(c) towards the hue of c by 60 % of their
//           difference. f is monotone, so the channels keep their order, and the hue keeps its
//           sextant. Within a sextant the hue is the relative position of the middle channel
//           between the others, which gives the formula above. The HDR version applies a second
//           curve after f, which contributes half of hue and saturation.
//           Guard rails: with off = max(-min, 0), r = c + off and luminance Y, the source compares
//           the luminances of c and r. To each it adds the complement's largest channel minus the
//           complement's luminance: 2 Y - min, because the weights sum to 1. The sum for r is never
//           less than that for c, so r is multiplied by 1 - off/(2 Y(r)), or set to black. Monotone
//           on the neutral axis: yes.
// Keeps     formula: 0 -> 0, mid gray 0.18 -> 0.18, neutral grays. 3D LUT: mid gray within 3e-5
//           (hdr: 0.181), grays within 4e-5 of the sRGB code (hdr: 7e-5).
// Differs   Where Y(r) of a color outside Rec.2020 is below off/2, the source multiplies by a
//           negative number, and its next step makes the color black; here it is black at once. The
//           3D LUTs are computed in double precision: 5e-8 from the files, which have seven
//           decimals. Only the 3D LUT of the looks' guard rail is rounded like its file. The
//           formula uses exact matrices; the generator's have a white of (0.31271, 0.32902). HLG
//           codes are decoded with the exact inverse of OpenColorIO's DISPLAY -
//           CIE-XYZ-D65_to_REC.2100-HLG-1000nit.
// Check     (0.8, 0.1, 0.05) in Rec.709 -> red 0.597988220 (formula), 0.595668176 (grid)
//           (check_values.json).
#include <cmath>
#include <cstring>
#include <functional>
#include <memory>
#include <vector>

#include "base/format_number.h"
#include "operators/agx_cube.h"
#include "operators/agx_nodes.h"
#include "operators/color_modifiers.h"
#include "operators/family.h"

TONEWRIGHT_NAMESPACE_BEGIN
using namespace agx_cube;
namespace {

/// Peak of the HDR view divided by its reference white: 1000 and 100 cd/m2.
constexpr double kHdrPeak = 10;
// ---------------------------------------------------------------------------------------------
// The formula, for expressions (Expr) and for the nodes of the 3D LUTs (double)

/// First curve for an HDR display, whose peak is 1: with the larger shoulder power.
template <class T>
T first_hdr_light(const T& x) {
    static const AgxSigmoid curve = sigmoid(1.5 * std::pow(kHdrPeak, std::log10(2.0)));
    return pow(max(curve(T(min(stops_of(x), 1))), 0), 2.4);
}

/// Moves mid gray to its value for the peak: a sigmoid of slope 1.000001 over the stops from 20
/// below mid gray to 1, whose shoulder is a plain hyperbola. Black stays black.
/// @param x  scene value; `light` is the result of the first curve.
template <class T>
T second_hdr_light(const T& x, const T& light) {
    static const double height = 20 + std::log2(1 / kMidGray);
    static const double px = 20 / height;
    static const double py = (20 - std::log2(kHdrPeak)) / height;
    constexpr double k = 1.000001;
    static const double toe = -AgxSigmoid::arm_scale(px, py, k, 3);
    static const double run = k * (1 - px);
    static const double shoulder = run / (run / (1 - py) - 1);

    const T e = (log2(max(light, kTiny) / kMidGray) + 20) / height;
    const T mapped = if_less(
        e, T(px),
        [&]() -> T {
            const T u = max(k * (e - px) / toe, 0);
            return toe * (u / pow(1 + u * u * u, 1.0 / 3)) + py;
        },
        [&]() -> T {
            const T u = k * max(e - px, 0);
            return u / (1 + u / shoulder) + py;
        });
    return if_less(
        T(0), stops_of(x), [&]() -> T { return kMidGray * exp2(height * mapped - 20); },
        []() -> T { return 0; });
}

/// The same for HDR. The second curve gives the value; both curves give half of the saturation and
/// half of the hue, which counts 40 %.
template <class T>
Color<T> hdr_map(const Color<T>& scene) {
    const Color<T> first = {first_hdr_light(scene[0]), first_hdr_light(scene[1]),
                            first_hdr_light(scene[2])};
    Color<T> out = {second_hdr_light(scene[0], first[0]), second_hdr_light(scene[1], first[1]),
                    second_hdr_light(scene[2], first[2])};
    const T value = largest(out);
    const T first_value = largest(first);
    const T first_saturation = if_less(
        T(0), first_value, [&]() -> T { return (first_value - smallest(first)) / first_value; },
        []() -> T { return 0; });
    const T spread = 0.5 * (value * first_saturation + (value - smallest(out)));
    const Color<T> place0 = places(scene);
    const Color<T> place1 = places(first);
    const Color<T> place2 = places(out);
    for (std::size_t i = 0; i < 3; ++i) {
        const T place = 0.6 * place0[i] + 0.2 * (place1[i] + place2[i]);
        out[i] = value - spread * (1 - place);
    }
    return out;
}

const std::array<Expr, 3>& inputs() {
    static const std::array<Expr, 3> rgb = {Expr::input(0), Expr::input(1), Expr::input(2)};
    return rgb;
}

/// The formula up to the guard rail of the limit, after a look's stages: one channel-mixing stage,
/// so that a 3D LUT samples it once. It accepts channels below 0.
Pipeline sdr_formula(const Pipeline& look, const Primaries& limit) {
    Pipeline chain =
        look + Pipeline{CrossTalkStage{scene_rail(inputs(), kRailWeights)},
                        MatrixStage{kAgxInsetRec2020, "inset"}, CrossTalkStage{sdr_map(inputs())},
                        MatrixStage{kAgxOutsetRec2020, "outset"}};
    if (!(limit == kRec2020)) {
        chain.push_back(MatrixStage{rgb_to_rgb(kRec2020, limit)});
        chain.push_back(CrossTalkStage{display_rail(inputs(), weights_of(limit, kRailWeights))});
    }
    return {CrossTalkStage{compose(chain)}, ClampStage{0, 1}};
}

Pipeline hdr_formula(const Pipeline& look) {
    const Pipeline chain =
        look +
        Pipeline{CrossTalkStage{scene_rail(inputs(), kRailWeights2025)},
                 MatrixStage{kAgxInsetRec2020, "inset"},
                 CrossTalkStage{hdr_map(inputs())},
                 MatrixStage{kAgxOutsetRec2020, "outset"},
                 MatrixStage{rgb_to_rgb(kRec2020, kP3D65)},
                 CrossTalkStage{display_rail(inputs(), weights_of(kP3D65, kRailWeights2025))}};
    return {CrossTalkStage{compose(chain)}, MatrixStage{rgb_to_rgb(kP3D65, kRec2020)},
            ClampStage{0, 1}, MatrixStage{scale(kIdentity3, kHdrPeak)}};
}

// ---------------------------------------------------------------------------------------------
// The 3D LUTs

/// Axes for lookups in the 3D LUTs: log2 of E-Gamut, with the ends that the configuration prints.
/// The generator places its nodes from exactly 10 stops below mid gray over exactly 25 stops.
constexpr double kLowest = -12.47393;
constexpr double kHighest = 12.5260688117;

Matrix3 rec2020_to_e_gamut() { return multiply(inverse(kEGamutToXyz), rgb_to_xyz(kRec2020)); }

constexpr int kRailEdge = 37;

/// A 3D LUT, computed and cached at the first lookup; and the formula of its nodes.
/// @param node  a functor: Rec.2020 -> color of the 3D LUT, for double and for Expr
/// @param nodes  gives the nodes
template <class Node>
std::shared_ptr<const Grid> make_cube(int edge, const Node& node,
                                      const std::function<std::vector<double>()>& nodes) {
    const auto formula = [node] {
        const std::array<Expr, 3>& place = inputs();
        const Color<Expr> light = {light_at(place[0]), light_at(place[1]), light_at(place[2])};
        const Color<Expr> color = node(times(multiply(kXyzToRec2020, kEGamutToXyz), light));
        return std::vector<Expr>(color.begin(), color.end());
    };
    return std::make_shared<const Grid>(edge, nodes, formula);
}
template <class Node>
std::shared_ptr<const Grid> make_cube(int edge, const Node& node) {
    return make_cube(edge, node, [edge, node] { return cube_nodes(edge, node); });
}

/// The nodes of the default 3D LUT.
std::vector<double> rec709_nodes() {
#ifdef TONEWRIGHT_HAVE_AGX_NODES
    std::vector<double> nodes(kAgxNumbers);
    std::memcpy(nodes.data(), kAgxNodes, kAgxNumbers * sizeof(double));
    return nodes;
#else  // a build for another machine
    return cube_nodes(kEdge, rec709_node());
#endif
}

/// ITU-R BT.2100-2, table 5: Rec.2020 light of [0, 1], 1 = 1000 cd/m2, to HLG codes. The file clips
/// at 1, which saturated blues exceed.
template <class T>
Color<T> hlg_codes(const Color<T>& light) {
    using std::log;
    using std::sqrt;
    constexpr double a = 0.17883277;
    constexpr double b = 1 - 4 * a;
    const double c = 0.5 - a * std::log(4 * a);
    const T y = luminance(light, kRec2020Weights);
    const T gain = if_less(
        T(0), y, [&]() -> T { return pow(max(y, kTiny), 1 / 1.2 - 1); }, []() -> T { return 0; });
    Color<T> out = light;
    for (std::size_t i = 0; i < 3; ++i) {
        const T e = light[i] * gain;
        out[i] =
            min(if_less(
                    T(1.0 / 12), e, [&]() -> T { return a * log(T(max(12 * e - b, kTiny))) + c; },
                    [&]() -> T { return sqrt(T(3 * max(e, 0))); }),
                1);
    }
    return out;
}

struct HdrNode {
    Matrix3 to_p3 = multiply(kXyzToP3, kRec2020ToXyz);
    Matrix3 outset = multiply(to_p3, kAgxOutsetRec2020);
    Matrix3 back = inverse(to_p3);
    Vector3 weights = weights_of(kP3D65, kRailWeights2025);

    template <class T>
    Color<T> operator()(const Color<T>& c) const {
        const Color<T> scene = times(kAgxInsetRec2020, scene_rail(c, kRailWeights2025));
        Color<T> out = times(back, display_rail(times(outset, hdr_map(scene)), weights));
        for (T& v : out)
            v = min(max(v, 0), 1);
        return hlg_codes(out);
    }
};

/// Only the first guard rail, for looks: log values like those of the axes.
struct RailNode {
    Matrix3 to_e_gamut = multiply(inverse(kEGamutToXyz), kRec2020ToXyz);

    template <class T>
    Color<T> operator()(const Color<T>& c) const {
        using std::floor;
        Color<T> out = times(to_e_gamut, scene_rail(c, kRailWeights));
        for (T& v : out) {
            v = max((log2(max(v, kTiny) / kMidGray) + 10) / 25, 0);
            v = floor(T(v * 1e7 + 0.5)) / 1e7;  // rounded like the file
        }
        return out;
    }
};

std::shared_ptr<const Grid> sdr_grid(const std::string& limit) {
    if (limit == "rec709") {
        static const auto rec709 = make_cube(kEdge, rec709_node(), rec709_nodes);
        return rec709;
    }
    if (limit == "p3d65") {
        static const auto p3 = make_cube(kEdge, SdrNode(kP3D65, &kXyzToP3));
        return p3;
    }
    static const auto rec2020 = make_cube(kEdge, SdrNode(kRec2020, nullptr));
    return rec2020;
}
std::shared_ptr<const Grid> hdr_grid() {
    static const auto grid = make_cube(kEdge, HdrNode{});
    return grid;
}
std::shared_ptr<const Grid> rail_grid() {
    static const auto grid = make_cube(kRailEdge, RailNode{});
    return grid;
}

/// log2 of scene values as positions on the axes: mid gray is at 0.4.
Expr log_encode(const Expr& x) { return (log2(x) - kLowest) / (kHighest - kLowest); }
Expr log_decode(const Expr& v) { return exp2(kLowest + (kHighest - kLowest) * v); }

/// Rec.2020 -> color of the 3D LUT.
Pipeline through(const std::shared_ptr<const Grid>& grid) {
    return {MatrixStage{rec2020_to_e_gamut(), "to_e_gamut"},
            ClampStage{std::exp2(kLowest), std::exp2(kHighest)},
            GridStage{log_encode(Expr::input()), grid}};
}

/// HLG codes -> display-linear Rec.2020, 1 = 100 cd/m2, on a display of 1000 cd/m2.
Pipeline hlg_display() {
    return {curve_stage(hlg_inverse_oetf(Expr::input())),
            ToneScaleStage{ToneScaleStage::Norm::luminance, kRec2020Weights,
                           hlg_ootf_luminance(Expr::input())},
            MatrixStage{scale(kIdentity3, kHdrPeak)}};
}

// ---------------------------------------------------------------------------------------------
// Looks, on log values in the inset, between the first guard rail and the rest of the chain

/// Lower limit of OpenColorIO's logarithm: the smallest normal float.
constexpr double kSmallestLog = 0x1p-126;
/// Upper limit: above it the largest contrast would overflow floats.
constexpr double kLargestLog = 0x1p60;

/// Slope and saturation of the looks that are a contrast about mid gray.
struct Contrast {
    const char* id;
    const char* title;
    double slope;
    double saturation;
};
constexpr std::array<Contrast, 7> kContrasts = {{
    {"very_high_contrast", "Very High Contrast", 1.57, 0.9},
    {"high_contrast", "High Contrast", 1.4, 0.95},
    {"medium_high_contrast", "Medium High Contrast", 1.2, 1},
    {"base_contrast", "Base Contrast", 1, 1},
    {"medium_low_contrast", "Medium Low Contrast", 0.9, 1.05},
    {"low_contrast", "Low Contrast", 0.8, 1.1},
    {"very_low_contrast", "Very Low Contrast", 0.7, 1.15},
}};

/// The shadow curve of OpenColorIO's GradingTone below 1: slope `m0` up to the pivot, then two
/// parabolas that reach the identity at 0.4.
Expr lowered_shadows(const Expr& t, double m0) {
    constexpr double x0 = 0.1;
    constexpr double x2 = 0.4;
    constexpr double x1 = x0 + (x2 - x0) / 2;
    const double y1 = 0.5 / (x2 - x0) *
                      ((2 * x0 + m0 * (x1 - x0)) * (x2 - x1) + (2 * x2 - (x2 - x1)) * (x1 - x0));
    const Expr a = named("a", (t - x0) / (x1 - x0));
    const Expr b = named("b", (t - x1) / (x2 - x1));
    const Expr lower =
        named("lower", x0 * (1 - a * a) + y1 * (a * a) + m0 * (x1 - x0) * ((1 - a) * a));
    const Expr upper =
        named("upper", y1 * ((1 - b) * (1 - b)) + x2 * ((2 - b) * b) + (x2 - x1) * ((b - 1) * b));
    return select(less(t, x0), x0 + m0 * (t - x0),
                  select(less(t, x1), lower, select(less(t, x2), upper, t)));
}

/// Scene color in the inset, limited to the range of the logarithm -> with the look.
Pipeline look_stages(const std::string& look) {
    const Expr v = named("v", log_encode(Expr::input()));
    if (look == "punchy") {
        const Expr lowered = named("lowered", lowered_shadows(lowered_shadows(v, 0.2), 0.35));
        const Expr darkened =
            named("darkened", select(less(0, lowered), pow(max(lowered, 0), 1.0912), lowered));
        return {curve_stage(log_decode(darkened))};
    }
    // The look decodes its log values for the sum and encodes them again.
    if (look == "greyscale")
        return {MatrixStage{{kRailWeights2025, kRailWeights2025, kRailWeights2025}}};
    for (const Contrast& contrast : kContrasts) {
        if (look != contrast.id) continue;
        // pivot + slope (v - pivot): the added constant does not change saturation, because it is a
        // factor in linear. So all of these looks share their curves.
        constexpr double pivot = 0.4;
        const double gain = std::exp2((kHighest - kLowest) * pivot * (1 - contrast.slope));
        const Matrix3 saturate = saturation_matrix(contrast.saturation, kRec709Weights);
        return {curve_stage(v), MatrixStage{scale(saturate, contrast.slope)},
                curve_stage(log_decode(Expr::input())), MatrixStage{scale(kIdentity3, gain)}};
    }
    return {};
}

/// Rec.2020 -> Rec.2020.
Pipeline apply_look(const std::string& look, bool is_grid) {
    if (look.empty()) return {};
    Pipeline rail = {CrossTalkStage{scene_rail(inputs(), kRailWeights)}};
    if (is_grid) {
        rail = through(rail_grid()) +
               Pipeline{curve_stage(log_decode(Expr::input())),
                        MatrixStage{inverse(rec2020_to_e_gamut()), "from_e_gamut"}};
    }
    return rail +
           Pipeline{MatrixStage{kAgxInsetRec2020, "inset"}, ClampStage{kSmallestLog, kLargestLog}} +
           look_stages(look) + Pipeline{MatrixStage{inverse(kAgxInsetRec2020), "inverse_inset"}};
}

std::vector<Look> looks() {
    std::vector<Look> all = {
        {"punchy", "Punchy", "darker shadows: GradingTone 0.2 and 0.35, log power 1.0912"},
        {"greyscale", "Greyscale", "black and white, with the luminance of the colors"}};
    for (const Contrast& c : kContrasts) {
        all.push_back({c.id, c.title,
                       "log contrast " + shortest(c.slope) + " about mid gray, saturation " +
                           shortest(c.saturation)});
    }
    return all;
}

bool is_hdr(const Params& params) { return params.choice("range") == "hdr"; }

}  // namespace

std::vector<Operator> define_agx_blender() {
    Operator op;
    op.id = "agx_blender";
    op.title = "AgX (Blender)";
    op.view = "AgX";
    op.character =
        "soft: bright colors fade to white and keep most of their hue, mid gray stays; low "
        "contrast unless a look is chosen";
    op.source =
        "E. Chow, AgX and AgX_LUT_Gen, github.com/EaryChow; Blender 5.2, config.ocio: AgX, AgX - "
        "HDR 1000 nits and their looks";
    op.license = "formula and constants only; none of its files or code is used";
    op.dialects = "AgX";
    op.negatives =
        "colors outside Rec.2020 are lifted until no channel is below 0, then scaled to compensate "
        "for the added light; Blender's 3D LUT limits them to E-Gamut first";
    op.working = kRec2020;
    op.parameters = {
        limit_parameter({"rec709", "p3d65", "rec2020"}, "rec709"),
        choice_parameter(
            "method", {"lattice", "formula"}, "lattice",
            "lattice: Blender's own 3D LUT; formula: the formula that the LUT samples"),
        display_parameter(choice_parameter("range", {"sdr", "hdr"}, "sdr",
                                           "hdr: displays of 1000 cd/m2, colors within P3"),
                          [](const DisplayFacts& display) -> std::string {
                              return display.is_hdr ? "hdr" : "sdr";
                          }),
    };
    op.presets = {{"formula",
                   "exact formula, without the interpolation of the 3D LUT",
                   {{"method", "formula"}}},
                  {"hdr", "HDR display of 1000 cd/m2", {{"range", "hdr"}}}};
    op.looks = looks();
    op.warnings = {
        "Blender shows the 3D LUT, whose interpolation moves saturated colors by up to 0.1 of the "
        "sRGB code value from the formula",
        "SDR displays clip range=hdr at 100 cd/m2",
        "Blender multiplies its HDR view by 2.03 when it shows or saves it"};
    // The 3D LUT of the looks' guard rail ends 10 stops below mid gray, and these looks lift that
    // value.
    op.differences = {{DocumentedDifference::Kind::exceeds_white, 10, "hdr"},
                      {DocumentedDifference::Kind::black, 0.000105, "punchy"},
                      {DocumentedDifference::Kind::black, 1.85e-5, "medium_low_contrast"},
                      {DocumentedDifference::Kind::black, 0.000128, "low_contrast"},
                      {DocumentedDifference::Kind::black, 0.000456, "very_low_contrast"}};
    op.bounds = {.simd = 1e-5,
                 .simd_goal = 1e-5,
                 .ocio_cpu = 8e-5,
                 .ocio_gpu = 2e-4,
                 .lut3d = 0.11,
                 .reason =
                     "simd: twice as fast as with 1e-6; hdr: HLG codes decode to values up to 10; "
                     "colors far outside Rec.709 suffer from cancellation; formula: a 3D LUT "
                     "smooths the corners of the guard rails"};
    op.build = [](const Params& p) -> Pipeline {
        const bool is_grid = p.choice("method") == "lattice";
        const Pipeline look = apply_look(p.look(), is_grid);
        if (is_grid) {
            if (is_hdr(p)) return look + through(hdr_grid()) + hlg_display();
            return look + through(sdr_grid(p.choice("limit"))) +
                   Pipeline{curve_stage(pow(Expr::input(), 2.4))};
        }
        return is_hdr(p) ? hdr_formula(look) : sdr_formula(look, limiting_primaries(p, kRec709));
    };
    op.output_primaries = [](const Params& p) -> Primaries {
        return is_hdr(p) ? kRec2020 : limiting_primaries(p, kRec709);
    };
    op.peak = [](const Params& p) -> double { return is_hdr(p) ? kHdrPeak : 1; };
    return {op};
}

TONEWRIGHT_NAMESPACE_END
