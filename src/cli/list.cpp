// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <memory>
#include <utility>

#include "cli/command.h"
#include "cli/messages.h"
#include "cli/options.h"
#include "cli/suggestions.h"
#include "tasks/engines.h"
#include "tasks/json.h"
#include "tasks/json_forms.h"
#include "tasks/operator_facts.h"
#include "tonewright/definition.h"
#include "tonewright/engines.h"
#include "tonewright/lut_applications.h"
#include "tonewright/registry.h"
#include "tonewright/source_color.h"
#include "tonewright/view.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

using InputKind = SourceColorName::Kind;

/// Titles of the groups of names for --input, in the order of the list.
constexpr std::array<std::pair<InputKind, const char*>, 6> kInputGroups = {{
    {InputKind::linear, "scene-linear spaces"},
    {InputKind::config, "other spaces of the OpenColorIO config"},
    {InputKind::display, "code values of displays"},
    {InputKind::encoding, "encodings of LUTs (bake --input-encoding)"},
    {InputKind::interop, "other ids of the Color Interop Forum"},
    {InputKind::other, "other names"},
}};

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
        fmt::print("  --set {}={}  {}\n      {}\n", p.name, default_of(p), range_of(p),
                   render(help_of(p), command_style()));
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
    for (const auto& [kind, title] : kInputGroups) {
        fmt::print("{}{}\n", is_first ? "" : "\n", title);
        is_first = false;
        for (const SourceColorName& name : names) {
            if (name.kind != kind) continue;
            std::vector<std::string> words;
            if (name.title != name.id) words.push_back(name.title);
            words.insert(words.end(), name.aliases.begin(), name.aliases.end());
            for (std::size_t i = 0; i + 1 < words.size(); ++i)
                words[i] += ",";
            print_entry(name.id, width, words);
        }
    }
}

void print_hosts() {
    fmt::print("applications (tonewright bake OPERATOR --for APPLICATION -o FILE)\n");
    for (const LutApplication& host : all_lut_applications())
        fmt::print("\n{}", application_facts(host, command_style()));
}

struct Options {
    std::string op;
    bool json = false;
    bool markdown = false;
    bool views = false;
    bool inputs = false;
    bool hosts = false;
    bool engines = false;
    bool definition = false;
};

int run_list(const Options& options) {
    if (!options.op.empty() && (options.inputs || options.hosts || options.engines)) {
        const char* const list = options.engines  ? "--engines"
                                 : options.inputs ? "--inputs"
                                                  : "--hosts";
        throw Error("list: operator is " + options.op + "; expected none with " + list);
    }
    const auto print = [](const Json& json) { fmt::print("{}\n", json.dump(2)); };
    if (options.inputs) {
        options.json ? print(all_to_json(all_source_color_names())) : print_inputs();
    } else if (options.hosts) {
        options.json ? print(all_to_json(all_lut_applications(), command_style())) : print_hosts();
    } else if (options.engines) {
        options.json
            ? print(all_to_json(engine_tone_mappers()))
            : fmt::print("{}", options.markdown ? engines_as_markdown() : engines_as_text());
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
            fmt::print("{}", render(operator_section(op), command_style()));
        } else {
            print_operator(op);
        }
    } else if (options.views) {
        for (const Operator& op : all_operators())
            fmt::print("{}\t{}\n", op.id, op.view);
    } else if (options.json) {
        print(catalogue_to_json());
    } else if (options.markdown) {
        for (const std::vector<Operator>* operators : {&all_operators(), &local_operators()}) {
            for (const Operator& op : *operators)
                fmt::print("{}", render(operator_section(op), command_style()));
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
    command.add_flag(
        "--inputs", &options->inputs,
        "list the names of --input for pictures: spaces, camera logs, displays, encodings",
        {.excludes = {"--markdown", "--views", "--definition"}});
    command.add_flag(
        "--hosts", &options->hosts,
        "list applications that read LUTs, the LUT that each expects, and how to load it",
        {.excludes = {"--markdown", "--views", "--definition", "--inputs"}});
    command.add_flag("--engines", &options->engines,
                     "list tone mappers of other programs, and the operators that equal them",
                     {.excludes = {"--views", "--definition", "--inputs", "--hosts"}});
    command.footer(
        "Examples:\n  tonewright list\n  tonewright list hable --json\n"
        "  tonewright list hable --definition > my.tone");
    command.action([options] { return run_list(*options); });
}

TONEWRIGHT_NAMESPACE_END
