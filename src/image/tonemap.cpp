// SPDX-License-Identifier: Apache-2.0
//
// tonemap() on OpenImageIO pictures.
//
// A picture is worked on in spans of at most kSpan pixels of one row: channels are gathered into
// planar float, whatever the pixel type, run through the engine, and scattered into the
// destination. No pixel type is known to the kernel.
//
// Operators with parameters that a picture has are prepared anew for each picture, from its
// statistics; all others once.
#include <OpenImageIO/imagebufalgo.h>
#include <OpenImageIO/imagebufalgo_util.h>
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <cstdint>
#include <functional>
#include <new>
#include <optional>

#include "image/color_tags.h"
#include "image/message.h"
#include "image/source_picture.h"
#include "tonewright/engine.h"
#include "tonewright/image.h"
#include "tonewright/view.h"

namespace tonewright {
namespace {

using OIIO::ImageBuf;
using OIIO::ImageSpec;
using OIIO::ROI;

struct CopiedChannel {
    int from;
    int to;
};

/// Which channel of the source goes where.
struct ChannelPlan {
    bool grey_source = false;  // channel 0 alone is color
    bool grey_result = false;
    int alpha = -1;  // of the source, to divide by and multiply with; -1: color is taken as it is
    std::vector<CopiedChannel> copies;
};

[[noreturn]] void fail(const std::string& message) { throw Error(message); }

/// The spec of a destination that does not exist yet.
ImageSpec result_spec(const ImageSpec& source, bool grey_becomes_color) {
    ImageSpec spec = source;
    if (grey_becomes_color) {
        const bool has_alpha = spec.nchannels == 2;
        spec.nchannels = has_alpha ? 4 : 3;
        spec.channelnames = {"R", "G", "B"};
        if (has_alpha) spec.channelnames.emplace_back("A");
        spec.alpha_channel = has_alpha ? 3 : -1;
        spec.z_channel = -1;
    }
    spec.set_format(OIIO::TypeFloat);
    spec.channelformats.clear();
    return spec;
}

View view_of(const TonemapOptions& options, const Settings& settings) {
    return make_view(resolve_operator(options.op, settings, options.look), options.input,
                     options.exposure_stops, options.display, options.reference_white);
}

/// True when a picture decides on some of the operator's parameters.
bool depends_on_picture(const TonemapOptions& options) {
    return options.statistics == TonemapOptions::Statistics::from_picture &&
           settings_for_picture(options.op, options.settings, {}).size() > options.settings.size();
}

/// Planar colors with strides, as SimdEngine::run() has them. In and out may be the same.
using PlanarMap = std::function<void(const std::array<const float*, 3>& in,
                                     std::ptrdiff_t in_stride, const std::array<float*, 3>& out,
                                     std::ptrdiff_t out_stride, std::size_t count)>;

/// What is done to a picture.
struct PictureMap {
    PlanarMap run;
    /// A grey picture stays one.
    bool keeps_grey = false;
    /// In messages.
    std::string label;
    TonemapOptions::Unpremult unpremult = TonemapOptions::Unpremult::automatic;
};

/// Runs it; the metadata is still that of the source. @throws Error
void run_picture(const PictureMap& with, ImageBuf& dst, const ImageBuf& src, ROI roi, int nthreads);

/// What a picture is run through.
struct Prepared {
    explicit Prepared(View v)
        : view(std::move(v)),
          engine(build_view(view), view.op.op->bounds.simd_goal),
          keeps_grey(keeps_greys(build_view(view))) {}

    View view;
    SimdEngine engine;
    bool keeps_grey;
};

}  // namespace

struct Tonemapper::State {
    explicit State(const TonemapOptions& o) : options(o) {
        View view = view_of(options, options.settings);
        if (!depends_on_picture(options)) prepared.emplace(std::move(view));
    }

    TonemapOptions options;
    /// Empty: made of each picture's statistics.
    std::optional<Prepared> prepared;

    void run(ImageBuf& dst, const ImageBuf& src, ROI roi, int nthreads) const;
    void run(const Prepared& with, ImageBuf& dst, const ImageBuf& src, ROI roi, int nthreads) const;
};

namespace {

/// Runs the rows of one thread's part of a picture.
class RowRunner {
  public:
    /// @throws std::bad_alloc
    RowRunner(const PlanarMap& map, const ChannelPlan& plan, ImageBuf& dst, const ImageBuf& src)
        : map_(map),
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
    }

