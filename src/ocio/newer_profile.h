// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "tonewright/version.h"

TONEWRIGHT_NAMESPACE_BEGIN

/// A config of a newer profile, as the linked OpenColorIO can read it: without ids, and without the
/// transforms that only newer versions have.
struct ReadableProfile {
    std::string text;
    /// The profile of the config, and the newest one of OpenColorIO: "2.5", "2.1".
    std::string profile;
    std::string newest;
    /// Contents whose transform is an identity here, because OpenColorIO does not know it:
    /// "view transform ACES 2.0".
    std::vector<std::string> unread;
    /// Displays whose transform is an older one here, which differs below 0 alone.
    std::vector<std::string> older;
};

/// Empty if OpenColorIO reads the profile, or if the text is no config with a profile.
[[nodiscard]] std::optional<ReadableProfile> make_readable(const std::string& text);

TONEWRIGHT_NAMESPACE_END
