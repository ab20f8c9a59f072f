// SPDX-License-Identifier: Apache-2.0
//
// One pass for the statistics of operators and for metering.
//
// Each row is summed from left to right, and then the rows from top to bottom, so threads change no
// bit of the sums. Sums are compensated, so that a row of a million pixels loses no precision.
// Pixels that do not count, or that only statistics count, are rare. They are removed from a span
// before the vector code runs.
#include "image/scene_meter.h"

#include <OpenImageIO/imagebufalgo_util.h>

#include <algorithm>
#include <atomic>
#include <bit>
#include <cmath>
#include <mutex>
#include <new>
#include <numeric>
#include <optional>
#include <tuple>
#include <utility>
#include <vector>

#include "image/metering_kernels.h"
#include "image/source_picture.h"
#include "image/spec_conversion.h"
#include "picture/picture_description.h"
#include "picture/pixel_access.h"
#include "picture/source_pixels.h"
#include "tonewright/engine.h"
#include "tonewright/tonemap.h"
#include "tonewright/view.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

using OIIO::ImageBuf;
using OIIO::ROI;

/// A. Neumaier, "Rundungsfehleranalyse einiger Verfahren zur Summation endlicher Summen", ZAMM 54
/// (1974): rounding errors are summed separately.
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

/// A sum of logarithms.
class LogSum {
  public:
    void add(const light::Product& product) noexcept {
        exponent_ += product.exponent;
        mantissa_.add(std::log(product.mantissa));
    }
    void add(const LogSum& other) noexcept {
        exponent_ += other.exponent_;
        mantissa_.add(other.mantissa_);
    }
    /// exp of the mean of `count` terms.
    [[nodiscard]] double geometric_mean(std::uint64_t count) const noexcept {
        constexpr double kLn2 = 0.693147180559945309417;
        const auto n = static_cast<double>(count);
        return std::exp((static_cast<double>(exponent_) * kLn2 + mantissa_.value()) / n);
    }

  private:
    std::int64_t exponent_ = 0;
    Sum mantissa_;
};

/// The light of a set of pixels.
struct Light {
    std::uint64_t count = 0;
    std::uint64_t lit_count = 0;  // L > 0
    LogSum log_lit;
    LogSum log_with_delta;
    std::array<Sum, 3> rgb;
    double minimum_lit = kInfinity;
    double maximum = 0;
    Vector3 maximum_rgb{};

    void add(const light::SpanLight& span, std::size_t n) noexcept {
        count += n;
        lit_count += span.lit_count;
        log_lit.add(span.lit);
        log_with_delta.add(span.with_delta);
        for (std::size_t c = 0; c < 3; ++c) {
            rgb[c].add(span.rgb[c].sum);
            rgb[c].add(span.rgb[c].lost);
            maximum_rgb[c] = std::max(maximum_rgb[c], span.maximum_rgb[c]);
        }
        minimum_lit = std::min(minimum_lit, span.minimum_lit);
        maximum = std::max(maximum, span.maximum);
    }

    void add(const Light& other) noexcept {
        count += other.count;
        lit_count += other.lit_count;
        log_lit.add(other.log_lit);
        log_with_delta.add(other.log_with_delta);
        for (std::size_t c = 0; c < 3; ++c) {
            rgb[c].add(other.rgb[c]);
            maximum_rgb[c] = std::max(maximum_rgb[c], other.maximum_rgb[c]);
        }
        minimum_lit = std::min(minimum_lit, other.minimum_lit);
        maximum = std::max(maximum, other.maximum);
    }

    /// The mean of luminances is the luminance of the mean color.
    [[nodiscard]] double mean_luminance() const noexcept {
        Sum sum;
        for (std::size_t c = 0; c < 3; ++c)
            sum.add(kRec709Weights[c] * rgb[c].value());
        return sum.value() / static_cast<double>(count);
    }

    [[nodiscard]] SceneStatistics statistics() const noexcept {
        SceneStatistics s;
        if (lit_count == 0) return s;
        const auto n = static_cast<double>(count);
        s.log_average = log_lit.geometric_mean(lit_count);
        s.mean_luminance = mean_luminance();
        s.minimum_luminance = minimum_lit;
        s.maximum_luminance = maximum;
        s.mean_rgb = {rgb[0].value() / n, rgb[1].value() / n, rgb[2].value() / n};
        s.maximum_rgb = maximum_rgb;
        return s;
    }
};

