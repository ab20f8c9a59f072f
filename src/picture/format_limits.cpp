// SPDX-License-Identifier: Apache-2.0
#include "picture/format_limits.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <numeric>

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

using Alpha = FileAlpha;
using Windows = FileWindows;

// Measured with OpenImageIO 2.4.7 by writing and reading each layout. Sizes: of the formats'
// headers, of libjpeg, libwebp and of OpenJPEG's six levels of resolution.
constexpr std::array kFormats = {
    FormatLimits{"openexr", "OpenEXR", true, true, true, true, true, Alpha::associated,
                 Windows::all},
    FormatLimits{"tiff", "TIFF", true, true, true, true, true, Alpha::either,
                 Windows::not_negative},
    FormatLimits{"png", "PNG", true, true, true, true, false, Alpha::straight},
    FormatLimits{"jpeg", "JPEG", true, false, true, false, false, Alpha::none, Windows::none, 1,
                 65500},
    FormatLimits{"webp", "WebP", false, false, true, true, false, Alpha::straight_by_writer,
                 Windows::none, 1, 16383},
    FormatLimits{"heif", "HEIF and AVIF", false, false, true, true, false, Alpha::straight},
    FormatLimits{"jpeg2000", "JPEG 2000", true, false, true, true, false, Alpha::straight,
                 Windows::none, 32},
    FormatLimits{"targa", "Targa", true, false, true, true, false, Alpha::straight, Windows::none,
                 1, 65535},
    FormatLimits{"bmp", "BMP", true, false, true, true, false, Alpha::associated},
    FormatLimits{"gif", "GIF", false, false, true, true, false, Alpha::associated, Windows::none, 1,
                 65535},
    FormatLimits{"ico", "ICO", false, false, false, true, false, Alpha::associated, Windows::none,
                 1, 256, false, true},
    FormatLimits{"iff", "IFF", false, false, true, true, false, Alpha::associated, Windows::none, 1,
                 8192},
    FormatLimits{"sgi", "SGI", true, false, true, true, true, Alpha::associated, Windows::none, 1,
                 65534},
    FormatLimits{"dpx", "DPX", true, false, true, true, false, Alpha::associated, Windows::none, 1,
                 0x7FFFFFFF, true},
    FormatLimits{"hdr", "Radiance HDR", false, false, true, false, false, Alpha::none},
    FormatLimits{"pnm", "PNM", true, false, true, false, false, Alpha::none},
    FormatLimits{"rla", "RLA", true, false, true, true, true, Alpha::associated, Windows::all, 1,
                 65535},
    FormatLimits{"fits", "FITS", true, false, true, true, false, Alpha::associated},
    FormatLimits{"zfile", "Zfile", true, false, false, false, false, Alpha::none, Windows::none, 1,
                 32767},
};
constexpr FormatLimits kAnything = {"",   "this format", true,          true,        true,
                                    true, true,          Alpha::either, Windows::all};

}  // namespace

const FormatLimits& format_limits(std::string_view format) {
    const auto* found = std::find_if(kFormats.begin(), kFormats.end(),
                                     [&](const auto& row) { return row.format == format; });
    return found == kFormats.end() ? kAnything : *found;
}

std::vector<int> file_channels(const PictureSpec& spec, const FormatLimits& limits,
                               bool leaves_out_alpha) {
    const bool is_gray = spec.nchannels < 3;
    const int colors = is_gray ? 1 : 3;
    const bool has_alpha =
        !leaves_out_alpha && spec.alpha_channel >= colors && spec.alpha_channel < spec.nchannels;
    const bool is_basic = spec.nchannels == colors + (spec.alpha_channel >= 0 ? 1 : 0);
    if (limits.others && (!is_basic || !is_gray)) {
        std::vector<int> all(static_cast<std::size_t>(spec.nchannels));
        std::iota(all.begin(), all.end(), 0);
        if (leaves_out_alpha && spec.alpha_channel >= 0) std::erase(all, spec.alpha_channel);
        return all;
    }
    const int alpha = has_alpha ? spec.alpha_channel : -1;
    if (is_gray) {
        if (has_alpha && limits.gray_alpha) return {0, alpha};
        if (has_alpha && limits.rgba) return {0, 0, 0, alpha};
        if (limits.gray) return {0};
        if (limits.rgb) return {0, 0, 0};
        if (limits.rgba) return {0, 0, 0, alpha};
        return {};
    }
    if ((has_alpha || !limits.rgb) && limits.rgba) return {0, 1, 2, alpha};
    if (limits.rgb) return {0, 1, 2};
    return {};
}

std::string size_refusal(const FormatLimits& limits, int width, int height) {
    if (std::min(width, height) >= limits.least && std::max(width, height) <= limits.most)
        return {};
    const std::string expected = limits.least > 1 ? fmt::format("at least {}", limits.least)
                                                  : fmt::format("at most {}", limits.most);
    return fmt::format("the picture is {} x {} pixels; expected {} in each direction for {}", width,
                       height, expected, limits.title);
}

TONEWRIGHT_NAMESPACE_END
