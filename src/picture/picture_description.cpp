// SPDX-License-Identifier: Apache-2.0
#include "picture/picture_description.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <utility>

#include "base/format_number.h"
#include "base/strings.h"
#include "lut/icc_source.h"
#include "picture/color_tags.h"
#include "picture/header_tags.h"
#include "tonewright/engine.h"
#include "tonewright/format_color.h"
#include "tonewright/source_color.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

using OIIO::TypeDesc;

/// A header that states a color, and what the color is.
struct Found {
    SourceColor color;
    std::string rule;
};
using Finding = std::optional<Found>;

/// Names that state no color.
bool is_no_name(std::string_view name) {
    constexpr std::array kNone = {"", "scene_linear", "unknown", "raw", "data"};
    return std::any_of(kNone.begin(), kNone.end(),
                       [&](const char* none) { return is_equal_but_for_case(name, none); });
}

bool is_near(const Primaries& a, const Primaries& b, double tolerance) {
    const auto near = [&](const Chromaticity& p, const Chromaticity& q) {
        return std::fabs(p.x - q.x) <= tolerance && std::fabs(p.y - q.y) <= tolerance;
    };
    return near(a.red, b.red) && near(a.green, b.green) && near(a.blue, b.blue) &&
           near(a.whitepoint, b.whitepoint);
}

const PictureAttribute* eight_floats(const PictureSpec& spec, const char* name) {
    return spec.find_attribute(name, TypeDesc(TypeDesc::FLOAT, 8));
}

/// Primaries of a header, those of a known space if they are so near that digits of the format
/// explain the difference.
/// @param digits  the last digit that the format has
/// @throws PictureError  they give no colors
Primaries primaries_of(const PictureAttribute& value, double digits, std::string& name) {
    const auto* const floats = value.numbers<float>();
    std::array<double, 8> xy{};
    std::copy_n(floats, xy.size(), xy.begin());
    const Primaries primaries = {
        "chromaticities", {xy[0], xy[1]}, {xy[2], xy[3]}, {xy[4], xy[5]}, {xy[6], xy[7]}};
    for (const InputSpace& space : all_input_spaces()) {
        if (!is_near(space.primaries, primaries, digits)) continue;
        name = space.id;
        return space.primaries;
    }
    std::string text;
    bool are_numbers = true;
    for (int i = 0; i < 8; ++i) {
        text += fmt::format("{}{}", i > 0 ? "," : "", floats[i]);
        if (!(std::fabs(floats[i]) <= 10)) are_numbers = false;
    }
    // Three primaries on a line give no colors, and a white without luminance is not white.
    const double area =
        (primaries.green.x - primaries.red.x) * (primaries.blue.y - primaries.red.y) -
        (primaries.blue.x - primaries.red.x) * (primaries.green.y - primaries.red.y);
    if (!are_numbers || !(std::fabs(area) > 1e-6) || !(primaries.whitepoint.y > 0)) {
        throw PictureError(
            fmt::format("chromaticities of the picture are {}; expected red, green, blue "
                        "and white, or an input space that you name",
                        text));
    }
    name = "chromaticities " + text;
    return primaries;
}

SourceColor named_color(const char* attribute, const std::string& name) {
    try {
        return find_source_color(name);
    } catch (const Error& e) {
        Problem problem = within(std::string(attribute) + " of the picture", e.problem());
        problem.expected += ", or name an input space";
        throw PictureError(problem);
    }
}

// The headers, one function each. ------------------------------------------------------------

