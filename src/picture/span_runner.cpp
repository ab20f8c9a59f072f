// SPDX-License-Identifier: Apache-2.0
#include "picture/span_runner.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdint>
#include <string>

#include "tonewright/error.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

/// More channels are not converted together.
constexpr int kMostChannels = 8;

void divide(const std::array<float*, 3>& rgb, const float* alpha, std::size_t n) noexcept {
    for (float* plane : rgb) {
        for (std::size_t i = 0; i < n; ++i)
            plane[i] /= alpha[i];
    }
}
void multiply(const std::array<float*, 3>& rgb, const float* alpha, std::size_t n) noexcept {
    for (float* plane : rgb) {
        for (std::size_t i = 0; i < n; ++i)
            plane[i] *= alpha[i];
    }
}

std::size_t values_of(const PixelLayout& picture) {
    return kSpan * static_cast<std::size_t>(picture.channels);
}

}  // namespace

ChannelPlan plan_channels(const PictureSpec& source, const PictureMap& with, int result_channels) {
    ChannelPlan plan;
    const ChannelLayout layout = channel_layout(source);
    plan.gray_source = layout.is_gray;
    // A gray result takes one channel, unless the destination has three.
    plan.gray_result = plan.gray_source && with.keeps_gray && result_channels < 3;
    if (result_channels > 0 && !plan.gray_result && result_channels < 3) {
        throw Error(fmt::format("destination has {}; expected 3 or more: {}",
                                result_channels == 1 ? "1 channel" : "2 channels",
                                plan.gray_source ? with.label + " shows this gray picture in color"
                                                 : std::string("the picture is in color")));
    }
    if (layout.alpha >= 0 && divides_by_alpha(source, with.unpremult)) plan.alpha = layout.alpha;
    plan.surface_limit = surface_limit(with.unpremult, with.exposure_stops);
    return plan;
}

void plan_copies(ChannelPlan& plan, int channel_end, int result_channels) {
    for (int c = plan.color_count(); c < channel_end; ++c) {
        const int to = plan.widens() ? c + 2 : c;
        if (to < result_channels) plan.copies.push_back({c, to});
    }
}

PictureSpec float_spec(const PictureSpec& source, bool widens) {
    PictureSpec spec = source;
    if (widens) {
        const bool has_alpha = spec.nchannels == 2;
        spec.nchannels = has_alpha ? 4 : 3;
        spec.channelnames = {"R", "G", "B"};
        if (has_alpha) spec.channelnames.emplace_back("A");
        spec.alpha_channel = has_alpha ? 3 : -1;
        spec.z_channel = -1;
    }
    spec.format = OIIO::TypeFloat;
    spec.channelformats.clear();
    complete_channel_names(spec);
    return spec;
}

SpanRunner::SpanRunner(const PictureMap& with, const ChannelPlan& plan, const PixelLayout& source,
                       const PixelLayout& result, bool is_in_place)
    : map_(with),
      plan_(plan),
      src_(source),
      dst_(result),
      src_access_(*pixel_access(source.type)),
      dst_access_(*pixel_access(result.type)),
      src_size_(static_cast<std::ptrdiff_t>(size_of(source.type))),
      dst_size_(static_cast<std::ptrdiff_t>(size_of(result.type))),
      planes_(kSpan * (plan.alpha >= 0 ? 4 : 3)) {
    if (src_.type != dst_.type && !plan.copies.empty()) wide_.resize(kSpan);
    if (src_.type != OIIO::TypeFloat && src_.channels <= kMostChannels)
        from_.resize(values_of(src_));
    // Copied channels are written last; in place they would be gone by then.
    const auto count = static_cast<int>(plan.copies.size());
    if (dst_.type != OIIO::TypeFloat && dst_.channels <= kMostChannels &&
        dst_.channels == 3 + count && (count == 0 || !is_in_place)) {
        to_.resize(values_of(dst_));
    }
}

