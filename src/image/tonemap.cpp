// SPDX-License-Identifier: Apache-2.0
//
// tonemap() on OpenImageIO pictures.
//
// A picture is processed in spans of at most kSpan pixels of one row: channels of any pixel type
// are gathered into planar float, run through the engine, and scattered into the destination.
//
// Views are compiled once for all exposures and statistics, because both are uniforms. An operator
// that needs its statistics as constants is compiled again for each picture.
#include <OpenImageIO/imagebufalgo.h>
#include <OpenImageIO/imagebufalgo_util.h>
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <cstdint>
#include <exception>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "base/bounded_cache.h"
#include "base/format_number.h"
#include "base/strings.h"
#include "image/converted_picture.h"
#include "image/report_thrown.h"
#include "image/scene_planes.h"
#include "image/source_picture.h"
#include "image/spec_conversion.h"
#include "picture/color_tags.h"
#include "picture/picture_description.h"
#include "picture/pixel_access.h"
#include "picture/source_pixels.h"
#include "tonewright/engine.h"
#include "tonewright/registry.h"
#include "tonewright/tonemap.h"
#include "tonewright/view.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

using OIIO::ImageBuf;
using OIIO::ImageSpec;
using OIIO::ROI;

struct CopiedChannel {
    int from;
    int to;
};

/// Maps channels of the source to the destination.
struct ChannelPlan {
    bool gray_source = false;  // channel 0 alone is color
    bool gray_result = false;
    int alpha = -1;  // of the source, to divide by and multiply with; -1: color is taken as it is
    double surface_limit = 0;  // for divisor_of()
    std::vector<CopiedChannel> copies;
};

[[noreturn]] void fail(const std::string& message) { throw Error(message); }

/// The spec of a destination that does not exist yet.
ImageSpec result_spec(const ImageSpec& source, bool gray_becomes_color) {
    ImageSpec spec = source;
    if (gray_becomes_color) {
        const bool has_alpha = spec.nchannels == 2;
        spec.nchannels = has_alpha ? 4 : 3;
        spec.channelnames = {"R", "G", "B"};
        if (has_alpha) spec.channelnames.emplace_back("A");
        spec.alpha_channel = has_alpha ? 3 : -1;
        spec.z_channel = -1;
    }
    spec.set_format(OIIO::TypeFloat);
    spec.channelformats.clear();
    change_spec(spec, [](PictureSpec& of) { complete_channel_names(of); });
    return spec;
}

View view_of(const TonemapOptions& options, const SourceColor& source) {
    return make_view(options.op, in_units(source, options.input_units), options.exposure_stops,
                     options.display, options.reference_white);
}

/// True if some of the operator's parameters come from a picture.
bool depends_on_picture(const TonemapOptions& options) {
    if (!options.op.op) fail("op is missing; expected a resolved operator");
    return options.statistics == TonemapOptions::Statistics::from_picture &&
           takes_statistics(options.op);
}

/// Planar colors with strides, as in SimdEngine::run(). In and out may be the same.
using PlanarMap = std::function<void(const std::array<const float*, 3>& in,
                                     std::ptrdiff_t in_stride, const std::array<float*, 3>& out,
                                     std::ptrdiff_t out_stride, std::size_t count)>;

/// Reports the progress of a picture, from one thread at a time, and receives the request to stop.
class Progress {
  public:
    Progress(OIIO::ProgressCallback callback, void* data) : callback_(callback), data_(data) {}

    void begin(OIIO::imagesize_t pixels) noexcept { total_ = pixels; }
    void add(int pixels) {
        if (!callback_) return;
        const std::lock_guard lock(mutex_);
        done_ += static_cast<OIIO::imagesize_t>(pixels);
        if (stopped_ || (done_ - reported_ < total_ / 100 && done_ < total_)) return;
        reported_ = done_;
        const auto part = static_cast<double>(done_) / static_cast<double>(total_);
        if (callback_(data_, static_cast<float>(part))) stopped_ = true;
    }
    [[nodiscard]] bool stopped() const noexcept { return stopped_; }

  private:
    OIIO::ProgressCallback callback_;
    void* data_;
    OIIO::imagesize_t total_ = 0;
    OIIO::imagesize_t done_ = 0;
    OIIO::imagesize_t reported_ = 0;
    std::mutex mutex_;
    std::atomic<bool> stopped_ = false;
};

