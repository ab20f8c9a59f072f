// SPDX-License-Identifier: Apache-2.0
#include <charconv>

#include "tonewright/pipeline.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

/// DocumentedDifferences are declared with two significant digits, what is near 1 with three.
std::string rounded(double value, int digits = 2) {
    std::array<char, 32> text{};
    const auto end = std::to_chars(text.data(), text.data() + text.size(), value,
                                   std::chars_format::general, digits);
    return {text.data(), end.ptr};
}

}  // namespace

std::string to_string(const DocumentedDifference& d) {
    using Kind = DocumentedDifference::Kind;
    const std::string prefix = d.when.empty() ? "" : d.when + ": ";
    switch (d.kind) {
        case Kind::black:
            if (d.value == 0) return prefix + "black is 0";
            return prefix + (d.value > 0
                                 ? "lifts black to " + rounded(d.value)
                                 : "takes black to " + rounded(d.value) + ", which displays clip");
        case Kind::crushes_black:
            return prefix + "shows greys up to " + rounded(d.value) + " as black";
        case Kind::never_reaches_white:
            return prefix + "never reaches white: at most " + rounded(d.value, 3) +
                   " of the display's light";
        case Kind::exceeds_white:
            return prefix +
                   (d.value == kInfinity ? "exceeds white without end"
                                         : "exceeds white, up to " + rounded(d.value, 3)) +
                   ": SDR displays clip it";
        case Kind::not_monotone:
            return prefix + "non-monotone" +
                   (d.value == kInfinity ? "" : " below " + rounded(d.value));
    }
    return {};
}

TONEWRIGHT_NAMESPACE_END
