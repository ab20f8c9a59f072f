// SPDX-License-Identifier: Apache-2.0
//
// Reinhard's dodging and burning.
//
// Source    E. Reinhard, M. Stark, P. Shirley, J. Ferwerda, "Photographic Tone Reproduction for
//           Digital Images", SIGGRAPH 2002, eq. 1-4 (exposure, white) and 5-9 (local adaptation).
// In        scene-linear planes of Rec.709, L = 0.2126 R + 0.7152 G + 0.0722 B.
// Out       display-linear Rec.709; unbounded above 1 if white is set, and for saturated channels.
// Formula   L1 = key L / Lavg, Lavg = exp(mean ln(0.001 + L)) of the picture before exposure.
//           B_k: L1 blurred with exp(-d^2/(s_k/(2 sqrt 2))^2), s_k = 1.6^k, taps within
//           ceil(3 s_k/4) pixels, their weights normalized over those inside the picture.
//           The surround of one scale is the center of the next: alpha2 s_k = alpha1 s_(k+1).
//           V_k = (B_k - B_(k+1))/(2^phi key/s_k^2 + B_k); m is the last k up to which |V| < eps;
//           C' = C key/Lavg (1 + L1/white^2)/(1 + B_m).
// Differs   as printed, eq. 1 divides by N outside the exponential, and the kernels of eq. 5 sum to
//           1 only for large s; here both are as intended. If no scale passes, the first one is
//           used. The paper prints white for the global operator only.
// Check     python_check/local_operators.py
#include <algorithm>
#include <cmath>
#include <vector>

#include "local/operators.h"
#include "local/scene_luminance.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

constexpr double kDelta = 1e-3;
constexpr double kScaleRatio = 1.6;

/// A Gaussian along one axis, and the sums of its weights inside the picture.
struct Blur {
    int radius = 0;
    std::vector<float> weights;  // of distance 0, 1, ... radius
    std::vector<float> across;   // of each column: 1/(sum of the weights inside)
    std::vector<float> down;     // of each row
};

std::vector<float> renormalization(const std::vector<double>& weights, int size) {
    std::vector<float> factors;
    const int radius = static_cast<int>(weights.size()) - 1;
    factors.reserve(static_cast<std::size_t>(size));
    for (int i = 0; i < size; ++i) {
        if (i >= radius && i + radius < size) {
            factors.push_back(1);
            continue;
        }
        double inside = 0;
        for (int d = -radius; d <= radius; ++d) {
            if (i + d >= 0 && i + d < size)
                inside += weights[static_cast<std::size_t>(std::abs(d))];
        }
        factors.push_back(static_cast<float>(1 / inside));
    }
    return factors;
}

Blur make_blur(int k, int width, int height) {
    const double reach = std::pow(kScaleRatio, k) / (2 * std::sqrt(2.0));
    Blur blur;
    blur.radius = static_cast<int>(std::ceil(3 * reach / std::sqrt(2.0)));
    std::vector<double> weights;
    double sum = 0;
    for (int d = 0; d <= blur.radius; ++d) {
        weights.push_back(std::exp(-d * d / (reach * reach)));
        sum += d == 0 ? weights.back() : 2 * weights.back();
    }
    for (double& w : weights) {
        w /= sum;
        blur.weights.push_back(static_cast<float>(w));
    }
    blur.across = renormalization(weights, width);
    blur.down = renormalization(weights, height);
    return blur;
}

/// to[x] = sum over d of weights[|d|] tap(d)[x], for `count` columns, rounded up to a whole block.
/// The columns of a block stay in registers for all taps.
constexpr std::size_t kBlock = 16;
template <class Tap>
void convolve(const std::vector<float>& weights, const Tap& tap, std::size_t count, float* to) {
    const std::size_t taps = weights.size();
    for (std::size_t x = 0; x < count; x += kBlock) {
        std::array<float, kBlock> sum{};
        const float* center = tap(0) + x;
        for (std::size_t i = 0; i < kBlock; ++i)
            sum[i] = weights[0] * center[i];
        for (std::size_t d = 1; d < taps; ++d) {
            const auto distance = static_cast<std::ptrdiff_t>(d);
            const float* before = tap(-distance) + x;
            const float* after = tap(distance) + x;
            const float weight = weights[d];
            for (std::size_t i = 0; i < kBlock; ++i)
                sum[i] += weight * (before[i] + after[i]);
        }
        std::copy(sum.begin(), sum.end(), to + x);
    }
}

