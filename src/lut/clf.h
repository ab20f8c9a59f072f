// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <string>
#include <vector>

#include "tonewright/version.h"

TONEWRIGHT_NAMESPACE_BEGIN

/// One table as a Common LUT Format file (Academy S-2014-006, version 3), or as a Color Transform
/// Format file where CLF does not reach; 32-bit float in and out.
struct ClfTable {
    int dimension = 1;  // 1 or 3
    int size = 0;       // entries, or grid points a side
    int channels = 1;   // 1D: 1 or 3
    bool is_half_domain = false;
    /// 1D: the largest and the smallest channel are looked up, the middle one keeps its place
    /// between them. Autodesk's CTF has it (hueAdjust "dw3"), CLF has not: the file is a .ctf.
    bool is_hue_preserving = false;
    /// A .ctf all the same.
    bool is_ctf = false;
    /// 1D: entry by entry. 3D: RGB triplets, BLUE fastest, as CLF has them.
    std::span<const float> values;
    /// How its numbers are written.
    /// All but the first without a zero before the point.
    enum class Numbers : unsigned char {
        exact,    // 9 significant digits without exponents: reads back as the same float
        compact,  // @see append_compact
        /// Multiples of 1/65535, as whole numbers of 16 bits: for cubes whose interpolation error
        /// dwarfs half of that. Not limited to [0, 65535].
        codes,
        decimals_7  // as the cubes that hosts ship have
    };
    Numbers numbers = Numbers::exact;
};

/// ".clf" or ".ctf". OCIO knows a format by it.
[[nodiscard]] TONEWRIGHT_API const char* file_extension(const ClfTable& table);

[[nodiscard]] TONEWRIGHT_API std::string write_clf(const ClfTable& table, const std::string& name,
                                                   const std::vector<std::string>& description);

TONEWRIGHT_NAMESPACE_END
