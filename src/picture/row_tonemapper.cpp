// SPDX-License-Identifier: Apache-2.0
#include "picture/row_tonemapper.h"

#include <fmt/format.h>

#include <algorithm>
#include <optional>
#include <string>
#include <utility>

#include "base/bounded_cache.h"
#include "base/strings.h"
#include "lut/in_parallel.h"
#include "picture/color_tags.h"
#include "picture/picture_description.h"
#include "picture/source_pixels.h"
#include "tonewright/error.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

View view_of(const TonemapOptions& options, const SourceColor& source) {
    return make_view(options.op, in_units(source, options.input_units), options.exposure_stops,
                     options.display, options.reference_white);
}

/// True if some of the operator's parameters come from a picture.
bool depends_on_picture(const TonemapOptions& options) {
    if (!options.op.op) throw Error("op is missing; expected a resolved operator");
    return options.statistics == TonemapOptions::Statistics::from_picture &&
           takes_statistics(options.op);
}

}  // namespace

void check_flat(const PictureSpec& source) {
    if (source.depth <= 1) return;
    throw Error(
        fmt::format("picture has {} slices; expected one: local operators work on flat pictures",
                    source.depth));
}

struct RowTonemapper::State {
    explicit State(const TonemapOptions& o)
        : options(o),
          depends_on_picture(tonewright::depends_on_picture(options)),
          programs(std::make_shared<BoundedCache<ProgramKey, PreparedView>>(kMostPrepared)) {
        if (depends_on_picture) statistics = live_statistics(options.op);
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
          statistics(other.statistics),
          programs(other.programs) {
        check_exposure(stops);
        options.exposure_stops = stops;
    }
    /// For pictures with these statistics, with the same programs.
    State(const State& other, const SceneStatistics& of_picture)
        : State(other, other.options.exposure_stops) {
        if (statistics.empty()) statistics = live_statistics(options.op);
        options.op = resolve_for_picture(options.op, of_picture);
        options.statistics = TonemapOptions::Statistics::defaults;
        depends_on_picture = false;
    }

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

    TonemapOptions options;
    /// Made again with each picture's statistics.
    bool depends_on_picture;
    bool is_local = false;
    LiveUniforms statistics;
    std::shared_ptr<BoundedCache<ProgramKey, PreparedView>> programs;
    mutable BoundedCache<std::string, PreparedView> prepared{kMostPrepared};  // by input space
};

RowTonemapper::RowTonemapper(const TonemapOptions& options)
    : state_(std::make_unique<const State>(options)) {}
RowTonemapper::~RowTonemapper() = default;
RowTonemapper::RowTonemapper(RowTonemapper&&) noexcept = default;
RowTonemapper& RowTonemapper::operator=(RowTonemapper&&) noexcept = default;
RowTonemapper::RowTonemapper(std::unique_ptr<const State> state) : state_(std::move(state)) {}

const TonemapOptions& RowTonemapper::options() const noexcept { return state_->options; }
bool RowTonemapper::takes_statistics() const noexcept { return state_->depends_on_picture; }
bool RowTonemapper::needs_whole_picture() const noexcept { return state_->is_local; }

RowTonemapper RowTonemapper::with_statistics(const SceneStatistics& statistics) const {
    return RowTonemapper(std::make_unique<const State>(*state_, statistics));
}

RowTonemapper RowTonemapper::with_exposure(double stops) const {
    return RowTonemapper(std::make_unique<const State>(*state_, stops));
}

std::shared_ptr<const PreparedView> RowTonemapper::prepared_for(const SourceColor& source) const {
    const State& state = *state_;
    const TonemapOptions& options = state.options;
    return state.prepared.get(source.name, [&] {
        State::ProgramKey key = {source.name, {}, options.op.settings};
        if (!is_live_exposure(options.exposure_stops) && !state.is_local)
            key.fixed_exposure = options.exposure_stops;
        for (auto& [name, value] : key.settings) {
            if (state.statistics.contains(name)) value.clear();
        }
        const std::shared_ptr<const PreparedView> compiled = state.programs->get(key, [&] {
            return PreparedView(view_of(options, source), state.statistics, options.mix);
        });
        // Making a view takes longer than all other steps, so only other statistics need a new one.
        View view = state.statistics.empty() ? compiled->view : view_of(options, source);
        view.exposure_stops = options.exposure_stops;
        return PreparedView(*compiled, std::move(view));
    });
}

PictureMap RowTonemapper::map_of(const PreparedView& prepared, const PictureSpec& source) const {
    const PlanarMap engine = [&prepared](const auto& in, std::ptrdiff_t in_stride, const auto& out,
                                         std::ptrdiff_t out_stride, std::size_t count) {
        prepared.engine.run(in, in_stride, out, out_stride, count);
    };
    const bool keeps_gray = channel_layout(source).is_gray && prepared.keeps_gray();
    return {engine, keeps_gray, prepared.view.op.label, options().unpremult,
            options().exposure_stops};
}

void RowTonemapper::tag_result(const PreparedView& prepared, PictureSpec& result) const {
    tag_as_result_of(prepared.view, result);
    if (options().dither) result.attribute("oiio:dither", 1);
}

PictureSpec RowTonemapper::result_spec(const PictureSpec& source) const {
    if (source.deep) throw Error("source is deep; expected flat pixels (oiiotool --flatten)");
    check_pixel_type("source", source.format);
    const SourceColor color = source_color(source, options().input);
    if (color.convert) return result_spec(converted_spec(source, color));
    // They change no channel and no tag.
    if (takes_statistics()) return with_statistics({}).result_spec(source);
    if (needs_whole_picture()) check_flat(source);
    const std::shared_ptr<const PreparedView> prepared = prepared_for(color);
    const ChannelPlan plan = plan_channels(source, map_of(*prepared, source), 0);
    PictureSpec result = float_spec(source, plan.widens());
    result.tile_width = result.tile_height = result.tile_depth = 0;
    result.erase_attribute("oiio:SHA-1");  // of other pixels
    tag_result(*prepared, result);
    return result;
}

void RowTonemapper::run(const PictureSpec& source, const std::byte* rows, int row_count,
                        const OIIO::TypeDesc& type, std::byte* result, unsigned nthreads) const {
    check_pixel_type("source", source.format);
    check_pixel_type("destination", type);
    const std::shared_ptr<const PreparedView> prepared =
        prepared_for(source_color(source, options().input));
    const PictureMap map = map_of(*prepared, source);
    ChannelPlan plan = plan_channels(source, map, 0);
    const PixelLayout from = {source.format, source.nchannels};
    const PixelLayout to = {type, source.nchannels + (plan.widens() ? 2 : 0)};
    plan_copies(plan, from.channels, to.channels);
    const auto from_stride = static_cast<std::ptrdiff_t>(size_of(from.type)) * from.channels;
    const auto to_stride = static_cast<std::ptrdiff_t>(size_of(to.type)) * to.channels;
    // Rows are packed, so spans need not end with them.
    const std::size_t count =
        static_cast<std::size_t>(source.width) * static_cast<std::size_t>(row_count);
    constexpr std::size_t kTask = 32 * kSpan;
    in_parallel((count + kTask - 1) / kTask, nthreads, [&](std::size_t task) {
        SpanRunner runner(map, plan, from, to, false);
        const std::size_t end = std::min(count, (task + 1) * kTask);
        for (std::size_t first = task * kTask; first < end; first += kSpan) {
            const auto at = static_cast<std::ptrdiff_t>(first);
            runner.run({rows + at * from_stride, from_stride}, 0, result + at * to_stride,
                       to_stride, std::min(kSpan, end - first));
        }
    });
}

TONEWRIGHT_NAMESPACE_END
