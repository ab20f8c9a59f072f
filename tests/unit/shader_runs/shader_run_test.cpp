// SPDX-License-Identifier: Apache-2.0
#include "shader_runs/shader_run.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "tonewright/engine.h"
#include "tonewright/error.h"
#include "tonewright/registry.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

// WGSL and HLSL need packages of npm: tests/shader/test_verify.py.
class ShaderRunOf : public testing::TestWithParam<const char*> {};
INSTANTIATE_TEST_SUITE_P(All, ShaderRunOf, testing::Values("glsl", "glsl-es", "dctl", "c"));

/// Largest difference from the reference.
double error_of(ShaderRun& run, const Shader& shader, const View& view) {
    std::vector<float> rgb;
    for (int i = -100; i < 1200; ++i) {
        const float x = 0.01F * static_cast<float>(i);
        rgb.insert(rgb.end(), {x, 0.5F * x, x * x});
    }
    std::vector<float> got(rgb.size());
    std::vector<double> truth(rgb.size());
    run.run_rgb(shader, rgb.data(), got.data(), rgb.size() / 3);
    ReferenceEngine(build_view(view)).run_rgb(rgb.data(), truth.data(), rgb.size() / 3);
    double worst = 0;
    for (std::size_t i = 0; i < got.size(); ++i)
        worst = std::max(worst, std::fabs(static_cast<double>(got[i]) - truth[i]));
    return worst;
}

TEST_P(ShaderRunOf, RunsTheTextThatItIsGiven) {
    VerifyOptions options;
    const std::vector<NotExecuted> not_executed = add_shader_runs(options, {GetParam()});
    if (options.shaders.empty()) GTEST_SKIP() << not_executed.at(0).reason;
    ShaderRun& run = *options.shaders[0].run;
    const View view = make_view(resolve_operator("hable"), "lin_rec709", 0, "srgb");
    const Shader shader =
        write_shader({.view = view, .language = find_shader_language(GetParam()).language});
    // A few roundings of numbers around 1, as tests/shader/ allow.
    EXPECT_LE(error_of(run, shader, view), 2e-6);

    Shader wrong = shader;
    const std::string linear_angle = "0.05";
    wrong.text.replace(wrong.text.rfind(linear_angle), linear_angle.size(), "0.06");
    EXPECT_GE(error_of(run, wrong, view), 1e-3);

    wrong.text += "@";
    EXPECT_THROW(error_of(run, wrong, view), Error);
    EXPECT_LE(error_of(run, shader, view), 2e-6) << "after a text that does not compile";
}

TEST(ShaderRuns, NamesAreChecked) {
    VerifyOptions options;
    EXPECT_TRUE(add_shader_runs(options, {"none"}).empty());
    EXPECT_TRUE(options.shaders.empty());
    EXPECT_THROW(add_shader_runs(options, {"msl"}), Error);
    EXPECT_THROW(add_shader_runs(options, {"none", "c"}), Error);
    options.with_gpu = false;
    EXPECT_TRUE(add_shader_runs(options, {"c"}).empty());
    EXPECT_TRUE(options.shaders.empty()) << "nothing runs";
    EXPECT_THROW(add_shader_runs(options, {"msl"}), Error) << "the names are checked";
}

TEST(NotExecuted, LanguagesOfOneReasonStandTogether) {
    EXPECT_EQ(format_not_executed(
                  {{"wgsl", "no Node.js"}, {"hlsl", "no Node.js"}, {"dctl", "no OpenCL"}}),
              "written, not executed: wgsl, hlsl (no Node.js); dctl (no OpenCL)\n");
}

}  // namespace
TONEWRIGHT_NAMESPACE_END
