// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <string>

#include "picture/exr_header.h"
#include "picture/picture_spec.h"

TONEWRIGHT_NAMESPACE_BEGIN

/// Replaces what OpenEXR lacks, and adds the attributes that OpenImageIO 2.4 adds while it opens a
/// file: compression, order of lines, time of writing.
void fit_to_exr(PictureSpec& spec);

/// The bytes of a file of one part with rows from its first byte to the table of blocks, as
/// OpenImageIO 2.4 writes them for a spec of fit_to_exr().
[[nodiscard]] std::string exr_header_of(const PictureSpec& spec, exr_compression_t compression);

TONEWRIGHT_NAMESPACE_END
