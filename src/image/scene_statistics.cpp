// SPDX-License-Identifier: Apache-2.0
//
// What operators ask of a whole picture.
//
// Every row is summed by itself, from left to right, and the rows from top to bottom: whichever
// threads they were on, the sums are the same to the last bit. Sums are compensated, so that a row
// of a million pixels loses nothing.
#include <OpenImageIO/imagebufalgo_util.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <memory>
#include <new>
#include <optional>
#include <vector>

#include "image/scene_meter.h"
#include "image/source_picture.h"
#include "tonewright/engine.h"
#include "tonewright/image.h"
#include "tonewright/view.h"

namespace tonewright {
namespace {

using OIIO::ImageBuf;
using OIIO::ROI;

/// A. Neumaier, "Rundungsfehleranalyse einiger Verfahren zur Summation endlicher Summen", ZAMM 54
/// (1974): the rounding errors are summed beside the sum.
class Sum {
  public:
    void add(double x) noexcept {
        const double sum = sum_ + x;
        lost_ += std::fabs(sum_) >= std::fabs(x) ? (sum_ - sum) + x : (x - sum) + sum_;
        sum_ = sum;
    }
    void add(const Sum& other) noexcept {
        add(other.sum_);
        add(other.lost_);
    }
    [[nodiscard]] double value() const noexcept { return sum_ + lost_; }

  private:
    double sum_ = 0;
    double lost_ = 0;
};

/// Of a row, or of all.
struct Measured {
    std::size_t count = 0;
    std::size_t lit_count = 0;  // L > 0
    Sum log_luminance;
    Sum luminance;
    std::array<Sum, 3> rgb;
    double minimum_lit = kInfinity;
    double maximum = 0;
    Vector3 maximum_rgb{};

    /// @param color  Rec.709, not negative
    void add(const Vector3& color) noexcept {
        ++count;
        double y = 0;
        for (std::size_t c = 0; c < 3; ++c) {
            y += kRec709Weights[c] * color[c];
            rgb[c].add(color[c]);
            maximum_rgb[c] = std::max(maximum_rgb[c], color[c]);
        }
        luminance.add(y);
        maximum = std::max(maximum, y);
        if (y > 0) {
            ++lit_count;
            log_luminance.add(std::log(y));
            minimum_lit = std::min(minimum_lit, y);
        }
    }

    void add(const Measured& other) noexcept {
        count += other.count;
        lit_count += other.lit_count;
        log_luminance.add(other.log_luminance);
        luminance.add(other.luminance);
        for (std::size_t c = 0; c < 3; ++c) {
            rgb[c].add(other.rgb[c]);
            maximum_rgb[c] = std::max(maximum_rgb[c], other.maximum_rgb[c]);
        }
        minimum_lit = std::min(minimum_lit, other.minimum_lit);
        maximum = std::max(maximum, other.maximum);
    }

    [[nodiscard]] SceneStatistics statistics() const {
        SceneStatistics s;
        if (lit_count == 0) return s;
        const auto n = static_cast<double>(count);
        s.log_average = std::exp(log_luminance.value() / static_cast<double>(lit_count));
        s.mean_luminance = luminance.value() / n;
        s.minimum_luminance = minimum_lit;
        s.maximum_luminance = maximum;
        s.mean_rgb = {rgb[0].value() / n, rgb[1].value() / n, rgb[2].value() / n};
        s.maximum_rgb = maximum_rgb;
        return s;
    }
};

/// How the color of a picture is read.
struct ColorSource {
    ChannelLayout layout;  // its alpha: -1 where alpha plays no part
    bool divides;
    Matrix3 to_rec709;
    std::optional<ReferenceEngine> decode;  // none: the picture is linear
};

/// Measures the rows of one thread's part of a picture.
class RowMeter {
  public:
    /// @throws std::bad_alloc
    RowMeter(const ImageBuf& picture, const ColorSource& color)
        : color_(color),
          reader_(picture),
          access_(*pixel_access(picture.spec().format)),
          size_(static_cast<std::ptrdiff_t>(picture.spec().format.size())),
          converts_(color.to_rec709 != kIdentity3) {}

    /// @returns  false when the picture could not be read.
    bool measure(int xbegin, int xend, int y, int z, Measured& row) {
        for (int x = xbegin; x < xend;) {
            const std::size_t n = std::min<std::size_t>(kSpan, static_cast<std::size_t>(xend - x));
            SpanSource source{nullptr, 0};
            if (!reader_.locate(x, y, z, n, source)) return false;
            measure_span(source, n, row);
            x += static_cast<int>(n);
        }
        return true;
    }

