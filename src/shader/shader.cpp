// SPDX-License-Identifier: Apache-2.0
#include "tonewright/shader.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <set>
#include <unordered_map>

#include "base/format_number.h"
#include "base/little_endian.h"
#include "base/number_cache.h"
#include "base/strings.h"
#include "expr/nodes.h"
#include "measure/sample_set.h"
#include "pipeline/settings_text.h"
#include "shader/first_order.h"
#include "shader/fitted_curves.h"
#include "shader/float_run.h"
#include "shader/grid_form.h"
#include "shader/guaranteed_bound.h"
#include "shader/measured_errors.h"
#include "shader/print.h"
#include "shader/texture_form.h"
#include "shader/wrapper.h"
#include "tonewright/engine.h"
#include "tonewright/registry.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

constexpr double kLargestExposure = 64;
/// The function of a GridStage in the text.
constexpr const char* kGridFunction = "lattice";

std::string joined(const std::string& name, const std::string& part) {
    return part.empty() ? name : name + "_" + part;
}

/// The operator's name as an identifier: id, preset, look.
std::string identifier(const ResolvedOperator& op) {
    std::string name = op.op->id;
    if (op.preset) {
        const std::string with_preset = joined(name, op.preset->id);
        // hable:gdc is not hable_gdc.
        const auto& all = all_operators();
        const bool is_taken = std::any_of(
            all.begin(), all.end(), [&](const Operator& other) { return other.id == with_preset; });
        name = is_taken ? joined(name, "preset_" + op.preset->id) : with_preset;
    }
    return joined(name, op.params.look());
}

bool is_of_a_display(const View& view) {
    return view.display != kLinearOutput && view.display != kNativeOutput;
}

/// @throws Error  as write_shader()
void check(const ShaderRequest& request) {
    const Operator& op = *request.view.op.op;
    if (op.is_local()) {
        throw Error(Problem{.value = op.id + " looks at the surroundings of a pixel",
                            .expected = "an operator that maps each pixel by itself"});
    }
    const std::vector<std::string> live = live_parameters(op);
    std::vector<std::string> choices = {std::string(kExposureUniform)};
    if (!request.is_inverse) choices.insert(choices.end(), live.begin(), live.end());
    for (auto at = request.uniforms.begin(); at != request.uniforms.end(); ++at) {
        if (std::find(choices.begin(), choices.end(), *at) == choices.end()) {
            throw Error({.parameter = "uniforms",
                         .value = printable(*at),
                         .expected = join_choices(choices),
                         .suggestion = suggested_names(*at, choices)});
        }
        if (std::find(request.uniforms.begin(), at, *at) != at)
            throw Error({.parameter = "uniforms", .value = *at + " twice", .expected = "it once"});
    }
}

Pipeline pipeline_of(const ShaderRequest& request) {
    if (!request.is_inverse) return build_live_view(request.view, request.uniforms);
    if (request.uniforms.empty()) return build_inverse_view(request.view);
    View view = request.view;
    view.exposure_stops = 0;
    Pipeline stages = build_inverse_view(view);
    const Expr stops = Expr::uniform(std::string(kExposureUniform));
    stages.push_back(named("expose", curve_stage(Expr::input() * exp2(-stops))));
    return stages;
}

UniformRanges ranges_of(const ShaderRequest& request) {
    UniformRanges ranges;
    for (const std::string& uniform : request.uniforms) {
        ranges[uniform] = {-kLargestExposure, kLargestExposure};
        for (const ParameterSpec& spec : request.view.op.op->parameters) {
            if (spec.name == uniform) ranges[uniform] = {spec.min, spec.max};
        }
    }
    return ranges;
}

/// Values of the uniforms in the view.
UniformValues values_of(const ShaderRequest& request) {
    UniformValues values;
    for (const std::string& uniform : request.uniforms) {
        values[uniform] = uniform == kExposureUniform ? request.view.exposure_stops
                                                      : request.view.op.params.number(uniform);
    }
    return values;
}

