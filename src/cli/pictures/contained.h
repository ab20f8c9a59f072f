// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <functional>
#include <string>
#include <vector>

#include "tonewright/version.h"

TONEWRIGHT_NAMESPACE_BEGIN

/// What became of a piece of work in a process of its own.
struct ContainedResult {
    /// What went wrong: a FileError (a crash and a timeout, too), an Error, another exception.
    enum class Failure { none, file, usage, other };

    /// What the work returned.
    std::string value = {};
    Failure failure = Failure::none;
    /// In one line, with the name; empty: nothing went wrong.
    std::string error = {};

    /// Throws what the work threw, in this process.
    void require() const;
};

/// Runs pieces of work, each in a process of its own, so that one that crashes or hangs in a reader
/// does not stop the others.
///
/// Call it before OpenImageIO and OpenEXR have made their thread pools: a new process has one
/// thread only, and would wait for the others. The work says how many threads its own process
/// takes.
///
/// @param names    of the files, for the messages: one for each piece of work
/// @param jobs     processes at the same time
/// @param seconds  that each may take; one that takes longer is killed
/// @param work     returns the value, in the new process
/// @param done     called in this process when a piece of work has ended
void run_contained(const std::vector<std::string>& names, std::size_t jobs, double seconds,
                   const std::function<std::string(std::size_t)>& work,
                   const std::function<void(std::size_t, const ContainedResult&)>& done);

TONEWRIGHT_NAMESPACE_END
