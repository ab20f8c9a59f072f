// SPDX-License-Identifier: Apache-2.0
#include "ocio/lower.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <vector>

#include "lut/half_domain.h"
#include "tonewright/engine.h"

namespace tonewright {
namespace {

constexpr unsigned long kHalfCount = 65536;

OCIO::MatrixTransformRcPtr make_matrix(const Matrix3& m) {
    std::array<double, 16> m44{};
    for (std::size_t i = 0; i < 3; ++i) {
        for (std::size_t j = 0; j < 3; ++j)
            m44[4 * i + j] = m[i][j];
    }
    m44[15] = 1;
    OCIO::MatrixTransformRcPtr t = OCIO::MatrixTransform::Create();
    t->setMatrix(m44.data());
    return t;
}

OCIO::RangeTransformRcPtr make_range(double lo, double hi) {
    OCIO::RangeTransformRcPtr t = OCIO::RangeTransform::Create();
    if (lo != -kInfinity) {
        t->setMinInValue(lo);
        t->setMinOutValue(lo);
    }
    if (hi != kInfinity) {
        t->setMaxInValue(hi);
        t->setMaxOutValue(hi);
    }
    return t;
}

OCIO::FixedFunctionTransformRcPtr make_fixed(OCIO::FixedFunctionStyle style,
                                             OCIO::TransformDirection direction) {
    OCIO::FixedFunctionTransformRcPtr t = OCIO::FixedFunctionTransform::Create(style);
    t->setDirection(direction);
    return t;
}

OCIO::Lut1DTransformRcPtr make_half_lut(const std::array<std::vector<float>, 3>& channels) {
    OCIO::Lut1DTransformRcPtr t = OCIO::Lut1DTransform::Create(kHalfCount, true);
    t->setInterpolation(OCIO::INTERP_LINEAR);
    t->setFileOutputBitDepth(OCIO::BIT_DEPTH_F32);
    for (unsigned long i = 0; i < kHalfCount; ++i) {
        t->setValue(i, channels[0][i], channels[1][i], channels[2][i]);
    }
    return t;
}

/// Widest to narrowest of what stages so far let through, per channel.
struct Domain {
    double lo = -kHalfMax;
    double hi = kHalfMax;
};

/// Smallest power of two t such that limiting every channel to [0, t] moves no colour of a ramp to
/// 65504 (greys, primaries and secondaries, saturated and not) by more than a quarter of a 10-bit
/// code: where the operator saturates, a cube's nodes beyond would be wasted.
double saturation_point(const Map3Stage& stage, const Expr& code) {
    const ReferenceEngine engine({stage, curve_stage(code)});
    const auto moved = [&](double top) {
        double worst = 0;
        for (int direction = 1; direction < 8; ++direction) {
            for (const double low : {0.0, 0.1, 0.5}) {
                for (double light = top; light <= kHalfMax; light *= 2) {
                    Vector3 v{};
                    Vector3 limited{};
                    for (std::size_t c = 0; c < 3; ++c) {
                        v[c] = (direction >> c & 1) ? light : low * light;
                        limited[c] = std::min(v[c], top);
                    }
                    const Vector3 a = engine(v);
                    const Vector3 b = engine(limited);
                    for (std::size_t c = 0; c < 3; ++c)
                        worst = std::max(worst, std::fabs(a[c] - b[c]));
                }
            }
        }
        return worst;
    };
    double top = 1;
    while (top < 65536 && moved(top) > 0.25 / 1023)
        top *= 2;
    return std::min(top, kHalfMax);
}

class Lowering {
  public:
    explicit Lowering(const LowerOptions& options) : options_(options) {
        result_.transform = OCIO::GroupTransform::Create();
    }

    void matrix(const Matrix3& m) {
        flush_curves();
        emit(make_matrix(m), "matrix");
        domain_ = {};
    }