Finding by_cicp(const PictureSpec& spec) {
    const PictureAttribute* value = spec.find_attribute(kCicpTag, TypeDesc(TypeDesc::INT, 4));
    if (!value) return std::nullopt;
    const auto* points = value->numbers<int>();
    constexpr int kUnspecified = 2;
    // nclx with nothing but a matrix says how to decode YCbCr, and no color.
    if (points[0] == kUnspecified && points[1] == kUnspecified) return std::nullopt;
    const std::string format = spec.get_string_attribute(file_tag::kFormat);
    const std::string rule = format == "png" ? "cICP" : "nclx";
    std::optional<SourceColor> color = color_of_code_points(points[0], points[1]);
    if (!color) {
        throw PictureError(
            fmt::format("{} of the picture is {}/{} ({}); expected code points of "
                        "ITU-T H.273 with a meaning, or name an input space",
                        rule, points[0], points[1], code_point_names(points[0], points[1])));
    }
    if (format == "png" && points[2] != 0) {
        throw PictureError(
            fmt::format("cICP of the picture has matrix {}; expected 0 (RGB)", points[2]));
    }
    if (format == "png" && points[3] == 0) {
        // W3C PNG, 11.3.2.6: a video full range flag of 0 is narrow range, whose codes of 8 bits
        // are 16 to 235, and 2^(n-8) times that with n bits.
        const int bits = spec.get_int_attribute("oiio:BitsPerSample",
                                                static_cast<int>(8 * size_of(spec.format)));
        const double scale_of = std::exp2(bits - 8) / (std::exp2(bits) - 1);
        const Expr x = Expr::input();
        const Expr full = (x - 16 * scale_of) / (219 * scale_of);
        color->decode.insert(color->decode.begin(), curve_stage(full));
        color->name += fmt::format(" narrow range {}", bits);
    }
    return Found{std::move(*color), rule};
}

Finding by_icc(const PictureSpec& spec) {
    const PictureAttribute* value = spec.find_attribute("ICCProfile");
    if (!value || value->type.basetype != TypeDesc::UINT8) return std::nullopt;
    const std::string_view bytes(value->numbers<char>(), value->data.size());
    IccSource icc;
    try {
        icc = color_of_icc(bytes, spec.nchannels < 3 ? 1 : 3, "the picture");
    } catch (const Error& e) {
        throw PictureError(fmt::format("{}; or name an input space", e.text()));
    }
    if (icc.code_points) {
        const auto [primaries, transfer] = *icc.code_points;
        if (std::optional<SourceColor> color = color_of_code_points(primaries, transfer))
            return Found{std::move(*color), "cicp of the ICC profile"};
    }
    const bool is_named = !icc.description.empty() && icc.color.name != icc.description;
    return Found{std::move(icc.color),
                 is_named ? fmt::format("ICC profile {}", icc.description) : "ICC profile"};
}

Finding by_srgb_chunk(const PictureSpec& spec) {
    if (!spec.find_attribute(file_tag::kSrgb)) return std::nullopt;
    return Found{find_source_color("sRGB"), "sRGB chunk"};
}

/// The power and the primaries of PNG, TIFF and BMP.
Finding by_gamma(const PictureSpec& spec) {
    const float gamma = spec.get_float_attribute(file_tag::kGamma, 0);
    const PictureAttribute* xy = eight_floats(spec, file_tag::kPrimaries);
    if (!(gamma > 0) && !xy) return std::nullopt;
    std::string space = "lin_rec709";
    constexpr double kDigits = 2e-5;  // PNG counts hundred-thousandths
    const Primaries primaries = xy ? primaries_of(*xy, kDigits, space) : kRec709;
    const bool is_png = spec.get_string_attribute(file_tag::kFormat) == "png";
    const std::string rule = std::string(gamma > 0 ? (is_png ? "gAMA" : "gamma") : "") +
                             (gamma > 0 && xy ? " and " : "") +
                             (xy ? (is_png ? "cHRM" : "primaries") : "");
    const Expr x = Expr::input();
    if (!(gamma > 0)) {
        if (is_floating_point(spec.format)) return Found{{space, primaries}, rule};
        SourceColor color = find_source_color("sRGB");
        if (primaries == kRec709) return Found{color, rule};
        return Found{{"sRGB curve, " + space, primaries, color.decode}, rule};
    }
    // 45455 is 2.2 with the digits that the chunk has.
    const double power = std::round(static_cast<double>(gamma) * 1e3) / 1e3;
    if (power == 1) return Found{{space, primaries}, rule};
    if (!(power >= 0.1 && power <= 10)) {
        throw PictureError(
            fmt::format("gamma of the picture is {}; expected [0.1, 10], or name an "
                        "input space",
                        shortest(power)));
    }
    SourceColor color = find_source_color("Gamma" + shortest(power));
    if (primaries == kRec709) return Found{color, rule};
    return Found{{fmt::format("{}, {}", color.name, space), primaries, color.decode}, rule};
}

Finding by_interop_id(const PictureSpec& spec) {
    const std::string name = spec.get_string_attribute("colorInteropID");
    if (is_no_name(name)) return std::nullopt;
    return Found{named_color("colorInteropID", name), "colorInteropID"};
}