/// Scaled luminance with margins of zeros, which add nothing to the sums.
class PaddedPlane {
  public:
    PaddedPlane(const ScenePlanes& picture, const std::vector<float>& luminance, int margin)
        : height_(picture.height),
          margin_(static_cast<std::size_t>(margin)),
          stride_(2 * margin_ + static_cast<std::size_t>(picture.width) + kBlock),
          zeros_(stride_),
          pixels_(stride_ * static_cast<std::size_t>(picture.height)) {
        const auto width = static_cast<std::size_t>(picture.width);
        picture.for_rows(picture.height, [&](int begin, int end) {
            for (int y = begin; y < end; ++y) {
                std::copy_n(&luminance[index_of(picture, y)], width,
                            &pixels_[static_cast<std::size_t>(y) * stride_ + margin_]);
            }
        });
    }
    /// The pixel at `x`, down to x = -margin; any y.
    [[nodiscard]] const float* at(std::ptrdiff_t x, std::ptrdiff_t y) const {
        const float* row =
            y < 0 || y >= height_ ? zeros_.data() : &pixels_[static_cast<std::size_t>(y) * stride_];
        return row + margin_ + x;
    }

  private:
    std::ptrdiff_t height_;
    std::size_t margin_;
    std::size_t stride_;
    std::vector<float> zeros_;
    std::vector<float> pixels_;
};

/// Adaptation of each pixel of a row: the blurred luminance at its scale.
class Adaptation {
  public:
    /// Columns per strip, so that the surrounding rows stay in the second-level cache.
    static constexpr std::size_t kStrip = 1024;

    /// @param activity  2^phi key/s^2 per scale; one fewer than the blurs.
    Adaptation(const PaddedPlane& plane, const std::vector<Blur>& blurs,
               const std::vector<float>& activity, float threshold)
        : plane_(plane),
          blurs_(blurs),
          activity_(activity),
          threshold_(threshold),
          columns_(kStrip + 2 * static_cast<std::size_t>(blurs.back().radius) + 2 * kBlock) {}

    /// @param count  at most kStrip pixels
    /// @returns      as many values, until the next call
    const float* run(std::size_t x, int y, std::size_t count) {
        blur(blurs_[0], x, y, count, center_.data());
        std::copy_n(center_.begin(), count, chosen_.begin());
        std::fill_n(passes_.begin(), count, 1.0F);
        for (std::size_t k = 0; k < activity_.size(); ++k) {
            blur(blurs_[k + 1], x, y, count, surround_.data());
            float any = 0;
            for (std::size_t i = 0; i < count; ++i) {
                const float limit = threshold_ * (activity_[k] + center_[i]);
                passes_[i] = std::fabs(center_[i] - surround_[i]) < limit ? passes_[i] : 0.0F;
                chosen_[i] = passes_[i] != 0 ? center_[i] : chosen_[i];
                any = std::max(any, passes_[i]);
            }
            if (any == 0) break;
            std::swap(center_, surround_);
        }
        return chosen_.data();
    }

  private:
    void blur(const Blur& with, std::size_t x, int y, std::size_t count, float* to) {
        const std::ptrdiff_t radius = with.radius;
        const auto left = static_cast<std::ptrdiff_t>(x) - radius;
        convolve(
            with.weights, [&](std::ptrdiff_t d) { return plane_.at(left, y + d); },
            count + 2 * static_cast<std::size_t>(radius), columns_.data());
        convolve(
            with.weights, [&](std::ptrdiff_t d) { return columns_.data() + radius + d; }, count,
            to);
        const float down = with.down[static_cast<std::size_t>(y)];
        for (std::size_t i = 0; i < count; ++i)
            to[i] *= down * with.across[x + i];
    }

