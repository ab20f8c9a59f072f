// SPDX-License-Identifier: Apache-2.0
//
// Chunks of PNG files that OpenImageIO does not write.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

#include "tonewright/version.h"

TONEWRIGHT_NAMESPACE_BEGIN

/// Coding-independent code points of RGB of full range: ITU-T H.273 (07/2021), tables 2 and 3.
struct CodePoints {
    std::uint8_t primaries;
    std::uint8_t transfer;
};

/// The place of the first chunk after the header: 8 bytes of signature, 25 of IHDR.
inline constexpr std::size_t kAfterPngHeader = 33;

/// A chunk with its length and its checksum. W3C PNG (third edition), 5.3.
/// @param type  four letters
[[nodiscard]] TONEWRIGHT_API std::string png_chunk(std::string_view type, std::string_view data);

/// The cICP chunk. W3C PNG (third edition), 11.3.2.6. It belongs before PLTE and IDAT.
[[nodiscard]] TONEWRIGHT_API std::string cicp_chunk(const CodePoints& points);

/// Light of a picture on its display, in cd/m2. CTA-861.3-A, annex P: the largest channel of a
/// pixel (MaxCLL), and the mean of each pixel's largest channel (MaxFALL).
struct LightLevels {
    double largest = 0;
    double mean = 0;
};
/// The cLLI chunk, always of the same size. W3C PNG (third edition), 11.3.2.8: before PLTE and
/// IDAT, in units of 0.0001 cd/m2. An application that knows the levels need not reduce the
/// picture to what its display shows.
[[nodiscard]] TONEWRIGHT_API std::string clli_chunk(const LightLevels& levels);

TONEWRIGHT_NAMESPACE_END
