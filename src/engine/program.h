// SPDX-License-Identifier: Apache-2.0
//
// The program of a pipeline. The interpreter (simd_kernels.h) runs it, and vector_code.h translates
// it for the machine code.
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

/// Opcode. The comments call the operands in[0..3] a, b, c and d.
enum class ProgramOp : std::uint8_t {
    copy,
    add,
    subtract,
    multiply,
    divide,
    multiply_add,       // a*b + c, rounded once where the processor can
    multiply_subtract,  // a*b - c
    subtract_product,   // c - a*b
    dot3,               // k0*a + k1*b + k2*c, for one to three rows of a matrix
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
    power_constant,  // a^k0, where k0 is no integer
    power_near,      // power_constant in float for a small k0: see computed_by()
    sine,
    cosine,
    atan2,
    less,  // a < b ? 1 : 0
    less_equal,
    equal,
    select,       // a != 0 ? b : c
    select_less,  // a < b ? c : d
    select_less_equal,
    select_equal,
    lookup,
    lookup_nonuniform,  // one to three tables with the same positions
    curve,              // a compiled curve
    grid,               // a 3D LUT at the coordinates a, b, c: all three channels
};

struct Operation {
    const char* name;
    int operands;
    /// The operation has up to three results.
    bool has_channels = false;
};
/// Operations in the order of ProgramOp.
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
static_assert(std::size(kOperations) == static_cast<std::size_t>(ProgramOp::grid) + 1);

[[nodiscard]] constexpr const Operation& operation(ProgramOp op) {
    return kOperations[static_cast<std::size_t>(op)];
}

/// Location of a value: a register of the tile, or a constant. A constant fills one vector, which
/// is read for all pixels.
struct Operand {
    std::uint32_t offset = 0;  // in bytes
    bool constant = false;
    bool wide = false;  // double, else float
};

/// Numbers as floats, as doubles, or as both.
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

/// A table whose samples lie at equal distances over [0, 1].
struct SampledTable {
    Samples samples;
    Table::Interpolation interpolation = Table::Interpolation::linear;
};

/// Up to three tables with the same positions. An x below the first position counts as the first
/// one, and an x above the last as the last one.
struct NonuniformTables {
    /// The range of the positions is divided into equal parts. first_cell holds the cell in which
    /// each part begins, and bisection finds the cell of x within its part. If the positions are
    /// all half floats, one part has 15,360 cells.
    double parts_per_unit = 0;
    Samples first_cell;
    /// First step of the bisection, a power of two; 0: one cell a part.
    std::int32_t half_of_most = 0;
    /// Start of each cell, then infinities, because bisection reads past the last cell. Starts in
    /// float are rounded up, so that every float x keeps its cell.
    Samples begin;
    std::size_t cells = 0;
    /// A row for each cell: its start, then the sample and the slope of each table.
    int length = 4;  // of a row; 8 for several tables
    Samples rows;
};

/// Nodes of a 3D LUT, each red, green, blue and one unused number. In double if the instruction
/// computes in double.
struct SampledGrid {
    int edge = 0;
    Samples nodes;
};

/// A step over all pixels of a tile. A wide instruction computes in double and any other in float,
/// whichever precision its operands have. Only wide instructions and compiled curves can have
/// double results.
struct Instruction {
    ProgramOp op = ProgramOp::copy;
    bool wide = false;
    /// The operand of this log2 or power_constant is at least the smallest normal float.
    bool is_positive = false;
    static constexpr Operand kUnused = {0, true, false};
    /// Registers of up to three results; kUnused for a result that nobody reads.
    std::array<Operand, 3> out = {kUnused, kUnused, kUnused};
    std::array<Operand, 4> in = {kUnused, kUnused, kUnused, kUnused};
    std::array<double, 9> k{};  // coefficients of dot3, exponent of power_constant
    std::uint32_t table = 0;    // index of the table, curve or grid among those of the program
};

/// Largest tile, in pixels.
inline constexpr std::size_t kMaxTile = 256;
inline constexpr std::size_t kVectorBytes = 64;   // of AVX-512, the widest vector
inline constexpr std::size_t kLaneMultiple = 16;  // floats in the widest vector
/// Inputs are limited to +- this, infinities included. NaN becomes 0. See limits_input().
inline constexpr float kLargestInput = 65504.0F;
/// Size of the register file, which lies on the stack of the running thread.
inline constexpr std::size_t kRegisterFileBytes = std::size_t{64} * 1024;

struct alignas(kVectorBytes) ConstantVector {
    std::array<unsigned char, kVectorBytes> bytes;
};

/// The numbers that a program reads. Uniforms may change them.
struct Numbers {
    /// Constants of the interpreter. Each fills one vector.
    std::vector<ConstantVector> constants;
    /// Constants of machine code.
    std::vector<ConstantVector> pool;
};

/// Location of a uniform's value in Numbers::constants or Numbers::pool.
struct UniformPlace {
    std::uint32_t source = 0;  // tape instruction that computes the value
    std::uint32_t offset = 0;  // in bytes
    std::uint32_t bytes = 0;   // filled with copies of the value
    bool wide = false;         // stored as double
    bool is_rounded = false;   // rounded to float before it is stored
};

/// @param bytes  size of the memory that is filled with floats, or with doubles if `wide`
inline void fill(unsigned char* to, std::size_t bytes, double value, bool wide) {
    const auto narrow = static_cast<float>(value);
    const std::size_t size = wide ? sizeof value : sizeof narrow;
    for (std::size_t at = 0; at < bytes; at += size)
        std::memcpy(to + at, wide ? static_cast<const void*>(&value) : &narrow, size);
}

struct Program {
    /// Instruction set that the program is compiled for and runs on.
    const Target* target = nullptr;
    /// Float registers of the input channels that the program reads.
    std::array<std::uint32_t, 3> input_offset{};
    std::array<bool, 3> reads_input{};
    /// True: the engine limits inputs to +-kLargestInput. False: the program limits them after its
    /// exposure.
    bool limits_input = true;
    /// Results, always in float.
    std::array<Operand, 3> output;
    std::vector<Instruction> instructions;
    /// Numbers for the typical values of the uniforms.
    Numbers numbers;
    std::vector<UniformPlace> uniforms;  // in numbers.constants
    std::shared_ptr<const Tape> source;  // the tape that computes the uniforms' values
    std::vector<SampledTable> tables;
    std::vector<NonuniformTables> positioned;
    std::vector<SampledGrid> grids;
    std::vector<CompiledCurve> curves;
    /// True if each output channel is the same function of its input channel alone. Then the floats
    /// of RGB pixels need not be separated by channel.
    bool is_one_function = false;
    /// Pixels per tile: a multiple of kLaneMultiple, such that the registers fit into the file.
    std::size_t tile = 0;
    /// Machine code of the program, or null. It refers to the tables, grids and curves, so a
    /// program is moved and never copied.
    std::shared_ptr<const MachineCode> machine;

    Program() = default;
    Program(Program&&) = default;
    Program& operator=(Program&&) = default;
};

}  // namespace simd
TONEWRIGHT_NAMESPACE_END
