// SPDX-License-Identifier: Apache-2.0
//
// The instruction sets of this machine and the interpreter of each. Nothing here names an
// instruction set: only simd_kernels.cpp includes Highway.
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <string_view>
#include <vector>

#include "engine/program.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace simd {

/// Vectors of an instruction set, for machine code.
struct VectorMachine {
    int lanes;      // floats in a vector: the pixels of a block
    int registers;  // vector registers
    /// AVX-512: mask registers, broadcasts in operands, permutes of whole tables.
    bool has_avx512;

    [[nodiscard]] constexpr int bytes() const { return lanes * 4; }
};

/// An instruction set, and the kernels that are compiled for it.
struct Target {
    const char* name = nullptr;
    /// Fastest form of compiled curves.
    CurveForm curve_form = CurveForm::none;
    /// Vectors for machine code; nullopt if there is no machine code for the instruction set.
    std::optional<VectorMachine> machine = std::nullopt;
    /// Interprets the program over `count` pixels.
    void (*interpret)(const Program& program, const Numbers& numbers,
                      const std::array<const float*, 3>& in, std::ptrdiff_t in_stride,
                      const std::array<float*, 3>& out, std::ptrdiff_t out_stride,
                      std::size_t count) noexcept = nullptr;
    /// pack() copies planes to RGB pixels, and pads them with zeros to `padded` pixels. unpack()
    /// copies pixels back to planes. Null if there is no machine code for the instruction set.
    void (*pack)(const std::array<const float*, 3>& in, std::ptrdiff_t stride, std::size_t count,
                 std::size_t padded, float* rgb) noexcept = nullptr;
    void (*unpack)(const float* rgb, const std::array<float*, 3>& out, std::ptrdiff_t stride,
                   std::size_t count) noexcept = nullptr;
};
/// Instruction sets that are compiled in and that this machine has, best first.
[[nodiscard]] const std::vector<Target>& targets();
/// @param name  "" for the best
/// @throws Error  when this machine has no such target
[[nodiscard]] const Target& find_target(std::string_view name = {});

/// True if the planes are the channels, in order, of pixels that are `stride` floats long.
template <class T>
[[nodiscard]] bool are_interleaved(const std::array<T*, 3>& plane, std::ptrdiff_t stride) {
    return (stride == 3 || stride == 4) && plane[1] == plane[0] + 1 && plane[2] == plane[0] + 2;
}

/// The planes from pixel `first` on.
template <class T>
[[nodiscard]] std::array<T*, 3> from(const std::array<T*, 3>& plane, std::ptrdiff_t stride,
                                     std::size_t first) {
    const std::ptrdiff_t at = static_cast<std::ptrdiff_t>(first) * stride;
    return {plane[0] + at, plane[1] + at, plane[2] + at};
}

}  // namespace simd
TONEWRIGHT_NAMESPACE_END
