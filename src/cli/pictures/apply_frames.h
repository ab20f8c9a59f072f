// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "cli/picture_options.h"
#include "tonewright/sequence.h"
#include "tonewright/tonemap.h"

TONEWRIGHT_NAMESPACE_BEGIN

/// Every frame, whatever becomes of the others: how far it is on a terminal, and at the end what
/// became of them, on standard error.
/// @param options   `in` and `out` are names with places for the number. @see frame_name
/// @param prepare   called with the frames and their numbers before any is made
/// @returns         the exit code
/// @throws Error    what is wrong with the whole of it
int apply_to_frames(
    const Tonemapper& tonemapper, const ApplyOptions& options, WriteOptions write,
    const std::function<void(std::vector<FrameFiles>&, const std::vector<int>&)>& prepare);

/// Pictures that are no shot, in the same way.
/// @returns  the exit code
int apply_to_files(const Tonemapper& tonemapper, const ApplyOptions& options,
                   std::vector<FrameFiles>& files, WriteOptions write);

/// tonemap_files() with a timeout: each file in a process of its own. A file that has an error
/// already is left out. What a killed process left of its output is removed.
void tonemap_contained(const Tonemapper& tonemapper, std::vector<FrameFiles>& files,
                       const SequenceOptions& options, const PictureInput& picture);

/// tonemap_file() with a timeout: in a process of its own.
/// @throws  what tonemap_file() throws; FileError for a crash and the timeout
void tonemap_contained(const Tonemapper& tonemapper, const FrameFiles& file,
                       const WriteOptions& write, const PictureInput& picture);

TONEWRIGHT_NAMESPACE_END
