// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <vector>

#include "engine/compiled_curve.h"
#include "engine/precision.h"
#include "engine/tape.h"

namespace tonewright {

/// What a compiled curve may add to the error of an output.
inline constexpr double kCurveErrorBudget = 3e-7;

/// For each value of a program the one value that it is a function of, apart from constants; itself
/// when it is a function of several, or of none. A tone curve, clamps and encoding included, is a
/// function of one channel.
[[nodiscard]] std::vector<std::uint32_t> find_roots(const std::vector<TapeInstruction>& code);

/// The values of a program that are cheaper taken from a compiled curve of their root.
struct Curves {
    struct Use {
        std::uint32_t root;
        std::uint32_t curve;
    };
    std::vector<CompiledCurve> curves;
    std::map<std::uint32_t, Use> uses;  // by value
};

/// From the largest functions of one value to their parts, until one can be compiled within the
/// error budget; what is cheap, needs double, or does not fit the tables stays as it is.
[[nodiscard]] Curves find_curves(const std::vector<TapeInstruction>& code,
                                 const std::array<std::uint32_t, 3>& outputs,
                                 const std::vector<std::uint32_t>& roots,
                                 const Precision& precision);

}  // namespace tonewright
