// SPDX-License-Identifier: Apache-2.0
#include "tasks/report.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <iterator>
#include <map>
#include <set>
#include <utility>

#include "base/strings.h"
#include "report/page.h"
#include "tasks/archive.h"
#include "tasks/engines.h"
#include "tasks/json.h"
#include "tasks/json_forms.h"
#include "tasks/verify.h"
#include "tonewright/definition.h"
#include "tonewright/engine.h"
#include "tonewright/registry.h"
#include "tonewright/shader.h"
#include "verify/backends.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

/// The page compares on an sRGB screen.
constexpr const char* kDisplay = "srgb";

/// Each operator once, and the operator of the page's false colors.
std::vector<ResolvedOperator> with_false_color(std::vector<ResolvedOperator> operators) {
    operators.push_back(resolve_operator("false_color"));
    std::vector<ResolvedOperator> all;
    std::set<std::string> seen;
    for (ResolvedOperator& op : operators) {
        if (seen.insert(operator_text(op)).second) all.push_back(std::move(op));
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
    explicit PageContents(const ReportRequest& request)
        : request_(request), operators_(with_false_color(request.operators)) {
        std::copy_if(operators_.begin(), operators_.end(), std::back_inserter(local_operators_),
                     [](const ResolvedOperator& op) { return op.op->is_local(); });
    }

    std::string write() {
        const std::vector<std::string> names =
            request_.pictures.empty() ? std::vector<std::string>{""} : request_.pictures;
        // First, because a picture that cannot be read should end the command at once.
        for (const std::string& path : names)
            add_picture(path);
        Json operators = Json::array();
        for (std::size_t i = 0; i < operators_.size(); ++i) {
            operators.push_back(operator_json(i));
            tell_progress(i + 1);
        }
        const Json page = {{"version", TONEWRIGHT_VERSION},
                           {"operators", operators},
                           {"pictures", pictures_},
                           {"backends", backends_},
                           {"backend_notes", notes_},
                           {"parity", parity()},
                           {"names", all_to_json(meaning_tables())}};
        files_.push_back({"page.json", page.dump()});
        const std::string references =
            "globalThis.tonewrightReferences = {" + references_ + "\n};\n";
        files_.push_back({"references.js", references});
        return make_report_page(make_archive(files_), references);
    }

  private:
    void tell_progress(std::size_t done) const {
        // Local operators have nothing to verify.
        const std::size_t views =
            request_.has_parity ? operators_.size() - local_operators_.size() : 0;
        if (request_.progress) request_.progress(done, operators_.size() + views);
    }
    void add_picture(const std::string& path) {
        ReportPicture picture = request_.read_picture(path, local_operators_);
        const std::string name = fmt::format("picture{}", pictures_.size());
        Json shown = Json::object();
        for (std::size_t i = 0; i < local_operators_.size(); ++i) {
            const std::string file = fmt::format("{}_{}.png", name, i);
            shown.add(operator_text(local_operators_[i]), file);
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
        request.cache_folder = request_.cache_folder;
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
        request.cache_folder = request_.cache_folder;
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
        const Pipeline pipeline = build_view(view);
        ReferenceEngine(pipeline).run_rgb(rgb.data(), truth.data(), rgb.size() / 3);
        std::string bytes;
        backends_.clear();
        for (const Backend& backend : all_backends()) {
            if (backend.title.empty()) continue;
            try {
                std::vector<float> shown(rgb.size());
                backend.start({view, pipeline, nullptr, request_.cache_folder})(
                    rgb.data(), shown.data(), rgb.size() / 3);
                bytes += packed_differences(shown, truth);
                backends_.push_back(backend.title);
            } catch (const Error& e) {
                notes_[backend.title] = e.what();
            }
        }
        const std::string file = fmt::format("measured{}_{}", picture, op);
        files_.push_back({file, std::move(bytes)});
        return file;
    }

    [[nodiscard]] Json parity() const {
        if (!request_.has_parity) return Json::array();
        VerifyRequest request = {.is_quick = true};
        std::copy_if(operators_.begin(), operators_.end(),
                     std::back_inserter(request.options.operators),
                     [](const ResolvedOperator& op) { return !op.op->is_local(); });
        request.options.only_best_target = true;
        request.options.cache_folder = request_.cache_folder;
        request.options.progress = [this](std::size_t done, std::size_t) {
            tell_progress(operators_.size() + done);
        };
        if (request_.shader_runs) request.options.shaders = request_.shader_runs();
        return all_to_json(verify(request).rows);
    }

    const ReportRequest& request_;
    std::vector<ResolvedOperator> operators_;
    std::vector<ResolvedOperator> local_operators_;
    std::vector<Json> pictures_;
    std::vector<MeasuredGrid> grids_;
    std::vector<std::string> backends_;
    std::map<std::string, std::string> notes_;
    std::vector<GeneratedFile> files_;
    std::set<std::string> written_;
    std::string references_;
};

}  // namespace

std::vector<ResolvedOperator> report_operators(bool has_variants) {
    std::vector<ResolvedOperator> all;
    if (has_variants) {
        for (const OperatorVariant& variant : all_variants())
            all.push_back(resolve_operator(variant.name, {}, variant.look));
    } else {
        for (const Operator& op : all_operators())
            all.push_back(resolve_operator(op.id));
    }
    for (const Operator& op : local_operators())
        all.push_back(resolve_picture_operator(op.id));
    return all;
}

std::string make_report(const ReportRequest& request) { return PageContents(request).write(); }

TONEWRIGHT_NAMESPACE_END
