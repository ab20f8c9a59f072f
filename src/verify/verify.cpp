// SPDX-License-Identifier: Apache-2.0
#include "tonewright/verify.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <optional>
#include <set>

#include "base/strings.h"
#include "measure/error_metric.h"
#include "measure/sample_set.h"
#include "ocio/gpu.h"
#include "ocio/operator_facts.h"
#include "ocio/read_config.h"
#include "ocio/round_trip.h"
#include "ocio/transforms.h"
#include "tonewright/engine.h"
#include "tonewright/generated_files.h"
#include "tonewright/ocio.h"
#include "tonewright/registry.h"
#include "tonewright/shader.h"
#include "verify/backends.h"
#include "verify/private_folder.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

namespace fs = std::filesystem;

/// A config in a temporary folder, which the destructor removes.
class TemporaryConfig {
  public:
    TemporaryConfig(std::vector<ConfigOptions::CustomView> views, const std::string& cache_folder) {
        write_generated_files(
            folder_.path(),
            make_config(
                {.views = {"none"}, .custom = std::move(views), .cache_folder = cache_folder}),
            "config.ocio");
    }
    [[nodiscard]] const std::string& folder() const { return folder_.path(); }

  private:
    PrivateFolder folder_;
};

/// For a folder: its config for any application.
std::string path_of_config(const std::string& given) {
    return fs::is_directory(given) ? given + "/config.ocio" : given;
}

/// OpenColorIO's GPU path reads LUTs with filters. Those of GPUs have 8-bit weights: two entries of
/// a half LUT are up to 2^-10 of the value apart, so that each of up to four LUTs is up to 2^-19
/// off, times the slopes of what follows. Their logarithms, powers and quotients are less exact,
/// too. On an NVIDIA H100 (driver 580), half LUTs add at most 8.7e-6 to the bound of a rasterizer
/// in software, which has float weights, and other operators take up to 2.5 times that bound.
double gpu_bound(double in_software) {
    const std::string renderer = OcioGpu::renderer();
    const bool is_software = renderer.starts_with("llvmpipe") || renderer.starts_with("softpipe");
    return is_software ? in_software : 3 * in_software + 1e-5;
}

class Comparison {
  public:
    Comparison(const View& view, const SampleSet& samples)
        : samples_(samples),
          to_working_(rgb_to_rgb(find_input_space(view.input).primaries, view.op.op->working)),
          decode_(find_display(view.display).decode),
          truth_(samples.rgb.size()) {
        const Pipeline whole = build_view(view);
        ReferenceEngine(whole).run_rgb(samples.rgb.data(), truth_.data(), samples.size());
        for (std::size_t i = 0; i < whole.size(); ++i) {
            const auto* m = std::get_if<MatrixStage>(&whole[i]);
            if (i > 0 && !(m && has_negative_coefficient(m->m))) continue;
            const auto at = whole.begin() + static_cast<std::ptrdiff_t>(i);
            rounding_points_.push_back(
                {ReferenceEngine({whole.begin(), at}), ReferenceEngine({at, whole.end()})});
        }
    }

    /// @param unit  relative rounding of the backend, see ParityRow::max_beyond_rounding
    /// @param loses_negatives  a 3D LUT of the backend takes negatives of the working primaries as
    /// 0:
    ///                         the bound does not apply to colors outside of these primaries
    /// @param answers_nan  the backend must show NaN as a color
    void measure(const std::vector<float>& shown, double unit, bool loses_negatives,
                 bool answers_nan, ParityRow& row) const {
        std::vector<double> errors;
        errors.reserve(samples_.size());
        std::size_t worst = 0;
        for (std::size_t i = 0; i < samples_.size(); ++i) {
            const float* v = &shown[3 * i];
            if (!answers_nan && has_nan(i)) continue;
            for (std::size_t c = 0; c < 3; ++c) {
                // A clamp in float32 can be off by a rounding of the encoding's constants.
                row.is_total = row.is_total && v[c] >= -1e-6F && v[c] <= 1 + 1e-6F;
            }
            if (samples_.kind[i] == SampleKind::special) continue;
            const double error = channel_error(&truth_[3 * i], v);
            if (samples_.is_non_negative(i)) errors.push_back(error);
            if (!(error <= row.max_all)) {
                row.max_all = error;
                worst = i;
            }
            if (error <= row.bound || (loses_negatives && !is_inside_working(i))) continue;
            const Vector3 allowed = row.is_mixed_metric ? rounding_allowance(i, unit) : Vector3{};
            row.max_beyond_rounding = std::max(row.max_beyond_rounding, excess(i, v, allowed));
        }
        const ErrorStats stats = summarise(errors);
        row.max = stats.max;
        row.p999 = stats.p999;
        row.mean = stats.mean;
        row.is_ok = row.is_total && row.max_beyond_rounding <= row.bound;
        if (!row.is_ok) {
            row.note = fmt::format("worst at {:.9g} {:.9g} {:.9g}", samples_.rgb[3 * worst],
                                   samples_.rgb[3 * worst + 1], samples_.rgb[3 * worst + 2]);
        }
    }

