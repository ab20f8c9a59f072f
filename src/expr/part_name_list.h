// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <vector>

#include "tonewright/expr.h"

TONEWRIGHT_NAMESPACE_BEGIN

/// Names in the order in which they were given: those of `first`, of `second`, then `entries`.
/// Expressions share the lists of what they are built of.
struct PartNameList {
    std::shared_ptr<const PartNameList> first;
    std::shared_ptr<const PartNameList> second;
    /// Their parts carry no names.
    std::vector<PartNames::Entry> entries;
};

/// The names of both.
[[nodiscard]] std::shared_ptr<const PartNameList> joined(
    const std::shared_ptr<const PartNameList>& a, const std::shared_ptr<const PartNameList>& b);

TONEWRIGHT_NAMESPACE_END
