// SPDX-License-Identifier: Apache-2.0
#include "verify/backends.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <utility>

#include "ocio/gpu.h"
#include "ocio/operator_facts.h"
#include "ocio/transforms.h"
#include "tonewright/engine.h"
#include "tonewright/lut.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

/// The largest output of a stage for inputs from -`largest` to `largest`.
double largest_after(const Stage& stage, double largest) {
    const auto at = [&](const Expr& f) { return std::fabs(evaluate(f, largest)); };
    if (const auto* m = std::get_if<MatrixStage>(&stage)) {
        double sum = 0;
        for (const auto& row : m->m)
            sum = std::max(sum, std::fabs(row[0]) + std::fabs(row[1]) + std::fabs(row[2]));
        return sum * largest;
    }
    if (const auto* c = std::get_if<ClampStage>(&stage)) return std::min(largest, c->hi);
    if (const auto* c = std::get_if<CurveStage>(&stage))
        return std::max({at(c->f[0]), at(c->f[1]), at(c->f[2])});
    if (const auto* l = std::get_if<GridStage>(&stage)) {
        const std::vector<double>& nodes = l->grid->nodes();
        return *std::max_element(nodes.begin(), nodes.end());
    }
    return largest;
}

double rounded_to_half(double x) {
    constexpr double largest = 65504;
    constexpr double smallest_normal = 0x1p-14;
    const double magnitude = std::min(std::fabs(x), largest);
    // Eleven bits, or fewer below the normal numbers.
    const double unit = std::exp2(std::floor(std::log2(std::max(magnitude, smallest_normal))) - 10);
    return std::copysign(std::nearbyint(magnitude / unit) * unit, x);
}

template <class Engine>
ColorRun run_of(Engine&& made) {
    return [engine = std::make_shared<Engine>(std::forward<Engine>(made))](
               const float* in, float* out, std::size_t count) { engine->run_rgb(in, out, count); };
}

ColorRun start_simd(const BackendInput& input) {
    return run_of(SimdEngine(input.pipeline, input.view.op.op->bounds.simd_goal));
}

OCIO::ConstProcessorRcPtr processor_of(const BackendInput& input) {
    if (input.processor) return input.processor;
    const LowerOptions lowering{.fits_cubes = lower_options(*input.view.op.op).fits_cubes,
                                .cache_folder = input.cache_folder};
    return make_processor(lower_to_ocio(input.pipeline, lowering).ops);
}

ColorRun start_lossless(const BackendInput& input) {
    return run_of(OcioCpu(processor_of(input), OCIO::OPTIMIZATION_LOSSLESS));
}

ColorRun start_cpu(const BackendInput& input) { return run_of(OcioCpu(processor_of(input))); }

ColorRun start_gpu(const BackendInput& input) { return run_of(OcioGpu(processor_of(input))); }

/// OpenColorIO's built-in transform that equals the view's operator, on the view's display; null if
/// there is none, or if this OpenColorIO lacks it.
ColorRun start_builtin(const BackendInput& input) {
    const View& view = input.view;
    const std::string style = builtin_style(view.op);
    const auto registry = OCIO::BuiltinTransformRegistry::Get();
    bool is_known = false;
    for (std::size_t i = 0; i < registry->getNumBuiltins(); ++i)
        is_known = is_known || style == registry->getBuiltinStyle(i);
    if (!is_known) return nullptr;
    const Display& display = find_display(view.display);
    Pipeline behind = {MatrixStage{inverse(rgb_to_xyz_d65(display.primaries))},
                       ClampStage{0, display_limit(view.op, display).peak}};
    behind.insert(behind.end(), display.encode.begin(), display.encode.end());
    const Matrix3 to_aces = rgb_to_rgb(find_input_space(view.input).primaries, kAP0);
    LoweredOps ops = lower_to_ocio({MatrixStage{to_aces}}).ops;
    ops.push_back({BuiltinOp{style}});
    append(ops, lower_to_ocio(behind).ops);
    return run_of(OcioCpu(make_processor(ops), OCIO::OPTIMIZATION_LOSSLESS));
}

/// A model of Blender's viewport, which uploads every table as textures of half floats; everything
/// else is exact.
ColorRun start_half_textures(const BackendInput& input) {
    const OCIO::GroupTransformRcPtr group = processor_of(input)
                                                ->getOptimizedProcessor(OCIO::OPTIMIZATION_DEFAULT)
                                                ->createGroupTransform();
    const auto half = [](float x) {
        return static_cast<float>(rounded_to_half(static_cast<double>(x)));
    };
    for (int i = 0; i < group->getNumTransforms(); ++i) {
        const OCIO::TransformRcPtr part = group->getTransform(i);
        float r = 0;
        float g = 0;
        float b = 0;
        if (const auto lut = OCIO_DYNAMIC_POINTER_CAST<OCIO::Lut1DTransform>(part)) {
            for (unsigned long k = 0; k < lut->getLength(); ++k) {
                lut->getValue(k, r, g, b);
                lut->setValue(k, half(r), half(g), half(b));
            }
        }
        if (const auto cube = OCIO_DYNAMIC_POINTER_CAST<OCIO::Lut3DTransform>(part)) {
            const unsigned long n = cube->getGridSize();
            for (unsigned long k = 0; k < n * n * n; ++k) {
                cube->getValue(k / (n * n), k / n % n, k % n, r, g, b);
                cube->setValue(k / (n * n), k / n % n, k % n, half(r), half(g), half(b));
            }
        }
    }
    return run_of(OcioCpu(make_processor(group), OCIO::OPTIMIZATION_LOSSLESS));
}

