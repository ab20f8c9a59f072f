// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "tonewright/version.h"

TONEWRIGHT_NAMESPACE_BEGIN

/// One finding about an OpenColorIO config.
struct LintFinding {
    enum class Level : unsigned char {
        error,    // a space, a view or the whole config does not work
        warning,  // something fails or looks different in some applications
        note      // worth knowing
    };
    Level level = Level::warning;
    /// "config", "role data", "space ACEScct", "view sRGB / AgX"
    std::string where;
    std::string what;
};

/// Checks any config: names (length, duplicates, aliases that are roles), roles of applications,
/// interchange roles, lists of active and inactive items, displays and the spaces of views, view
/// transforms, search paths and tables, interpolation. For every active view: the result of NaN,
/// infinities and negatives, and the difference between OpenColorIO's GPU path and its CPU path.
/// @param path      of the config
/// @param with_gpu  includes the GPU path, if OpenGL is available
/// @throws FileError  the config cannot be read
[[nodiscard]] TONEWRIGHT_API std::vector<LintFinding> lint_config(const std::string& path,
                                                                  bool with_gpu);

TONEWRIGHT_NAMESPACE_END
