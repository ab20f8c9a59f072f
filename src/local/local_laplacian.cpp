// SPDX-License-Identifier: Apache-2.0
//
// Local Laplacian filter: compresses the contrast of large differences and keeps that of small
// ones.
//
// Source    S. Paris, S. Hasinoff, J. Kautz, "Local Laplacian Filters: Edge-aware Image Processing
//           with a Laplacian Pyramid", SIGGRAPH 2011, and M. Aubry, S. Paris, S. Hasinoff, J.
//           Kautz, F. Durand, "Fast Local Laplacian Filters: Theory and Applications", ACM TOG
//           33(5), 2014. Pyramids: P. Burt, E. Adelson, 1983, with (1 4 6 4 1)/16.
// In        scene-linear planes of Rec.709, L = 0.2126 R + 0.7152 G + 0.0722 B.
// Out       display-linear Rec.709; half a percent of the pixels, and saturated channels, exceed 1.
// Formula   Y = log2 L, from 24 stops below the largest L on. References g from the smallest to the
//           largest Y, at most `threshold` apart; for each the picture g + r(Y - g),
//           r(d) = base d + (detail - base) d/sqrt(1 + (d/threshold)^2), and its Laplacian pyramid.
//           A coefficient of the result is that of the two references next to the Gaussian pyramid
//           of Y there, interpolated. The coarsest level is that of Y. The result's 99.5 %
//           percentile is shown as 1; where the 0.5 % percentile is more than `contrast` stops
//           below it, the result is scaled to that. C' = L' (1 + saturation (C/L - 1)).
// Differs   r is a smooth version of the paper's function, which is linear up to the threshold and
//           bends there, so references may be farther apart. Percentiles are of bins of 1/64 stop,
//           of pixels above 0.
// Check     python_check/local_operators.py
#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "local/operators.h"
#include "local/scene_luminance.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

constexpr float kStopsBelowLargest = 24;

/// A plane of a pyramid.
struct Plane {
    int width = 0;
    int height = 0;
    std::vector<float> pixels;

    Plane(int w, int h)
        : width(w), height(h), pixels(static_cast<std::size_t>(w) * static_cast<std::size_t>(h)) {}
    [[nodiscard]] float* row(int y) {
        return &pixels[static_cast<std::size_t>(y) * static_cast<std::size_t>(width)];
    }
    [[nodiscard]] const float* row(int y) const {
        return &pixels[static_cast<std::size_t>(y) * static_cast<std::size_t>(width)];
    }
};

/// Sizes of a pyramid: halved until one pixel is left.
std::vector<Plane> make_pyramid(int width, int height, bool with_finest) {
    std::vector<Plane> levels;
    levels.emplace_back(with_finest ? width : 0, with_finest ? height : 0);
    while (width > 1 || height > 1) {
        width = (width + 1) / 2;
        height = (height + 1) / 2;
        levels.emplace_back(width, height);
    }
    return levels;
}

/// Filters five rows with (1 4 6 4 1)/16, then every second column; clamped at the edges.
void reduce_row(const std::array<const float*, 5>& rows, int width, float* column_sums, float* to) {
    // Two more on each side repeat the edge.
    float* sums = column_sums + 2;
    for (int x = 0; x < width; ++x) {
        sums[x] = (rows[0][x] + rows[4][x]) + 4 * (rows[1][x] + rows[3][x]) + 6 * rows[2][x];
    }
    sums[-2] = sums[-1] = sums[0];
    sums[width] = sums[width + 1] = sums[width - 1];
    constexpr float kSum = 1.0F / 256;
    for (int x = 0; 2 * x < width; ++x) {
        const float* s = sums + static_cast<std::ptrdiff_t>(2) * x;
        to[x] = kSum * ((s[-2] + s[2]) + 4 * (s[-1] + s[1]) + 6 * s[0]);
    }
}

/// A row of the next finer size from the rows of a plane: (1 6 1)/8 at its positions, (4 4)/8
/// between them.
class Expansion {
  public:
    explicit Expansion(int width) : column_sums_(static_cast<std::size_t>(width) / 2 + 3) {}

