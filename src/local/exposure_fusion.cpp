// SPDX-License-Identifier: Apache-2.0
//
// Exposure fusion of one picture.
//
// Source    B. Wronski, "Exposure Fusion - local tonemapping for real-time rendering", 2022, and
//           its demo; weights after T. Mertens, J. Kautz, F. Van Reeth, "Exposure Fusion", Pacific
//           Graphics 2007; guided upsampling after K. He, J. Sun, "Fast Guided Filter", 2015.
// In        scene-linear planes of Rec.709.
// Out       display-linear Rec.709, [0, 1]: the curve is Hill's ACES fit as three.js has it
//           (aces_hill:threejs), whose clamp is part of it.
// Formula   Three exposures c = exposure {2^-highlights, 1, 2^shadows} rgb, each tone mapped; their
//           lightness e = sqrt(0.1 R + 0.7 G + 0.2 B); weights exp(-(e - 0.5)^2 sigma^2/2), divided
//           by their sum. Both in pyramids by bilinear sampling, whose levels are at least two
//           pixels wide and high. From the level `mip` up to `display_mip`, the weights of each
//           level sum the Laplacian of e. A linear model of the middle exposure's lightness in 3 x
//           3 samples upsamples the result; the quotient of new and old lightness scales the scene
//           value before the curve.
// Differs   the demo encodes with a square root; here the display encodes. With shadows =
//           highlights = 0 there is one exposure, and only the curve is applied; the demo's
//           epsilons change near-black by up to 6 %.
// Check     python_check/local_operators.py
#include <algorithm>
#include <cmath>
#include <vector>

#include "local/operators.h"
#include "local/scene_luminance.h"
#include "tonewright/engine.h"

TONEWRIGHT_NAMESPACE_BEGIN

std::vector<Operator> define_aces_fits();  // operators/aces_fits.cpp

namespace {

constexpr Vector3 kLightness = {0.1, 0.7, 0.2};

/// Position of a sample between two texels of an axis.
struct Sample {
    std::size_t before;
    std::size_t after;
    float fraction;
};

/// @param texel  position in texels, with the first center at 0; clamped at the edges.
Sample sample_at(double texel, int size) {
    const double floor = std::floor(texel);
    const auto clamped = [&](double i) {
        return static_cast<std::size_t>(std::clamp(i, 0.0, static_cast<double>(size - 1)));
    };
    return {clamped(floor), clamped(floor + 1), static_cast<float>(texel - floor)};
}

/// The centers of `count` pixels, moved by `shift` texels of `size` of them.
std::vector<Sample> samples_of(int count, int size, int shift = 0) {
    std::vector<Sample> samples;
    samples.reserve(static_cast<std::size_t>(count));
    for (int i = 0; i < count; ++i)
        samples.push_back(sample_at((i + 0.5) / count * size - 0.5 + shift, size));
    return samples;
}

float mix(float a, float b, float t) { return a + t * (b - a); }

/// Planes of one size: three of lightness and three of weights, or one.
struct Level {
    int width = 0;
    int height = 0;
    std::vector<std::vector<float>> planes;

