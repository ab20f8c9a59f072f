// SPDX-License-Identifier: Apache-2.0
#include "image/source_picture.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "image/message.h"

namespace tonewright {
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

}  // namespace

ChannelLayout channel_layout(const OIIO::ImageSpec& spec) {
    const int alpha = find_alpha(spec);
    if (spec.nchannels == 2 && alpha != 1) {
        throw Error(
            fmt::format("picture has 2 channels ({}, {}); expected 1, 3 or more, or grey and alpha",
                        std::string(spec.channel_name(0)), std::string(spec.channel_name(1))));
    }
    const bool is_grey = spec.nchannels <= 2;
    if (alpha >= 0 && alpha < (is_grey ? 1 : 3)) {
        throw Error(
            fmt::format("alpha channel is {}; expected none or {} and above: color comes first "
                        "(oiiotool --ch R,G,B,A)",
                        alpha, is_grey ? 1 : 3));
    }
    return {is_grey, alpha};
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
    throw Error(
        fmt::format("{} pixel type is {}; expected an integer of 8, 16 or 32 bits, half, float or "
                    "double",
                    what, std::string(type.c_str())));
}

void check_source(const OIIO::ImageBuf& source) {
    const OIIO::ImageSpec& spec = source.spec();  // opens the file
    if (!source.initialized()) {
        throw Error(source.has_error() ? first_line(source.geterror())
                                       : "source is not initialized; expected a picture");
    }
    if (source.deep()) {
        throw Error("source is deep; expected flat pixels (oiiotool --flatten)");
    }
    check_pixel_type("source", spec.format);
}

void check_was_read(const OIIO::ImageBuf& source, bool is_complete) {
    if (is_complete && (source.localpixels() || !source.has_error())) return;
    throw Error(source.has_error() ? first_line(source.geterror()) : "source cannot be read");
}

void load_color(const OIIO::TypeDesc& type, bool is_grey, const SpanSource& source,
                const std::array<float*, 3>& rgb, std::size_t n) noexcept {
    const PixelAccess& access = *pixel_access(type);
    for (std::size_t c = 0; c < 3; ++c) {
        if (is_grey && c > 0) {
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

}  // namespace tonewright
