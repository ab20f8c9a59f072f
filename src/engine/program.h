// SPDX-License-Identifier: Apache-2.0
//
// The float program of a pipeline. The interpreter (simd_kernels.h) runs it, and vector_code.h
// translates it for the machine code.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <iterator>
#include <memory>
#include <span>
#include <type_traits>
#include <vector>

#include "engine/compiled_curve.h"
#include "tonewright/expr.h"

TONEWRIGHT_NAMESPACE_BEGIN
class Tape;
namespace simd {

class MachineCode;
struct Target;

/// What one instruction does with its operands a, b, c, e.
enum class Op : std::uint8_t {
    copy,
    add,
    subtract,
    multiply,
    divide,
    multiply_add,       // a*b + c, rounded once where the processor can
    multiply_subtract,  // a*b - c
    subtract_product,   // c - a*b
    dot3,               // k0*a + k1*b + k2*c, of one to three rows of a matrix
    minimum,            // b < a ? b : a
    maximum,            // a < b ? b : a
    clamp,              // minimum(maximum(a, b), c)
    negate,
    absolute,
    square_root,
    floor,
    exp2,
    log2,
    power,           // a^b
    power_constant,  // a^k0, k0 not whole
    power_near,      // the same in float, for a small k0: see computed_by()
    sine,
    cosine,
    atan2,
    less,  // a < b ? 1 : 0
    less_equal,
    equal,
    select,       // a != 0 ? b : c
    select_less,  // a < b ? c : e
    select_less_equal,
    select_equal,
    lookup,
    lookup_nonuniform,  // of one to three tables with the same positions
    curve,              // compiled
    grid,               // of coordinates a, b, c: all three channels
};

struct Operation {
    const char* name;
    int operands;
    /// Has up to three results.
    bool has_channels = false;
};
/// In the order of Op.
inline constexpr Operation kOperations[] = {
    {"copy", 1},
    {"add", 2},
    {"subtract", 2},
    {"multiply", 2},
    {"divide", 2},
    {"multiply_add", 3},
    {"multiply_subtract", 3},
    {"subtract_product", 3},
    {"dot3", 3, true},
    {"minimum", 2},
    {"maximum", 2},
    {"clamp", 3},
    {"negate", 1},
    {"absolute", 1},
    {"square_root", 1},
    {"floor", 1},
    {"exp2", 1},
    {"log2", 1},
    {"power", 2},
    {"power_constant", 1},
    {"power_near", 1},
    {"sine", 1},
    {"cosine", 1},
    {"atan2", 2},
    {"less", 2},
    {"less_equal", 2},
    {"equal", 2},
    {"select", 3},
    {"select_less", 4},
    {"select_less_equal", 4},
    {"select_equal", 4},
    {"lookup", 1},
    {"lookup_nonuniform", 1, true},
    {"curve", 1},
    {"grid", 3, true},
};
static_assert(std::size(kOperations) == static_cast<std::size_t>(Op::grid) + 1);

[[nodiscard]] constexpr const Operation& operation(Op op) {
    return kOperations[static_cast<std::size_t>(op)];
}

/// Where a value is: in the tile's register file, or among the constants, which stand there as one
/// vector each and are read again and again.
struct Operand {
    std::uint32_t offset = 0;  // in bytes
    bool constant = false;
    bool wide = false;  // double, else float
};

/// In float, in double, or both.
struct Samples {
    std::vector<float> narrow;
    std::vector<double> wide;

