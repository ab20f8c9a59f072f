// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <map>
#include <memory>
#include <set>

#include "base/atomic_file.h"
#include "base/strings.h"
#include "cli/elapsed_line.h"
#include "cli/json_forms.h"
#include "cli/messages.h"
#include "cli/options.h"
#include "cli/picture_commands.h"
#include "cli/shared_options.h"
#include "cli/suggestions.h"
#include "report/backends.h"
#include "report/page.h"
#include "shader_runs/shader_run.h"
#include "tasks/archive.h"
#include "tasks/json.h"
#include "tonewright/definition.h"
#include "tonewright/engine.h"
#include "tonewright/ocio.h"
#include "tonewright/registry.h"
#include "tonewright/shader.h"
#include "tonewright/verify.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

struct Options {
    std::string file;
    std::vector<std::string> pictures;
    std::vector<std::string> operators;
    int width = 960;
    std::string input_units = "relative";
    double reference_white = kUnitLuminance;
    PictureChoice choice;
    bool no_parity = false;
};

/// The page compares on an sRGB screen.
constexpr const char* kDisplay = "srgb";
/// The operator of the page's false colors.
constexpr const char* kFalseColor = "false_color";

std::vector<ResolvedOperator> operators_of(const Options& options) {
    std::vector<ResolvedOperator> all;
    std::set<std::string> seen;
    const auto add = [&](const ResolvedOperator& op) {
        if (seen.insert(operator_text(op)).second) all.push_back(op);
    };
    const bool is_all = options.operators == std::vector<std::string>{"all"};
    if (is_all) {
        for (const OperatorVariant& variant : all_variants())
            add(resolve_operator(variant.name, {}, variant.look));
    } else if (options.operators.empty()) {
        for (const Operator& op : all_operators())
            add(resolve_operator(op.id));
    } else {
        for (const std::string& text : options.operators)
            add(resolve_for_command(text));
        add(resolve_operator(kFalseColor));
    }
    if (is_all || options.operators.empty()) {
        for (const Operator& op : local_operators())
            add(resolve_picture_operator(op.id));
    }
    return all;
}

/// Pixels that backends are measured on: x and y are multiples of a step.
struct MeasuredGrid {
    int step = 1;
    std::vector<float> rgb;
};

MeasuredGrid grid_of(const ReportPicture& picture) {
    constexpr double kMostPoints = 2500;
    MeasuredGrid grid;
    const double pixels = static_cast<double>(picture.width) * picture.height;
    grid.step = std::max(1, static_cast<int>(std::ceil(std::sqrt(pixels / kMostPoints))));
    for (int y = 0; y < picture.height; y += grid.step) {
        for (int x = 0; x < picture.width; x += grid.step) {
            const auto at =
                3 * (static_cast<std::size_t>(y) * static_cast<std::size_t>(picture.width) +
                     static_cast<std::size_t>(x));
            for (std::size_t c = 0; c < 3; ++c)
                grid.rgb.push_back(picture.rgb[at + c]);
        }
    }
    return grid;
}

/// Differences from the reference in units of 1/1024 of an 8-bit code, as little-endian 16-bit
/// integers.
std::string packed_differences(const std::vector<float>& shown, const std::vector<double>& truth) {
    constexpr double kUnits = 255.0 * 1024;
    constexpr double kMost = 32767;
    std::string bytes;
    bytes.reserve(2 * shown.size());
    for (std::size_t i = 0; i < shown.size(); ++i) {
        const double units = (static_cast<double>(shown[i]) - truth[i]) * kUnits;
        const auto packed = static_cast<std::uint16_t>(
            static_cast<std::int16_t>(std::lround(std::clamp(units, -kMost, kMost))));
        bytes += static_cast<char>(packed & 0xFFU);
        bytes += static_cast<char>(packed >> 8U);
    }
    return bytes;
}

class PageContents {
  public:
    explicit PageContents(const Options& options)
        : options_(options), operators_(operators_of(options)) {}

