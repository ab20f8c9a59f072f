// SPDX-License-Identifier: Apache-2.0
//
// tonemap() on OpenImageIO pictures: regions, data windows and cached pictures. RowTonemapper and
// SpanRunner do the rest.
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

#include "base/strings.h"
#include "image/converted_picture.h"
#include "image/report_thrown.h"
#include "image/scene_planes.h"
#include "image/source_picture.h"
#include "image/spec_conversion.h"
#include "image/tonemap_file.h"
#include "picture/color_tags.h"
#include "picture/picture_description.h"
#include "picture/row_tonemapper.h"
#include "picture/source_pixels.h"
#include "picture/span_runner.h"
#include "tonewright/tonemap.h"
#include "tonewright/view.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

using OIIO::ImageBuf;
using OIIO::ImageSpec;
using OIIO::ROI;

[[noreturn]] void fail(const std::string& message) { throw Error(message); }

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

/// Runs it; the metadata is still that of the source. @throws Error
void run_picture(const PictureMap& with, ImageBuf& dst, const ImageBuf& src, ROI roi, int nthreads,
                 Progress& progress);

}  // namespace

struct Tonemapper::State {
    RowTonemapper rows;

    void run(ImageBuf& dst, const ImageBuf& src, ROI roi, int nthreads, Progress& progress) const;

  private:
    void run(const PreparedView& with, ImageBuf& dst, const ImageBuf& src, ROI roi, int nthreads,
             Progress& progress, const ScenePlanes* light = nullptr) const;
};

namespace {

/// Runs the rows of one thread's part of a picture.
class RowRunner {
  public:
    /// @throws std::bad_alloc
    RowRunner(const PictureMap& with, const ChannelPlan& plan, ImageBuf& dst, const ImageBuf& src)
        : dst_(dst),
          src_(src),
          reader_(src),
          spans_(with, plan, {src.spec().format, src.nchannels()},
                 {dst.spec().format, dst.nchannels()}, dst.localpixels() == src.localpixels()) {}

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
            spans_.run(source, index_of(x, y), static_cast<std::byte*>(dst_.pixeladdr(x, y, z)),
                       dst_.pixel_stride(), n);
            x += static_cast<int>(n);
        }
        return true;
    }

    /// Index of a pixel in the planes of the data window.
    [[nodiscard]] std::size_t index_of(int x, int y) const noexcept {
        return static_cast<std::size_t>(y - src_.ybegin()) *
                   static_cast<std::size_t>(src_.spec().width) +
               static_cast<std::size_t>(x - src_.xbegin());
    }

    ImageBuf& dst_;
    const ImageBuf& src_;
    SpanReader reader_;
    SpanRunner spans_;
};

void run_picture(const PictureMap& with, ImageBuf& dst, const ImageBuf& src, ROI roi, int nthreads,
                 Progress& progress) {
    if (dst.deep()) fail("destination is deep; expected flat pixels (oiiotool --flatten)");
    if (dst.initialized()) check_pixel_type("destination", dst.spec().format);

    const PictureSpec source = picture_spec(src.spec());
    const int color_count = channel_layout(source).is_gray ? 1 : 3;
    const int chbegin = roi.defined() ? std::max(roi.chbegin, 0) : 0;
    const int chend = roi.defined() ? std::min(roi.chend, source.nchannels) : source.nchannels;
    if (chbegin > 0 || chend < color_count) {
        fail(fmt::format(
            "channel range is [{}, {}); expected a range from 0 that has all {} channels of "
            "color",
            roi.chbegin, roi.chend, color_count));
    }
    ChannelPlan plan = plan_channels(source, with, dst.initialized() ? dst.nchannels() : 0);
    ImageSpec fresh = image_spec(float_spec(source, plan.widens()));
    if (!OIIO::ImageBufAlgo::IBAprep(roi, &dst, &src, nullptr, &fresh,
                                     OIIO::ImageBufAlgo::IBAprep_DST_FLOAT_PIXELS)) {
        throw Error(problem_of_library(dst.geterror()));
    }
    if (!dst.localpixels()) {
        fail(dst.has_error() ? first_line(dst.geterror()) : "destination cannot be written");
    }
    plan_copies(plan, chend, dst.nchannels());

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
    const TonemapOptions& options = rows.options();
    check_source(src);
    const SourceColor source = source_color(described_spec(src), options.input);
    if (source.convert) {
        run(dst, converted_picture(src, source), roi, nthreads, progress);
        return;
    }
    if (!rows.takes_statistics()) {
        const std::shared_ptr<const PreparedView> prepared = rows.prepared_for(source);
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
    State{rows.with_statistics(statistics)}.run(dst, src, roi, nthreads, progress);
}

void Tonemapper::State::run(const PreparedView& with, ImageBuf& dst, const ImageBuf& src, ROI roi,
                            int nthreads, Progress& progress, const ScenePlanes* light) const {
    PictureMap map = rows.map_of(with, picture_spec(src.spec()));
    map.light = light;
    run_picture(map, dst, src, roi, nthreads, progress);
    change_spec(dst.specmod(), [&](PictureSpec& spec) { rows.tag_result(with, spec); });
}

Tonemapper::Tonemapper(const TonemapOptions& options)
    : Tonemapper(std::make_unique<const State>(State{RowTonemapper(options)})) {}
Tonemapper::~Tonemapper() = default;
Tonemapper::Tonemapper(Tonemapper&&) noexcept = default;
Tonemapper& Tonemapper::operator=(Tonemapper&&) noexcept = default;

const TonemapOptions& Tonemapper::options() const noexcept { return state_->rows.options(); }

bool Tonemapper::takes_statistics() const noexcept { return state_->rows.takes_statistics(); }
bool Tonemapper::needs_whole_picture() const noexcept { return state_->rows.needs_whole_picture(); }

Tonemapper::Tonemapper(std::unique_ptr<const State> state) : state_(std::move(state)) {}

Tonemapper Tonemapper::with_statistics(const SceneStatistics& statistics) const {
    return Tonemapper(
        std::make_unique<const State>(State{state_->rows.with_statistics(statistics)}));
}

Tonemapper Tonemapper::with_exposure(double stops) const {
    return Tonemapper(std::make_unique<const State>(State{state_->rows.with_exposure(stops)}));
}

const RowTonemapper& rows_of(const Tonemapper& tonemapper) { return tonemapper.state_->rows; }

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
