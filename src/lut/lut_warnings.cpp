// SPDX-License-Identifier: Apache-2.0
#include "lut/lut_warnings.h"

#include <fmt/format.h>

#include <cmath>

#include "base/format_number.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

/// The lut1d of ffmpeg divides by the larger of DOMAIN_MAX and 1, and ignores DOMAIN_MIN.
std::string domain_warning(const std::string& file, const LutRequest& request) {
    const InputEncoding& input = request.encoding;
    if (request.format != LutFormat::cube || !input.is_linear) return {};
    if (input.scene_lo == 0 && input.scene_hi >= 1) return {};
    return fmt::format(
        "{} has the domain {} to {}, and ffmpeg reads one from 0 to at least 1; use "
        "<<input_encoding=linear:0:{}>>, or <<format=clf>> or spi1d for OpenColorIO",
        file, shortest(input.scene_lo), shortest(input.scene_hi),
        shortest(std::fmax(1, input.scene_hi)));
}

/// Changes that the user can make; none that the application fixes.
std::string remedy(const LutRequest& request, const BakedLut& baked, const LutApplication* host) {
    const View& view = request.view;
    if (!host) {
        for (const InputSpace& space : all_input_spaces()) {
            if (space.primaries == view.op.op->working && space.id != view.input)
                return "take input of the operator's own primaries: <<input=" + space.id + ">>";
        }
    }
    if (host && reads_chains(*host, LutFormat::clf) && !reads_chains(*host, request.format))
        return "a clf or ctf file has no such errors: <<target=NAME.ctf>>";
    // Pictures of LUTs have the sizes that their application wants.
    if (baked.lut.size < 65 && !is_picture_format(request.format) &&
        (!host || host->largest_size >= 65))
        return "take more nodes: <<size=65>>";
    return {};
}

}  // namespace

std::string lut_warning(const std::string& file, const LutRequest& request, const BakedLut& baked,
                        const LutApplication* host) {
    if (baked.lut.dimension != 3) return domain_warning(file, request);
    constexpr double kCodes = 255;
    const std::string help = remedy(request, baked, host);
    if (help.empty()) return {};
    const LutRinging& ringing = baked.ringing;
    if (rings(ringing)) {
        return fmt::format(
            "{} rings: in {}, {} is {:.0f} codes of 255 too dark at {:+.1f} stops "
            "from 0.18; {}",
            file, ringing.color, ringing.channel, std::ceil(kCodes * ringing.fall), ringing.stops,
            help);
    }
    constexpr double kManyPixels = 0.05;
    const double share = baked.error.photographs.share;
    if (share <= kManyPixels) return {};
    return fmt::format(
        "{} is more than one code of 255 off on {:.0f} % of the pixels of "
        "photographs; {}",
        file, std::ceil(100 * share), help);
}

TONEWRIGHT_NAMESPACE_END
