// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <memory>

#include "base/format_number.h"
#include "base/strings.h"
#include "cli/command.h"
#include "cli/list.h"
#include "cli/messages.h"
#include "cli/options.h"
#include "cli/suggestions.h"
#include "tasks/json.h"
#include "tasks/json_forms.h"
#include "tonewright/definition.h"
#include "tonewright/lut.h"
#include "tonewright/lut_applications.h"
#include "tonewright/registry.h"
#include "tonewright/source_color.h"
#include "tonewright/view.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

using Kind = ParameterSpec::Kind;

using InputKind = SourceColorName::Kind;

/// Groups of names for --input, in the order of the list.
struct InputGroup {
    InputKind kind;
    const char* id;
    const char* title;
};
constexpr std::array<InputGroup, 6> kInputGroups = {{
    {InputKind::linear, "linear", "scene-linear spaces"},
    {InputKind::config, "config", "other spaces of the OpenColorIO config"},
    {InputKind::display, "display", "code values of displays"},
    {InputKind::encoding, "encoding", "encodings of LUTs (bake --input-encoding)"},
    {InputKind::interop, "interop", "other ids of the Color Interop Forum"},
    {InputKind::other, "pattern", "other names"},
}};

Json inputs_to_json() {
    Json inputs = Json::array();
    for (const SourceColorName& name : all_source_color_names()) {
        const auto* group = std::find_if(kInputGroups.begin(), kInputGroups.end(),
                                         [&](const auto& g) { return g.kind == name.kind; });
        inputs.push_back({{"id", name.id},
                          {"title", name.title},
                          {"aliases", name.aliases},
                          {"kind", group->id}});
    }
    return inputs;
}

Json spaces_to_json() {
    Json spaces = Json::array();
    for (const InputSpace& s : all_input_spaces())
        spaces.push_back({{"id", s.id}, {"title", s.title}, {"aliases", s.aliases}});
    return {{"operators", all_to_json(all_operators())},
            {"local_operators", all_to_json(local_operators())},
            {"displays", all_to_json(all_displays())},
            {"spaces", spaces},
            {"inputs", inputs_to_json()}};
}

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
        return p.help + "; `tonewright apply` takes it from the picture: " + p.statistic;
    return p.from_display ? p.help + "; where it is not set, --display decides" : p.help;
}

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

/// "AgX; others: agx_minimal, agx_sobotka".
std::string dialects_of(const Operator& op) {
    std::string ids;
    for (const Operator& other : all_operators()) {
        if (other.dialects == op.dialects && other.id != op.id)
            ids += (ids.empty() ? "" : ", ") + other.id;
    }
    return op.dialects + (ids.empty() ? "" : "; others: " + ids);
}

constexpr const char* kDiagnostic = "shows facts about a picture, such as its exposure";
constexpr const char* kLocal = "pictures only; LUTs and configs cannot contain it";

void print_operator(const Operator& op) {
    fmt::print("{}: {}\n  {}\n", op.id, op.title, op.character);
    fmt::print("  source      {}\n  license     {}\n", op.source, op.license);
    if (op.is_local()) {
        fmt::print("  local       {}\n", kLocal);
    } else {
        fmt::print("  view        {} (in the OpenColorIO config)\n", op.view);
    }
    fmt::print("  works in    {}; negatives: {}\n", op.working.name, op.negatives);
    fmt::print("  output      {}\n", output_of(op));
    if (!op.dialects.empty()) fmt::print("  dialect of  {}\n", dialects_of(op));
    if (op.is_diagnostic) fmt::print("  diagnostic  {}\n", kDiagnostic);
    for (const ParameterSpec& p : op.parameters) {
        fmt::print("  --set {}={}  {}\n      {}\n", p.name, default_of(p), range_of(p), help_of(p));
    }
    if (const std::vector<std::string> live = live_parameters(op); !live.empty()) {
        fmt::print("  live        {} (one expression serves all their values)\n",
                   fmt::join(live, ", "));
    }
    for (const Preset& p : op.presets)
        fmt::print("  preset      {}:{}  {}\n", op.id, p.id, p.title);
    for (const Look& l : op.looks)
        fmt::print("  --look {}  {}\n", l.id, l.help);
    for (const std::string& w : all_warnings(op))
        fmt::print("  note        {}\n", w);
}

/// A name, and a text after it that is wrapped into lines of the same indentation.
void print_entry(const std::string& name, std::size_t name_width,
                 const std::vector<std::string>& words) {
    constexpr std::size_t kLine = 100;
    const std::string indent(name_width + 3, ' ');
    std::string line = fmt::format("  {:<{}}", name, name_width);
    for (const std::string& word : words) {
        if (line.size() + 1 + word.size() > kLine && line.size() > indent.size()) {
            fmt::print("{}\n", line);
            line = indent + " ";
        }
        line += " " + word;
    }
    fmt::print("{}\n", line);
}

