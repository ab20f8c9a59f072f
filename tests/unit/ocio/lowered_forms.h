// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "base/format_number.h"
#include "measure/sample_set.h"
#include "ocio/gpu.h"
#include "ocio/lower.h"
#include "ocio/transforms.h"
#include "tonewright/engine.h"
#include "tonewright/ocio.h"
#include "tonewright/pipeline.h"

/// Stages as OpenColorIO transforms, run by OCIO itself (CPU with the lossless and the default
/// optimizer, GPU if there is one), against the double reference. Bounds are in code values of the
/// display.
TONEWRIGHT_NAMESPACE_BEGIN

inline const Stage kPositive = ClampStage{0, kHalfMax};
inline const Stage kSdr = ClampStage{0, 1};
inline Stage srgb() { return curve_stage(srgb_encode(Expr::input())); }
inline Expr reinhard() { return Expr::input() / (1 + Expr::input()); }

/// One way in which OCIO can run a chain.
struct Form {
    std::string name;
    bool is_gpu = false;
    std::vector<float> out;
};

inline std::vector<Form> run_forms(const OCIO::ConstProcessorRcPtr& processor,
                                   const std::vector<float>& in) {
    std::vector<Form> forms;
    const auto add = [&](const char* name, const auto& runner) {
        Form form{name, std::string(name) == "gpu", std::vector<float>(in.size())};
        runner.run_rgb(in.data(), form.out.data(), in.size() / 3);
        forms.push_back(std::move(form));
    };
    add("cpu lossless", OcioCpu(processor, OCIO::OPTIMIZATION_LOSSLESS));
    add("cpu default", OcioCpu(processor, OCIO::OPTIMIZATION_DEFAULT));
    if (OcioGpu::unavailable_reason().empty()) add("gpu", OcioGpu(processor));
    return forms;
}

inline std::vector<Form> run_forms(const Pipeline& pipeline, const std::vector<float>& in) {
    return run_forms(make_processor(lower_to_ocio(pipeline).ops), in);
}

inline std::vector<double> reference(const Pipeline& pipeline, const std::vector<float>& in) {
    std::vector<double> out(in.size());
    ReferenceEngine(pipeline).run_rgb(in.data(), out.data(), in.size() / 3);
    return out;
}

/// Grays, grids, saturated and dark colors; all channels >= 0 and finite.
inline std::vector<float> positive_colors() {
    const SampleSet set = make_sample_set(find_input_space("lin_rec709"), {9, 20000});
    std::vector<float> rgb;
    for (std::size_t i = 0; i < set.size(); ++i) {
        if (!set.is_non_negative(i)) continue;
        rgb.insert(rgb.end(), {set.rgb[3 * i], set.rgb[3 * i + 1], set.rgb[3 * i + 2]});
    }
    return rgb;
}

/// The same with negative channels.
inline std::vector<float> mixed_colors() {
    const SampleSet set = make_sample_set(find_input_space("lin_rec709"), {9, 20000});
    std::vector<float> rgb;
    for (std::size_t i = 0; i < set.size(); ++i) {
        if (set.kind[i] == SampleKind::special) continue;
        rgb.insert(rgb.end(), {set.rgb[3 * i], set.rgb[3 * i + 1], set.rgb[3 * i + 2]});
    }
    return rgb;
}

/// Saturated colors of six hues and all orders of the channels, grays, black, and both ends.
inline std::vector<float> saturated_colors() {
    std::vector<float> rgb;
    for (const float light :
         {1e-7F, 1e-3F, 0.05F, 0.3F, 0.8F, 1.0F, 3.0F, 50.0F, 4000.0F, 65504.0F}) {
        for (const float low : {0.0F, 1e-6F, 0.01F, 0.5F, 0.999F, 1.0F}) {
            for (const float mid : {low, low + (1 - low) * 0.001F, (1 + low) / 2, 1.0F}) {
                const float v[3] = {light, light * low, light * mid};
                for (const int i : {0, 1, 2}) {
                    for (const int j : {1, 2})
                        rgb.insert(rgb.end(), {v[i], v[(i + j) % 3], v[(i + 2 * j) % 3]});
                }
            }
        }
    }
    rgb.insert(rgb.end(), {0, 0, 0, -0.0F, -0.0F, -0.0F, -1, -2, -3, -1, 0.5F, 2});
    return rgb;
}

