// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>
#include <set>
#include <stdexcept>

#include "base/random.h"
#include "full_counts.h"
#include "tonewright/engine.h"
#include "tonewright/registry.h"
#include "tonewright/view.h"
#include "unit/engine/views.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

const Expr kX = Expr::input(0);
constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

using Planes = std::array<std::vector<double>, 3>;

/// Colors as pictures and accidents have them: log-uniform, saturated, negative, zero of both
/// signs, denormal, huge, not a number.
Planes random_colors(std::size_t count, unsigned long long seed) {
    SampleRandom random(seed);
    Planes planes;
    for (auto& plane : planes) {
        for (std::size_t i = 0; i < count; ++i) {
            double x = std::exp2(random.uniform(-20, 12));
            switch (random.bits() % 16) {
                case 0:
                    x = -x;
                    break;
                case 1:
                    x = 0;
                    break;
                case 2:
                    x = -0.0;
                    break;
                case 3:
                    x = std::exp2(random.uniform(-1074, -1000));
                    break;
                case 4:
                    x = std::exp2(random.uniform(15, 1000));
                    break;
                case 5:
                    x = -kInfinity;
                    break;
                case 6:
                    x = kNan;
                    break;
                default:
                    break;
            }
            plane.push_back(x);
        }
    }
    return planes;
}

Planes run(const ReferenceEngine& engine, const Planes& in) {
    const std::size_t count = in[0].size();
    Planes out = in;
    engine.run({in[0].data(), in[1].data(), in[2].data()},
               {out[0].data(), out[1].data(), out[2].data()}, count);
    return out;
}

TEST(Reference, IsEvaluateBitForBit) {
    const Planes in = random_colors(count_of(300U, 60U), 1);
    for (const OperatorVariant& variant : all_variants()) {
        for (const Pipeline& view : all_views(variant)) {
            const std::array<Expr, 3> f = compose(view);
            const Planes out = run(ReferenceEngine(view), in);
            for (std::size_t i = 0; i < in[0].size(); ++i) {
                // The exposure comes before the limit.
                const Vector3 rgb = {without_nan(in[0][i]), without_nan(in[1][i]),
                                     without_nan(in[2][i])};
                for (std::size_t c = 0; c < 3; ++c) {
                    const double expected = evaluate(f[c], rgb);
                    ASSERT_EQ(std::bit_cast<std::uint64_t>(out[c][i]),
                              std::bit_cast<std::uint64_t>(expected))
                        << variant.name << " " << variant.look << " of (" << rgb[0] << ", "
                        << rgb[1] << ", " << rgb[2] << "): " << out[c][i] << ", expected "
                        << expected;
                }
            }
        }
    }
}

TEST(Reference, RunsEveryOperation) {
    const Expr a = Expr::input(0);
    const Expr b = Expr::input(1);
    const Expr c = Expr::input(2);
    const auto line = std::make_shared<const Table>(Table{{0, 0.5, 3}});
    const auto steps =
        std::make_shared<const Table>(Table{{0, 0.5, 3}, Table::Interpolation::step});
    const auto uneven = std::make_shared<const Table>(
        Table{{0, 0.5, 3, 4}, Table::Interpolation::linear, {-2, 0.125, 0.3, 70000}});
    const std::vector<Expr> all = {a + b,
                                   a - b,
                                   a * b,
                                   a / (b + 100000),
                                   min(a, b),
                                   max(a, b),
                                   pow(abs(a), b / 65504),
                                   atan2(a, b),
                                   less(a, b),
                                   less_equal(a, b),
                                   equal(a, b),
                                   -a,
                                   abs(a),
                                   sqrt(abs(a)),
                                   exp2(a / 65504),
                                   log2(abs(a) + 1),
                                   sin(a),
                                   cos(a),
                                   floor(a),
                                   select(less(a, b), b, c),
                                   lookup(line, a),
                                   lookup(steps, b),
                                   lookup(uneven, a),
                                   Expr(0.1),
                                   c};
    std::set<ExprOp> covered;
    const Planes in = random_colors(500, 2);
    for (const Expr& e : all) {
        covered.insert(e.op());
        const Pipeline pipeline = {CrossTalkStage{{e, a, b}}};
        const Planes out = run(ReferenceEngine(pipeline), in);
        for (std::size_t i = 0; i < in[0].size(); ++i) {
            const Vector3 rgb = {sanitize(in[0][i]), sanitize(in[1][i]), sanitize(in[2][i])};
            ASSERT_EQ(std::bit_cast<std::uint64_t>(out[0][i]),
                      std::bit_cast<std::uint64_t>(evaluate(e, rgb)))
                << to_string(e);
        }
    }
    EXPECT_EQ(covered.size(), static_cast<std::size_t>(ExprOp::lookup) + 1)
        << "an operation without a case here";
}

