// SPDX-License-Identifier: Apache-2.0
//
// Speed of the engine on one 3840x2160 RGBA float picture, sRGB view, beside memcpy of the same
// picture and OpenColorIO's CPU path, in one run. Ratios to memcpy ("of_memcpy") are the figures to
// keep: they depend less on the machine. table.py runs this and prints them.
//
//   tonewright_bench --benchmark_filter='^(memcpy|[a-z0-9_]+/hable$)' [--target=AVX2]
#include <OpenColorIO/OpenColorIO.h>
#include <OpenImageIO/parallel.h>
#include <benchmark/benchmark.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstring>
#include <limits>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "base/random.h"
#include "measure/sample_set.h"
#include "ocio/operator_facts.h"
#include "ocio/transforms.h"
#include "tonewright/engine.h"
#include "tonewright/lut.h"
#include "tonewright/registry.h"
#include "tonewright/view.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

constexpr std::size_t kWidth = 3840;
constexpr std::size_t kHeight = 2160;
constexpr std::size_t kPixels = kWidth * kHeight;
constexpr std::size_t kChannels = 4;

/// The scene: colors between -10 and +6 stops, noise, the worst for branches and tables.
const std::vector<float>& picture() {
    static const std::vector<float> pixels = [] {
        SampleRandom random(1);
        std::vector<float> made(kPixels * kChannels);
        for (float& x : made)
            x = static_cast<float>(std::exp2(random.uniform(-10, 6)));
        return made;
    }();
    return pixels;
}

std::vector<float>& result() {
    static std::vector<float> pixels(kPixels * kChannels);
    return pixels;
}

void copy_picture() {
    std::memcpy(result().data(), picture().data(), picture().size() * sizeof(float));
    benchmark::DoNotOptimize(result().data());
    benchmark::ClobberMemory();
}

/// Pixels per second of memcpy on one thread, the best of some.
double memcpy_rate() {
    static const double rate = [] {
        using Clock = std::chrono::steady_clock;
        double seconds = std::numeric_limits<double>::infinity();
        for (int i = 0; i < 20; ++i) {
            const auto start = Clock::now();
            copy_picture();
            seconds =
                std::min(seconds, std::chrono::duration<double>(Clock::now() - start).count());
        }
        return static_cast<double>(kPixels) / seconds;
    }();
    return rate;
}

Pipeline view_of(const std::string& name) {
    return build_view(make_view(resolve_operator(name), "lin_rec709", 0, "srgb"));
}

/// The engine's instruction set, or "" for the best of this machine.
std::string& target() {
    static std::string name;
    return name;
}

double goal_of(const std::string& name) { return resolve_operator(name).op->bounds.simd_goal; }

void report(benchmark::State& state, std::size_t pixels) {
    const auto n = static_cast<double>(pixels);
    state.SetItemsProcessed(static_cast<std::int64_t>(pixels) *
                            static_cast<std::int64_t>(state.iterations()));
    state.counters["of_memcpy"] =
        benchmark::Counter(n / memcpy_rate(), benchmark::Counter::kIsIterationInvariantRate);
}

/// Largest distance of the result's first pixels from the double reference, in code values.
void report_error(benchmark::State& state, const std::string& name) {
    constexpr std::size_t kSome = 100000;
    std::vector<float> in(3 * kSome);
    for (std::size_t i = 0; i < in.size(); ++i)
        in[i] = picture()[i / 3 * kChannels + i % 3];
    std::vector<double> truth(in.size());
    ReferenceEngine(view_of(name)).run_rgb(in.data(), truth.data(), kSome);
    double error = 0;
    for (std::size_t i = 0; i < in.size(); ++i) {
        const auto shown = static_cast<double>(result()[i / 3 * kChannels + i % 3]);
        error = std::max(error, std::fabs(shown - truth[i]));
    }
    state.counters["max_error"] = error;
}

void copy(benchmark::State& state) {
    for (auto _ : state)
        copy_picture();
    report(state, kPixels);
}

void run_rows(const SimdEngine& engine, std::size_t begin, std::size_t end) {
    const float* in = picture().data() + begin * kWidth * kChannels;
    float* out = result().data() + begin * kWidth * kChannels;
    engine.run({in, in + 1, in + 2}, kChannels, {out, out + 1, out + 2}, kChannels,
               (end - begin) * kWidth);
}

/// @param threads  0: all
void simd(benchmark::State& state, const std::string& name, int threads) {
    const SimdEngine engine(view_of(name), goal_of(name), target());
    for (auto _ : state) {
        if (threads == 1) {
            run_rows(engine, 0, kHeight);
            continue;
        }
        OIIO::parallel_for_chunked(
            0, static_cast<std::int64_t>(kHeight), 0,
            [&](std::int64_t begin, std::int64_t end) {
                run_rows(engine, static_cast<std::size_t>(begin), static_cast<std::size_t>(end));
            },
            OIIO::paropt(threads));
    }
    report(state, kPixels);
    report_error(state, name);
}

/// RGB pictures of other sizes: the cost of a pixel should not depend on how many there are.
void simd_size(benchmark::State& state, const std::string& name) {
    const auto pixels = static_cast<std::size_t>(state.range(0));
    const SimdEngine engine(view_of(name), goal_of(name), target());
    std::vector<float> in(3 * pixels), out(3 * pixels);
    for (std::size_t i = 0; i < in.size(); ++i)
        in[i] = picture()[i % picture().size()];
    for (auto _ : state)
        engine.run_rgb(in.data(), out.data(), pixels);
    report(state, pixels);
}