void print_overview() {
    std::size_t width = 18;
    for (const Operator& op : all_operators())
        width = std::max(width, op.id.size());
    fmt::print("operators (details: tonewright list OPERATOR)\n");
    for (const Operator& op : all_operators()) {
        std::vector<std::string> words = {op.title};
        for (const Preset& p : op.presets)
            words.push_back(":" + p.id);
        for (const Look& l : op.looks)
            words.push_back("--look " + l.id);
        print_entry(op.id, width, words);
    }
    fmt::print("\nlocal: pictures only (tonewright apply)\n");
    for (const Operator& op : local_operators())
        print_entry(op.id, width, {op.title});
    fmt::print("\ndisplays (--display)\n");
    for (const Display& d : all_displays())
        print_entry(d.id, width, {d.title + ":", d.source});
    print_entry(std::string(kLinearOutput), width, {"display-linear Rec.709, unclamped"});
    print_entry(std::string(kNativeOutput), width, {"the operator's own output, untouched"});
    fmt::print("\nscene-linear input spaces (--input; all names: tonewright list --inputs)\n");
    for (const InputSpace& s : all_input_spaces())
        print_entry(s.id, width, {s.title});
}

/// Each name with its title and its aliases.
void print_inputs() {
    const std::vector<SourceColorName> names = all_source_color_names();
    std::size_t width = 0;
    for (const SourceColorName& name : names)
        width = std::max(width, name.id.size());
    bool is_first = true;
    for (const InputGroup& group : kInputGroups) {
        fmt::print("{}{}\n", is_first ? "" : "\n", group.title);
        is_first = false;
        for (const SourceColorName& name : names) {
            if (name.kind != group.kind) continue;
            std::vector<std::string> words;
            if (name.title != name.id) words.push_back(name.title);
            words.insert(words.end(), name.aliases.begin(), name.aliases.end());
            for (std::size_t i = 0; i + 1 < words.size(); ++i)
                words[i] += ",";
            print_entry(name.id, width, words);
        }
    }
}

}  // namespace

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

namespace {

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

void print_hosts() {
    fmt::print("applications (tonewright bake OPERATOR --for APPLICATION -o FILE)\n");
    for (const LutApplication& host : all_lut_applications()) {
        fmt::print(
            "\n  {}: {}\n      format         {}\n      input          {}\n      output         "
            "{}\n"
            "      interpolation  {}\n      how to load    {}\n      tested         {}\n",
            host.id, host.title, format_of(host), taken_by(host), output_of(host),
            host.interpolation, render(lut_steps_of(host, host.format), command_style()),
            host.tested.empty() ? "the file format, not the application" : host.tested);
        if (!reads_chains(host, host.format) && reads_chains(host, LutFormat::ctf))
            fmt::print("      or clf, ctf    {}\n", host.chain_steps);
    }
}

struct Options {
    std::string op;
    bool json = false;
    bool markdown = false;
    bool views = false;
    bool inputs = false;
    bool hosts = false;
    bool definition = false;
};

int run_list(const Options& options) {
    if (!options.op.empty() && (options.inputs || options.hosts)) {
        throw Error("list: operator is " + options.op + "; expected none with " +
                    (options.inputs ? "--inputs" : "--hosts"));
    }
    const auto print = [](const Json& json) { fmt::print("{}\n", json.dump(2)); };
    if (options.inputs) {
        options.json ? print(inputs_to_json()) : print_inputs();
    } else if (options.hosts) {
        options.json ? print(all_to_json(all_lut_applications(), command_style())) : print_hosts();
    } else if (options.definition) {
        if (options.op.empty())
            throw Error("list: operator is missing; expected one before --definition");
        fmt::print("{}", definition_of(resolve_for_command(options.op)));
    } else if (!options.op.empty()) {
        const ResolvedOperator resolved = resolve_for_command(options.op);
        const Operator& op = *resolved.op;
        if (options.json) {
            print(to_json(op));
        } else if (options.markdown) {
            fmt::print("{}", operator_section(op));
        } else {
            print_operator(op);
        }
    } else if (options.views) {
        for (const Operator& op : all_operators())
            fmt::print("{}\t{}\n", op.id, op.view);
    } else if (options.json) {
        print(spaces_to_json());
    } else if (options.markdown) {
        for (const std::vector<Operator>* operators : {&all_operators(), &local_operators()}) {
            for (const Operator& op : *operators)
                fmt::print("{}", operator_section(op));
        }
    } else {
        print_overview();
    }
    return kOk;
}

}  // namespace

void add_list(CommandLine& program) {
    auto options = std::make_shared<Options>();
    const Command command = program.add(
        "list", "Operators", "List operators with their parameters, displays and color spaces.");
    command.argument("operator", &options->op,
                     "operator to describe in full, a .tone file or a LUT",
                     {.suggest = suggest_operators});
    command.title("Format");
    command.add_flag("--json", &options->json, "print JSON");
    command.add_flag("--markdown", &options->markdown, "print Markdown", {.excludes = {"--json"}});
    command.title("What to list");
    command.add_flag("--views", &options->views,
                     "print each operator's id, a tab, and the name of its view in the config",
                     {.excludes = {"--json", "--markdown"}});
    command.add_flag("--definition", &options->definition,
                     "print the operator as a .tone file, with its settings (agx_blender:hdr)",
                     {.excludes = {"--json", "--markdown", "--views"}});
    command.add_flag("--inputs", &options->inputs,
                     "list the names of --input for pictures: spaces, camera logs, displays, "
                     "encodings",
                     {.excludes = {"--markdown", "--views", "--definition"}});
    command.add_flag("--hosts", &options->hosts,
                     "list applications that read LUTs, the LUT that each expects, and how to load "
                     "it",
                     {.excludes = {"--markdown", "--views", "--definition", "--inputs"}});
    command.footer(
        "Examples:\n  tonewright list\n  tonewright list hable --json\n"
        "  tonewright list hable --definition > my.tone");
    command.action([options] { return run_list(*options); });
}

TONEWRIGHT_NAMESPACE_END