TEST(Reference, SanitizesItsInput) {
    EXPECT_EQ(sanitize(kNan), 0);
    EXPECT_EQ(sanitize(-kNan), 0);
    EXPECT_EQ(sanitize(kInfinity), 65504);
    EXPECT_EQ(sanitize(-kInfinity), -65504);
    EXPECT_EQ(sanitize(65504.5), 65504);
    EXPECT_EQ(sanitize(-1e300), -65504);
    EXPECT_EQ(sanitize(65503.9), 65503.9);
    EXPECT_EQ(sanitize(5e-324), 5e-324);
    const ReferenceEngine nothing(Pipeline{});
    EXPECT_EQ(nothing({kNan, kInfinity, -kInfinity}), (Vector3{0, 65504, -65504}));
    EXPECT_EQ(nothing({0.25, -2, 1e300}), (Vector3{0.25, -2, 65504}));
    // One bad channel leaves the others alone.
    const ReferenceEngine swapped({MatrixStage{{{{0, 1, 0}, {0, 0, 1}, {1, 0, 0}}}}});
    EXPECT_EQ(swapped({kNan, 0.5, kInfinity}), (Vector3{0.5, 65504, 0}));
}

TEST(Reference, TakesAnyCount) {
    const ReferenceEngine engine(
        build_view(make_view(resolve_operator("agx_sobotka"), "lin_ap1", 0, "srgb")));
    // Around the tile of 256 that it works in.
    for (const std::size_t count : {0U, 1U, 2U, 255U, 256U, 257U, 511U, 512U, 513U, 1000U}) {
        const Planes in = random_colors(count, 3 + count);
        Planes out;
        constexpr double kGuard = -77;
        for (auto& plane : out)
            plane.assign(count + 1, kGuard);
        engine.run({in[0].data(), in[1].data(), in[2].data()},
                   {out[0].data(), out[1].data(), out[2].data()}, count);
        for (std::size_t i = 0; i < count; ++i) {
            ASSERT_EQ(engine({in[0][i], in[1][i], in[2][i]}),
                      (Vector3{out[0][i], out[1][i], out[2][i]}))
                << i << " of " << count;
        }
        for (const auto& plane : out)
            EXPECT_EQ(plane[count], kGuard) << "written past the end";
    }
}

TEST(Reference, WorksInPlace) {
    for (const char* op : {"clamp", "reinhard:luminance", "reinhard_jodie", "agx_minimal"}) {
        const ReferenceEngine engine(
            build_view(make_view(resolve_operator(op), "lin_rec2020", 0, "display_p3")));
        const Planes in = random_colors(1000, 4);
        const Planes expected = run(engine, in);
        Planes planes = in;
        engine.run({planes[0].data(), planes[1].data(), planes[2].data()},
                   {planes[0].data(), planes[1].data(), planes[2].data()}, 1000);
        EXPECT_EQ(planes, expected) << op;
    }
}

TEST(Reference, RunRgbIsInterleaved) {
    const ReferenceEngine engine(
        build_view(make_view(resolve_operator("aces_hill"), "lin_rec709", 0, "srgb")));
    // Around its chunk of 4096.
    for (const std::size_t count : {0U, 1U, 4095U, 4096U, 4097U, 9000U}) {
        const Planes colors = random_colors(count, 5);
        std::vector<float> in;
        Planes rounded;
        for (std::size_t i = 0; i < count; ++i) {
            for (std::size_t c = 0; c < 3; ++c) {
                in.push_back(static_cast<float>(sanitize(colors[c][i])));
                rounded[c].push_back(static_cast<double>(in.back()));
            }
        }
        const Planes expected = run(engine, rounded);
        std::vector<double> out(3 * count + 1, -77);
        engine.run_rgb(in.data(), out.data(), count);
        for (std::size_t i = 0; i < count; ++i) {
            for (std::size_t c = 0; c < 3; ++c)
                ASSERT_EQ(out[3 * i + c], expected[c][i]) << i << " of " << count;
        }
        EXPECT_EQ(out.back(), -77) << "written past the end";
    }
}

