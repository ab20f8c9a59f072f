// SPDX-License-Identifier: Apache-2.0
//
// Speed on one 1920x1080 float picture, sRGB view, in one run: memcpy, our engine on one thread and
// on all, OpenColorIO's CPU path for the same view, and the reference engine. Ratios to memcpy
// ("of_memcpy") are the figures to keep: they depend less on the machine.
//
//   bench --benchmark_filter='/(memcpy|hable)'
#include <OpenImageIO/parallel.h>
#include <benchmark/benchmark.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstring>
#include <limits>
#include <memory>
#include <string>
#include <vector>

#include "engine/probe.h"
#include "ocio/lower.h"
#include "tonewright/engine.h"
#include "tonewright/view.h"

namespace tonewright {
namespace {

constexpr std::size_t kWidth = 1920;
constexpr std::size_t kHeight = 1080;
constexpr std::size_t kPixels = kWidth * kHeight;

/// The scene: colours between -10 and +6 stops.
const std::vector<float>& picture(std::size_t channels) {
    static std::vector<float> rgb, rgba;
    std::vector<float>& pixels = channels == 3 ? rgb : rgba;
    if (pixels.empty()) {
        ProbeRandom random(1);
        pixels.resize(kPixels * channels);
        for (float& x : pixels)
            x = static_cast<float>(std::exp2(random.uniform(-10, 6)));
    }
    return pixels;
}

std::vector<float>& result(std::size_t channels) {
    static std::vector<float> rgb(kPixels * 3), rgba(kPixels * 4);
    return channels == 3 ? rgb : rgba;
}

void copy_picture(std::size_t channels) {
    const std::vector<float>& in = picture(channels);
    std::memcpy(result(channels).data(), in.data(), in.size() * sizeof(float));
    benchmark::DoNotOptimize(result(channels).data());
    benchmark::ClobberMemory();
}

/// Pixels per second of memcpy, the best of some.
double memcpy_rate(std::size_t channels) {
    using Clock = std::chrono::steady_clock;
    double seconds = std::numeric_limits<double>::infinity();
    for (int i = 0; i < 20; ++i) {
        const auto start = Clock::now();
        copy_picture(channels);
        seconds = std::min(seconds, std::chrono::duration<double>(Clock::now() - start).count());
    }
    return static_cast<double>(kPixels) / seconds;
}

void report(benchmark::State& state, std::size_t pixels, std::size_t channels) {
    static const double rates[2] = {memcpy_rate(3), memcpy_rate(4)};
    const auto n = static_cast<double>(pixels);
    state.SetItemsProcessed(static_cast<std::int64_t>(pixels) *
                            static_cast<std::int64_t>(state.iterations()));
    state.counters["of_memcpy"] =
        benchmark::Counter(n / rates[channels - 3], benchmark::Counter::kIsIterationInvariantRate);
}

void copy(benchmark::State& state, std::size_t channels) {
    for (auto _ : state)
        copy_picture(channels);
    report(state, kPixels, channels);
}

Pipeline view_of(const std::string& name) {
    return build_view(make_view(resolve_operator(name), "lin_rec709", 0, "srgb"));
}

double goal_of(const std::string& name) { return resolve_operator(name).op->bounds.simd_goal; }

void run_rows(const SimdEngine& engine, std::size_t channels, std::size_t begin, std::size_t end) {
    const float* in = picture(channels).data() + begin * kWidth * channels;
    float* out = result(channels).data() + begin * kWidth * channels;
    const auto stride = static_cast<std::ptrdiff_t>(channels);
    engine.run({in, in + 1, in + 2}, stride, {out, out + 1, out + 2}, stride,
               (end - begin) * kWidth);
}

void simd_one_thread(benchmark::State& state, const std::string& name, std::size_t channels) {
    const SimdEngine engine(view_of(name), goal_of(name));
    for (auto _ : state)
        run_rows(engine, channels, 0, kHeight);
    report(state, kPixels, channels);
}

void simd_all_threads(benchmark::State& state, const std::string& name) {
    const SimdEngine engine(view_of(name), goal_of(name));
    const auto rows = static_cast<std::int64_t>(kHeight);
    for (auto _ : state) {
        OIIO::parallel_for_chunked(0, rows, 0, [&](std::int64_t begin, std::int64_t end) {
            run_rows(engine, 3, static_cast<std::size_t>(begin), static_cast<std::size_t>(end));
        });
    }
    report(state, kPixels, 3);
}

void ocio(benchmark::State& state, const std::string& name) {
    std::unique_ptr<OcioCpu> cpu;
    try {
        cpu = std::make_unique<OcioCpu>(make_processor(lower_to_ocio(simplify(view_of(name)))));
    } catch (const std::exception& e) {
        return state.SkipWithError(e.what());
    }
    for (auto _ : state)
        cpu->run_rgb(picture(3).data(), result(3).data(), kPixels);
    report(state, kPixels, 3);
}

void reference(benchmark::State& state, const std::string& name) {
    constexpr std::size_t kPart = kPixels / 16;
    const ReferenceEngine engine(view_of(name));
    std::vector<double> out(kPart * 3);
    for (auto _ : state)
        engine.run_rgb(picture(3).data(), out.data(), kPart);
    report(state, kPart, 3);
}

void prepare(benchmark::State& state, const std::string& name) {
    const Pipeline view = view_of(name);
    for (auto _ : state)
        benchmark::DoNotOptimize(SimdEngine(view, goal_of(name)));
}

template <class F, class... Args>
void add(const std::string& name, F function, Args... args) {
    benchmark::RegisterBenchmark(name.c_str(), function, args...)
        ->UseRealTime()
        ->Unit(benchmark::kMillisecond);
}

void register_all() {
    add("memcpy/rgb", copy, 3);
    add("memcpy/rgba", copy, 4);
    for (const Operator& op : all_operators()) {
        add("simd/" + op.id, simd_one_thread, op.id, 3);
        add("simd_rgba/" + op.id, simd_one_thread, op.id, 4);
        add("simd_all_threads/" + op.id, simd_all_threads, op.id);
        add("ocio/" + op.id, ocio, op.id);
        add("reference/" + op.id, reference, op.id);
        add("prepare_simd/" + op.id, prepare, op.id);
    }
}

}  // namespace
}  // namespace tonewright

int main(int argc, char** argv) {
    tonewright::register_all();
    benchmark::Initialize(&argc, argv);
    if (benchmark::ReportUnrecognizedArguments(argc, argv)) return 2;
    benchmark::RunSpecifiedBenchmarks();
    benchmark::Shutdown();
    return 0;
}
