// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <charconv>
#include <optional>

#include "base/format_number.h"
#include "base/strings.h"
#include "tonewright/view.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

/// Null if there is no such name.
template <class Item>
const Item* look_up(const std::vector<Item>& items, std::string_view name) {
    for (const Item& item : items) {
        if (is_same_name(item.id, name) || is_same_name(item.title, name)) return &item;
        for (const std::string& alias : item.aliases) {
            if (is_same_name(alias, name)) return &item;
        }
    }
    return nullptr;
}

template <class Item>
const Item& find_named(const std::vector<Item>& items, std::string_view name, const char* what,
                       const std::vector<std::string>& extra) {
    if (const Item* found = look_up(items, name)) return *found;
    std::vector<NamedChoice> all;
    std::vector<std::string> ids;
    for (const Item& item : items) {
        ids.push_back(item.id);
        all.push_back({item.id, item.aliases});
        all.back().names.push_back(item.title);
    }
    for (const std::string& other : extra) {
        ids.push_back(other);
        all.push_back({other});
    }
    throw Error(std::string(what) + " is " + std::string(name) + "; expected " + join_choices(ids) +
                did_you_mean(name, all));
}

Display sdr_display(std::string id, std::string title, std::vector<std::string> aliases,
                    const Primaries& primaries, Expr (*encode)(const Expr&),
                    Expr (*decode)(const Expr&), std::string source) {
    const Expr x = Expr::input(0);
    return {.id = std::move(id),
            .title = std::move(title),
            .aliases = std::move(aliases),
            .primaries = primaries,
            .encode = {named("encode", curve_stage(encode(x), decode(x)))},
            .decode = {named("decode", curve_stage(decode(x), encode(x)))},
            .source = std::move(source)};
}

constexpr double kHdrPeak = 1000;     // cd/m2, of grading displays and of OCIO's HLG display
constexpr double kPqLargest = 10000;  // SMPTE ST 2084

Display pq_display(std::string id, std::string title, std::vector<std::string> aliases,
                   const Primaries& primaries, std::string source) {
    const Expr x = Expr::input(0);
    const Expr encode = pq_encode_nits(x * kReferenceWhite);
    const Expr decode = pq_decode_nits(x) / kReferenceWhite;
    return {.id = std::move(id),
            .title = std::move(title),
            .aliases = std::move(aliases),
            .primaries = primaries,
            .encode = {named("encode", curve_stage(encode, decode))},
            .decode = {named("decode", curve_stage(decode, encode))},
            .source = std::move(source),
            .is_hdr = true,
            .peak = kHdrPeak,
            .largest_light = kPqLargest / kReferenceWhite};
}

Display hlg_display() {
    const Expr x = Expr::input(0);
    const double unit = kHdrPeak / kReferenceWhite;
    const auto luminance = [](const Expr& f) {
        // ITU-R BT.2100-2, table 5
        return ToneScaleStage{ToneScaleStage::Norm::luminance, {0.2627, 0.6780, 0.0593}, f};
    };
    return {.id = "rec2100_hlg",
            .title = "Rec.2100-HLG",
            .aliases = {"rec2100_hlg_display", "hlg_rec2020_display"},
            .primaries = kRec2020,
            .encode = {MatrixStage{scale(kIdentity3, 1 / unit)},
                       luminance(hlg_inverse_ootf_luminance(x)),
                       named("encode", curve_stage(hlg_oetf(x), hlg_inverse_oetf(x))),
                       // A color with one bright channel has a luminance below 1, so its scene
                       // value may exceed 1 at the largest display value.
                       ClampStage{0, 1}},
            .decode = {named("decode", curve_stage(hlg_inverse_oetf(x), hlg_oetf(x))),
                       luminance(hlg_ootf_luminance(x)), MatrixStage{scale(kIdentity3, unit)}},
            .source = "ITU-R BT.2100-2 HLG, a display of 1000 cd/m2",
            .is_hdr = true,
            .peak = kHdrPeak,
            .largest_light = unit};
}