std::vector<ShaderArgument> arguments_of(const ShaderRequest& request) {
    std::vector<ShaderArgument> arguments;
    const UniformValues values = values_of(request);
    for (const std::string& uniform : request.uniforms) {
        ShaderArgument argument{uniform, "exposure in stops", values.at(uniform), -8, 8};
        for (const ParameterSpec& spec : request.view.op.op->parameters) {
            if (spec.name == uniform)
                argument = {uniform, spec.help, values.at(uniform), spec.min, spec.max};
        }
        arguments.push_back(argument);
    }
    return arguments;
}

ShaderProgram bound(ShaderProgram program, const UniformValues& values) {
    const auto bind = [&](Expr& e) { e = bind_uniforms(e, values); };
    for (ScalarFunction& function : program.scalars)
        bind(function.f);
    for (ColorFunction& function : program.colors) {
        for (ColorFunction::Call& call : function.calls)
            bind(call.argument);
        for (Expr& e : function.f)
            bind(e);
    }
    return program;
}

/// False for multiples of 1/4, which may have another meaning elsewhere in a formula.
bool is_telling(double value) { return value > 0 && 4 * value != std::floor(4 * value); }

/// Names for settings in the text, by their parameters. A number shared by two parameters stays a
/// number.
std::map<double, std::string> names_of_settings(const ShaderRequest& request) {
    std::map<double, std::string> names;
    std::set<double> ambiguous;
    const ResolvedOperator& op = request.view.op;
    for (const ParameterSpec& parameter : op.op->parameters) {
        if (parameter.kind != ParameterSpec::Kind::number) continue;
        const double value = op.params.number(parameter.name);
        if (!is_telling(value)) continue;
        if (!names.emplace(value, parameter.name).second) ambiguous.insert(value);
    }
    for (const double value : ambiguous)
        names.erase(value);
    return names;
}

PartNames names_in(const ShaderProgram& program) {
    PartNames names;
    for (const ScalarFunction& scalar : program.scalars)
        names.take(scalar.f);
    for (const ColorFunction& color : program.colors) {
        for (const ColorFunction::Call& call : color.calls)
            names.take(call.argument);
        for (const Expr& e : color.f)
            names.take(e);
    }
    return names;
}

/// Adds names of the source for numbers. A named expression that is constant only for some colors,
/// such as the curve at black, gives no name.
void add_names_of_numbers(const PartNames& names, std::map<double, std::string>& numbers) {
    std::set<std::string> of_others;
    for (const PartNames::Entry& entry : names.all()) {
        if (!entry.part.is_constant()) of_others.insert(entry.name);
    }
    for (const PartNames::Entry& entry : names.all()) {
        if (entry.part.is_constant() && is_telling(entry.part.value()) &&
            !of_others.contains(entry.name))
            numbers.emplace(entry.part.value(), entry.name);
    }
}

ShaderProgram program_of(const ShaderRequest& request) {
    ShaderProgram program = make_program(pipeline_of(request), ranges_of(request));
    if (request.curves == ShaderCurves::fitted) program = with_fitted_curves(program);
    program.names = names_of_settings(request);
    return program;
}

/// True if the result is display-linear; its errors are then measured in sRGB code values.
bool is_light(const ShaderRequest& request) {
    const View& view = request.view;
    if (is_of_a_display(view)) return false;
    return view.display == kLinearOutput || view.op.output() == OutputKind::display_linear;
}

/// Display-linear as unlimited sRGB code values; differences above 1 count relatively.
Expr code_value(const Expr& light) { return srgb_encode(max(light, 0)); }

/// Round trip error: display colors through the inverse and the view, for colors that the view can
/// show.
double measure_inverse(const ShaderRequest& request, const ShaderProgram& program) {
    constexpr int kEdge = 17;
    constexpr double kShown = 1e-6;
    const UniformValues values = values_of(request);
    const FloatRun in_float(bound(program, values));
    const ReferenceEngine inverse(bind_uniforms(pipeline_of(request), values));
    const ReferenceEngine view(build_view(request.view));
    double worst = 0;
    for (int i = 0; i < kEdge * kEdge * kEdge; ++i) {
        const auto at = [&](int k) { return static_cast<float>(k % kEdge) / (kEdge - 1); };
        const std::array<float, 3> color = {at(i / kEdge / kEdge), at(i / kEdge), at(i)};
        const Vector3 exact = {static_cast<double>(color[0]), static_cast<double>(color[1]),
                               static_cast<double>(color[2])};
        const auto distance = [&](const Vector3& scene) {
            const Vector3 shown = view(scene);
            double largest = 0;
            for (std::size_t c = 0; c < 3; ++c)
                largest = std::max(largest, std::fabs(shown[c] - exact[c]));
            return largest;
        };
        if (!(distance(inverse(exact)) <= kShown)) continue;
        std::array<float, 3> scene{};
        in_float.run_rgb(color.data(), scene.data(), 1);
        worst =
            std::max(worst, distance({static_cast<double>(scene[0]), static_cast<double>(scene[1]),
                                      static_cast<double>(scene[2])}));
    }
    return worst;
}

