// SPDX-License-Identifier: Apache-2.0
#include "engine/compiled_curve.h"

#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>

#include "engine/simd_kernels.h"
#include "engine/simd_program.h"
#include "tonewright/engine.h"
#include "tonewright/registry.h"
#include "tonewright/view.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

struct Function {
    std::string name;
    std::function<double(double)> f;
    std::array<double, 2> range;
    std::vector<double> kinks;
    double floor;
};

double srgb(double x) { return x <= 0.0031308 ? 12.92 * x : 1.055 * std::pow(x, 1 / 2.4) - 0.055; }

/// Curves as operators have them, and what is hard about them.
std::vector<Function> functions() {
    const auto limited = [](double x) { return std::fmin(std::fmax(x, 0), 1); };
    return {
        {"sRGB, black and white limited",
         [=](double x) { return srgb(limited(x)); },
         {-65504, 65504},
         {0.0031308, 1},
         0x1p-26},
        {"no end of slope at 0",
         [](double x) { return std::pow(x, 1 / 2.4); },
         {0, 1},
         {},
         0x1p-26},
        {"no end of the range",
         [](double x) { return std::fmax(x, 0) / (1 + std::fmax(x, 0)); },
         {-std::numeric_limits<double>::infinity(), std::numeric_limits<double>::infinity()},
         {},
         0x1p-26},
        {"relative to small results",
         [](double x) { return std::pow(x, 1.5); },
         {0, 65536},
         {},
         1e-12},
        {"three kinks in an octave",
         [](double x) {
             return std::fabs(std::fmax(x, 0) - 0.3) + std::fabs(std::fmax(x, 0) - 0.4) +
                    std::fabs(std::fmax(x, 0) - 0.45);
         },
         {-10, 10},
         {0.3, 0.4, 0.45},
         0x1p-26},
        {"a step", [](double x) { return x < 0.7 ? x : x + 1; }, {0, 4}, {0.7}, 0x1p-26},
        {"a step at the last float before a power of two",
         [](double x) { return x < 0.5 - 0x1p-25 ? x : x + 1; },
         {0, 4},
         {0.5 - 0x1p-25},
         0x1p-26},
        {"a pulse",
         [](double x) { return x < 0.3 || x >= 0.31 ? 0.0 : 1.0; },
         {-4, 9},
         {0.3, 0.31},
         0x1p-26},
        {"kinks much nearer than a cell is wide",
         [](double x) { return x < 0.3 || x >= 0.3001 ? std::fmax(x, 0) : 1.0; },
         {-4, 9},
         {0.3, 0.3001},
         0x1p-26},
        {"constant", [](double) { return 0.25; }, {-65504, 65504}, {}, 0x1p-26},
    };
}

constexpr std::array kForms = {CurveForm::segments, CurveForm::rows, CurveForm::rows_unfused};

CurveTolerance tolerance_of(const Function& f, bool is_precise) {
    CurveTolerance tolerance;
    tolerance.half_ulps = is_precise ? 1.5 : 3;
    tolerance.floor.fill(static_cast<float>(f.floor));
    return tolerance;
}

/// Floats of all magnitudes in the range, and those about the kinks.
std::vector<float> places(const Function& f) {
    std::vector<float> x;
    for (std::uint32_t bits = 0; bits < 0x7F800000; bits += 9973) {
        for (const float sign : {1.0F, -1.0F}) {
            const float place = sign * std::bit_cast<float>(bits);
            if (static_cast<double>(place) >= f.range[0] &&
                static_cast<double>(place) <= f.range[1])
                x.push_back(place);
        }
    }
    for (const double kink : f.kinks) {
        auto place = static_cast<float>(kink);
        for (int i = 0; i < 8; ++i)
            place = std::nextafter(place, 0.0F);
        for (int i = 0; i < 16; ++i) {
            x.push_back(place);
            place = std::nextafter(place, 1e9F);
        }
    }
    return x;
}

/// One number after the other.
CurveFunction each(const std::function<double(double)>& f) {
    return [f](std::span<double> x) { std::transform(x.begin(), x.end(), x.begin(), f); };
}