    Level(int w, int h, std::size_t count)
        : width(w),
          height(h),
          planes(count,
                 std::vector<float>(static_cast<std::size_t>(w) * static_cast<std::size_t>(h))) {}
    [[nodiscard]] float* row(std::size_t plane, std::size_t y) {
        return &planes[plane][y * static_cast<std::size_t>(width)];
    }
    [[nodiscard]] const float* row(std::size_t plane, std::size_t y) const {
        return &planes[plane][y * static_cast<std::size_t>(width)];
    }
};

void resample_row(const float* above, const float* below, float fraction,
                  const std::vector<Sample>& across, float* to) {
    for (std::size_t x = 0; x < across.size(); ++x) {
        const Sample& s = across[x];
        to[x] = mix(mix(above[s.before], above[s.after], s.fraction),
                    mix(below[s.before], below[s.after], s.fraction), fraction);
    }
}

constexpr std::size_t kExposures = 3;
constexpr std::size_t kMiddle = 1;

/// `aces_hill:threejs`, the source's tone curve.
Pipeline tone_curve() {
    const std::vector<Operator> family = define_aces_fits();
    const auto op = std::find_if(family.begin(), family.end(),
                                 [](const Operator& o) { return o.id == "aces_hill"; });
    return resolve(*op, &find_preset(*op, "threejs"), {}, "").build();
}

/// The tone curve at an exposure.
SimdEngine engine_of(double gain) {
    Pipeline stages = {MatrixStage{scale(kIdentity3, gain)}, ClampStage{-kHalfMax, kHalfMax, true}};
    for (const Stage& stage : tone_curve())
        stages.push_back(stage);
    return SimdEngine(stages);
}

class Fusion {
  public:
    Fusion(ScenePlanes& picture, const Params& p)
        : picture_(picture),
          width_(static_cast<std::size_t>(picture.width)),
          gain_(p.number("exposure") * static_cast<double>(picture.exposure)),
          engines_{engine_of(gain_ * std::exp2(-p.number("highlights"))), engine_of(gain_),
                   engine_of(gain_ * std::exp2(p.number("shadows")))},
          sharpness_(static_cast<float>(-0.5 * p.number("sigma") * p.number("sigma"))),
          boosts_(p.choice("boost_local_contrast") == "yes"),
          is_plain_(p.number("shadows") == 0 && p.number("highlights") == 0) {
        int last = 0;
        for (int w = picture.width / 2, h = picture.height / 2; w > 1 && h > 1; w /= 2, h /= 2)
            ++last;
        mip_ = std::min(whole_number(p, "mip"), last);
        display_mip_ = std::min(whole_number(p, "display_mip"), mip_);
    }

    void run() {
        if (is_plain_) {
            picture_.for_rows(picture_.height, [&](int begin, int end) {
                for (int y = begin; y < end; ++y)
                    tone_map(kMiddle, y, rgb_at(y));
            });
            return;
        }
        std::vector<Level> levels;  // from display_mip on
        levels.push_back(display_mip_ == 0 ? full_size() : first_level());
        for (int k = display_mip_ == 0 ? 0 : 1; k < display_mip_; ++k)
            levels.back() = half_of(levels.back());
        for (int k = display_mip_; k < mip_; ++k)
            levels.push_back(half_of(levels.back()));
        upsample(levels.front(), fuse(levels));
    }

  private:
    [[nodiscard]] std::array<float*, 3> rgb_at(int y) {
        const std::size_t first = index_of(picture_, y);
        return {&picture_.rgb[0][first], &picture_.rgb[1][first], &picture_.rgb[2][first]};
    }

    void tone_map(std::size_t exposure, int y, const std::array<float*, 3>& to) {
        const auto [r, g, b] = rgb_at(y);
        engines_[exposure].run({r, g, b}, 1, to, 1, width_);
    }

    /// Buffers of a row.
    struct Row {
        explicit Row(std::size_t width, std::size_t count)
            : planes(count, std::vector<float>(width)) {}
        [[nodiscard]] std::array<float*, 3> rgb() {
            return {planes[0].data(), planes[1].data(), planes[2].data()};
        }
        std::vector<std::vector<float>> planes;
    };

    /// Lightness and weights of the three exposures of a row of the picture.
    void expose(int y, Row& rgb, const std::array<float*, 2 * kExposures>& to) {
        const auto [r_weight, g_weight, b_weight] = lightness_weights();
        for (std::size_t i = 0; i < kExposures; ++i) {
            const std::array<float*, 3> c = rgb.rgb();
            tone_map(i, y, c);
            for (std::size_t x = 0; x < width_; ++x)
                to[i][x] = std::sqrt(r_weight * c[0][x] + g_weight * c[1][x] + b_weight * c[2][x]);
        }
        for (std::size_t x = 0; x < width_; ++x) {
            std::array<float, kExposures> w{};
            float sum = 1e-5F;
            for (std::size_t i = 0; i < kExposures; ++i) {
                const float off = to[i][x] - 0.5F;
                w[i] = std::exp(sharpness_ * off * off);
                sum += w[i];
            }
            for (std::size_t i = 0; i < kExposures; ++i)
                to[kExposures + i][x] = w[i] / sum;
        }
    }

    [[nodiscard]] static std::array<float, 3> lightness_weights() {
        return {static_cast<float>(kLightness[0]), static_cast<float>(kLightness[1]),
                static_cast<float>(kLightness[2])};
    }

