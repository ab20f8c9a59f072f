// SPDX-License-Identifier: Apache-2.0
//
// SimdEngine against ReferenceEngine and the C library, for every instruction set that this machine
// has. Bounds: 2 units in the last place for the elementary functions, 1e-6 of the code value (its
// contract) for whole views.
#include "engine/simd_program.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <ctime>
#include <functional>
#include <limits>
#include <thread>
#include <vector>

#include "base/format_number.h"
#include "base/half_value.h"
#include "base/random.h"
#include "full_counts.h"
#include "measure/sample_set.h"
#include "tonewright/engine.h"
#include "tonewright/registry.h"
#include "tonewright/view.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

constexpr double kBound = 1e-6;

/// "SCALAR" runs some 30 times slower than the others: fewer colors for it.
std::size_t scaled_count(const std::string& target, std::size_t count) {
    return target == "SCALAR" ? count / 20 : count;
}

std::vector<float> run(const SimdEngine& engine, const std::vector<float>& rgb) {
    std::vector<float> out(rgb.size());
    engine.run_rgb(rgb.data(), out.data(), rgb.size() / 3);
    return out;
}

std::vector<double> run(const ReferenceEngine& engine, const std::vector<float>& rgb) {
    std::vector<double> out(rgb.size());
    engine.run_rgb(rgb.data(), out.data(), rgb.size() / 3);
    return out;
}

std::vector<float> gray(const std::vector<float>& values) {
    std::vector<float> rgb;
    for (const float v : values)
        rgb.insert(rgb.end(), 3, v);
    return rgb;
}

Pipeline view_of(const std::string& op, const std::string& display = "srgb") {
    return build_view(make_view(resolve_operator(op), "lin_rec709", 0, display));
}

/// Every operator with its defaults, and with each of its presets.
std::vector<std::string> all_operator_names() {
    std::vector<std::string> names;
    for (const Operator& op : all_operators()) {
        names.push_back(op.id);
        for (const Preset& preset : op.presets)
            names.push_back(op.id + ":" + preset.id);
    }
    return names;
}

// ---------------------------------------------------------------------------------------------
// Elementary functions

/// Distance in units of the last place of the float nearest to `truth`.
double ulps(float value, double truth) {
    // Beyond the largest float: Highway's scalar code turns infinity in double into that float.
    if (std::isinf(static_cast<float>(truth))) {
        const bool same =
            std::fabs(value) >= std::numeric_limits<float>::max() && (value < 0) == (truth < 0);
        return same ? 0 : kInfinity;
    }
    const float nearest = std::fabs(static_cast<float>(truth));
    const float next = std::nextafter(nearest, std::numeric_limits<float>::infinity());
    const double ulp = static_cast<double>(next) - static_cast<double>(nearest);
    return std::fabs(static_cast<double>(value) - truth) / ulp;
}

struct Function {
    std::string name;
    std::function<Expr(const Expr&)> build;
    std::function<double(double)> truth;
    double lo,
        hi;  // the sweep; limited in the expression, too, so that no overflow asks for double
    double bound = 2;
};

const std::vector<Function>& functions() {
    const auto power = [](double y, double lo, double hi, double bound = 2) {
        return Function{"pow " + shortest(y),
                        [y](const Expr& x) { return pow(x, y); },
                        [y](double x) { return std::pow(x, y); },
                        lo,
                        hi,
                        bound};
    };
    static const std::vector<Function> all = {
        {"exp2", [](const Expr& x) { return exp2(x); }, [](double x) { return std::exp2(x); }, -160,
         126},
        {"log2", [](const Expr& x) { return log2(x); }, [](double x) { return std::log2(x); }, 0,
         65504},
        {"log2 near 1", [](const Expr& x) { return log2(x); },
         [](double x) { return std::log2(x); }, 0.7, 1.5},
        {"sqrt", [](const Expr& x) { return sqrt(x); }, [](double x) { return std::sqrt(x); }, 0,
         65504, 0.5},
        {"sin", [](const Expr& x) { return sin(x); }, [](double x) { return std::sin(x); }, -1e4,
         1e4},
        {"cos", [](const Expr& x) { return cos(x); }, [](double x) { return std::cos(x); }, -1e4,
         1e4},
        {"atan2(x, 1)", [](const Expr& x) { return atan2(x, 1); },
         [](double x) { return std::atan2(x, 1); }, -65504, 65504},
        {"atan2(1, x)", [](const Expr& x) { return atan2(1, x); },
         [](double x) { return std::atan2(1, x); }, -65504, 65504},
        {"atan2(-0.3, x)", [](const Expr& x) { return atan2(-0.3F, x); },
         [](double x) { return std::atan2(-0.3F, x); }, -2, 2},
        {"floor", [](const Expr& x) { return floor(x); }, [](double x) { return std::floor(x); },
         -65504, 65504, 0},
        power(1 / 2.4, 0, 65504),
        power(1 / 2.2, 0, 65504),
        power(0.1593017578125, 0, 65504),
        power(2.2, 0, 65504),
        power(2.4, 0, 65504),
        power(2.6, 0, 65504),
        power(3.25, 0, 65504),
        power(-0.7, 1e-30, 65504),
        power(3.9, 0, 65504),
        power(78.84375, 0, 2.9),
        power(2, -65504, 65504),
        power(3, -65504, 65504),
        power(5, -1000, 1000, 4),  // three products
        power(-2, 1e-12, 65504),
        power(0.5, 0, 65504),
        power(11, -300, 300),
        {"1.7^x", [](const Expr& x) { return pow(1.7F, x); },
         [](double x) { return std::pow(static_cast<double>(1.7F), x); }, -160, 160},
        {"x^x", [](const Expr& x) { return pow(x, x); }, [](double x) { return std::pow(x, x); }, 0,
         25},
        {"x^floor(x)", [](const Expr& x) { return pow(x, floor(x)); },
         [](double x) { return std::pow(x, std::floor(x)); }, -20, 20},
    };
    return all;
}

/// Steps of equal size, steps of equal ratio down to the denormals, and the ends.
std::vector<float> sweep(double lo, double hi, std::size_t count) {
    std::vector<float> x;
    const auto n = static_cast<double>(count);
    for (double i = 0; i <= n; ++i)
        x.push_back(static_cast<float>(lo + (hi - lo) * i / n));
    for (double i = 0; i <= n; ++i) {
        const double magnitude = std::exp2(-149 + 165 * i / n);
        for (const double v : {magnitude, -magnitude}) {
            if (v >= lo && v <= hi) x.push_back(static_cast<float>(v));
        }
    }
    return x;
}

