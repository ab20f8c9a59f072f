// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <OpenImageIO/typedesc.h>

#include <array>
#include <cstddef>
#include <functional>
#include <string>
#include <vector>

#include "picture/picture_spec.h"
#include "picture/pixel_access.h"
#include "picture/source_pixels.h"
#include "tonewright/local.h"
#include "tonewright/tonemap_options.h"

/// The colors of a picture's pixels through a function, in spans of at most kSpan pixels of one
/// row: channels of any pixel type are gathered into planar float, run through the function, and
/// scattered into the result.
TONEWRIGHT_NAMESPACE_BEGIN

/// Planar colors with strides, as in SimdEngine::run(). In and out may be the same.
using PlanarMap = std::function<void(const std::array<const float*, 3>& in,
                                     std::ptrdiff_t in_stride, const std::array<float*, 3>& out,
                                     std::ptrdiff_t out_stride, std::size_t count)>;

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

/// Maps channels of the source to the result.
struct ChannelPlan {
    struct Copy {
        int from;
        int to;
    };
    bool gray_source = false;  // channel 0 alone is color
    bool gray_result = false;
    int alpha = -1;  // of the source, to divide by and multiply with; -1: color is taken as it is
    double surface_limit = 0;  // for divisor_of()
    std::vector<Copy> copies;

    [[nodiscard]] int color_count() const { return gray_source ? 1 : 3; }
    /// A gray picture gets three channels.
    [[nodiscard]] bool widens() const { return gray_source && !gray_result; }
};

/// @param result_channels  of a result that exists; 0: it is made for the plan
/// @throws PictureError  @see channel_layout
/// @throws Error         a result with too few channels
[[nodiscard]] TONEWRIGHT_API ChannelPlan plan_channels(const PictureSpec& source,
                                                       const PictureMap& with, int result_channels);
/// Adds the copies of all channels that are no color.
/// @param channel_end  the first channel of the source that is left out
TONEWRIGHT_API void plan_copies(ChannelPlan& plan, int channel_end, int result_channels);

/// The spec of a new result: floats, with the metadata of the source.
[[nodiscard]] TONEWRIGHT_API PictureSpec float_spec(const PictureSpec& source, bool widens);

/// Pixels of a picture in memory.
struct PixelLayout {
    OIIO::TypeDesc type;
    int channels = 0;
};

/// Runs spans. One for each thread.
class TONEWRIGHT_API SpanRunner {
  public:
    /// @param with, plan   outlive it
    /// @param is_in_place  source and result are the same memory
    /// @throws std::bad_alloc
    SpanRunner(const PictureMap& with, const ChannelPlan& plan, const PixelLayout& source,
               const PixelLayout& result, bool is_in_place);

    /// @param light_index  of the first pixel in PictureMap::light
    /// @param to_stride    bytes from pixel to pixel
    /// @param n            at most kSpan
    void run(const SpanSource& source, std::size_t light_index, std::byte* to,
             std::ptrdiff_t to_stride, std::size_t n);

  private:
    /// All channels of the source as floats, if one conversion can do this; otherwise unchanged.
    struct FloatSpan {
        SpanSource source;
        OIIO::TypeDesc type;
    };
    [[nodiscard]] FloatSpan as_floats(const SpanSource& source, std::size_t n);
    bool run_interleaved(const FloatSpan& from, std::byte* to, std::ptrdiff_t to_stride,
                         std::size_t n);
    [[nodiscard]] bool needs_division(const FloatSpan& from, std::size_t n) noexcept;
    void store_color(const std::array<float*, 3>& rgb, std::byte* to, std::ptrdiff_t to_stride,
                     std::size_t n) const noexcept;
    void copy(const SpanSource& source, const ChannelPlan::Copy& channel, std::byte* to,
              std::ptrdiff_t to_stride, std::size_t n) noexcept;

    const PictureMap& map_;
    const ChannelPlan& plan_;
    PixelLayout src_;
    PixelLayout dst_;
    const PixelAccess& src_access_;
    const PixelAccess& dst_access_;
    std::ptrdiff_t src_size_;
    std::ptrdiff_t dst_size_;
    std::vector<float> planes_;  // r, g, b (, alpha)
    /// All channels of a span, converted together. Empty if no conversion is needed, or if they are
    /// too many for the first-level cache.
    std::vector<float> from_, to_;
    std::vector<double> wide_;  // copied channels whose type changes; double holds every type
};

TONEWRIGHT_NAMESPACE_END