LanguageFacts language_of(const ShaderRequest& request) {
    return request.application ? language_for(*request.application) : facts_of(request.language);
}

/// True if the text could compute the nodes that it has in half floats.
bool are_halves_with_formulas(const GridsInText& grids) {
    return std::any_of(grids.begin(), grids.end(),
                       [](const auto& grid) { return !grid.second->has_formula(); }) &&
           std::all_of(grids.begin(), grids.end(),
                       [](const auto& grid) { return grid.first->has_formula(); });
}

double measure_in_float(const ShaderRequest& request, const ShaderProgram& program,
                        const GridsInText& grids) {
    if (request.is_inverse) return measure_inverse(request, program);
    const UniformValues values = values_of(request);
    const FloatRun in_float(bound(program, values), grids);
    const ReferenceEngine reference(bind_uniforms(pipeline_of(request), values));
    // Sources that are no input space use the samples of Rec.709.
    const InputSpace* space = &find_input_space("lin_rec709");
    for (const InputSpace& candidate : all_input_spaces()) {
        if (candidate.id == request.view.input) space = &candidate;
    }
    const SampleSet samples = make_sample_set(*space, {.gamut_grid_size = 6, .random_count = 3000});
    std::vector<float> got(samples.rgb.size());
    std::vector<double> truth(samples.rgb.size());
    in_float.run_rgb(samples.rgb.data(), got.data(), samples.size());
    reference.run_rgb(samples.rgb.data(), truth.data(), samples.size());
    const Expr light = code_value(Expr::input());
    double worst = 0;
    for (std::size_t i = 0; i < samples.size(); ++i) {
        bool is_number = true;
        for (std::size_t c = 0; c < 3; ++c)
            is_number = is_number && !std::isnan(samples.rgb[3 * i + c]);
        if (!is_number) continue;
        for (std::size_t c = 3 * i; c < 3 * i + 3; ++c) {
            const auto code = [&](double x) { return is_light(request) ? evaluate(light, x) : x; };
            const double right = code(truth[c]);
            const double error = std::fabs(code(static_cast<double>(got[c])) - right) /
                                 std::max(1.0, std::fabs(right));
            if (std::isnan(error)) return kInfinity;
            worst = std::max(worst, error);
        }
    }
    return worst;
}

/// Hash of all operations and numbers, including tables and Grids. Numbers are hashed as floats,
/// so that different rounding of math libraries gives the same definition.
std::string definition_hash(const Pipeline& pipeline) {
    const std::array<Expr, 3> rgb = compose(pipeline);
    std::string text;
    std::unordered_map<const ExprNode*, std::size_t> number;
    std::set<const void*> seen;
    const auto digits = [](double x) {
        return shortest(static_cast<double>(static_cast<float>(x)));
    };
    const auto add_numbers = [&](const void* what, const std::vector<double>& numbers) {
        if (!seen.insert(what).second) return;
        const std::vector<float> floats(numbers.begin(), numbers.end());
        text += little_endian_bytes(floats);
    };
    for (const Expr& e : nodes_of(rgb)) {
        text += std::to_string(static_cast<int>(e.op()));
        for (int i = 0; i < e.operand_count(); ++i)
            text += " " + std::to_string(number.at(e.operand(i).node()));
        if (e.is_constant()) text += " " + digits(e.value());
        if (e.op() == ExprOp::input) text += " " + std::to_string(e.input_index());
        if (e.op() == ExprOp::uniform) text += " " + e.uniform_name();
        if (e.op() == ExprOp::lookup) {
            add_numbers(e.table().get(), e.table()->samples);
            add_numbers(&e.table()->positions, e.table()->positions);
        }
        if (e.op() == ExprOp::grid) {
            text += " " + std::to_string(e.channel());
            add_numbers(e.grid().get(), e.grid()->nodes());
        }
        text += "\n";
        number.emplace(e.node(), number.size());
    }
    return content_hash(text);
}

