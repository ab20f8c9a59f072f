// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "tonewright/tonemap.h"

/// The frames of a shot.
TONEWRIGHT_NAMESPACE_BEGIN

/// A frame of a shot, and what became of it.
struct FrameFiles {
    std::string in;
    std::string out;
    /// Instead of the tonemapper's exposure, in stops.
    std::optional<double> exposure_stops = {};
    /// Of `in`.
    int subimage = 0;
    /// What went wrong, in one line; empty: nothing.
    std::string error = {};
    /// It was a FileError.
    bool is_file_error = false;
    /// `out` was there already, and stayed as it was. @see SequenceOptions::skip_existing
    bool is_skipped = false;
};

struct SequenceOptions {
    /// Of the files. `warn` is called from one thread at a time.
    WriteOptions write = {};
    /// Leaves a frame's `out` as it is if it is newer than `in`, has the size and the pixel type
    /// that it would have, and can be read to its end. What it was made with nobody knows: with
    /// another operator or another exposure it would have other colors.
    bool skip_existing = false;
    /// Frames at the same time, each with memory of its own. 0: as many as threads.
    int jobs = 0;
    /// Threads of all of them together; each frame has at least one. 0: OIIO's `threads` attribute.
    int nthreads = 0;
    /// Of each frame. @see read_image
    double max_pixels = kMaxPixels;
    /// Called after each frame, from one thread at a time.
    std::function<void(const FrameFiles&)> done = {};
};

/// tonemap_file() of many files, several at the same time: while one is read another is written.
/// One that fails does not stop the others. The bytes do not depend on jobs and threads, nor on
/// which frames are made in one run.
///
/// First removes temporary files that killed runs left of the same frames: those of processes of
/// this machine that are no more, and those that are older than a day.
///
/// @param frames  gets what became of each.
TONEWRIGHT_API void tonemap_files(const Tonemapper& tonemapper, std::vector<FrameFiles>& frames,
                                  const SequenceOptions& options = {});

TONEWRIGHT_NAMESPACE_END