  private:
    [[nodiscard]] bool has_nan(std::size_t i) const {
        const float* const v = &samples_.rgb[3 * i];
        return std::any_of(v, v + 3, [](float x) { return std::isnan(x); });
    }

    [[nodiscard]] bool is_inside_working(std::size_t i) const {
        const Vector3 v =
            multiply(to_working_, Vector3{static_cast<double>(samples_.rgb[3 * i]),
                                          static_cast<double>(samples_.rgb[3 * i + 1]),
                                          static_cast<double>(samples_.rgb[3 * i + 2])});
        return std::min({v[0], v[1], v[2]}) >= 0;
    }

    /// Error of the worst channel, minus its allowance.
    [[nodiscard]] double excess(std::size_t i, const float* shown, const Vector3& allowed) const {
        double worst = 0;
        const Vector3 true_light = decode_({truth_[3 * i], truth_[3 * i + 1], truth_[3 * i + 2]});
        const Vector3 shown_light =
            decode_({static_cast<double>(shown[0]), static_cast<double>(shown[1]),
                     static_cast<double>(shown[2])});
        for (std::size_t c = 0; c < 3; ++c) {
            const double code = static_cast<double>(shown[c]);
            const double truth = truth_[3 * i + c];
            const double light = std::fabs(shown_light[c] - true_light[c]);
            const double error = visible_error(std::fabs(code - truth), light);
            if (std::isnan(code)) return kInfinity;
            worst = std::max(worst, error - allowed[c]);
        }
        return worst;
    }

    /// @see ParityRow::max_beyond_rounding
    [[nodiscard]] Vector3 rounding_allowance(std::size_t i, double unit) const {
        const Vector3 in = {static_cast<double>(samples_.rgb[3 * i]),
                            static_cast<double>(samples_.rgb[3 * i + 1]),
                            static_cast<double>(samples_.rgb[3 * i + 2])};
        Vector3 allowance{};
        for (const auto& [before, after] : rounding_points_) {
            const Vector3 entering = before(in);
            for (std::size_t j = 0; j < 3; ++j) {
                Vector3 moved{};
                for (const double sign : {-1.0, 1.0}) {
                    Vector3 v = entering;
                    v[j] *= 1 + sign * unit;
                    const Vector3 out = after(v);
                    for (std::size_t c = 0; c < 3; ++c) {
                        moved[c] = std::max(moved[c], std::fabs(out[c] - truth_[3 * i + c]));
                    }
                }
                for (std::size_t c = 0; c < 3; ++c)
                    allowance[c] += moved[c];
            }
        }
        return allowance;
    }

    /// The chain, cut in two where a float32 backend rounds and a canceling matrix follows.
    struct RoundingPoint {
        ReferenceEngine before;
        ReferenceEngine after;
    };
    const SampleSet& samples_;
    Matrix3 to_working_;
    ReferenceEngine decode_;
    std::vector<double> truth_;
    std::vector<RoundingPoint> rounding_points_;
};