/// Figures of one row, or of all rows.
struct Measured {
    Light finite;
    Light limited;  // pixels with NaN or infinities, which only statistics count
    std::uint64_t nan = 0;
    std::uint64_t infinite = 0;
    std::uint64_t uncovered = 0;
    std::vector<double> kept;  // luminances that are not black, where percentiles are exact

    void add(const Measured& other) {
        finite.add(other.finite);
        limited.add(other.limited);
        nan += other.nan;
        infinite += other.infinite;
        uncovered += other.uncovered;
        kept.insert(kept.end(), other.kept.begin(), other.kept.end());
    }
};

/// A histogram that grows leaves at most this share of the pixels beyond either end.
constexpr double kShareBeyond = 5e-4;
/// Luminances below are black to the histogram.
constexpr double kHistogramBlack = 1e-6;

/// The places of bins: bin i > 0 begins at log2 L = at(i), and bin 0 is black. Bins of the options
/// are 1 to bins - 1, the last of which has all that is brighter. A histogram that grows has
/// further ones, at 0 and below and at bins and above.
struct BinScale {
    double minimum;
    double range;
    int steps;  // bins of the range

    explicit BinScale(const MeterOptions& options)
        : minimum(options.histogram_min),
          range(options.histogram_max - options.histogram_min),
          steps(options.bins - 2) {}

    [[nodiscard]] double at(double bin) const { return minimum + range * (bin - 1) / steps; }
    /// The lowest and the last bin of a histogram that grows: from black to the largest float.
    [[nodiscard]] std::pair<int, int> widest() const {
        const double per_stop = steps / range;
        const double below = (minimum - std::log2(kHistogramBlack)) * per_stop;
        const double above = (kMostStops - minimum) * per_stop;
        return {std::min(1, 1 - static_cast<int>(std::clamp(below, 0.0, kMostBins))),
                std::max(steps + 1, 1 + static_cast<int>(std::clamp(above, 0.0, kMostBins)))};
    }

  private:
    static constexpr double kMostStops = 128;
    /// At either end, so that numbers of bins have 16 bits.
    static constexpr double kMostBins = 30'000;
};

/// The bins of a histogram, without logarithms: a table by exponent and first digits, and the next
/// edge if one is within such a step.
class Bins {
  public:
    /// Several counters for each bin: neighbors are often in the same bin, and one increment would
    /// wait for the other.
    static constexpr std::size_t kCopies = 4;

    explicit Bins(const MeterOptions& options) : scale_(options), last_(options.bins - 1) {
        if (options.grows_histogram) {
            std::tie(first_, last_) = scale_.widest();
        } else if (options.histogram_min > std::log2(kHistogramBlack)) {
            --first_;  // counts what lies below the range
        }
        edges_.assign(size() + 1, kInfinity);
        edges_[0] = 0;
        edges_[1] = kHistogramBlack;
        // The last bin has what is clamped to 1.
        std::size_t place = 2;
        for (int i = first_ + 1; i <= last_; ++i)
            edges_[place++] = std::max(std::exp2(scale_.at(i)), kHistogramBlack);
        // The table has only as many digits as distinguish the edges, because it shares the cache
        // with pixels.
        for (digits_ = kFewestDigits; digits_ < kMostDigits; ++digits_) {
            if (!has_narrow_bin()) break;
        }
        has_narrow_ = has_narrow_bin();
        for (const double edge : edges_)
            places_.push_back(place_of(edge));
        steps_.reserve(key_of(kLargest) + 1);
        std::size_t bin = 0;
        for (std::size_t key = 0; key <= key_of(kLargest); ++key) {
            const auto least = static_cast<std::int64_t>(key) << (kDigits - digits_);
            while (least >= places_[bin + 1])
                ++bin;
            steps_.push_back(static_cast<std::uint16_t>(bin));
        }
    }