/// The operations on a picture.
struct PictureMap {
    PlanarMap run;
    /// A gray picture stays gray.
    bool keeps_gray = false;
    /// In messages.
    std::string label;
    TonemapOptions::Unpremult unpremult = TonemapOptions::Unpremult::automatic;
    /// The exposure inside of `run`, in stops.
    double exposure_stops = 0;
    /// Not null: replaces the color of the source in the data window.
    const ScenePlanes* light = nullptr;
};

/// Runs it; the metadata is still that of the source. @throws Error
void run_picture(const PictureMap& with, ImageBuf& dst, const ImageBuf& src, ROI roi, int nthreads,
                 Progress& progress);

/// Limit of the light that local operators get. They apply the exposure themselves, because their
/// statistics are those before it, so the limit is that of exposed light. At exposures above 0 it
/// is that of light itself, so that statistics do not depend on the exposure.
double light_limit(const View& view) {
    return kHalfMax * std::exp2(std::max(-view.exposure_stops, 0.0));
}

/// The input of a local operator: light of Rec.709, not negative.
Pipeline light_stages(const View& view) {
    const double limit = light_limit(view);
    Pipeline stages = view.input_decode;
    const bool is_linear = stages.empty();
    if (view.input_scale != 1)
        stages.emplace_back(MatrixStage{scale(kIdentity3, view.input_scale)});
    stages.emplace_back(ClampStage{-limit, limit, is_linear});
    stages.emplace_back(MatrixStage{rgb_to_rgb(view.input_primaries, kRec709)});
    stages.emplace_back(ClampStage{0, limit});
    return stages;
}

/// Range of exposures, up and down, in stops, that a program takes as a number; it extends the
/// domain of its curves. Exposures beyond it, and exposure 0, have their own programs.
constexpr double kMostLiveStops = 16;

bool is_live_exposure(double stops) { return stops != 0 && std::fabs(stops) <= kMostLiveStops; }

bool is_exposure_live(const View& view) {
    return is_live_exposure(view.exposure_stops) && !view.op.op->is_local();
}

/// The engine's part: after a local operator, the display.
Pipeline engine_stages(View view, const LiveUniforms& uniforms) {
    if (view.op.op->is_local()) {
        view.input_primaries = kRec709;
        view.input_decode = {};
        view.input_scale = 1;
        view.exposure_stops = 0;
    }
    return build_live_view(view, uniform_names(uniforms));
}

/// The limit of the light that an operator gets, and the stages before it, are those of every view.
std::size_t stages_of_light(const Pipeline& stages) {
    const auto limit = std::find_if(stages.begin(), stages.end(), [](const Stage& stage) {
        const auto* clamp = std::get_if<ClampStage>(&stage);
        return clamp && clamp->lo == -kHalfMax && clamp->hi == kHalfMax;
    });
    return limit == stages.end() ? 0 : static_cast<std::size_t>(limit - stages.begin()) + 1;
}

/// The engine's part of a view that is blended with a plain clamp's, in code values, as a mix node
/// blends two pictures.
Pipeline mixed_stages(const View& view, double share, const LiveUniforms& uniforms) {
    Pipeline stages = engine_stages(view, uniforms);
    if (share == 1) return stages;
    // The view has checked its reference white.
    SourceColor source = {view.input, view.input_primaries, view.input_decode};
    source.is_absolute = true;
    View plain = make_view(resolve_operator("clamp"), std::move(source), view.exposure_stops,
                           view.display, view.reference_white);
    plain.input_scale = view.input_scale;
    LiveUniforms exposure = uniforms;
    std::erase_if(exposure, [](const auto& item) { return item.first != kExposureUniform; });
    const Pipeline other = engine_stages(std::move(plain), exposure);
    // The light is computed once, and the limit stays the first stage that engines know.
    const auto count = static_cast<std::ptrdiff_t>(stages_of_light(stages));
    const std::array<Expr, 3> a = compose(Pipeline(stages.begin() + count, stages.end()));
    const std::array<Expr, 3> b = compose(Pipeline(other.begin() + count, other.end()));
    const auto blend = [&](std::size_t c) { return share * a[c] + (1 - share) * b[c]; };
    stages.erase(stages.begin() + count, stages.end());
    stages.emplace_back(CrossTalkStage{{blend(0), blend(1), blend(2)}});
    return stages;
}