void SpanRunner::run(const SpanSource& source, std::size_t light_index, std::byte* to,
                     std::ptrdiff_t to_stride, std::size_t n) {
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
            if (divides || !map_.light)
                load_color(floats.type, plan_.gray_source, floats.source, rgb, n);
            if (divides) {
                load_divisor(floats.type, plan_.alpha, floats.source, rgb, plan_.surface_limit,
                             divisor, nullptr, n);
            }
            if (map_.light) {  // which is divided already
                for (std::size_t c = 0; c < 3; ++c)
                    std::copy_n(&map_.light->rgb[c][light_index], n, rgb[c]);
            } else if (divides) {
                divide(rgb, divisor, n);
            }
        }
        map_.run({rgb[0], rgb[1], rgb[2]}, 1, rgb, 1, n);
        if (divides) multiply(rgb, divisor, n);
        store_color(rgb, to, to_stride, n);
    }
    for (const ChannelPlan::Copy& channel : plan_.copies)
        copy(source, channel, to, to_stride, n);
}

SpanRunner::FloatSpan SpanRunner::as_floats(const SpanSource& source, std::size_t n) {
    if (!source.pixels || from_.empty() || source.stride != src_.channels * src_size_)
        return {source, src_.type};
    src_access_.run_to_float(source.pixels, from_.data(),
                             n * static_cast<std::size_t>(src_.channels));
    return {{reinterpret_cast<const std::byte*>(from_.data()),
             src_.channels * static_cast<std::ptrdiff_t>(sizeof(float))},
            OIIO::TypeFloat};
}

/// Interleaved floats need no planes: the engine reads and writes the pictures or their converted
/// copies.
bool SpanRunner::run_interleaved(const FloatSpan& from, std::byte* to, std::ptrdiff_t to_stride,
                                 std::size_t n) {
    constexpr std::ptrdiff_t kFloat = sizeof(float);
    const auto is_aligned = [](const std::byte* p, std::ptrdiff_t stride) {
        return reinterpret_cast<std::uintptr_t>(p) % alignof(float) == 0 && stride % kFloat == 0;
    };
    const std::byte* pixels = from.source.pixels;
    if (!pixels || map_.light || plan_.gray_source || plan_.gray_result ||
        from.type != OIIO::TypeFloat || !is_aligned(pixels, from.source.stride)) {
        return false;
    }
    const bool converts = !to_.empty() && to_stride == dst_.channels * dst_size_;
    const bool is_float = dst_.type == OIIO::TypeFloat && is_aligned(to, to_stride);
    if (!converts && !is_float) return false;
    const auto* in = reinterpret_cast<const float*>(pixels);
    float* out = converts ? to_.data() : reinterpret_cast<float*>(to);
    map_.run({in, in + 1, in + 2}, from.source.stride / kFloat, {out, out + 1, out + 2},
             converts ? dst_.channels : to_stride / kFloat, n);
    if (converts) dst_access_.run_from_float(out, to, n * static_cast<std::size_t>(dst_.channels));
    return true;
}

/// False if there is no alpha to divide by, or if all divisors are 1.
bool SpanRunner::needs_division(const FloatSpan& from, std::size_t n) noexcept {
    if (plan_.alpha < 0 || !from.source.pixels) return false;
    float* alpha = planes_.data() + 3 * kSpan;
    const std::size_t offset = static_cast<std::size_t>(plan_.alpha) * size_of(from.type);
    pixel_access(from.type)->load_float(from.source.pixels + offset, from.source.stride, alpha, n);
    return !std::all_of(alpha, alpha + n, [](float a) { return divisor_of(a, 0.0F, 0.0F) == 1; });
}

void SpanRunner::store_color(const std::array<float*, 3>& rgb, std::byte* to,
                             std::ptrdiff_t to_stride, std::size_t n) const noexcept {
    if (plan_.gray_result) {
        // The three agree within half a code value; green is nearest to luminance.
        dst_access_.store_float(rgb[1], to, to_stride, n);
        return;
    }
    for (std::size_t c = 0; c < 3; ++c) {
        dst_access_.store_float(rgb[c], to + static_cast<std::ptrdiff_t>(c) * dst_size_, to_stride,
                                n);
    }
}

void SpanRunner::copy(const SpanSource& source, const ChannelPlan::Copy& channel, std::byte* to,
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

TONEWRIGHT_NAMESPACE_END
