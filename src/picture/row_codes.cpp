// SPDX-License-Identifier: Apache-2.0
#include "picture/row_codes.h"

#include <algorithm>
#include <bit>
#include <cstring>
#include <utility>

#include "base/half_value.h"
#include "lut/in_parallel.h"
#include "picture/png_kernels.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

using T = OIIO::TypeDesc;

}  // namespace

RowCodes::RowCodes(const PictureSpec& spec)
    : value_count_(static_cast<std::size_t>(spec.width) * static_cast<std::size_t>(spec.nchannels)),
      code_bytes_(size_of(spec.format)) {}

void RowCodes::convert_floats(const float* from, std::uint8_t* to, std::size_t count) const {
    const PngKernels& with = png_kernels().front();
    if (code_bytes_ == 1) {
        with.to_codes_8(from, to, count);
    } else {
        with.to_codes_16(from, to, count);
    }
}

void RowCodes::fill_table() {
    constexpr std::size_t kHalves = 65536;
    std::vector<float> values(kHalves);
    for (unsigned bits = 0; bits < kHalves; ++bits)
        values[bits] = static_cast<float>(half_value(bits));
    codes_of_halves_.resize(kHalves * code_bytes_);
    convert_floats(values.data(), codes_of_halves_.data(), kHalves);
}

void RowCodes::convert_row(const OIIO::TypeDesc& type, const std::byte* from,
                           std::uint8_t* to) const {
    if (type.basetype == T::FLOAT) {
        convert_floats(reinterpret_cast<const float*>(from), to, value_count_);
        return;
    }
    if (type.basetype == T::HALF) {
        for (std::size_t i = 0; i < value_count_; ++i) {
            std::uint16_t half = 0;
            std::memcpy(&half, from + 2 * i, sizeof half);
            std::memcpy(to + code_bytes_ * i, &codes_of_halves_[code_bytes_ * half], code_bytes_);
        }
        return;
    }
    std::memcpy(to, from, value_count_ * code_bytes_);
    if (code_bytes_ == 2 && std::endian::native == std::endian::little) {
        for (std::size_t i = 0; i < 2 * value_count_; i += 2)
            std::swap(to[i], to[i + 1]);
    }
}

void RowCodes::convert(std::size_t row_count, const OIIO::TypeDesc& type, const std::byte* from,
                       std::uint8_t* to, std::size_t stride, unsigned threads) {
    if (type.basetype == T::HALF && codes_of_halves_.empty()) fill_table();
    constexpr std::size_t kRows = 16;  // for each thread at a time
    in_parallel((row_count + kRows - 1) / kRows, threads, [&](std::size_t piece) {
        const std::size_t end = std::min(row_count, kRows * (piece + 1));
        for (std::size_t row = kRows * piece; row < end; ++row)
            convert_row(type, from + row * row_bytes(type), to + row * stride);
    });
}

TONEWRIGHT_NAMESPACE_END