/// Tonewright's own tag, unless another program has written the file since.
Finding by_own_tag(const PictureSpec& spec) {
    const std::string software = spec.get_string_attribute("Software");
    const bool is_own = software.empty() || software.starts_with("Tonewright ");
    if (!is_own) return std::nullopt;
    std::string display = spec.get_string_attribute("tonewright:display");
    std::string rule = "tonewright:display";
    if (display.empty()) {
        // Formats without such tags keep the text of the program.
        constexpr std::string_view kDisplay = ", display ";
        const std::size_t at = software.find(kDisplay);
        if (at == std::string::npos) return std::nullopt;
        display = software.substr(at + kDisplay.size());
        rule = "Software";
    }
    display = display.substr(0, display.find(','));
    if (display == kLinearOutput) return Found{find_source_color("lin_rec709"), rule};
    try {
        return Found{find_source_color(display), rule};
    } catch (const Error&) {
        return std::nullopt;  // `native`, or a name that was cut
    }
}

Finding by_aces_flag(const PictureSpec& spec) {
    if (spec.get_int_attribute("acesImageContainerFlag", 0) != 1) return std::nullopt;
    return Found{find_source_color("lin_ap0"), "acesImageContainerFlag"};
}

/// Linear light of stated primaries.
Finding by_chromaticities(const PictureSpec& spec) {
    const PictureAttribute* xy = eight_floats(spec, "chromaticities");
    if (!xy) return std::nullopt;
    const bool is_text = spec.get_string_attribute(file_tag::kFormat) == "hdr";
    std::string space;
    // OpenEXR has floats; Radiance has digits, four at most in common files.
    const Primaries primaries = primaries_of(*xy, is_text ? 1e-4 : 1e-6, space);
    return Found{{space, primaries}, is_text ? "PRIMARIES" : "chromaticities"};
}

/// JEITA CP-3451 (Exif 2.3), 4.6.5 and annex: 1 is sRGB; "R03" is DCF's optional space, Adobe RGB.
Finding by_exif(const PictureSpec& spec) {
    const int space = spec.get_int_attribute("Exif:ColorSpace", 0);
    const std::string index = spec.get_string_attribute("Exif:InteroperabilityIndex");
    if (index == "R03" && space != 1) {
        constexpr Primaries kAdobeRgb = {
            "Adobe RGB (1998)", {0.64, 0.33}, {0.21, 0.71}, {0.15, 0.06}, kD65};
        constexpr double kAdobePower = 563.0 / 256;  // Adobe RGB (1998), 4.3.1.2
        SourceColor color = find_source_color("Gamma" + shortest(kAdobePower));
        return Found{{"Adobe RGB", kAdobeRgb, color.decode}, "Exif interoperability R03"};
    }
    if (space == 1) return Found{find_source_color("sRGB"), "Exif ColorSpace"};
    return std::nullopt;
}

/// The name that OpenImageIO gives, unless it is what its reader assumes for every file.
Finding by_oiio_name(const PictureSpec& spec) {
    const std::string name = spec.get_string_attribute("oiio:ColorSpace");
    // OpenImageIO calls every PNG without a tag sRGB; other names are those of a text chunk.
    const bool is_png = spec.get_string_attribute(file_tag::kFormat) == "png";
    if (is_no_name(name) || (is_png && name == "sRGB")) return std::nullopt;
    SourceColor color = named_color("oiio:ColorSpace", name);
    if (color.name == "lin_rec709") return std::nullopt;
    return Found{std::move(color), "oiio:ColorSpace"};
}

/// OpenImageIO's names of the video of SMPTE ST 268:2003, table 5A, with ITU-T H.273's primaries:
/// 1 of HDTV, 5 of 625 lines, 6 of 525 lines.
struct DpxVideo {
    const char* name;
    int primaries;
};
constexpr std::array kDpxVideo = {
    DpxVideo{"Unspecified video", 1},    DpxVideo{"SMPTE 274M", 1},
    DpxVideo{"ITU-R 709-4", 1},          DpxVideo{"ITU-R 601-5 system B or G", 5},
    DpxVideo{"ITU-R 601-5 system M", 6}, DpxVideo{"NTSC composite video", 6},
    DpxVideo{"PAL composite video", 5},
};