/// @throws Error  out of [0, 1], or of a view that cannot be blended
void check_mix(double share, const View& view) {
    if (!(share >= 0 && share <= 1))
        throw Error(fmt::format("mix is {}; expected [0, 1]", shortest(share)));
    if (share == 1) return;
    if (view.op.op->is_local()) {
        throw Error(
            fmt::format("mix is {}; expected 1 with {}, which looks at a pixel's "
                        "surroundings",
                        shortest(share), view.op.op->id));
    }
    if (view.display == kNativeOutput) {
        throw Error(fmt::format("mix is {}; expected 1 with display native", shortest(share)));
    }
}

/// @param uniforms  the statistics that are live
LiveUniforms with_exposure(LiveUniforms uniforms, const View& view) {
    if (is_exposure_live(view))
        uniforms[std::string(kExposureUniform)] = {0, -kMostLiveStops, kMostLiveStops};
    return uniforms;
}

/// The programs that a picture passes.
struct Prepared {
    /// A program for all live exposures, unless the view's own is fixed, and for all live
    /// statistics.
    /// @param mix  share of the operator
    Prepared(View v, const LiveUniforms& statistics, double mix)
        : view(std::move(v)),
          uniforms(with_exposure(statistics, view)),
          engine(mixed_stages(view, mix, uniforms), uniforms, view.op.op->bounds.simd_goal) {
        if (view.op.op->is_local()) to_light.emplace(light_stages(view));
    }
    /// The same program for another view that it serves.
    Prepared(const Prepared& program, View v)
        : view(std::move(v)),
          uniforms(program.uniforms),
          engine(program.engine.with_uniforms(values())) {
        if (view.op.params == program.view.op.params) keeps_gray_ = program.keeps_gray_;
        if (!program.to_light) return;
        if (light_limit(view) == light_limit(program.view)) {
            to_light.emplace(program.to_light->with_uniforms({}));
        } else {
            to_light.emplace(light_stages(view));
        }
    }

    /// True if a gray picture stays gray, at all live exposures.
    [[nodiscard]] bool keeps_gray() const {
        // Computed only for gray pictures, which are rare. All threads get the same result.
        Known known = *keeps_gray_;
        if (known == Known::nothing) {
            View any = view;
            if (is_exposure_live(any)) any.exposure_stops = 0;
            known = keeps_grays(engine_stages(any, {})) ? Known::yes : Known::no;
            *keeps_gray_ = known;
        }
        return known == Known::yes;
    }

    View view;
    LiveUniforms uniforms;
    SimdEngine engine;
    /// With a local operator: the stages before it. `engine` has those after it.
    std::optional<SimdEngine> to_light;

  private:
    enum class Known : unsigned char { nothing, no, yes };
    std::shared_ptr<std::atomic<Known>> keeps_gray_ =
        std::make_shared<std::atomic<Known>>(Known::nothing);

    [[nodiscard]] UniformValues values() const {
        UniformValues values;
        for (const auto& [name, uniform] : uniforms) {
            values[name] =
                name == kExposureUniform ? view.exposure_stops : view.op.params.number(name);
        }
        return values;
    }
};

}  // namespace

struct Tonemapper::State {
    explicit State(const TonemapOptions& o)
        : options(o),
          depends_on_picture(tonewright::depends_on_picture(options)),
          programs_(std::make_shared<BoundedCache<ProgramKey, Prepared>>(kMostPrepared)) {
        if (depends_on_picture) statistics_ = live_statistics(options.op);
        // Reports wrong options before there is a picture, which may say that it is absolute.
        SourceColor source = source_color({}, options.input);
        source.is_absolute = source.is_absolute || is_same_name(options.input, kAutoInput);
        const View view = view_of(options, source);
        check_mix(options.mix, view);
        is_local = view.op.op->is_local();
    }

    /// At another exposure, with the same programs.
    State(const State& other, double stops)
        : options(other.options),
          depends_on_picture(other.depends_on_picture),
          is_local(other.is_local),
          statistics_(other.statistics_),
          programs_(other.programs_) {
        check_exposure(stops);
        options.exposure_stops = stops;
    }
    /// For pictures with these statistics, with the same programs.
    State(const State& other, const SceneStatistics& statistics)
        : State(other, other.options.exposure_stops) {
        if (statistics_.empty()) statistics_ = live_statistics(options.op);
        options.op = resolve_for_picture(options.op, statistics);
        options.statistics = TonemapOptions::Statistics::defaults;
        depends_on_picture = false;
    }

