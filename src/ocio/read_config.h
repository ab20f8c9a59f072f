// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <OpenColorIO/OpenColorIO.h>

#include <optional>
#include <string>

#include "ocio/newer_profile.h"
#include "tonewright/version.h"
namespace OCIO = OCIO_NAMESPACE;

TONEWRIGHT_NAMESPACE_BEGIN

/// OpenColorIO 2.1's own copy loses the default view transform, and with it the conversion from
/// scene-linear to a display.
[[nodiscard]] OCIO::ConfigRcPtr editable_copy(const OCIO::Config& config);

/// Disables the processor cache, because its keys ignore the contents of tables.
/// @throws FileError  if the file is missing or no config, with OpenColorIO's reason; if it has
///                    thousands of spaces or views; and as check_references() throws
[[nodiscard]] OCIO::ConfigRcPtr read_config(const std::string& path);

/// The same for a text, as a config at this path.
[[nodiscard]] OCIO::ConfigRcPtr read_config(const std::string& path, const std::string& text);

/// A config of any profile.
struct AnyConfig {
    OCIO::ConfigRcPtr config;
    /// The profile that the config was read with, if its own is newer than those of OpenColorIO.
    std::optional<ReadableProfile> newer = {};
};

/// The same for a config of any profile: of a newer one, without what OpenColorIO does not know.
[[nodiscard]] AnyConfig read_any_config(const std::string& path, const std::string& text);

/// The text of a config. @throws FileError
[[nodiscard]] std::string read_config_text(const std::string& path);

TONEWRIGHT_NAMESPACE_END
