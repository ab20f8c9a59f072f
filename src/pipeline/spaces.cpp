// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <charconv>
#include <optional>
#include <utility>

#include "base/format_number.h"
#include "base/strings.h"
#include "pipeline/encoded_spaces.h"
#include "pipeline/spaces.h"
#include "tonewright/input_encoding.h"
#include "tonewright/source_color.h"

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
const Item& find_named(const std::vector<Item>& items, std::string_view name, const char* parameter,
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
    throw Error({.parameter = parameter,
                 .value = std::string(name),
                 .expected = join_choices(ids),
                 .suggestion = suggested_names(name, all)});
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
    const Expr encode = pq_encode_nits(x * kUnitLuminance);
    const Expr decode = pq_decode_nits(x) / kUnitLuminance;
    return {.id = std::move(id),
            .title = std::move(title),
            .aliases = std::move(aliases),
            .primaries = primaries,
            .encode = {named("encode", curve_stage(encode, decode))},
            .decode = {named("decode", curve_stage(decode, encode))},
            .source = std::move(source),
            .is_hdr = true,
            .peak = kHdrPeak,
            .largest_light = kPqLargest / kUnitLuminance};
}

constexpr double kHlgUnit = kHdrPeak / kUnitLuminance;
constexpr Vector3 kBt2100Luminance = {0.2627, 0.6780, 0.0593};  // ITU-R BT.2100-2, table 5

Display hlg_display() {
    const Expr x = Expr::input(0);
    return {.id = "rec2100_hlg",
            .title = "Rec.2100-HLG",
            .aliases = {"rec2100_hlg_display", "hlg_rec2020_display"},
            .primaries = kRec2020,
            .encode = {MatrixStage{scale(kIdentity3, 1 / kHlgUnit)},
                       ToneScaleStage{ToneScaleStage::Norm::luminance, kBt2100Luminance,
                                      hlg_inverse_ootf_luminance(x)},
                       named("encode", curve_stage(hlg_oetf(x), hlg_inverse_oetf(x))),
                       // A color with one bright channel has a luminance below 1, so its scene
                       // value may exceed 1 at the largest display value.
                       ClampStage{0, 1}},
            .decode = hlg_display_decode(kBt2100Luminance),
            .source = "ITU-R BT.2100-2 HLG, a display of 1000 cd/m2",
            .is_hdr = true,
            .peak = kHdrPeak,
            .largest_light = kHlgUnit};
}