    TonemapOptions options;
    /// Made again with each picture's statistics.
    bool depends_on_picture;
    bool is_local = false;

    void run(ImageBuf& dst, const ImageBuf& src, ROI roi, int nthreads, Progress& progress) const;

  private:
    [[nodiscard]] std::shared_ptr<const Prepared> prepared_for(const SourceColor& source) const;
    void run(const Prepared& with, ImageBuf& dst, const ImageBuf& src, ROI roi, int nthreads,
             Progress& progress, const ScenePlanes* light = nullptr) const;

    /// Pictures of one shot are of one kind.
    static constexpr std::size_t kMostPrepared = 8;
    /// The values that a program of the operator depends on beside the options that never change.
    struct ProgramKey {
        std::string input;
        std::optional<double> fixed_exposure;
        /// Settings; only the names of statistics that are live.
        Settings settings;
        bool operator==(const ProgramKey&) const = default;
    };
    LiveUniforms statistics_;
    std::shared_ptr<BoundedCache<ProgramKey, Prepared>> programs_;
    mutable BoundedCache<std::string, Prepared> prepared_{kMostPrepared};  // by input space
};

namespace {

/// Runs the rows of one thread's part of a picture.
class RowRunner {
  public:
    /// @throws std::bad_alloc
    RowRunner(const PictureMap& with, const ChannelPlan& plan, ImageBuf& dst, const ImageBuf& src)
        : map_(with.run),
          light_(with.light),
          plan_(plan),
          dst_(dst),
          src_(src),
          reader_(src),
          src_type_(src.spec().format),
          src_access_(*pixel_access(src_type_)),
          dst_access_(*pixel_access(dst.spec().format)),
          src_size_(static_cast<std::ptrdiff_t>(src_type_.size())),
          dst_size_(static_cast<std::ptrdiff_t>(dst.spec().format.size())),
          planes_(kSpan * (plan.alpha >= 0 ? 4 : 3)) {
        const bool convert = src_type_ != dst.spec().format;
        if (convert && !plan.copies.empty()) wide_.resize(kSpan);
        const auto channels = [](const ImageBuf& picture) {
            return static_cast<std::size_t>(picture.nchannels());
        };
        if (src_type_ != OIIO::TypeFloat && channels(src) <= kMostChannels)
            from_.resize(kSpan * channels(src));
        // Copied channels are written last; in place they would be gone by then.
        const bool is_in_place = dst.localpixels() == src.localpixels();
        if (dst.spec().format != OIIO::TypeFloat && channels(dst) <= kMostChannels &&
            channels(dst) == 3 + plan.copies.size() && (plan.copies.empty() || !is_in_place)) {
            to_.resize(kSpan * channels(dst));
        }
    }

    /// Ends early if the caller stops it.
    /// @returns  false if the source could not be read
    bool run(const ROI& roi, Progress& progress) {
        const ROI window = src_.roi();
        for (int z = roi.zbegin; z < roi.zend; ++z) {
            for (int y = roi.ybegin; y < roi.yend; ++y) {
                if (progress.stopped()) return true;
                const bool row_inside =
                    y >= window.ybegin && y < window.yend && z >= window.zbegin && z < window.zend;
                const int from =
                    row_inside ? std::clamp(window.xbegin, roi.xbegin, roi.xend) : roi.xend;
                const int to = row_inside ? std::clamp(window.xend, from, roi.xend) : roi.xend;
                if (!run_part(roi.xbegin, from, y, z, false) || !run_part(from, to, y, z, true) ||
                    !run_part(to, roi.xend, y, z, false)) {
                    return false;
                }
                progress.add(roi.width());
            }
        }
        return true;
    }

  private:
    bool run_part(int xbegin, int xend, int y, int z, bool inside) {
        for (int x = xbegin; x < xend;) {
            const std::size_t n = std::min<std::size_t>(kSpan, static_cast<std::size_t>(xend - x));
            SpanSource source{nullptr, 0};
            if (inside && !reader_.locate(x, y, z, n, source)) return false;
            run_span(source, x, y, static_cast<std::byte*>(dst_.pixeladdr(x, y, z)), n);
            x += static_cast<int>(n);
        }
        return true;
    }

