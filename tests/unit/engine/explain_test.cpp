// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <string>

#include "tonewright/engine.h"
#include "tonewright/registry.h"
#include "tonewright/view.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

Pipeline view_of(const char* op) {
    return build_view(make_view(resolve_operator(op), "lin_rec709", 0, "srgb"));
}

TEST(Explain, SaysHowEveryTargetRuns) {
    for (const std::string& target : SimdEngine::targets()) {
        const std::string text = explain(view_of("hable"), {}, kSimdError, target);
        EXPECT_NE(text.find("\nMachine code"), std::string::npos) << target;
        const bool is_written = target.rfind("AVX", 0) == 0;
        if (!is_written) {
            EXPECT_NE(text.find("Machine code: none"), std::string::npos) << target;
        }
        EXPECT_EQ(text, explain(view_of("hable"), {}, kSimdError, target))
            << "the same on every call";
    }
    EXPECT_THROW((void)explain(view_of("hable"), {}, kSimdError, "AVX9"), Error);
}

TEST(Explain, ATighterGoalComputesMoreInDouble) {
    // AgX subtracts rows of matrices that nearly cancel: within 1e-12 no float is good enough.
    const auto doubles = [](double goal) {
        const std::string text = explain(view_of("agx_sobotka"), {}, goal);
        std::size_t count = 0;
        for (std::size_t at = text.find(".f64"); at != std::string::npos;
             at = text.find(".f64", at + 1))
            ++count;
        return count;
    };
    EXPECT_GT(doubles(1e-12), doubles(1e-3));
}

}  // namespace
TONEWRIGHT_NAMESPACE_END
