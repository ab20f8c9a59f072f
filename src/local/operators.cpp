// SPDX-License-Identifier: Apache-2.0
#include "local/operators.h"
#include "base/format_number.h"

#include <cmath>

TONEWRIGHT_NAMESPACE_BEGIN

void run_rows_in_turn(int count, const std::function<void(int begin, int end)>& body) {
    body(0, count);
}

void run_local_operator(const ResolvedOperator& op, ScenePlanes& picture) {
    if (!op.op->is_local()) {
        throw Error("operator is " + op.op->id + "; expected a local operator");
    }
    const std::size_t count =
        static_cast<std::size_t>(picture.width) * static_cast<std::size_t>(picture.height);
    for (const std::vector<float>& plane : picture.rgb) {
        if (picture.width < 1 || picture.height < 1 || plane.size() != count) {
            throw Error("plane has " + std::to_string(plane.size()) + " pixels; expected " +
                        std::to_string(picture.width) + " x " + std::to_string(picture.height));
        }
    }
    op.op->run_local(picture, op.params);
}

void check_whole_number(const Params& params, const char* name) {
    const double value = params.number(name);
    if (value != std::floor(value)) {
        throw Error(std::string(name) + " is " + shortest(value) + "; expected a whole number");
    }
}

int whole_number(const Params& params, const char* name) {
    check_whole_number(params, name);
    return static_cast<int>(params.number(name));
}

TONEWRIGHT_NAMESPACE_END