    std::string write() {
        const std::vector<std::string> names =
            options_.pictures.empty() ? std::vector<std::string>{""} : options_.pictures;
        // First, because a picture that cannot be read should end the command at once.
        for (const std::string& path : names)
            add_picture(path);
        Json operators = Json::array();
        for (std::size_t i = 0; i < operators_.size(); ++i)
            operators.push_back(operator_json(i));
        Json backends = Json::array();
        for (const std::string& name : backends_)
            backends.push_back(name);
        Json pictures = Json::array();
        for (const Json& picture : pictures_)
            pictures.push_back(picture);
        const Json page = {{"version", TONEWRIGHT_VERSION}, {"operators", operators},
                           {"pictures", pictures},          {"backends", backends},
                           {"backend_notes", notes_},       {"parity", parity()}};
        files_.push_back({"page.json", page.dump()});
        const std::string references =
            "globalThis.tonewrightReferences = {" + references_ + "\n};\n";
        files_.push_back({"references.js", references});
        return make_report_page(make_archive(files_), references);
    }

  private:
    void add_picture(const std::string& path) {
        ReportPictureOptions wanted;
        wanted.path = path;
        wanted.width = options_.width;
        wanted.input_units = options_.input_units;
        wanted.reference_white = options_.reference_white;
        wanted.choice = options_.choice;
        for (const ResolvedOperator& op : operators_) {
            if (!op.op->is_local()) continue;
            wanted.local_operators.push_back(op);
        }
        ReportPicture picture = picture_commands().read_report_picture(wanted);
        const std::string name = fmt::format("picture{}", pictures_.size());
        Json shown = Json::object();
        for (std::size_t i = 0; i < wanted.local_operators.size(); ++i) {
            const std::string file = fmt::format("{}_{}.png", name, i);
            shown.add(operator_text(wanted.local_operators[i]), file);
            files_.push_back({file, std::move(picture.shown[i])});
        }
        files_.push_back({name + ".exr", std::move(picture.exr)});
        grids_.push_back(grid_of(picture));
        pictures_.push_back(Json{{"name", picture.name},
                                 {"file", name + ".exr"},
                                 {"width", picture.width},
                                 {"height", picture.height},
                                 {"step", grids_.back().step},
                                 {"shown", shown}});
    }

    Json operator_json(std::size_t index) {
        const ResolvedOperator& op = operators_[index];
        Json entry = {{"name", operator_text(op)}, {"title", title_of(op)}};
        entry.add("facts", to_json(*op.op));
        if (op.op->is_local()) return entry;
        ShaderRequest request;
        request.view = make_view(op, "lin_rec709", 0, kDisplay);
        request.language = ShaderLanguage::glsl_es;
        request.uniforms = live_parameters(*op.op);
        request.cache_folder = user_cache_folder();
        Json values = Json::object();
        for (const std::string& name : request.uniforms)
            values.add(name, op.params.number(name));
        request.uniforms.insert(request.uniforms.begin(), std::string(kExposureUniform));
        const Shader glsl = write_shader(request);
        // Large arrays are slow in browsers: the page draws with textures, and gives away arrays.
        request.tables = ShaderTables::texture;
        const Shader drawn = write_shader(request, &glsl.errors);
        request.tables = ShaderTables::by_size;
        request.language = ShaderLanguage::javascript;
        const Shader reference = write_shader(request, &glsl.errors);
        Json measured = Json::array();
        for (std::size_t i = 0; i < grids_.size(); ++i)
            measured.push_back(measured_json(request.view, i, index));
        entry.add("function", glsl.function);
        entry.add("glsl", glsl.text);
        add_reference(operator_text(op), reference);
        entry.add("uniforms", request.uniforms);
        entry.add("values", values);
        entry.add("textures", textures_json(glsl, reference));
        if (drawn.textures.size() > glsl.textures.size()) {
            entry.add("drawn",
                      Json{{"glsl", drawn.text}, {"textures", textures_json(drawn, reference)}});
        }
        entry.add("hdr", hdr_json(op, request.uniforms));
        entry.add("error", glsl.errors.in_float);
        entry.add("measured", measured);
        entry.add("definition", definition_or_null(op));
        return entry;
    }

    /// The text of a .tone file; null for an operator with tables or branches that such a file
    /// cannot express.
    static Json definition_or_null(const ResolvedOperator& op) {
        try {
            return definition_of(op);
        } catch (const Error&) {
            return nullptr;
        }
    }