Finding by_dpx_transfer(const PictureSpec& spec) {
    const std::string transfer = spec.get_string_attribute("dpx:Transfer");
    const std::string rule = "dpx:Transfer " + transfer;
    if (transfer == "Printing density" || transfer == "Logarithmic")
        return Found{find_source_color("Cineon"), rule};
    if (transfer == "Linear") return Found{find_source_color("lin_rec709"), rule};
    for (const DpxVideo& video : kDpxVideo) {
        if (transfer != video.name) continue;
        if (auto color = color_of_code_points(video.primaries, 1))
            return Found{std::move(*color), rule};
    }
    // A power that the file states.
    const std::string name = spec.get_string_attribute("oiio:ColorSpace");
    if (starts_with_but_for_case(name, "gamma"))
        return Found{named_color("oiio:ColorSpace", name), "gamma of the header"};
    return std::nullopt;
}

using Rule = Finding (*)(const PictureSpec&);

/// The order in which the headers of a format count.
std::vector<Rule> rules_of(std::string_view format) {
    if (format.empty())  // a picture in memory, of which other programs may have changed the pixels
        return {by_oiio_name, by_interop_id, by_aces_flag, by_chromaticities};
    // W3C PNG (third edition), 4.3: cICP, iCCP, sRGB, gAMA and cHRM.
    if (format == "png")
        return {by_cicp, by_icc, by_srgb_chunk, by_gamma, by_own_tag, by_oiio_name};
    // ISO/IEC 23008-12, 6.5.5: a profile describes colors better than code points.
    if (format == "heif") return {by_icc, by_cicp, by_exif};
    if (format == "openexr")
        return {by_interop_id, by_own_tag, by_icc, by_aces_flag, by_chromaticities, by_oiio_name};
    if (format == "hdr") return {by_chromaticities};
    if (format == "dpx" || format == "cineon") return {by_own_tag, by_dpx_transfer};
    if (format == "rla") return {by_own_tag, by_gamma, by_oiio_name};
    if (format == "pnm") return {by_own_tag};  // OpenImageIO calls all of them "Rec709"
    if (format == "jpeg" || format == "webp" || format == "tiff" || format == "psd" ||
        format == "bmp" || format == "jpeg2000")
        return {by_icc, by_interop_id, by_srgb_chunk, by_exif, by_gamma, by_own_tag};
    return {by_cicp,      by_icc,       by_interop_id, by_own_tag,
            by_oiio_name, by_aces_flag, by_gamma,      by_chromaticities};
}

/// The color of files of the format if their header says nothing.
Found default_of(const PictureSpec& spec, std::string_view format) {
    const FormatColor* row =
        find_format_color(format, spec.get_string_attribute(file_tag::kExtension));
    const bool is_float = is_floating_point(spec.format);
    const std::string space(!row ? "lin_rec709" : is_float ? row->float_space : row->integer_space);
    // The config's name of the same curve.
    const bool is_srgb = space == "sRGB - Texture";
    std::string rule = "default";
    if (row) {
        rule += fmt::format(" of {}", row->title);
        if (row->integer_space != row->float_space)
            rule += is_float ? " with float pixels" : " with integer pixels";
    }
    return {find_source_color(is_srgb ? "sRGB" : space), rule};
}

