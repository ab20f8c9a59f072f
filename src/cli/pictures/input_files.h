// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "cli/picture_options.h"
#include "tonewright/sequence.h"

TONEWRIGHT_NAMESPACE_BEGIN

/// Input and output files of `apply`.
struct ApplyFiles {
    /// One picture, or the pattern of a shot.
    bool is_single = true;
    std::vector<FrameFiles> files;
};

/// The files of the arguments, also those of folders and lists.
/// @throws Error      no output, or two outputs of one name
/// @throws FileError  a folder without pictures, or a list that cannot be read
[[nodiscard]] ApplyFiles files_of(const ApplyOptions& options);

TONEWRIGHT_NAMESPACE_END