    [[nodiscard]] const BinScale& scale() const noexcept { return scale_; }
    /// The bin behind that of black. @see BinScale
    [[nodiscard]] int first() const noexcept { return first_; }
    /// Bins, with that of black.
    [[nodiscard]] std::size_t size() const noexcept {
        return static_cast<std::size_t>(last_ - first_) + 2;
    }

    /// Counts luminances.
    /// @param counts  kCopies of each bin, which add up
    void count(const double* luminances, std::size_t n, std::uint64_t* counts) const noexcept {
        if (has_narrow_) {
            for (std::size_t i = 0; i < n; ++i)
                ++counts[kCopies * bin_of(luminances[i])];
            return;
        }
        const std::uint16_t* const steps = steps_.data();
        const std::int64_t* const next = places_.data() + 1;
        const int shift = kDigits - digits_;
        const auto add = [&](std::size_t i, std::size_t copy) {
            const std::int64_t place = place_of(luminances[i]);
            const std::size_t bin = steps[place >> shift];
            ++counts[kCopies * (bin + (place >= next[bin] ? 1 : 0)) + copy];
        };
        std::size_t i = 0;
        for (; i + kCopies <= n; i += kCopies) {
            for (std::size_t copy = 0; copy < kCopies; ++copy)
                add(i + copy, copy);
        }
        for (; i < n; ++i)
            add(i, 0);
    }

  private:
    static constexpr int kDigits = 52;  // of a double
    static constexpr int kFewestDigits = 3;
    static constexpr int kMostDigits = 8;
    static constexpr double kFirst = 0x1p-20;
    /// Luminances are sums of channels up to light::kLargestLight.
    static constexpr double kLargest = 1.01 * light::kLargestLight;
    static_assert(kHistogramBlack > kFirst);

    /// Bits that increase with luminance, starting with those of kFirst.
    static std::int64_t place_of(double luminance) noexcept {
        return std::max(
            std::bit_cast<std::int64_t>(luminance) - std::bit_cast<std::int64_t>(kFirst),
            std::int64_t{0});
    }
    [[nodiscard]] std::size_t key_of(double luminance) const noexcept {
        return static_cast<std::size_t>(place_of(luminance) >> (kDigits - digits_));
    }
    /// Several edges are within a step.
    [[nodiscard]] bool has_narrow_bin() const noexcept {
        for (std::size_t i = 2; i < edges_.size() && edges_[i] <= kLargest; ++i) {
            if (key_of(edges_[i]) == key_of(edges_[i - 1])) return true;
        }
        return false;
    }
    [[nodiscard]] std::size_t bin_of(double luminance) const noexcept {
        std::size_t bin = steps_[key_of(luminance)];
        while (luminance >= edges_[bin + 1])
            ++bin;
        return bin;
    }

    BinScale scale_;
    int first_ = 1;
    int last_;
    std::vector<double> edges_;         // bin i is [edges_[i], edges_[i + 1])
    std::vector<std::int64_t> places_;  // of the edges
    std::vector<std::uint16_t> steps_;  // the bin of the least luminance of each step
    int digits_ = 0;
    bool has_narrow_ = false;
};

/// Settings of the measurement.
struct Plan {
    MeterOptions options;
    SceneMeter::Figures figures;
    ChannelLayout layout;  // its alpha: -1 if alpha is ignored
    bool divides;
    double surface_limit;  // for divisor_of(), before exposure
    bool converts;
    Matrix3 to_rec709;
    std::optional<ReferenceEngine> decode;  // none: the picture is linear
    Bins bins;
};

/// Measures the rows of one thread's part of a picture.
class RowMeter {
  public:
    /// @throws std::bad_alloc
    RowMeter(const ImageBuf& picture, const Plan& plan)
        : plan_(plan),
          reader_(picture),
          type_(picture.spec().format),
          access_(*pixel_access(type_)),
          size_(static_cast<std::ptrdiff_t>(type_.size())),
          weighing_{plan.converts ? &plan.to_rec709 : nullptr, plan.options.delta},
          counts_(Bins::kCopies * plan.bins.size()) {}

    /// @returns  false when the picture could not be read.
    bool measure(int xbegin, int xend, int y, int z, Measured& row) {
        for (int x = xbegin; x < xend;) {
            const std::size_t n =
                std::min<std::size_t>(light::kSpan, static_cast<std::size_t>(xend - x));
            SpanSource source{nullptr, 0};
            if (!reader_.locate(x, y, z, n, source)) return false;
            measure_span(source, n, row);
            x += static_cast<int>(n);
        }
        return true;
    }