std::string output_text(const ShaderRequest& request) {
    const View& view = request.view;
    if (view.display == kNativeOutput) return "the operator's own output";
    if (view.display == kLinearOutput)
        return "display-linear, Rec.709, 1.0 = display peak, not limited";
    const Display& display = find_display(view.display);
    return "code values for " + display.title + " (" + display.source + ")";
}

/// Estimates of the largest error of each Grid's nodes.
std::map<const Grid*, double> errors_of_nodes(const GridsInText& grids) {
    std::map<const Grid*, double> errors;
    for (const auto& [exact, in_text] : grids) {
        double& worst = errors[exact];
        const std::vector<double>& right = exact->nodes();
        const std::vector<double>& got = in_text->nodes();
        for (std::size_t i = 0; i < right.size(); ++i)
            worst = std::max(worst, std::fabs(got[i] - right[i]));
        if (in_text->has_formula())
            worst = std::max(worst, first_order_error(node_formula(*exact)).vulkan);
    }
    return errors;
}

/// Result of measure_shader(), from the request's cache folder if present.
ShaderErrors known_errors(const ShaderRequest& request, const ShaderProgram& program,
                          const std::string& definition, const GridsInText& grids) {
    // Change it if the measurement of errors or the float formulas change.
    constexpr int kVersion = 1;
    std::vector<std::string> functions;
    const auto add = [&](const auto& some) {
        for (const auto& function : some)
            functions.push_back(function.name);
    };
    add(program.matrices);
    add(program.scalars);
    add(program.colors);
    std::string key = fmt::format(
        "shader errors {} " TONEWRIGHT_VERSION ": {} {}, {} {} {} {}, {}", kVersion,
        shader_function_name(request), definition, request.view.input, request.view.display,
        request.view.exposure_stops, static_cast<int>(request.curves), fmt::join(functions, " "));
    for (const auto& [name, value] : values_of(request))
        key += fmt::format(", {} {}", name, value);
    for (const auto& [exact, in_text] : grids)
        key += in_text->has_formula() ? ", computed nodes" : ", halves";
    // Three errors, and the index of a function, or the count of functions for none.
    const NumberCheck are_errors = numbers_in(4, 0, kInfinity);
    const auto is_usable = [&](const std::vector<double>& numbers) {
        return are_errors(numbers) && numbers[3] <= static_cast<double>(functions.size());
    };
    const std::vector<double> numbers =
        cached_numbers(request.cache_folder, "shader_errors", key, is_usable, [&] {
            const ShaderErrors errors = measure_shader(request);
            const auto place = std::find(functions.begin(), functions.end(), errors.arises_in);
            return std::vector<double>{errors.in_float, errors.guaranteed, errors.vulkan_estimate,
                                       static_cast<double>(place - functions.begin())};
        });
    const auto place = static_cast<std::size_t>(numbers[3]);
    return {numbers[0], numbers[1], place < functions.size() ? functions[place] : "", numbers[2]};
}

/// Wraps text into comment lines after a label.
std::string comment(const std::string& label, const std::string& words) {
    constexpr std::size_t kWidth = 100;
    std::string text;
    std::string row = fmt::format("// {:<11}", label);
    bool is_first = true;
    std::size_t begin = 0;
    while (begin < words.size()) {
        const std::size_t end = std::min(words.find(' ', begin), words.size());
        const std::string word = words.substr(begin, end - begin);
        if (!is_first && row.size() + 1 + word.size() > kWidth) {
            text += row + "\n";
            row = fmt::format("// {:<11}", "");
            is_first = true;
        }
        row += (is_first ? "" : " ") + word;
        is_first = false;
        begin = end + 1;
    }
    return text + row + "\n";
}

/// Replaces non-ASCII bytes, for languages with ASCII sources.
std::string ascii(std::string text) {
    for (char& c : text) {
        if (static_cast<unsigned char>(c) >= 0x80) c = '?';
    }
    return text;
}

