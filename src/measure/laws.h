// SPDX-License-Identifier: Apache-2.0
//
// The laws of tone curves. The law tests check the built-in operators, and `tonewright check`
// reports broken laws of any operator.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "tonewright/pipeline.h"
#include "tonewright/view.h"

TONEWRIGHT_NAMESPACE_BEGIN

/// A thousandth of a 10-bit code: smaller falls do not count. AgX needs it: the rows of its inset
/// matrix, as printed, sum to 1.00014, 0.99996 and 0.99995, so the channels of a gray reach the
/// shaper's end 1.6e-5 of its length apart, and a matrix after the curve subtracts 0.1 to 0.3 of
/// the others' slope there.
inline constexpr double kNoise = 1e-6;

/// -16..+16 stops about mid gray, in steps of 1/64.
[[nodiscard]] TONEWRIGHT_API std::vector<double> gray_ramp();

using Differences = std::map<DocumentedDifference::Kind, double>;

/// Black, grays and white of an operator, measured as DocumentedDifference defines them.
[[nodiscard]] TONEWRIGHT_API Differences measured_differences(const ResolvedOperator& op);
/// Differences that the operator declares for its preset and look.
[[nodiscard]] TONEWRIGHT_API Differences declared_differences(const ResolvedOperator& op);

/// Result of one law.
struct LawResult {
    enum class Verdict : unsigned char { holds, as_declared, breaks, does_not_apply };
    std::string law;  // "monotone"
    Verdict verdict = Verdict::holds;
    std::string text;         // "falls from 0.731 at x = 4.02 to 0.728 at x = 4.31"; may be empty
    std::optional<double> x;  // where it breaks, scene-linear
};
/// "holds", "as declared", "breaks", "does not apply"
[[nodiscard]] TONEWRIGHT_API std::string to_string(LawResult::Verdict verdict);

/// All laws, one result each:
///
/// finite      every color, of negative channels as well, gives finite numbers;
/// monotone    no brighter gray is darker, no saturated color gets darker by a step of 8 bits, and
///             from -6 to +3 stops grays get brighter;
/// bounded     no gray is brighter than the declared output peak;
/// white       the brightest gray is shown as white;
/// black       black is 0, and grays above -8 stops are not shown as black;
/// gray        grays have no tint;
/// continuous  no jump between neighboring colors;
/// inverse     the round trip through the inverse is exact.
[[nodiscard]] TONEWRIGHT_API std::vector<LawResult> check_laws(const ResolvedOperator& op);

TONEWRIGHT_NAMESPACE_END