    /// Chooses a row; the plane stays alive until the last expand().
    void begin_row(const Plane& coarse, int y) {
        const int k = y / 2;
        const float* here = coarse.row(k);
        const float* below = coarse.row(std::min(k + 1, coarse.height - 1));
        float* sums = column_sums_.data() + 1;
        if (y % 2 == 1) {
            for (int x = 0; x < coarse.width; ++x)
                sums[x] = 4 * (here[x] + below[x]);
        } else {
            const float* above = coarse.row(std::max(k - 1, 0));
            for (int x = 0; x < coarse.width; ++x)
                sums[x] = (above[x] + below[x]) + 6 * here[x];
        }
        sums[-1] = sums[0];
        sums[coarse.width] = sums[coarse.width - 1];
    }
    /// @param begin  even
    void expand(int begin, int end, float* to) const {
        constexpr float kSum = 1.0F / 64;
        const float* s = column_sums_.data() + 1 + begin / 2;
        const std::ptrdiff_t count = end - begin;
        for (std::ptrdiff_t i = 0; i < count / 2; ++i) {
            to[2 * i] = kSum * ((s[i - 1] + s[i + 1]) + 6 * s[i]);
            to[2 * i + 1] = kSum * 4 * (s[i] + s[i + 1]);
        }
        if (count % 2 == 1) {
            const std::ptrdiff_t i = count / 2;
            to[2 * i] = kSum * ((s[i - 1] + s[i + 1]) + 6 * s[i]);
        }
    }

  private:
    std::vector<float> column_sums_;  // and one more on either side
};

/// Remapping of a difference from the reference.
struct Remapping {
    float base;
    float extra;          // detail - base
    float per_threshold;  // 1/threshold

    void run(const float* from, float reference, int count, float* to) const {
        for (int i = 0; i < count; ++i) {
            const float d = from[i] - reference;
            const float t = d * per_threshold;
            to[i] = reference + d * (base + extra / std::sqrt(1 + t * t));
        }
    }
};

/// Minimum and maximum of each group of pixels in a row.
class Extents {
  public:
    static constexpr int kGroup = 64;
    Extents(const Plane& plane, const RowLoop& for_rows)
        : groups_(static_cast<std::size_t>((plane.width + kGroup - 1) / kGroup)),
          extents_(groups_ * static_cast<std::size_t>(plane.height)) {
        for_rows(plane.height, [&](int begin, int end) {
            for (int y = begin; y < end; ++y) {
                const float* row = plane.row(y);
                for (int x = 0; x < plane.width; x += kGroup) {
                    const auto [least, largest] =
                        std::minmax_element(row + x, row + std::min(x + kGroup, plane.width));
                    extents_[static_cast<std::size_t>(y) * groups_ +
                             static_cast<std::size_t>(x / kGroup)] = {*least, *largest};
                }
            }
        });
    }
    /// True if a value of the group at x is closer to `value` than `distance`.
    [[nodiscard]] bool has_near(int x, int y, float value, float distance) const {
        const Extent& e =
            extents_[static_cast<std::size_t>(y) * groups_ + static_cast<std::size_t>(x / kGroup)];
        return e.largest > value - distance && e.least < value + distance;
    }

  private:
    struct Extent {
        float least, largest;
    };
    std::size_t groups_;
    std::vector<Extent> extents_;
};

class LocalLaplacian {
  public:
    LocalLaplacian(Plane&& stops, const Remapping& remapping, float threshold,
                   const RowLoop& for_rows)
        : remapping_(remapping),
          for_rows_(for_rows),
          guide_(make_pyramid(stops.width, stops.height, false)),
          remapped_(make_pyramid(stops.width, stops.height, false)),
          result_(make_pyramid(stops.width, stops.height, true)) {
        const auto [least, largest] = std::minmax_element(stops.pixels.begin(), stops.pixels.end());
        const float least_stops = *least;
        const float range = *largest - least_stops;
        const int steps = static_cast<int>(std::ceil(range / threshold));
        const float step = steps > 0 ? range / static_cast<float>(steps) : 1;
        guide_[0] = std::move(stops);
        for (std::size_t k = 0; k + 1 < guide_.size(); ++k)
            reduce(guide_[k], guide_[k + 1]);
        for (const Plane& level : guide_)
            extents_.emplace_back(level, for_rows_);
        for (int i = 0; i <= steps; ++i)
            add_reference(least_stops + static_cast<float>(i) * step, step);
    }

    /// The result, in place of the pyramid.
    Plane collapse() {
        result_.back() = guide_.back();
        for (std::size_t k = result_.size() - 1; k-- > 0;) {
            for_rows_(result_[k].height, [&](int begin, int end) {
                Expansion expansion(result_[k].width);
                std::vector<float> row(static_cast<std::size_t>(result_[k].width));
                for (int y = begin; y < end; ++y) {
                    expansion.begin_row(result_[k + 1], y);
                    expansion.expand(0, result_[k].width, row.data());
                    float* to = result_[k].row(y);
                    for (std::size_t x = 0; x < row.size(); ++x)
                        to[x] += row[x];
                }
            });
        }
        return std::move(result_[0]);
    }

