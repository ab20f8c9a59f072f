// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "cli/picture_options.h"
#include "tonewright/sequence.h"
#include "tonewright/tonemap.h"

TONEWRIGHT_NAMESPACE_BEGIN

/// Tone maps every frame, also after failures. Shows the progress on a terminal, and the results at
/// the end on standard error.
/// @param options   `in` and `out` are names with placeholders for the number. @see frame_name
/// @param prepare   called with the frames and their numbers before the first one
/// @returns         the exit code
/// @throws Error    an error that concerns all frames
int apply_to_frames(
    const Tonemapper& tonemapper, const ApplyOptions& options, WriteOptions write,
    const std::function<void(std::vector<FrameFiles>&, const std::vector<int>&)>& prepare);

/// The same for pictures that are not frames of a shot.
/// @returns  the exit code
int apply_to_files(const Tonemapper& tonemapper, const ApplyOptions& options,
                   std::vector<FrameFiles>& files, WriteOptions write);

/// tonemap_files() with a timeout: each file has its own process. Leaves out files that already
/// have an error. Removes incomplete output of a killed process.
void tonemap_contained(const Tonemapper& tonemapper, std::vector<FrameFiles>& files,
                       const SequenceOptions& options, const PictureInput& picture);

/// tonemap_file() with a timeout: in its own process.
/// @throws  as tonemap_file(); FileError for a crash and the timeout
void tonemap_contained(const Tonemapper& tonemapper, const FrameFiles& file,
                       const WriteOptions& write, const ReadOptions& read,
                       const PictureInput& picture);

/// Options for reading the pictures of `apply`, without callbacks.
[[nodiscard]] ReadOptions read_options_of(const ApplyOptions& options);

TONEWRIGHT_NAMESPACE_END