    void add_to(std::vector<std::uint64_t>& histogram) const noexcept {
        for (std::size_t i = 0; i < counts_.size(); ++i)
            histogram[i / Bins::kCopies] += counts_[i];
    }

  private:
    void measure_span(const SpanSource& source, std::size_t n, Measured& row) {
        const bool has_alpha = plan_.layout.alpha >= 0;
        if (const float* pixels = packed_floats(source, n)) {
            const int channels = static_cast<int>(source.stride / size_);
            if (!plan_.decode && light::are_plain(pixels, channels, n, has_alpha)) {
                row.finite.add(light::add_up(pixels, channels, n, weighing_, luminance_), n);
                count(n, row);
                return;
            }
            light::split(pixels, channels, n, planes_);
        } else {
            load(source, n);
        }
        const light::Kinds kinds = light::kinds(planes_, n, has_alpha);
        std::size_t limited = 0;
        if (!kinds.all_finite || !kinds.all_cover) {
            const std::size_t all = n;
            n = sort_out(all, has_alpha, row, limited);
        }
        if (n > 0) {
            if (has_alpha && plan_.divides && !kinds.all_opaque) {
                light::divide_by_alpha(planes_, n, plan_.surface_limit);
            }
            add_up(planes_, n, row.finite);
            count(n, row);
        }
        if (limited > 0) add_up(limited_, limited, row.limited);
    }

    void load(const SpanSource& source, std::size_t n) noexcept {
        const std::size_t colors = plan_.layout.is_gray ? 1 : 3;
        for (std::size_t c = 0; c < colors; ++c)
            load(source, static_cast<int>(c), planes_[c], n);
        if (plan_.layout.is_gray) {
            std::copy_n(planes_[0].begin(), n, planes_[1].begin());
            std::copy_n(planes_[0].begin(), n, planes_[2].begin());
        }
        if (plan_.layout.alpha >= 0) load(source, plan_.layout.alpha, planes_[3], n);
    }
    void load(const SpanSource& source, int channel, std::array<double, light::kSpan>& to,
              std::size_t n) const noexcept {
        access_.load_double(source.pixels + channel * size_, source.stride, to.data(), n);
    }
    /// Contiguous RGB or RGBA floats, from floats or halves; otherwise null.
    const float* packed_floats(const SpanSource& source, std::size_t n) noexcept {
        const bool is_half = type_ == OIIO::TypeHalf;
        if ((type_ != OIIO::TypeFloat && !is_half) || plan_.layout.is_gray ||
            (source.stride != 3 * size_ && source.stride != 4 * size_) ||
            (plan_.layout.alpha >= 0 && plan_.layout.alpha != 3) ||
            reinterpret_cast<std::uintptr_t>(source.pixels) % type_.size() != 0) {
            return nullptr;
        }
        if (!is_half) return reinterpret_cast<const float*>(source.pixels);
        access_.run_to_float(source.pixels, floats_.data(),
                             n * static_cast<std::size_t>(source.stride / size_));
        return floats_.data();
    }

    /// Moves the counted pixels to the front, and those that only statistics count to a separate
    /// buffer.
    /// @returns  the number of counted pixels
    std::size_t sort_out(std::size_t n, bool has_alpha, Measured& row, std::size_t& limited) {
        std::size_t counted = 0;
        for (std::size_t i = 0; i < n; ++i) {
            const double alpha = has_alpha ? planes_[3][i] : 1;
            if (alpha == 0 || !std::isfinite(alpha)) {
                ++row.uncovered;
                continue;
            }
            const Vector3 color = {planes_[0][i], planes_[1][i], planes_[2][i]};
            const bool is_finite =
                std::all_of(color.begin(), color.end(), [](double x) { return std::isfinite(x); });
            if (is_finite) {
                for (std::size_t c = 0; c < 3; ++c)
                    planes_[c][counted] = color[c];
                planes_[3][counted++] = alpha;
                continue;
            }
            const bool is_nan =
                std::any_of(color.begin(), color.end(), [](double x) { return std::isnan(x); });
            ++(is_nan ? row.nan : row.infinite);
            const double divisor = plan_.divides
                                       ? divisor_of(alpha, largest_of(color[0], color[1], color[2]),
                                                    plan_.surface_limit)
                                       : 1;
            // Infinities tell no number: they are the largest half float, not the largest float.
            for (std::size_t c = 0; c < 3; ++c) {
                const double x = color[c] / divisor;
                limited_[c][limited] = std::isinf(x) ? sanitize(x) : without_nan(x);
            }
            ++limited;
        }
        // Divides by alpha in whole blocks.
        std::fill(planes_[3].begin() + static_cast<std::ptrdiff_t>(counted), planes_[3].end(), 1);
        return counted;
    }

