// SPDX-License-Identifier: Apache-2.0
#include "image/source_picture.h"

#include <OpenImageIO/imagebufalgo.h>
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <string>

#include "base/strings.h"
#include "tonewright/tonemap.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

bool names_alpha(const std::string& name) {
    return OIIO::Strutil::iequals(name, "A") || OIIO::Strutil::iequals(name, "alpha") ||
           OIIO::Strutil::iends_with(name, ".A") || OIIO::Strutil::iends_with(name, ".alpha");
}

/// Index of the alpha channel, or -1.
int find_alpha(const OIIO::ImageSpec& spec) {
    if (spec.alpha_channel >= 0 && spec.alpha_channel < spec.nchannels) return spec.alpha_channel;
    if (spec.nchannels == 2 && names_alpha(spec.channel_name(1))) return 1;
    return -1;
}

/// The attributes that state a picture's color.
constexpr std::array kColorMetadata = {"oiio:UnassociatedAlpha", "oiio:ColorSpace",
                                       "colorInteropID", "acesImageContainerFlag",
                                       "chromaticities"};

/// Names that state no color.
bool is_no_name(std::string_view name) {
    constexpr std::array kNone = {"", "scene_linear", "unknown", "raw", "data"};
    return std::any_of(kNone.begin(), kNone.end(), [&](const char* none) {
        return OIIO::Strutil::iequals(OIIO::string_view(name), none);
    });
}

/// Linear light of the primaries of an OpenEXR file.
SourceColor color_of_chromaticities(const float* floats) {
    std::array<double, 8> xy{};
    std::copy_n(floats, xy.size(), xy.begin());
    const Primaries primaries = {
        "chromaticities", {xy[0], xy[1]}, {xy[2], xy[3]}, {xy[4], xy[5]}, {xy[6], xy[7]}};
    // The file has floats, so primaries near those of a known space count as that space.
    constexpr double kRounding = 1e-6;
    const auto is_near = [](const Chromaticity& a, const Chromaticity& b) {
        return std::fabs(a.x - b.x) <= kRounding && std::fabs(a.y - b.y) <= kRounding;
    };
    for (const InputSpace& space : all_input_spaces()) {
        const Primaries& p = space.primaries;
        if (is_near(p.red, primaries.red) && is_near(p.green, primaries.green) &&
            is_near(p.blue, primaries.blue) && is_near(p.whitepoint, primaries.whitepoint)) {
            return {space.id, p};
        }
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
    return {"chromaticities " + text, primaries};
}

/// With the name of its file.
std::string error_of(const OIIO::ImageBuf& picture) {
    const std::string text = first_line(picture.geterror());
    const std::string name(picture.name());
    return text.find(name) == std::string::npos ? name + ": " + text : text;
}

}  // namespace

SourceColor source_color(const OIIO::ImageSpec& spec, std::string_view input) {
    if (!is_same_name(input, kAutoInput)) return find_source_color(input);
    for (const char* attribute : {"oiio:ColorSpace", "colorInteropID"}) {
        const std::string name = spec.get_string_attribute(attribute);
        if (is_no_name(name)) continue;
        try {
            SourceColor color = find_source_color(name);
            if (color.name != "lin_rec709") return color;
        } catch (const Error& e) {
            throw PictureError(
                fmt::format("{} of the picture: {}; or name an input space", attribute, e.what()));
        }
    }
    if (spec.get_int_attribute("acesImageContainerFlag", 0) == 1)
        return find_source_color("lin_ap0");
    const OIIO::ParamValue* xy =
        spec.find_attribute("chromaticities", OIIO::TypeDesc(OIIO::TypeDesc::FLOAT, 8));
    if (xy) return color_of_chromaticities(static_cast<const float*>(xy->data()));
    return find_source_color("lin_rec709");
}

OIIO::ImageSpec with_color_metadata_alone(const OIIO::ImageSpec& spec) {
    OIIO::ImageSpec result = spec;
    result.extra_attribs.clear();
    for (const char* name : kColorMetadata) {
        if (const OIIO::ParamValue* value = spec.find_attribute(name))
            result.extra_attribs.push_back(*value);
    }
    return result;
}

void complete_channel_names(OIIO::ImageSpec& spec) {
    const auto is_there = [&](int channel) { return channel < spec.nchannels; };
    if (!is_there(spec.alpha_channel)) spec.alpha_channel = -1;
    if (!is_there(spec.z_channel)) spec.z_channel = -1;
    if (static_cast<int>(spec.channelnames.size()) == spec.nchannels) return;
    const int alpha = spec.alpha_channel;
    spec.default_channel_names();
    if (alpha >= 0) spec.alpha_channel = alpha;
}