/// Clamps like the input of every engine.
SourceColor encoded(std::string name, Pipeline decode, const Primaries& primaries) {
    decode.push_back(ClampStage{-kHalfMax, kHalfMax});
    return {std::move(name), primaries, std::move(decode)};
}

/// The X.Y of "GammaX.Y", as OIIO names powers of Rec.709; or 0.
double exponent_of(std::string_view name) {
    constexpr std::string_view kPrefix = "gamma";
    const std::string folded = folded_name(name);
    if (!folded.starts_with(kPrefix)) return 0;
    std::string_view digits = std::string_view(folded).substr(kPrefix.size());
    if (digits.starts_with('_')) digits.remove_prefix(1);
    double exponent = 0;
    const auto [end, error] =
        std::from_chars(digits.data(), digits.data() + digits.size(), exponent);
    const bool is_number = error == std::errc() && end == digits.data() + digits.size();
    return is_number && exponent >= 0.1 && exponent <= 10 ? exponent : 0;
}

/// `<curve>_<primaries>_<scene|display>`, the curve `lin`, `srgb` or `gNN` (a power, in tenths).
std::optional<SourceColor> by_interop_pattern(std::string_view text) {
    const std::string name = folded_name(text);
    const std::size_t first = name.find('_');
    const std::size_t last = name.rfind('_');
    if (first == std::string_view::npos || first == last) return std::nullopt;
    const std::string curve = name.substr(0, first);
    const InputSpace* space =
        look_up(all_input_spaces(), "lin_" + name.substr(first + 1, last - first - 1));
    const std::string state = name.substr(last + 1);
    if (!space || !(state == "scene" || state == "display")) return std::nullopt;
    if (curve == "lin") return SourceColor{space->id, space->primaries};
    const Expr x = Expr::input();
    if (curve == "srgb") return encoded(name, {curve_stage(srgb_decode(x))}, space->primaries);
    int tenths = 0;
    const auto [end, error] =
        std::from_chars(curve.data() + 1, curve.data() + curve.size(), tenths);
    if (curve.size() != 3 || curve.front() != 'g' || error != std::errc() ||
        end != curve.data() + curve.size() || tenths < 1) {
        return std::nullopt;
    }
    return encoded(name, {curve_stage(power_decode(x, tenths / 10.0))}, space->primaries);
}

}  // namespace

const std::vector<InputSpace>& all_input_spaces() {
    // Aliases: names of the same space in Blender 3 and 4, OIIO, the ACES configs and the interop
    // forum.
    static const std::vector<InputSpace> spaces = {
        {"lin_rec709",
         "Linear Rec.709",
         {"Linear Rec.709 (sRGB)", "Linear", "lin_rec709_srgb", "lin_srgb", "lin_rec709_scene",
          "Utility - Linear - sRGB"},
         kRec709},
        {"lin_ap1", "ACEScg", {"lin_ap1_scene", "ACES - ACEScg"}, kAP1},
        {"lin_ap0",
         "ACES2065-1",
         {"aces2065_1", "lin_ap0_scene", "ACES - ACES2065-1", "Linear ACES"},
         kAP0},
        {"lin_rec2020",
         "Linear Rec.2020",
         {"lin_rec2020_scene", "Utility - Linear - Rec.2020"},
         kRec2020},
        {"lin_p3d65",
         "Linear P3-D65",
         {"lin_p3d65_scene", "lin_displayp3", "Utility - Linear - P3-D65"},
         kP3D65},
        {"lin_egamut", "Linear FilmLight E-Gamut", {"Linear E-Gamut", "lin_egamut_scene"}, kEGamut},
        {"lin_awg3", "Linear ARRI Wide Gamut 3", {"lin_arri_wide_gamut_3"}, kArriWideGamut3, true},
        {"lin_awg4", "Linear ARRI Wide Gamut 4", {"lin_arri_wide_gamut_4"}, kArriWideGamut4, true},
        {"lin_sgamut3", "Linear S-Gamut3", {}, kSGamut3, true},
        {"lin_sgamut3cine", "Linear S-Gamut3.Cine", {}, kSGamut3Cine, true},
        {"lin_davinci_wg",
         "Linear DaVinci WideGamut",
         {"lin_davinci_widegamut"},
         kDaVinciWideGamut,
         true},
    };
    return spaces;
}