    void add_up(light::Planes& planes, std::size_t n, Light& light) noexcept {
        if (plan_.decode) {
            const std::array<double*, 3> rgb = {planes[0].data(), planes[1].data(),
                                                planes[2].data()};
            plan_.decode->run({rgb[0], rgb[1], rgb[2]}, rgb, n);
        }
        light.add(light::add_up(planes, n, weighing_, luminance_), n);
    }

    void count(std::size_t n, Measured& row) {
        if (plan_.figures != SceneMeter::Figures::all) return;
        plan_.bins.count(luminance_.data(), n, counts_.data());
        if (!plan_.options.exact) return;
        std::copy_if(luminance_.begin(), luminance_.begin() + static_cast<std::ptrdiff_t>(n),
                     std::back_inserter(row.kept), [](double y) { return y >= kHistogramBlack; });
    }

    const Plan& plan_;
    SpanReader reader_;
    OIIO::TypeDesc type_;
    const PixelAccess& access_;
    std::ptrdiff_t size_;
    light::Weighing weighing_;
    light::Planes planes_{};
    light::Planes limited_{};
    std::array<float, 4 * light::kSpan> floats_{};
    std::array<double, light::kSpan> luminance_{};
    std::vector<std::uint64_t> counts_;  // of the histogram
};

/// A histogram and the places of its bins.
struct Histogram {
    BinScale scale;
    int first;  // behind black
    std::vector<std::uint64_t> counts;
    std::uint64_t below = 0;
    std::uint64_t above = 0;

    [[nodiscard]] int last() const { return first + static_cast<int>(counts.size()) - 2; }
    [[nodiscard]] std::uint64_t at(int bin) const {
        return counts[static_cast<std::size_t>(bin - first) + 1];
    }
    [[nodiscard]] std::uint64_t all() const {
        return std::accumulate(counts.begin() + 1, counts.end(), std::uint64_t{0});
    }
};

/// The histogram between the limits of the options, or beyond them as far as the picture reaches.
Histogram histogram_of(const Bins& bins, const std::vector<std::uint64_t>& counts,
                       const MeterOptions& options) {
    const Histogram whole = {bins.scale(), bins.first(), counts};
    int first = 1;
    int last = options.bins - 1;
    // The widest histogram ends one bin before black, which lies in its first bin.
    std::uint64_t below = 0;
    for (int bin = whole.first; bin < first; ++bin)
        below += whole.at(bin);
    std::uint64_t above = 0;
    for (int bin = last; bin <= whole.last(); ++bin)
        above += whole.at(bin);
    if (options.grows_histogram) {
        const auto allowed = static_cast<double>(whole.all()) * kShareBeyond;
        while (first > whole.first && static_cast<double>(below) > allowed)
            below -= whole.at(--first);
        while (last < whole.last() && static_cast<double>(above) > allowed)
            above -= whole.at(last++);
    }
    Histogram result = {bins.scale(), first, {}, below, above};
    result.counts.assign(static_cast<std::size_t>(last - first) + 2, 0);
    result.counts[0] = counts[0];
    for (int bin = whole.first; bin <= whole.last(); ++bin) {
        result.counts[static_cast<std::size_t>(std::clamp(bin, first, last) - first) + 1] +=
            whole.at(bin);
    }
    return result;
}

