// SPDX-License-Identifier: Apache-2.0
#include "cli/command.h"
#include "cli/messages.h"
#include "cli/options.h"
#include "tonewright/engines.h"
#include "tonewright/lut.h"
#include "tonewright/lut_file.h"
#include "tonewright/ocio.h"
#include "tonewright/registry.h"

#include <cstdlib>
#include <filesystem>
#include <utility>

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

std::string exit_codes() {
    std::string codes;
    for (const ExitMeaning& exit : kExitMeanings) {
        if (!codes.empty()) codes += ", ";
        codes += std::to_string(exit.code) + " " + exit.text;
    }
    return codes;
}

/// For people, each note once.
void say_note_on_name(const std::string& text) {
    static std::set<std::string> said;
    const std::string note = note_on_name(text);
    if (!note.empty() && says_what_was_done() && said.insert(note).second) print_message(note);
}

}  // namespace

void warn_of(const ResolvedOperator& op) {
    static std::set<std::string> said;
    const std::string text = op.caution();
    if (!text.empty() && said.insert(text).second) warn(text);
}

void tell_of_operator(const std::string& text, const ResolvedOperator& op) {
    say_note_on_name(text);
    warn_of(op);
}

std::string user_cache_folder() {
    namespace fs = std::filesystem;
    const auto from = [](const char* variable) -> fs::path {
        const char* value = std::getenv(variable);
        return value ? fs::path(value) : fs::path();
    };
    // By the XDG Base Directory Specification, a relative path is ignored.
    if (const fs::path folder = from("XDG_CACHE_HOME"); folder.is_absolute())
        return (folder / "tonewright").string();
    if (const fs::path home = from("HOME"); home.is_absolute())
        return (home / ".cache" / "tonewright").string();
    return "";
}

std::unique_ptr<CommandLine> make_command_line() {
    auto program = std::make_unique<CommandLine>(
        "tonewright",
        "Tone map pictures, and write operators as LUTs, shaders and OpenColorIO configs.",
        TONEWRIGHT_VERSION);
    program->footer(
        "Examples:\n"
        "  tonewright apply in.exr out.png --operator agx_blender\n"
        "  tonewright compare in.exr -o sheet.png\n"
        "  tonewright bake agx_blender --for resolve -o agx.cube\n"
        "  tonewright config -o ocio_config\n"
        "`tonewright COMMAND --help` explains a command. Exit codes: " +
        exit_codes() + ".");
    for (const auto add : {add_apply, add_compare, add_info, add_meter, add_sheet, add_chart,
                           add_bake, add_shader, add_conformance, add_config, add_list, add_import,
                           add_eval, add_plot, add_check, add_verify, add_report})
        add(*program);
    return program;
}

Settings ViewOptions::settings() const {
    Settings result;
    for (const std::string& text : set) {
        const std::size_t equals = text.find('=');
        if (equals == std::string::npos || equals == 0) {
            throw Error("--set is " + text + "; expected name=value");
        }
        const std::string value = text.substr(equals + 1);
        const auto [known, is_new] = result.emplace(text.substr(0, equals), value);
        if (!is_new && known->second != value) {
            throw Error("--set: " + known->first + " is " + known->second + " and " + value +
                        "; expected it once");
        }
    }
    return result;
}

ResolvedOperator ViewOptions::resolved() const {
    ResolvedOperator result = resolve_operator(op, settings(), look, operator_files());
    tell_of_operator(op, result);
    return result;
}

View ViewOptions::view() const { return view(resolved()); }

View ViewOptions::view(ResolvedOperator resolved) const {
    const InputSpace& space = find_input_space(input);
    return make_view(std::move(resolved),
                     in_units({space.id, space.primaries}, parse_input_units(input_units)),
                     exposure, display, reference_white);
}

View ViewOptions::view(const SourceColor& color) const {
    return make_view(resolved(), color, exposure, display, reference_white);
}

std::function<Lut(const std::string&)>& lut_picture_reader() {
    static std::function<Lut(const std::string&)> reader;
    return reader;
}

const OperatorSet& operator_files() {
    static const OperatorSet files(table_reader([](const std::string& path) {
                                       if (is_lut_picture(path))
                                           return table_file_of(lut_picture_reader()(path), path);
                                       static const TableReader others = ocio_table_reader();
                                       silence_opencolorio();
                                       return others(path);
                                   }),
                                   OperatorSet::Formulas::yes);
    return files;
}

void print_opencolorio_messages() {
    redirect_opencolorio_messages([](const std::string& text) {
        if (!message_options().is_quiet) print_message("OpenColorIO: " + text);
    });
}

ResolvedOperator resolve_for_command(const std::string& text, const Settings& settings,
                                     const std::string& look) {
    ResolvedOperator resolved = resolve_picture_operator(text, settings, look, operator_files());
    tell_of_operator(text, resolved);
    return resolved;
}

TONEWRIGHT_NAMESPACE_END