    void run_span(const SpanSource& source, int x, int y, std::byte* to, std::size_t n) {
        const std::ptrdiff_t to_stride = dst_.pixel_stride();
        const FloatSpan floats = as_floats(source, n);
        const bool divides = needs_division(floats, n);
        if (divides || !run_interleaved(floats, to, to_stride, n)) {
            const std::array<float*, 3> rgb = {planes_.data(), planes_.data() + kSpan,
                                               planes_.data() + 2 * kSpan};
            float* const divisor = planes_.data() + 3 * kSpan;
            if (!source.pixels) {
                for (float* plane : rgb)
                    std::fill_n(plane, n, 0.0F);
            } else {
                if (divides || !light_)
                    load_color(floats.type, plan_.gray_source, floats.source, rgb, n);
                if (divides) {
                    load_divisor(floats.type, plan_.alpha, floats.source, rgb, plan_.surface_limit,
                                 divisor, nullptr, n);
                }
                if (light_) {
                    copy_light(x, y, rgb, n);  // which is divided already
                } else if (divides) {
                    divide(rgb, divisor, n);
                }
            }
            map_({rgb[0], rgb[1], rgb[2]}, 1, rgb, 1, n);
            if (divides) multiply(rgb, divisor, n);
            store_color(rgb, to, to_stride, n);
        }
        for (const CopiedChannel& channel : plan_.copies)
            copy(source, channel, to, to_stride, n);
    }

    /// All channels of the source as floats, if one conversion can do this; otherwise unchanged.
    struct FloatSpan {
        SpanSource source;
        OIIO::TypeDesc type;
    };
    FloatSpan as_floats(const SpanSource& source, std::size_t n) {
        const int channels = src_.nchannels();
        if (!source.pixels || from_.empty() || source.stride != channels * src_size_)
            return {source, src_type_};
        src_access_.run_to_float(source.pixels, from_.data(),
                                 n * static_cast<std::size_t>(channels));
        return {{reinterpret_cast<const std::byte*>(from_.data()),
                 channels * static_cast<std::ptrdiff_t>(sizeof(float))},
                OIIO::TypeFloat};
    }

    /// Interleaved floats need no planes: the engine reads and writes the pictures or their
    /// converted copies.
    bool run_interleaved(const FloatSpan& from, std::byte* to, std::ptrdiff_t to_stride,
                         std::size_t n) {
        constexpr std::ptrdiff_t kFloat = sizeof(float);
        const auto is_aligned = [](const std::byte* p, std::ptrdiff_t stride) {
            return reinterpret_cast<std::uintptr_t>(p) % alignof(float) == 0 &&
                   stride % kFloat == 0;
        };
        const std::byte* pixels = from.source.pixels;
        if (!pixels || light_ || plan_.gray_source || plan_.gray_result ||
            from.type != OIIO::TypeFloat || !is_aligned(pixels, from.source.stride)) {
            return false;
        }
        const int channels = dst_.nchannels();
        const bool converts = !to_.empty() && to_stride == channels * dst_size_;
        const bool is_float = dst_.spec().format == OIIO::TypeFloat && is_aligned(to, to_stride);
        if (!converts && !is_float) return false;
        const auto* in = reinterpret_cast<const float*>(pixels);
        float* out = converts ? to_.data() : reinterpret_cast<float*>(to);
        map_({in, in + 1, in + 2}, from.source.stride / kFloat, {out, out + 1, out + 2},
             converts ? channels : to_stride / kFloat, n);
        if (converts) dst_access_.run_from_float(out, to, n * static_cast<std::size_t>(channels));
        return true;
    }

    void copy_light(int x, int y, const std::array<float*, 3>& rgb, std::size_t n) const noexcept {
        const std::size_t first =
            static_cast<std::size_t>(y - src_.ybegin()) * static_cast<std::size_t>(light_->width) +
            static_cast<std::size_t>(x - src_.xbegin());
        for (std::size_t c = 0; c < 3; ++c)
            std::copy_n(&light_->rgb[c][first], n, rgb[c]);
    }

