// SPDX-License-Identifier: Apache-2.0
//
// Laws of every operator, preset and look of the registry. A new operator is under these tests
// before it has a test of its own.
#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>
#include <optional>
#include <set>
#include <thread>

#include "base/format_number.h"
#include "base/random.h"
#include "engine/tape.h"
#include "full_counts.h"
#include "measure/laws.h"
#include "measure/sample_set.h"
#include "resolve_any.h"
#include "tonewright/engine.h"
#include "tonewright/registry.h"
#include "tonewright/view.h"

TONEWRIGHT_NAMESPACE_BEGIN

/// For GoogleTest: what failure messages and ctest call a variant.
void PrintTo(const OperatorVariant& v, std::ostream* out);
void PrintTo(const OperatorVariant& v, std::ostream* out) {
    *out << v.name << (v.look.empty() ? "" : " look=" + v.look);
}

namespace {

using Planes = std::array<std::vector<double>, 3>;

ResolvedOperator resolve(const OperatorVariant& v) { return resolve_any(v.name, {}, v.look); }

/// Known defects are as total as others, and what they do to black and white is declared.
std::vector<OperatorVariant> variants_and_defects() {
    std::vector<OperatorVariant> all = all_variants();
    for (const Operator& defect : known_defects())
        all.push_back({defect.id, ""});
    return all;
}

class Law : public ::testing::TestWithParam<OperatorVariant> {
  protected:
    [[nodiscard]] static const Operator& op() { return *resolve(GetParam()).op; }
    [[nodiscard]] static Pipeline view(std::string_view display, double stops = 0,
                                       std::string_view input = "lin_rec709") {
        return build_view(make_view(resolve(GetParam()), input, stops, display));
    }
};

Planes run(const Pipeline& pipeline, Planes planes) {
    const std::array<double*, 3> p = {planes[0].data(), planes[1].data(), planes[2].data()};
    ReferenceEngine(pipeline).run({p[0], p[1], p[2]}, p, planes[0].size());
    return planes;
}

Planes gray(const std::vector<double>& values) { return {values, values, values}; }

/// Log-uniform, every channel for itself: saturated ones are the rule. With `signs`, a third of the
/// channels is negative.
Planes random_colors(std::size_t count, double lowest, double highest, bool signs = false) {
    SampleRandom random(41);
    Planes planes;
    for (std::size_t i = 0; i < count; ++i) {
        for (auto& plane : planes) {
            const double x = std::exp2(random.uniform(lowest, highest));
            plane.push_back(signs && random.bits() % 3 == 0 ? -x : x);
        }
    }
    return planes;
}

std::string color_text(const Planes& p, std::size_t i) {
    return "(" + shortest(p[0][i]) + ", " + shortest(p[1][i]) + ", " + shortest(p[2][i]) + ")";
}

// ---------------------------------------------------------------------------------------------
// Totality

/// Every float that there is, in random order and with repetitions: subnormals, infinities and NaNs
/// come with their share of the bit patterns.
void fill_with_patterns(SampleRandom& random, std::vector<float>& rgb) {
    for (std::size_t i = 0; i + 1 < rgb.size(); i += 2) {
        const unsigned long long bits = random.bits();
        rgb[i] = std::bit_cast<float>(static_cast<std::uint32_t>(bits));
        rgb[i + 1] = std::bit_cast<float>(static_cast<std::uint32_t>(bits >> 32));
    }
}

/// The first color whose output is no picture, or empty.
std::string check_patterns(const SimdEngine& display, const SimdEngine& native,
                           unsigned long long seed, std::size_t float_count) {
    constexpr std::size_t kBlock = 3 * 4096;
    SampleRandom random(seed);
    std::vector<float> in(kBlock);
    std::vector<float> shown(kBlock);
    std::vector<float> own(kBlock);
    for (std::size_t done = 0; done < float_count; done += kBlock) {
        fill_with_patterns(random, in);
        display.run_rgb(in.data(), shown.data(), kBlock / 3);
        native.run_rgb(in.data(), own.data(), kBlock / 3);
        for (std::size_t i = 0; i < kBlock; ++i) {
            // The clamp is before the encoding, whose constants may round 1 up in float.
            const bool is_code = shown[i] >= 0.0F && shown[i] <= 1.0F + 1e-6F;
            if (is_code && std::isfinite(own[i])) continue;
            const float* v = &in[i / 3 * 3];
            return "(" + shortest(static_cast<double>(v[0])) + ", " +
                   shortest(static_cast<double>(v[1])) + ", " +
                   shortest(static_cast<double>(v[2])) + "), channel " + std::to_string(i % 3) +
                   ": sRGB " + shortest(static_cast<double>(shown[i])) + ", native " +
                   shortest(static_cast<double>(own[i]));
        }
    }
    return "";
}

/// The worst error of an engine over samples, against the operator's bound.
void expect_within_bound(const SimdEngine& engine, const std::string& target,
                         const Pipeline& pipeline, double bound) {
    const SampleSet samples = make_sample_set(
        find_input_space("lin_rec709"), {count_of(17, 9), count_of<std::size_t>(20000, 2000)});
    std::vector<double> truth(samples.rgb.size());
    ReferenceEngine(pipeline).run_rgb(samples.rgb.data(), truth.data(), samples.size());
    std::vector<float> out(samples.rgb.size());
    engine.run_rgb(samples.rgb.data(), out.data(), samples.size());
    double worst = 0;
    std::size_t at = 0;
    for (std::size_t i = 0; i < out.size(); ++i) {
        const double error = std::fabs(static_cast<double>(out[i]) - truth[i]);
        if (error <= worst) continue;
        worst = std::isnan(error) ? kInfinity : error;
        at = i;
    }
    const float* rgb = &samples.rgb[at / 3 * 3];
    EXPECT_LE(worst, bound) << target << " of (" << rgb[0] << ", " << rgb[1] << ", " << rgb[2]
                            << "): " << out[at] << ", expected " << shortest(truth[at]) << "; "
                            << worst / bound << " times the bound";
    ::testing::Test::RecordProperty(target, rounded_up(worst));
}

/// Compiling an engine is the larger part of these tests, so both are of one. Random bit patterns,
/// 10^8 an operator with full counts, shared between its presets and looks. parity.verify measures
/// the errors on more displays and samples; builds of core alone have only these.
TEST_P(Law, SimdIsTotalAndWithinItsBound) {
    std::size_t sharers = 0;
    for (const OperatorVariant& v : variants_and_defects())
        sharers += resolve(v).op->id == op().id ? 1 : 0;
    const std::size_t float_count = count_of(100'000'000U, 1'000'000U) / sharers;
    const Pipeline shown = view("srgb");
    const std::vector<std::string> targets = SimdEngine::targets();
    std::vector<SimdEngine> engines;
    if (takes_full_counts()) {
        engines = SimdEngine::of_all_targets(shown, op().bounds.simd_goal);
    } else {
        engines.emplace_back(shown, op().bounds.simd_goal);
    }
    for (std::size_t t = 0; t < engines.size(); ++t)
        expect_within_bound(engines[t], targets[t], shown, op().bounds.simd);
    const SimdEngine& display = engines.front();
    const SimdEngine native(view("native"), op().bounds.simd_goal);
    constexpr std::size_t kThreads = 2;
    std::array<std::string, kThreads> failure;
    std::vector<std::thread> threads;
    for (std::size_t t = 0; t < kThreads; ++t) {
        threads.emplace_back([&, t] {
            failure[t] = check_patterns(display, native, 1000 + t, float_count / kThreads);
        });
    }
    for (std::thread& t : threads)
        t.join();
    for (const std::string& text : failure)
        EXPECT_EQ(text, "");
    RecordProperty("patterns", std::to_string(float_count));
}

TEST_P(Law, ReferenceIsTotal) {
    // Up to a million patterns, as floats and as doubles, through the reference.
    const std::size_t count = count_of(1'000'000U, 60'000U) / 6;
    SampleRandom random(42);
    Planes in;
    for (auto& plane : in) {
        for (std::size_t i = 0; i < count; ++i)
            plane.push_back(std::bit_cast<double>(static_cast<std::uint64_t>(random.bits())));
        for (std::size_t i = 0; i < count; ++i) {
            plane.push_back(static_cast<double>(
                std::bit_cast<float>(static_cast<std::uint32_t>(random.bits() >> 32))));
        }
    }
    for (const char* input : {"lin_rec709", "lin_ap0"}) {
        const Planes native = run(view("native", 0, input), in);
        const Planes shown = run(view("srgb", 0, input), in);
        for (std::size_t i = 0; i < in[0].size(); ++i) {
            for (std::size_t c = 0; c < 3; ++c) {
                ASSERT_TRUE(std::isfinite(native[c][i]))
                    << color_text(in, i) << ": native " << native[c][i];
                ASSERT_TRUE(shown[c][i] >= 0 && shown[c][i] <= 1)
                    << color_text(in, i) << ": sRGB " << shown[c][i];
            }
        }
    }
}

TEST_P(Law, EveryDisplayGetsCodeValues) {
    const Planes in = random_colors(count_of(20000U, 4000U), -20, 16, true);
    for (const Display& display : all_displays()) {
        const Planes out = run(view(display.id, 0, "lin_rec2020"), in);
        for (std::size_t i = 0; i < in[0].size(); ++i) {
            for (std::size_t c = 0; c < 3; ++c) {
                ASSERT_TRUE(out[c][i] >= 0 && out[c][i] <= 1)
                    << display.id << " of " << color_text(in, i) << ": " << out[c][i];
            }
        }
    }
}

TEST_P(Law, ExtremeExposuresAreTotal) {
    const Planes in = random_colors(2000, -24, 16, true);
    for (const double stops : {-64.0, -20.0, 20.0, 64.0}) {
        const Pipeline pipeline = view("srgb", stops);
        const Planes out = run(pipeline, in);
        std::vector<float> rgb;
        for (std::size_t i = 0; i < in[0].size(); ++i) {
            for (std::size_t c = 0; c < 3; ++c) {
                ASSERT_TRUE(out[c][i] >= 0 && out[c][i] <= 1) << color_text(in, i);
                rgb.push_back(static_cast<float>(in[c][i]));
            }
        }
        // Making an engine takes most of the time: without full counts, for the extremes.
        if (std::fabs(stops) < count_of(0, 64)) continue;
        SimdEngine(pipeline, op().bounds.simd_goal).run_rgb(rgb.data(), rgb.data(), rgb.size() / 3);
        for (const float x : rgb)
            ASSERT_TRUE(x >= 0 && x <= 1 + 1e-6F) << stops << " stops: " << x;
    }
}

// ---------------------------------------------------------------------------------------------
// Tone

using Kind = DocumentedDifference::Kind;

Differences declared_differences(const OperatorVariant& v) {
    return declared_differences(resolve(v));
}

TEST_P(Law, ChecksFindWhatIsDeclaredAndNoMore) {
    for (const LawResult& result : check_laws(resolve(GetParam()))) {
        // Showing brighter scenes no brighter is what is wrong with some known defects.
        if (op().is_defect() && result.law == "monotone") continue;
        EXPECT_NE(result.verdict, LawResult::Verdict::breaks) << result.law << ": " << result.text;
    }
    // A peak above white is a declaration as well; lists warn of it with this one.
    const Differences declared = declared_differences(GetParam());
    for (const auto& [kind, value] : measured_differences(resolve(GetParam())))
        EXPECT_TRUE(declared.contains(kind)) << to_string(DocumentedDifference{kind, value, ""});
    for (const DocumentedDifference& d : op().differences) {
        const auto names = [&](const auto& items) {
            return std::any_of(items.begin(), items.end(),
                               [&](const auto& item) { return item.id == d.when; });
        };
        EXPECT_TRUE(d.when.empty() || names(op().presets) || names(op().looks)) << d.when;
    }
}

TEST_P(Law, NothingIsDarkerThanBlack) {
    const Vector3 shown = ReferenceEngine(view("srgb"))({0, 0, 0});
    if (!declared_differences(GetParam()).contains(Kind::black)) {
        for (const double x : shown)
            EXPECT_LT(x, 0.5 / 255) << "code 0 of 8 bits";
    }
    // Whatever an operator does with negatives, below black there is nothing brighter.
    const Vector3 below = ReferenceEngine(view("srgb"))({-1, -1, -1});
    for (std::size_t c = 0; c < 3; ++c)
        EXPECT_LE(below[c], shown[c]);
}

TEST_P(Law, GraysStayGrayWhereTheViewSaysSo) {
    const std::vector<double> ramp = gray_ramp();
    for (const char* display : {"srgb", "display_p3"}) {
        const Pipeline pipeline = view(display);
        const Planes out = run(pipeline, gray(ramp));
        double spread = 0;
        for (std::size_t i = 0; i < ramp.size(); ++i) {
            const auto [lo, hi] = std::minmax({out[0][i], out[1][i], out[2][i]});
            spread = std::max(spread, hi - lo);
        }
        EXPECT_EQ(keeps_grays(pipeline), spread <= 0.5 / 1023)
            << display << ": " << spread * 1023 << " codes of 10 bits";
    }
}

// ---------------------------------------------------------------------------------------------
// Structure

TEST_P(Law, ExposureIsAFactorOnTheScene) {
    for (const char* input : {"lin_rec709", "lin_ap1"}) {
        for (const double stops : {-3.0, -0.7, 2.0, 4.3}) {
            // Up to 2^10 in, 2^14.3 with the exposure: away from the limit at 65504.
            const Planes in = random_colors(count_of(3000U, 500U), -14, 10);
            Planes scaled = in;
            for (auto& plane : scaled) {
                for (double& x : plane)
                    x *= std::exp2(stops);
            }
            const Planes a = run(view("srgb", stops, input), in);
            const Planes b = run(view("srgb", 0, input), scaled);
            for (std::size_t i = 0; i < in[0].size(); ++i) {
                // The products come in two orders: some 2^-53 of the largest channel, that the
                // matrix may leave standing (2.4 is its largest sum of coefficients) where the
                // others cancel, times the steepest slope of the sRGB curve, 12.92.
                const double largest = std::max({scaled[0][i], scaled[1][i], scaled[2][i]});
                // PQ's power of 78.84, and 1/0.159 in the inverse, multiply a rounding by
                // thousands where chroma cancels.
                const double tolerance = 2e-11 + 6 * 0x1p-53 * 2.4 * 12.92 * largest;
                for (std::size_t c = 0; c < 3; ++c) {
                    ASSERT_NEAR(a[c][i], b[c][i], tolerance)
                        << input << ", " << stops << " stops, " << color_text(in, i);
                }
            }
        }
    }
}

class ToneScaleLaw : public Law {};

TEST_P(ToneScaleLaw, RatiosOfTheChannelsAreKept) {
    const Pipeline in_working_space =
        view("native", 0, op().working == kRec2020 ? "lin_rec2020" : "lin_rec709");
    const Planes in = random_colors(20000, -14, 14);
    const Planes out = run(in_working_space, in);
    std::size_t lit = 0;
    for (std::size_t i = 0; i < in[0].size(); ++i) {
        for (std::size_t c = 0; c < 3; ++c) {
            const std::size_t d = (c + 1) % 3;
            // out_c/out_d = in_c/in_d: a product and a division, rounded.
            const double left = out[c][i] * in[d][i];
            const double right = out[d][i] * in[c][i];
            ASSERT_NEAR(left, right, 1e-15 * std::max(left, right)) << color_text(in, i);
            ASSERT_GE(out[c][i], 0) << color_text(in, i);
            lit += out[c][i] > 0 ? 1 : 0;
        }
    }
    EXPECT_GT(lit, 3 * in[0].size() / 2) << "some crush their shadows, none the half of all colors";
    const Vector3 red = ReferenceEngine(in_working_space)({3, 0, 0});
    EXPECT_GT(red[0], 0);
    EXPECT_EQ(red[1], 0);
    EXPECT_EQ(red[2], 0);
}

TEST_P(Law, AnalyticInversesInvert) {
    for (const Display& display : all_displays()) {
        const Pipeline stages = view(display.id);
        for (std::size_t s = 1; s < stages.size(); ++s) {
            const auto* curve = std::get_if<CurveStage>(&stages[s]);
            const auto* domain = std::get_if<ClampStage>(&stages[s - 1]);
            if (!curve || !curve->inverse) continue;
            // The scene light of HLG is behind the OOTF: up to the peak's, 1.
            const bool is_hlg = display.id == "rec2100_hlg" && s + 2 == stages.size();
            ASSERT_TRUE(domain || is_hlg) << "an inverse needs to know where it holds";
            const double lo = is_hlg ? 0 : std::max(domain->lo, -kHalfMax);
            const double hi = is_hlg ? 1 : std::min(domain->hi, kHalfMax);
            for (std::size_t c = 0; c < 3; ++c) {
                for (int i = 0; i <= 2000; i += count_of(1, 8)) {
                    // Even steps, and stops down from the upper end. None falls into the 7e-9 above
                    // 0.0031308 where the two rounded constants of IEC 61966-2-1 leave a gap.
                    const double even = lo + (hi - lo) * i / 2000;
                    const double dark = hi * std::exp2(-i / 100.0);
                    for (const double x : {even, dark}) {
                        const double back =
                            evaluate((*curve->inverse)[c], evaluate(curve->f[c], x));
                        // x/(1-x) at 65504 magnifies the rounding of its argument 65505 times.
                        ASSERT_NEAR(back, x, 1e-9 * std::max(std::fabs(x), 1e-3))
                            << display.id << ", stage " << s;
                    }
                }
            }
        }
    }
}

class CurveLaw : public Law {};

TEST_P(CurveLaw, IsInvertedNumerically) {
    const Expr f = compose(resolve(GetParam()).build())[0];
    const Expr slope = derivative(f);
    std::size_t inverted = 0;
    const std::vector<double> ramp = gray_ramp();
    const std::size_t step = count_of(1U, 4U);
    for (std::size_t i = 0; i < ramp.size(); i += step) {
        const double x = ramp[i];
        if (x > kHalfMax) continue;
        const double y = evaluate(f, x);
        // The rounding of y may move x by this much, relative: some 2^-53 of the formula's terms,
        // which are of the size of 1 (Hable's cancel in the dark), over the slope. PQ's power of
        // 78.84 multiplies them by a hundred.
        const double uncertainty = 1e-13 * std::max(1.0, std::fabs(y)) / (evaluate(slope, x) * x);
        // If the curve is flat (a clamp, a shoulder near its end), any x will do.
        if (!(uncertainty >= 0 && uncertainty < 1e-6)) continue;
        EXPECT_NEAR(inverse_at(f, y, 0, kHalfMax) / x, 1, uncertainty + 1e-15) << "at " << x;
        ++inverted;
    }
    EXPECT_GT(inverted * step, 500) << "eight stops of the ramp at least";
}

// ---------------------------------------------------------------------------------------------
// SIMD

class ThreadLaw : public Law {};

TEST_P(ThreadLaw, ThreadsMayCompileAndRunTogether) {
    const Planes colors = random_colors(5000, -16, 12, true);
    std::vector<float> in;
    for (std::size_t i = 0; i < colors[0].size(); ++i) {
        for (const auto& plane : colors)
            in.push_back(static_cast<float>(plane[i]));
    }
    const SimdEngine shared(view("srgb"));
    std::vector<float> expected(in.size());
    shared.run_rgb(in.data(), expected.data(), in.size() / 3);
    const std::size_t thread_count = count_of<std::size_t>(4, 2);
    std::vector<std::vector<float>> results(2 * thread_count);
    std::vector<std::thread> threads;
    for (std::size_t t = 0; t < thread_count; ++t) {
        threads.emplace_back([&, t] {
            // One engine for all, and one of its own that is compiled meanwhile.
            const SimdEngine own(
                build_view(make_view(resolve(GetParam()), "lin_rec709", 0, "srgb")));
            for (const auto& [engine, slot] : {std::pair{&shared, t}, {&own, thread_count + t}}) {
                results[slot].resize(in.size());
                engine->run_rgb(in.data(), results[slot].data(), in.size() / 3);
            }
        });
    }
    for (std::thread& t : threads)
        t.join();
    for (const std::vector<float>& result : results)
        EXPECT_EQ(result, expected);
}

// ---------------------------------------------------------------------------------------------
// Parameters

/// Settings from the whole of every interval: log-uniform where it spans more than two decades.
Settings random_settings(const Operator& op, SampleRandom& random) {
    Settings settings;
    for (const ParameterSpec& p : op.parameters) {
        if (p.kind == ParameterSpec::Kind::text) continue;  // names a file
        if (p.kind == ParameterSpec::Kind::choice) {
            settings[p.name] = p.choices[random.bits() % p.choices.size()];
            continue;
        }
        double value = random.bits() % 2 ? p.min : p.max;
        if (random.bits() % 4 != 0) {
            value = p.min > 0 && p.max / p.min > 100
                        ? std::exp2(random.uniform(std::log2(p.min), std::log2(p.max)))
                        : random.uniform(p.min, p.max);
        }
        settings[p.name] = shortest(std::clamp(value, p.min, p.max));
    }
    // Most random combinations of these contradict each other.
    if (settings.contains("color_correction")) {
        if (settings["apply"] != "luminance") settings["color_correction"] = "ratio";
        if (settings["color_correction"] == "ratio") {
            settings["saturation"] = "1";
            settings["saturation_from"] = "fixed";
        }
    }
    return settings;
}

std::string text_of(const Settings& settings) {
    std::string text;
    for (const auto& [name, value] : settings)
        text += " " + name + "=" + value;
    return text;
}

class ParameterLaw : public ::testing::TestWithParam<std::string> {};

/// "A bad parameter is an error, never a silent clamp": then what is no error has to work.
TEST_P(ParameterLaw, AcceptedValuesGiveFiniteResults) {
    const Operator& op = find_operator(GetParam());
    SampleRandom random(43);
    std::vector<float> in;
    for (int i = 0; i < 3 * 600; ++i) {
        const unsigned long long bits = random.bits();
        in.push_back(i % 2 ? std::bit_cast<float>(static_cast<std::uint32_t>(bits))
                           : static_cast<float>(std::exp2(random.uniform(-20, 16))));
    }
    for (const double s : {0.0, 0.18, 1.0, 65504.0})
        in.insert(in.end(), 3, static_cast<float>(s));
    std::vector<double> reference(in.size());
    std::vector<float> simd(in.size());
    std::set<Settings> tried;
    std::size_t accepted = 0;
    // Preparing an engine for the largest operators takes a good part of a second, and so does a
    // grid.
    const Tape usual(
        compose(build_view(make_view(resolve_operator(op.id), "lin_rec709", 0, "srgb"))));
    const bool is_large =
        usual.code().size() > 300 ||
        std::any_of(usual.code().begin(), usual.code().end(),
                    [](const TapeInstruction& step) { return step.op == ExprOp::grid; });
    const std::size_t wanted = is_large ? count_of(8U, 2U) : count_of(50U, 6U);
    // Hardly one random set in twenty has two peaks and two blacks in order.
    for (int round = 0; round < 600 && accepted < wanted; ++round) {
        const Settings settings = random_settings(op, random);
        if (!tried.insert(settings).second) continue;
        std::optional<ResolvedOperator> resolved;
        try {
            resolved = resolve_operator(op.id, settings);
        } catch (const Error&) {
            continue;  // parameters that contradict each other
        }
        ++accepted;
        for (const char* display : {"native", "srgb"}) {
            const Pipeline pipeline = build_view(make_view(*resolved, "lin_rec709", 0, display));
            ReferenceEngine(pipeline).run_rgb(in.data(), reference.data(), in.size() / 3);
            SimdEngine(pipeline, op.bounds.simd_goal)
                .run_rgb(in.data(), simd.data(), in.size() / 3);
            for (std::size_t i = 0; i < in.size(); ++i) {
                ASSERT_TRUE(std::isfinite(reference[i]))
                    << text_of(settings) << ": " << display << " of " << in[i] << " is "
                    << reference[i];
                ASSERT_TRUE(std::isfinite(simd[i])) << text_of(settings) << ": SIMD, " << display
                                                    << " of " << in[i] << " is " << simd[i];
                if (std::string_view(display) == "native") continue;
                ASSERT_NEAR(static_cast<double>(simd[i]), reference[i], op.bounds.simd)
                    << text_of(settings) << ": SIMD of " << in[i];
            }
        }
    }
    EXPECT_GE(accepted, std::min({tried.size(), wanted, std::size_t{8}}));
}

// ---------------------------------------------------------------------------------------------
// Who is under which law

/// A clamp of the result, which changes ratios, is no tone scale.
bool is_tone_scale(const Pipeline& stages) {
    const auto is_one = [](const Stage& s) { return std::holds_alternative<ToneScaleStage>(s); };
    const auto is_clamp = [](const Stage& s) { return std::holds_alternative<ClampStage>(s); };
    return std::any_of(stages.begin(), stages.end(), is_one) && !is_clamp(stages.back()) &&
           std::all_of(stages.begin(), stages.end(),
                       [&](const Stage& s) { return is_one(s) || is_clamp(s); });
}

template <class Predicate>
std::vector<OperatorVariant> variants_where(const Predicate& applies) {
    std::vector<OperatorVariant> chosen;
    for (const OperatorVariant& v : variants_and_defects()) {
        if (applies(simplify(resolve(v).build()))) chosen.push_back(v);
    }
    return chosen;
}

std::vector<OperatorVariant> invertible_curves() {
    std::vector<OperatorVariant> chosen = variants_where(is_per_channel);
    std::erase_if(chosen, [](const OperatorVariant& v) {
        return declared_differences(v).contains(Kind::not_monotone);
    });
    return chosen;
}

/// Every tenth: what threads share knows of no operator.
std::vector<OperatorVariant> some_variants() {
    const std::vector<OperatorVariant> all = variants_and_defects();
    std::vector<OperatorVariant> chosen;
    for (std::size_t i = 0; i < all.size(); i += count_of(1U, 10U))
        chosen.push_back(all[i]);
    return chosen;
}

std::vector<std::string> operators_with_parameters() {
    std::vector<std::string> ids;
    for (const Operator& op : all_operators()) {
        const bool has_number_or_choice =
            std::any_of(op.parameters.begin(), op.parameters.end(),
                        [](const ParameterSpec& p) { return p.kind != ParameterSpec::Kind::text; });
        if (has_number_or_choice) ids.push_back(op.id);
    }
    return ids;
}

std::string test_name(const ::testing::TestParamInfo<OperatorVariant>& test) {
    std::string name = test.param.name;
    // hable:gdc and hable_gdc are two.
    if (const std::size_t colon = name.find(':'); colon != std::string::npos)
        name.replace(colon, 1, "__");
    if (!test.param.look.empty()) name += "_" + test.param.look;
    for (char& c : name) {
        const bool is_alnum =
            (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9');
        if (!is_alnum) c = '_';
    }
    return name;
}

INSTANTIATE_TEST_SUITE_P(Operators, Law, ::testing::ValuesIn(variants_and_defects()), test_name);
INSTANTIATE_TEST_SUITE_P(Operators, ThreadLaw, ::testing::ValuesIn(some_variants()), test_name);
INSTANTIATE_TEST_SUITE_P(Operators, ToneScaleLaw,
                         ::testing::ValuesIn(variants_where(is_tone_scale)), test_name);
INSTANTIATE_TEST_SUITE_P(Operators, CurveLaw, ::testing::ValuesIn(invertible_curves()), test_name);
INSTANTIATE_TEST_SUITE_P(Operators, ParameterLaw, ::testing::ValuesIn(operators_with_parameters()),
                         [](const auto& test) { return test.param; });

TEST(Laws, CoverEveryPresetAndLook) {
    std::size_t expected = 0;
    for (const Operator& op : all_operators())
        expected += 1 + op.presets.size() + op.looks.size();
    EXPECT_EQ(all_variants().size(), expected);
}

// Inverses of every display color, those that the operator never shows included.
TEST(Laws, InversesAreFinite) {
    std::size_t count = 0;
    for (const Operator& op : all_operators()) {
        for (const char* display : {"srgb", "linear"}) {
            std::optional<ReferenceEngine> inverse;
            try {
                inverse.emplace(build_inverse_view(
                    make_view(resolve_operator(op.id), "lin_rec709", 0, display)));
            } catch (const Error& e) {
                EXPECT_EQ(std::string(e.what()).find(op.id + " has no inverse: "), 0) << e.what();
                continue;
            }
            ++count;
            for (int i = 0; i < 9 * 9 * 9; ++i) {
                const Vector3 color = {i / 81 / 8.0, i / 9 % 9 / 8.0, i % 9 / 8.0};
                const Vector3 scene = (*inverse)(color);
                EXPECT_TRUE(std::isfinite(scene[0] + scene[1] + scene[2]))
                    << op.id << " " << display << " (" << color[0] << ", " << color[1] << ", "
                    << color[2] << ")";
            }
        }
    }
    EXPECT_GT(count, all_operators().size()) << "on two displays, more than half of them";
}

}  // namespace

TONEWRIGHT_NAMESPACE_END