std::string header(const ShaderRequest& request, const Shader& shader,
                   const std::string& definition, const GridsInText& grids) {
    const View& view = request.view;
    const Operator& op = *view.op.op;
    std::string text = "// " + op.title;
    if (view.op.preset) text += ", " + view.op.preset->title;
    if (request.is_inverse) text += ", inverse";
    text +=
        "\n// Written by Tonewright " TONEWRIGHT_VERSION ", definition " + definition + "\n//\n";
    std::string space = view.input;
    for (const InputSpace& candidate : all_input_spaces()) {
        if (candidate.id == view.input) space = candidate.title;
    }
    const std::string scene = space + ", 1.0 = diffuse white";
    const std::string shown = output_text(request);
    const auto add = [&](const char* label, const std::string& words) {
        if (!words.empty()) text += comment(label, ascii(words));
    };
    add("Operator", operator_text(view.op));
    add("Source", op.source);
    add("License", op.license + "; this text: Apache-2.0");
    add("Settings", settings_text(view.op, request.uniforms));
    const bool has_exposure = std::find(request.uniforms.begin(), request.uniforms.end(),
                                        kExposureUniform) != request.uniforms.end();
    add("Exposure", has_exposure ? "argument in stops: scene values times 2^exposure"
                                 : shortest(view.exposure_stops) + " stops");
    for (const std::string& uniform : request.uniforms) {
        for (const ParameterSpec& spec : op.parameters) {
            if (spec.name != uniform) continue;
            add("Argument",
                fmt::format("{}: {}; [{}, {}]{}{}", spec.name, spec.help, shortest(spec.min),
                            shortest(spec.max), spec.unit.empty() ? "" : " ", spec.unit));
        }
    }
    add("Input", request.is_inverse ? shown : scene);
    add("Output", request.is_inverse ? scene : shown);
    add("Negatives", request.is_inverse ? "" : op.negatives);
    if (request.application) add("Use", request.application->steps);
    for (const auto& [exact, in_text] : grids) {
        add("3D LUT",
            fmt::format("{0}^3 nodes, {1}, interpolated in tetrahedra", exact->edge(),
                        in_text->has_formula() ? "four of which the text computes for each color"
                                               : "in half floats"));
    }
    if (facts_of(request.language).is_double && !request.application) {
        add("Precision",
            "64-bit float: the formulas of the double reference, with the mathematical functions "
            "of the JavaScript engine.");
        add("NaN", "replace it by 0 first, as every engine of Tonewright does");
        return text;
    }
    const char* const unit = request.is_inverse      ? "the view's code values of the result"
                             : is_of_a_display(view) ? "code values from 0 to 1"
                                                     : "sRGB code values from 0 to 1";
    std::string precision = fmt::format(
        "32-bit float. Each operation rounded once: within {} of the double reference, in {} "
        "(measured).",
        rounded_up(shader.errors.in_float), unit);
    if (std::isfinite(shader.errors.guaranteed)) {
        precision += fmt::format(
            " Guaranteed: within {} of these formulas wherever each operation is as exact as "
            "Vulkan and WGSL demand, for channels from 0 to 65504.",
            rounded_up(shader.errors.guaranteed));
    } else if (request.curves == ShaderCurves::fitted) {
        precision +=
            " Curves are polynomials of segments, fitted and measured; no guaranteed bound.";
    } else if (!request.is_inverse) {
        precision +=
            fmt::format(" No useful guaranteed bound: the error of {}_{} may be too large.",
                        shader.function, shader.errors.arises_in);
        if (std::isfinite(shader.errors.vulkan_estimate)) {
            precision += fmt::format(
                " With the errors that Vulkan and WGSL allow each operation: about {} (first "
                "order: an estimate, no bound).",
                rounded_up(shader.errors.vulkan_estimate));
        }
    }
    add("Precision", precision);
    if (!request.is_inverse) {
        View on_srgb = view;
        on_srgb.display = "srgb";
        const std::string measured =
            request.curves == ShaderCurves::formula && grids.empty()
                ? measured_errors(view.display == "srgb" && request.uniforms.empty()
                                      ? definition
                                      : definition_hash(build_view(on_srgb)))
                : std::string();
        add("Measured",
            measured.empty()
                ? "not with these settings; `tonewright verify` measures GLSL on a machine's GPU"
                : "in code values of sRGB, negatives included: " + measured);
    }
    add("NaN", "undefined, depends on the compiler; all other inputs give finite results");
    return text;
}

}  // namespace