    /// False if there is no alpha to divide by, or if all divisors are 1.
    bool needs_division(const FloatSpan& from, std::size_t n) noexcept {
        if (plan_.alpha < 0 || !from.source.pixels) return false;
        float* alpha = planes_.data() + 3 * kSpan;
        const auto offset = static_cast<std::size_t>(plan_.alpha) * from.type.size();
        pixel_access(from.type)->load_float(from.source.pixels + offset, from.source.stride, alpha,
                                            n);
        return !std::all_of(alpha, alpha + n,
                            [](float a) { return divisor_of(a, 0.0F, 0.0F) == 1; });
    }

    static void divide(const std::array<float*, 3>& rgb, const float* alpha,
                       std::size_t n) noexcept {
        for (float* plane : rgb) {
            for (std::size_t i = 0; i < n; ++i)
                plane[i] /= alpha[i];
        }
    }
    static void multiply(const std::array<float*, 3>& rgb, const float* alpha,
                         std::size_t n) noexcept {
        for (float* plane : rgb) {
            for (std::size_t i = 0; i < n; ++i)
                plane[i] *= alpha[i];
        }
    }

    void store_color(const std::array<float*, 3>& rgb, std::byte* to, std::ptrdiff_t to_stride,
                     std::size_t n) const noexcept {
        if (plan_.gray_result) {
            // The three agree within half a code value; green is nearest to luminance.
            dst_access_.store_float(rgb[1], to, to_stride, n);
            return;
        }
        for (std::size_t c = 0; c < 3; ++c) {
            dst_access_.store_float(rgb[c], to + static_cast<std::ptrdiff_t>(c) * dst_size_,
                                    to_stride, n);
        }
    }

    void copy(const SpanSource& source, const CopiedChannel& channel, std::byte* to,
              std::ptrdiff_t to_stride, std::size_t n) noexcept {
        std::byte* target = to + channel.to * dst_size_;
        if (!source.pixels) {
            static constexpr std::array<std::byte, 8> kZero{};
            dst_access_.copy(kZero.data(), 0, target, to_stride, n);
            return;
        }
        const std::byte* origin = source.pixels + channel.from * src_size_;
        if (wide_.empty()) {
            src_access_.copy(origin, source.stride, target, to_stride, n);
        } else {
            src_access_.load_double(origin, source.stride, wide_.data(), n);
            dst_access_.store_double(wide_.data(), target, to_stride, n);
        }
    }

    const PlanarMap& map_;
    const ScenePlanes* light_;
    const ChannelPlan& plan_;
    ImageBuf& dst_;
    const ImageBuf& src_;
    SpanReader reader_;
    OIIO::TypeDesc src_type_;
    const PixelAccess& src_access_;
    const PixelAccess& dst_access_;
    std::ptrdiff_t src_size_;
    std::ptrdiff_t dst_size_;
    std::vector<float> planes_;  // r, g, b (, alpha)
    /// All channels of a span, converted together. Empty if no conversion is needed, or if they are
    /// too many for the first-level cache.
    static constexpr std::size_t kMostChannels = 8;
    std::vector<float> from_, to_;
    std::vector<double> wide_;  // copied channels whose type changes; double holds every type
};

void run_picture(const PictureMap& with, ImageBuf& dst, const ImageBuf& src, ROI roi, int nthreads,
                 Progress& progress) {
    const ImageSpec& source = src.spec();
    if (dst.deep()) fail("destination is deep; expected flat pixels (oiiotool --flatten)");
    if (dst.initialized()) check_pixel_type("destination", dst.spec().format);

    ChannelPlan plan;
    const ChannelLayout layout = channel_layout(picture_spec(source));
    plan.gray_source = layout.is_gray;
    const int color_count = plan.gray_source ? 1 : 3;
    const int chbegin = roi.defined() ? std::max(roi.chbegin, 0) : 0;
    const int chend = roi.defined() ? std::min(roi.chend, source.nchannels) : source.nchannels;
    if (chbegin > 0 || chend < color_count) {
        fail(fmt::format(
            "channel range is [{}, {}); expected a range from 0 that has all {} channels of "
            "color",
            roi.chbegin, roi.chend, color_count));
    }

    // A gray result takes one channel, unless the destination has three.
    const bool wide_destination = dst.initialized() && dst.nchannels() >= 3;
    plan.gray_result = plan.gray_source && with.keeps_gray && !wide_destination;
    if (dst.initialized() && !plan.gray_result && dst.nchannels() < 3) {
        fail(fmt::format("destination has {}; expected 3 or more: {}",
                         dst.nchannels() == 1 ? "1 channel" : "2 channels",
                         plan.gray_source ? with.label + " shows this gray picture in color"
                                          : std::string("the picture is in color")));
    }
    if (layout.alpha >= 0 && divides_by_alpha(picture_spec(source), with.unpremult))
        plan.alpha = layout.alpha;
    plan.surface_limit = surface_limit(with.unpremult, with.exposure_stops);

    const bool widens = plan.gray_source && !plan.gray_result;
    ImageSpec fresh = result_spec(source, widens);
    if (!OIIO::ImageBufAlgo::IBAprep(roi, &dst, &src, nullptr, &fresh,
                                     OIIO::ImageBufAlgo::IBAprep_DST_FLOAT_PIXELS)) {
        throw Error(problem_of_library(dst.geterror()));
    }
    if (!dst.localpixels()) {
        fail(dst.has_error() ? first_line(dst.geterror()) : "destination cannot be written");
    }
    for (int c = color_count; c < chend; ++c) {
        const int to = widens ? c + 2 : c;
        if (to < dst.nchannels()) plan.copies.push_back({c, to});
    }

    if (roi.width() > 0 && roi.height() > 0 && roi.depth() > 0) {
        progress.begin(roi.npixels());
        std::atomic<bool> unreadable = false;
        std::exception_ptr error;
        std::mutex error_mutex;
        OIIO::ImageBufAlgo::parallel_image(roi, OIIO::paropt(nthreads), [&](ROI part) {
            // No exception may leave a thread of OIIO's pool.
            try {
                if (!RowRunner(with, plan, dst, src).run(part, progress)) unreadable = true;
            } catch (...) {
                const std::lock_guard lock(error_mutex);
                error = std::current_exception();
            }
        });
        if (error) std::rethrow_exception(error);
        if (progress.stopped())
            throw Error(Problem{.kind = Problem::Kind::canceled, .value = "canceled"});
        check_was_read(src, !unreadable);
    }
}

}  // namespace