/// Bound of the round trip for 99.9 % of the colors, in code values, by the structure of the
/// inverse; 0 if the config has no inverse of its own.
double round_trip_bound(const OCIO::ConstProcessorRcPtr& back, const ResolvedOperator& op) {
    // Inverse tables of 16384 entries; a curve that is steep next to white has few of them there.
    double bound = 1e-3;
    const OCIO::GroupTransformRcPtr group = back->createGroupTransform();
    for (int i = 0; i < group->getNumTransforms(); ++i) {
        const OCIO::TransformRcPtr part = group->getTransform(i);
        if (const auto f = OCIO_DYNAMIC_POINTER_CAST<OCIO::FixedFunctionTransform>(part)) {
            // Tables that OpenColorIO inverts, by default over half floats, in HSV. The ACES
            // functions invert clipped colors in their own way.
            bound = std::max(bound, f->getStyle() == OCIO::FIXED_FUNCTION_RGB_TO_HSV ? 3e-3 : 2e-2);
        }
        if (!OCIO_DYNAMIC_POINTER_CAST<OCIO::Lut3DTransform>(part)) continue;
        if (part->getDirection() == OCIO::TRANSFORM_DIR_INVERSE) return 0;
        // An inverse that mixes channels, in 33 or 37 nodes a side; a formula may have corners.
        const Pipeline stages = op.build();
        const bool is_grid = std::any_of(stages.begin(), stages.end(), [](const Stage& stage) {
            return std::holds_alternative<GridStage>(stage);
        });
        bound = std::max(bound, is_grid || op.op->build_inverse ? 2.5e-2 : 5e-2);
    }
    return bound;
}

/// Adds rows for the inverse from the config's output space, as applications run it.
template <class Add>
void add_inverse_space(const OCIO::ConstConfigRcPtr& config, const View& view,
                       const std::string& space, const SampleSet& samples, bool with_gpu,
                       const Add& add) {
    if (!config->getColorSpace(space.c_str())) return;
    ParityRow row;
    row.op = view.op.label;
    row.display = view.display;
    if (view.op.op->is_diagnostic) {
        row.backend = "inverse";
        row.note = "none: many colors are shown as one";
        add(row);
        return;
    }
    const OCIO::ConstProcessorRcPtr back =
        config->getProcessor(space.c_str(), config_space_name(view.input).c_str());
    row.bound = round_trip_bound(back, view.op);
    row.lowering = "config: " + space;
    if (row.bound == 0) {
        row.backend = "inverse";
        row.note =
            "none: the config has no inverse table, and OpenColorIO's own inversion is coarse";
        add(row);
        return;
    }
    // A fifth of the colors, because every backend takes two more passes.
    const RoundTrip trip(view, samples, 5);
    const auto measure = [&](const std::string& backend, const RoundTrip::Inverse& run) {
        ParityRow measured = row;
        measured.backend = backend;
        const auto [errors, is_finite] = trip.measure(run);
        measured.max = measured.max_all = errors.max;
        measured.p999 = measured.max_beyond_rounding = errors.p999;
        measured.mean = errors.mean;
        measured.is_total = is_finite;
        measured.is_ok = is_finite && errors.p999 <= measured.bound;
        add(measured);
    };
    for (const bool is_default : {false, true}) {
        const OcioCpu cpu(back,
                          is_default ? OCIO::OPTIMIZATION_DEFAULT : OCIO::OPTIMIZATION_LOSSLESS);
        measure(is_default ? "inverse cpu default" : "inverse cpu lossless",
                [&](const float* in, float* out, std::size_t n) { cpu.run_rgb(in, out, n); });
    }
    if (!with_gpu || !OcioGpu::unavailable_reason().empty()) return;
    const OcioGpu gpu(back);
    measure("inverse gpu",
            [&](const float* in, float* out, std::size_t n) { gpu.run_rgb(in, out, n); });
}

/// The config's name for the operator with defaults or with a look; empty if it has other settings.
std::string view_name(const ResolvedOperator& op) {
    if (op.label == op.op->id) return op.op->view;
    for (const Look& look : op.op->looks) {
        if (op.label == op.op->id + " look=" + look.id) return op.op->view + " " + look.title;
    }
    return "";
}

/// The config's view of the operator on its display; empty if there is none.
std::string view_in_config(const OCIO::ConstConfigRcPtr& config, const View& view) {
    const std::string name = view_name(view.op);
    if (name.empty()) return "";
    const Display& display = find_display(view.display);
    const std::string shown = config_view_name(name, view.op, display);
    const char* transform =
        config->getDisplayViewTransformName(display.title.c_str(), shown.c_str());
    return transform && *transform ? shown : "";
}

constexpr double kTenBits = 1.0 / 1023;
/// Drivers sum a row in any order, and round more often.
constexpr double kGpuRounding = 0x1p-21;

