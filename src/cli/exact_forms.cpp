// SPDX-License-Identifier: Apache-2.0
#include "cli/exact_forms.h"

#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <map>
#include <optional>
#include <vector>

#include "base/strings.h"
#include "cli/elapsed_line.h"
#include "lut/photograph_error.h"
#include "measure/photographs.h"
#include "ocio/lut_chain.h"
#include "tonewright/engine.h"
#include "tonewright/registry.h"
#include "tonewright/shader.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

struct Form {
    double error;  // code values, 99.9 % of photographs
    std::string title;
    std::string command;
};

constexpr double kCodes = 255;
/// A hundredth of an 8-bit code is half a code of 14 bits.
constexpr double kExact = 0.01;
/// Rounds to the same 8-bit code.
constexpr double kNearlyExact = 0.5;

std::string grade_of(double codes) {
    if (codes < kExact) return "exact";
    if (codes <= kNearlyExact) return "near";
    return fmt::format("{:.1f}", codes);
}

class Forms {
  public:
    explicit Forms(const ViewOptions& options) : options_(options), op_(options.resolved()) {}

    std::vector<Form> of(const LutApplication& host) {
        std::vector<Form> forms;
        if (reads_chains(host, LutFormat::ctf)) forms.push_back(chain(host));
        forms.push_back(table(host));
        for (const ShaderApplication& application : shader_applications()) {
            if (application.id == host.id) forms.push_back(shader(application));
        }
        std::stable_sort(forms.begin(), forms.end(),
                         [](const Form& a, const Form& b) { return a.error < b.error; });
        return forms;
    }

  private:
    [[nodiscard]] View view(const ResolvedOperator& op, const std::string& input,
                            const std::string& display) const {
        ViewOptions options = options_;
        if (!options.given.contains("--input")) options.input = input;
        if (!options.given.contains("--display")) options.display = display;
        return options.view(op);
    }

    /// The command line with the user's own options.
    [[nodiscard]] std::string command(const std::string& verb, const std::string& op,
                                      const std::string& host, const std::string& extension) const {
        std::string text = fmt::format("tonewright {} {}", verb, op);
        for (const std::string& setting : options_.set)
            text += " --set " + setting;
        if (!options_.look.empty()) text += " --look " + options_.look;
        if (options_.given.contains("--exposure"))
            text += fmt::format(" --exposure {}", options_.exposure);
        if (options_.given.contains("--display")) text += " --display " + options_.display;
        std::string stem = op;
        std::replace_if(
            stem.begin(), stem.end(), [](char c) { return c == ':' || c == '='; }, '_');
        return fmt::format("{} --for {} -o {}{}", text, host, stem, extension);
    }

    Form chain(const LutApplication& host) {
        LutRequest request;
        request.encoding = parse_input_encoding("linear");
        request.view = view(op_, request.encoding.default_input, host.display);
        request.format = LutFormat::ctf;
        if (!is_lut_chain(request)) {
            return {0, "clf or ctf, scene-linear: a 1D table",
                    command("bake", options_.op, host.id, ".clf")};
        }
        if (!chain_) chain_ = make_lut_chain(request, LutNodes::automatic, user_cache_folder());
        const std::string name = chain_->fits_clf ? "clf" : "ctf";
        return {chain_->error.photographs.p999, name + ", scene-linear input",
                command("bake", options_.op, host.id, "." + name)};
    }

    /// The LUT that `bake --for` writes.
    Form table(const LutApplication& host) {
        LutRequest request;
        request.encoding = parse_input_encoding(host.encoding);
        request.view = view(op_, lut_input_of(host, *op_.op), host.display);
        request.format = host.format;
        const bool is_curve = host.takes_any_primaries && is_per_channel(build_view(request.view));
        if (!is_curve) {
            request.dimension = LutDimension::three;
            request.size = host.size;
            request.bits = host.bits;
        }
        const std::string key =
            fmt::format("{} {} {} {} {} {}", host.encoding, host.display, request.view.input,
                        is_curve ? 0 : host.size, host.bits.value_or(0), host.interpolation);
        if (!known_.contains(key)) {
            known_[key] = bake_lut(request, LutNodes::automatic, interpolation_of(&host))
                              .error.photographs.p999;
        }
        const std::string extension =
            is_picture_format(host.format) ? ".png" : "." + name_of(host.format);
        return {known_[key],
                is_curve ? "1D table"
                         : fmt::format("{} of {} a side, {} input", name_of(host.format), host.size,
                                       request.encoding.id),
                command("bake", options_.op, host.id, extension)};
    }

    /// A shader of a grid is the formula that the grid samples, if it has one.
    Form shader(const ShaderApplication& application) {
        const View own = view(op_, "lin_rec709", application.display);
        const std::string language = application.title + ", shader";
        if (!reads_grid(own))
            return {0, language,
                    command("shader", options_.op, application.id, application.extension)};
        const std::vector<Preset>& presets = op_.op->presets;
        const auto preset = std::find_if(presets.begin(), presets.end(),
                                         [](const Preset& p) { return p.id == "formula"; });
        if (preset == presets.end()) return {std::numeric_limits<double>::infinity(), "", ""};
        ResolvedOperator by_formula =
            resolve(*op_.op, &*preset, options_.settings(), options_.look);
        by_formula.owner = op_.owner;
        const View formula = view(by_formula, "lin_rec709", application.display);
        const std::vector<float> light = photograph_light(find_input_space("lin_rec709").primaries);
        std::vector<double> shown(light.size());
        std::vector<double> wanted(light.size());
        ReferenceEngine(build_view(formula)).run_rgb(light.data(), shown.data(), light.size() / 3);
        ReferenceEngine(build_view(own)).run_rgb(light.data(), wanted.data(), light.size() / 3);
        const PhotographError error = photograph_error(own, shown, wanted, nullptr);
        return {error.p999, language + " of the formula",
                command("shader", op_.op->id + ":formula", application.id, application.extension)};
    }

    const ViewOptions& options_;
    const ResolvedOperator op_;
    std::map<std::string, double> known_;  // errors of tables
    std::optional<LutChain> chain_;        // the same for all applications: their display is sRGB
};

}  // namespace

void print_exact_forms(const ViewOptions& options, const LutApplication* host) {
    fmt::print(
        "{}: files for applications; 99.9 % of photographs are within this many codes of "
        "255 (exact: less than 0.01; near: at most 0.5)\n",
        options.op);
    Forms forms(options);
    for (const LutApplication& one : all_lut_applications()) {
        if (host && host != &one) continue;
        fmt::print("\n  {}: {}\n", one.id, one.title);
        const std::vector<Form> found = [&] {
            const ElapsedLine line("bake --exact");
            return forms.of(one);
        }();
        for (const Form& form : found) {
            if (form.command.empty()) continue;
            fmt::print("    {:<5}  {}\n           {}\n", grade_of(kCodes * form.error), form.title,
                       form.command);
        }
    }
}

TONEWRIGHT_NAMESPACE_END
