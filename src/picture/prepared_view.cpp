// SPDX-License-Identifier: Apache-2.0
#include "picture/prepared_view.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <string>
#include <utility>

#include "base/format_number.h"
#include "tonewright/error.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

/// Range of exposures, up and down, in stops, that a program takes as a number; it extends the
/// domain of its curves.
constexpr double kMostLiveStops = 16;

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

/// @param uniforms  the statistics that are live
LiveUniforms with_exposure(LiveUniforms uniforms, const View& view) {
    if (is_exposure_live(view))
        uniforms[std::string(kExposureUniform)] = {0, -kMostLiveStops, kMostLiveStops};
    return uniforms;
}

}  // namespace

bool is_live_exposure(double stops) { return stops != 0 && std::fabs(stops) <= kMostLiveStops; }

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

PreparedView::PreparedView(View v, const LiveUniforms& statistics, double mix)
    : view(std::move(v)),
      uniforms(with_exposure(statistics, view)),
      engine(mixed_stages(view, mix, uniforms), uniforms, view.op.op->bounds.simd_goal) {
    if (view.op.op->is_local()) to_light.emplace(light_stages(view));
}

PreparedView::PreparedView(const PreparedView& program, View v)
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

bool PreparedView::keeps_gray() const {
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

UniformValues PreparedView::values() const {
    UniformValues values;
    for (const auto& [name, uniform] : uniforms) {
        values[name] = name == kExposureUniform ? view.exposure_stops : view.op.params.number(name);
    }
    return values;
}

TONEWRIGHT_NAMESPACE_END
