// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "lut/formats/cube_text.h"
#include "tonewright/version.h"

TONEWRIGHT_NAMESPACE_BEGIN

/// Extensions of the LUT files that are text, with the dot.
[[nodiscard]] TONEWRIGHT_API const std::vector<std::string>& lut_text_extensions();

/// Validates a LUT file before OpenColorIO reads it. OpenColorIO's readers allocate any size that a
/// file declares, skip lines that they do not understand, accept NaN as a number and wait forever
/// for the end of a .csp's metadata. If one reader fails, OpenColorIO tries all others. So a file
/// must have the format of its extension, and no free text that makes another reader allocate
/// memory. Accepts files found in practice: CRLF, comments, empty lines, no TITLE, DOMAIN_MIN and
/// DOMAIN_MAX or LUT_3D_INPUT_RANGE, keywords of applications before the size. Needs almost no
/// memory.
/// @param path   its extension determines the format
/// @param bytes  loses a byte order mark, which OpenColorIO's readers do not accept
/// @returns  one line about a keyword that is unknown and ignored; empty if there is none.
/// @throws FileError  with path, line and reason.
[[nodiscard]] TONEWRIGHT_API std::string check_lut_text(const std::string& path,
                                                        std::string& bytes);

/// Refuses words that OpenColorIO 2.1 copies into buffers that are too small, in a file of any
/// format that it will read: a config's LUT, which is not validated otherwise.
/// @throws FileError  with path, line and reason.
TONEWRIGHT_API void check_lut_words(const std::string& path, std::string_view bytes);

/// True for .cube, .dat, .mga, .m3d and .look, which parse_cube() reads.
[[nodiscard]] TONEWRIGHT_API bool is_parsed_here(const std::string& extension);

/// Adobe's and Resolve's .cube, DaVinci's .dat, Pandora's .mga and .m3d, and Iridas's .look, by the
/// extension. OpenColorIO's readers do not accept a TITLE together with a range, which many files
/// have.
/// @throws FileError  with path, line and reason.
[[nodiscard]] TONEWRIGHT_API CubeText parse_cube(const std::string& path, std::string_view text);

TONEWRIGHT_NAMESPACE_END
