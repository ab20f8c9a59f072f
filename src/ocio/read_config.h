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
/// @throws FileError  for a file that is missing or no config, with OpenColorIO's reason
[[nodiscard]] OCIO::ConfigRcPtr read_config(const std::string& path);

TONEWRIGHT_NAMESPACE_END