double shader_bound(const Shader& shader, bool is_hdr) {
    // An estimate over the sample set; between samples, derivatives are assumed to be up to twice
    // as large. If float is not enough, second-order terms count as much, so the factor is four.
    const double beyond = shader.errors.in_float > kTenBits ? 4 : 2;
    if (std::isfinite(shader.errors.vulkan_estimate)) return beyond * shader.errors.vulkan_estimate;
    // Limited only by the display: a canceled channel below PQ's steepest part.
    if (shader.errors.in_float > kTenBits) return 1;
    // First order has a pole here: a logarithm near 1 may be off by 2^-21, which PQ's exponent
    // 78.84 turns into 2.6e-5. Without PQ, float is enough.
    return is_hdr ? 2.6e-5 : 2e-6;
}

SampleSet every_nth(const SampleSet& all, std::size_t n) {
    SampleSet chosen;
    for (std::size_t i = 0; i < all.size(); i += n) {
        chosen.add(static_cast<double>(all.rgb[3 * i]), static_cast<double>(all.rgb[3 * i + 1]),
                   static_cast<double>(all.rgb[3 * i + 2]), all.kind[i]);
    }
    return chosen;
}

/// The views of a config from Tonewright, on its displays. In other configs, a view such as AgX may
/// be a different one.
bool checks_views_of_config(const VerifyOptions& options) {
    return options.operators.empty() && !options.config.empty();
}

/// @param config  null: there is none
std::vector<View> choose_views(const VerifyOptions& options, const OCIO::ConstConfigRcPtr& config) {
    const bool is_of_config = checks_views_of_config(options);
    for (const ResolvedOperator& op : options.operators)
        require_no_surroundings(*op.op);
    const std::vector<ResolvedOperator> operators =
        options.operators.empty() ? resolve_operators({"all"}) : options.operators;
    std::vector<std::string> displays = options.displays;
    if (displays.empty() && is_of_config) {
        for (const Display& display : all_displays())
            displays.push_back(display.id);
    }
    if (displays.empty()) displays = {"srgb"};
    const InputSpace& input = find_input_space(options.input);
    if (input.is_camera) {
        throw Error({.parameter = "input",
                     .value = input.id,
                     .expected = "a space of the config, which has only log encodings of cameras"});
    }
    std::vector<View> views;
    for (const ResolvedOperator& op : operators) {
        for (const std::string& display : displays) {
            View view = make_view(op, input.id, 0, find_display(display).id);
            if (is_of_config && (std::string_view(config->getName()) != kConfigName ||
                                 view_in_config(config, view).empty()))
                continue;
            views.push_back(std::move(view));
        }
    }
    return views;
}

SampleSet choose_samples(const VerifyOptions& options) {
    SampleSetOptions counts = {options.gamut_grid_size, options.random_count};
    if (checks_views_of_config(options)) {  // every view on every display, in a minute
        counts.gamut_grid_size = std::min(counts.gamut_grid_size, 17);
        counts.random_count = std::min<std::size_t>(counts.random_count, 50000);
    }
    SampleSet samples = make_sample_set(find_input_space(options.input), counts);
    for (std::size_t i = 0; i + 2 < options.picture.size(); i += 3) {
        samples.add(static_cast<double>(options.picture[i]),
                    static_cast<double>(options.picture[i + 1]),
                    static_cast<double>(options.picture[i + 2]), SampleKind::picture);
    }
    return samples;
}

/// The views of a config with the operators.
std::vector<ConfigOptions::CustomView> views_of_operators(const std::vector<View>& views) {
    std::vector<ConfigOptions::CustomView> requested;
    std::set<std::string> names;
    for (const View& view : views) {
        const std::string name = view_name(view.op);
        if (!name.empty() && names.insert(name).second) requested.push_back({name, view.op});
    }
    if (requested.empty()) requested.push_back({views.front().op.op->view, views.front().op});
    return requested;
}

/// The comparison of all backends of a view with the reference.
class Verification {
  public:
    Verification(const VerifyOptions& options, const std::function<void(const ParityRow&)>& on_row)
        : options_(options), on_row_(on_row), is_of_config_(checks_views_of_config(options)) {}

    std::vector<ParityRow> run() {
        if (!options_.config.empty()) config_ = read_config(path_of_config(options_.config));
        const std::vector<View> views = choose_views(options_, config_);
        samples_ = choose_samples(options_);
        every_20th_ = every_nth(samples_, 20);
        shown_.resize(samples_.rgb.size());
        std::optional<TemporaryConfig> fresh;
        if (!config_) {
            fresh.emplace(views_of_operators(views), options_.cache_folder);
            config_ = read_config(path_of_config(fresh->folder()));
        }
        for (std::size_t i = 0; i < views.size(); ++i) {
            add_view(views[i]);
            if (options_.progress) options_.progress(i + 1, views.size());
        }
        return std::move(rows_);
    }

