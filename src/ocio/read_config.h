// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <OpenColorIO/OpenColorIO.h>

#include <string>

#include "tonewright/version.h"
namespace OCIO = OCIO_NAMESPACE;

TONEWRIGHT_NAMESPACE_BEGIN

/// OpenColorIO 2.1's own copy forgets which view transform is the default, and with it what becomes
/// of scene light that is converted to a display.
[[nodiscard]] OCIO::ConfigRcPtr editable_copy(const OCIO::Config& config);

/// Without a cache of processors: its keys ignore what is in tables.
/// @throws FileError  for a file that is missing or no config, with OpenColorIO's reason; for one
/// with
///                    thousands of spaces or views; and what check_references() throws
[[nodiscard]] OCIO::ConfigRcPtr read_config(const std::string& path);

/// The same of a text, for a config that would be at the path.
[[nodiscard]] OCIO::ConfigRcPtr read_config(const std::string& path, const std::string& text);

/// The text of a config. @throws FileError
[[nodiscard]] std::string read_config_text(const std::string& path);

TONEWRIGHT_NAMESPACE_END
