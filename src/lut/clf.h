// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <string>
#include <vector>

#include "tonewright/version.h"

TONEWRIGHT_NAMESPACE_BEGIN

/// One table as a Common LUT Format file (Academy S-2014-006, version 3), or as a Color Transform
/// Format file for features that CLF lacks; 32-bit float in and out.
struct ClfTable {
    int dimension = 1;  // 1 or 3
    int size = 0;       // entries, or grid points a side
    int channels = 1;   // 1D: 1 or 3
    bool is_half_domain = false;
    /// 1D: looks up the largest and the smallest channel; the middle one keeps its relative
    /// position. Autodesk's CTF supports this (hueAdjust "dw3") and CLF does not, so the file is a
    /// .ctf.
    bool is_hue_preserving = false;
    /// Writes a .ctf in any case.
    bool is_ctf = false;
    /// 1D: entry by entry. 3D: RGB triplets, BLUE fastest, like CLF.
    std::span<const float> values;
    /// Per entry of a table of `compact` numbers: 0, or the sign of the direction in which the
    /// number may change freely, because no lookup reaches it or a clamp follows. Empty: all 0.
    std::span<const signed char> slack = {};
    /// Notation of the numbers.
    enum class Numbers : unsigned char {
        exact,  // 9 significant digits without exponents: reads back as the same float
        /// 1D: as few digits as the precision of floats around 1 justifies (@see precision_of), for
        /// the value times a power of two. A matrix after the table reverses the power.
        compact,
        /// Multiples of 1/65535, as 16-bit integers: for 3D LUTs with a much larger interpolation
        /// error than half of that. Not limited to [0, 65535].
        codes,
        decimals_7,  // like the 3D LUTs that applications ship
        /// Integer multiples of `unit`, with a matrix after the table that multiplies by it.
        /// Shorter than decimals, but the table exceeds [0, 1], which OpenColorIO's fast inversion
        /// of a 3D LUT does not support.
        multiples
    };
    Numbers numbers = Numbers::exact;
    double unit = 1;             // of multiples
    double least_precision = 0;  // of compact numbers: none needs to be nearer to its value
    /// Input and output for InputDescriptor and OutputDescriptor. Empty: none.
    std::string input_descriptor = {};
    std::string output_descriptor = {};
};

/// ".clf" or ".ctf". OCIO recognizes the format by it.
[[nodiscard]] TONEWRIGHT_API const char* file_extension(const ClfTable& table);

/// Largest error of a compact number: half of the sixth digit or of the eighth decimal, whichever
/// is less. After the sRGB curve that is a tenth of the error of float32 operations for values in
/// [0, 1]. From 0.1 half as much again, a quarter of the rounding of a float. Three digits above
/// the largest half float, where every engine clamps.
[[nodiscard]] TONEWRIGHT_API double precision_of(double value);

[[nodiscard]] TONEWRIGHT_API std::string write_clf(const ClfTable& table, const std::string& name,
                                                   const std::vector<std::string>& description);

TONEWRIGHT_NAMESPACE_END