  private:
    void reduce(const Plane& from, Plane& to) {
        for_rows_(to.height, [&](int begin, int end) {
            std::vector<float> sums(static_cast<std::size_t>(from.width) + 4);
            for (int y = begin; y < end; ++y) {
                std::array<const float*, 5> rows{};
                for (int i = 0; i < 5; ++i) {
                    rows[static_cast<std::size_t>(i)] =
                        from.row(std::clamp(2 * y + i - 2, 0, from.height - 1));
                }
                reduce_row(rows, from.width, sums.data(), to.row(y));
            }
        });
    }

    /// First reduction of the remapped picture, which is not stored.
    void reduce_remapped(float reference) {
        const Plane& from = guide_[0];
        Plane& to = remapped_[1];
        const auto width = static_cast<std::size_t>(from.width);
        for_rows_(to.height, [&](int begin, int end) {
            constexpr int kKept = 8;  // a power of 2 above 5
            std::vector<float> kept(kKept * width);
            std::vector<float> sums(width + 4);
            int next = std::max(2 * begin - 2, 0);
            for (int y = begin; y < end; ++y) {
                for (; next <= std::min(2 * y + 2, from.height - 1); ++next) {
                    remapping_.run(from.row(next), reference, from.width,
                                   &kept[static_cast<std::size_t>(next % kKept) * width]);
                }
                std::array<const float*, 5> rows{};
                for (int i = 0; i < 5; ++i) {
                    const int row = std::clamp(2 * y + i - 2, 0, from.height - 1);
                    rows[static_cast<std::size_t>(i)] =
                        &kept[static_cast<std::size_t>(row % kKept) * width];
                }
                reduce_row(rows, from.width, sums.data(), to.row(y));
            }
        });
    }

    /// Adds the coefficients of one reference, weighted by how close each pixel is to it.
    void add_reference(float reference, float step) {
        if (guide_.size() == 1) return;
        reduce_remapped(reference);
        for (std::size_t k = 1; k + 1 < remapped_.size(); ++k)
            reduce(remapped_[k], remapped_[k + 1]);
        for (std::size_t k = 0; k + 1 < guide_.size(); ++k)
            add_level(k, reference, step);
    }

    void add_level(std::size_t k, float reference, float step) {
        const Plane& guide = guide_[k];
        for_rows_(guide.height, [&](int begin, int end) {
            Expansion expansion(guide.width);
            std::array<float, Extents::kGroup> own{};
            std::array<float, Extents::kGroup> blurred{};
            for (int y = begin; y < end; ++y) {
                bool is_expanded = false;
                for (int x = 0; x < guide.width; x += Extents::kGroup) {
                    if (!extents_[k].has_near(x, y, reference, step)) continue;
                    if (!is_expanded) expansion.begin_row(remapped_[k + 1], y);
                    is_expanded = true;
                    const int count = std::min(Extents::kGroup, guide.width - x);
                    const float* at = guide.row(y) + x;
                    if (k == 0) {
                        remapping_.run(at, reference, count, own.data());
                    } else {
                        std::copy_n(remapped_[k].row(y) + x, count, own.begin());
                    }
                    expansion.expand(x, x + count, blurred.data());
                    float* to = result_[k].row(y) + x;
                    for (int i = 0; i < count; ++i) {
                        const float near = 1 - std::fabs(at[i] - reference) / step;
                        const auto n = static_cast<std::size_t>(i);
                        to[i] += std::max(near, 0.0F) * (own[n] - blurred[n]);
                    }
                }
            }
        });
    }

    Remapping remapping_;
    const RowLoop& for_rows_;
    std::vector<Plane> guide_;     // Gaussian pyramid of the stops
    std::vector<Plane> remapped_;  // of one reference; its finest level is empty
    std::vector<Plane> result_;    // Laplacian pyramid
    std::vector<Extents> extents_;
};

/// Histogram with bins of 1/64 stop, identical for any number of threads.
class Histogram {
  public:
    void add(float stops) {
        const float bin = (stops + kStops) * kBinsPerStop;
        const float last = static_cast<float>(bins_.size() - 1);
        ++bins_[static_cast<std::size_t>(std::clamp(bin, 0.0F, last))];
    }
    void add(const Histogram& other) {
        for (std::size_t i = 0; i < bins_.size(); ++i)
            bins_[i] += other.bins_[i];
    }
    /// Middle of the bin of a percentile; 0 for an empty histogram.
    [[nodiscard]] float percentile(double part) const {
        double count = 0;
        for (const std::size_t bin : bins_)
            count += static_cast<double>(bin);
        if (count == 0) return 0;
        double sum = 0;
        std::size_t i = 0;
        for (; i + 1 < bins_.size(); ++i) {
            sum += static_cast<double>(bins_[i]);
            if (sum >= part * count) break;
        }
        return (static_cast<float>(i) + 0.5F) / kBinsPerStop - kStops;
    }

  private:
    static constexpr float kStops = 64;  // on either side of 0
    static constexpr float kBinsPerStop = 64;
    std::vector<std::size_t> bins_ = std::vector<std::size_t>(std::size_t{2} * 64 * 64);
};