    static std::string title_of(const ResolvedOperator& op) {
        std::string title = op.op->title;
        if (op.preset) title += " (" + op.preset->id + ")";
        for (const Look& look : op.op->looks) {
            if (look.id == op.params.look()) title += ", " + look.title;
        }
        return title;
    }

    /// The operator's HDR version for WebGPU, as light of which 1 is white; null if it does not
    /// exceed white.
    Json hdr_json(const ResolvedOperator& op, const std::vector<std::string>& uniforms) {
        // Light of Rec.709 with channels below 0 and above 1, as far as P3 and 1000 cd/m2 reach.
        const ResolvedOperator shown = resolve_for_display(op, {kP3D65, true, 1000});
        if (!(shown.peak() > 1)) return nullptr;
        ShaderRequest request;
        request.view = make_view(shown, "lin_rec709", 0, kLinearOutput);
        request.uniforms = uniforms;
        request.language = ShaderLanguage::wgsl;
        request.tables = ShaderTables::by_size;
        request.cache_folder = user_cache_folder();
        const Shader wgsl = write_shader(request);
        request.language = ShaderLanguage::javascript;
        const Shader reference = write_shader(request, &wgsl.errors);
        const std::string name = operator_text(op) + " hdr";
        add_reference(name, reference);
        Json values = Json::object();
        for (const std::string& uniform : uniforms) {
            if (uniform != kExposureUniform) values.add(uniform, shown.params.number(uniform));
        }
        return {{"name", name},
                {"function", wgsl.function},
                {"wgsl", wgsl.text},
                {"uniforms", uniforms},
                {"values", values},
                {"settings", settings_of(shown)},
                {"error", wgsl.errors.in_float},
                {"textures", textures_json(wgsl, reference)}};
    }

    /// Settings that the display decided, in the syntax of `--set`.
    static Json settings_of(const ResolvedOperator& op) {
        Json settings = Json::array();
        for (const ParameterSpec& spec : op.op->parameters) {
            if (!spec.from_display) continue;
            const std::string value = spec.kind == ParameterSpec::Kind::choice
                                          ? op.params.choice(spec.name)
                                          : fmt::format("{}", op.params.number(spec.name));
            settings.push_back(spec.name + "=" + value);
        }
        return settings;
    }

    /// Adds a property of an object: a function that takes the functions that fetch texels, and
    /// returns the operator's function and those that compute texels, by the names of the textures.
    void add_reference(const std::string& name, const Shader& reference) {
        std::vector<std::string> textures;
        std::string formulas;
        for (const ShaderTexture& texture : reference.textures) {
            textures.push_back(texture.name);
            if (!texture.formula.empty())
                formulas += fmt::format("{}: {}, ", texture.name, texture.formula);
        }
        references_ +=
            fmt::format("\n{}: ({}) => {{\n{}\nreturn [{}, {{ {} }}];\n}},", Json(name).dump(),
                        fmt::join(textures, ", "), reference.text, reference.function, formulas);
    }

    Json textures_json(const Shader& shader, const Shader& reference) {
        Json textures = Json::array();
        for (const ShaderTexture& texture : shader.textures) {
            const bool has_formula = std::any_of(
                reference.textures.begin(), reference.textures.end(), [&](const ShaderTexture& t) {
                    return t.name == texture.name && !t.formula.empty();
                });
            textures.push_back(texture_json(texture, has_formula));
        }
        return textures;
    }

    /// Looks share 3D LUTs: each is one file. The page computes those that have a formula.
    Json texture_json(const ShaderTexture& texture, bool has_formula) {
        std::string rgb;
        for (std::size_t i = 0; i < texture.rgba.size(); ++i) {
            if (i % 4 != 3)
                rgb.append(reinterpret_cast<const char*>(&texture.rgba[i]), sizeof(float));
        }
        const std::string file = content_hash(rgb) + ".rgb32f";
        if (!has_formula && written_.insert(file).second) files_.push_back({file, std::move(rgb)});
        return {{"name", texture.name},
                {"size", texture.size},
                {"file", file},
                {"has_formula", has_formula}};
    }

