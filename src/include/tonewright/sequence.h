// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "tonewright/tonemap.h"

/// The frames of a shot.
TONEWRIGHT_NAMESPACE_BEGIN

/// A frame of a shot, and its result.
struct FrameFiles {
    std::string in;
    std::string out;
    /// Replaces the tonemapper's exposure, in stops.
    std::optional<double> exposure_stops = {};
    /// Why there is no result.
    std::optional<Problem> problem = {};
    /// True if `out` existed and was kept. @see SequenceOptions::skip_existing
    bool is_skipped = false;
};

struct SequenceOptions {
    /// `warn` is called from one thread at a time.
    WriteOptions write = {};
    /// Keeps a frame's `out` if it is newer than `in`, has the expected size, channels and pixel
    /// type, and is complete. The operator and the exposure of an earlier run are not known.
    bool skip_existing = false;
    /// Frames at the same time, each with its own memory. 0: as many as threads.
    int jobs = 0;
    /// Threads for all frames together; each frame has at least one. 0: OIIO's `threads` attribute.
    int nthreads = 0;
    /// Options for reading each frame. `warn` and `note` are called from one thread at a time.
    ReadOptions read = {};
    /// Warnings and notes begin with the name of their picture.
    bool names_pictures = false;
    /// Called after each frame, from one thread at a time.
    std::function<void(const FrameFiles&)> done = {};
};

/// Runs tonemap_file() on many files, several at the same time. A frame that fails does not stop
/// the others. Jobs, threads and the choice of frames change no byte of the files.
///
/// First removes temporary files that killed runs left for the same frames: those whose process on
/// this machine has ended, and those that are older than a day.
///
/// @param frames  receives the results
TONEWRIGHT_API void tonemap_files(const Tonemapper& tonemapper, std::vector<FrameFiles>& frames,
                                  const SequenceOptions& options = {});

TONEWRIGHT_NAMESPACE_END