ChannelLayout channel_layout(const OIIO::ImageSpec& spec) {
    const int alpha = find_alpha(spec);
    if (spec.nchannels == 2 && alpha != 1) {
        throw PictureError(
            fmt::format("picture has 2 channels ({}, {}); expected 1, 3 or more, or gray and alpha",
                        std::string(spec.channel_name(0)), std::string(spec.channel_name(1))));
    }
    const auto has = [&](const char* name) {
        const std::vector<std::string>& names = spec.channelnames;
        return std::find(names.begin(), names.end(), name) != names.end();
    };
    if (has("RY") && has("BY")) {
        throw PictureError(
            "channels are Y, RY, BY: luminance and chroma; expected R, G, B, or Y alone "
            "(oiiotool --ch Y)");
    }
    const bool is_gray = spec.nchannels <= 2;
    if (alpha >= 0 && alpha < (is_gray ? 1 : 3)) {
        throw PictureError(
            fmt::format("alpha channel is {}; expected none, or {} and above: color comes first "
                        "(oiiotool --ch R,G,B,A)",
                        alpha, is_gray ? 1 : 3));
    }
    return {is_gray, alpha};
}

bool divides_by_alpha(const OIIO::ImageSpec& spec, TonemapOptions::Unpremult unpremult) {
    switch (unpremult) {
        case TonemapOptions::Unpremult::yes:
            return true;
        case TonemapOptions::Unpremult::no:
            return false;
        case TonemapOptions::Unpremult::automatic:
            break;
    }
    return spec.get_int_attribute("oiio:UnassociatedAlpha", 0) == 0;
}

void check_pixel_type(const char* what, const OIIO::TypeDesc& type) {
    if (pixel_access(type)) return;
    throw PictureError(
        fmt::format("{} pixel type is {}; expected an integer of 8, 16 or 32 bits, half, float or "
                    "double",
                    what, std::string(type.c_str())));
}

void check_source(const OIIO::ImageBuf& source) {
    const OIIO::ImageSpec& spec = source.spec();  // opens the file
    if (!source.initialized()) {
        throw Error(source.has_error() ? error_of(source)
                                       : "source is not initialized; expected a picture");
    }
    // OpenImageIO 3 reads the whole file here. Earlier errors are no news of it.
    const bool had_error = source.has_error();
    (void)source.localpixels();
    if (!had_error && source.has_error()) throw Error(error_of(source));
    if (source.deep()) {
        throw Error("source is deep; expected flat pixels (oiiotool --flatten)");
    }
    check_pixel_type("source", spec.format);
}

void check_was_read(const OIIO::ImageBuf& source, bool is_complete) {
    if (is_complete && (source.localpixels() || !source.has_error())) return;
    throw Error(source.has_error() ? error_of(source) : "source cannot be read");
}

OIIO::ImageBuf black_picture(const OIIO::ImageSpec& spec) {
    OIIO::ImageBuf picture(spec, OIIO::InitializePixels::No);
    if (!picture.localpixels()) {
        (void)picture.geterror();  // which would be printed otherwise
        throw std::bad_alloc();
    }
    OIIO::ImageBufAlgo::zero(picture);
    return picture;
}

void load_color(const OIIO::TypeDesc& type, bool is_gray, const SpanSource& source,
                const std::array<float*, 3>& rgb, std::size_t n) noexcept {
    const PixelAccess& access = *pixel_access(type);
    for (std::size_t c = 0; c < 3; ++c) {
        if (is_gray && c > 0) {
            std::copy_n(rgb[0], n, rgb[c]);
        } else {
            access.load_float(source.pixels + c * type.size(), source.stride, rgb[c], n);
        }
    }
}

void load_divisor(const OIIO::TypeDesc& type, int alpha, const SpanSource& source, float* to,
                  std::uint8_t* covers, std::size_t n) noexcept {
    const auto offset = static_cast<std::size_t>(alpha) * type.size();
    pixel_access(type)->load_float(source.pixels + offset, source.stride, to, n);
    for (std::size_t i = 0; i < n; ++i) {
        const bool is_divisor = to[i] != 0 && std::isfinite(to[i]);
        if (!is_divisor) to[i] = 1;
        if (covers) covers[i] = is_divisor ? 1 : 0;
    }
}

TONEWRIGHT_NAMESPACE_END
