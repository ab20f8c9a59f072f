// SPDX-License-Identifier: Apache-2.0
#include "tonewright/verify.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <map>
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
#include "verify/private_folder.h"
#include "verify/shader_runs/shader_run.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

namespace fs = std::filesystem;

/// A config in a temporary folder, which the destructor removes.
class TemporaryConfig {
  public:
    explicit TemporaryConfig(std::vector<ConfigOptions::CustomView> views) {
        write_generated_files(folder_.path(),
                              make_config({.views = {"none"}, .custom = std::move(views)}),
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

bool has_negative_coefficient(const Matrix3& m) {
    for (const auto& row : m) {
        for (const double x : row) {
            if (x < 0) return true;
        }
    }
    return false;
}

/// Bounds from the structure of a chain, for display code values; an operator may declare others.
struct Bounds {
    double simd = 1e-6;
    double cpu = 3e-7;
    double gpu = 1e-6;
    bool is_mixed_metric = false;
};

/// The largest output of a stage for inputs from -`largest` to `largest`.
double largest_after(const Stage& stage, double largest) {
    const auto at = [&](const Expr& f) { return std::fabs(evaluate(f, largest)); };
    if (const auto* m = std::get_if<MatrixStage>(&stage)) {
        double sum = 0;
        for (const auto& row : m->m)
            sum = std::max(sum, std::fabs(row[0]) + std::fabs(row[1]) + std::fabs(row[2]));
        return sum * largest;
    }
    if (const auto* c = std::get_if<ClampStage>(&stage)) return std::min(largest, c->hi);
    if (const auto* c = std::get_if<CurveStage>(&stage))
        return std::max({at(c->f[0]), at(c->f[1]), at(c->f[2])});
    if (const auto* l = std::get_if<GridStage>(&stage)) {
        const std::vector<double>& nodes = l->grid->nodes();
        return *std::max_element(nodes.begin(), nodes.end());
    }
    return largest;
}

Bounds bounds_of(const Pipeline& pipeline, const Lowered& lowered, bool is_hdr,
                 const DeclaredBounds& declared) {
    Bounds b;
    // Below 1, the error is that of float32 numbers around 1. Above, it grows with the curve, up to
    // the display's clamp.
    double largest_input = 4096;
    const auto largest = [&](const Expr& f) { return std::max(1.0, evaluate(f, largest_input)); };
    const auto allow = [&](double cpu, double gpu) {
        b.cpu = std::max(b.cpu, cpu);
        b.gpu = std::max(b.gpu, gpu);
    };
    bool may_be_negative = true;
    for (const Stage& stage : simplify(pipeline)) {
        // Negative channels cancel in any matrix that mixes them.
        const auto* m = std::get_if<MatrixStage>(&stage);
        if (m && (has_negative_coefficient(m->m) || (may_be_negative && mixes_channels(stage))))
            b.is_mixed_metric = true;
        if (const auto* c = std::get_if<ClampStage>(&stage); c && c->lo >= 0)
            may_be_negative = false;
        // xyY and HSV subtract numbers as large as the brightest channel.
        if (const auto* t = std::get_if<ToneScaleStage>(&stage))
            allow(2e-5 * largest(t->f), 5e-5 * largest(t->f));
        if (const auto* h = std::get_if<HuePreservingStage>(&stage))
            allow(3e-7 * largest(h->f), 1e-6 * largest(h->f));
        if (const auto* h = std::get_if<HexconeStage>(&stage))
            allow(1e-5 * largest(h->value), 3e-5 * largest(h->value));
        if (std::holds_alternative<GridStage>(stage)) allow(1e-5, 5e-5);
        largest_input = largest_after(stage, largest_input);
    }
    if (declared.simd > 0) b.simd = declared.simd;
    if (declared.ocio_cpu > 0) b.cpu = declared.ocio_cpu;
    if (declared.ocio_gpu > 0) b.gpu = declared.ocio_gpu;
    if (!lowered.is_exact) {  // 65^3 cube: one code of 10 bits
        const double declared_cube =
            is_hdr && declared.cube_hdr > 0 ? declared.cube_hdr : declared.cube;
        const double cube = declared_cube > 0 ? declared_cube : 1.0 / 1023;
        allow(cube, cube);
    }
    return b;
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

/// OpenColorIO's built-in transform that equals the view's operator, on the view's display; null if
/// there is none, or if this OpenColorIO lacks it.
OCIO::ConstProcessorRcPtr builtin_processor(const View& view) {
    const std::string style = builtin_style(view.op);
    const auto registry = OCIO::BuiltinTransformRegistry::Get();
    bool is_known = false;
    for (std::size_t i = 0; i < registry->getNumBuiltins(); ++i)
        is_known = is_known || style == registry->getBuiltinStyle(i);
    if (!is_known) return nullptr;
    const Display& display = find_display(view.display);
    Pipeline behind = {MatrixStage{inverse(rgb_to_xyz_d65(display.primaries))},
                       ClampStage{0, display_limit(view.op, display).peak}};
    behind.insert(behind.end(), display.encode.begin(), display.encode.end());
    const Matrix3 to_aces = rgb_to_rgb(find_input_space(view.input).primaries, kAP0);
    LoweredOps ops = lower_to_ocio({MatrixStage{to_aces}}).ops;
    ops.push_back({BuiltinOp{style}});
    append(ops, lower_to_ocio(behind).ops);
    return make_processor(ops);
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

double rounded_to_half(double x) {
    constexpr double largest = 65504;
    constexpr double smallest_normal = 0x1p-14;
    const double magnitude = std::min(std::fabs(x), largest);
    // Eleven bits, or fewer below the normal numbers.
    const double unit = std::exp2(std::floor(std::log2(std::max(magnitude, smallest_normal))) - 10);
    return std::copysign(std::nearbyint(magnitude / unit) * unit, x);
}

/// A model of Blender's viewport, which uploads every table as textures of half floats; everything
/// else is exact.
OCIO::ConstProcessorRcPtr with_half_textures(const OCIO::ConstProcessorRcPtr& processor) {
    const OCIO::GroupTransformRcPtr group =
        processor->getOptimizedProcessor(OCIO::OPTIMIZATION_DEFAULT)->createGroupTransform();
    const auto half = [](float x) {
        return static_cast<float>(rounded_to_half(static_cast<double>(x)));
    };
    for (int i = 0; i < group->getNumTransforms(); ++i) {
        const OCIO::TransformRcPtr part = group->getTransform(i);
        float r = 0;
        float g = 0;
        float b = 0;
        if (const auto lut = OCIO_DYNAMIC_POINTER_CAST<OCIO::Lut1DTransform>(part)) {
            for (unsigned long k = 0; k < lut->getLength(); ++k) {
                lut->getValue(k, r, g, b);
                lut->setValue(k, half(r), half(g), half(b));
            }
        }
        if (const auto cube = OCIO_DYNAMIC_POINTER_CAST<OCIO::Lut3DTransform>(part)) {
            const unsigned long n = cube->getGridSize();
            for (unsigned long k = 0; k < n * n * n; ++k) {
                cube->getValue(k / (n * n), k / n % n, k % n, r, g, b);
                cube->setValue(k / (n * n), k / n % n, k % n, half(r), half(g), half(b));
            }
        }
    }
    return make_processor(group);
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

VerifyResult measure_all(const VerifyOptions& options,
                         const std::function<void(const ParityRow&)>& on_row) {
    // The views of a config from Tonewright, on its displays. In other configs, a view such as AgX
    // may be a different one.
    const bool is_of_config = options.operators.empty() && !options.config.empty();
    OCIO::ConstConfigRcPtr config;
    if (!options.config.empty()) config = read_config(path_of_config(options.config));
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

    // Tonewright's shaders do not read a config.
    ShaderRuns shaders;
    if (options.with_gpu && !is_of_config) {
        shaders = make_shader_runs(options.shaders);
    } else {
        (void)languages_to_run(options.shaders);  // wrong names are errors without a run, too
    }

    // Every view on every display, in a minute.
    SampleSetOptions counts = {options.gamut_grid_size, options.random_count};
    if (is_of_config) {
        counts.gamut_grid_size = std::min(counts.gamut_grid_size, 17);
        counts.random_count = std::min<std::size_t>(counts.random_count, 50000);
    }
    SampleSet samples = make_sample_set(input, counts);
    for (std::size_t i = 0; i + 2 < options.picture.size(); i += 3) {
        samples.add(static_cast<double>(options.picture[i]),
                    static_cast<double>(options.picture[i + 1]),
                    static_cast<double>(options.picture[i + 2]), SampleKind::picture);
    }
    std::optional<TemporaryConfig> fresh;
    if (!config) {
        std::vector<ConfigOptions::CustomView> wanted;
        std::set<std::string> names;
        for (const ResolvedOperator& op : operators) {
            const std::string name = view_name(op);
            if (!name.empty() && names.insert(name).second) wanted.push_back({name, op});
        }
        if (wanted.empty()) wanted.push_back({operators.front().op->view, operators.front()});
        fresh.emplace(wanted);
        config = read_config(path_of_config(fresh->folder()));
    }

    std::vector<ParityRow> rows;
    std::vector<float> shown(samples.rgb.size());
    const SampleSet few = every_nth(samples, 20);
    std::vector<std::string> targets = SimdEngine::targets();  // the best one first
    if (options.only_best_target) targets.resize(1);
    if (is_of_config) targets.clear();  // our engine does not read it
    for (const View& view : views) {
        const Pipeline pipeline = build_view(view);
        const Comparison comparison(view, samples);
        const Comparison few_compared(view, few);
        const DeclaredBounds& declared = view.op.op->bounds;
        const Lowered lowered = lower_to_ocio(pipeline, lower_options(*view.op.op));
        const bool is_hdr = find_display(view.display).is_hdr;
        const Bounds bounds = bounds_of(pipeline, lowered, is_hdr, declared);
        const auto row_of = [&](const std::string& backend) {
            ParityRow row;
            row.op = view.op.label;
            row.display = view.display;
            row.backend = backend;
            return row;
        };
        const auto add_row = [&](const ParityRow& row) {
            rows.push_back(row);
            if (on_row) on_row(rows.back());
        };
        const auto add_note = [&](const std::string& backend, const std::string& note) {
            ParityRow row = row_of(backend);
            row.note = note;
            add_row(row);
        };
        const auto add = [&](const Comparison& compared, const std::string& backend, double bound,
                             bool is_declared, bool mixed, const std::string& lowering,
                             const auto& run) {
            ParityRow row = row_of(backend);
            row.lowering = lowering;
            row.bound = bound;
            row.is_mixed_metric = mixed;
            run();
            const double unit = backend == "ocio gpu" ? kGpuRounding : 0x1p-23;
            compared.measure(shown, unit, backend.starts_with("ocio") && lowered.loses_negatives,
                             true, row);
            if (is_declared)
                row.note += (row.note.empty() ? "" : "; ") + ("bound: " + declared.reason);
            add_row(row);
        };

        std::vector<SimdEngine> engines;
        if (targets.size() > 1) {
            engines = SimdEngine::of_all_targets(pipeline, declared.simd_goal);
        } else if (!targets.empty()) {
            engines.emplace_back(pipeline, declared.simd_goal);
        }
        for (std::size_t t = 0; t < engines.size(); ++t) {
            const std::string& target = targets[t];
            // SCALAR takes thirty times as long as the others, with the same code.
            const bool is_slow = target == "SCALAR";
            const SampleSet& taken = is_slow ? few : samples;
            add(is_slow ? few_compared : comparison, "simd " + target, bounds.simd,
                declared.simd != DeclaredBounds{}.simd, false, "",
                [&] { engines[t].run_rgb(taken.rgb.data(), shown.data(), taken.size()); });
        }

        OCIO::ConstProcessorRcPtr processor;
        std::string lowering = lowered.summary;
        try {
            if (const std::string name = view_in_config(config, view); !name.empty()) {
                processor = config->getProcessor(config_space_name(view.input).c_str(),
                                                 find_display(view.display).title.c_str(),
                                                 name.c_str(), OCIO::TRANSFORM_DIR_FORWARD);
                lowering.insert(0, "config: ");
            } else {
                processor = make_processor(lowered.ops);
                lowering.insert(0, "chain: ");
            }
        } catch (const OCIO::Exception& e) {
            throw FileError(fmt::format("{}: {} on {}: {}", options.config, view.op.label,
                                        view.display, one_line(e.what())));
        }
        const auto cpu = [&](OCIO::OptimizationFlags flags) {
            OcioCpu(processor, flags).run_rgb(samples.rgb.data(), shown.data(), samples.size());
        };
        add(comparison, "ocio cpu lossless", bounds.cpu, declared.ocio_cpu > 0,
            bounds.is_mixed_metric, lowering, [&] { cpu(OCIO::OPTIMIZATION_LOSSLESS); });
        add(comparison, "ocio cpu default", bounds.cpu, declared.ocio_cpu > 0,
            bounds.is_mixed_metric, lowering, [&] { cpu(OCIO::OPTIMIZATION_DEFAULT); });
        if (const auto builtin = builtin_processor(view)) {
            // OpenColorIO's own transform, in float32 throughout, not our lowering.
            add(comparison, "ocio builtin", 1e-3, false, true, builtin_style(view.op), [&] {
                OcioCpu(builtin, OCIO::OPTIMIZATION_LOSSLESS)
                    .run_rgb(samples.rgb.data(), shown.data(), samples.size());
            });
        }
        if (is_of_config) {
            // Limited only by the display, because Blender chose the precision.
            add(comparison, "half textures", 1, false, false, lowering, [&] {
                OcioCpu(with_half_textures(processor), OCIO::OPTIMIZATION_LOSSLESS)
                    .run_rgb(samples.rgb.data(), shown.data(), samples.size());
            });
            rows.back().note = "a model of Blender's viewport";
        }
        if (is_of_config) {
            const std::string space = output_space_name(
                config_view_name(view_name(view.op), view.op, find_display(view.display)),
                find_display(view.display).title);
            add_inverse_space(config, view, space, samples, options.with_gpu, add_row);
        }
        if (const std::string reason = OcioGpu::unavailable_reason();
            options.with_gpu && reason.empty()) {
            const OcioGpu gpu(processor);
            add(comparison, "ocio gpu", gpu_bound(bounds.gpu), declared.ocio_gpu > 0,
                bounds.is_mixed_metric, lowering,
                [&] { gpu.run_rgb(samples.rgb.data(), shown.data(), samples.size()); });
        } else if (options.with_gpu) {
            add_note("ocio gpu", "skipped: " + reason);
        }
        std::optional<ShaderErrors> errors;
        for (const ShaderRuns::Of& shader_run : shaders.runs) {
            const ShaderLanguageInfo& language = shader_run.language;
            if (!errors) errors = measure_shader({.view = view});
            Shader shader;
            try {
                shader = write_shader({.view = view, .language = language.language}, &*errors);
            } catch (const Error&) {
                if (language.holds_grids) throw;
                add_note(language.id, "none: it cannot store the operator's tables");
                continue;
            }
            ParityRow row = row_of(language.id);
            row.bound = shader_bound(shader, is_hdr);
            row.is_mixed_metric = bounds.is_mixed_metric;
            row.lowering = shader_run.run->by();
            try {
                shader_run.run->run_rgb(shader, samples.rgb.data(), shown.data(), samples.size());
                comparison.measure(shown, kGpuRounding, false, false, row);
                if (row.is_ok && shader.errors.in_float > kTenBits)
                    row.note = "float is not enough";
            } catch (const Error& e) {
                row.is_ok = false;
                row.note = one_line(e.what(), 200);
            }
            add_row(row);
        }
    }
    return {std::move(rows), std::move(shaders.not_executed)};
}

}  // namespace

VerifyResult verify(const VerifyOptions& options,
                    const std::function<void(const ParityRow&)>& on_row) {
    try {
        return measure_all(options, on_row);
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

std::string format_not_executed(const std::vector<NotExecuted>& all) {
    std::string text = "written, not executed: ";
    for (auto first = all.begin(), last = first; first != all.end(); first = last) {
        last = std::find_if(first, all.end(), [&](const NotExecuted& other) {
            return other.reason != first->reason;
        });
        if (first != all.begin()) text += "; ";
        for (auto one = first; one != last; ++one)
            text += (one == first ? "" : ", ") + one->name;
        text += " (" + first->reason + ")";
    }
    return text + "\n";
}

TONEWRIGHT_NAMESPACE_END