/// Histogram of the measured pixels above 0.
Histogram histogram_of(const ScenePlanes& picture, const std::vector<float>& luminance,
                       const Plane& stops) {
    const bool all_count = std::none_of(picture.counts.begin(), picture.counts.end(),
                                        [](std::uint8_t counts) { return counts != 0; });
    constexpr int kParts = 16;
    std::vector<Histogram> parts(kParts);
    picture.for_rows(kParts, [&](int begin, int end) {
        for (int part = begin; part < end; ++part) {
            Histogram& histogram = parts[static_cast<std::size_t>(part)];
            const std::size_t first = luminance.size() * static_cast<std::size_t>(part) / kParts;
            const std::size_t last = luminance.size() * static_cast<std::size_t>(part + 1) / kParts;
            for (std::size_t i = first; i < last; ++i) {
                if (luminance[i] > 0 && (all_count || picture.counts[i] != 0))
                    histogram.add(stops.pixels[i]);
            }
        }
    });
    for (std::size_t i = 1; i < kParts; ++i)
        parts[0].add(parts[i]);
    return parts[0];
}

Plane stops_of(const ScenePlanes& picture, const std::vector<float>& luminance) {
    Plane stops(picture.width, picture.height);
    const float largest = *std::max_element(luminance.begin(), luminance.end());
    const float least =
        std::max(std::exp2(-kStopsBelowLargest) * largest, std::numeric_limits<float>::min());
    picture.for_rows(picture.height, [&](int begin, int end) {
        for (std::size_t i = index_of(picture, begin); i < index_of(picture, end); ++i)
            stops.pixels[i] = std::log2(std::max(luminance[i], least));
    });
    return stops;
}

void run(ScenePlanes& picture, const Params& p) {
    const std::vector<float> luminance = luminance_of(picture);
    const auto base = static_cast<float>(p.number("base"));
    const auto threshold = static_cast<float>(p.number("threshold"));
    const Remapping remapping = {base, static_cast<float>(p.number("detail")) - base,
                                 1 / threshold};
    const Plane stops =
        LocalLaplacian(stops_of(picture, luminance), remapping, threshold, picture.for_rows)
            .collapse();

    const Histogram histogram = histogram_of(picture, luminance, stops);
    const float white = histogram.percentile(0.995);
    const float range = white - histogram.percentile(0.005);
    const auto contrast = static_cast<float>(p.number("contrast"));
    const float slope = range > contrast ? contrast / range : 1;
    const float offset = std::log2(picture.exposure) - white;
    const auto saturation = static_cast<float>(p.number("saturation"));
    picture.for_rows(picture.height, [&](int begin, int end) {
        for (std::size_t i = index_of(picture, begin); i < index_of(picture, end); ++i) {
            const float shown = std::exp2(std::min(slope * (stops.pixels[i] + offset), 64.0F));
            const float gray = (1 - saturation) * luminance[i];
            // Divided first: 1/luminance may be infinite.
            for (std::vector<float>& channel : picture.rgb) {
                channel[i] =
                    luminance[i] > 0 ? (saturation * channel[i] + gray) / luminance[i] * shown : 0;
            }
        }
    });
}

}  // namespace

Operator define_local_laplacian() {
    Operator op;
    op.id = "local_laplacian";
    op.title = "Local Laplacian";
    op.character =
        "fits any scene into the display's range and keeps detail at the chosen contrast; loses "
        "absolute brightness, and lifts noise in blacks";
    op.source =
        "Paris, Hasinoff, Kautz, Local Laplacian Filters, SIGGRAPH 2011; Aubry, Paris, Hasinoff, "
        "Kautz, Durand, Fast Local Laplacian Filters, ACM TOG 33(5), 2014";
    op.license = "published formula";
    op.negatives = kLocalNegatives;
    op.parameters = {
        number_parameter(
            "contrast", "stops", 7.5, 1, 24,
            "largest contrast of the result, between its 0.5 % and 99.5 % percentiles"),
        number_parameter("base", "", 0.25, 0, 1, "slope of log luminance for large differences"),
        number_parameter("detail", "", 1, 0, 4, "slope of log luminance for small differences"),
        number_parameter("threshold", "stops", 1.3, 0.25, 8,
                         "smallest difference that counts as large"),
        number_parameter("saturation", "", 0.8, 0, 1,
                         "saturation at constant luminance (1: same chromaticity)"),
    };
    op.warnings = {
        "each picture has its own percentiles, so frames of a shot may differ in brightness"};
    op.build = [](const Params&) -> Pipeline { return {}; };
    op.run_local = run;
    return op;
}

TONEWRIGHT_NAMESPACE_END
