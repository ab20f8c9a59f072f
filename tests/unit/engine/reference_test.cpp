// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numeric>
#include <set>
#include <stdexcept>

#include "base/random.h"
#include "engine/tape.h"
#include "full_counts.h"
#include "measure/error_metric.h"
#include "measure/sample_set.h"
#include "tonewright/engine.h"
#include "tonewright/registry.h"

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

std::vector<Pipeline> all_views(const OperatorVariant& variant) {
    std::vector<Pipeline> views;
    for (const char* input : {"lin_rec709", "lin_ap1"}) {
        for (const char* display : {"native", "linear", "srgb", "rec2020"}) {
            views.push_back(build_view(
                make_view(resolve_operator(variant.name, {}, variant.look), input, 0.3, display)));
        }
    }
    return views;
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
TEST(Reference, EnginesThrowWhatALatticeThrows) {
    int calls = 0;
    const auto lattice = std::make_shared<const Lattice>(2, [&]() -> std::vector<double> {
        if (++calls == 1) throw std::runtime_error("no file");
        if (calls == 2) return {1, 2, 3};
        return std::vector<double>(24, 0.25);
    });
    const Pipeline pipeline = {LatticeStage{kX, lattice}};
    EXPECT_THROW(ReferenceEngine{pipeline}, std::runtime_error);
    EXPECT_THROW(SimdEngine{pipeline}, Error) << "three numbers are too few";
    // After a failure the next call tries again.
    EXPECT_EQ(ReferenceEngine(pipeline)({0, 1, 0}), (Vector3{0.25, 0.25, 0.25}));
    EXPECT_EQ((*lattice)(0, 0.5, 0.5, 0.5), 0.25);
    EXPECT_EQ(calls, 3);

    const Lattice broken(2, [] { return std::vector<double>(); });
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

// ---------------------------------------------------------------------------------------------
// Tape

int operand_count(const TapeInstruction& step) {
    switch (step.op) {
        case ExprOp::constant:
        case ExprOp::input:
            return 0;
        case ExprOp::negate:
        case ExprOp::absolute:
        case ExprOp::square_root:
        case ExprOp::exp2:
        case ExprOp::log2:
        case ExprOp::sine:
        case ExprOp::cosine:
        case ExprOp::floor:
        case ExprOp::lookup:
            return 1;
        case ExprOp::select:
            return 3;
        default:
            return 2;
    }
}

TEST(Tape, HasEveryNodeOnceAndOperandsFirst) {
    for (const OperatorVariant& variant : all_variants()) {
        for (const Pipeline& view : all_views(variant)) {
            const std::array<Expr, 3> f = compose(view);
            const Tape tape(f);
            std::set<const ExprNode*> nodes;
            for (std::uint32_t i = 0; i < tape.code().size(); ++i) {
                const TapeInstruction& step = tape.code()[i];
                EXPECT_TRUE(nodes.insert(step.node).second) << "twice";
                const std::array<std::uint32_t, 3> operands = {step.a, step.b, step.c};
                for (int k = 0; k < operand_count(step); ++k)
                    EXPECT_LT(operands[static_cast<std::size_t>(k)], i);
            }
            EXPECT_EQ(tape.code().size(), node_count(f));
            for (std::size_t c = 0; c < 3; ++c)
                EXPECT_EQ(tape.code()[tape.outputs()[c]].node, f[c].node());
        }
    }
}

/// Straight-line code to give registers to.
struct Program {
    std::vector<std::array<std::int64_t, 4>> operands;
    std::vector<bool> needs_register;
    std::vector<std::uint32_t> pinned;
};

Program random_program(SampleRandom& random, std::size_t size) {
    Program p;
    for (std::size_t i = 0; i < size; ++i) {
        std::array<std::int64_t, 4> operands = {-1, -1, -1, -1};
        const std::size_t count = i == 0 ? 0 : random.bits() % 5;
        for (std::size_t k = 0; k < count; ++k) {
            // Mostly near ones, as in real code; the same one twice at times.
            const std::size_t reach = random.bits() % 8 == 0 ? i : std::min<std::size_t>(i, 6);
            operands[k] = static_cast<std::int64_t>(i - 1 - random.bits() % reach);
        }
        p.operands.push_back(operands);
        p.needs_register.push_back(random.bits() % 5 != 0);  // the others are constants
    }
    for (int k = 0; k < 3; ++k) {
        const auto value = static_cast<std::uint32_t>(random.bits() % size);
        if (p.needs_register[value]) p.pinned.push_back(value);
    }
    return p;
}

/// Executes the allocation: each register holds the number of the value last written to it.
/// Returns how many values are live at once at most, an instruction's dying operands not counted.
std::size_t simulate(const Program& p, const RegisterAllocation& a) {
    const std::size_t n = p.operands.size();
    std::vector<std::size_t> last_use(n);
    for (std::size_t i = 0; i < n; ++i) {
        last_use[i] = i;
        for (const std::int64_t v : p.operands[i]) {
            if (v >= 0) last_use[static_cast<std::size_t>(v)] = i;
        }
    }
    for (const std::uint32_t v : p.pinned)
        last_use[v] = n;

    constexpr std::size_t kEmpty = static_cast<std::size_t>(-1);
    std::vector<std::size_t> holds(a.register_count, kEmpty);
    std::size_t most = 0;
    for (std::size_t i = 0; i < n; ++i) {
        for (const std::int64_t operand : p.operands[i]) {
            if (operand < 0) continue;
            const auto v = static_cast<std::size_t>(operand);
            if (!p.needs_register[v]) continue;
            EXPECT_EQ(holds[a.register_of[v]], v) << "value " << v << " is gone before its use";
        }
        if (p.needs_register[i]) {
            EXPECT_LT(a.register_of[i], a.register_count);
            if (a.register_of[i] < a.register_count) holds[a.register_of[i]] = i;
        }
        std::size_t live = 0;
        for (std::size_t v = 0; v <= i; ++v) {
            if (p.needs_register[v] && (last_use[v] > i || v == i)) ++live;
        }
        most = std::max(most, live);
    }
    for (const std::uint32_t v : p.pinned)
        EXPECT_EQ(holds[a.register_of[v]], v) << "output " << v << " is gone at the end";
    return most;
}

TEST(Registers, OverlappingLifetimesNeverShare) {
    SampleRandom random(11);
    for (int round = 0; round < 300; ++round) {
        const Program p = random_program(random, 2 + random.bits() % 80);
        const RegisterAllocation a = allocate_registers(p.operands, p.needs_register, p.pinned);
        const std::size_t most = simulate(p, a);
        // In straight-line code first-come allocation needs no more than are live at once.
        EXPECT_EQ(a.register_count, most) << "round " << round;
        if (::testing::Test::HasFailure()) return;
    }
}

TEST(Registers, TapesOfOperatorsFit) {
    for (const OperatorVariant& variant : all_variants()) {
        for (const Pipeline& view : all_views(variant)) {
            const Tape tape(compose(view));
            Program p;
            for (const TapeInstruction& step : tape.code()) {
                std::array<std::int64_t, 4> operands = {-1, -1, -1, -1};
                const std::array<std::uint32_t, 3> abc = {step.a, step.b, step.c};
                for (std::size_t k = 0; k < static_cast<std::size_t>(operand_count(step)); ++k)
                    operands[k] = abc[k];
                p.operands.push_back(operands);
                p.needs_register.push_back(step.op != ExprOp::constant);
            }
            p.pinned.assign(tape.outputs().begin(), tape.outputs().end());
            const RegisterAllocation a = allocate_registers(p.operands, p.needs_register, p.pinned);
            EXPECT_EQ(a.register_count, simulate(p, a)) << variant.name << " " << variant.look;
        }
    }
}

TEST(Registers, SmallCases) {
    // Three inputs, one sum of two of them, all three values pinned at once.
    const Program p = {
        {{-1, -1, -1, -1}, {-1, -1, -1, -1}, {0, 1, -1, -1}}, {true, true, true}, {0, 1, 2}};
    EXPECT_EQ(allocate_registers(p.operands, p.needs_register, p.pinned).register_count, 3U);
    // The result takes the place of an operand that dies; an operand read twice dies once.
    const RegisterAllocation square = allocate_registers(
        {{-1, -1, -1, -1}, {0, 0, -1, -1}, {1, 1, -1, -1}}, {true, true, true}, {2});
    EXPECT_EQ(square.register_count, 1U);
    // Constants take none.
    EXPECT_EQ(allocate_registers({{-1, -1, -1, -1}}, {false}, {}).register_count, 0U);
}

// ---------------------------------------------------------------------------------------------
// Probes

std::size_t count_of(const SampleSet& set, SampleKind kind) {
    return static_cast<std::size_t>(std::count(set.kind.begin(), set.kind.end(), kind));
}

/// Bit patterns, so that NaN equals NaN.
std::vector<std::uint32_t> bits_of(const std::vector<float>& values) {
    std::vector<std::uint32_t> bits;
    for (const float x : values)
        bits.push_back(std::bit_cast<std::uint32_t>(x));
    return bits;
}

TEST(Probes, AreTheSameOnEveryCall) {
    const InputSpace& input = find_input_space("lin_ap1");
    const SampleSet a = make_sample_set(input, {5, 3000});
    const SampleSet b = make_sample_set(input, {5, 3000});
    EXPECT_EQ(bits_of(a.rgb), bits_of(b.rgb));
    EXPECT_EQ(a.kind, b.kind);
}

TEST(Probes, CountsAreAsAsked) {
    const SampleSet set = make_sample_set(find_input_space("lin_rec709"), {7, 2000});
    EXPECT_EQ(set.rgb.size(), 3 * set.size());
    EXPECT_EQ(count_of(set, SampleKind::lattice), 3U * 5 * 7 * 7 * 7) << "3 gamuts, 5 exposures";
    EXPECT_EQ(count_of(set, SampleKind::random), 2000U);
    EXPECT_EQ(count_of(set, SampleKind::picture), 0U);
    for (const SampleKind kind :
         {SampleKind::gray, SampleKind::near_black, SampleKind::negative, SampleKind::special}) {
        EXPECT_GT(count_of(set, kind), 20U) << static_cast<int>(kind);
    }
    const SampleSet standard = make_sample_set(find_input_space("lin_rec709"));
    EXPECT_EQ(count_of(standard, SampleKind::lattice), 3U * 5 * 33 * 33 * 33);
    EXPECT_EQ(count_of(standard, SampleKind::random), 100000U);
}

TEST(Probes, KindsAreWhatTheyAreCalled) {
    const SampleSet set = make_sample_set(find_input_space("lin_rec2020"), {9, 20000});
    double gray_lo = 1;
    double gray_hi = 0;
    double random_lo = 1;
    double random_hi = 0;
    double smallest = 1;
    std::size_t with_zero = 0;
    bool has_black = false;
    bool has_mixed_thousands = false;
    std::array<std::size_t, 4> negatives{};
    bool has_nan = false;
    bool has_infinity = false;
    bool has_largest = false;
    for (std::size_t i = 0; i < set.size(); ++i) {
        const float* rgb = &set.rgb[3 * i];
        const auto [lo, hi] = std::minmax({rgb[0], rgb[1], rgb[2]});
        const auto below = std::count_if(rgb, rgb + 3, [](float x) { return x < 0; });
        switch (set.kind[i]) {
            case SampleKind::gray:
                ASSERT_EQ(lo, hi);
                has_black = has_black || hi == 0;
                if (hi > 0) gray_lo = std::min(gray_lo, static_cast<double>(lo));
                gray_hi = std::max(gray_hi, static_cast<double>(hi));
                break;
            case SampleKind::random:
                ASSERT_TRUE(set.is_non_negative(i));
                with_zero += lo == 0 ? 1 : 0;
                for (std::size_t c = 0; c < 3; ++c) {
                    if (rgb[c] > 0) random_lo = std::min(random_lo, static_cast<double>(rgb[c]));
                }
                random_hi = std::max(random_hi, static_cast<double>(hi));
                break;
            case SampleKind::near_black:
                ASSERT_TRUE(set.is_non_negative(i));
                ASSERT_LE(hi, 0x1p-10F);
                if (hi > 0) smallest = std::min(smallest, static_cast<double>(lo));
                break;
            case SampleKind::negative:
                ASSERT_FALSE(set.is_non_negative(i));
                ++negatives[static_cast<std::size_t>(below)];
                has_mixed_thousands = has_mixed_thousands || (lo < -1000 && hi > 1000);
                break;
            case SampleKind::special:
                for (std::size_t c = 0; c < 3; ++c) {
                    has_nan = has_nan || std::isnan(rgb[c]);
                    has_infinity = has_infinity || std::isinf(rgb[c]);
                    has_largest = has_largest || rgb[c] == std::numeric_limits<float>::max();
                }
                break;
            default:
                break;
        }
    }
    // Float rounding of 0.18 * 2^+-12.
    EXPECT_NEAR(gray_lo / (0.18 / 4096), 1, 1e-7);
    EXPECT_NEAR(gray_hi / (0.18 * 4096), 1, 1e-7);
    EXPECT_TRUE(has_black);
    // 60000 draws over 28 stops: the extreme ones are within 0.01 stops of the ends, all but
    // surely.
    EXPECT_NEAR(std::log2(random_lo), -16, 0.01);
    EXPECT_NEAR(std::log2(random_hi), 12, 0.01);
    EXPECT_EQ(with_zero, 2000U) << "a tenth";
    EXPECT_LT(smallest, 1.2e-38) << "down to denormals";
    EXPECT_EQ(negatives[0], 0U);
    EXPECT_GT(negatives[1], 1000U);
    EXPECT_GT(negatives[2], 1000U);
    EXPECT_EQ(negatives[3], 0U) << "one or two channels";
    EXPECT_TRUE(has_mixed_thousands);
    EXPECT_TRUE(has_nan && has_infinity && has_largest);
}

TEST(Probes, LatticesReachTheCornersOfTheirGamuts) {
    // In Rec.2020 the red corner of Rec.2020 is (g, 0, 0) at each of five exposures, and that of
    // Rec.709 is g times BT.2087's first column.
    const SampleSet set = make_sample_set(find_input_space("lin_rec2020"), {3, 10});
    for (const double gain : {1.0 / 64, 0.25, 1.0, 8.0, 64.0}) {
        for (const Vector3& corner : {Vector3{1, 0, 0}, {0.6274, 0.0691, 0.0164}}) {
            bool found = false;
            for (std::size_t i = 0; i < set.size(); ++i) {
                if (set.kind[i] != SampleKind::lattice) continue;
                double away = 0;
                for (std::size_t c = 0; c < 3; ++c) {
                    away = std::max(away, std::fabs(static_cast<double>(set.rgb[3 * i + c]) -
                                                    gain * corner[c]));
                }
                found = found || away < 6e-5 * gain;  // BT.2087 prints four decimals
            }
            EXPECT_TRUE(found) << gain << " x " << corner[0];
        }
    }
}

TEST(Probes, NonNegativeMeansFiniteToo) {
    SampleSet set;
    for (const double x : {0.0, -0.0, 1.0, -1e-30, kNan, kInfinity}) {
        set.add(x, 1, 1, SampleKind::picture);
        set.add(1, x, 1, SampleKind::picture);
        set.add(1, 1, x, SampleKind::picture);
    }
    ASSERT_EQ(set.size(), 18U);
    for (std::size_t i = 0; i < 18; ++i)
        EXPECT_EQ(set.is_non_negative(i), i < 9) << i;
}

TEST(Probes, RandomIsSplitMix64) {
    // The published outputs for seed 1234567 (Vigna's splitmix64.c; Rosetta Code).
    SampleRandom random(1234567);
    for (const unsigned long long expected :
         {6457827717110365317ULL, 3203168211198807973ULL, 9817491932198370423ULL,
          4593380528125082431ULL, 16408922859458223821ULL}) {
        EXPECT_EQ(random.bits(), expected);
    }
    double mean = 0;
    for (int i = 0; i < 10000; ++i) {
        const double x = random.uniform(-2, 6);
        ASSERT_GE(x, -2);
        ASSERT_LT(x, 6);
        mean += x / 10000;
    }
    EXPECT_NEAR(mean, 2, 0.1) << "four standard errors of 8/sqrt(12 * 10000) each";
}

// ---------------------------------------------------------------------------------------------
// Error metrics

TEST(Summary, OfKnownErrors) {
    // 0..1000 in a mixed order (10 and 1001 have no common factor): 99.9 % are at most 999.
    std::vector<double> errors;
    for (int i = 0; i < 1001; ++i)
        errors.push_back(i * 10 % 1001);
    const ErrorStats s = summarise(errors);
    EXPECT_EQ(s.count, 1001U);
    EXPECT_EQ(s.max, 1000);
    EXPECT_EQ(s.p999, 999);
    EXPECT_EQ(s.mean, 500);
    EXPECT_EQ(errors[s.worst], 1000);
}

TEST(Summary, OfFewErrors) {
    const ErrorStats none = summarise({});
    EXPECT_EQ(none.count, 0U);
    EXPECT_EQ(none.max, 0);
    EXPECT_EQ(none.mean, 0);
    const std::vector<double> one = {0.25};
    EXPECT_EQ(summarise(one).p999, 0.25);
    EXPECT_EQ(summarise(one).mean, 0.25);
    // One outlier in 2000 is beyond the 99.9 % figure, three are not.
    std::vector<double> errors(2000, 1.0);
    errors[70] = 9;
    EXPECT_EQ(summarise(errors).p999, 1);
    EXPECT_EQ(summarise(errors).worst, 70U);
    errors[71] = errors[72] = 9;
    EXPECT_EQ(summarise(errors).p999, 9);
}

TEST(Summary, NotANumberIsInfinitelyWrong) {
    const std::vector<double> errors = {1, kNan, 2};
    const ErrorStats s = summarise(errors);
    EXPECT_EQ(s.max, kInfinity);
    EXPECT_EQ(s.worst, 1U);
}

TEST(Summary, ChannelErrorTakesTheWorst) {
    const Vector3 truth = {0.5, 0.25, 1};
    const std::array<float, 3> candidate = {0.5F, 0.75F, 0.75F};
    EXPECT_EQ(channel_error(truth.data(), candidate.data()), 0.5);
    for (std::size_t c = 0; c < 3; ++c) {
        std::array<float, 3> broken = {0.5F, 0.25F, 1};
        broken[c] = std::numeric_limits<float>::quiet_NaN();
        const std::array<double, 1> error = {channel_error(truth.data(), broken.data())};
        EXPECT_EQ(summarise(error).max, kInfinity) << "NaN in channel " << c;
        broken[c] = std::numeric_limits<float>::infinity();
        EXPECT_EQ(channel_error(truth.data(), broken.data()), kInfinity);
    }
}

// ---------------------------------------------------------------------------------------------
// dE ITP

/// ICtCp -> display light of BT.2020 primaries in cd/m2, in plain double: the inverse of what is
/// under test (ITU-R BT.2100-2, table 7; SMPTE ST 2084).
Vector3 rec2020_nits_of(const Vector3& ictcp) {
    const Matrix3 to_lms = {{{1688, 2146, 262}, {683, 2951, 462}, {99, 309, 3688}}};
    const Matrix3 to_ictcp = {{{2048, 2048, 0}, {6610, -13613, 7003}, {17933, -17390, -543}}};
    Vector3 lms = multiply(inverse(scale(to_ictcp, 1.0 / 4096)), ictcp);
    for (double& v : lms) {
        const double m1 = 2610.0 / 16384;
        const double m2 = 2523.0 / 4096 * 128;
        const double c1 = 3424.0 / 4096;
        const double c2 = 2413.0 / 4096 * 32;
        const double c3 = 2392.0 / 4096 * 32;
        const double p = std::pow(v, 1 / m2);
        v = 10000 * std::pow(std::max(p - c1, 0.0) / (c2 - c3 * p), 1 / m1);
    }
    return multiply(inverse(scale(to_lms, 1.0 / 4096)), lms);
}

TEST(DeltaEItp, AgreesWithPublishedPairs) {
    // Pairs of ICtCp triplets and their difference by ITU-R BT.2124 as the tests of the
    // colour-science package have them (made with another program): dark skin, and 100 % white.
    struct Pair {
        Vector3 a;
        Vector3 b;
        double difference;
    };
    const std::vector<Pair> pairs = {{{0.4885468072, -0.04739350675, 0.07475401302},
                                      {0.4899203231, -0.04567508203, 0.07361341775},
                                      1.426572247},
                                     {{0.7538438727, 0, -6.25e-16},
                                      {0.7538912244, 0.001930922514, -0.0003599955951},
                                      0.7426668055}};
    const Display& display = find_display("rec2020");
    constexpr double kPeak = 10000;
    std::vector<double> a;
    std::vector<double> b;
    for (const Pair& pair : pairs) {
        const Vector3 nits_a = rec2020_nits_of(pair.a);
        const Vector3 nits_b = rec2020_nits_of(pair.b);
        for (std::size_t c = 0; c < 3; ++c) {
            ASSERT_GT(nits_a[c], 0);
            ASSERT_GT(nits_b[c], 0);
            a.push_back(std::pow(nits_a[c] / kPeak, 1 / 2.4));  // BT.1886
            b.push_back(std::pow(nits_b[c] / kPeak, 1 / 2.4));
        }
    }
    const std::vector<double> differences = delta_e_itp(display, a, b, kPeak);
    ASSERT_EQ(differences.size(), pairs.size());
    for (std::size_t i = 0; i < pairs.size(); ++i) {
        // Ten printed digits of coordinates of 0.5, times 720.
        EXPECT_NEAR(differences[i], pairs[i].difference, 720 * 1e-9);
    }
}

TEST(DeltaEItp, OfGraysIsTheDifferenceOfPq) {
    // R = G = B gives L = M = S = Y, so I = PQ(Y) and T = P = 0. SMPTE ST 2084: PQ(100 cd/m2) is
    // 0.508078421517 and PQ(1 cd/m2) 0.149945732100; 1 % of sRGB's light is code 0.099852...
    const double code = 1.055 * std::pow(0.01, 1 / 2.4) - 0.055;
    const std::vector<double> white = {1, 1, 1};
    const std::vector<double> gray = {code, code, code};
    const double expected = 720 * (0.508078421517 - 0.149945732100);
    for (const char* display : {"srgb", "display_p3"}) {
        const auto d = delta_e_itp(find_display(display), white, gray, 100);
        ASSERT_EQ(d.size(), 1U);
        EXPECT_NEAR(d[0], expected, 1e-8) << display << ": twelve digits, times 720";
        EXPECT_EQ(delta_e_itp(find_display(display), gray, white, 100), d) << "symmetric";
        EXPECT_EQ(delta_e_itp(find_display(display), white, white, 100)[0], 0);
    }
    // Ten times the light: PQ(1000) and PQ(10).
    EXPECT_NEAR(delta_e_itp(find_display("srgb"), white, gray, 1000)[0],
                720 * (0.751827096247 - 0.299699092421), 1e-8);
}

TEST(DeltaEItp, IsOfLightNotOfCodes) {
    // The same light on an sRGB and on a BT.2020 display, by ITU-R BT.2087's matrix and the two
    // curves, is the same color: differences to black agree.
    const Vector3 light = {0.5, 0.2, 0.05};
    const Vector3 wide = {0.6274 * 0.5 + 0.3293 * 0.2 + 0.0433 * 0.05,
                          0.0691 * 0.5 + 0.9195 * 0.2 + 0.0114 * 0.05,
                          0.0164 * 0.5 + 0.0880 * 0.2 + 0.8956 * 0.05};
    std::vector<double> srgb;
    std::vector<double> rec2020;
    for (std::size_t c = 0; c < 3; ++c) {
        srgb.push_back(1.055 * std::pow(light[c], 1 / 2.4) - 0.055);
        rec2020.push_back(std::pow(wide[c], 1 / 2.4));
    }
    const std::vector<double> black(3, 0.0);
    // Four printed decimals of light are 3e-4 of the darkest channel; PQ rises by about 0.1 a stop.
    EXPECT_NEAR(delta_e_itp(find_display("srgb"), srgb, black)[0],
                delta_e_itp(find_display("rec2020"), rec2020, black)[0], 720 * 0.1 * 2e-3);
}

}  // namespace
TONEWRIGHT_NAMESPACE_END
