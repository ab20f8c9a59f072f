// SPDX-License-Identifier: Apache-2.0
#include "shader_runs/shader_run.h"

#include <algorithm>
#include <array>

#include "base/strings.h"
#include "ocio/gpu.h"
#include "tonewright/error.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

class OpenGlRun : public ShaderRun {
  public:
    explicit OpenGlRun(GlslDialect dialect) : dialect_(dialect) {}

    [[nodiscard]] std::string by() const override { return GlslGpu::renderer(dialect_); }

    void run_rgb(const Shader& shader, const float* in, float* out,
                 std::size_t pixel_count) override {
        std::vector<GlslTexture> textures;
        for (const ShaderTexture& texture : shader.textures)
            textures.push_back({texture.name, texture.size, texture.rgba.data()});
        GlslGpu(shader.text, shader.function, textures, dialect_).run_rgb(in, out, pixel_count);
    }

  private:
    GlslDialect dialect_;
};

struct Runner {
    const char* language;
    std::unique_ptr<ShaderRun> (*make)();
    /// A function `same` that returns its color: what fails with it fails with every text.
    const char* same;
};

constexpr std::array kRunners = {
    Runner{"glsl", run_on_opengl, "vec3 same(vec3 c) { return c; }\n"},
    Runner{"glsl-es", run_on_opengl_es,
           "precision highp float;\nvec3 same(vec3 c) { return c; }\n"},
    Runner{"wgsl", run_wgsl_on_dawn, "fn same(c: vec3<f32>) -> vec3<f32> { return c; }\n"},
    Runner{"hlsl", run_hlsl_on_dawn, "float3 same(float3 c) { return c; }\n"},
    Runner{"dctl", run_on_opencl, "__DEVICE__ float3 same(float3 c) { return c; }\n"},
    Runner{"c", run_by_c_compiler,
           "static void same(const float* in, float* out) {\n"
           "    for (int i = 0; i < 3; ++i) out[i] = in[i];\n}\n"},
};

std::unique_ptr<ShaderRun> try_run(const Runner& runner) {
    std::unique_ptr<ShaderRun> run = runner.make();
    const std::array<float, 3> in = {0.25F, 0.5F, 1.0F};
    std::array<float, 3> out{};
    run->run_rgb({.function = "same", .text = runner.same, .errors = {}}, in.data(), out.data(), 1);
    if (in != out) throw Error(run->by() + " does not return a color as it is");
    return run;
}

/// Ids of the languages that the names choose.
std::vector<std::string> languages_to_run(const std::vector<std::string>& names) {
    std::vector<std::string> ids(kRunners.size());
    std::transform(kRunners.begin(), kRunners.end(), ids.begin(),
                   [](const Runner& runner) { return runner.language; });
    std::vector<std::string> chosen;
    bool is_none = false;
    bool is_all = names.empty();
    for (const std::string& name : names) {
        if (is_same_name(name, "none")) {
            is_none = true;
        } else if (is_same_name(name, "all")) {
            is_all = true;
        } else {
            chosen.push_back(ids[find_choice("shaders", name, ids)]);
        }
    }
    if (is_none && (is_all || !chosen.empty()))
        throw Error({.parameter = "shaders", .value = "none and more", .expected = "none alone"});
    return is_all ? ids : chosen;
}

}  // namespace

std::unique_ptr<ShaderRun> run_on_opengl() {
    return std::make_unique<OpenGlRun>(GlslDialect::desktop);
}

std::unique_ptr<ShaderRun> run_on_opengl_es() {
    return std::make_unique<OpenGlRun>(GlslDialect::es);
}

std::vector<NotExecuted> add_shader_runs(VerifyOptions& options,
                                         const std::vector<std::string>& names) {
    std::vector<NotExecuted> not_executed;
    const std::vector<std::string> chosen = languages_to_run(names);
    // Tonewright's shaders do not read a config.
    if (!options.with_gpu || (options.operators.empty() && !options.config.empty())) return {};
    for (const Runner& runner : kRunners) {
        const ShaderLanguageInfo& language = find_shader_language(runner.language);
        if (std::find(chosen.begin(), chosen.end(), language.id) == chosen.end()) continue;
        try {
            options.shaders.push_back({language, try_run(runner)});
        } catch (const Error& e) {
            not_executed.push_back({language.id, one_line(e.what())});
        }
    }
    const bool is_all = names.empty() || std::any_of(names.begin(), names.end(), [](const auto& n) {
                            return is_same_name(n, "all");
                        });
    if (!is_all) return not_executed;
    for (const ShaderLanguageInfo& language : shader_languages()) {
        if (std::find(chosen.begin(), chosen.end(), language.id) == chosen.end())
            not_executed.push_back({language.id, "nothing can run it here"});
    }
    for (const ShaderApplication& application : shader_applications())
        not_executed.push_back(
            {application.id, "verify runs functions, not the files of applications"});
    return not_executed;
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