bool reads_grid(const View& view) {
    const std::vector<Expr> nodes = nodes_of(compose(build_view(view)));
    return std::any_of(nodes.begin(), nodes.end(),
                       [](const Expr& e) { return e.op() == ExprOp::grid; });
}

std::string shader_function_name(const ShaderRequest& request) {
    std::string name = "tw_" + identifier(request.view.op);
    if (request.is_inverse) name += "_inverse";
    if (is_of_a_display(request.view)) name += "_encoded";
    return name;
}

ShaderErrors measure_shader(const ShaderRequest& request) {
    check(request);
    const ShaderProgram program = program_of(request);
    const GridsInText grids =
        grids_in_text(program, language_of(request), request.tables, shader_function_name(request));
    ShaderErrors errors;
    errors.in_float = measure_in_float(request, program, grids);
    if (request.is_inverse) return errors;
    const ShaderProgram constant = bound(program, values_of(request));
    const Expr metric = is_light(request) ? code_value(Expr::input()) : Expr::input();
    // Lower limit of the measured error: half a unit in the last place of white.
    constexpr double kUseful = 300;
    if (request.curves == ShaderCurves::formula) {
        const GuaranteedBound guaranteed =
            guaranteed_bound(constant, metric, kUseful * std::max(errors.in_float, 0x1p-24));
        // The bound knows no nodes in half floats and no computed ones.
        errors.guaranteed = grids.empty() ? guaranteed.error : kInfinity;
        if (std::isinf(errors.guaranteed))
            errors.arises_in = grids.empty() ? guaranteed.arises_in : kGridFunction;
    }
    std::array<Expr, 3> outputs = compose(constant);
    for (Expr& e : outputs)
        e = substitute(metric, Span<const Expr>(&e, 1));
    constexpr double kUseless = 0.1;
    const double estimate = first_order_error(outputs, errors_of_nodes(grids)).vulkan;
    if (estimate < kUseless) errors.vulkan_estimate = estimate;
    return errors;
}

Shader write_shader(const ShaderRequest& given, const ShaderErrors* errors) {
    check(given);
    ShaderRequest request = given;
    const Pipeline pipeline = pipeline_of(request);
    ShaderProgram program = program_of(request);
    add_names_of_numbers(names_in(program), program.names);
    const LanguageFacts language = language_of(request);
    Shader shader;
    shader.function = shader_function_name(request);
    const std::string definition = definition_hash(pipeline);
    if (request.application)
        request.tables = tables_for(*request.application, program, request.tables);
    GridsInText grids;
    const auto measure = [&] {
        grids = grids_in_text(program, language, request.tables, shader.function);
        shader.errors =
            errors && grids.empty() ? *errors : known_errors(request, program, definition, grids);
    };
    measure();
    // Looks amplify the error of half floats.
    constexpr double kTenBits = 1.0 / 1023;
    if (request.tables == ShaderTables::by_size && shader.errors.in_float > kTenBits &&
        are_halves_with_formulas(grids)) {
        request.tables = ShaderTables::formula;
        measure();
    }
    const std::string prologue =
        *language.prologue ? std::string("\n") + language.prologue : std::string();
    PrintedProgram printed =
        print_program(program, language, shader.function, request.uniforms, request.tables);
    const std::string comments = header(request, shader, definition, grids);
    shader.text = comments + prologue + printed.text;
    shader.textures = std::move(printed.textures);
    if (!request.application) return shader;
    // The same functions for the application's other backend.
    std::string other;
    if (const std::optional<ShaderLanguage> second = second_language(*request.application)) {
        other = print_program(program, second_language_for(*second), shader.function,
                              request.uniforms, request.tables)
                    .text;
    }
    return wrap(*request.application, std::move(shader), arguments_of(request), other);
}

TONEWRIGHT_NAMESPACE_END