  private:
    struct Subject {
        const View& view;
        const std::string& cache_folder;
        Pipeline pipeline = build_view(view);
        Lowered lowered = lower_to_ocio(pipeline, lower_options(*view.op.op, cache_folder));
        BackendBounds bounds = backend_bounds(view, pipeline, lowered);
    };

    void add_view(const View& view) {
        const Subject subject{view, options_.cache_folder};
        const Comparison comparison(view, samples_);
        if (!is_of_config_) add_engines(subject, comparison);  // our engine does not read it
        const auto [processor, lowering] = processor_of(subject);
        for (const Backend& backend : all_backends()) {
            if (backend.id == Backend::Id::simd || !backend.bound) continue;
            if (backend.id == Backend::Id::half_textures && !is_of_config_) continue;
            if (backend.id == Backend::Id::ocio_gpu) {
                if (is_of_config_) add_inverse(view);
                if (!options_.with_gpu) continue;
                if (const std::string reason = OcioGpu::unavailable_reason(); !reason.empty()) {
                    add_note(view, backend.name, "skipped: " + reason);
                    continue;
                }
            }
            const ColorRun run = backend.start({view, subject.pipeline, processor});
            if (!run) continue;
            run(samples_.rgb.data(), shown_.data(), samples_.size());
            ParityRow row = row_of(view, backend.name);
            row.lowering =
                backend.id == Backend::Id::ocio_builtin ? builtin_style(view.op) : lowering;
            add_measured(subject, comparison, backend, row);
            if (backend.id == Backend::Id::half_textures)
                rows_.back().note = "a model of Blender's viewport";
        }
        std::optional<ShaderErrors> errors;
        for (const LanguageRun& shader : options_.shaders)
            add_shader(subject, comparison, shader, errors);
    }

    [[nodiscard]] static ParityRow row_of(const View& view, const std::string& backend) {
        ParityRow row;
        row.op = view.op.label;
        row.display = view.display;
        row.backend = backend;
        return row;
    }
    void add(const ParityRow& row) {
        rows_.push_back(row);
        if (on_row_) on_row_(rows_.back());
    }
    void add_note(const View& view, const std::string& backend, const std::string& note) {
        ParityRow row = row_of(view, backend);
        row.note = note;
        add(row);
    }
    /// Adds a row for the colors of `shown_`.
    void add_measured(const Subject& subject, const Comparison& comparison, const Backend& backend,
                      ParityRow row) {
        BackendBound bound = subject.bounds.*backend.bound;
        const bool is_gpu = backend.id == Backend::Id::ocio_gpu;
        if (is_gpu) bound.error = gpu_bound(bound.error);
        row.bound = bound.error;
        row.is_mixed_metric = bound.is_mixed_metric;
        comparison.measure(shown_, is_gpu ? kGpuRounding : 0x1p-23,
                           row.backend.starts_with("ocio") && subject.lowered.loses_negatives, true,
                           row);
        if (bound.is_declared) {
            row.note +=
                (row.note.empty() ? "" : "; ") + ("bound: " + subject.view.op.op->bounds.reason);
        }
        add(row);
    }

    /// The engine with each instruction set of this processor, the best one first.
    void add_engines(const Subject& subject, const Comparison& comparison) {
        const Backend& backend = find_backend(Backend::Id::simd);
        const Comparison compared_20th(subject.view, every_20th_);
        const double goal = subject.view.op.op->bounds.simd_goal;
        const std::vector<std::string> targets = SimdEngine::targets();
        std::vector<SimdEngine> engines;
        if (targets.size() > 1 && !options_.only_best_target) {
            engines = SimdEngine::of_all_targets(subject.pipeline, goal);
        } else {
            engines.emplace_back(subject.pipeline, goal);
        }
        for (std::size_t t = 0; t < engines.size(); ++t) {
            // SCALAR takes thirty times as long as the others, with the same code.
            const bool is_slow = targets[t] == "SCALAR";
            const SampleSet& taken = is_slow ? every_20th_ : samples_;
            engines[t].run_rgb(taken.rgb.data(), shown_.data(), taken.size());
            add_measured(subject, is_slow ? compared_20th : comparison, backend,
                         row_of(subject.view, backend.name + " " + targets[t]));
        }
    }

