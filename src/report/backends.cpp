// SPDX-License-Identifier: Apache-2.0
#include "report/backends.h"

#include <array>
#include <functional>
#include <utility>

#include "ocio/gpu.h"
#include "ocio/operator_facts.h"
#include "ocio/transforms.h"
#include "tonewright/engine.h"
#include "tonewright/error.h"
#include "tonewright/lut.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

/// A 3D LUT that many applications take: 33 points a side, indexed with ACEScct in the operator's
/// input space.
std::vector<float> through_lut(const View& view, const std::vector<float>& rgb) {
    LutRequest request;
    request.view = view;
    request.encoding = parse_input_encoding("acescct");
    request.dimension = LutDimension::three;
    request.size = 33;
    const Lut lut = sample_lut(request);
    const ReferenceEngine encode({curve_stage(request.encoding.encode)});
    std::vector<float> shown(rgb.size());
    for (std::size_t i = 0; i < rgb.size(); i += 3) {
        const Vector3 color =
            interpolate(lut,
                        encode({static_cast<double>(rgb[i]), static_cast<double>(rgb[i + 1]),
                                static_cast<double>(rgb[i + 2])}),
                        false);
        for (std::size_t c = 0; c < 3; ++c)
            shown[i + c] = static_cast<float>(color[c]);
    }
    return shown;
}

}  // namespace

std::vector<BackendResult> run_backends(const View& view, const std::vector<float>& rgb) {
    const Pipeline pipeline = build_view(view);
    const auto through = [&](const auto& engine) {
        std::vector<float> shown(rgb.size());
        engine.run_rgb(rgb.data(), shown.data(), rgb.size() / 3);
        return shown;
    };
    const auto processor = [&] {
        const LowerOptions lowering{.fits_cubes = lower_options(*view.op.op).fits_cubes};
        return make_processor(lower_to_ocio(pipeline, lowering).ops);
    };
    const std::array<std::pair<const char*, std::function<std::vector<float>()>>, 4> backends = {{
        {"Tonewright's engine",
         [&] { return through(SimdEngine(pipeline, view.op.op->bounds.simd_goal)); }},
        {"OpenColorIO, CPU", [&] { return through(OcioCpu(processor())); }},
        {"OpenColorIO, GPU", [&] { return through(OcioGpu(processor())); }},
        {"3D LUT, 33 points, ACEScct", [&] { return through_lut(view, rgb); }},
    }};
    std::vector<BackendResult> results;
    for (const auto& [name, run] : backends) {
        BackendResult& result = results.emplace_back();
        result.name = name;
        try {
            result.shown = run();
        } catch (const Error& e) {
            result.reason = e.what();
        }
    }
    return results;
}

TONEWRIGHT_NAMESPACE_END