    template <class T>
    [[nodiscard]] std::span<const T> of() const {
        if constexpr (std::is_same_v<T, float>)
            return narrow;
        else
            return wide;
    }
};

/// At equal distances over [0, 1].
struct SampledTable {
    Samples samples;
    Table::Interpolation interpolation = Table::Interpolation::linear;
};

/// Up to three tables with the same positions. Numbers before the first position count as the
/// first, and numbers behind the last as the last.
struct NonuniformTables {
    /// Equal parts between them, and in which cell each of them begins. Bisection finds the cell
    /// of a number: positions that are halves have 15,360 cells in one part.
    double parts_per_unit = 0;
    Samples first_cell;
    std::int32_t half_of_most = 0;  // a power of two, or 0: no part has twice as many further cells
    /// Where each cell begins, and infinity for those that bisection reads behind the last. As
    /// floats not before it: no float changes its cell.
    Samples begin;
    std::size_t cells = 0;
    /// Of each cell in a row: where it begins, and for each table the sample there and the slope.
    int length = 4;  // or 8
    Samples rows;
};

/// Nodes of red, green, blue and one unused; in double where its results are.
struct SampledGrid {
    int edge = 0;
    Samples nodes;
};

/// An instruction computes over a whole tile, a wide one in double, another in float, whatever its
/// operands are kept in. An instruction that is neither wide nor a compiled curve has a float
/// result.
struct Instruction {
    Op op = Op::copy;
    bool wide = false;
    /// Of a logarithm, or a power with a constant exponent: its operand is at least the smallest
    /// normal float.
    bool is_positive = false;
    static constexpr Operand kUnused = {0, true, false};
    /// Where up to three results go. One that nobody reads is unused.
    std::array<Operand, 3> out = {kUnused, kUnused, kUnused};
    std::array<Operand, 4> in = {kUnused, kUnused, kUnused, kUnused};
    std::array<double, 9> k{};  // coefficients of dot3, exponent of power_constant
    std::uint32_t table = 0;    // of a lookup, a curve, a grid: its index among those
};

/// Largest tile, in pixels.
inline constexpr std::size_t kMaxTile = 256;
inline constexpr std::size_t kVectorBytes = 64;   // the widest vector there is
inline constexpr std::size_t kLaneMultiple = 16;  // floats in it
/// Numbers beyond this, infinity too, count as this; NaN as 0. See limits_input().
inline constexpr float kLargestInput = 65504.0F;
/// On the stack of the running thread.
inline constexpr std::size_t kRegisterFileBytes = std::size_t{64} * 1024;

struct alignas(kVectorBytes) ConstantVector {
    std::array<unsigned char, kVectorBytes> bytes;
};

/// All numbers that a program reads and that uniforms may change.
struct Numbers {
    /// One vector full of each, for the interpreter.
    std::vector<ConstantVector> constants;
    /// Those of machine code.
    std::vector<ConstantVector> pool;
};

/// Where the value of a uniform belongs in one of them.
struct UniformPlace {
    std::uint32_t source = 0;  // the instruction of the tape that computes it
    std::uint32_t offset = 0;  // in bytes
    std::uint32_t bytes = 0;   // to fill with it
    bool wide = false;         // as double
    bool is_rounded = false;   // to float before
};

/// @param bytes  to fill with floats, or with doubles where `wide`
inline void fill(unsigned char* to, std::size_t bytes, double value, bool wide) {
    const auto narrow = static_cast<float>(value);
    const std::size_t size = wide ? sizeof value : sizeof narrow;
    for (std::size_t at = 0; at < bytes; at += size)
        std::memcpy(to + at, wide ? static_cast<const void*>(&value) : &narrow, size);
}

struct Code {
    /// The one that it is compiled for, and that runs it.
    const Target* target = nullptr;
    /// Float registers of the three input channels; a channel that is not read has none.
    std::array<std::uint32_t, 3> input_offset{};
    std::array<bool, 3> reads_input{};
    /// Inputs are limited to +-kLargestInput. Otherwise the program limits them after its exposure.
    bool limits_input = true;
    /// Never wide.
    std::array<Operand, 3> output;
    std::vector<Instruction> instructions;
    /// With typical values of the uniforms.
    Numbers numbers;
    std::vector<UniformPlace> uniforms;  // among the constants
    std::shared_ptr<const Tape> source;  // computes them
    std::vector<SampledTable> tables;
    std::vector<NonuniformTables> positioned;
    std::vector<SampledGrid> grids;
    std::vector<CompiledCurve> curves;
    /// Each channel of the result is the same function of that channel alone: the floats of RGB
    /// pixels need not be sorted by channel.
    bool is_one_function = false;
    /// Pixels per tile: a multiple of kLaneMultiple, such that the registers fit into the file.
    std::size_t tile = 0;
    /// The same as machine code, where it could be made. Refers to the tables, grids and curves:
    /// a program is moved, not copied.
    std::shared_ptr<const MachineCode> machine;

    Code() = default;
    Code(Code&&) = default;
    Code& operator=(Code&&) = default;
};

}  // namespace simd
TONEWRIGHT_NAMESPACE_END