class CompiledCurveForm : public testing::TestWithParam<CurveForm> {};
INSTANTIATE_TEST_SUITE_P(All, CompiledCurveForm, testing::ValuesIn(kForms), [](const auto& form) {
    return form.param == CurveForm::segments ? "Segments"
           : form.param == CurveForm::rows   ? "Rows"
                                             : "RowsUnfused";
});

TEST_P(CompiledCurveForm, IsWithinItsTolerance) {
    for (const Function& f : functions()) {
        const CurveTolerance tolerance = tolerance_of(f, false);
        const auto curve = compile_curve(each(f.f), f.range, f.kinks, tolerance, GetParam());
        ASSERT_TRUE(curve) << f.name;
        double worst = 0;
        for (const float place : places(f)) {
            const auto x = static_cast<double>(place);
            const double error = std::fabs((*curve)(x)-f.f(x)) / tolerance.at(x, f.f(x));
            worst = std::max(worst, error);
            // It was measured at some hundred places of each segment, and these are others.
            ASSERT_LE(error, 1.3) << f.name << " at " << place << ": " << (*curve)(x)
                                  << ", expected " << f.f(x);
        }
        RecordProperty(f.name, std::to_string(worst));
    }
}

TEST_P(CompiledCurveForm, PreciseOnesTakeDoublesToHalfAFloatsError) {
    const auto f = [](double x) { return std::pow(x, 1.5) + 0.01; };
    const CurveTolerance tolerance = tolerance_of({"", f, {0, 64}, {}, 1e-12}, true);
    const auto curve = compile_curve(each(f), {0, 64}, {}, tolerance, GetParam(), true);
    ASSERT_TRUE(curve);
    EXPECT_TRUE(curve->is_precise);
    for (double x = 1e-6; x < 64; x *= 1.00037) {
        EXPECT_LE(std::fabs((*curve)(x)-f(x)), 1.3 * tolerance.at(x, f(x))) << x;
    }
}

TEST_P(CompiledCurveForm, StaysBetweenTheLeastAndTheMostOfTheFunction) {
    const Function f = functions().front();
    const auto curve =
        compile_curve(each(f.f), f.range, f.kinks, tolerance_of(f, false), GetParam());
    ASSERT_TRUE(curve);
    for (std::uint32_t bits = 0; bits < 0x7F800000; bits += 7919) {
        const double y = (*curve)(static_cast<double>(std::bit_cast<float>(bits)));
        EXPECT_GE(y, 0);
        EXPECT_LE(y, 1);
    }
    const double nan = std::numeric_limits<double>::quiet_NaN();
    EXPECT_EQ((*curve)(0.0), 0) << "black";
    EXPECT_EQ((*curve)(nan), 0);
    EXPECT_EQ((*curve)(-std::numeric_limits<double>::infinity()), 0);
    EXPECT_EQ((*curve)(std::numeric_limits<double>::infinity()), 1);
}

TEST_P(CompiledCurveForm, DoesNotPretend) {
    const CurveTolerance tolerance = tolerance_of(functions().front(), false);
    const auto compiled = [&](const std::function<double(double)>& f) {
        return compile_curve(each(f), {-4, 65504}, {}, tolerance, GetParam()).has_value();
    };
    EXPECT_FALSE(compiled([](double x) { return x; })) << "values below 0";
    EXPECT_FALSE(compiled([](double x) { return 1 / std::fmax(x - 1, 0); })) << "a pole";
    EXPECT_FALSE(compiled([](double x) { return std::sin(100 * std::fmax(x, 0)); })) << "waves";
    EXPECT_FALSE(compiled([](double x) { return x < 1000 ? 0 : std::fmod(x, 1); })) << "noise";
}