/// A curve by the kernels of its operations.
std::vector<float> run_kernels(const Expr& curve, const std::vector<float>& rgb,
                               const std::string& target) {
    const simd::Program program =
        simd::compile({curve_stage(curve)}, kBound, simd::find_target(target), false);
    std::vector<float> out(rgb.size());
    simd::run(program, {rgb.data(), rgb.data() + 1, rgb.data() + 2}, 3,
              {out.data(), out.data() + 1, out.data() + 2}, 3, rgb.size() / 3);
    return out;
}

TEST(Simd, ElementaryFunctionsAreWithinTwoUlp) {
    for (const std::string& target : SimdEngine::targets()) {
        for (const Function& f : functions()) {
            const std::vector<float> x = sweep(f.lo, f.hi, scaled_count(target, 300000));
            const Expr argument =
                clamp(Expr::input(), static_cast<float>(f.lo), static_cast<float>(f.hi));
            const std::vector<float> out = run_kernels(f.build(argument), gray(x), target);
            double worst = 0;
            float at = 0;
            for (std::size_t i = 0; i < x.size(); ++i) {
                const double error = ulps(out[3 * i], f.truth(static_cast<double>(x[i])));
                if (std::isnan(error) || error > worst) {
                    worst = error;
                    at = x[i];
                }
            }
            EXPECT_LE(worst, f.bound)
                << f.name << " on " << target << " at " << shortest(static_cast<double>(at));
            RecordProperty(target + " " + f.name, shortest(worst));
        }
    }
}

TEST(Simd, ElementaryFunctionsInDouble) {
    // The fraction of f(x) 2^30: float shows the digits of f from 2^-30 on, and the engine has to
    // compute f in double for it.
    constexpr double kGain = 0x1p30;
    for (const std::string& target : SimdEngine::targets()) {
        for (const Function& f : functions()) {
            if (f.name == "floor") continue;
            // A range in which f is about 1, so that the digits shown are its last ones.
            const double lo = std::max(f.lo, f.name == "1.7^x" || f.name == "exp2" ? -1.0 : 0.3);
            const double hi = std::min(f.hi, f.name.starts_with("pow 78") ? 1.0 : 1.9);
            std::vector<float> x;
            for (int i = 0; i < 2000; ++i)
                x.push_back(static_cast<float>(lo + (hi - lo) * i / 2000));
            const Expr argument =
                clamp(Expr::input(), static_cast<float>(lo), static_cast<float>(hi));
            const Expr y = f.build(argument) * kGain;
            const std::vector<float> out = run_kernels(y - floor(y), gray(x), target);
            double worst = 0;
            for (std::size_t i = 0; i < x.size(); ++i) {
                const double truth = f.truth(static_cast<double>(x[i]));
                const double t = truth * kGain;
                double error = std::fabs(static_cast<double>(out[3 * i]) - (t - std::floor(t)));
                error = std::min(error, 1 - error);  // next to a whole number
                worst = std::max(worst, error / kGain / std::max(1.0, std::fabs(truth)));
            }
            // Polynomials in double are exact to 2^-45 (simd_math-inl.h).
            // Sines have 16 units in the last place of double; float shows the rest to 2^-25.
            const bool is_sine = f.name.starts_with("sin") || f.name.starts_with("cos");
            EXPECT_LE(worst, is_sine ? 16 * 0x1p-53 + 0x1p-25 / kGain : 0x1p-45)
                << f.name << " on " << target;
        }
    }
}