const std::vector<Display>& all_displays() {
    static const std::vector<Display> displays = {
        sdr_display("srgb", "sRGB", {"srgb_display", "srgb_rec709_display"}, kRec709, srgb_encode,
                    srgb_decode, "IEC 61966-2-1:1999"),
        sdr_display("display_p3", "Display P3", {"displayp3_display", "srgb_p3d65_display"}, kP3D65,
                    srgb_encode, srgb_decode,
                    "SMPTE EG 432-1 primaries, D65, IEC 61966-2-1:1999 curve"),
        sdr_display("rec1886", "Rec.1886",
                    {"rec1886_rec709_display", "g24_rec709_display", "bt1886"}, kRec709,
                    bt1886_encode, bt1886_decode, "ITU-R BT.1886 (black 0), BT.709-6"),
        sdr_display("rec2020", "Rec.2020", {"rec1886_rec2020_display", "g24_rec2020_display"},
                    kRec2020, bt1886_encode, bt1886_decode, "ITU-R BT.1886 (black 0), BT.2020-2"),
        sdr_display(
            "g22", "Gamma 2.2", {"g22_rec709_display"}, kRec709,
            [](const Expr& x) { return power_encode(x, 2.2); },
            [](const Expr& x) { return power_decode(x, 2.2); }, "2.2 power, BT.709-6 primaries"),
        pq_display("rec2100_pq", "Rec.2100-PQ", {"rec2100_pq_display", "pq_rec2020_display"},
                   kRec2020, "ITU-R BT.2100-2 PQ (SMPTE ST 2084); linear 1 is 100 cd/m2"),
        hlg_display(),
        pq_display("p3d65_pq", "P3-D65 PQ", {"st2084_p3d65_display", "pq_p3d65_display"}, kP3D65,
                   "SMPTE EG 432-1 primaries, D65, SMPTE ST 2084; linear 1 is 100 cd/m2"),
    };
    return displays;
}

const InputSpace& find_input_space(std::string_view name) {
    return find_named(all_input_spaces(), name, "input space", {});
}

SourceColor find_source_color(std::string_view name) {
    if (const InputSpace* space = look_up(all_input_spaces(), name))
        return {space->id, space->primaries};
    if (const Display* display = look_up(all_displays(), name))
        return encoded(display->title, display->decode, display->primaries);
    const Expr x = Expr::input();
    if (is_same_name(name, "Rec709"))
        return encoded("Rec709", {curve_stage(bt709_inverse_oetf(x))}, kRec709);
    if (const double exponent = exponent_of(name); exponent > 0) {
        return encoded("Gamma" + shortest(exponent), {curve_stage(power_decode(x, exponent))},
                       kRec709);
    }
    // CIE XYZ itself: its primaries are X, Y and Z.
    if (is_same_name(name, "lin_ciexyzd65_scene"))
        return {"lin_ciexyzd65_scene", {"CIE XYZ", {1, 0}, {0, 1}, {0, 0}, kD65}};
    if (std::optional<SourceColor> color = by_interop_pattern(name)) return *color;
    // Throws the message of the input spaces, with all names.
    return {find_named(all_input_spaces(), name, "input space",
                       {"sRGB", "Rec709", "Gamma2.2", "a display"})
                .id,
            kRec709};
}

const Display& find_display(std::string_view name) {
    return find_named(all_displays(), name, "display", {});
}

const Display& find_display(std::string_view name, const std::vector<std::string>& others) {
    return find_named(all_displays(), name, "display", others);
}

TONEWRIGHT_NAMESPACE_END
