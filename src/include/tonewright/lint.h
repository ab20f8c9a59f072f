// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "tonewright/version.h"

TONEWRIGHT_NAMESPACE_BEGIN

/// One thing that is wrong, or odd, with an OpenColorIO config.
struct LintFinding {
    enum class Level : unsigned char {
        error,    // something does not work: a space, a view or the whole config
        warning,  // something does not work, or looks otherwise, in some applications
        note      // worth knowing
    };
    Level level = Level::warning;
    /// "config", "role data", "space ACEScct", "view sRGB / AgX"
    std::string where;
    std::string what;
};

/// Any config, ours or not: names (length, twice the same, aliases that are roles), roles of
/// applications, interchange roles, lists of what is active or inactive, displays and the spaces of
/// views, view transforms, search paths and tables, interpolation; and of every active view what
/// NaN, infinities and negatives become, and how far OpenColorIO's GPU path is from its CPU path.
/// @param path      of the config
/// @param with_gpu  the last of these, where OpenGL can be had
/// @throws FileError  for a config that cannot be read
[[nodiscard]] TONEWRIGHT_API std::vector<LintFinding> lint_config(const std::string& path,
                                                                  bool with_gpu);

TONEWRIGHT_NAMESPACE_END
