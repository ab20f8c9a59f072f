// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <string>
#include <vector>

#include "ocio/config_builder.h"
#include "ocio/model.h"

TONEWRIGHT_NAMESPACE_BEGIN

/// Stands for a built-in transform that the library at hand may not know, in a config that
/// to_profile_2_5() writes.
[[nodiscard]] OCIO::TransformRcPtr builtin_of_profile_2_5(const std::string& style);

/// The YAML of a config of profile 2.1, which every library can write, as one of profile 2.5: with
/// the transforms that builtin_of_profile_2_5() stands for, interop ids of spaces, and the ids that
/// ACES Metadata Files have for spaces and view transforms.
[[nodiscard]] std::string to_profile_2_5(
    const std::string& yaml, const ConfigModel& model,
    const std::map<std::string, std::vector<DisplayedView>>& displayed);

TONEWRIGHT_NAMESPACE_END