TEST(Reference, MovesWithItsTables) {
    ReferenceEngine engine = [] {
        const auto table = std::make_shared<const Table>(Table{{0, 10}});
        return ReferenceEngine({curve_stage(lookup(table, kX))});
    }();
    EXPECT_EQ(engine({0.5, 0.25, 2}), (Vector3{5, 2.5, 10})) << "the tape keeps the table alive";
    ReferenceEngine other(Pipeline{});
    other = std::move(engine);
    EXPECT_EQ(other({0.5, 0.25, 2}), (Vector3{5, 2.5, 10}));
}

/// Bad input reaches an exception, never std::terminate.
TEST(Reference, EnginesThrowWhatAGridThrows) {
    int calls = 0;
    const auto grid = std::make_shared<const Grid>(2, [&]() -> std::vector<double> {
        if (++calls == 1) throw std::runtime_error("no file");
        if (calls == 2) return {1, 2, 3};
        return std::vector<double>(24, 0.25);
    });
    const Pipeline pipeline = {GridStage{kX, grid}};
    EXPECT_THROW(ReferenceEngine{pipeline}, std::runtime_error);
    EXPECT_THROW(SimdEngine{pipeline}, Error) << "three numbers are too few";
    // After a failure the next call tries again.
    EXPECT_EQ(ReferenceEngine(pipeline)({0, 1, 0}), (Vector3{0.25, 0.25, 0.25}));
    EXPECT_EQ((*grid)(0, 0.5, 0.5, 0.5), 0.25);
    EXPECT_EQ(calls, 3);

    const Grid broken(2, [] { return std::vector<double>(); });
    EXPECT_THROW((void)broken(0, 0.5, 0.5, 0.5), Error);
    EXPECT_THROW((void)broken(0.5, 0.5, 0.5), Error);
    EXPECT_THROW((void)broken.gradient(0, 0.5, 0.5, 0.5), Error);
}

/// @returns  sums of products that all have to wait for the sum of their first factors
Pipeline waiting(int count) {
    std::vector<Expr> values;
    for (int i = 0; i < count; ++i)
        values.push_back(sqrt(abs(kX) + i));
    const auto sum = [&](const auto& term) {
        std::vector<Expr> parts;
        for (const Expr& value : values)
            parts.push_back(term(value));
        while (parts.size() > 1) {
            std::vector<Expr> pairs;
            for (std::size_t i = 0; i + 1 < parts.size(); i += 2)
                pairs.push_back(parts[i] + parts[i + 1]);
            if (parts.size() % 2) pairs.push_back(parts.back());
            parts = std::move(pairs);
        }
        return parts[0];
    };
    const Expr total = sum([](const Expr& value) { return value; });
    const Expr shares = sum([&](const Expr& value) { return value / total; });
    return {curve_stage(shares)};
}

TEST(Reference, RunsAsManyValuesAsATileHolds) {
    // A tile of one pixel, of a few and of many.
    for (const int count : {3, 100, 1000, 3000}) {
        const Pipeline pipeline = waiting(count);
        const Expr f = compose(pipeline)[0];
        const Planes in = random_colors(20, 3);
        const Planes out = run(ReferenceEngine(pipeline), in);
        for (std::size_t i = 0; i < in[0].size(); ++i)
            EXPECT_EQ(out[0][i], evaluate(f, sanitize(in[0][i]))) << count << " values";
    }
    try {
        const ReferenceEngine engine(waiting(5000));
        FAIL();
    } catch (const Error& e) {
        EXPECT_EQ(std::string(e.what()).rfind("reference engine: live values are 500", 0), 0U)
            << e.what();
    }
}

}  // namespace
TONEWRIGHT_NAMESPACE_END
