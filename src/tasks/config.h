// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "tasks/listener.h"
#include "tonewright/ocio.h"

TONEWRIGHT_NAMESPACE_BEGIN

/// A new config as a folder, an archive or both.
struct ConfigRequest {
    ConfigOptions options;
    /// Empty: none.
    std::string folder = {};
    /// An .ocioz file with `config.ocio` and its tables. Empty: none.
    std::string archive = {};
};

/// A folder or an archive that was written.
struct WrittenConfig {
    std::string path;
    std::size_t files = 0;
    std::size_t bytes = 0;
};

/// @throws Error      @see ConfigPlan; another extension of the archive
/// @throws FileError  a file cannot be written
std::vector<WrittenConfig> write_config(const ConfigRequest& request, const Listener& listener);

TONEWRIGHT_NAMESPACE_END
