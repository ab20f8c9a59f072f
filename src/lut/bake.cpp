// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include "base/format_number.h"
#include "lut/ringing.h"
#include "measure/error_metric.h"
#include "tonewright/lut.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

BakedLut measured(Lut lut, const LutRequest& request, LutInterpolation interpolation,
                  bool is_fitted) {
    quantize(lut, request);
    const LutError error = measure_lut(lut, request, interpolation);
    LutRinging ringing = measure_ringing(lut, request, interpolation);
    return {std::move(lut), error, {}, is_fitted, std::move(ringing)};
}

/// The bounds of `smooth`, as they were when it was the default.
constexpr double kSmoothFall = 1.0 / 255;
constexpr RayBounds kSmoothBounds = {.largest_fall = 0.6 * kSmoothFall, .has_band = true};

bool has_no_smooth_ring(const LutRinging& ringing) { return ringing.fall <= kSmoothFall; }

/// Fits nodes that follow the operator along rising exposure, if possible.
BakedLut smooth(Lut lut, const LutRequest& request, LutInterpolation interpolation,
                bool is_fitted) {
    BakedLut baked = measured(lut, request, interpolation, is_fitted);
    // If the operator clips colors of the domain, no nodes help: successful repairs started below
    // this error.
    constexpr double kHopeless = 0.3;
    const LutRinging& ringing = baked.ringing;
    if ((has_no_smooth_ring(ringing) && ringing.p999 <= kFittedRayError) ||
        ringing.p999 > kHopeless)
        return baked;
    RayFit(lut, request, interpolation, RayNodes::all).fit(lut, kSmoothBounds);
    BakedLut calm = measured(std::move(lut), request, interpolation, is_fitted);
    const bool was_right = has_no_smooth_ring(baked.ringing);
    const bool is_better = has_no_smooth_ring(calm.ringing) == was_right
                               ? calm.ringing.p999 < baked.ringing.p999
                               : !was_right;
    return is_better ? calm : baked;
}

LutInterpolation other(LutInterpolation interpolation) {
    return interpolation == LutInterpolation::trilinear ? LutInterpolation::tetrahedral
                                                        : LutInterpolation::trilinear;
}

/// Also measures the other interpolation.
BakedLut complete(BakedLut baked, const LutRequest& request, LutInterpolation interpolation) {
    if (baked.lut.dimension == 3)
        baked.other_error = measure_lut(baked.lut, request, other(interpolation));
    return baked;
}

/// The LUT of LutNodes::smooth: sampled or fitted, whichever is better along the rays.
BakedLut bake_smooth(const LutRequest& request, const Lut& sampled,
                     LutInterpolation interpolation) {
    BakedLut fitted = smooth(fit_lut(request, sampled), request, interpolation, true);
    BakedLut plain = smooth(sampled, request, interpolation, false);
    for (bool (*is_right)(const LutRinging&) : {+[](const LutRinging& ringing) {
                                                    return has_no_smooth_ring(ringing) &&
                                                           ringing.p999 <= kLargestRayError;
                                                },
                                                has_no_smooth_ring}) {
        const bool fitted_is_right = is_right(fitted.ringing);
        if (fitted_is_right == is_right(plain.ringing)) continue;
        return fitted_is_right ? fitted : plain;
    }
    const bool is_nearer =
        fitted.error.mean <= plain.error.mean && fitted.error.p999 <= plain.error.p999;
    return is_nearer ? fitted : plain;
}

/// The LUT without rings that is nearest to the operator on photographs.
BakedLut bake_for_photographs(const LutRequest& request, const Lut& sampled,
                              LutInterpolation interpolation) {
    // With more, colors that photographs lack get worse; with less, photographs do (measured on
    // five operators).
    constexpr double kPhotographShare = 0.8;
    // Rings are the worst, because everybody sees them. The 99.9th percentile is about ten times
    // the mean. Lamps that follow the operator may cost a quarter.
    const auto badness = [](const BakedLut& baked) {
        constexpr double kLamps = 1.25;
        const PhotographError& e = baked.error.photographs;
        return (e.p999 + 10 * e.mean) * (follows_operator(baked.ringing) ? 1 : kLamps);
    };
    const auto is_better = [&](const BakedLut& a, const BakedLut& b) {
        return rings(a.ringing) == rings(b.ringing) ? badness(a) < badness(b) : rings(b.ringing);
    };
    const RayFit rays(sampled, request, interpolation, RayNodes::unused);
    const auto without_falls = [&](Lut& lut) { rays.fit(lut, {}); };
    const Lut fitted = fit_lut(request, sampled, kPhotographShare, without_falls);
    BakedLut best = measured(fitted, request, interpolation, true);
    const auto offer = [&](Lut lut, bool is_fitted) {
        BakedLut baked = measured(std::move(lut), request, interpolation, is_fitted);
        if (is_better(baked, best)) best = std::move(baked);
    };
    if (!follows_operator(best.ringing)) {
        Lut near_lamps = fitted;
        rays.fit(near_lamps, {.has_band = true});
        offer(std::move(near_lamps), true);
    }
    Lut plain = sampled;
    without_falls(plain);
    offer(std::move(plain), false);
    return best;
}

BakedLut bake_size(const LutRequest& request, LutNodes nodes, LutInterpolation interpolation) {
    const Lut sampled = sample_lut(request);
    if (sampled.dimension == 1 || nodes == LutNodes::sampled)
        return measured(sampled, request, interpolation, false);
    if (nodes == LutNodes::fitted)
        return measured(fit_lut(request, sampled), request, interpolation, true);
    if (nodes == LutNodes::smooth) return bake_smooth(request, sampled, interpolation);
    return bake_for_photographs(request, sampled, interpolation);
}

/// Sizes to try; each format uses those that it supports.
std::vector<int> sizes_of(LutFormat format) {
    if (format == LutFormat::hald) return {16, 25, 36, 49, 64, 81, 100, 121, 144};
    if (is_strip(format)) return {16, 32, 64};
    if (format == LutFormat::threedl) return {17, 33, 65};
    return {17, 25, 33, 49, 65, 97, 129};
}

}  // namespace

BakedLut bake_lut(const LutRequest& request, LutNodes nodes, LutInterpolation interpolation,
                  std::optional<double> max_error, int largest_size) {
    if (!max_error)
        return complete(bake_size(request, nodes, interpolation), request, interpolation);
    if (request.size) {
        throw Error({.parameter = "size",
                     .value = std::to_string(*request.size),
                     .expected = "no size with <<max_error>>"});
    }
    if (!(*max_error > 0))
        throw Error(
            {.parameter = "max_error", .value = shortest(*max_error), .expected = "above 0"});
    // A 1D table chooses its own number of entries.
    BakedLut baked = bake_size(request, nodes, interpolation);
    if (baked.lut.dimension == 1 && baked.error.photographs.p999 <= *max_error) return baked;
    if (baked.lut.dimension == 3) {
        LutRequest sized = request;
        for (const int size : sizes_of(request.format)) {
            if (size > largest_size) break;
            sized.size = size;
            baked = bake_size(sized, nodes, interpolation);
            if (baked.error.photographs.p999 <= *max_error)
                return complete(std::move(baked), sized, interpolation);
        }
    }
    throw Error({.parameter = "max_error",
                 .value = shortest(*max_error),
                 .expected = fmt::format("at least {}, which {} {} has on photographs",
                                         rounded_up(baked.error.photographs.p999),
                                         name_of(request.format), baked.lut.size)});
}

TONEWRIGHT_NAMESPACE_END
