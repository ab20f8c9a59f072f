// SPDX-License-Identifier: Apache-2.0
#include "picture/color_tags.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <string>
#include <string_view>

#include "base/format_number.h"
#include "tonewright/format_color.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

/// Facts about the numbers of a result.
struct Claim {
    std::string color_space;  // empty: nothing
    Primaries primaries;
    /// The name that find_source_color() knows. Empty: none.
    std::string readable;
};

constexpr std::string_view kGamma = "Gamma";

Claim power_claim(double exponent, const Primaries& primaries) {
    // OIIO parses the number, and its writers (PNG's gAMA) need the point: "Gamma2.0".
    std::string number = shortest(exponent);
    if (number.find('.') == std::string::npos) number += ".0";
    const std::string name = std::string(kGamma) + number;
    return {name, primaries, primaries == kRec709 ? name : ""};
}

/// Description of a display's code values in files, by its id.
struct DisplayCode {
    std::string_view id;
    IccCurve curve;          // of an SDR display
    CodePoints code_points;  // of an HDR display: ITU-T H.273, tables 2 and 3
    /// Color Interop Forum, "Color Space Encodings for Interchange". Empty: it has none.
    std::string_view interop_id;
};
constexpr CodePoints kNoPoints = {2, 2};  // "unspecified"
constexpr double kSrgbPower = 2.4;
constexpr std::array kDisplayCodes = {
    DisplayCode{"srgb", {kSrgbPower, true}, kNoPoints, "srgb_rec709_display"},
    DisplayCode{"display_p3", {kSrgbPower, true}, kNoPoints, "srgb_p3d65_display"},
    DisplayCode{"rec1886", {2.4}, kNoPoints, "g24_rec709_display"},
    DisplayCode{"rec2020", {2.4}, kNoPoints, ""},
    DisplayCode{"g22", {2.2}, kNoPoints, "g22_rec709_display"},
    DisplayCode{"rec2100_pq", {}, {9, 16}, "pq_rec2020_display"},
    DisplayCode{"rec2100_hlg", {}, {9, 18}, "hlg_rec2020_display"},
    DisplayCode{"p3d65_pq", {}, {12, 16}, "pq_p3d65_display"},
};

/// The X.Y of "GammaX.Y", or 0.
double power_of(std::string_view name) {
    if (name.substr(0, kGamma.size()) != kGamma) return 0;
    double power = 0;
    const char* end = name.data() + name.size();
    const auto [stop, error] = std::from_chars(name.data() + kGamma.size(), end, power);
    return error == std::errc() && stop == end && power >= 0.1 && power <= 10 ? power : 0;
}

/// `chromaticities`, or those of Rec.709 if there are none.
Primaries primaries_of(const PictureSpec& spec) {
    const PictureAttribute* xy =
        spec.find_attribute("chromaticities", OIIO::TypeDesc(OIIO::TypeDesc::FLOAT, 8));
    if (!xy) return kRec709;
    std::array<double, 8> p{};
    std::copy_n(xy->numbers<float>(), p.size(), p.begin());
    return {"chromaticities", {p[0], p[1]}, {p[2], p[3]}, {p[4], p[5]}, {p[6], p[7]}};
}

Claim claim_of_display(std::string_view name) {
    if (name == kLinearOutput) return {"Linear", kRec709, "lin_rec709"};
    const Display& display = find_display(name);
    Claim claim = {display.title, display.primaries, display.id};
    if (display.id == "srgb") claim.color_space = "sRGB";
    if (display.id == "g22") claim.color_space = power_claim(2.2, kRec709).color_space;
    // OIIO's "Rec709" is the camera curve of BT.709. Rec.1886 is the 2.4 power of a display.
    if (display.id == "rec1886") claim.color_space = power_claim(2.4, kRec709).color_space;
    return claim;
}