/// 2^(mean log2) of the bins, each weighted with its pixels between the percentiles.
double average_of_bins(const Histogram& histogram, const MeterOptions& options) {
    const auto all = static_cast<double>(histogram.all());
    const double low = all * options.low_percentile / 100;
    const double high = all * options.high_percentile / 100;
    double before = 0;
    double sum = 0;
    double weights = 0;
    for (int i = histogram.first; i <= histogram.last(); ++i) {
        const double after = before + static_cast<double>(histogram.at(i));
        const double weight = std::max(std::min(after, high) - std::max(before, low), 0.0);
        sum += weight * static_cast<double>(i);
        weights += weight;
        before = after;
    }
    const double bin = (weights > 0 ? sum / weights : 0) - 1;
    const BinScale& scale = histogram.scale;
    return std::exp2(bin / scale.steps * scale.range + scale.minimum);
}

/// Luminance below which `rank` pixels of the histogram are.
double luminance_at(const Histogram& histogram, double rank) {
    double before = 0;
    int bin = histogram.first;
    while (bin < histogram.last() &&
           (histogram.at(bin) == 0 || before + static_cast<double>(histogram.at(bin)) < rank))
        before += static_cast<double>(histogram.at(bin++));
    const double within =
        histogram.at(bin) == 0
            ? 0
            : std::clamp((rank - before) / static_cast<double>(histogram.at(bin)), 0.0, 1.0);
    const BinScale& scale = histogram.scale;
    return std::exp2((static_cast<double>(bin - 1) + within) / scale.steps * scale.range +
                     scale.minimum);
}

/// Partially sorts: the value of this rank is at its position, and smaller ones are before it.
double select(std::vector<double>& values, std::size_t from, std::size_t rank) {
    const auto at = [&](std::size_t i) { return values.begin() + static_cast<std::ptrdiff_t>(i); };
    std::nth_element(at(from), at(rank), values.end());
    return values[rank];
}

/// 2^(mean log2) of the luminances between the percentiles; those at the ends count by their
/// fraction between them.
double average_of_luminances(std::vector<double> values, const MeterOptions& options) {
    const auto n = static_cast<double>(values.size());
    const double low = n * options.low_percentile / 100;
    const double high = n * options.high_percentile / 100;
    const auto first = static_cast<std::size_t>(low);
    const auto end = static_cast<std::size_t>(std::ceil(high));
    if (first > 0) (void)select(values, 0, first);
    if (end < values.size()) (void)select(values, first, end);
    // The smallest and the largest may count partially.
    std::nth_element(values.begin() + static_cast<std::ptrdiff_t>(first),
                     values.begin() + static_cast<std::ptrdiff_t>(first),
                     values.begin() + static_cast<std::ptrdiff_t>(end));
    Sum sum;
    double largest = values[first];
    for (std::size_t i = first; i < end; ++i) {
        sum.add(std::log2(values[i]));
        largest = std::max(largest, values[i]);
    }
    sum.add(-(low - static_cast<double>(first)) * std::log2(values[first]));
    sum.add(-(static_cast<double>(end) - high) * std::log2(largest));
    return std::exp2(sum.value() / (high - low));
}

}  // namespace

struct SceneMeter::State {
    Plan plan;
    int nthreads;
    Measured all;
    std::vector<std::uint64_t> histogram;
};

SceneMeter::SceneMeter(const OIIO::ImageSpec& spec, const MeterOptions& options, Cover cover,
                       Figures figures, int nthreads) {
    const PictureSpec of = picture_spec(spec);
    const SourceColor source = in_units(source_color(of, options.input), options.input_units);
    const Matrix3 to_rec709 =
        scale(rgb_to_rgb(source.primaries, kRec709), scene_scale(source, options.reference_white));
    std::optional<ReferenceEngine> decode;
    if (!source.decode.empty()) decode.emplace(source.decode);
    ChannelLayout layout = channel_layout(of);
    if (options.unpremult == TonemapOptions::Unpremult::no || cover == Cover::ignored)
        layout.alpha = -1;
    Bins bins(options);
    std::vector<std::uint64_t> histogram(bins.size());
    state_ = std::make_unique<State>(
        State{{options, figures, layout, divides_by_alpha(of, options.unpremult),
               surface_limit(options.unpremult, 0), to_rec709 != kIdentity3, to_rec709,
               std::move(decode), std::move(bins)},
              nthreads,
              {},
              std::move(histogram)});
}

