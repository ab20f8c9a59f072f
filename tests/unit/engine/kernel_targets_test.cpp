// SPDX-License-Identifier: Apache-2.0
#include "engine/kernel_targets.h"

#include <gtest/gtest.h>

#include <cstdint>

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

/// Code for an instruction set that the processor or its system lacks would end the program, and
/// code for a lesser one would be slow. Highway finds the instruction sets in its own way.
TEST(KernelTargets, AreThoseThatHighwayFinds) {
    const std::int64_t ours = targets_of_this_machine();
    const std::int64_t expected = hwy::SupportedTargets();
    const std::int64_t known = HWY_TARGETS & ~HWY_STATIC_TARGET;
    EXPECT_EQ(ours & known, expected & known) << std::hex << ours << " and " << expected;
    EXPECT_NE(ours & HWY_STATIC_TARGET, 0);
}

}  // namespace
TONEWRIGHT_NAMESPACE_END