/// A 3D LUT that many applications take: 33 points a side, indexed with ACEScct in the operator's
/// input space.
ColorRun start_lut(const BackendInput& input) {
    LutRequest request;
    request.view = input.view;
    request.encoding = parse_input_encoding("acescct");
    request.dimension = LutDimension::three;
    request.size = 33;
    const auto lut = std::make_shared<const Lut>(sample_lut(request));
    const auto encode =
        std::make_shared<const ReferenceEngine>(Pipeline{curve_stage(request.encoding.encode)});
    return [lut, encode](const float* in, float* out, std::size_t count) {
        for (std::size_t i = 0; i < 3 * count; i += 3) {
            const Vector3 color =
                interpolate(*lut,
                            (*encode)({static_cast<double>(in[i]), static_cast<double>(in[i + 1]),
                                       static_cast<double>(in[i + 2])}),
                            LutInterpolation::tetrahedral);
            for (std::size_t c = 0; c < 3; ++c)
                out[i + c] = static_cast<float>(color[c]);
        }
    };
}

}  // namespace

bool has_negative_coefficient(const Matrix3& m) {
    for (const auto& row : m) {
        for (const double x : row) {
            if (x < 0) return true;
        }
    }
    return false;
}

BackendBounds backend_bounds(const View& view, const Pipeline& pipeline, const Lowered& lowered) {
    const DeclaredBounds& declared = view.op.op->bounds;
    BackendBounds b;
    // Below 1, the error is that of float32 numbers around 1. Above, it grows with the curve, up to
    // the display's clamp.
    double largest_input = 4096;
    const auto largest = [&](const Expr& f) { return std::max(1.0, evaluate(f, largest_input)); };
    const auto allow = [&](double cpu, double gpu) {
        b.cpu.error = std::max(b.cpu.error, cpu);
        b.gpu.error = std::max(b.gpu.error, gpu);
    };
    bool may_be_negative = true;
    for (const Stage& stage : simplify(pipeline)) {
        // Negative channels cancel in any matrix that mixes them.
        const auto* m = std::get_if<MatrixStage>(&stage);
        if (m && (has_negative_coefficient(m->m) || (may_be_negative && mixes_channels(stage))))
            b.cpu.is_mixed_metric = b.gpu.is_mixed_metric = true;
        if (const auto* c = std::get_if<ClampStage>(&stage); c && c->lo >= 0)
            may_be_negative = false;
        // xyY and HSV subtract numbers as large as the brightest channel.
        if (const auto* t = std::get_if<ToneScaleStage>(&stage))
            allow(2e-5 * largest(t->f), 5e-5 * largest(t->f));
        if (const auto* h = std::get_if<HuePreservingStage>(&stage))
            allow(3e-7 * largest(h->f), 1e-6 * largest(h->f));
        if (const auto* h = std::get_if<HexconeStage>(&stage))
            allow(1e-5 * largest(h->value), 3e-5 * largest(h->value));
        if (std::holds_alternative<GridStage>(stage)) allow(1e-5, 5e-5);
        largest_input = largest_after(stage, largest_input);
    }
    const auto declare = [](BackendBound& bound, double error, bool is_declared) {
        if (error > 0) bound.error = error;
        bound.is_declared = is_declared;
    };
    declare(b.simd, declared.simd, declared.simd != DeclaredBounds{}.simd);
    declare(b.cpu, declared.ocio_cpu, declared.ocio_cpu > 0);
    declare(b.gpu, declared.ocio_gpu, declared.ocio_gpu > 0);
    if (!lowered.is_exact) {  // 65^3 cube: one code of 10 bits
        const double declared_3d = find_display(view.display).is_hdr && declared.lut3d_hdr > 0
                                       ? declared.lut3d_hdr
                                       : declared.lut3d;
        const double error_3d = declared_3d > 0 ? declared_3d : 1.0 / 1023;
        allow(error_3d, error_3d);
    }
    return b;
}

const std::vector<Backend>& all_backends() {
    using Id = Backend::Id;
    using Bounds = BackendBounds;
    static const std::vector<Backend> all = {
        {Id::simd, "simd", "Tonewright's engine", &Bounds::simd, start_simd},
        {Id::ocio_cpu_lossless, "ocio cpu lossless", "", &Bounds::cpu, start_lossless},
        {Id::ocio_cpu, "ocio cpu default", "OpenColorIO, CPU", &Bounds::cpu, start_cpu},
        {Id::ocio_builtin, "ocio builtin", "", &Bounds::builtin, start_builtin},
        {Id::half_textures, "half textures", "", &Bounds::half_textures, start_half_textures},
        {Id::ocio_gpu, "ocio gpu", "OpenColorIO, GPU", &Bounds::gpu, start_gpu},
        {Id::lut, "", "3D LUT, 33 points, ACEScct", nullptr, start_lut},
    };
    return all;
}

const Backend& find_backend(Backend::Id id) {
    return *std::find_if(all_backends().begin(), all_backends().end(),
                         [&](const Backend& backend) { return backend.id == id; });
}

TONEWRIGHT_NAMESPACE_END
