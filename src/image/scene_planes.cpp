// SPDX-License-Identifier: Apache-2.0
#include "image/scene_planes.h"

#include <OpenImageIO/parallel.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <new>

#include "image/source_picture.h"
#include "image/spec_conversion.h"
#include "picture/row_tonemapper.h"
#include "picture/source_pixels.h"
#include "tonewright/tonemap.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

RowLoop row_loop(int nthreads) {
    return [nthreads](int count, const std::function<void(int, int)>& body) {
        std::atomic<bool> out_of_memory = false;
        const auto part = [&](std::int64_t begin, std::int64_t end) {
            // No exception may leave a thread of OIIO's pool.
            try {
                body(static_cast<int>(begin), static_cast<int>(end));
            } catch (const std::bad_alloc&) {
                out_of_memory = true;
            }
        };
        OIIO::parallel_for_chunked(0, count, 0, part, OIIO::paropt(nthreads));
        if (out_of_memory) throw std::bad_alloc();
    };
}

/// Reads the rows of one thread's part of a picture.
class LightReader {
  public:
    LightReader(const OIIO::ImageBuf& src, const SimdEngine& to_light, const ChannelLayout& layout,
                bool divides, double limit, ScenePlanes& light)
        : src_(src),
          to_light_(to_light),
          layout_(layout),
          divides_(divides),
          limit_(limit),
          light_(light),
          reader_(src) {}

    /// @param row  of the data window. @returns  false when it could not be read.
    bool read(int row) {
        const auto width = static_cast<std::size_t>(light_.width);
        for (std::size_t x = 0; x < width; x += kSpan) {
            const std::size_t n = std::min(kSpan, width - x);
            SpanSource source{nullptr, 0};
            if (!reader_.locate(src_.xbegin() + static_cast<int>(x), src_.ybegin() + row,
                                src_.zbegin(), n, source)) {
                return false;
            }
            read_span(source, static_cast<std::size_t>(row) * width + x, n);
        }
        return true;
    }

  private:
    void read_span(const SpanSource& source, std::size_t first, std::size_t n) noexcept {
        const std::array<float*, 3> rgb = {&light_.rgb[0][first], &light_.rgb[1][first],
                                           &light_.rgb[2][first]};
        load_color(src_.spec().format, layout_.is_gray, source, rgb, n);
        if (!light_.counts.empty()) {
            load_divisor(src_.spec().format, layout_.alpha, source, rgb, limit_, alpha_.data(),
                         &light_.counts[first], n);
            for (float* plane : rgb) {
                for (std::size_t i = 0; divides_ && i < n; ++i)
                    plane[i] /= alpha_[i];
            }
        }
        to_light_.run({rgb[0], rgb[1], rgb[2]}, 1, rgb, 1, n);
    }

    const OIIO::ImageBuf& src_;
    const SimdEngine& to_light_;
    ChannelLayout layout_;
    bool divides_;
    double limit_;
    ScenePlanes& light_;
    SpanReader reader_;
    std::array<float, kSpan> alpha_{};
};

}  // namespace

ScenePlanes read_light(const OIIO::ImageBuf& src, const SimdEngine& to_light,
                       TonemapOptions::Unpremult unpremult, double exposure_stops, int nthreads) {
    const PictureSpec spec = picture_spec(src.spec());
    const ChannelLayout layout = channel_layout(spec);
    check_flat(spec);
    ScenePlanes light;
    light.width = spec.width;
    light.height = spec.height;
    light.for_rows = row_loop(nthreads);
    const auto count = static_cast<std::size_t>(src.spec().image_pixels());
    for (std::vector<float>& plane : light.rgb)
        plane.resize(count);
    if (layout.alpha >= 0 && unpremult != TonemapOptions::Unpremult::no) light.counts.resize(count);
    const bool divides = divides_by_alpha(spec, unpremult);
    const double limit = surface_limit(unpremult, exposure_stops);
    std::atomic<bool> unreadable = false;
    light.for_rows(light.height, [&](int begin, int end) {
        LightReader reader(src, to_light, layout, divides, limit, light);
        for (int row = begin; row < end; ++row) {
            if (!reader.read(row)) unreadable = true;
        }
    });
    check_was_read(src, !unreadable);
    return light;
}

TONEWRIGHT_NAMESPACE_END