/// The space of scene-linear colors with these primaries, or null.
const InputSpace* space_of(const Primaries& primaries) {
    const std::vector<InputSpace>& spaces = all_input_spaces();
    const auto found = std::find_if(spaces.begin(), spaces.end(), [&](const InputSpace& space) {
        return space.primaries == primaries;
    });
    return found == spaces.end() ? nullptr : &*found;
}

Claim claim_of_operator(const ResolvedOperator& op) {
    if (const std::string display = op.output_display(); !display.empty())
        return claim_of_display(display);
    const Primaries primaries = op.output_primaries();
    if (op.output() == OutputKind::display_linear) {
        const InputSpace* space = space_of(primaries);
        // OIIO's names imply Rec.709: for other primaries there is none.
        return {primaries == kRec709 ? "Linear" : "", primaries, space ? space->id : ""};
    }
    Claim claim = power_claim(op.op->code_power, primaries);
    if (!(primaries == kRec709)) claim.color_space.clear();
    return claim;
}

/// The Color Interop Forum's identifier, or empty: the forum's list has fewer pairs of a curve and
/// primaries than its pattern of names allows.
std::string interop_id_of(const Claim& claim) {
    constexpr std::array<std::string_view, 5> kLinear = {"lin_rec709", "lin_rec2020", "lin_p3d65",
                                                         "lin_ap0", "lin_ap1"};
    if (std::find(kLinear.begin(), kLinear.end(), claim.readable) != kLinear.end())
        return claim.readable + "_scene";
    for (const DisplayCode& code : kDisplayCodes) {
        const bool is_it =
            code.id == claim.readable ||
            (code.id == "g22" && claim.readable == power_claim(2.2, kRec709).readable) ||
            (code.id == "rec1886" && claim.readable == power_claim(2.4, kRec709).readable);
        if (is_it) return std::string(code.interop_id);
    }
    return {};
}

void tag(const Claim& claim, PictureSpec& spec) {
    tag_as_unknown(spec);
    if (!claim.color_space.empty()) spec.attribute("oiio:ColorSpace", claim.color_space);
    // OpenImageIO drops oiio:ColorSpace where it writes OpenEXR.
    if (const std::string id = interop_id_of(claim); !id.empty()) {
        spec.attribute("colorInteropID", id);
    } else if (!claim.readable.empty()) {
        spec.attribute("tonewright:display", claim.readable);
    }
    if (claim.primaries == kRec709) return;  // the value of OpenEXR files without the attribute
    const Primaries& p = claim.primaries;
    std::array<float, 8> xy{};
    std::size_t i = 0;
    for (const Chromaticity& c : {p.red, p.green, p.blue, p.whitepoint}) {
        xy[i++] = static_cast<float>(c.x);
        xy[i++] = static_cast<float>(c.y);
    }
    spec.attribute("chromaticities", OIIO::TypeDesc(OIIO::TypeDesc::FLOAT, 8), xy.data());
}

}  // namespace

void erase_attributes(PictureSpec& spec, std::string_view name) {
    const bool begins_so = name.ends_with('*');
    if (begins_so) name.remove_suffix(1);
    std::erase_if(spec.attributes, [&](const PictureAttribute& attribute) {
        return begins_so ? starts_with_but_for_case(attribute.name, name)
                         : is_equal_but_for_case(attribute.name, name);
    });
}

