// SPDX-License-Identifier: Apache-2.0
#include "shader/float_run.h"

#include <gtest/gtest.h>

#include <cmath>

#include "base/format_number.h"
#include "base/random.h"
#include "shader/float_form.h"
#include "tonewright/error.h"
#include "tonewright/registry.h"
#include "tonewright/shader.h"
#include "unit/shader/hostile_colors.h"
#include "unit/shader/requests.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

/// Every finite color and both infinities give finite numbers, as float computes them.
void expect_finite(const ShaderProgram& program, const std::vector<float>& rgb,
                   const std::string& what) {
    std::vector<float> out(rgb.size());
    FloatRun(program).run_rgb(rgb.data(), out.data(), rgb.size() / 3);
    for (std::size_t i = 0; i < rgb.size(); ++i) {
        if (std::isfinite(out[i])) continue;
        const std::size_t c = i / 3 * 3;
        FAIL() << what << ": (" << rgb[c] << ", " << rgb[c + 1] << ", " << rgb[c + 2] << ") gives "
               << out[i];
    }
}

TEST(Shader, FiniteInFloatForHostileColors) {
    const std::vector<float> rgb = hostile_colors(2000);
    for (const OperatorVariant& variant : all_variants()) {
        for (const char* display : {"linear", "srgb", "rec2100_pq"}) {
            const ShaderRequest request = request_of(variant.name, variant.look, display);
            expect_finite(make_program(build_view(request.view), {}), rgb,
                          variant.name + " " + variant.look + " " + display);
        }
    }
}

// Parameters at the ends of their intervals and between, as constants and as uniforms.
TEST(Shader, FiniteInFloatForAllSettings) {
    const std::vector<float> rgb = hostile_colors(200);
    SampleRandom random(7);
    int count = 0;
    for (const Operator& op : all_operators()) {
        const std::vector<std::string> live = live_parameters(op);
        if (live.empty()) continue;
        for (int round = 0; round < 32; ++round) {
            Settings settings;
            UniformValues values;
            UniformRanges ranges;
            for (const ParameterSpec& spec : op.parameters) {
                if (std::find(live.begin(), live.end(), spec.name) == live.end()) continue;
                const double at = random.uniform(0, 1);
                const double value = at < 0.25   ? spec.min
                                     : at > 0.75 ? spec.max
                                                 : random.uniform(spec.min, spec.max);
                values[spec.name] = value;
                ranges[spec.name] = {spec.min, spec.max};
                settings[spec.name] = shortest(value);
            }
            try {
                (void)resolve(op, nullptr, settings, "");
            } catch (const Error&) {
                continue;  // parameters that contradict each other
            }
            ++count;
            const ResolvedOperator resolved = resolve(op, nullptr, {}, "");
            const View view = make_view(resolved, "lin_rec709", 0, "linear");
            const Pipeline pipeline = build_live_view(view, live);
            std::string what = op.id;
            for (const auto& [name, value] : values)
                what += " " + name + "=" + std::to_string(value);
            ShaderProgram program = make_program(pipeline, ranges);
            for (ScalarFunction& function : program.scalars)
                function.f = bind_uniforms(function.f, values);
            for (ColorFunction& function : program.colors) {
                for (ColorFunction::Call& call : function.calls)
                    call.argument = bind_uniforms(call.argument, values);
                for (Expr& e : function.f)
                    e = bind_uniforms(e, values);
            }
            expect_finite(program, rgb, what + " with uniforms");
            expect_finite(make_program(bind_uniforms(pipeline, values), {}), rgb, what);
        }
    }
    EXPECT_GE(count, 200);
}

}  // namespace
TONEWRIGHT_NAMESPACE_END
