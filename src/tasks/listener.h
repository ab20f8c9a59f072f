// SPDX-License-Identifier: Apache-2.0
//
// Tasks are what the command and the Python module do: a request of resolved values in, a result
// out.
#pragma once

#include <cstddef>
#include <functional>
#include <string>

#include "tonewright/version.h"

TONEWRIGHT_NAMESPACE_BEGIN

/// Receives what a task says while it runs. Empty functions mean that nobody listens.
struct Listener {
    /// A result may differ from the user's intention: one line, @see render. Called before the
    /// result is written. What it throws ends the task.
    std::function<void(const std::string& line)> warn = {};
    std::function<void(std::size_t done, std::size_t total)> progress = {};

    /// Hands the line on, unless it is empty.
    void warn_of(const std::string& line) const {
        if (warn && !line.empty()) warn(line);
    }
};

TONEWRIGHT_NAMESPACE_END
