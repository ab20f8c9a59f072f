// SPDX-License-Identifier: Apache-2.0
#include "lut/lut_warnings.h"

#include <fmt/format.h>

#include "measure/error_metric.h"

TONEWRIGHT_NAMESPACE_BEGIN

std::string ringing_warning(const std::string& file, const LutRequest& request,
                            const BakedLut& baked) {
    if (baked.lut.dimension != 3 || follows_operator(baked.ringing)) return {};
    const LutRinging& ringing = baked.ringing;
    const std::string what =
        rings(ringing)
            ? fmt::format("rings: along rising exposure, {}, where {} does not", to_string(ringing),
                          request.view.op.label)
            : fmt::format("does not follow {} in saturated highlights", request.view.op.label);
    std::string remedy;
    const Operator& op = *request.view.op.op;
    for (const InputSpace& space : all_input_spaces()) {
        if (space.primaries == op.working && space.id != request.view.input)
            remedy = fmt::format("; use the operator's own primaries: --input {}", space.id);
    }
    if (remedy.empty() && baked.lut.size < 65 && !is_picture_format(request.format))
        remedy = "; use more nodes: --size 65";
    return fmt::format(
        "{} {}; errors there up to {} (99.9 %), because clips and kinks of the operator lie "
        "between its nodes{}",
        file, what, rounded_up(ringing.p999), remedy);
}

TONEWRIGHT_NAMESPACE_END
