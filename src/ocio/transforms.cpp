// SPDX-License-Identifier: Apache-2.0
#include "ocio/transforms.h"

#include <algorithm>
#include <array>

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

OCIO::TransformRcPtr make(const MatrixOp& op) {
    std::array<double, 16> m44{};
    for (std::size_t i = 0; i < 3; ++i)
        std::copy(op.m[i].begin(), op.m[i].end(), m44.begin() + static_cast<std::ptrdiff_t>(4 * i));
    m44[15] = 1;
    const OCIO::MatrixTransformRcPtr t = OCIO::MatrixTransform::Create();
    t->setMatrix(m44.data());
    t->setOffset(std::array{op.offset[0], op.offset[1], op.offset[2], 0.0}.data());
    return t;
}

OCIO::TransformRcPtr make(const RangeOp& op) {
    const OCIO::RangeTransformRcPtr t = OCIO::RangeTransform::Create();
    // OCIO 2.1 appends a point to whole numbers, also to "1e+18.", which is invalid GLSL.
    // Half-float tables are constant above 65504 in any case.
    constexpr double largest = 1e15;
    if (op.lo > -largest) {
        t->setMinInValue(op.lo);
        t->setMinOutValue(op.lo);
    }
    if (op.hi < largest) {
        t->setMaxInValue(op.hi);
        t->setMaxOutValue(op.hi);
    }
    return t;
}

OCIO::TransformRcPtr make(const Lut1DOp& op) {
    const auto size = static_cast<unsigned long>(op.size());
    const OCIO::Lut1DTransformRcPtr t = OCIO::Lut1DTransform::Create(size, op.is_half_domain);
    t->setInterpolation(OCIO::INTERP_LINEAR);
    t->setFileOutputBitDepth(OCIO::BIT_DEPTH_F32);
    t->setHueAdjust(op.keeps_hue ? OCIO::HUE_DW3 : OCIO::HUE_NONE);
    const bool has_three = op.channels == 3;
    const float* v = op.values.data();
    for (unsigned long i = 0; i < size; ++i, v += op.channels)
        t->setValue(i, v[0], v[has_three ? 1 : 0], v[has_three ? 2 : 0]);
    return t;
}

OCIO::TransformRcPtr make(const Lut3DOp& op) {
    const auto edge = static_cast<unsigned long>(op.edge);
    const OCIO::Lut3DTransformRcPtr t = OCIO::Lut3DTransform::Create(edge);
    t->setInterpolation(OCIO::INTERP_TETRAHEDRAL);
    t->setFileOutputBitDepth(OCIO::BIT_DEPTH_F32);
    const float* v = op.values.data();
    for (unsigned long i = 0; i < edge * edge * edge; ++i, v += 3)
        t->setValue(i / (edge * edge), i / edge % edge, i % edge, v[0], v[1], v[2]);
    return t;
}

OCIO::TransformRcPtr make(const FixedFunctionOp& op) {
    const auto style = OCIO::FixedFunctionStyleFromString(op.style.c_str());
    if (op.parameters.empty()) return OCIO::FixedFunctionTransform::Create(style);
    return OCIO::FixedFunctionTransform::Create(style, op.parameters.data(), op.parameters.size());
}

OCIO::TransformRcPtr make(const BuiltinOp& op) {
    const OCIO::BuiltinTransformRcPtr t = OCIO::BuiltinTransform::Create();
    t->setStyle(op.style.c_str());
    return t;
}

}  // namespace

OCIO::TransformRcPtr to_ocio(const LoweredOp& op) {
    OCIO::TransformRcPtr t = std::visit([](const auto& o) { return make(o); }, op.op);
    if (op.is_inverse) t->setDirection(OCIO::TRANSFORM_DIR_INVERSE);
    return t;
}

OCIO::GroupTransformRcPtr to_ocio(const LoweredOps& ops) {
    OCIO::GroupTransformRcPtr group = OCIO::GroupTransform::Create();
    append(group, ops);
    return group;
}

void append(OCIO::GroupTransformRcPtr& group, const LoweredOps& ops) {
    for (const LoweredOp& op : ops)
        group->appendTransform(to_ocio(op));
}

OCIO::ConstProcessorRcPtr make_processor(const OCIO::ConstTransformRcPtr& transform) {
    const OCIO::ConfigRcPtr config = OCIO::Config::CreateRaw()->createEditableCopy();
    config->setProcessorCacheFlags(OCIO::PROCESSOR_CACHE_OFF);
    return config->getProcessor(transform);
}

OCIO::ConstProcessorRcPtr make_processor(const LoweredOps& ops) {
    return make_processor(to_ocio(ops));
}

// OpenColorIO lets OCIO_OPTIMIZATION_FLAGS of the environment replace the flags of every caller, up
// to its version 2.5. A library must not change the environment of its application, so the command
// removes the variable before it starts a thread.
OcioCpu::OcioCpu(const OCIO::ConstProcessorRcPtr& processor, OCIO::OptimizationFlags flags)
    : cpu_(processor->getOptimizedCPUProcessor(flags)) {}

void OcioCpu::run_rgb(const float* in, float* out, std::size_t pixel_count) const {
    constexpr std::size_t kChunk = std::size_t{1} << 20;
    std::copy_n(in, 3 * pixel_count, out);
    for (std::size_t begin = 0; begin < pixel_count; begin += kChunk) {
        const std::size_t n = std::min(kChunk, pixel_count - begin);
        OCIO::PackedImageDesc image(out + 3 * begin, static_cast<long>(n), 1, 3);
        cpu_->apply(image);
    }
}

TONEWRIGHT_NAMESPACE_END
