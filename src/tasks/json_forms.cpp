// SPDX-License-Identifier: Apache-2.0
#include "tasks/json_forms.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstddef>

#include "tonewright/registry.h"
#include "tonewright/view.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

using Kind = ParameterSpec::Kind;

const char* kind_name(Kind kind) {
    if (kind == Kind::number) return "number";
    return kind == Kind::choice ? "choice" : "text";
}

const char* kind_name(SourceColorName::Kind kind) {
    // In the order of their declaration.
    constexpr std::array kNames = {"linear", "display", "config", "interop", "encoding", "pattern"};
    return kNames.at(static_cast<std::size_t>(kind));
}

Json to_json(const ParameterSpec& p, bool is_live) {
    Json j = {{"name", p.name}, {"kind", kind_name(p.kind)}, {"unit", p.unit}};
    if (p.kind == Kind::number) {
        j.add("default", p.default_value);
        j.add("min", p.min);
        j.add("max", p.max);
        j.add("live", is_live);
    } else {
        j.add("default", p.default_choice);
    }
    j.add("choices", p.choices);
    j.add("help", p.help);
    if (p.from_picture) j.add("statistic", p.statistic);
    j.add("decided_by_display", p.from_display != nullptr);
    return j;
}

/// The operator with the parameters that an HDR display of 1000 cd/m2 decides.
ResolvedOperator on_hdr_display(const Operator& op, const Preset* preset) {
    const Display& display = find_display("rec2100_pq");
    return resolve_for_display(resolve(op, preset, {}, ""),
                               {display.primaries, true, display.peak});
}

/// The parameters that an HDR display decides, with its values; null if the operator shows its
/// SDR picture there.
Json hdr_settings(const Operator& op) {
    if (op.is_local() || !op.peak) return nullptr;
    const ResolvedOperator shown = on_hdr_display(op, nullptr);
    if (!(shown.peak() > 1)) return nullptr;
    Json settings = Json::object();
    for (const ParameterSpec& p : op.parameters) {
        if (!p.from_display) continue;
        settings.add(p.name, p.kind == Kind::number ? Json(shown.params.number(p.name))
                                                    : Json(shown.params.choice(p.name)));
    }
    return settings;
}

/// The first preset whose output exceeds white on its own; null: none.
Json hdr_preset(const Operator& op) {
    for (const Preset& preset : op.presets) {
        if (op.peak && resolve(op, &preset, {}, "").peak() > 1) return preset.id;
    }
    return nullptr;
}

}  // namespace

std::string output_of(const Operator& op) {
    const ResolvedOperator usual = resolve(op, nullptr, {}, "");
    if (usual.output() == OutputKind::display_linear) return "display-linear";
    if (const std::string display = usual.output_display(); !display.empty())
        return "code values of " + find_display(display).title;
    return fmt::format("code values, power {}", op.code_power);
}

std::vector<std::string> all_warnings(const Operator& op) {
    std::vector<std::string> all = op.warnings;
    for (const DocumentedDifference& d : op.differences)
        all.push_back(to_string(d));
    return all;
}

const char* level_name(LintFinding::Level level) {
    if (level == LintFinding::Level::error) return "error";
    return level == LintFinding::Level::warning ? "warning" : "note";
}

Json to_json(const Operator& op) {
    Json parameters = Json::array();
    const std::vector<std::string> live = live_parameters(op);
    for (const ParameterSpec& p : op.parameters)
        parameters.push_back(to_json(p, std::find(live.begin(), live.end(), p.name) != live.end()));
    Json deviations = Json::array();
    for (const DocumentedDifference& d : op.differences) {
        deviations.push_back({{"kind", difference_names().at(static_cast<std::size_t>(d.kind))},
                              {"value", d.value},
                              {"when", d.when},
                              {"text", to_string(d)}});
    }
    Json presets = Json::array();
    for (const Preset& p : op.presets)
        presets.push_back({{"id", p.id}, {"title", p.title}, {"settings", p.settings}});
    Json looks = Json::array();
    for (const Look& l : op.looks)
        looks.push_back({{"id", l.id}, {"title", l.title}, {"help", l.help}});
    const Json hdr = hdr_settings(op);
    return {{"id", op.id},
            {"title", op.title},
            {"view", op.view},
            {"character", op.character},
            {"source", op.source},
            {"license", op.license},
            {"working_primaries", op.working.name},
            {"negatives", op.negatives},
            {"output", output_of(op)},
            {"parameters", parameters},
            {"presets", presets},
            {"looks", looks},
            {"warnings", all_warnings(op)},
            {"deviations", deviations},
            {"dialects", op.dialects},
            {"hdr", !std::holds_alternative<std::nullptr_t>(hdr.value())},
            {"hdr_settings", hdr},
            {"hdr_preset", hdr_preset(op)},
            {"is_diagnostic", op.is_diagnostic},
            {"is_local", op.is_local()}};
}

Json to_json(const Display& display) {
    return {{"id", display.id},
            {"title", display.title},
            {"aliases", display.aliases},
            {"source", display.source}};
}

Json to_json(const SourceColorName& name) {
    return {{"id", name.id},
            {"title", name.title},
            {"aliases", name.aliases},
            {"kind", kind_name(name.kind)}};
}

Json catalogue_to_json() {
    Json spaces = Json::array();
    for (const InputSpace& s : all_input_spaces())
        spaces.push_back({{"id", s.id}, {"title", s.title}, {"aliases", s.aliases}});
    return {{"operators", all_to_json(all_operators())},
            {"local_operators", all_to_json(local_operators())},
            {"displays", all_to_json(all_displays())},
            {"spaces", spaces},
            {"inputs", all_to_json(all_source_color_names())}};
}

Json to_json(const LutApplication& host, const MessageStyle& style) {
    return {{"id", host.id},
            {"title", host.title},
            {"format", name_of(host.format)},
            {"size", host.size},
            {"bits", host.bits},
            {"input_encoding", lut_encoding_of(host, host.format)},
            {"input", parse_input_encoding(lut_encoding_of(host, host.format)).default_input},
            {"takes_any_primaries", host.takes_any_primaries},
            {"display", host.display},
            {"interpolation", host.interpolation},
            {"steps", render(lut_steps_of(host, host.format), style)},
            {"chain_steps", host.chain_steps},
            {"tested", host.tested}};
}

Json to_json(const ParityRow& row) {
    return {{"operator", row.op},
            {"display", row.display},
            {"backend", row.backend},
            {"lowering", row.lowering},
            {"max", row.max},
            {"p999", row.p999},
            {"mean", row.mean},
            {"max_all", row.max_all},
            {"max_beyond_rounding", row.max_beyond_rounding},
            {"bound", row.bound},
            {"mixed_metric", row.is_mixed_metric},
            {"ok", row.is_ok},
            {"note", row.note}};
}

Json to_json(const LutMatch& match) {
    return {{"operator", match.op},
            {"defect", match.definition->defect},
            {"meant", match.definition->meant},
            {"input_encoding", match.encoding},
            {"input", match.input},
            {"display", match.display},
            {"max", match.max},
            {"p999", match.p999},
            {"mean", match.mean}};
}

Json to_json(const LintFinding& finding) {
    return {{"level", level_name(finding.level)}, {"where", finding.where}, {"what", finding.what}};
}

Json to_json(const LawResult& result) {
    return {{"law", result.law},
            {"verdict", to_string(result.verdict)},
            {"text", result.text},
            {"x", result.x}};
}

TONEWRIGHT_NAMESPACE_END
