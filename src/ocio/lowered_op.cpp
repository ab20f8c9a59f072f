// SPDX-License-Identifier: Apache-2.0
#include "ocio/lowered_op.h"

#include <algorithm>
#include <iterator>

TONEWRIGHT_NAMESPACE_BEGIN

Lut1DOp lut_1d(const std::array<std::vector<float>, 3>& channels,
               const std::array<std::vector<signed char>, 3>& slack) {
    if (channels[0] == channels[1] && channels[1] == channels[2] && slack[0] == slack[1] &&
        slack[1] == slack[2])
        return {1, channels[0], true, false, slack[0]};
    Lut1DOp lut{3, {}};
    lut.values.reserve(3 * channels[0].size());
    for (std::size_t i = 0; i < channels[0].size(); ++i) {
        for (const std::vector<float>& channel : channels)
            lut.values.push_back(channel[i]);
        if (slack[0].empty()) continue;
        for (const std::vector<signed char>& channel : slack)
            lut.slack.push_back(channel[i]);
    }
    return lut;
}

LoweredOps inverse(LoweredOps ops) {
    std::reverse(ops.begin(), ops.end());
    for (LoweredOp& op : ops)
        op.is_inverse = !op.is_inverse;
    return ops;
}

void append(LoweredOps& ops, LoweredOps more) {
    ops.insert(ops.end(), std::make_move_iterator(more.begin()),
               std::make_move_iterator(more.end()));
}

TONEWRIGHT_NAMESPACE_END