void run_ocio(benchmark::State& state, const std::string& name,
              const OCIO::ConstTransformRcPtr& transform, OCIO::OptimizationFlags flags) {
    const OCIO::ConstCPUProcessorRcPtr cpu = make_processor(transform)->getOptimizedCPUProcessor(
        OCIO::BIT_DEPTH_F32, OCIO::BIT_DEPTH_F32, flags);
    // The interface has no const for constant pixels.
    auto* in = const_cast<float*>(picture().data());  // NOLINT(*-const-cast)
    const OCIO::PackedImageDesc source(in, kWidth, kHeight, kChannels);
    OCIO::PackedImageDesc target(result().data(), kWidth, kHeight, kChannels);
    for (auto _ : state)
        cpu->apply(source, target);
    report(state, kPixels);
    report_error(state, name);
}

/// The most exact route that OpenColorIO has.
void ocio(benchmark::State& state, const std::string& name, OCIO::OptimizationFlags flags) {
    try {
        const LowerOptions options{.fits_cubes =
                                       lower_options(*resolve_operator(name).op).fits_cubes};
        run_ocio(state, name, to_ocio(lower_to_ocio(view_of(name), options).ops), flags);
    } catch (const std::exception& e) {
        state.SkipWithError(e.what());
    }
}

/// The usual alternative: a 3D LUT of the whole view behind a logarithm that holds the scene.
void lut65(benchmark::State& state, const std::string& name) {
    LutRequest request;
    request.view = make_view(resolve_operator(name), "lin_rec709", 0, "srgb");
    request.encoding = parse_input_encoding("log2:-10:8.5");
    request.dimension = LutDimension::three;
    request.size = 65;
    const Lut lut = sample_lut(request);

    constexpr double kLow = -10, kHigh = 8.5;
    const double scene_slope[] = {1 / 0.18, 1 / 0.18, 1 / 0.18};
    const double slope[] = {1 / (kHigh - kLow), 1 / (kHigh - kLow), 1 / (kHigh - kLow)};
    const double offset[] = {-kLow * slope[0], -kLow * slope[0], -kLow * slope[0]};
    const auto logarithm = OCIO::LogAffineTransform::Create();
    logarithm->setBase(2);
    logarithm->setLinSideSlopeValue(scene_slope);
    logarithm->setLogSideSlopeValue(slope);
    logarithm->setLogSideOffsetValue(offset);
    const auto cube = OCIO::Lut3DTransform::Create(65);
    cube->setInterpolation(OCIO::INTERP_TETRAHEDRAL);
    std::size_t i = 0;
    for (unsigned long b = 0; b < 65; ++b) {
        for (unsigned long g = 0; g < 65; ++g) {
            for (unsigned long r = 0; r < 65; ++r, i += 3)
                cube->setValue(r, g, b, lut.values[i], lut.values[i + 1], lut.values[i + 2]);
        }
    }
    const OCIO::GroupTransformRcPtr group = OCIO::GroupTransform::Create();
    group->appendTransform(logarithm);
    group->appendTransform(cube);
    run_ocio(state, name, group, OCIO::OPTIMIZATION_DEFAULT);
}

void reference(benchmark::State& state, const std::string& name) {
    constexpr std::size_t kPart = kPixels / 64;
    const ReferenceEngine engine(view_of(name));
    std::vector<double> out(kPart * 3);
    for (auto _ : state)
        engine.run_rgb(picture().data(), out.data(), kPart);
    report(state, kPart);
}

void prepare(benchmark::State& state, const std::string& name) {
    const Pipeline view = view_of(name);
    for (auto _ : state)
        benchmark::DoNotOptimize(SimdEngine(view, goal_of(name), target()));
}

template <class F, class... Args>
benchmark::internal::Benchmark* add(const std::string& name, F function, Args... args) {
    return benchmark::RegisterBenchmark(name.c_str(), function, args...)
        ->UseRealTime()
        ->Unit(benchmark::kMillisecond);
}

void register_all() {
    add("memcpy", copy);
    std::vector<std::string> names;
    for (const Operator& op : all_operators()) {
        names.push_back(op.id);
        for (const Preset& preset : op.presets)
            names.push_back(op.id + ":" + preset.id);
    }
    for (const std::string& name : names) {
        add("simd/" + name, simd, name, 1);
        add("simd_two_threads/" + name, simd, name, 2);
        add("simd_all_threads/" + name, simd, name, 0);
        add("ocio_lossless/" + name, ocio, name, OCIO::OPTIMIZATION_LOSSLESS);
        add("ocio_default/" + name, ocio, name, OCIO::OPTIMIZATION_DEFAULT);
        add("ocio_lut65/" + name, lut65, name);
        add("reference/" + name, reference, name);
        add("prepare_simd/" + name, prepare, name);
        add("size/" + name, simd_size, name)->RangeMultiplier(10)->Range(1000, 100000000);
    }
}

}  // namespace
TONEWRIGHT_NAMESPACE_END

int main(int argc, char** argv) {
    constexpr std::string_view kTarget = "--target=";
    const auto is_target = [&](const char* a) { return std::string_view(a).starts_with(kTarget); };
    if (char** at = std::find_if(argv + 1, argv + argc, is_target); at != argv + argc) {
        tonewright::target() = std::string_view(*at).substr(kTarget.size());
        std::copy(at + 1, argv + argc, at);
        --argc;
    }
    // Overwrites the result, which must not happen between a measurement and its error.
    tonewright::memcpy_rate();
    tonewright::register_all();
    benchmark::Initialize(&argc, argv);
    if (benchmark::ReportUnrecognizedArguments(argc, argv)) return 2;
    benchmark::RunSpecifiedBenchmarks();
    benchmark::Shutdown();
    return 0;
}