    /// The view of the config, or the lowered chain; and its words.
    std::pair<OCIO::ConstProcessorRcPtr, std::string> processor_of(const Subject& subject) const {
        const View& view = subject.view;
        try {
            if (const std::string name = view_in_config(config_, view); !name.empty()) {
                return {config_->getProcessor(config_space_name(view.input).c_str(),
                                              find_display(view.display).title.c_str(),
                                              name.c_str(), OCIO::TRANSFORM_DIR_FORWARD),
                        "config: " + subject.lowered.summary};
            }
            return {make_processor(subject.lowered.ops), "chain: " + subject.lowered.summary};
        } catch (const OCIO::Exception& e) {
            throw FileError(fmt::format("{}: {} on {}: {}", options_.config, view.op.label,
                                        view.display, one_line(e.what())));
        }
    }

    void add_inverse(const View& view) {
        const Display& display = find_display(view.display);
        const std::string space = output_space_name(
            config_view_name(view_name(view.op), view.op, display), display.title);
        add_inverse_space(config_, view, space, samples_, options_.with_gpu,
                          [&](const ParityRow& row) { add(row); });
    }

    /// @param errors  of the shaders of the view; the first call measures them
    void add_shader(const Subject& subject, const Comparison& comparison,
                    const LanguageRun& shader_run, std::optional<ShaderErrors>& errors) {
        const ShaderLanguageInfo& language = shader_run.language;
        const View& view = subject.view;
        if (!errors) errors = measure_shader({.view = view});
        Shader shader;
        try {
            shader = write_shader({.view = view, .language = language.language}, &*errors);
        } catch (const Error&) {
            if (language.holds_grids) throw;
            add_note(view, language.id, "none: it cannot store the operator's tables");
            return;
        }
        ParityRow row = row_of(view, language.id);
        row.bound = shader_bound(shader, find_display(view.display).is_hdr);
        row.is_mixed_metric = subject.bounds.cpu.is_mixed_metric;
        row.lowering = shader_run.run->by();
        try {
            shader_run.run->run_rgb(shader, samples_.rgb.data(), shown_.data(), samples_.size());
            comparison.measure(shown_, kGpuRounding, false, false, row);
            if (row.is_ok && shader.errors.in_float > kTenBits) row.note = "float is not enough";
        } catch (const Error& e) {
            row.is_ok = false;
            row.note = one_line(e.what(), 200);
        }
        add(row);
    }

    const VerifyOptions& options_;
    const std::function<void(const ParityRow&)>& on_row_;
    bool is_of_config_;
    OCIO::ConstConfigRcPtr config_;
    SampleSet samples_;
    SampleSet every_20th_;
    std::vector<float> shown_;
    std::vector<ParityRow> rows_;
};

}  // namespace

std::vector<ParityRow> verify(const VerifyOptions& options,
                              const std::function<void(const ParityRow&)>& on_row) {
    try {
        return Verification(options, on_row).run();
    } catch (const OCIO::Exception& e) {
        throw FileError(fmt::format("{}: {}", options.config, one_line(e.what())));
    }
}

std::string parity_heading() {
    return fmt::format("{:<28} {:<10} {:<20} {:>8} {:>8} {:>8} {:>8} {:>10} {:>8}\n", "operator",
                       "display", "backend", "max", "99.9 %", "mean", "max all", "beyond f32",
                       "bound");
}

std::string format_row(const ParityRow& row) {
    if (row.bound == 0) {
        return fmt::format("{:<28} {:<10} {:<20} {}\n", row.op, row.display, row.backend, row.note);
    }
    return fmt::format(
        "{:<28} {:<10} {:<20} {:>8.1e} {:>8.1e} {:>8.1e} {:>8.1e} {:>10} {:>8.1e}  {}{}\n", row.op,
        row.display, row.backend, row.max, row.p999, row.mean, row.max_all,
        row.max_all <= row.bound ? "-" : fmt::format("{:.1e}", row.max_beyond_rounding), row.bound,
        row.is_ok ? "ok" : "FAILED", row.note.empty() ? "" : ", " + row.note);
}

TONEWRIGHT_NAMESPACE_END
