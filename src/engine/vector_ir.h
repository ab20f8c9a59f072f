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

/// Opcode of a vector instruction. A vector has half as many doubles as floats.
enum class VectorOp : std::uint8_t {
    add,
    subtract,
    multiply,
    divide,
    multiply_add,       // a*b + c
    multiply_subtract,  // a*b - c
    subtract_product,   // c - a*b
    minimum,            // a < b ? a : b, the processor's instruction
    maximum,            // a > b ? a : b
    square_root,
    bit_and,
    bit_or,
    bit_xor,
    bit_and_not,  // ~a & b
    round,        // to the nearest integer
    floor,        // to the next integer below
    // Conversions between a vector of floats and two vectors of doubles
    promote_low,
    promote_high,
    demote,  // (low, high) -> floats
    // Masks. With AVX2, a mask is a vector whose elements have all bits set or none
    equal,
    less,
    less_equal,
    greater,
    greater_equal,
    is_minus,  // the sign bit of a, for a blend
    blend,     // mask ? a : b
    zero_unless,
    // Integers, of 64 bits if wide
    shift_right,  // a >> `immediate`, with the sign unless wide
    shift_left,
    integer_add,
    integer_subtract,
    to_index,  // from floats; from doubles, the result is half a vector
    to_float,  // from 32-bit integers
    // Tables
    permute_16,   // element a of the 16 floats at `address`; AVX-512
    permute_32,   // element a of the 32 floats at `address`; AVX-512
    gather,       // number a of those at `address`
    spill_index,  // stores the integers a on the stack, in index slot `immediate`
    /// Loads four adjacent floats at `address` for one lane in each four. `immediate` % 4 is the
    /// slot of their indices, and `immediate` / 4 the lane.
    rows,
    // Memory
    load_plane,
    store_plane,
    load_pixels,   // vector `immediate` of the block's pixels
    store_pixels,  // to such a vector
    store_colors,  // store_pixels without the fourth float of each pixel
    load_thirds,   // every third group of four floats, beginning with group `immediate`
    store_thirds,  // to such groups
    shuffle_4,     // two floats of each four of a, then two of b
};

/// A value in a register, or a number in the pool.
struct VectorOperand {
    static constexpr std::int32_t kNone = -1;
    std::int32_t value = kNone;
    std::int32_t pool = kNone;  // offset in bytes

    [[nodiscard]] bool is_value() const { return value != kNone; }
    [[nodiscard]] bool is_constant() const { return pool != kNone; }
};

struct VectorInstruction {
    VectorOp op = VectorOp::add;
    bool wide = false;  // doubles
    std::uint8_t immediate = 0;
    std::uint8_t block = 0;                      // number of the block in a turn of the loop
    std::uint32_t offset = 0;                    // in the tile, in bytes
    const void* address = nullptr;               // of the table
    std::int32_t result = VectorOperand::kNone;  // a mask if makes_mask(op)
    std::int32_t mask = VectorOperand::kNone;
    std::array<VectorOperand, 3> in{};
};

[[nodiscard]] constexpr bool makes_mask(VectorOp op) {
    return op >= VectorOp::equal && op <= VectorOp::is_minus;
}

/// Floats of a pixel in the memory that the code reads and writes.
enum class PixelLayout : std::uint8_t {
    rgb,
    rgba,  // the fourth channel keeps its value
};

/// Straight-line code: a program or a part of it.
struct VectorCode {
    std::vector<VectorInstruction> instructions;
    std::int32_t value_count = 0;
};

/// A program as parts, which run one after the other over a tile.
struct VectorProgram {
    /// Parts for each PixelLayout.
    std::array<std::vector<VectorCode>, 2> parts;
    std::vector<unsigned char> pool;     // constants; must be aligned to 64 bytes
    std::vector<UniformPlace> uniforms;  // in the pool
    std::size_t tile = 0;                // in pixels
};

}  // namespace simd
TONEWRIGHT_NAMESPACE_END