SceneMeter::~SceneMeter() = default;
SceneMeter::SceneMeter(SceneMeter&&) noexcept = default;
SceneMeter& SceneMeter::operator=(SceneMeter&&) noexcept = default;

void SceneMeter::add(const ImageBuf& picture, const ROI& roi) {
    std::vector<Measured> rows(static_cast<std::size_t>(roi.height()) *
                               static_cast<std::size_t>(roi.depth()));
    std::atomic<bool> unreadable = false;
    std::atomic<bool> out_of_memory = false;
    std::mutex mutex;
    // Split between rows, never within one.
    const OIIO::paropt threads(state_->nthreads, OIIO::paropt::SplitDir::Y);
    OIIO::ImageBufAlgo::parallel_image(roi, threads, [&](ROI part) {
        // No exception may leave a thread of OIIO's pool.
        try {
            const auto meter = std::make_unique<RowMeter>(picture, state_->plan);
            for (int z = part.zbegin; z < part.zend; ++z) {
                for (int y = part.ybegin; y < part.yend; ++y) {
                    const auto row = static_cast<std::size_t>(z - roi.zbegin) *
                                         static_cast<std::size_t>(roi.height()) +
                                     static_cast<std::size_t>(y - roi.ybegin);
                    if (!meter->measure(part.xbegin, part.xend, y, z, rows[row])) unreadable = true;
                }
            }
            const std::lock_guard lock(mutex);
            meter->add_to(state_->histogram);
        } catch (const std::bad_alloc&) {
            out_of_memory = true;
        }
    });
    if (out_of_memory) throw std::bad_alloc();
    check_was_read(picture, !unreadable);
    for (const Measured& row : rows)
        state_->all.add(row);
}

bool SceneMeter::has_cover() const {
    const Measured& all = state_->all;
    return all.finite.count + all.limited.count > 0;
}

SceneStatistics SceneMeter::statistics() const {
    Light light = state_->all.finite;
    light.add(state_->all.limited);
    return light.statistics();
}

Metering SceneMeter::metering() const {
    const Measured& all = state_->all;
    const MeterOptions& options = state_->plan.options;
    const Light& light = all.finite;
    Metering m;
    m.counted = light.count;
    m.black = light.count - light.lit_count;
    m.nan = all.nan;
    m.infinite = all.infinite;
    m.uncovered = all.uncovered;
    m.scene = statistics();
    m.scene_count = light.count + all.limited.count;
    m.scene_lit_count = light.lit_count + all.limited.lit_count;
    const Histogram histogram = histogram_of(state_->plan.bins, state_->histogram, options);
    m.histogram = histogram.counts;
    m.histogram_min = histogram.scale.at(histogram.first);
    m.histogram_max = histogram.scale.at(histogram.last());
    m.below_histogram = histogram.below;
    m.above_histogram = histogram.above;
    m.histogram_average = average_of_bins(histogram, options);
    if (light.count == 0) return m;
    m.log_average = light.log_with_delta.geometric_mean(light.count);
    m.mean = light.mean_luminance();
    m.maximum = light.maximum;
    if (light.lit_count > 0) {
        m.geometric_mean = light.log_lit.geometric_mean(light.lit_count);
        m.minimum = light.minimum_lit;
    }
    const std::uint64_t measurable = light.count - m.histogram[0];
    if (measurable == 0) return m;
    if (options.exact) {
        m.histogram_average = average_of_luminances(all.kept, options);
        std::vector<double> values = all.kept;
        std::size_t sorted = 0;  // the values before it are smaller
        for (const double percent : Metering::kPercents) {
            const double position = static_cast<double>(values.size()) * percent / 100;
            const std::size_t rank =
                std::min(static_cast<std::size_t>(position), values.size() - 1);
            m.percentiles.push_back(select(values, sorted, rank));
            sorted = rank;
        }
    } else {
        for (const double percent : Metering::kPercents) {
            m.percentiles.push_back(
                luminance_at(histogram, static_cast<double>(measurable) * percent / 100));
        }
    }
    return m;
}

TONEWRIGHT_NAMESPACE_END
