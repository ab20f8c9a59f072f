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
    /// Entry by entry, of a table of `compact` numbers: 0, or the sign of the direction in which
    /// the number may be any other, because nothing is looked up there or a clamp is behind it.
    /// Empty: all 0.
    std::span<const signed char> slack = {};
    /// How its numbers are written.
    enum class Numbers : unsigned char {
        exact,  // 9 significant digits without exponents: reads back as the same float
        /// 1D: as few digits as the precision of floats around 1 is worth, @see precision_of, of
        /// the value times a power of two, with a matrix behind the table that takes the power
        /// back.
        compact,
        /// Multiples of 1/65535, as whole numbers of 16 bits: for cubes whose interpolation error
        /// dwarfs half of that. Not limited to [0, 65535].
        codes,
        decimals_7,  // as the cubes that hosts ship have
        /// Whole numbers of `unit`, with a matrix behind the table that multiplies by it: shorter
        /// than decimals, but the table itself leaves [0, 1], and OpenColorIO's fast inversion of a
        /// cube does not.
        multiples
    };
    Numbers numbers = Numbers::exact;
    double unit = 1;             // of multiples
    double least_precision = 0;  // of compact numbers: none needs to be nearer to its value
    /// What goes in and what comes out, for InputDescriptor and OutputDescriptor. Empty: none.
    std::string input_descriptor = {};
    std::string output_descriptor = {};
};

/// ".clf" or ".ctf". OCIO knows a format by it.
[[nodiscard]] TONEWRIGHT_API const char* file_extension(const ClfTable& table);

/// How far a compact number may be from its value: half of the sixth digit or of the eighth
/// decimal, whichever is less: of light in [0, 1] behind the curve of sRGB a tenth of what float32
/// operations leave. From 0.1 on half as much again, a quarter of what a float is rounded by. Three
/// digits beyond the largest half float, where every engine limits light.
[[nodiscard]] TONEWRIGHT_API double precision_of(double value);

[[nodiscard]] TONEWRIGHT_API std::string write_clf(const ClfTable& table, const std::string& name,
                                                   const std::vector<std::string>& description);

TONEWRIGHT_NAMESPACE_END