    const PaddedPlane& plane_;
    const std::vector<Blur>& blurs_;
    const std::vector<float>& activity_;
    float threshold_;
    std::vector<float> columns_;
    std::vector<float> center_ = std::vector<float>(kStrip);
    std::vector<float> surround_ = std::vector<float>(kStrip);
    std::vector<float> chosen_ = std::vector<float>(kStrip);
    std::vector<float> passes_ = std::vector<float>(kStrip);
};

void run(ScenePlanes& picture, const Params& p) {
    const double key = p.number("key");
    double average = p.number("log_average");
    std::vector<float> luminance = luminance_of(picture);
    if (average == 0) average = log_average(picture, luminance, kDelta);
    const auto scale = static_cast<float>(key / average * static_cast<double>(picture.exposure));
    for (float& l : luminance)
        l *= scale;

    const int scales = whole_number(p, "scales");
    std::vector<Blur> blurs;
    std::vector<float> activity;
    for (int k = 0; k <= scales; ++k) {
        blurs.push_back(make_blur(k, picture.width, picture.height));
        if (k < scales) {
            activity.push_back(static_cast<float>(std::exp2(p.number("sharpening")) * key /
                                                  std::pow(kScaleRatio, 2 * k)));
        }
    }
    const PaddedPlane plane(picture, luminance, blurs.back().radius);
    const auto threshold = static_cast<float>(p.number("threshold"));
    const double white = p.number("white");
    const auto white_factor = static_cast<float>(white > 0 ? 1 / (white * white) : 0);
    const auto width = static_cast<std::size_t>(picture.width);
    picture.for_rows(picture.height, [&](int begin, int end) {
        Adaptation adaptation(plane, blurs, activity, threshold);
        for (std::size_t x = 0; x < width; x += Adaptation::kStrip) {
            const std::size_t count = std::min(Adaptation::kStrip, width - x);
            for (int y = begin; y < end; ++y) {
                const float* adapted = adaptation.run(x, y, count);
                const std::size_t first = index_of(picture, y) + x;
                for (std::size_t i = 0; i < count; ++i) {
                    const float shown =
                        (1 + luminance[first + i] * white_factor) / (1 + adapted[i]) * scale;
                    for (std::vector<float>& channel : picture.rgb)
                        channel[first + i] *= shown;
                }
            }
        }
    });
}

}  // namespace

Operator define_reinhard_local() {
    Operator op;
    op.id = "reinhard_local";
    op.title = "Reinhard, dodging and burning";
    op.character =
        "Reinhard with one exposure per pixel, from its surroundings up to the next edge: "
        "highlights and shadows keep their local contrast; clips saturated highlights";
    op.source =
        "Reinhard, Stark, Shirley, Ferwerda, Photographic Tone Reproduction for Digital Images, "
        "SIGGRAPH 2002, eq. 1-9";
    op.license = "published formula";
    op.negatives = kLocalNegatives;
    op.dialects = "Reinhard";
    op.parameters = {
        number_parameter("key", "", 0.18, 0.001, 10,
                         "value of the log average before the curve: 0.045 for dark scenes, 0.72 "
                         "for bright ones"),
        number_parameter("log_average", "scene-linear", 0, 0, kHalfMax,
                         "log average luminance (0: measured in each picture); use one value for "
                         "all frames of a shot"),
        number_parameter("sharpening", "", 8, 0, 15,
                         "phi: larger values extend a pixel's surroundings in shadows"),
        number_parameter("threshold", "", 0.05, 0.001, 1,
                         "epsilon: contrast at which a pixel's surroundings end"),
        number_parameter("scales", "", 8, 1, 10,
                         "number of sizes of the surroundings, a whole number; from 1 pixel, each "
                         "1.6 times the one before"),
        number_parameter("white", "", 0, 0, kHalfMax,
                         "lowest luminance, times key/log_average, that a uniform picture shows as "
                         "display white (0: none)"),
    };
    op.warnings = {"keeps chromaticity, so a saturated channel may exceed 1 and clip",
                   "surroundings are measured in pixels: at twice the size, they cover less of the "
                   "picture"};
    op.build = [](const Params& p) -> Pipeline {
        check_whole_number(p, "scales");
        return {};
    };
    op.run_local = run;
    return op;
}

TONEWRIGHT_NAMESPACE_END
