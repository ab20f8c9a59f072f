// SPDX-License-Identifier: Apache-2.0
//
// Instructions over vectors in registers, for AVX2 (blocks of 8 pixels) and AVX-512 (16 pixels).
// Nothing here knows an encoding: machine_code.cpp does.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "engine/program.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace simd {

/// What a vector instruction does. Doubles are half as many to a vector as floats.
enum class VectorOp : std::uint8_t {
    add,
    subtract,
    multiply,
    divide,
    multiply_add,       // a*b + c
    multiply_subtract,  // a*b - c
    subtract_product,   // c - a*b
    minimum,            // a < b ? a : b, as the processor has it
    maximum,            // a > b ? a : b
    square_root,
    bit_and,
    bit_or,
    bit_xor,
    bit_and_not,  // ~a & b
    round,        // to the nearest whole number
    floor,        //
    // Between floats and pairs of vectors of doubles
    promote_low,
    promote_high,
    demote,  // (low, high) -> floats
    // Masks; of AVX2 all bits of a vector's element
    equal,
    less,
    less_equal,
    greater,
    greater_equal,
    is_minus,  // the sign bit of a, for a blend
    blend,     // mask ? a : b
    zero_unless,
    // Whole numbers; of 64 bits where wide
    shift_right,  // of the bits of a, by `immediate`; with the sign unless wide
    shift_left,
    integer_add,
    integer_subtract,
    to_index,  // from floats, or from doubles to half a vector
    to_float,  // from whole numbers
    // Tables
    permute_16,   // the element of 16 floats at `address` that a says; AVX-512
    permute_32,   // AVX-512
    gather,       // of the numbers at `address`, that of index a
    spill_index,  // the whole numbers a, on the stack, number `immediate`
    rows,         // four floats each for a quarter of the pixels, at `address` + the floats that
           // spill_index kept: `immediate` says which index, and times 4, which pixel of each four
    // Memory
    load_plane,
    store_plane,
    load_pixels,   // the vector number `immediate` of the block's pixels
    store_pixels,  //
    store_colors,  // only the first three of each four floats
    load_thirds,   // every third group of four floats, beginning with group `immediate`
    store_thirds,  //
    shuffle_4,     // two floats of each four of a, two of b
};

/// A value in a register, or a number in the pool.
struct VectorOperand {
    static constexpr std::int32_t kNone = -1;
    std::int32_t value = kNone;
    std::int32_t pool = kNone;  // in bytes

    [[nodiscard]] bool is_value() const { return value != kNone; }
    [[nodiscard]] bool is_constant() const { return pool != kNone; }
};

struct VectorInstruction {
    VectorOp op = VectorOp::add;
    bool wide = false;  // doubles
    std::uint8_t immediate = 0;
    std::uint8_t block = 0;                      // of those that one turn of the loop computes
    std::uint32_t offset = 0;                    // in the tile: bytes
    const void* address = nullptr;               // of that table
    std::int32_t result = VectorOperand::kNone;  // a mask, of a comparison
    std::int32_t mask = VectorOperand::kNone;
    std::array<VectorOperand, 3> in{};
};

[[nodiscard]] constexpr bool makes_mask(VectorOp op) {
    return op >= VectorOp::equal && op <= VectorOp::is_minus;
}

/// Floats of a pixel in memory, for the code that reads or writes them.
enum class PixelLayout : std::uint8_t {
    rgb,
    rgba,  // the fourth channel keeps its value
};

/// A program, or a part of it.
struct VectorCode {
    std::vector<VectorInstruction> instructions;
    std::int32_t value_count = 0;
};

/// The program as such parts, which run one after the other over a tile.
struct VectorProgram {
    /// By the layout of the pixels.
    std::array<std::vector<VectorCode>, 2> parts;
    std::vector<unsigned char> pool;     // constants; to be aligned to 64
    std::vector<UniformPlace> uniforms;  // in the pool
    std::size_t tile = 0;                // in pixels
};

}  // namespace simd
TONEWRIGHT_NAMESPACE_END