    Level full_size() {
        Level level(picture_.width, picture_.height, 2 * kExposures);
        picture_.for_rows(picture_.height, [&](int begin, int end) {
            Row rgb(width_, 3);
            for (int y = begin; y < end; ++y) {
                std::array<float*, 2 * kExposures> to{};
                for (std::size_t i = 0; i < to.size(); ++i)
                    to[i] = level.row(i, static_cast<std::size_t>(y));
                expose(y, rgb, to);
            }
        });
        return level;
    }

    /// Half the size of full_size(), which is not stored.
    Level first_level() {
        Level level(picture_.width / 2, picture_.height / 2, 2 * kExposures);
        const std::vector<Sample> across = samples_of(level.width, picture_.width);
        const std::vector<Sample> down = samples_of(level.height, picture_.height);
        picture_.for_rows(level.height, [&](int begin, int end) {
            Row rgb(width_, 3);
            std::array<Row, 2> rows = {Row(width_, 2 * kExposures), Row(width_, 2 * kExposures)};
            for (auto y = static_cast<std::size_t>(begin); y < static_cast<std::size_t>(end); ++y) {
                const std::array<std::size_t, 2> from = {down[y].before, down[y].after};
                for (std::size_t n = 0; n < 2; ++n) {
                    std::array<float*, 2 * kExposures> to{};
                    for (std::size_t i = 0; i < to.size(); ++i)
                        to[i] = rows[n].planes[i].data();
                    expose(static_cast<int>(from[n]), rgb, to);
                }
                for (std::size_t i = 0; i < level.planes.size(); ++i) {
                    resample_row(rows[0].planes[i].data(), rows[1].planes[i].data(),
                                 down[y].fraction, across, level.row(i, y));
                }
            }
        });
        return level;
    }

    Level half_of(const Level& level) { return resample(level, level.width / 2, level.height / 2); }

    Level resample(const Level& level, int width, int height) {
        Level to(width, height, level.planes.size());
        const std::vector<Sample> across = samples_of(width, level.width);
        const std::vector<Sample> down = samples_of(height, level.height);
        picture_.for_rows(height, [&](int begin, int end) {
            for (auto y = static_cast<std::size_t>(begin); y < static_cast<std::size_t>(end); ++y) {
                for (std::size_t i = 0; i < to.planes.size(); ++i) {
                    resample_row(level.row(i, down[y].before), level.row(i, down[y].after),
                                 down[y].fraction, across, to.row(i, y));
                }
            }
        });
        return to;
    }

    /// The pyramid of the fused lightness, collapsed to its finest level.
    Level fuse(const std::vector<Level>& levels) {
        const Level& coarsest = levels.back();
        Level fused(coarsest.width, coarsest.height, 1);
        for (std::size_t i = 0; i < fused.planes[0].size(); ++i) {
            float sum = 0;
            float weight = 1e-4F;
            for (std::size_t n = 0; n < kExposures; ++n) {
                sum += coarsest.planes[n][i] * coarsest.planes[kExposures + n][i];
                weight += coarsest.planes[kExposures + n][i];
            }
            fused.planes[0][i] = sum / weight;
        }
        for (std::size_t k = levels.size() - 1; k-- > 0;)
            fused = add_laplacian(levels[k], levels[k + 1], fused);
        return fused;
    }

    Level add_laplacian(const Level& level, const Level& coarser, const Level& fused) {
        Level to = resample(fused, level.width, level.height);
        const std::vector<Sample> across = samples_of(level.width, coarser.width);
        const std::vector<Sample> down = samples_of(level.height, coarser.height);
        picture_.for_rows(level.height, [&](int begin, int end) {
            Row blurred(across.size(), kExposures);
            for (auto y = static_cast<std::size_t>(begin); y < static_cast<std::size_t>(end); ++y) {
                for (std::size_t n = 0; n < kExposures; ++n) {
                    resample_row(coarser.row(n, down[y].before), coarser.row(n, down[y].after),
                                 down[y].fraction, across, blurred.planes[n].data());
                }
                float* out = to.row(0, y);
                for (std::size_t x = 0; x < across.size(); ++x) {
                    float sum = 0;
                    float weight = 1e-5F;
                    for (std::size_t n = 0; n < kExposures; ++n) {
                        const float laplacian = level.row(n, y)[x] - blurred.planes[n][x];
                        float q = level.row(kExposures + n, y)[x];
                        if (boosts_) q *= std::fabs(laplacian) + 1e-5F;
                        sum += q * laplacian;
                        weight += q;
                    }
                    out[x] += sum / weight;
                }
            }
        });
        return to;
    }

