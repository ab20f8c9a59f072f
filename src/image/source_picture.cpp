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

/// With the name of its file.
std::string error_of(const OIIO::ImageBuf& picture) {
    const std::string text = first_line(picture.geterror());
    const std::string name(picture.name());
    return text.find(name) == std::string::npos ? name + ": " + text : text;
}

}  // namespace

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

void multiply_by_alpha(OIIO::ImageBuf& picture) {
    const int alpha = picture.spec().alpha_channel;
    const int colors = std::min(alpha, 3);
    for (OIIO::ImageBuf::Iterator<float> p(picture); !p.done(); ++p) {
        for (int c = 0; c < colors; ++c)
            p[c] = p[c] * p[alpha];
    }
}

void load_divisor(const OIIO::TypeDesc& type, int alpha, const SpanSource& source,
                  const std::array<float*, 3>& rgb, double limit, float* to, std::uint8_t* covers,
                  std::size_t n) noexcept {
    const auto offset = static_cast<std::size_t>(alpha) * type.size();
    pixel_access(type)->load_float(source.pixels + offset, source.stride, to, n);
    const auto most = static_cast<float>(limit);
    for (std::size_t i = 0; i < n; ++i) {
        if (covers) covers[i] = to[i] != 0 && std::isfinite(to[i]) ? 1 : 0;
        to[i] = divisor_of(to[i], largest_of(rgb[0][i], rgb[1][i], rgb[2][i]), most);
    }
}

TONEWRIGHT_NAMESPACE_END
