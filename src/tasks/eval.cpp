// SPDX-License-Identifier: Apache-2.0
#include "tasks/eval.h"

#include <algorithm>
#include <array>
#include <memory>
#include <utility>
#include <vector>

#include "tonewright/engine.h"
#include "verify/backends.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

Pipeline pipeline_of(const EvalRequest& request) {
    return request.is_inverse ? build_inverse_view(request.view) : build_view(request.view);
}

/// For an engine that takes floats.
ColorMap through_floats(ColorRun run) {
    return [run = std::move(run)](const double* in, double* out, std::size_t count) {
        const std::vector<float> from(in, in + 3 * count);
        std::vector<float> to(from.size());
        run(from.data(), to.data(), count);
        std::copy(to.begin(), to.end(), out);
    };
}

}  // namespace

ColorMap color_map(const EvalRequest& request) {
    const Pipeline pipeline = pipeline_of(request);
    if (request.engine == EvalEngine::reference) {
        const auto engine = std::make_shared<const ReferenceEngine>(pipeline);
        return [engine](const double* in, double* out, std::size_t count) {
            std::array<std::vector<double>, 3> plane;
            for (std::size_t i = 0; i < 3 * count; ++i)
                plane[i % 3].push_back(in[i]);
            const std::array<double*, 3> p = {plane[0].data(), plane[1].data(), plane[2].data()};
            engine->run({p[0], p[1], p[2]}, p, count);
            for (std::size_t i = 0; i < 3 * count; ++i)
                out[i] = plane[i % 3][i / 3];
        };
    }
    constexpr std::array kBackends = {Backend::Id::simd, Backend::Id::ocio_cpu,
                                      Backend::Id::ocio_gpu};
    const Backend& backend =
        find_backend(kBackends.at(static_cast<std::size_t>(request.engine) - 1));
    return through_floats(backend.start({request.view, pipeline, nullptr, request.cache_folder}));
}

std::string explain(const EvalRequest& request) {
    return explain(pipeline_of(request), {}, request.view.op.op->bounds.simd_goal);
}

ColorMap color_map(LutFile lut, const Pipeline& before) {
    const auto file = std::make_shared<const LutFile>(std::move(lut));
    const auto encode = before.empty() ? nullptr : std::make_shared<const ReferenceEngine>(before);
    return through_floats([file, encode](const float* in, float* out, std::size_t count) {
        if (!encode) {
            file->run_rgb(in, out, count);
            return;
        }
        std::vector<double> encoded(3 * count);
        encode->run_rgb(in, encoded.data(), count);
        const std::vector<float> code(encoded.begin(), encoded.end());
        file->run_rgb(code.data(), out, count);
    });
}

TONEWRIGHT_NAMESPACE_END