    /// Rows of a level at the picture's width: guide and fused lightness, at one texel to the left,
    /// here, and one to the right. Caches the last few.
    class WideRows {
      public:
        WideRows(const Level& guide, const Level& fused, std::size_t width)
            : guide_(guide), fused_(fused), rows_(kKept, Row(width, 6)) {
            for (std::size_t i = 0; i < 3; ++i) {
                across_[i] =
                    samples_of(static_cast<int>(width), guide.width, static_cast<int>(i) - 1);
            }
            kept_.fill(static_cast<std::size_t>(-1));
        }
        /// Guide at the three shifts, then fused lightness at the three shifts.
        const Row& at(std::size_t y) {
            Row& row = rows_[y % kKept];
            if (kept_[y % kKept] == y) return row;
            kept_[y % kKept] = y;
            for (std::size_t shift = 0; shift < 3; ++shift) {
                widen(guide_.row(kMiddle, y), across_[shift], row.planes[shift]);
                widen(fused_.row(0, y), across_[shift], row.planes[3 + shift]);
            }
            return row;
        }

      private:
        static void widen(const float* from, const std::vector<Sample>& across,
                          std::vector<float>& to) {
            for (std::size_t x = 0; x < across.size(); ++x)
                to[x] = mix(from[across[x].before], from[across[x].after], across[x].fraction);
        }
        static constexpr std::size_t kKept = 4;  // rows that one row of the picture lies between
        const Level& guide_;
        const Level& fused_;
        std::array<std::vector<Sample>, 3> across_;
        std::vector<Row> rows_;
        std::array<std::size_t, kKept> kept_{};
    };

    /// Applies the fused lightness at full size to the picture.
    void upsample(const Level& guide, const Level& fused) {
        std::array<std::vector<Sample>, 3> down;
        for (std::size_t i = 0; i < 3; ++i)
            down[i] = samples_of(picture_.height, guide.height, static_cast<int>(i) - 1);
        const auto weight_of = [](int i) {
            const int dx = i % 3 - 1;
            const int dy = i / 3 - 1;
            return std::exp(-0.5 * (dx * dx + dy * dy) / 0.49);
        };
        double sum = 0;
        for (int i = 0; i < 9; ++i)
            sum += weight_of(i);
        std::array<float, 9> weights{};
        for (int i = 0; i < 9; ++i)
            weights[static_cast<std::size_t>(i)] = static_cast<float>(weight_of(i) / sum);
        picture_.for_rows(picture_.height, [&](int begin, int end) {
            WideRows wide(guide, fused, width_);
            Row rgb(width_, 3);
            Row model(width_, 6);  // guide and fused lightness here; sums of their differences
            for (int y = begin; y < end; ++y) {
                fit(wide, down, static_cast<std::size_t>(y), weights, model);
                tone_map(kMiddle, y, rgb.rgb());
                apply(model, rgb, rgb_at(y));
                tone_map(kMiddle, y, rgb_at(y));
            }
        });
    }

    /// Sums over the nine samples of differences from the middle one, to avoid cancellation.
    void fit(WideRows& wide, const std::array<std::vector<Sample>, 3>& down, std::size_t y,
             const std::array<float, 9>& weights, Row& model) const {
        {
            const Sample& s = down[1][y];
            const Row& above = wide.at(s.before);
            const Row& below = wide.at(s.after);
            for (std::size_t x = 0; x < width_; ++x) {
                model.planes[0][x] = mix(above.planes[1][x], below.planes[1][x], s.fraction);
                model.planes[1][x] = mix(above.planes[4][x], below.planes[4][x], s.fraction);
            }
        }
        for (std::size_t i = 2; i < 6; ++i)
            std::fill(model.planes[i].begin(), model.planes[i].end(), 0.0F);
        const float* here = model.planes[0].data();
        const float* fused_here = model.planes[1].data();
        for (std::size_t dy = 0; dy < 3; ++dy) {
            const Sample& s = down[dy][y];
            const Row& above = wide.at(s.before);
            const Row& below = wide.at(s.after);
            for (std::size_t dx = 0; dx < 3; ++dx) {
                const float w = weights[3 * dy + dx];
                const float* guide_above = above.planes[dx].data();
                const float* guide_below = below.planes[dx].data();
                const float* fused_above = above.planes[3 + dx].data();
                const float* fused_below = below.planes[3 + dx].data();
                for (std::size_t x = 0; x < width_; ++x) {
                    const float a = mix(guide_above[x], guide_below[x], s.fraction) - here[x];
                    const float b = mix(fused_above[x], fused_below[x], s.fraction) - fused_here[x];
                    model.planes[2][x] += w * a;
                    model.planes[3][x] += w * b;
                    model.planes[4][x] += w * a * a;
                    model.planes[5][x] += w * a * b;
                }
            }
        }
    }