/// Names of other fields of the same header that say something else.
void add_contradictions(std::vector<std::string>& ignored, const PictureSpec& spec,
                        const std::vector<Rule>& rules, const Found& chosen) {
    // A few saturated colors show whether two descriptions differ.
    constexpr std::array<std::array<double, 3>, 3> kCodes = {
        {{0.75, 0.25, 0.1}, {0.1, 0.6, 0.3}, {0.2, 0.2, 0.9}}};
    const auto light_of = [&](const SourceColor& color) {
        Pipeline stages = color.decode;
        stages.emplace_back(MatrixStage{rgb_to_rgb(color.primaries, kRec709)});
        const ReferenceEngine engine(stages);
        std::array<std::array<double, 3>, 3> light{};
        for (std::size_t i = 0; i < kCodes.size(); ++i)
            light[i] = engine(kCodes[i]);
        return light;
    };
    const auto differ = [&](const SourceColor& a, const SourceColor& b) {
        if (a.convert || b.convert) return a.name != b.name;
        const auto x = light_of(a);
        const auto y = light_of(b);
        constexpr double kSame = 0.02;  // of the largest channel: 2.2 and sRGB are the same
        for (std::size_t i = 0; i < x.size(); ++i) {
            for (std::size_t c = 0; c < 3; ++c) {
                const double most =
                    std::max({std::fabs(x[i][0]), std::fabs(x[i][1]), std::fabs(x[i][2]), 1e-6});
                if (!(std::fabs(x[i][c] - y[i][c]) <= kSame * most)) return true;
            }
        }
        return false;
    };
    bool is_after = false;
    for (const Rule rule : rules) {
        Finding other;
        try {
            other = rule(spec);
        } catch (const Error&) {
            continue;  // a damaged field of lower rank
        }
        if (!other) continue;
        if (!is_after) {
            is_after = true;
            continue;
        }
        if (other->rule == "oiio:ColorSpace") continue;  // OpenImageIO's, not the file's
        if (differ(chosen.color, other->color)) {
            ignored.push_back(fmt::format("{}: it says {}, but {} decides", other->rule,
                                          other->color.name, chosen.rule));
        }
    }
}

/// Empty for a picture in memory, also for one whose pixels were converted since it was read.
std::string format_of(const PictureSpec& spec) {
    const std::string space = spec.get_string_attribute("oiio:ColorSpace");
    if (space != std::string(spec.get_string_attribute(file_tag::kColorSpace))) return {};
    return spec.get_string_attribute(file_tag::kFormat);
}

std::string transfer_of(const SourceColor& color) {
    if (color.convert) return "LUT of the profile";
    if (color.decode.empty()) return "linear";
    for (const auto& [id, transfer] :
         {std::pair("srgb", "sRGB"), std::pair("display_p3", "sRGB"),
          std::pair("rec1886", "BT.1886"), std::pair("rec2020", "BT.1886"),
          std::pair("g22", "gamma 2.2"), std::pair("rec2100_pq", "PQ"),
          std::pair("rec2100_hlg", "HLG"), std::pair("p3d65_pq", "PQ")}) {
        if (find_display(id).title == color.name) return transfer;
    }
    return color.name;
}

std::string alpha_kind(const PictureSpec& spec) {
    if (spec.alpha_channel < 0 || spec.alpha_channel >= spec.nchannels) return "none";
    return spec.get_int_attribute("oiio:UnassociatedAlpha", 0) != 0 ? "straight" : "associated";
}

/// The attributes that describe_picture() reads.
constexpr std::array kMetadata = {"oiio:UnassociatedAlpha",
                                  "oiio:ColorSpace",
                                  "oiio:BitsPerSample",
                                  "colorInteropID",
                                  "acesImageContainerFlag",
                                  "chromaticities",
                                  "tonewright:display",
                                  "Software",
                                  "ICCProfile",
                                  "Exif:ColorSpace",
                                  "Exif:InteroperabilityIndex",
                                  "dpx:Transfer",
                                  file_tag::kExtension,
                                  kCicpTag,
                                  file_tag::kFormat,
                                  file_tag::kColorSpace,
                                  file_tag::kSrgb,
                                  file_tag::kGamma,
                                  file_tag::kPrimaries,
                                  file_tag::kImpossible,
                                  file_tag::kLight,
                                  file_tag::kLightColor};

constexpr int kLightNumbers = 10;

/// The light that tag_as_light() stored.
Finding tagged_light(const PictureSpec& spec) {
    const PictureAttribute* value =
        spec.find_attribute(file_tag::kLightColor, TypeDesc(TypeDesc::DOUBLE, kLightNumbers));
    if (!value) return {};
    const auto* n = value->numbers<double>();
    SourceColor color{spec.get_string_attribute(file_tag::kLight),
                      {"", {n[0], n[1]}, {n[2], n[3]}, {n[4], n[5]}, {n[6], n[7]}}};
    color.is_absolute = n[8] != 0;
    color.scale = n[9];
    return Found{std::move(color), "resized"};
}