/// Every form of the pipeline against the reference.
inline void expect_close(const Pipeline& pipeline, const std::vector<float>& in, double cpu_bound,
                         double gpu_bound) {
    const std::vector<double> truth = reference(pipeline, in);
    for (const Form& form : run_forms(pipeline, in)) {
        const double bound = form.is_gpu ? gpu_bound : cpu_bound;
        double worst = 0;
        std::size_t at = 0;
        for (std::size_t i = 0; i < in.size(); ++i) {
            const double error = std::fabs(static_cast<double>(form.out[i]) - truth[i]);
            if (error <= worst) continue;
            worst = std::isnan(error) ? kInfinity : error;
            at = i;
        }
        const float* rgb = &in[at / 3 * 3];
        EXPECT_LE(worst, bound) << form.name << " of (" << rgb[0] << ", " << rgb[1] << ", "
                                << rgb[2] << "): " << form.out[at] << ", expected "
                                << shortest(truth[at]) << "; " << worst / bound
                                << " times the bound\n"
                                << to_string(pipeline) << lower_to_ocio(pipeline).summary;
        ::testing::Test::RecordProperty(form.name, rounded_up(worst));
    }
}

/// NaN, infinities, the largest float: the same picture as the reference, and always a picture.
inline void expect_sane(const Pipeline& pipeline, double bound) {
    const float nan = std::numeric_limits<float>::quiet_NaN();
    const float inf = std::numeric_limits<float>::infinity();
    const float huge = std::numeric_limits<float>::max();
    std::vector<float> in;
    for (const float odd : {nan, inf, -inf, huge, -huge}) {
        for (const float other : {0.0F, 0.18F, 70000.0F, odd})
            in.insert(in.end(), {odd, 0.18F, other, other, odd, 0.18F, 0.18F, other, odd});
    }
    const std::vector<double> truth = reference(pipeline, in);
    for (const Form& form : run_forms(pipeline, in)) {
        for (std::size_t i = 0; i < in.size(); ++i) {
            const float* rgb = &in[i / 3 * 3];
            ASSERT_TRUE(form.out[i] >= -1e-6F && form.out[i] <= 1 + 1e-6F)
                << form.name << " of " << rgb[0] << ", " << rgb[1] << ", " << rgb[2];
            // The driver decides what NaN becomes in GLSL.
            if (form.is_gpu && std::any_of(rgb, rgb + 3, [](float x) { return std::isnan(x); }))
                continue;
            EXPECT_NEAR(static_cast<double>(form.out[i]), truth[i], bound)
                << form.name << " of " << rgb[0] << ", " << rgb[1] << ", " << rgb[2];
        }
    }
}

enum class Type { matrix, range, lut_1d, lut_3d, fixed, builtin };
using Types = std::vector<Type>;

inline Types types_of(const Lowered& lowered) {
    Types types;
    for (const LoweredOp& op : lowered.ops)
        types.push_back(static_cast<Type>(op.op.index()));
    return types;
}

inline constexpr auto kLut3D = Type::lut_3d;

inline void expect_no_cube(const Pipeline& pipeline) {
    const Lowered lowered = lower_to_ocio(pipeline);
    for (const Type type : types_of(lowered))
        EXPECT_TRUE(type != kLut3D) << lowered.summary;
    EXPECT_TRUE(lowered.is_exact) << lowered.summary;
}

TONEWRIGHT_NAMESPACE_END
