// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <OpenImageIO/imageio.h>

#include <string>
#include <vector>

#include "tonewright/version.h"

TONEWRIGHT_NAMESPACE_BEGIN

/// A picture that a writer has finished, and what it was to be.
struct WrittenPicture {
    std::string path;
    OIIO::ImageSpec spec;
    std::string format;
    bool is_avif = false;
    /// OpenImageIO opened the file itself, so that nothing has told of a full disk.
    bool is_opened_by_name = false;
    /// Bits of integers; 0: those of the type.
    int bits = 0;
    /// Null: they are not compared.
    const std::vector<float>* pixels = nullptr;
};

/// Reads the file again.
/// @returns  the difference from what was to be written; empty if there is none
[[nodiscard]] std::string fault_of(const WrittenPicture& written);

TONEWRIGHT_NAMESPACE_END
