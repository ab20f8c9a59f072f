// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "cli/command.h"

namespace tonewright {
namespace {

using Json = nlohmann::ordered_json;

std::string output_of(const Operator& op) {
    if (op.output == OutputKind::display_linear) return "display-linear";
    return fmt::format("code values, power {}", op.code_power);
}

Json to_json(const Operator& op) {
    Json parameters = Json::array();
    for (const ParameterSpec& p : op.parameters) {
        Json j = {{"name", p.name}, {"unit", p.unit}};
        if (p.choices.empty()) {
            j["default"] = p.default_value;
            j["min"] = p.min;
            j["max"] = p.max;
        } else {
            j["default"] = p.default_choice;
        }
        j["choices"] = p.choices;
        j["help"] = p.help;
        parameters.push_back(j);
    }
    Json presets = Json::array();
    for (const Preset& p : op.presets)
        presets.push_back({{"id", p.id}, {"title", p.title}, {"settings", p.settings}});
    Json looks = Json::array();
    for (const Look& l : op.looks)
        looks.push_back({{"id", l.id}, {"title", l.title}, {"help", l.help}});
    return {{"id", op.id},
            {"title", op.title},
            {"view", op.view},
            {"character", op.character},
            {"source", op.source},
            {"licence", op.licence},
            {"working_primaries", op.working.name},
            {"negatives", op.negatives},
            {"output", output_of(op)},
            {"parameters", parameters},
            {"presets", presets},
            {"looks", looks},
            {"warnings", op.warnings}};
}

Json spaces_to_json() {
    Json all;
    for (const Operator& op : all_operators())
        all["operators"].push_back(to_json(op));
    for (const Display& d : all_displays()) {
        all["displays"].push_back(
            {{"id", d.id}, {"title", d.title}, {"aliases", d.aliases}, {"source", d.source}});
    }
    for (const InputSpace& s : all_input_spaces()) {
        all["spaces"].push_back({{"id", s.id}, {"title", s.title}, {"aliases", s.aliases}});
    }
    return all;
}

std::string range_of(const ParameterSpec& p) {
    if (!p.choices.empty()) return join_choices(p.choices);
    return "[" + shortest(p.min) + ", " + shortest(p.max) + "]" +
           (p.unit.empty() ? "" : " " + p.unit);
}

std::string default_of(const ParameterSpec& p) {
    return p.choices.empty() ? shortest(p.default_value) : p.default_choice;
}

void print_operator(const Operator& op) {
    fmt::print("{}: {}\n  {}\n", op.id, op.title, op.character);
    fmt::print("  source      {}\n  licence     {}\n", op.source, op.licence);
    fmt::print("  view        {} (in the OpenColorIO config)\n", op.view);
    fmt::print("  works in    {}; negatives: {}\n", op.working.name, op.negatives);
    fmt::print("  output      {}\n", output_of(op));
    for (const ParameterSpec& p : op.parameters) {
        fmt::print("  --set {}={}  {}\n      {}\n", p.name, default_of(p), range_of(p), p.help);
    }
    for (const Preset& p : op.presets)
        fmt::print("  preset      {}:{}  {}\n", op.id, p.id, p.title);
    for (const Look& l : op.looks)
        fmt::print("  --look {}  {}\n", l.id, l.help);
    for (const std::string& w : op.warnings)
        fmt::print("  note        {}\n", w);
}

void print_markdown(const Operator& op) {
    fmt::print("## {} (`{}`)\n\n{}.\n\n", op.title, op.id, op.character);
    fmt::print("* Source: {} ({})\n* Output: {}\n* Negatives: {}\n* View of the config: `{}`\n",
               op.source, op.licence, output_of(op), op.negatives, op.view);
    for (const std::string& w : op.warnings)
        fmt::print("* Note: {}\n", w);
    if (!op.parameters.empty()) {
        fmt::print("\n| parameter | default | range | |\n|---|---|---|---|\n");
        for (const ParameterSpec& p : op.parameters) {
            fmt::print("| `{}` | {} | {} | {} |\n", p.name, default_of(p), range_of(p), p.help);
        }
    }
    if (!op.presets.empty() || !op.looks.empty()) fmt::print("\n");
    for (const Preset& p : op.presets)
        fmt::print("* Preset `{}:{}`: {}\n", op.id, p.id, p.title);
    for (const Look& l : op.looks)
        fmt::print("* Look `{}`: {}\n", l.id, l.help);
    fmt::print("\n");
}

void print_overview() {
    fmt::print("operators (tonewright list OPERATOR tells more)\n");
    for (const Operator& op : all_operators()) {
        std::string more;
        for (const Preset& p : op.presets)
            more += " :" + p.id;
        for (const Look& l : op.looks)
            more += " --look " + l.id;
        fmt::print("  {:<18} {}{}\n", op.id, op.title,
                   more.empty() ? "" : "  (" + more.substr(1) + ")");
    }
    fmt::print("\ndisplays (--display)\n");
    for (const Display& d : all_displays())
        fmt::print("  {:<18} {}: {}\n", d.id, d.title, d.source);
    fmt::print("  {:<18} {}\n  {:<18} {}\n", kLinearOutput, "display-linear Rec.709, unclamped",
               kNativeOutput, "the operator's own output, untouched");
    fmt::print("\nscene-linear input spaces (--input)\n");
    for (const InputSpace& s : all_input_spaces())
        fmt::print("  {:<18} {}\n", s.id, s.title);
}

}  // namespace

void add_list(CLI::App& program, int&) {
    struct Options {
        std::string op;
        bool json = false;
        bool markdown = false;
        bool views = false;
    };
    auto options = std::make_shared<Options>();
    CLI::App* command = program.add_subcommand(
        "list", "operators with their parameters and looks; displays; spaces");
    command->add_option("operator", options->op, "one operator in full");
    CLI::Option* json = command->add_flag("--json", options->json, "for programs");
    CLI::Option* markdown =
        command->add_flag("--markdown", options->markdown, "for documents")->excludes(json);
    command
        ->add_flag("--views", options->views,
                   "each operator's id and its view in the config, with a tab between: for scripts")
        ->excludes(json)
        ->excludes(markdown);
    command->footer("Example:\n  tonewright list hable --json");
    command->callback([options] {
        if (!options->op.empty()) {
            const Operator& op = find_operator(options->op);
            if (options->json) {
                fmt::print("{}\n", to_json(op).dump(2));
            } else if (options->markdown) {
                print_markdown(op);
            } else {
                print_operator(op);
            }
        } else if (options->views) {
            for (const Operator& op : all_operators())
                fmt::print("{}\t{}\n", op.id, op.view);
        } else if (options->json) {
            fmt::print("{}\n", spaces_to_json().dump(2));
        } else if (options->markdown) {
            for (const Operator& op : all_operators())
                print_markdown(op);
        } else {
            print_overview();
        }
    });
}

}  // namespace tonewright