TEST(Simd, PositionsThatAreHalvesAreFoundSoon) {
    // Half of all positions lie within [-1, 1] of [-65504, 65504], as in LUTs over halves.
    Table halves;
    for (int i = -31743; i <= 31743; ++i) {
        halves.positions.push_back(
            std::copysign(half_value(static_cast<unsigned>(std::abs(i))), i));
        halves.samples.push_back(i % 7);  // another cell has another line
    }
    std::vector<float> rgb;
    SampleRandom random(11);
    for (const double x : halves.positions)
        rgb.push_back(static_cast<float>(x));
    while (rgb.size() < 300'000)
        rgb.push_back(
            static_cast<float>(halves.positions[random.bits() % halves.positions.size()] * 1.0002));
    const Pipeline pipeline = {
        curve_stage(lookup(std::make_shared<const Table>(halves), Expr::input()))};
    const std::vector<double> truth = run(ReferenceEngine(pipeline), rgb);
    for (const std::string& target : SimdEngine::targets()) {
        const SimdEngine engine(pipeline, kSimdError, target);
        const std::clock_t start = std::clock();
        const std::vector<float> out = run(engine, rgb);
        // Bisection takes 0.02 s; one position after the other would take 20 s.
        EXPECT_LT(static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC, 3) << target;
        for (std::size_t i = 0; i < out.size(); ++i)
            ASSERT_NEAR(static_cast<double>(out[i]), truth[i], kBound) << target << " " << rgb[i];
    }
}

TEST(Simd, OperationsMeanWhatExpressionsMean) {
    const Expr a = Expr::input(0);
    const Expr b = Expr::input(1);
    const auto table =
        std::make_shared<const Table>(Table{{0.5, -1, 3, 3.25, 7}, Table::Interpolation::linear});
    const auto steps =
        std::make_shared<const Table>(Table{{0.5, -1, 3, 3.25, 7}, Table::Interpolation::step});
    const auto single = std::make_shared<const Table>(Table{{0.25}, Table::Interpolation::linear});
    const std::vector<double> positions = {-1.5, -0.25, 0.5, 0.53125, 2};
    const auto uneven = std::make_shared<const Table>(
        Table{{0.5, -1, 3, 3.25, 7}, Table::Interpolation::linear, positions});
    const auto uneven_steps = std::make_shared<const Table>(
        Table{{0.5, -1, 3, 3.25, 7}, Table::Interpolation::step, positions});
    const auto single_placed =
        std::make_shared<const Table>(Table{{0.25}, Table::Interpolation::linear, {0.5}});
    const std::vector<Expr> expressions = {
        a + b,
        a - b,
        a * b,
        a / (abs(b) + 0.5F),
        min(a, b),
        max(a, b),
        -a,
        abs(a),
        floor(a * 0.1F),
        less(a, b),
        less_equal(a, b),
        equal(a, b),
        select(a, b, 3),
        select(less(a, b), a, b * 0.5F),
        select(less_equal(a, 0.25F), b, 7),
        select(equal(a, b), 1, 2),
        select(less(0, a), a / (abs(b) + 0.5F) / a, 2),
        clamp(a, -1, 2),
        a * 0.5F + b,
        a * b + 1,
        a * b - 1,
        1 - a * b,
        b - a * 0.25F,
        (a + 1) * (a + 1),
        a / 4,
        a / 3,
        less(a, b) * 2 + less_equal(b, a),
        lookup(table, a),
        lookup(steps, b),
        lookup(single, a),
        lookup(uneven, a),
        lookup(uneven_steps, b),
        lookup(uneven, a * 0.7) + lookup(uneven_steps, a),
        lookup(single_placed, a),
        atan2(a, b),
        pow(a, 2),
        pow(a, 3),
        pow(a, 4) + pow(b, 2),
        Expr(0.25F),
        a,
    };
    SampleRandom random(3);
    std::vector<float> rgb;
    for (int i = 0; i < 2000; ++i) {
        const bool whole = i % 3 == 0;  // equal values, zeros of both signs, table nodes
        const auto draw = [&] {
            return whole ? static_cast<float>(std::floor(random.uniform(-4, 5))) * 0.25F
                         : static_cast<float>(random.uniform(-3, 3));
        };
        rgb.insert(rgb.end(), {draw(), i % 7 == 0 ? -0.0F : draw(), 0});
    }
    for (const std::string& target : SimdEngine::targets()) {
        for (const Expr& e : expressions) {
            const Pipeline pipeline = {CrossTalkStage{{e, a, b}}};
            const std::vector<float> out = run(SimdEngine(pipeline, kSimdError, target), rgb);
            const std::vector<double> truth = run(ReferenceEngine(pipeline), rgb);
            for (std::size_t i = 0; i < out.size(); ++i) {
                const double error = std::fabs(static_cast<double>(out[i]) - truth[i]);
                ASSERT_LE(error, kBound * std::max(1.0, std::fabs(truth[i])))
                    << to_string(e) << " on " << target << " of (" << rgb[i / 3 * 3] << ", "
                    << rgb[i / 3 * 3 + 1] << "): " << out[i] << ", expected " << truth[i];
            }
        }
    }
}

/// Positions at all distances, many of them nearer to each other than two floats are, and as many
/// samples as powers of two need filling up or not.
TEST(Simd, UnevenTablesAreExact) {
    SampleRandom random(5);
    for (const std::size_t count : {1U, 2U, 3U, 4U, 5U, 8U, 9U, 31U, 1024U, 1025U}) {
        auto table = std::make_shared<Table>();
        std::vector<float> inputs;
        double position = 0;
        double sample = 0;
        for (std::size_t i = 0; i < count; ++i) {
            position += std::exp2(random.uniform(-20, -1)) / static_cast<double>(count);
            sample += random.uniform(0, 2) / static_cast<double>(count);
            table->positions.push_back(position);
            table->samples.push_back(sample);
            const auto near = static_cast<float>(position);
            inputs.insert(inputs.end(), {near, std::nextafterf(near, 0), std::nextafterf(near, 1)});
        }
        for (int i = 0; i < 500; ++i)
            inputs.push_back(static_cast<float>(random.uniform(-0.1, 1.1)));
        const std::vector<float> rgb = gray(inputs);
        for (const bool linear : {true, false}) {
            auto copy = std::make_shared<Table>(*table);
            if (!linear) copy->interpolation = Table::Interpolation::step;
            // The index as it is, and one that float would round out of its cell.
            for (const Expr& index : {Expr::input(), Expr::input() * 0.7 + 0.1}) {
                if (!linear && index.op() != ExprOp::input) continue;
                const Pipeline pipeline = {curve_stage(lookup(copy, index))};
                const std::vector<double> truth = run(ReferenceEngine(pipeline), rgb);
                for (const std::string& target : SimdEngine::targets()) {
                    const std::vector<float> out =
                        run(SimdEngine(pipeline, kSimdError, target), rgb);
                    for (std::size_t i = 0; i < out.size(); ++i) {
                        ASSERT_NEAR(static_cast<double>(out[i]), truth[i], 3e-7)
                            << count << " samples, " << target << ", " << rgb[i];
                    }
                }
            }
        }
    }
}

/// Differences of positions that a float or a double cannot hold, and parts without a length.
TEST(Simd, UnevenTablesMayBeLongAndShort) {
    const std::vector<std::vector<double>> all = {{-1e308, 0, 1e308},   {-3e38, 1, 3e38},
                                                  {0, 1e-300, 1},       {0, 4e-45, 8e-45},
                                                  {-1e-300, 0, 1e-300}, {0.1, 0.3, 0.9}};
    const std::vector<float> rgb =
        gray({-65504, -1, -1e-38F, -1e-45F, 0, 1e-45F, 3e-45F, 6e-45F, 1e-38F, 0.5F, 1, 65504});
    for (const std::vector<double>& positions : all) {
        const auto table = std::make_shared<const Table>(
            Table{{0, 0.25, 1}, Table::Interpolation::linear, positions});
        for (const Expr& index : {Expr::input(), Expr::input() * 1e34}) {
            const Pipeline pipeline = {curve_stage(lookup(table, index))};
            const std::vector<double> truth = run(ReferenceEngine(pipeline), rgb);
            for (const std::string& target : SimdEngine::targets()) {
                const std::vector<float> out = run(SimdEngine(pipeline, kSimdError, target), rgb);
                for (std::size_t i = 0; i < out.size(); ++i) {
                    // Black is black exactly, though 0.1 is no float.
                    EXPECT_NEAR(static_cast<double>(out[i]), truth[i], truth[i] == 0 ? 0 : 3e-7)
                        << positions.back() << ", " << target << ", " << rgb[i];
                }
            }
        }
    }
}

/// A jump of an even table, in a cell that no probe comes near to.
TEST(Simd, SteepTablesAreIndexedInDouble) {
    auto table = std::make_shared<Table>();
    for (int i = 0; i <= 4096; ++i)
        table->samples.push_back(i < 3001 ? 0.0 : 1.0);
    const Pipeline pipeline = {curve_stage(lookup(table, Expr::input() / 6))};
    std::vector<float> inputs;
    for (float x = 3000.0F / 4096 * 6; x < 3001.0F / 4096 * 6; x = std::nextafterf(x, 7))
        inputs.push_back(x);
    const std::vector<float> rgb = gray(inputs);
    const std::vector<double> truth = run(ReferenceEngine(pipeline), rgb);
    for (const std::string& target : SimdEngine::targets()) {
        const std::vector<float> out = run(SimdEngine(pipeline, kSimdError, target), rgb);
        for (std::size_t i = 0; i < out.size(); ++i)
            ASSERT_NEAR(static_cast<double>(out[i]), truth[i], 1e-7) << target << ", " << rgb[i];
    }
}

TEST(Simd, WhatASteepTableIsIndexedWithIsNoCompiledCurve) {
    const auto table = std::make_shared<const Table>(
        Table{{0, 0, 1, 1}, Table::Interpolation::linear, {0, 1.2345, 1.23451, 3}});
    const auto f = [](const Expr& x) { return pow(max(x, 0) + 0.5, 0.42); };
    const Expr index = (f(Expr::input(0)) + f(Expr::input(1))) / 2;
    const Expr y = lookup(table, index);
    const Pipeline pipeline = {CrossTalkStage{{y, index, y}}};
    std::vector<float> rgb;
    // 1.65134^0.42 = 1.23450...: no probe of the compiler lies in that cell.
    for (float x = 1.1512F; x < 1.1516F; x = std::nextafterf(x, 2))
        rgb.insert(rgb.end(), {x, 1.15134F, 1.0F});
    const std::vector<double> truth = run(ReferenceEngine(pipeline), rgb);
    for (const std::string& target : SimdEngine::targets()) {
        const std::vector<float> out = run(SimdEngine(pipeline, kSimdError, target), rgb);
        for (std::size_t i = 0; i < out.size(); ++i)
            ASSERT_NEAR(static_cast<double>(out[i]), truth[i], kBound) << target << " " << rgb[i];
    }
}

// ---------------------------------------------------------------------------------------------
// Operators

class SimdOperator : public ::testing::TestWithParam<std::string> {};

/// The standard samples, and colors of huge mixed signs: what is left of them after a matrix is
/// the difference of large numbers.
std::vector<float> test_colors() {
    SampleSet set = make_sample_set(find_input_space("lin_rec709"), {7, count_of(20000U, 4000U)});
    SampleRandom random(99);
    set.add(-280, 3000, 0.1, SampleKind::negative);
    for (std::size_t i = 0; i < count_of(40000U, 8000U); ++i) {
        Vector3 v;
        for (double& x : v)
            x = std::exp2(random.uniform(-18, 16.5)) * (random.bits() % 3 == 0 ? -1 : 1);
        set.add(v[0], v[1], v[2], SampleKind::negative);
    }
    return set.rgb;
}

TEST(Simd, GridsAreInterpolatedAsTheReferenceDoes) {
    // Three channels of their own at places whose fractions have every order; one channel read
    // alone; coordinates and results that are double (steep) and float.
    const auto grid = std::make_shared<const Grid>(5, [] {
        SampleRandom random(3);
        std::vector<double> nodes(3 * 125);
        for (double& x : nodes)
            x = random.uniform(0, 1);
        return nodes;
    });
    const Expr x = Expr::input();
    const GridStage stage{(log2(max(x, 0x1p-8)) + 8) / 16, grid};
    std::vector<float> rgb = {0, 0, 0, 1, 1, 1, 256, 256, 256, 1e4F, -1, 7};
    SampleRandom random(4);
    for (int i = 0; i < 3 * 5000; ++i)
        rgb.push_back(static_cast<float>(std::exp2(random.uniform(-9, 9))));
    const std::array<Expr, 3> c = {Expr::input(0), Expr::input(1), Expr::input(2)};
    for (const Pipeline& pipeline :
         {Pipeline{stage}, Pipeline{stage, CrossTalkStage{{c[2], c[2], 0.5}}},
          Pipeline{stage, curve_stage(exp2(x * 12)), curve_stage(x / 4096)},
          Pipeline{stage, CrossTalkStage{{exp2(20 * c[0]) / 0x1p20, c[1], sqrt(c[2])}}}}) {
        const std::vector<double> truth = run(ReferenceEngine(pipeline), rgb);
        for (const std::string& target : SimdEngine::targets()) {
            const std::vector<float> out = run(SimdEngine(pipeline, kSimdError, target), rgb);
            for (std::size_t i = 0; i < out.size(); ++i) {
                ASSERT_NEAR(static_cast<double>(out[i]), truth[i], kBound)
                    << target << " of channel " << i % 3 << " of pixel " << i / 3 << "\n"
                    << to_string(pipeline);
            }
        }
    }
}

/// Without full counts, parity.verify has sRGB on the best one,
/// parity.verify_displays Display P3.
std::vector<std::string> bound_displays() {
    if (takes_full_counts()) return {"srgb", "rec1886", "display_p3"};
    return {"rec1886"};
}

TEST_P(SimdOperator, IsWithinBoundOfReference) {
    const double bound = resolve_operator(GetParam()).op->bounds.simd;
    const double goal = resolve_operator(GetParam()).op->bounds.simd_goal;
    const std::vector<float> rgb = test_colors();
    for (const std::string& display : bound_displays()) {
        const Pipeline view = view_of(GetParam(), display);
        const ReferenceEngine decode(find_display(display).decode);
        const std::vector<double> truth = run(ReferenceEngine(view), rgb);
        // Without full counts, presets run on the best target only.
        std::vector<SimdEngine> engines;
        if (takes_full_counts() || GetParam().find(':') == std::string::npos) {
            engines = SimdEngine::of_all_targets(view, goal);
        } else {
            engines.emplace_back(view, goal);
        }
        for (std::size_t t = 0; t < engines.size(); ++t) {
            const std::string target = SimdEngine::targets()[t];
            // Every n-th color, so that there are some of each kind.
            const std::size_t step = rgb.size() / scaled_count(target, rgb.size());
            std::vector<float> in;
            std::vector<double> expected;
            for (std::size_t i = 0; i + 3 <= rgb.size(); i += 3 * step) {
                in.insert(in.end(), &rgb[i], &rgb[i] + 3);
                expected.insert(expected.end(), &truth[i], &truth[i] + 3);
            }
            const std::vector<float> out = run(engines[t], in);
            double worst = 0;
            std::size_t at = 0;
            for (std::size_t i = 0; i < out.size(); ++i) {
                const auto code = static_cast<double>(out[i]);
                const double truth_code = expected[i];
                if (std::fabs(code - truth_code) <= worst) continue;
                // Near black a pure power has no end of slope: light counts, as code of sRGB.
                const double light = std::fabs(decode({code, code, code})[0] -
                                               decode({truth_code, truth_code, truth_code})[0]);
                const double error = std::min(std::fabs(code - truth_code), 12.92 * light);
                if (std::isnan(code) || error > worst) {
                    worst = std::isnan(code) ? kInfinity : error;
                    at = i;
                }
            }
            const float* color = in.data() + at / 3 * 3;
            EXPECT_LE(worst, bound)
                << display << " on " << target << " of (" << color[0] << ", " << color[1] << ", "
                << color[2] << "): " << out[at] << ", expected " << expected[at] << "; "
                << worst / bound << " times the bound";
            RecordProperty(display + " " + target, shortest(worst));
        }
    }
}

TEST_P(SimdOperator, IsTotal) {
    const double goal = resolve_operator(GetParam()).op->bounds.simd_goal;
    // Law.SimdIsTotalAndWithinItsBound has sRGB on the best target.
    const std::vector<std::string> displays = takes_full_counts()
                                                  ? std::vector<std::string>{"srgb", "linear"}
                                                  : std::vector<std::string>{"linear"};
    for (const std::string& display : displays) {
        const std::vector<SimdEngine> engines =
            SimdEngine::of_all_targets(view_of(GetParam(), display), goal);
        for (std::size_t t = 0; t < engines.size(); ++t) {
            const std::string target = SimdEngine::targets()[t];
            SampleRandom random(17);
            std::vector<float> rgb(3 * scaled_count(target, count_of(1000000U, 100000U)));
            for (float& x : rgb)
                x = std::bit_cast<float>(static_cast<std::uint32_t>(random.bits() >> 32));
            const std::vector<float> out = run(engines[t], rgb);
            for (std::size_t i = 0; i < out.size(); ++i) {
                ASSERT_TRUE(std::isfinite(out[i]))
                    << out[i] << " on " << target << " of (" << rgb[i / 3 * 3] << ", "
                    << rgb[i / 3 * 3 + 1] << ", " << rgb[i / 3 * 3 + 2] << ")";
            }
        }
    }
}

/// One program for all exposures. Its own error may be as large as that of a program for one.
TEST_P(SimdOperator, IsWithinBoundAtEachExposure) {
    const ResolvedOperator op = resolve_operator(GetParam());
    const std::string exposure(kExposureUniform);
    View view = make_view(op, "lin_rec709", 0, "srgb");
    const std::vector<float> rgb = test_colors();
    const SimdEngine live(build_live_view(view, {exposure}), {{exposure, {0, -16, 16}}},
                          op.op->bounds.simd_goal);
    for (const double stops : {-15.9, -3.3, 0.7, 16.0}) {
        std::vector<float> in;  // what this exposure makes test colors of
        for (std::size_t i = 0; i + 3 <= rgb.size(); i += 3 * count_of<std::size_t>(1, 10)) {
            for (std::size_t c = 0; c < 3; ++c)
                in.push_back(std::ldexp(rgb[i + c], -static_cast<int>(stops)));
        }
        view.exposure_stops = stops;
        const std::vector<double> truth = run(ReferenceEngine(build_view(view)), in);
        const std::vector<float> out = run(live.with_uniforms({{exposure, stops}}), in);
        for (std::size_t i = 0; i < out.size(); ++i) {
            ASSERT_NEAR(out[i], truth[i], op.op->bounds.simd)
                << stops << " stops, (" << in[i / 3 * 3] << ", " << in[i / 3 * 3 + 1] << ", "
                << in[i / 3 * 3 + 2] << ")";
        }
    }
}

INSTANTIATE_TEST_SUITE_P(Operators, SimdOperator, ::testing::ValuesIn(all_operator_names()),
                         [](const auto& test) {
                             std::string name = test.param;
                             // Two, because hable:gdc and hable_gdc are two.
                             if (const std::size_t colon = name.find(':'); colon < name.size())
                                 name.replace(colon, 1, "__");
                             return name;
                         });

TEST(Simd, CurvesOfFilesAreWithinBound) {
    const std::string data = TONEWRIGHT_TEST_DATA "/";
    const std::vector<float> rgb = test_colors();
    for (const Settings& settings : std::vector<Settings>{
             {{"file", data + "synthetic_response.rf"}, {"iso", "0.5"}},
             {{"file", data + "synthetic_response_uneven.csv"}},
             {{"file", data + "synthetic_dorf.txt"}, {"curve", "Synthetic-1"}, {"iso", "1000"}}}) {
        const ResolvedOperator op = resolve_operator("camera_response", settings);
        for (const std::string display : {"srgb", "rec1886", "display_p3"}) {
            const Pipeline view = build_view(make_view(op, "lin_ap1", 0.3, display));
            const std::vector<float> out = run(SimdEngine(view), rgb);
            const std::vector<double> truth = run(ReferenceEngine(view), rgb);
            for (std::size_t i = 0; i < out.size(); ++i) {
                ASSERT_NEAR(static_cast<double>(out[i]), truth[i], kBound)
                    << op.label << ", " << display << ", pixel " << i / 3;
            }
        }
    }
}

TEST(Simd, MatrixOfMixedSignsBeforeAPowerDisplay) {
    // The slope of a power display has no bound at black: whatever the float rounding of the
    // difference is, some color makes it visible. Such a matrix has to run in double. (With
    // colors of thousands the reference's own rounding shows.)
    const Matrix3 m = {{{1.6, -0.53, -0.07}, {-0.1, 1.1, 0.0}, {-0.003, -0.07, 1.073}}};
    const Pipeline view = {MatrixStage{m}, ClampStage{0, 1},
                           curve_stage(pow(Expr::input(), 1 / 2.4))};
    SampleRandom random(5);
    std::vector<float> rgb;
    for (int i = 0; i < 20000; ++i) {
        const double r = random.uniform(0, 1);
        const double g = random.uniform(0, 1);
        const double b = (1.6 * r - 0.53 * g) / 0.07;  // red comes out as the rounding of b
        rgb.insert(rgb.end(),
                   {static_cast<float>(r), static_cast<float>(g), static_cast<float>(b)});
    }
    const std::vector<double> truth = run(ReferenceEngine(view), rgb);
    for (const std::string& target : SimdEngine::targets()) {
        const std::vector<float> out = run(SimdEngine(view, kSimdError, target), rgb);
        for (std::size_t i = 0; i < out.size(); ++i) {
            ASSERT_NEAR(static_cast<double>(out[i]), truth[i], kBound)
                << target << " pixel " << i / 3;
        }
    }
}

// ---------------------------------------------------------------------------------------------
// Memory

TEST(Simd, AnyStrideAndCountAndNothingOutsideThePixels) {
    constexpr float kGuard = -123.5F;
    constexpr std::size_t kEdge = 8;  // guard floats around
    constexpr float kInfinity = std::numeric_limits<float>::infinity();
    SampleRandom random(23);
    const auto check = [&](const std::string& target, const SimdEngine& engine) {
        for (const std::size_t count :
             {0, 1, 2, 3, 15, 16, 17, 31, 255, 256, 257, 511, 513, 1000}) {
            // Each pixel alone: what the whole has to equal, bit for bit.
            std::vector<float> pixels(3 * count);
            for (float& x : pixels)
                x = static_cast<float>(random.uniform(-0.5, 4));
            for (std::size_t i = 0; i + 4 < pixels.size(); i += 29) {
                pixels[i] = std::numeric_limits<float>::quiet_NaN();
                pixels[i + 2] = kInfinity;
                pixels[i + 4] = -kInfinity;
            }
            std::vector<float> expected(3 * count);
            for (std::size_t i = 0; i < count; ++i) {
                engine.run_rgb(&pixels[3 * i], &expected[3 * i], 1);
            }
            // Layouts as {stride, distance of the planes}; 0: one plane after the other.
            struct Layout {
                std::size_t stride;
                std::size_t plane;
            };
            const auto place = [&](const Layout& l, std::size_t i, std::size_t c) {
                return kEdge + i * l.stride + c * (l.plane ? l.plane : count * l.stride + 1);
            };
            const std::vector<Layout> layouts = {{1, 0}, {3, 1}, {4, 1}, {5, 1}, {2, 0}, {7, 2}};
            for (const Layout& from : layouts) {
                for (const Layout& to : layouts) {
                    const bool in_place = from.stride == to.stride && from.plane == to.plane;
                    const std::size_t size = 2 * kEdge + 3 * (7 * count + 8);
                    std::vector<float> source(size, kGuard);
                    for (std::size_t i = 0; i < count; ++i) {
                        for (std::size_t c = 0; c < 3; ++c)
                            source[place(from, i, c)] = pixels[3 * i + c];
                    }
                    std::vector<float> other(size, kGuard);
                    std::vector<float>& result = in_place ? source : other;
                    const auto at = [&](std::vector<float>& v, const Layout& l, std::size_t c) {
                        return v.data() + place(l, 0, c);
                    };
                    engine.run({at(source, from, 0), at(source, from, 1), at(source, from, 2)},
                               static_cast<std::ptrdiff_t>(from.stride),
                               {at(result, to, 0), at(result, to, 1), at(result, to, 2)},
                               static_cast<std::ptrdiff_t>(to.stride), count);
                    std::vector<float> wanted(size, kGuard);
                    for (std::size_t i = 0; i < count; ++i) {
                        for (std::size_t c = 0; c < 3; ++c)
                            wanted[place(to, i, c)] = expected[3 * i + c];
                    }
                    ASSERT_EQ(result, wanted) << target << ", " << count << " pixels, stride "
                                              << from.stride << " to " << to.stride;
                }
            }
        }
    };
    for (const std::string& target : SimdEngine::targets()) {
        check(target, SimdEngine(view_of("aces_hill"), kSimdError, target));
        check(target, SimdEngine(view_of("uchimura"), kSimdError, target));  // each channel alone
    }
}

TEST(Simd, PlanesMayChangePlaces) {
    for (const std::string& target : SimdEngine::targets()) {
        const SimdEngine engine(view_of("hable"), kSimdError, target);  // each channel alone
        const std::vector<float> rgb = {0.1F, 0.2F, 0.4F, 0.8F, 1.6F, 3.2F};
        const std::vector<float> expected = run(engine, rgb);
        std::vector<float> x = {0.1F, 0.8F}, y = {0.2F, 1.6F}, z = {0.4F, 3.2F};
        engine.run({x.data(), y.data(), z.data()}, 1, {y.data(), z.data(), x.data()}, 1, 2);
        EXPECT_EQ(y, (std::vector<float>{expected[0], expected[3]})) << target;
        EXPECT_EQ(z, (std::vector<float>{expected[1], expected[4]})) << target;
        EXPECT_EQ(x, (std::vector<float>{expected[2], expected[5]})) << target;
    }
}

TEST(Simd, PixelsMayEndWithTheBuffer) {
    // Exactly as many floats as there are; an address sanitizer sees any access beyond.
    for (const std::string& target : SimdEngine::targets()) {
        const SimdEngine engine(view_of("hable"), kSimdError, target);
        for (const std::size_t count : {1, 16, 64, 257}) {
            for (const std::size_t stride : {3, 4}) {
                std::vector<float> in((count - 1) * stride + 3, 0.18F);
                std::vector<float> out(in.size());
                const auto s = static_cast<std::ptrdiff_t>(stride);
                engine.run({in.data(), in.data() + 1, in.data() + 2}, s,
                           {out.data(), out.data() + 1, out.data() + 2}, s, count);
                EXPECT_EQ(out.back(), out[2]);
            }
        }
    }
}

TEST(Simd, EnginesOfAllTargetsAreTheOnesMadeOneByOne) {
    const std::vector<float> rgb = test_colors();
    for (const char* op : {"agx_sobotka", "hable", "aces_13"}) {
        const std::vector<SimdEngine> engines = SimdEngine::of_all_targets(view_of(op), 1e-6);
        const std::vector<std::string> targets = SimdEngine::targets();
        ASSERT_EQ(engines.size(), targets.size());
        for (std::size_t t = 0; t < targets.size(); ++t) {
            EXPECT_EQ(run(engines[t], rgb), run(SimdEngine(view_of(op), 1e-6, targets[t]), rgb))
                << op << " on " << targets[t];
        }
    }
}

/// A uniform in every place where an instruction may have it, and what uniforms alone decide on.
TEST(Simd, UniformsMeanWhatTheirValuesMean) {
    const Expr u = Expr::uniform("u");
    const Expr v = Expr::uniform("v");
    const Expr r = Expr::input(0);
    const Expr g = Expr::input(1);
    const Expr b = Expr::input(2);
    const std::vector<std::array<Expr, 3>> programs = {
        {{r * u, g / v, u / (abs(b) + 1)}},
        {{r + g * u, u - b * r, r * g - v}},
        {{u, log2(v) + u, exp2(u * 0.25) * sin(v)}},
        {{pow(abs(r), u), pow(v, r * 0.01), min(max(g, u), v)}},
        {{select(less(u, v), r, g), select(less(r, u), g, v), select(equal(u, u), v, r)}},
        {{r * 0.3 + g * 0.6 + b * u, sqrt(u * u) * r, floor(u) + less(g, v)}},
        {{cos(u) * r, atan2(g, u), abs(-u) * b}},
    };
    const LiveUniforms ranges = {{"u", {1, -4, 4}}, {"v", {2, 0.5, 8}}};
    SampleRandom random(5);
    std::vector<float> rgb(3 * 500);
    for (float& x : rgb)
        x = static_cast<float>(random.uniform(-3, 12));
    for (const std::string& target : SimdEngine::targets()) {
        for (const double max_error : {1e-6, 1e-12}) {  // the second computes in double
            for (std::size_t i = 0; i < programs.size(); ++i) {
                const SimdEngine engine({CrossTalkStage{.f = programs[i]}}, ranges, max_error,
                                        target);
                // All at a time: none changes what another one has.
                const std::vector<UniformValues> all = {
                    {{"u", 2.3}, {"v", 0.7}}, {{"u", 3.9}, {"v", 7}}, {{"u", 0.1}, {"v", 0.5}}};
                std::vector<SimdEngine> with;
                for (const UniformValues& values : all)
                    with.push_back(engine.with_uniforms(values));
                for (std::size_t k = 0; k < all.size(); ++k) {
                    CrossTalkStage bound{.f = programs[i]};
                    for (Expr& channel : bound.f)
                        channel = bind_uniforms(channel, all[k]);
                    const std::vector<double> truth = run(ReferenceEngine({bound}), rgb);
                    const std::vector<float> out = run(with[k], rgb);
                    for (std::size_t j = 0; j < out.size(); ++j) {
                        // Rounding of the uniform and of operands that cancel: the largest are 100.
                        EXPECT_NEAR(static_cast<double>(out[j]), truth[j],
                                    2e-6 * std::max(10.0, std::fabs(truth[j])))
                            << target << ", program " << i << ", values " << k << ", float " << j;
                    }
                }
            }
        }
    }
}

/// Every operator with statistics: with all of a picture's numbers at the ends of their intervals
/// and at opposite ends, on colors of all magnitudes and on those near the statistics.
TEST(Simd, StatisticsAsUniformsKeepTheBound) {
    std::size_t tested = 0;
    for (const Operator& op : all_operators()) {
        const ResolvedOperator resolved = resolve_operator(op.id);
        const LiveUniforms uniforms = live_statistics(resolved);
        const std::vector<std::string> names = uniform_names(uniforms);
        const bool takes_statistics =
            std::any_of(op.parameters.begin(), op.parameters.end(),
                        [](const ParameterSpec& spec) { return spec.from_picture; });
        ASSERT_EQ(!names.empty(), takes_statistics) << op.id;
        if (names.empty()) continue;
        ++tested;
        const View view = make_view(resolved, "lin_rec709", 0, "srgb");
        const Pipeline pipeline = build_live_view(view, names);
        for (const std::string& target : SimdEngine::targets()) {
            const SimdEngine engine(pipeline, uniforms, op.bounds.simd_goal, target);
            const std::vector<double> levels =
                takes_full_counts()
                    ? std::vector<double>{0, 1e-6, 1e-3, 0.18, 1, 50, 3000, kHalfMax}
                    : std::vector<double>{0, 1e-6, 0.18, kHalfMax};
            for (const double level : levels) {
                for (const double other : {level, 1e-6, kHalfMax}) {
                    UniformValues values;
                    Settings settings;
                    for (std::size_t i = 0; i < names.size(); ++i) {
                        const LiveUniform& range = uniforms.at(names[i]);
                        const double value =
                            std::clamp(i % 2 ? other : level, range.least, range.most);
                        values[names[i]] = value;
                        settings[names[i]] = shortest(value);
                    }
                    SampleRandom random(5);
                    std::vector<float> in;
                    for (std::size_t i = 0; i < scaled_count(target, 4000); ++i) {
                        const double middle = i % 2 ? std::log2(std::max(level, 1e-6)) : -4;
                        const double reach = i % 2 ? 6 : 20;
                        for (int c = 0; c < 3; ++c) {
                            const double x = std::exp2(middle + random.uniform(-reach, reach)) *
                                             (random.uniform(0, 1) < 0.1 ? -1 : 1);
                            in.push_back(static_cast<float>(x));
                        }
                    }
                    const ReferenceEngine reference(build_view(
                        make_view(resolve_operator(op.id, settings, ""), "lin_rec709", 0, "srgb")));
                    const std::vector<double> expected = run(reference, in);
                    const std::vector<float> out = run(engine.with_uniforms(values), in);
                    for (std::size_t i = 0; i < out.size(); ++i) {
                        ASSERT_NEAR(out[i], expected[i], op.bounds.simd)
                            << op.id << " " << target << " at " << level << ", " << other
                            << ", color " << in[i / 3 * 3] << " " << in[i / 3 * 3 + 1] << " "
                            << in[i / 3 * 3 + 2];
                    }
                }
            }
        }
    }
    EXPECT_EQ(tested, 16);
}

TEST(Simd, StatisticsThatAreFixedHaveNoUniforms) {
    const LiveUniforms uniforms = live_statistics(resolve_operator("logarithmic"));
    ASSERT_EQ(uniforms.size(), 1);
    EXPECT_EQ(uniforms.at("maximum").least, 1e-6);
    EXPECT_EQ(uniforms.at("maximum").most, kHalfMax);
    EXPECT_TRUE(live_statistics(resolve_operator("logarithmic", {{"maximum", "4"}}, "")).empty());
    EXPECT_EQ(live_statistics(resolve_operator("drago", {{"maximum", "4"}}, "")).size(), 1);
    const SceneStatistics dark = {0, 0, 0, 1e-9, {}, {}};
    EXPECT_EQ(statistic_values(uniforms, resolve_operator("logarithmic"), dark),
              (UniformValues{{"maximum", 1e-6}}));
}

/// A limit of NaN is NaN. Logarithms and powers without a guard would take it for a large number,
/// and only the limits of finite numbers need no guard.
TEST(Simd, LimitsOfNanAreNoPositiveNumbers) {
    const Expr quotient = max(Expr::input(0) / Expr::input(1), 0.5);
    const Pipeline pipeline = {
        CrossTalkStage{{log2(quotient), pow(quotient, 0.3), pow(quotient, 5.5)}}};
    for (const std::string& target : SimdEngine::targets()) {
        for (const double max_error : {1e-6, 1e-12}) {  // the second computes in double
            const std::vector<float> out =
                run(SimdEngine(pipeline, max_error, target), {0, 0, 0, 3, 1, 0});
            // The result is that of a number below 0 or, without vectors, that of the limit.
            EXPECT_LE(out[0], -1) << target;
            EXPECT_LT(out[1], 1) << target;
            EXPECT_LT(out[2], 1) << target;
            EXPECT_NEAR(out[3], std::log2(3), 1e-6) << target;
        }
    }
}

TEST(Simd, UniformsOutOfTheirRangeAreRefused) {
    const Pipeline twice = {curve_stage(Expr::input() * Expr::uniform("u"))};
    const SimdEngine engine(twice, {{"u", {1, 0, 4}}});
    EXPECT_THROW((void)engine.with_uniforms({{"u", 4.5}}), Error);
    EXPECT_THROW((void)engine.with_uniforms({{"u", -0.1}}), Error);
    EXPECT_THROW((void)engine.with_uniforms({}), Error);
    EXPECT_THROW(SimdEngine{twice}, Error);
    EXPECT_EQ(run(engine, {2, 3, 4}), (std::vector<float>{2, 3, 4})) << "its typical value";
    EXPECT_EQ(run(engine.with_uniforms({{"u", 4}}), {2, 3, 4}), (std::vector<float>{8, 12, 16}));
}

TEST(Simd, EnginesOfTwoTargetsWorkSideBySide) {
    // Neither engine knows of the other: each gives the bits that it gives alone.
    const std::vector<std::string> targets = SimdEngine::targets();
    if (targets.size() < 2) GTEST_SKIP() << "this machine has one instruction set";
    const Pipeline view = view_of("agx_sobotka");
    const std::vector<float> rgb = test_colors();
    std::vector<std::vector<float>> alone;
    for (const std::string& target : targets)
        alone.push_back(run(SimdEngine(view, kSimdError, target), rgb));
    EXPECT_NE(alone.front(), alone.back()) << "the instruction sets round differently";
    EXPECT_EQ(run(SimdEngine(view), rgb), alone.front()) << "the best one is the default";
    std::vector<std::vector<float>> together(targets.size());
    std::vector<std::thread> threads;
    for (std::size_t i = 0; i < targets.size(); ++i) {
        threads.emplace_back(
            [&, i] { together[i] = run(SimdEngine(view, kSimdError, targets[i]), rgb); });
    }
    for (std::thread& t : threads)
        t.join();
    EXPECT_EQ(together, alone);
}

TEST(Simd, ThreadsShareAnEngine) {
    const SimdEngine engine(view_of("agx_sobotka"));
    const std::vector<float> rgb = test_colors();
    const std::vector<float> expected = run(engine, rgb);
    std::vector<std::vector<float>> results(4);
    std::vector<std::thread> threads;
    for (std::vector<float>& result : results) {
        threads.emplace_back([&] {
            for (int i = 0; i < 3; ++i)
                result = run(engine, rgb);
        });
    }
    for (std::thread& t : threads)
        t.join();
    for (const std::vector<float>& result : results)
        EXPECT_EQ(result, expected);
}

TEST(Simd, EmptyPipelineOnlySanitizes) {
    const SimdEngine engine(Pipeline{});
    const float nan = std::numeric_limits<float>::quiet_NaN();
    const float inf = std::numeric_limits<float>::infinity();
    const std::vector<float> in = {nan, inf, -inf, 1e30F, -1e30F, 65505, 1e-45F, -0.0F, 0.25F};
    EXPECT_EQ(run(engine, in),
              (std::vector<float>{0, 65504, -65504, 65504, -65504, 65504, 1e-45F, 0, 0.25F}));
}

TEST(Simd, TargetsAreNamed) {
    const std::vector<std::string> targets = SimdEngine::targets();
    ASSERT_FALSE(targets.empty());
    try {
        const SimdEngine engine(Pipeline{}, kSimdError, "AVX");
        FAIL();
    } catch (const Error& e) {
        EXPECT_EQ(std::string(e.what()).rfind("simd engine: target is AVX; expected ", 0), 0U)
            << e.what();
    }
}

/// The kernels take a number apart into [3/4, 3/2) and a power of two: about 3/2, in double.
TEST(Simd, PowersAboutTheFractionWhereTheExponentChanges) {
    // r - b is the row of a matrix that cancels, which is double; and so is a power whose exponent
    // is no constant.
    const Expr x = 1 * Expr::input(0) + -1 * Expr::input(1);
    const Expr f = pow(x, Expr::input(2));
    for (const std::string& target : SimdEngine::targets()) {
        const SimdEngine engine({CrossTalkStage{{f, f, f}}}, kSimdError, target);
        for (int k = -12; k <= 12; ++k) {
            for (int steps = -3; steps <= 3; ++steps) {
                const auto r = static_cast<float>(std::ldexp(1.5, k));
                const auto b = static_cast<float>(std::ldexp(steps, k - 52));
                const std::array<float, 3> in = {r, b, 0.4F};
                std::array<float, 3> out{};
                engine.run_rgb(in.data(), out.data(), 1);
                const double expected = std::pow(std::ldexp(1.5, k), static_cast<double>(0.4F));
                // The error of a float result; the bug that this found was a factor of 2^0.4.
                EXPECT_NEAR(static_cast<double>(out[0]) / expected, 1, 1e-6)
                    << target << ", 1.5 * 2^" << k << " less " << steps << " last places";
            }
        }
    }
}

}  // namespace
TONEWRIGHT_NAMESPACE_END