    /// @returns  false when the source could not be read.
    bool run(const ROI& roi) {
        const ROI window = src_.roi();
        for (int z = roi.zbegin; z < roi.zend; ++z) {
            for (int y = roi.ybegin; y < roi.yend; ++y) {
                const bool row_inside =
                    y >= window.ybegin && y < window.yend && z >= window.zbegin && z < window.zend;
                const int from =
                    row_inside ? std::clamp(window.xbegin, roi.xbegin, roi.xend) : roi.xend;
                const int to = row_inside ? std::clamp(window.xend, from, roi.xend) : roi.xend;
                if (!run_part(roi.xbegin, from, y, z, false) || !run_part(from, to, y, z, true) ||
                    !run_part(to, roi.xend, y, z, false)) {
                    return false;
                }
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
            run_span(source, static_cast<std::byte*>(dst_.pixeladdr(x, y, z)), n);
            x += static_cast<int>(n);
        }
        return true;
    }

    void run_span(const SpanSource& source, std::byte* to, std::size_t n) {
        const std::ptrdiff_t to_stride = dst_.pixel_stride();
        if (!run_in_place_of_floats(source, to, to_stride, n)) {
            const std::array<float*, 3> rgb = {planes_.data(), planes_.data() + kSpan,
                                               planes_.data() + 2 * kSpan};
            load_color(source, rgb, n);
            const float* alpha = load_alpha(source, n);
            if (alpha) divide(rgb, alpha, n);
            map_({rgb[0], rgb[1], rgb[2]}, 1, rgb, 1, n);
            if (alpha) multiply(rgb, alpha, n);
            store_color(rgb, to, to_stride, n);
        }
        for (const CopiedChannel& channel : plan_.copies)
            copy(source, channel, to, to_stride, n);
    }

    /// Float to float without alpha needs no scratch: the engine reads and writes the pictures.
    bool run_in_place_of_floats(const SpanSource& source, std::byte* to, std::ptrdiff_t to_stride,
                                std::size_t n) {
        constexpr std::ptrdiff_t kFloat = sizeof(float);
        const auto aligned = [](const std::byte* p) {
            return reinterpret_cast<std::uintptr_t>(p) % alignof(float) == 0;
        };
        if (!source.pixels || plan_.grey_source || plan_.grey_result || plan_.alpha >= 0 ||
            src_type_ != OIIO::TypeFloat || dst_.spec().format != OIIO::TypeFloat ||
            source.stride % kFloat != 0 || to_stride % kFloat != 0 || !aligned(source.pixels) ||
            !aligned(to)) {
            return false;
        }
        const auto* in = reinterpret_cast<const float*>(source.pixels);
        auto* out = reinterpret_cast<float*>(to);
        map_({in, in + 1, in + 2}, source.stride / kFloat, {out, out + 1, out + 2},
             to_stride / kFloat, n);
        return true;
    }

    void load_color(const SpanSource& source, const std::array<float*, 3>& rgb,
                    std::size_t n) const noexcept {
        for (std::size_t c = 0; c < 3; ++c) {
            if (!source.pixels) {
                std::fill_n(rgb[c], n, 0.0F);
            } else if (plan_.grey_source && c > 0) {
                std::copy_n(rgb[0], n, rgb[c]);
            } else {
                src_access_.load_float(source.pixels + static_cast<std::ptrdiff_t>(c) * src_size_,
                                       source.stride, rgb[c], n);
            }
        }
    }

    /// The alpha to divide by, with 1 where there is nothing to divide by; or null.
    const float* load_alpha(const SpanSource& source, std::size_t n) noexcept {
        if (plan_.alpha < 0 || !source.pixels) return nullptr;
        float* alpha = planes_.data() + 3 * kSpan;
        src_access_.load_float(source.pixels + plan_.alpha * src_size_, source.stride, alpha, n);
        for (std::size_t i = 0; i < n; ++i) {
            if (alpha[i] == 0 || !std::isfinite(alpha[i])) alpha[i] = 1;
        }
        return alpha;
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
        if (plan_.grey_result) {
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
    std::vector<double> wide_;   // copied channels whose type changes; double holds every type
};

void run_picture(const PictureMap& with, ImageBuf& dst, const ImageBuf& src, ROI roi,
                 int nthreads) {
    const ImageSpec& source = src.spec();
    if (dst.deep()) fail("destination is deep; expected flat pixels (oiiotool --flatten)");
    if (dst.initialized()) check_pixel_type("destination", dst.spec().format);

    ChannelPlan plan;
    const ChannelLayout layout = channel_layout(source);
    plan.grey_source = layout.is_grey;
    const int color_count = plan.grey_source ? 1 : 3;
    const int chbegin = roi.defined() ? std::max(roi.chbegin, 0) : 0;
    const int chend = roi.defined() ? std::min(roi.chend, source.nchannels) : source.nchannels;
    if (chbegin > 0 || chend < color_count) {
        fail(fmt::format(
            "channel range is [{}, {}); expected it to begin at 0 and to hold all {} of "
            "color",
            roi.chbegin, roi.chend, color_count));
    }

    // A grey result takes one channel, unless the destination has a place for three.
    const bool wide_destination = dst.initialized() && dst.nchannels() >= 3;
    plan.grey_result = plan.grey_source && with.keeps_grey && !wide_destination;
    if (dst.initialized() && !plan.grey_result && dst.nchannels() < 3) {
        fail(fmt::format("destination has {}; expected 3 or more: {}",
                         dst.nchannels() == 1 ? "1 channel" : "2 channels",
                         plan.grey_source ? with.label + " shows this grey picture in color"
                                          : std::string("the picture is in color")));
    }
    if (layout.alpha >= 0 && divides_by_alpha(source, with.unpremult)) plan.alpha = layout.alpha;

    const bool widens = plan.grey_source && !plan.grey_result;
    ImageSpec fresh = result_spec(source, widens);
    if (!OIIO::ImageBufAlgo::IBAprep(roi, &dst, &src, nullptr, &fresh,
                                     OIIO::ImageBufAlgo::IBAprep_DST_FLOAT_PIXELS)) {
        fail(first_line(dst.geterror()));
    }
    if (!dst.localpixels()) {
        fail(dst.has_error() ? first_line(dst.geterror()) : "destination cannot be written");
    }
    for (int c = color_count; c < chend; ++c) {
        const int to = widens ? c + 2 : c;
        if (to < dst.nchannels()) plan.copies.push_back({c, to});
    }

    if (roi.width() > 0 && roi.height() > 0 && roi.depth() > 0) {
        std::atomic<bool> unreadable = false;
        std::atomic<bool> out_of_memory = false;
        OIIO::ImageBufAlgo::parallel_image(roi, OIIO::paropt(nthreads), [&](ROI part) {
            // No exception may leave a thread of OIIO's pool.
            try {
                if (!RowRunner(with.run, plan, dst, src).run(part)) unreadable = true;
            } catch (const std::bad_alloc&) {
                out_of_memory = true;
            }
        });
        if (out_of_memory) throw std::bad_alloc();
        check_was_read(src, !unreadable);
    }
}

}  // namespace

void Tonemapper::State::run(ImageBuf& dst, const ImageBuf& src, ROI roi, int nthreads) const {
    check_source(src);
    if (prepared) {
        run(*prepared, dst, src, roi, nthreads);
        return;
    }
    // Of the whole picture, whatever the region: its parts must fit together.
    const SceneStatistics statistics =
        measure_scene(src, options.input, options.unpremult, {}, nthreads);
    const Settings settings = settings_for_picture(options.op, options.settings, statistics);
    run(Prepared(view_of(options, settings)), dst, src, roi, nthreads);
}

void Tonemapper::State::run(const Prepared& with, ImageBuf& dst, const ImageBuf& src, ROI roi,
                            int nthreads) const {
    const PlanarMap engine = [&](const auto& in, std::ptrdiff_t in_stride, const auto& out,
                                 std::ptrdiff_t out_stride, std::size_t count) {
        with.engine.run(in, in_stride, out, out_stride, count);
    };
    run_picture({engine, with.keeps_grey, with.view.op.label, options.unpremult}, dst, src, roi,
                nthreads);
    tag_as_result_of(with.view, dst.specmod());
}

Tonemapper::Tonemapper(const TonemapOptions& options)
    : state_(std::make_unique<const State>(options)) {}
Tonemapper::~Tonemapper() = default;
Tonemapper::Tonemapper(Tonemapper&&) noexcept = default;
Tonemapper& Tonemapper::operator=(Tonemapper&&) noexcept = default;

const TonemapOptions& Tonemapper::options() const noexcept { return state_->options; }

bool Tonemapper::takes_statistics() const noexcept { return !state_->prepared; }

Tonemapper Tonemapper::with_statistics(const SceneStatistics& statistics) const {
    TonemapOptions options = state_->options;
    options.settings = settings_for_picture(options.op, options.settings, statistics);
    options.statistics = TonemapOptions::Statistics::defaults;
    return Tonemapper(options);
}

Tonemapper Tonemapper::with_exposure(double stops) const {
    TonemapOptions options = state_->options;
    options.exposure_stops = stops;
    return Tonemapper(options);
}

bool Tonemapper::operator()(ImageBuf& dst, const ImageBuf& src, ROI roi,
                            int nthreads) const noexcept {
    try {
        state_->run(dst, src, roi, nthreads);
        return true;
    } catch (const std::exception& e) {
        dst.errorfmt("tonemap: {}", e.what());
        return false;
    }
}

bool tonemap(ImageBuf& dst, const ImageBuf& src, const TonemapOptions& options, ROI roi,
             int nthreads) noexcept {
    std::optional<Tonemapper> tonemapper;
    try {
        tonemapper.emplace(options);
    } catch (const std::exception& e) {
        dst.errorfmt("tonemap: {}", e.what());
        return false;
    }
    return (*tonemapper)(dst, src, roi, nthreads);
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
        run_picture({planar, false, "the LUT", unpremult}, dst, src, roi, nthreads);
        tag_as_unknown(dst.specmod());
        return true;
    } catch (const std::exception& e) {
        dst.errorfmt("{}", e.what());
        return false;
    }
}

ImageBuf tonemap(const ImageBuf& src, const TonemapOptions& options, ROI roi,
                 int nthreads) noexcept {
    ImageBuf result;
    tonemap(result, src, options, roi, nthreads);
    return result;
}

}  // namespace tonewright