    /// The file of the differences; null if nothing was measured.
    Json measured_json(const View& view, std::size_t picture, std::size_t op) {
        const bool is_measuring = std::any_of(
            view.op.op->parameters.begin(), view.op.op->parameters.end(),
            [](const ParameterSpec& parameter) { return parameter.from_picture != nullptr; });
        if (is_measuring) return nullptr;
        const std::vector<float>& rgb = grids_[picture].rgb;
        std::vector<double> truth(rgb.size());
        ReferenceEngine(build_view(view)).run_rgb(rgb.data(), truth.data(), rgb.size() / 3);
        std::string bytes;
        backends_.clear();
        for (const BackendResult& result : run_backends(view, rgb, user_cache_folder())) {
            if (result.shown.empty()) {
                notes_[result.name] = result.reason;
                continue;
            }
            backends_.push_back(result.name);
            bytes += packed_differences(result.shown, truth);
        }
        const std::string file = fmt::format("measured{}_{}", picture, op);
        files_.push_back({file, std::move(bytes)});
        return file;
    }

    [[nodiscard]] Json parity() const {
        Json rows = Json::array();
        if (options_.no_parity) return rows;
        VerifyOptions verify_options;
        for (const ResolvedOperator& op : operators_) {
            if (!op.op->is_local()) verify_options.operators.push_back(op);
        }
        verify_options.gamut_grid_size = 9;
        verify_options.random_count = 10000;
        verify_options.only_best_target = true;
        verify_options.cache_folder = user_cache_folder();
        add_shader_runs(verify_options, {"glsl-es"});
        for (const ParityRow& row : verify(verify_options))
            rows.push_back(to_json(row));
        return rows;
    }

    const Options& options_;
    std::vector<ResolvedOperator> operators_;
    std::vector<Json> pictures_;
    std::vector<MeasuredGrid> grids_;
    std::vector<std::string> backends_;
    std::map<std::string, std::string> notes_;
    std::vector<GeneratedFile> files_;
    std::set<std::string> written_;
    std::string references_;
};

int run_report(const Options& options) {
    if (const std::string extension = extension_of(options.file);
        extension != ".html" && extension != ".htm") {
        throw Error("report: -o is " + printable(options.file) +
                    "; expected a name that ends in .html");
    }
    const ResultLine line;
    redirect_opencolorio_messages([](const std::string& text) {
        if (!message_options().is_quiet) print_message("OpenColorIO: " + text);
    });
    const std::string page = [&] {
        const ElapsedLine elapsed("report");
        PageContents contents(options);  // names are checked first
        require_writable_file(options.file);
        return contents.write();
    }();
    write_text_atomically(options.file, page);
    line.print(
        fmt::format("report: {}: {:.1f} MB", options.file, static_cast<double>(page.size()) / 1e6));
    return kOk;
}

}  // namespace

void add_report(CommandLine& program) {
    auto options = std::make_shared<Options>();
    const Command command =
        program.add("report", "Write an HTML page that shows operators on pictures.");
    command.group("Pictures");
    const char* const contents = "Contents";
    command.add("pictures", options->pictures,
                "pictures to embed, in any format that OpenImageIO reads (default: the chart)");
    command.add("-o", options->file, "HTML file to write").value("FILE").required().group(contents);
    command
        .add("--operators", options->operators,
             "operators, as for `compare`, or `all`, with presets and looks (default: all without "
             "them)")
        .suggest(suggest_operators)
        .one_value_each()
        .separated_by(',')
        .value("LIST")
        .group(contents);
    command.add("--width", options->width, "largest width of an embedded picture in pixels")
        .value("N")
        .show_default()
        .range(320, 8192)
        .group(contents);
    add_input_units(command, options->input_units, options->reference_white, contents);
    add_picture_choice(command, options->choice, "Pictures");
    command.add_flag("--no-parity", options->no_parity, "leave out the parity table")
        .group(contents);
    command.footer(
        "The page is one file. It opens without a server and sends no data. It runs the exported "
        "GLSL ES on the embedded pictures, and on pictures that you drop on it.\n"
        "Examples:\n"
        "  tonewright report -o page.html\n"
        "  tonewright report -o page.html render.exr --operators agx_blender,hable");
    command.action([options] { return run_report(*options); });
}

TONEWRIGHT_NAMESPACE_END