    void clamp(double lo, double hi) {
        flush_curves();
        // NaN must not survive the first clamp: Range takes it to its lower end, if it has one.
        emit(make_range(lo, hi), "range");
        domain_.lo = std::max(domain_.lo, lo);
        domain_.hi = std::min(domain_.hi, hi);
    }

    void curve(const std::array<Expr, 3>& f) {
        if (!pending_) {
            pending_ = f;
            return;
        }
        for (std::size_t c = 0; c < 3; ++c) {
            (*pending_)[c] = substitute(f[c], std::span(&(*pending_)[c], 1));
        }
    }

    void tone_scale(const ToneScaleStage& stage) {
        flush_curves();
        const Expr x = Expr::input();
        // The norm of what the domain holds is in the domain too (weights of a luminance sum to 1).
        const auto identity = sample_half_domain(x, -kHalfMax, kHalfMax);
        const auto f = sample_half_domain(stage.f, std::max(domain_.lo, 0.0), domain_.hi);
        const auto lut = make_half_lut({identity, identity, f});
        if (stage.norm == ToneScaleStage::Norm::max_rgb) {
            // HSV of a negative channel loses it.
            if (!(domain_.lo >= 0)) {
                throw Error(
                    "ocio: tone scale on the largest channel without a clamp at 0 before it");
            }
            emit(make_fixed(OCIO::FIXED_FUNCTION_RGB_TO_HSV, OCIO::TRANSFORM_DIR_FORWARD), "HSV");
            emit(lut, "half LUT on V");
            emit(make_fixed(OCIO::FIXED_FUNCTION_RGB_TO_HSV, OCIO::TRANSFORM_DIR_INVERSE),
                 "HSV inverse");
        } else {
            // xyY scales all three by Y'/Y whatever the other two rows are; of the bases tried,
            // this one cancels least in 1-x-y and in the matrix back.
            const Matrix3 basis = {
                {{0.5, 0, 0}, {stage.weights[0], stage.weights[1], stage.weights[2]}, {0, 0, 1}}};
            emit(make_matrix(basis), "matrix to (R/2, L, B)");
            emit(make_fixed(OCIO::FIXED_FUNCTION_XYZ_TO_xyY, OCIO::TRANSFORM_DIR_FORWARD), "xyY");
            emit(lut, "half LUT on Y");
            emit(make_fixed(OCIO::FIXED_FUNCTION_XYZ_TO_xyY, OCIO::TRANSFORM_DIR_INVERSE),
                 "xyY inverse");
            emit(make_matrix(inverse(basis)), "matrix back");
        }
        domain_ = {};
    }

    void map3(const Map3Stage& stage) {
        flush_curves();
        if (!(domain_.lo >= 0)) throw Error("ocio: map3 stage without a clamp at 0 before it");
        const Expr x = Expr::input();
        const Expr code = srgb_encode(x);  // smooth, signed: negatives follow the straight part
        const double top = std::min(saturation_point(stage, code), domain_.hi);
        // Log with a linear toe: equal steps in stops above k, no floor above black.
        constexpr double k = 0.01;
        const double lowest = std::log2(k);
        const double span = std::log2(top + k) - lowest;
        const Expr shaper = (log2(x + k) - lowest) / span;
        const Expr unshape = exp2(x * span + lowest) - k;

        const auto shaper_table = sample_half_domain(shaper, 0, top);
        emit(make_range(0, top), "range");
        emit(make_half_lut({shaper_table, shaper_table, shaper_table}), "half LUT shaper");

        const auto edge = static_cast<unsigned long>(options_.cube_edge);
        OCIO::Lut3DTransformRcPtr cube = OCIO::Lut3DTransform::Create(edge);
        cube->setInterpolation(OCIO::INTERP_TETRAHEDRAL);
        cube->setFileOutputBitDepth(OCIO::BIT_DEPTH_F32);
        const ReferenceEngine engine({stage, curve_stage(code)});
        std::vector<double> axis(edge);
        for (unsigned long i = 0; i < edge; ++i) {
            axis[i] = std::max(
                0.0, evaluate(unshape, static_cast<double>(i) / static_cast<double>(edge - 1)));
        }
        for (unsigned long r = 0; r < edge; ++r) {
            for (unsigned long g = 0; g < edge; ++g) {
                for (unsigned long b = 0; b < edge; ++b) {
                    const Vector3 v = engine({axis[r], axis[g], axis[b]});
                    cube->setValue(r, g, b, static_cast<float>(v[0]), static_cast<float>(v[1]),
                                   static_cast<float>(v[2]));
                }
            }
        }
        emit(cube, std::to_string(edge) + "^3 cube to " + shortest(top));
        result_.is_exact = false;
        domain_ = {};
        curve({srgb_decode(x), srgb_decode(x), srgb_decode(x)});
    }