void tag_as_unknown(PictureSpec& spec) {
    // Each of these attributes described the source. If a writer prefers one of them to
    // oiio:ColorSpace (as DPX does), the file would be wrong. oiio:Gamma repeats the name
    // "GammaX.Y", is deprecated, and makes OIIO's TGA writer divide by a power of alpha. A gain map
    // (hdrgm and the container that names it) belongs to the source's pixels, and is not copied.
    for (const char* stale : {
             "oiio:ColorSpace",
             "oiio:Gamma",
             "tonewright:file:*",
             "tonewright:display",
             "ICCProfile*",
             "photoshop:ICCProfile",
             "CICP",
             "colorInteropID",
             "Exif:ColorSpace",
             "Exif:Gamma",
             "Exif:InteroperabilityIndex",
             "tiff:ColorSpace",
             "png:gamma",
             "dpx:Transfer",
             "dpx:Colorimetric",
             "chromaticities",
             "adoptedNeutral",
             "whiteLuminance",
             "renderingTransform",
             "lookModTransform",
             "acesImageContainerFlag",
             "rla:ColorChannel",
             "rla:RedChroma",
             "rla:GreenChroma",
             "rla:BlueChroma",
             "rla:WhitePoint",
             "tonewright:*",
             "hdrgm:*",
             "Item:*",
             "Container:*",
             "GContainer:*",
             "rdf:parseType",
         }) {
        erase_attributes(spec, stale);
    }
}

void tag_as_result_of(const View& view, PictureSpec& spec) {
    tag(view.display == kNativeOutput ? claim_of_operator(view.op) : claim_of_display(view.display),
        spec);
}

void tag_as_shown_on(std::string_view display, PictureSpec& spec) {
    tag(claim_of_display(display), spec);
}

std::optional<TaggedColor> tagged_color(const PictureSpec& spec) {
    const std::string name = spec.get_string_attribute("oiio:ColorSpace");
    if (name == "Linear") return TaggedColor{"linear light", primaries_of(spec), IccCurve{}};
    if (name == "sRGB") return TaggedColor{"sRGB", primaries_of(spec), IccCurve{kSrgbPower, true}};
    if (const double power = power_of(name); power > 0) {
        return TaggedColor{fmt::format("Gamma {}", shortest(power)), primaries_of(spec),
                           IccCurve{power}};
    }
    for (const Display& display : all_displays()) {
        if (display.title != name) continue;
        const auto* code = std::find_if(kDisplayCodes.begin(), kDisplayCodes.end(),
                                        [&](const auto& c) { return c.id == display.id; });
        if (code == kDisplayCodes.end()) return {};
        TaggedColor color = {display.title, display.primaries};
        if (display.is_hdr) {
            color.code_points = code->code_points;
        } else {
            color.curve = code->curve;
        }
        return color;
    }
    return {};
}

ColorDescription describe_color(const PictureSpec& spec, std::string_view format) {
    const FormatColor* row = find_format_color(format);
    const std::optional<TaggedColor> color = tagged_color(spec);
    // The rest keep the attributes themselves.
    if (!row || !color) return {};
    const bool is_png = format == "png";
    const bool is_srgb = color->curve && color->curve->is_srgb && color->primaries == kRec709;
    const bool is_linear = color->curve && color->curve->exponent == 1;
    if (is_png && is_srgb) return {};  // OpenImageIO writes the chunk sRGB
    ColorDescription description;
    if (color->curve && row->has_icc && has_icc()) {
        description.icc =
            write_display_icc(color->primaries, *color->curve, color->name, spec.nchannels < 3);
        return description;
    }
    if (is_png && color->code_points) {
        description.chunk = cicp_chunk(*color->code_points);
        return description;
    }
    // For some formats, applications always assume linear light; for others, sRGB.
    const bool assumes_linear = row->meaning == FormatMeaning::linear;
    const bool is_presumed = assumes_linear ? is_linear : is_srgb;
    const bool is_said =
        row->has_power && color->curve && !color->curve->is_srgb && color->primaries == kRec709;
    if (is_presumed || is_said) return {};
    description.missing =
        assumes_linear ? fmt::format(
                             "most applications read {} as linear light, but the file holds code "
                             "values of {}; for linear light, use <<display=linear>>",
                             row->title, color->name)
                       : fmt::format("{} does not say that its colors are {}: viewers assume sRGB",
                                     row->title, color->name);
    return description;
}

TONEWRIGHT_NAMESPACE_END
