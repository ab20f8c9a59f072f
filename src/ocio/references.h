// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <OpenColorIO/OpenColorIO.h>

#include <functional>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "tonewright/version.h"
namespace OCIO = OCIO_NAMESPACE;

TONEWRIGHT_NAMESPACE_BEGIN

/// All color spaces of a config by their names and aliases: OpenColorIO's lookup is linear.
class TONEWRIGHT_API SpaceIndex {
  public:
    explicit SpaceIndex(const OCIO::Config& config);

    /// In the config's order, inactive ones included.
    [[nodiscard]] const std::vector<OCIO::ConstColorSpaceRcPtr>& all() const { return all_; }
    /// By name, alias or role, ignoring case; null if there is none.
    [[nodiscard]] OCIO::ConstColorSpaceRcPtr find(std::string_view name) const;

  private:
    std::vector<OCIO::ConstColorSpaceRcPtr> all_;
    std::map<std::string, OCIO::ConstColorSpaceRcPtr> by_name_;
};

/// Calls `visit` with every transform of a tree of groups.
TONEWRIGHT_API void for_each_transform(
    const OCIO::ConstTransformRcPtr& transform,
    const std::function<void(const OCIO::ConstTransformRcPtr&)>& visit);

/// Refuses contents that crash or hang OpenColorIO: color spaces, looks and views with cyclic or
/// very deep references, and LUTs that are pipes or devices.
/// @param path  for messages
/// @throws FileError
void check_references(const OCIO::Config& config, const std::string& path);

TONEWRIGHT_NAMESPACE_END
