// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "tonewright/error.h"
#include "tonewright/version.h"

TONEWRIGHT_NAMESPACE_BEGIN

/// The processors and the time for pictures.
struct PictureWork {
    /// For all pictures together. 0: all cores.
    int threads = 0;
    /// Seconds for each picture, which then has its own process. 0: no limit, and no process.
    double timeout = 0;
};

/// Sets the number of threads of OpenImageIO and OpenEXR; 0: all cores.
void set_picture_threads(int count);

/// Result of work in a separate process.
struct ContainedResult {
    /// The result of the work.
    std::string value = {};
    /// The problem of the work's exception; of kind `file` for a crash and a timeout.
    std::optional<Problem> problem = {};
};

/// Runs pieces of work, each in its own process, so that a crash or a hang in a reader does not
/// stop the others.
///
/// Call it before OpenImageIO and OpenEXR have made their thread pools: a new process has one
/// thread only, and would wait for the others. The work sets the number of threads of its process.
///
/// @param names    of the files, for the messages: one for each piece of work
/// @param jobs     processes at the same time
/// @param seconds  limit for each; a process that takes longer is killed
/// @param work     returns the value, in the new process
/// @param done     called in this process after each piece of work
void run_contained(const std::vector<std::string>& names, std::size_t jobs, double seconds,
                   const std::function<std::string(std::size_t)>& work,
                   const std::function<void(std::size_t, const ContainedResult&)>& done);

TONEWRIGHT_NAMESPACE_END