    Lowered finish() {
        flush_curves();
        return result_;
    }

  private:
    void emit(const OCIO::TransformRcPtr& transform, const std::string& what) {
        result_.transform->appendTransform(transform);
        result_.summary += (result_.summary.empty() ? "" : ", ") + what;
    }

    void flush_curves() {
        if (!pending_) return;
        std::array<Expr, 3> f = *pending_;
        pending_.reset();
        Domain domain = domain_;
        // Where the slope at black is infinite (the power of a display), the first cells of a table
        // over half floats are too coarse. Their exponents go much further below 1 than above what
        // this curve is given, so the curve moves up: a power of two loses nothing.
        const double gain = std::exp2(std::floor(std::log2(kHalfMax / domain.hi)));
        if (domain.lo >= 0 && gain > 1 && is_steep_at_black(f)) {
            emit(make_matrix(scale(kIdentity3, gain)), "scale");
            const Expr scaled = Expr::input() / gain;
            for (Expr& channel : f)
                channel = substitute(channel, std::span(&scaled, 1));
            domain = {domain.lo * gain, domain.hi * gain};
        }
        std::array<std::vector<float>, 3> tables;
        for (std::size_t c = 0; c < 3; ++c) {
            const bool known = c > 0 && same(f[c], f[0]);
            tables[c] = known ? tables[0] : sample_half_domain(f[c], domain.lo, domain.hi);
        }
        emit(make_half_lut(tables), "half LUT");
        domain_ = {};
    }

    static bool is_steep_at_black(const std::array<Expr, 3>& f) {
        constexpr double kSmallestHalf = 0x1p-24;
        constexpr double kSteep = 64;  // sRGB has 12.92, a 2.2 power 5000
        return std::any_of(f.begin(), f.end(), [&](const Expr& channel) {
            return evaluate(derivative(channel), kSmallestHalf) > kSteep;
        });
    }

    LowerOptions options_;
    Lowered result_;
    Domain domain_;
    std::optional<std::array<Expr, 3>> pending_;
};

}  // namespace

Lowered lower_to_ocio(const Pipeline& pipeline, const LowerOptions& options) {
    Lowering lowering(options);
    for (const Stage& stage : simplify(pipeline)) {
        if (const auto* m = std::get_if<MatrixStage>(&stage)) lowering.matrix(m->m);
        if (const auto* c = std::get_if<ClampStage>(&stage)) lowering.clamp(c->lo, c->hi);
        if (const auto* c = std::get_if<CurveStage>(&stage)) lowering.curve(c->f);
        if (const auto* t = std::get_if<ToneScaleStage>(&stage)) lowering.tone_scale(*t);
        if (const auto* m = std::get_if<Map3Stage>(&stage)) lowering.map3(*m);
    }
    return lowering.finish();
}

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

OCIO::ConstProcessorRcPtr make_processor(const Lowered& lowered) {
    OCIO::ConfigRcPtr config = OCIO::Config::CreateRaw()->createEditableCopy();
    config->setProcessorCacheFlags(OCIO::PROCESSOR_CACHE_OFF);
    return config->getProcessor(lowered.transform);
}

}  // namespace tonewright