Found color_of(const PictureSpec& spec, std::string_view input, std::vector<std::string>* ignored) {
    if (Finding light = tagged_light(spec)) return std::move(*light);
    if (!is_same_name(input, kAutoInput)) return {find_source_color(input), "<<input>>"};
    if (const std::string why = spec.get_string_attribute(file_tag::kImpossible); !why.empty())
        throw PictureError(why);
    const std::string format = format_of(spec);
    const std::vector<Rule> rules = rules_of(format);
    for (const Rule rule : rules) {
        Finding found = rule(spec);
        if (!found) continue;
        if (ignored) add_contradictions(*ignored, spec, rules, *found);
        return std::move(*found);
    }
    return default_of(spec, format);
}

}  // namespace

PictureDescription describe_picture(const PictureSpec& spec, std::string_view input) {
    PictureDescription description;
    description.ignored = ignored_of(spec);
    Found found = color_of(spec, input, &description.ignored);
    description.color = std::move(found.color);
    description.rule = std::move(found.rule);
    description.transfer = transfer_of(description.color);
    description.orientation = orientation_of(spec);
    description.layer = spec.get_string_attribute(file_tag::kLayer);
    description.subimage = spec.get_string_attribute(file_tag::kSubimage);
    description.units = description.color.is_absolute ? "cd/m2" : "relative";
    description.alpha = alpha_kind(spec);
    return description;
}

SourceColor source_color(const PictureSpec& spec, std::string_view input) {
    return color_of(spec, input, nullptr).color;
}

PictureSpec described_spec(PictureSpec spec, std::string_view format) {
    if (spec.find_attribute(file_tag::kFormat) || format.empty()) return spec;
    // OpenImageIO has read it. The name is what its reader gives, or a program has set another.
    const std::string space = spec.get_string_attribute("oiio:ColorSpace");
    constexpr std::array kReaders = {"",       "sRGB",   "srgb_rec709_scene", "Linear",
                                     "linear", "Rec709", "lin_rec709",        "lin_rec709_scene"};
    const bool is_linear =
        is_equal_but_for_case(space, "linear") || starts_with_but_for_case(space, "lin_rec709");
    const FormatColor* row = find_format_color(format);
    const bool holds_light = row && row->meaning == FormatMeaning::linear;
    if ((is_linear && !holds_light) ||
        std::find(kReaders.begin(), kReaders.end(), space) == kReaders.end())
        return spec;
    spec.attribute(file_tag::kFormat, format);
    spec.attribute(file_tag::kColorSpace, space);
    return spec;
}

PictureSpec with_color_metadata_alone(const PictureSpec& spec) {
    PictureSpec result;
    copy_structure(spec, result);
    for (const char* name : kMetadata) {
        if (const PictureAttribute* value = spec.find_attribute(name))
            result.attributes.push_back(*value);
    }
    return result;
}

PictureSpec converted_spec(const PictureSpec& spec, const SourceColor& color) {
    PictureSpec result = spec;
    result.format = OIIO::TypeFloat;
    result.channelformats.clear();
    tag_as_unknown(result);
    result.attribute("oiio:ColorSpace", "Linear");
    if (!(color.primaries == kRec709)) {
        const Primaries& p = color.primaries;
        const std::array<float, 8> xy = {
            static_cast<float>(p.red.x),        static_cast<float>(p.red.y),
            static_cast<float>(p.green.x),      static_cast<float>(p.green.y),
            static_cast<float>(p.blue.x),       static_cast<float>(p.blue.y),
            static_cast<float>(p.whitepoint.x), static_cast<float>(p.whitepoint.y)};
        result.attribute("chromaticities", TypeDesc(TypeDesc::FLOAT, 8), xy.data());
    }
    return result;
}

void tag_as_light(PictureSpec& spec, const SourceColor& color) {
    const Primaries& p = color.primaries;
    const std::array<double, kLightNumbers> numbers = {
        p.red.x,        p.red.y,        p.green.x,
        p.green.y,      p.blue.x,       p.blue.y,
        p.whitepoint.x, p.whitepoint.y, color.is_absolute ? 1.0 : 0.0,
        color.scale};
    spec.attribute(file_tag::kLight, "light of " + color.name);
    spec.attribute(file_tag::kLightColor, TypeDesc(TypeDesc::DOUBLE, kLightNumbers),
                   numbers.data());
}

int orientation_of(const PictureSpec& spec) {
    const int orientation = spec.get_int_attribute("Orientation", 1);
    return orientation >= 1 && orientation <= 8 ? orientation : 1;
}

TONEWRIGHT_NAMESPACE_END