void Tonemapper::State::run(ImageBuf& dst, const ImageBuf& src, ROI roi, int nthreads,
                            Progress& progress) const {
    check_source(src);
    const SourceColor source = source_color(described_spec(src), options.input);
    if (source.convert) {
        run(dst, converted_picture(src, source), roi, nthreads, progress);
        return;
    }
    if (!depends_on_picture) {
        const std::shared_ptr<const Prepared> prepared = prepared_for(source);
        if (prepared->to_light) {
            ScenePlanes light = read_light(src, *prepared->to_light, options.unpremult,
                                           options.exposure_stops, nthreads);
            light.exposure = static_cast<float>(std::exp2(options.exposure_stops));
            run_local_operator(prepared->view.op, light);
            run(*prepared, dst, src, roi, nthreads, progress, &light);
        } else {
            run(*prepared, dst, src, roi, nthreads, progress);
        }
        return;
    }
    // Statistics of the whole picture, so that regions match.
    const SceneStatistics statistics = measure_scene(src, options, {}, nthreads);
    State(*this, statistics).run(dst, src, roi, nthreads, progress);
}

std::shared_ptr<const Prepared> Tonemapper::State::prepared_for(const SourceColor& source) const {
    return prepared_.get(source.name, [&] {
        ProgramKey key = {source.name, {}, options.op.settings};
        if (!is_live_exposure(options.exposure_stops) && !is_local)
            key.fixed_exposure = options.exposure_stops;
        for (auto& [name, value] : key.settings) {
            if (statistics_.contains(name)) value.clear();
        }
        const std::shared_ptr<const Prepared> compiled = programs_->get(
            key, [&] { return Prepared(view_of(options, source), statistics_, options.mix); });
        // Making a view takes longer than all other steps, so only other statistics need a new one.
        View view = statistics_.empty() ? compiled->view : view_of(options, source);
        view.exposure_stops = options.exposure_stops;
        return Prepared(*compiled, std::move(view));
    });
}

