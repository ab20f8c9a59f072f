// SPDX-License-Identifier: Apache-2.0
#include "tasks/operator_facts.h"

#include <fmt/format.h>

#include <algorithm>

#include "base/format_number.h"
#include "base/strings.h"
#include "tasks/json_forms.h"
#include "tonewright/lut.h"
#include "tonewright/registry.h"
#include "tonewright/view.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

using Kind = ParameterSpec::Kind;

/// The help of a parameter that all tone curves share, as a link to docs/choosing.md; empty for
/// other parameters.
std::string_view link_to_choosing(const Operator& op, std::string_view parameter) {
    const auto has = [&](std::string_view name) {
        return std::any_of(op.parameters.begin(), op.parameters.end(),
                           [&](const ParameterSpec& p) { return p.name == name; });
    };
    if (!has("apply") || !has("color_correction")) return {};
    if (parameter == "apply")
        return "[how the curve treats color](../choosing.md#how-a-curve-treats-color)";
    const bool is_shared = parameter == "color_correction" || parameter == "saturation" ||
                           parameter == "saturation_from";
    return is_shared ? "[color correction](../choosing.md#color-correction)" : "";
}

std::string format_of(const LutApplication& host) {
    if (reads_chains(host, host.format)) return name_of(host.format) + " or ctf";
    std::string text = fmt::format("{} {}", name_of(host.format), host.size);
    if (host.bits) text += fmt::format(", {} bit", *host.bits);
    return text;
}

std::string taken_by(const LutApplication& host) {
    if (reads_chains(host, host.format)) return "scene-linear Rec.709";
    return parse_input_encoding(host.encoding).title +
           (host.takes_any_primaries ? ", of Rec.709 or Rec.2020, by the operator" : "");
}

std::string output_of(const LutApplication& host) {
    return host.display == kLinearOutput ? "display-linear Rec.709"
                                         : find_display(host.display).title;
}

}  // namespace

std::string range_of(const ParameterSpec& p) {
    if (p.kind == Kind::choice) return join_choices(p.choices);
    if (p.kind == Kind::text) return "text";
    return "[" + shortest(p.min) + ", " + shortest(p.max) + "]" +
           (p.unit.empty() ? "" : " " + p.unit);
}

std::string default_of(const ParameterSpec& p) {
    return p.kind == Kind::number ? shortest(p.default_value) : p.default_choice;
}

std::string help_of(const ParameterSpec& p) {
    if (p.from_picture)
        return p.help + "; <<task=apply>> takes it from the picture: " + p.statistic;
    return p.from_display ? p.help + "; where it is not set, <<display>> decides" : p.help;
}

std::string dialects_of(const Operator& op) {
    std::string ids;
    for (const Operator& other : all_operators()) {
        if (other.dialects == op.dialects && other.id != op.id)
            ids += (ids.empty() ? "" : ", ") + other.id;
    }
    return op.dialects + (ids.empty() ? "" : "; others: " + ids);
}

std::string operator_section(const Operator& op, std::string_view after_character, bool is_page) {
    std::string character = op.character;
    if (!character.empty() && character[0] >= 'a' && character[0] <= 'z')
        character[0] = static_cast<char>(character[0] - 'a' + 'A');
    std::string text = fmt::format("{} {} (`{}`)\n\n{}.\n\n{}", is_page ? "#" : "##", op.title,
                                   op.id, character, after_character);
    text += fmt::format("* Source: {} ({})\n* Works in: {}; output: {}\n* Negatives: {}\n",
                        op.source, op.license, op.working.name, output_of(op), op.negatives);
    text += op.is_local() ? fmt::format("* Local: {}\n", kLocal)
                          : fmt::format("* View of the config: `{}`\n", op.view);
    if (!op.dialects.empty()) text += fmt::format("* Dialect of {}\n", dialects_of(op));
    if (op.is_diagnostic) text += fmt::format("* Diagnostic: {}\n", kDiagnostic);
    for (const std::string& w : all_warnings(op))
        text += fmt::format("* Note: {}\n", w);
    if (!op.parameters.empty()) {
        text += "\n| parameter | default | range | |\n|---|---|---|---|\n";
        for (const ParameterSpec& p : op.parameters) {
            const std::string_view link = is_page ? link_to_choosing(op, p.name) : "";
            text += fmt::format("| `{}` | {} | {} | {} |\n", p.name, default_of(p), range_of(p),
                                link.empty() ? help_of(p) : link);
        }
    }
    if (!op.presets.empty() || !op.looks.empty()) text += "\n";
    for (const Preset& p : op.presets)
        text += fmt::format("* Preset `{}:{}`: {}\n", op.id, p.id, p.title);
    for (const Look& l : op.looks)
        text += fmt::format("* Look `{}`: {}\n", l.id, l.help);
    return text + "\n";
}

std::string application_facts(const LutApplication& host, const MessageStyle& style) {
    std::string text = fmt::format(
        "  {}: {}\n      format         {}\n      input          {}\n      output         {}\n"
        "      interpolation  {}\n      how to load    {}\n      tested         {}\n",
        host.id, host.title, format_of(host), taken_by(host), output_of(host), host.interpolation,
        render(lut_steps_of(host, host.format), style),
        host.tested.empty() ? "the file format, not the application" : host.tested);
    if (!reads_chains(host, host.format) && reads_chains(host, LutFormat::ctf))
        text += fmt::format("      or clf, ctf    {}\n", host.chain_steps);
    return text;
}

TONEWRIGHT_NAMESPACE_END