/// Kernels and operator() have the same arithmetic.
TEST_P(CompiledCurveForm, KernelsComputeWhatItSays) {
    std::vector<const simd::Target*> targets;
    for (const simd::Target& target : simd::targets()) {
        if (target.curve_form == GetParam()) targets.push_back(&target);
    }
    if (targets.empty()) GTEST_SKIP() << "no instruction set of this machine has this form";
    for (const Function& f : functions()) {
        for (const bool is_precise : {false, true}) {
            const auto curve = compile_curve(each(f.f), f.range, f.kinks,
                                             tolerance_of(f, is_precise), GetParam(), is_precise);
            if (!curve) continue;
            simd::Program program;
            program.tile = simd::kMaxTile;
            program.curves.push_back(*curve);
            program.reads_input = {true, false, false};
            simd::Instruction step;
            step.op = simd::ProgramOp::curve;
            step.wide = is_precise;
            step.in[0] = {.offset = 0};
            step.out[0] = {.offset = sizeof(float) * simd::kMaxTile};
            program.instructions.push_back(step);
            program.output = {step.out[0], step.out[0], step.out[0]};
            // Pixels are limited to half floats' numbers before anything else.
            std::vector<float> x;
            for (const float place : places(f)) {
                if (std::fabs(place) <= 65504) x.push_back(place);
            }
            std::vector<float> y(x.size()), rest(x.size());
            for (const simd::Target* target : targets) {
                program.target = target;
                simd::run(program, {x.data(), x.data(), x.data()}, 1,
                          {y.data(), rest.data(), rest.data()}, 1, x.size());
                for (std::size_t i = 0; i < x.size(); ++i) {
                    ASSERT_EQ(y[i], static_cast<float>((*curve)(static_cast<double>(x[i]))))
                        << f.name << " of " << x[i] << " on " << target->name;
                }
            }
        }
    }
}

/// The result of a precise curve up to its lower end is a double: here 0.1, less the float next to
/// it.
TEST_P(CompiledCurveForm, PreciseOnesBeginWithADouble) {
    const auto f = [](double x) { return std::pow(std::fmax(x, 0), 1.5) + 0.1; };
    const CurveTolerance tolerance = tolerance_of({"", f, {-64, 64}, {}, 1e-12}, true);
    const auto curve = compile_curve(each(f), {-64, 64}, {}, tolerance, GetParam(), true);
    ASSERT_TRUE(curve);
    constexpr std::uint32_t kPlane = sizeof(float) * simd::kMaxTile;
    simd::Program program;
    program.tile = simd::kMaxTile;
    program.curves.push_back(*curve);
    program.reads_input = {true, true, false};
    program.input_offset = {0, kPlane, 0};
    simd::Instruction step;
    step.op = simd::ProgramOp::curve;
    step.wide = true;
    step.out[0] = {.offset = 2 * kPlane, .wide = true};
    step.in[0] = {.offset = 0};
    program.instructions.push_back(step);
    step.op = simd::ProgramOp::subtract;
    step.in[0] = step.out[0];
    step.in[1] = {.offset = kPlane};
    step.out[0] = {.offset = 0};
    program.instructions.push_back(step);
    program.output = {step.out[0], step.out[0], step.out[0]};
    const std::vector<float> x = {0.0F, -1.0F, -0.0F, std::nanf("")};
    const std::vector<float> subtracted(x.size(), 0.1F);
    std::vector<float> y(x.size()), others(x.size());
    for (const simd::Target& target : simd::targets()) {
        if (target.curve_form != GetParam()) continue;
        program.target = &target;
        simd::run(program, {x.data(), subtracted.data(), x.data()}, 1,
                  {y.data(), others.data(), others.data()}, 1, x.size());
        for (std::size_t i = 0; i < x.size(); ++i)
            EXPECT_FLOAT_EQ(y[i], -1.4901161e-9F) << x[i] << " on " << target.name;
    }
}

TEST(CompiledCurve, AWholeChannelIsOneInstruction) {
    for (const simd::Target& target : simd::targets()) {
        if (target.curve_form == CurveForm::none) continue;
        const auto compiled = [&](const char* op) {
            const View view = make_view(resolve_operator(op), "lin_rec709", 0, "srgb");
            return simd::compile(build_view(view), kSimdError, target);
        };
        for (const char* op : {"hable", "reinhard", "uchimura"}) {
            const simd::Program program = compiled(op);
            EXPECT_EQ(program.instructions.size(), 3U) << op << " on " << target.name;
        }
        // Inset, curve, outset to the display's primaries, encoding.
        const simd::Program program = compiled("agx_sobotka");
        EXPECT_LE(program.instructions.size(), 8U) << target.name;
    }
}

}  // namespace
TONEWRIGHT_NAMESPACE_END
