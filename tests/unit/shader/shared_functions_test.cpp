// SPDX-License-Identifier: Apache-2.0
#include "tonewright/shader.h"

#include <gtest/gtest.h>

#include "full_counts.h"
#include "tonewright/error.h"
#include "unit/shader/requests.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

// Three channels share a function; its formula stands there once.
TEST(Shader, ACurveOfEachChannelIsWrittenOnce) {
    const ShaderErrors unmeasured;
    const std::string text = write_shader(request_of("agx_blender:formula"), &unmeasured).text;
    const auto count_of = [&](const std::string& words) {
        int count = 0;
        for (std::size_t at = text.find(words); at != std::string::npos;
             at = text.find(words, at + 1))
            ++count;
        return count;
    };
    EXPECT_EQ(count_of("log2("), 1);
    EXPECT_EQ(count_of("_mix_curve("), 4);  // and three calls
}

}  // namespace
TONEWRIGHT_NAMESPACE_END
