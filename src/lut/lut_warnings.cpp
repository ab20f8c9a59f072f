// SPDX-License-Identifier: Apache-2.0
#include "lut/lut_warnings.h"

#include <fmt/format.h>

#include <cmath>

#include "measure/error_metric.h"

TONEWRIGHT_NAMESPACE_BEGIN

std::string lut_warning(const std::string& file, const LutRequest& request, const BakedLut& baked,
                        bool is_for_application) {
    if (baked.lut.dimension != 3) return {};
    std::string remedy;
    const Operator& op = *request.view.op.op;
    for (const InputSpace& space : all_input_spaces()) {
        // An application has primaries of its own.
        if (!is_for_application && space.primaries == op.working && space.id != request.view.input)
            remedy = fmt::format("; use the operator's own primaries: --input {}", space.id);
    }
    if (remedy.empty() && baked.lut.size < 65 && !is_picture_format(request.format))
        remedy = "; use more nodes: --size 65";
    const LutRinging& ringing = baked.ringing;
    if (rings(ringing)) {
        return fmt::format(
            "{} rings: along rising exposure, {}, where {} does not; errors there up to {} (99.9 "
            "%), because clips and kinks of the operator lie between its nodes{}",
            file, to_string(ringing), request.view.op.label, rounded_up(ringing.p999), remedy);
    }
    constexpr double kManyPixels = 0.05;
    const double share = baked.error.photographs.share;
    if (remedy.empty() || share <= kManyPixels) return {};
    return fmt::format(
        "{} is more than one code of 255 off on {:.0f} % of the pixels of photographs{}", file,
        std::ceil(100 * share), remedy);
}

TONEWRIGHT_NAMESPACE_END