/// The color of "cicp:P/T", the name that color_of_code_points() gives.
/// @throws Error  such a name of values without a meaning
std::optional<SourceColor> by_code_points(std::string_view name) {
    constexpr std::string_view kPrefix = "cicp:";
    const std::string folded = folded_name(name);
    if (!folded.starts_with(kPrefix)) return std::nullopt;
    int primaries = 0;
    int transfer = 0;
    const char* const end = folded.data() + folded.size();
    const auto [slash, error] = std::from_chars(folded.data() + kPrefix.size(), end, primaries);
    if (error != std::errc() || slash == end || *slash != '/') return std::nullopt;
    const auto [rest, second_error] = std::from_chars(slash + 1, end, transfer);
    if (second_error != std::errc() || rest != end) return std::nullopt;
    std::optional<SourceColor> color = color_of_code_points(primaries, transfer);
    if (!color) {
        throw Error("input space is " + std::string(name) + ", " +
                    code_point_names(primaries, transfer) +
                    "; expected values that ITU-T H.273, tables 2 and 3, specifies");
    }
    return color;
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

/// Ids of the Color Interop Forum that no display and no space of the config has: "Color Space
/// Encodings for Texture Assets and CG Rendering", "Display Color Space Encodings", 2026.
struct InteropName {
    const char* id;
    const char* title;
};
constexpr std::array kOtherInteropNames = {
    InteropName{"lin_adobergb_scene", "Linear AdobeRGB"},
    InteropName{"lin_ciexyzd65_scene", "CIE XYZ-D65 - Scene-referred"},
    InteropName{"g18_rec709_scene", "Gamma 1.8 Encoded Rec.709"},
    InteropName{"g22_adobergb_scene", "Gamma 2.2 Encoded AdobeRGB"},
    InteropName{"srgbe_p3d65_display", "Display P3 HDR - Display"},
    InteropName{"g22_adobergb_display", "AdobeRGB - Display"},
    InteropName{"g26_p3d65_display", "Gamma 2.6 P3-D65 - Display"},
    InteropName{"g26_xyzd65_display", "DCDM G2.6-XYZ-D65 - Display"},
    InteropName{"pq_xyzd65_display", "DCDM ST2084-XYZ-D65 - Display"},
    InteropName{"lin_rec709_display", "Linear Rec.709 - Display-referred"},
    InteropName{"lin_p3d65_display", "Linear P3-D65 - Display-referred"},
    InteropName{"lin_rec2020_display", "Linear Rec.2020 - Display-referred"},
};

/// The forum's id of files whose color nobody knows.
constexpr const char* kUnknownColor = "unknown";

/// Other names, and names with a number.
constexpr std::array<std::pair<const char*, const char*>, 3> kOtherNames = {{
    {"Rec709", "camera curve of ITU-R BT.709, inverted"},
    {"GammaX.Y", "power of Rec.709, such as Gamma1.8"},
    {"cicp:P/T", "code points of ITU-T H.273: primaries and transfer, such as cicp:9/16"},
}};

/// Primaries in the Color Interop Forum's ids.
std::optional<Primaries> interop_primaries(const std::string& name) {
    if (name == "adobergb") return kAdobeRgb;
    if (const InputSpace* space = look_up(all_input_spaces(), "lin_" + name))
        return space->primaries;
    return std::nullopt;
}

bool is_xyz(std::string_view primaries) {
    return primaries == "ciexyzd65" || primaries == "xyzd65";
}

/// The curve of one of those ids: `srgb`, `srgbe` (negatives mirror), `pq`, or `gNN`, a power in
/// tenths.
std::optional<Expr> interop_curve(const std::string& curve, const std::string& primaries) {
    const Expr x = Expr::input();
    if (curve == "srgb") return srgb_decode(x);
    if (curve == "srgbe") return select(less(x, 0), -srgb_decode(-x), srgb_decode(x));
    if (curve == "pq") return pq_decode_nits(x) / kUnitLuminance;
    int tenths = 0;
    const char* const end = curve.data() + curve.size();
    if (curve.size() != 3 || curve.front() != 'g') return std::nullopt;
    const auto [stop, error] = std::from_chars(curve.data() + 1, end, tenths);
    if (error != std::errc() || stop != end || tenths < 1) return std::nullopt;
    // Digital cinema's code values leave room above white.
    if (tenths == 26 && is_xyz(primaries)) return st428_decode(x);
    // Adobe RGB (1998) has 2 51/256.
    if (tenths == 22 && primaries == "adobergb") return power_decode(x, 563.0 / 256);
    return power_decode(x, tenths / 10.0);
}

/// `<curve>_<primaries>_<scene|display>`.
std::optional<SourceColor> by_interop_pattern(std::string_view text) {
    const std::string name = folded_name(text);
    const std::size_t first = name.find('_');
    const std::size_t last = name.rfind('_');
    if (first == std::string_view::npos || first == last) return std::nullopt;
    const std::string curve = name.substr(0, first);
    const std::string gamut = name.substr(first + 1, last - first - 1);
    const std::optional<Primaries> primaries = interop_primaries(gamut);
    const std::string state = name.substr(last + 1);
    if (!primaries && !is_xyz(gamut)) return std::nullopt;
    if (state != "scene" && state != "display") return std::nullopt;
    if (curve == "lin") {
        if (is_xyz(gamut)) return xyz_color(name, {});
        for (const InputSpace& space : all_input_spaces()) {
            if (space.primaries == *primaries) return SourceColor{space.id, space.primaries};
        }
        return SourceColor{name, *primaries};
    }
    const std::optional<Expr> decode = interop_curve(curve, gamut);
    if (!decode) return std::nullopt;
    SourceColor color = primaries ? encoded_color(name, {curve_stage(*decode)}, *primaries)
                                  : xyz_color(name, {curve_stage(*decode)});
    color.is_absolute = curve == "pq";
    return color;
}

/// A space of the config that is neither linear nor a display.
std::optional<SourceColor> by_encoded_space(std::string_view name) {
    for (const EncodedSpace& space : all_encoded_spaces()) {
        const bool is_named =
            is_same_name(space.title, name) || is_same_name(space.interop_id, name) ||
            std::any_of(space.aliases.begin(), space.aliases.end(),
                        [&](const std::string& alias) { return is_same_name(alias, name); });
        if (!is_named) continue;
        if (space.kind == EncodedSpace::Kind::display_reference) return xyz_color(space.title, {});
        if (space.decode.empty()) return SourceColor{space.title, space.primaries};
        return encoded_color(space.title, space.decode, space.primaries);
    }
    return std::nullopt;
}

/// An encoding of LUTs, with its parameters and its default primaries.
std::optional<SourceColor> by_input_encoding(std::string_view name) {
    const std::string id = folded_name(name.substr(0, name.find(':')));
    const std::vector<std::string> ids = input_encoding_names();
    if (std::find(ids.begin(), ids.end(), id) == ids.end()) return std::nullopt;
    const InputEncoding encoding = parse_input_encoding(name);
    const Primaries& primaries = find_input_space(encoding.default_input).primaries;
    const bool is_absolute = is_same_name(name, "pq");  // without a white of its own
    SourceColor color =
        encoded_color(is_absolute ? "pq" : encoding.id, {curve_stage(encoding.decode)}, primaries);
    color.is_absolute = is_absolute;
    return color;
}

std::optional<SourceColor> look_up_color(std::string_view name) {
    if (const InputSpace* space = look_up(all_input_spaces(), name))
        return SourceColor{space->id, space->primaries};
    if (const Display* display = look_up(all_displays(), name)) return color_of_display(*display);
    const Expr x = Expr::input();
    if (is_same_name(name, "Rec709"))
        return encoded_color("Rec709", {curve_stage(bt709_inverse_oetf(x))}, kRec709);
    if (const double exponent = exponent_of(name); exponent > 0) {
        return encoded_color("Gamma" + shortest(exponent), {curve_stage(power_decode(x, exponent))},
                             kRec709);
    }
    if (is_same_name(name, kUnknownColor)) return SourceColor{kUnknownColor, kRec709};
    for (const InteropName& named : kOtherInteropNames) {
        if (is_same_name(name, named.title)) return by_interop_pattern(named.id);
    }
    for (const auto& find :
         {by_interop_pattern, by_encoded_space, by_input_encoding, by_code_points}) {
        if (std::optional<SourceColor> color = find(name)) return color;
    }
    return std::nullopt;
}

}  // namespace

