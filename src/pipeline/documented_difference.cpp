// SPDX-License-Identifier: Apache-2.0
#include "base/format_number.h"
#include "tonewright/pipeline.h"

TONEWRIGHT_NAMESPACE_BEGIN

const std::vector<std::string>& difference_names() {
    static const std::vector<std::string> names = {
        "black",      "crushes_black", "never_reaches_white", "exceeds_white", "not_monotone",
        "tints_gray", "jumps"};
    return names;
}

/// Differences have two significant digits, values near 1 have three.
std::string to_string(const DocumentedDifference& d) {
    using Kind = DocumentedDifference::Kind;
    const std::string prefix = d.when.empty() ? "" : d.when + ": ";
    switch (d.kind) {
        case Kind::black:
            if (d.value == 0) return prefix + "black is 0";
            return prefix + (d.value > 0 ? "lifts black to " + rounded(d.value, 2)
                                         : "takes black to " + rounded(d.value, 2) +
                                               ", which displays clip");
        case Kind::crushes_black:
            return prefix + "shows grays up to " + rounded(d.value, 2) + " as black";
        case Kind::never_reaches_white:
            return prefix + "never reaches white: at most " + rounded(d.value, 3) +
                   " of display white";
        case Kind::exceeds_white:
            return prefix +
                   (d.value == kInfinity ? "exceeds white without limit"
                                         : "exceeds white, up to " + rounded(d.value, 3)) +
                   "; SDR displays clip it";
        case Kind::not_monotone:
            if (d.value == 0) return prefix + "monotone";
            return prefix + "non-monotone" +
                   (d.value == kInfinity ? "" : " below " + rounded(d.value, 2));
        case Kind::tints_gray:
            return prefix + "tints gray: its channels differ by up to " + rounded(d.value, 2);
        case Kind::jumps:
            return prefix + "jumps by " + rounded(d.value, 2) + " from one gray to the next";
    }
    return {};
}

TONEWRIGHT_NAMESPACE_END