    /// Scales the color by the quotient of fused and own lightness.
    void apply(const Row& model, const Row& shown, const std::array<float*, 3>& light) const {
        const auto [r_weight, g_weight, b_weight] = lightness_weights();
        for (std::size_t x = 0; x < width_; ++x) {
            const float a = model.planes[2][x];
            const float b = model.planes[3][x];
            const float variance = std::max(model.planes[4][x] - a * a, 0.0F);
            const float slope = (model.planes[5][x] - a * b) / (variance + 1e-5F);
            const float lightness = r_weight * std::sqrt(shown.planes[0][x]) +
                                    g_weight * std::sqrt(shown.planes[1][x]) +
                                    b_weight * std::sqrt(shown.planes[2][x]) + 1e-5F;
            const float fused =
                model.planes[1][x] + b + slope * (lightness - (model.planes[0][x] + a));
            float factor = std::max(fused, 0.0F) / lightness;
            constexpr float kDark = 0.007F;
            const float dark = std::min(lightness / kDark, 1.0F);
            factor = lightness < kDark ? mix(1, factor, dark * dark) : factor;
            for (float* channel : light)
                channel[x] *= factor;
        }
    }

    ScenePlanes& picture_;
    std::size_t width_;
    double gain_;
    std::array<SimdEngine, kExposures> engines_;
    float sharpness_;
    bool boosts_;
    bool is_plain_;
    int mip_ = 0;
    int display_mip_ = 0;
};

void run(ScenePlanes& picture, const Params& p) { Fusion(picture, p).run(); }

}  // namespace

Operator define_exposure_fusion() {
    Operator op;
    op.id = "exposure_fusion";
    op.title = "Exposure fusion";
    op.character =
        "shows shadows and highlights each at a suitable exposure, like merged bracketed "
        "photographs; loses the contrast of large areas first";
    op.source =
        "Wronski, Exposure Fusion - local tonemapping for real-time rendering, 2022; Mertens, "
        "Kautz, Van Reeth, Exposure Fusion, Pacific Graphics 2007; curve: Hill's ACES fit";
    op.license = "MIT";
    op.negatives = kLocalNegatives;
    op.parameters = {
        number_parameter("exposure", "", 0.7, 0.001, 1000,
                         "factor on the scene value before the curve"),
        number_parameter("shadows", "stops", 1.5, 0, 8,
                         "stops of the brighter exposure, for shadows"),
        number_parameter("highlights", "stops", 2, 0, 8,
                         "stops of the darker exposure, for highlights"),
        number_parameter("sigma", "", 5, 0, 20,
                         "how strongly the weight of an exposure prefers middle grays"),
        number_parameter("mip", "", 6, 0, 12,
                         "coarsest pyramid level, a whole number; larger values blend exposures "
                         "over larger areas"),
        number_parameter(
            "display_mip", "", 2, 0, 12,
            "finest pyramid level that is fused, a whole number; the picture guides finer levels"),
        choice_parameter("boost_local_contrast", {"no", "yes"}, "no",
                         "also weight exposures by local contrast"),
    };
    op.warnings = {
        "each pyramid level halves the picture: at twice the size, the same result needs mip one "
        "higher"};
    op.build = [](const Params& p) -> Pipeline {
        check_whole_number(p, "mip");
        check_whole_number(p, "display_mip");
        return {};
    };
    op.run_local = run;
    return op;
}

TONEWRIGHT_NAMESPACE_END