void Tonemapper::State::run(const Prepared& with, ImageBuf& dst, const ImageBuf& src, ROI roi,
                            int nthreads, Progress& progress, const ScenePlanes* light) const {
    const PlanarMap engine = [&](const auto& in, std::ptrdiff_t in_stride, const auto& out,
                                 std::ptrdiff_t out_stride, std::size_t count) {
        with.engine.run(in, in_stride, out, out_stride, count);
    };
    const bool keeps_gray = channel_layout(picture_spec(src.spec())).is_gray && with.keeps_gray();
    run_picture(
        {engine, keeps_gray, with.view.op.label, options.unpremult, options.exposure_stops, light},
        dst, src, roi, nthreads, progress);
    change_spec(dst.specmod(), [&](PictureSpec& spec) { tag_as_result_of(with.view, spec); });
    if (options.dither) dst.specmod().attribute("oiio:dither", 1);
}

Tonemapper::Tonemapper(const TonemapOptions& options)
    : state_(std::make_unique<const State>(options)) {}
Tonemapper::~Tonemapper() = default;
Tonemapper::Tonemapper(Tonemapper&&) noexcept = default;
Tonemapper& Tonemapper::operator=(Tonemapper&&) noexcept = default;

const TonemapOptions& Tonemapper::options() const noexcept { return state_->options; }

bool Tonemapper::takes_statistics() const noexcept { return state_->depends_on_picture; }
bool Tonemapper::needs_whole_picture() const noexcept { return state_->is_local; }

Tonemapper::Tonemapper(std::unique_ptr<const State> state) : state_(std::move(state)) {}

Tonemapper Tonemapper::with_statistics(const SceneStatistics& statistics) const {
    return Tonemapper(std::make_unique<const State>(*state_, statistics));
}

Tonemapper Tonemapper::with_exposure(double stops) const {
    return Tonemapper(std::make_unique<const State>(*state_, stops));
}

void Tonemapper::run(ImageBuf& dst, const ImageBuf& src, ROI roi, int nthreads,
                     OIIO::ProgressCallback progress, void* progress_data) const {
    Progress reporter(progress, progress_data);
    state_->run(dst, src, roi, nthreads, reporter);
}

bool Tonemapper::operator()(ImageBuf& dst, const ImageBuf& src, ROI roi, int nthreads,
                            OIIO::ProgressCallback progress, void* progress_data) const noexcept {
    try {
        run(dst, src, roi, nthreads, progress, progress_data);
        return true;
    } catch (...) {
        return report_thrown(dst, "tonemap: ");
    }
}

bool tonemap(ImageBuf& dst, const ImageBuf& src, const TonemapOptions& options, ROI roi,
             int nthreads, OIIO::ProgressCallback progress, void* progress_data) noexcept {
    std::optional<Tonemapper> tonemapper;
    try {
        tonemapper.emplace(options);
    } catch (...) {
        return report_thrown(dst, "tonemap: ");
    }
    return (*tonemapper)(dst, src, roi, nthreads, progress, progress_data);
}

bool map_colors(ImageBuf& dst, const ImageBuf& src,
                const std::function<void(const float*, float*, std::size_t)>& map,
                TonemapOptions::Unpremult unpremult, ROI roi, int nthreads) noexcept {
    const PlanarMap planar = [&](const auto& in, std::ptrdiff_t in_stride, const auto& out,
                                 std::ptrdiff_t out_stride, std::size_t count) {
        std::array<float, 3 * kSpan> from{};
        std::array<float, 3 * kSpan> to{};
        for (std::size_t i = 0; i < count; ++i) {
            for (std::size_t c = 0; c < 3; ++c)
                from[3 * i + c] = in[c][static_cast<std::ptrdiff_t>(i) * in_stride];
        }
        map(from.data(), to.data(), count);
        for (std::size_t i = 0; i < count; ++i) {
            for (std::size_t c = 0; c < 3; ++c)
                out[c][static_cast<std::ptrdiff_t>(i) * out_stride] = to[3 * i + c];
        }
    };
    try {
        check_source(src);
        Progress untold(nullptr, nullptr);
        run_picture({planar, false, "the LUT", unpremult}, dst, src, roi, nthreads, untold);
        change_spec(dst.specmod(), tag_as_unknown);
        return true;
    } catch (...) {
        return report_thrown(dst, "");
    }
}

ImageBuf tonemap(const ImageBuf& src, const TonemapOptions& options, ROI roi, int nthreads,
                 OIIO::ProgressCallback progress, void* progress_data) noexcept {
    ImageBuf result;
    tonemap(result, src, options, roi, nthreads, progress, progress_data);
    return result;
}

TONEWRIGHT_NAMESPACE_END