  private:
    void measure_span(const SpanSource& source, std::size_t n, Measured& row) noexcept {
        const int color_count = color_.layout.is_grey ? 1 : 3;
        for (int c = 0; c < color_count; ++c)
            load(source, c, planes_[static_cast<std::size_t>(c)], n);
        if (color_.layout.alpha >= 0) load(source, color_.layout.alpha, planes_[3], n);
        if (color_.layout.is_grey) planes_[1] = planes_[2] = planes_[0];
        if (color_.layout.alpha >= 0 && color_.divides) divide(n);
        if (color_.decode) {
            const std::array<double*, 3> rgb = {planes_[0].data(), planes_[1].data(),
                                                planes_[2].data()};
            color_.decode->run({rgb[0], rgb[1], rgb[2]}, rgb, n);
        }
        for (std::size_t i = 0; i < n; ++i) {
            if (color_.layout.alpha >= 0 && !covers(planes_[3][i])) continue;
            Vector3 rgb = {sanitise(planes_[0][i]), sanitise(planes_[1][i]),
                           sanitise(planes_[2][i])};
            if (converts_) rgb = multiply(color_.to_rec709, rgb);
            for (double& x : rgb)
                x = std::clamp(x, 0.0, kHalfMax);
            row.add(rgb);
        }
    }

    static bool covers(double alpha) noexcept { return alpha != 0 && std::isfinite(alpha); }

    void divide(std::size_t n) noexcept {
        for (std::size_t c = 0; c < 3; ++c) {
            for (std::size_t i = 0; i < n; ++i) {
                if (covers(planes_[3][i])) planes_[c][i] /= planes_[3][i];
            }
        }
    }

    void load(const SpanSource& source, int channel, std::array<double, kSpan>& to,
              std::size_t n) const noexcept {
        access_.load_double(source.pixels + channel * size_, source.stride, to.data(), n);
    }

    const ColorSource& color_;
    SpanReader reader_;
    const PixelAccess& access_;
    std::ptrdiff_t size_;
    bool converts_;
    std::array<std::array<double, kSpan>, 4> planes_{};  // r, g, b, alpha
};

}  // namespace

struct SceneMeter::State {
    ColorSource color;
    int nthreads;
    Measured all;
};

SceneMeter::SceneMeter(const OIIO::ImageSpec& spec, std::string_view input,
                       TonemapOptions::Unpremult unpremult, Cover cover, int nthreads)
    : state_(std::make_unique<State>()) {
    const SourceColor source = source_color(spec, input);
    state_->color = {channel_layout(spec), divides_by_alpha(spec, unpremult),
                     rgb_to_rgb(source.primaries, kRec709), std::nullopt};
    if (!source.decode.empty()) state_->color.decode.emplace(source.decode);
    if (unpremult == TonemapOptions::Unpremult::no || cover == Cover::ignored)
        state_->color.layout.alpha = -1;
    state_->nthreads = nthreads;
}

SceneMeter::~SceneMeter() = default;

void SceneMeter::add(const ImageBuf& picture, const ROI& roi) {
    std::vector<Measured> rows(static_cast<std::size_t>(roi.height()) *
                               static_cast<std::size_t>(roi.depth()));
    std::atomic<bool> unreadable = false;
    std::atomic<bool> out_of_memory = false;
    // Split between rows, never within one.
    const OIIO::paropt threads(state_->nthreads, OIIO::paropt::SplitDir::Y);
    OIIO::ImageBufAlgo::parallel_image(roi, threads, [&](ROI part) {
        // No exception may leave a thread of OIIO's pool.
        try {
            const auto meter = std::make_unique<RowMeter>(picture, state_->color);
            for (int z = part.zbegin; z < part.zend; ++z) {
                for (int y = part.ybegin; y < part.yend; ++y) {
                    const auto row = static_cast<std::size_t>(z - roi.zbegin) *
                                         static_cast<std::size_t>(roi.height()) +
                                     static_cast<std::size_t>(y - roi.ybegin);
                    if (!meter->measure(part.xbegin, part.xend, y, z, rows[row])) unreadable = true;
                }
            }
        } catch (const std::bad_alloc&) {
            out_of_memory = true;
        }
    });
    if (out_of_memory) throw std::bad_alloc();
    check_was_read(picture, !unreadable);
    for (const Measured& row : rows)
        state_->all.add(row);
}

bool SceneMeter::has_cover() const { return state_->all.count > 0; }

SceneStatistics SceneMeter::statistics() const { return state_->all.statistics(); }

SceneStatistics measure_scene(const ImageBuf& src, std::string_view input,
                              TonemapOptions::Unpremult unpremult, ROI roi, int nthreads) {
    (void)source_color({}, input);  // a wrong name is told before a picture is opened
    check_source(src);
    const ROI window = roi.defined() ? OIIO::roi_intersection(roi, src.roi()) : src.roi();
    if (window.width() <= 0 || window.height() <= 0 || window.depth() <= 0) return {};
    for (const SceneMeter::Cover cover : SceneMeter::kTries) {
        SceneMeter meter(src.spec(), input, unpremult, cover, nthreads);
        meter.add(src, window);
        if (meter.has_cover()) return meter.statistics();
    }
    return {};
}

}  // namespace tonewright