SourceColor encoded_color(std::string name, Pipeline decode, const Primaries& primaries) {
    return {std::move(name), primaries, std::move(decode)};
}

Pipeline hlg_display_decode(const Vector3& luminance) {
    const Expr x = Expr::input(0);
    return {
        named("decode", curve_stage(hlg_inverse_oetf(x), hlg_oetf(x))),
        ToneScaleStage{ToneScaleStage::Norm::luminance, luminance, hlg_ootf_luminance(x)},
        MatrixStage{scale(kIdentity3, kHlgUnit)},
    };
}

SourceColor xyz_color(std::string name, Pipeline decode) {
    decode.push_back(MatrixStage{inverse(rgb_to_xyz(kRec709))});
    return encoded_color(std::move(name), std::move(decode), kRec709);
}

SourceColor color_of_display(const Display& display) {
    SourceColor color = encoded_color(display.title, display.decode, display.primaries);
    color.is_absolute = display.is_hdr;
    // HLG's exponential of larger codes leaves the range of doubles, and its OOTF would be infinity
    // divided by infinity. Light of these codes is far beyond half floats.
    if (display.is_hdr) color.decode.insert(color.decode.begin(), ClampStage{-8, 8});
    return color;
}

const std::vector<InputSpace>& all_input_spaces() {
    // Aliases: names of the same space in Blender 3 and 4, OIIO, the ACES configs and the interop
    // forum.
    static const std::vector<InputSpace> spaces = {
        {"lin_rec709",
         "Linear Rec.709",
         {"Linear Rec.709 (sRGB)", "Linear", "lin_rec709_srgb", "lin_srgb", "lin_rec709_scene",
          "Utility - Linear - sRGB"},
         kRec709},
        {"lin_ap1", "ACEScg", {"lin_ap1_acescg", "lin_ap1_scene", "ACES - ACEScg"}, kAP1},
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

namespace {

std::vector<Display> make_displays() {
    std::vector<Display> displays = {
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
    // Its color space in the ACES configs; ours has the display's name, which Blender looks for.
    for (Display& display : displays)
        display.aliases.insert(display.aliases.begin(), display.title + " - Display");
    return displays;
}

}  // namespace

const std::vector<Display>& all_displays() {
    static const std::vector<Display> displays = make_displays();
    return displays;
}

const InputSpace& find_input_space(std::string_view name) {
    if (!look_up(all_input_spaces(), name) && look_up_color(name)) {
        std::vector<std::string> ids;
        for (const InputSpace& space : all_input_spaces())
            ids.push_back(space.id);
        throw Error(
            {.parameter = "input",
             .value = std::string(name) + ", a color of pictures",
             .expected = join_choices(ids) + " (for a LUT of encoded colors: <<input_encoding>>)"});
    }
    return find_named(all_input_spaces(), name, "input", {});
}

SourceColor find_source_color(std::string_view name) {
    if (std::optional<SourceColor> color = look_up_color(name)) return *color;
    // A namespace before an id of the Color Interop Forum: "An ID for Color Interop", 1.0.0.
    if (const std::size_t colon = name.find(':'); colon != std::string_view::npos) {
        if (std::optional<SourceColor> color = look_up_color(name.substr(colon + 1))) return *color;
    }
    std::vector<NamedChoice> choices;
    for (const SourceColorName& source : all_source_color_names()) {
        choices.push_back({source.id, source.aliases});
        choices.back().names.push_back(source.title);
    }
    throw Error({.parameter = "input",
                 .value = std::string(name),
                 .expected = "a name of <<list=inputs>>, such as lin_rec709, sRGB or ACEScct",
                 .suggestion = suggested_names(name, choices)});
}

std::vector<SourceColorName> all_source_color_names() {
    std::vector<SourceColorName> names;
    using Kind = SourceColorName::Kind;
    for (const InputSpace& space : all_input_spaces())
        names.push_back({space.id, space.title, space.aliases, Kind::linear});
    for (const Display& display : all_displays())
        names.push_back({display.id, display.title, display.aliases, Kind::display});
    for (const EncodedSpace& space : all_encoded_spaces()) {
        std::vector<std::string> aliases = space.aliases;
        if (!space.interop_id.empty()) aliases.push_back(space.interop_id);
        names.push_back({space.title, space.title, aliases, Kind::config});
    }
    for (const InteropName& name : kOtherInteropNames)
        names.push_back({name.id, name.title, {}, Kind::interop});
    names.push_back({kUnknownColor,
                     "files whose color nobody knows: the numbers, as linear Rec.709",
                     {},
                     Kind::interop});
    for (const std::string& id : input_encoding_names())
        names.push_back({id, parse_input_encoding(id).title, {}, Kind::encoding});
    for (const auto& [id, title] : kOtherNames)
        names.push_back({id, title, {}, Kind::other});
    return names;
}

const Display& find_display(std::string_view name) {
    return find_named(all_displays(), name, "display", {});
}

const Display& find_display(std::string_view name, const std::vector<std::string>& others) {
    return find_named(all_displays(), name, "display", others);
}

TONEWRIGHT_NAMESPACE_END
