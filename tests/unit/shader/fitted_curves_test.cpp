// SPDX-License-Identifier: Apache-2.0
#include "tonewright/shader.h"

#include <gtest/gtest.h>

#include "tonewright/error.h"
#include "unit/shader/requests.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

// Curves in front of an argument and behind it, and one that reads it.
TEST(Shader, FittedCurvesLeaveArgumentsAlone) {
    ShaderRequest request = request_of("uchimura", "", "srgb");
    request.curves = ShaderCurves::fitted;
    for (const std::vector<std::string>& uniforms :
         {std::vector<std::string>{"exposure"}, {"max_brightness"}, {"exposure", "contrast"}}) {
        request.uniforms = uniforms;
        // An error of the polynomials is at most 3 units of 2^-24.
        EXPECT_LE(measure_shader(request).in_float, 4e-7) << uniforms.back();
    }
    const ShaderErrors unmeasured;
    const std::string text = write_shader(request, &unmeasured).text;
    EXPECT_NE(text.find("exp2(exposure)"), std::string::npos);
}

}  // namespace
TONEWRIGHT_NAMESPACE_END
