// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "picture/picture_spec.h"

TONEWRIGHT_NAMESPACE_BEGIN

/// Converts rows to code values of 8 or 16 bits, the high byte first, with OpenImageIO's rounding.
class RowCodes {
  public:
    /// @param spec  of a file with UINT8 or UINT16
    explicit RowCodes(const PictureSpec& spec);

    /// Bytes of a row that has this type.
    [[nodiscard]] std::size_t row_bytes(const OIIO::TypeDesc& type) const {
        return value_count_ * size_of(type);
    }
    /// Converts packed rows on threads.
    /// @param type     HALF, FLOAT or the type of the file
    /// @param to       of the first row
    /// @param stride   bytes between rows there
    /// @param threads  as for in_parallel()
    void convert(std::size_t row_count, const OIIO::TypeDesc& type, const std::byte* from,
                 std::uint8_t* to, std::size_t stride, unsigned threads);

  private:
    void fill_table();
    void convert_row(const OIIO::TypeDesc& type, const std::byte* from, std::uint8_t* to) const;
    void convert_floats(const float* from, std::uint8_t* to, std::size_t count) const;

    std::size_t value_count_;
    std::size_t code_bytes_;
    std::vector<std::uint8_t> codes_of_halves_;  // of all bit patterns
};

TONEWRIGHT_NAMESPACE_END
