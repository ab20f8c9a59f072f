// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "ocio/transforms.h"

TONEWRIGHT_NAMESPACE_BEGIN

/// The transforms of a LUT file that OpenColorIO reads, one after the other, after the file has
/// been validated.
/// @param contents  gets the bytes of the file
/// @param note      gets a line about a keyword that was ignored, or nothing
/// @throws FileError  as LutFile does
[[nodiscard]] OCIO::ConstGroupTransformRcPtr lut_transforms(const std::string& path,
                                                            std::string& contents,
                                                            std::string& note);

TONEWRIGHT_NAMESPACE_END
