// SPDX-License-Identifier: Apache-2.0
#include "picture/source_pixels.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <string_view>
#include <vector>

#include "picture/pixel_access.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

bool names_alpha(std::string_view name) {
    const std::string_view last = name.substr(name.rfind('.') + 1);  // all of it without a dot
    return is_equal_but_for_case(last, "A") || is_equal_but_for_case(last, "alpha");
}

/// Index of the alpha channel, or -1.
int find_alpha(const PictureSpec& spec) {
    if (spec.alpha_channel >= 0 && spec.alpha_channel < spec.nchannels) return spec.alpha_channel;
    if (spec.nchannels == 2 && names_alpha(spec.channel_name(1))) return 1;
    return -1;
}

}  // namespace

void complete_channel_names(PictureSpec& spec) {
    const auto is_there = [&](int channel) { return channel < spec.nchannels; };
    if (!is_there(spec.alpha_channel)) spec.alpha_channel = -1;
    if (!is_there(spec.z_channel)) spec.z_channel = -1;
    if (static_cast<int>(spec.channelnames.size()) == spec.nchannels) return;
    // The names of ImageSpec::default_channel_names().
    spec.channelnames.clear();
    spec.z_channel = -1;
    if (spec.alpha_channel < 0 && spec.nchannels > 3) spec.alpha_channel = 3;
    for (int c = 0; c < spec.nchannels; ++c) {
        constexpr std::array kNames = {"R", "G", "B", "A"};
        spec.channelnames.push_back(spec.nchannels == 1 ? "Y"
                                    : c < 4             ? kNames.at(static_cast<std::size_t>(c))
                                                        : fmt::format("channel{}", c));
    }
}

ChannelLayout channel_layout(const PictureSpec& spec) {
    const int alpha = find_alpha(spec);
    if (spec.nchannels == 2 && alpha != 1) {
        throw PictureError(
            fmt::format("picture has 2 channels ({}, {}); expected 1, 3 or more, or gray and alpha",
                        spec.channel_name(0), spec.channel_name(1)));
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

bool divides_by_alpha(const PictureSpec& spec, TonemapOptions::Unpremult unpremult) {
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
                    what, name_of(type)));
}

void load_color(const OIIO::TypeDesc& type, bool is_gray, const SpanSource& source,
                const std::array<float*, 3>& rgb, std::size_t n) noexcept {
    const PixelAccess& access = *pixel_access(type);
    for (std::size_t c = 0; c < 3; ++c) {
        if (is_gray && c > 0) {
            std::copy_n(rgb[0], n, rgb[c]);
        } else {
            access.load_float(source.pixels + c * size_of(type), source.stride, rgb[c], n);
        }
    }
}

void load_divisor(const OIIO::TypeDesc& type, int alpha, const SpanSource& source,
                  const std::array<float*, 3>& rgb, double limit, float* to, std::uint8_t* covers,
                  std::size_t n) noexcept {
    const auto offset = static_cast<std::size_t>(alpha) * size_of(type);
    pixel_access(type)->load_float(source.pixels + offset, source.stride, to, n);
    const auto most = static_cast<float>(limit);
    for (std::size_t i = 0; i < n; ++i) {
        if (covers) covers[i] = to[i] != 0 && std::isfinite(to[i]) ? 1 : 0;
        to[i] = divisor_of(to[i], largest_of(rgb[0][i], rgb[1][i], rgb[2][i]), most);
    }
}

TONEWRIGHT_NAMESPACE_END
