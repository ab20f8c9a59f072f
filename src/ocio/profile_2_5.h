// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <string>
#include <vector>

#include "ocio/model.h"
#include "ocio/read_config.h"

TONEWRIGHT_NAMESPACE_BEGIN

/// Placeholder for a built-in transform that the current library may not support, for configs of
/// to_profile_2_5().
[[nodiscard]] OCIO::TransformRcPtr builtin_of_profile_2_5(const std::string& style);

/// Converts the YAML of a config from profile 2.1, which every library can write, to profile 2.5:
/// replaces the placeholders of builtin_of_profile_2_5(), and adds interop ids of spaces and the
/// ids of ACES Metadata Files for spaces and view transforms.
[[nodiscard]] std::string to_profile_2_5(
    const std::string& yaml, const ConfigModel& model,
    const std::map<std::string, std::vector<DisplayedView>>& displayed);

TONEWRIGHT_NAMESPACE_END
