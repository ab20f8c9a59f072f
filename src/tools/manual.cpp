// SPDX-License-Identifier: Apache-2.0
#include "tools/manual.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <filesystem>

#include "base/atomic_file.h"
#include "base/input_file.h"
#include "base/strings.h"
#include "cli/command.h"
#include "tonewright/error.h"
#include "tools/roff.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

struct Variable {
    std::string names;
    std::string text;
    /// The commands that read it; empty: all.
    std::vector<std::string> commands;
};

const std::vector<Variable>& variables() {
    static const std::vector<std::string> with_luts = {
        "apply", "compare", "bake", "shader", "conformance", "config",
        "list",  "eval",    "plot", "check",  "verify",      "report"};
    static const std::vector<std::string> with_fits = {"bake", "shader", "config",
                                                       "eval", "verify", "report"};
    static const std::vector<Variable> all = {
        {"COLUMNS", "Width of the help, from 40 to 120 (default: that of the terminal).", {}},
        {"LC_ALL, LC_CTYPE, LANG",
         "The first one that is set decides between UTF-8 and ASCII characters in plots.",
         {"check", "meter"}},
        {"XDG_CACHE_HOME",
         "Folder for computed fits, in `tonewright` (default: `.cache` in the home folder).",
         with_fits},
        {"HOME", "Home folder. Without it and XDG_CACHE_HOME, the command keeps no fits.",
         with_fits},
        {"SOURCE_DATE_EPOCH",
         "Date of pictures that have none, in seconds since 1970, for reproducible files.",
         {"apply", "compare", "sheet", "chart", "bake"}},
        {"TMPDIR", "Folder for temporary copies of LUT files (default: `/tmp`).", with_luts},
        {"OPENIMAGEIO_THREADS, CUE_THREADS",
         "Threads, if `--threads` states none; the first one that is set counts (default: all "
         "cores).",
         {"apply", "meter"}},
        {"OIIO_LIBRARY_PATH",
         "Folders with OpenImageIO's plugins for more formats, separated by colons.",
         {"apply", "compare", "meter", "sheet", "report", "verify"}},
        {"CC",
         "C compiler, with options, that compiles shaders in C (default: cc, gcc or clang).",
         {"verify"}},
        {"TONEWRIGHT_NODE_MODULES",
         "Folder with the Node.js packages webgpu and naga-wasm, which run WGSL and HLSL.",
         {"verify"}},
    };
    return all;
}

std::string page_name(const std::string& command) {
    return command == "tonewright" ? command : "tonewright-" + command;
}

std::string entry(const std::string& term, const std::string& text) {
    return ".TP\n" + term + "\n" + text + "\n";
}

/// `-o, --output OUT`: names in bold, values in italics.
std::string term_of(std::string_view names) {
    std::string term;
    while (!names.empty()) {
        const std::string_view word = names.substr(0, names.find_first_of(", "));
        const std::size_t next = std::min(names.find_first_not_of(", ", word.size()), names.size());
        const bool is_value =
            std::any_of(word.begin(), word.end(), [](char c) { return c >= 'A' && c <= 'Z'; }) &&
            !word.starts_with('-');
        term += fmt::format("\\f{}{}\\fR{}", is_value ? 'I' : 'B', roff_escape(word),
                            names.substr(word.size(), next - word.size()));
        names.remove_prefix(next);
    }
    return term;
}

/// The footer of a help, in man(7): its paragraphs and its examples.
struct Footer {
    std::string paragraphs;
    std::string examples;
};

Footer footer_of(std::string_view text) {
    Footer footer;
    std::string examples;
    while (!text.empty()) {
        const std::size_t end = text.find('\n');
        const std::string_view line = text.substr(0, end);
        text.remove_prefix(end == std::string_view::npos ? text.size() : end + 1);
        if (line.starts_with("  "))
            examples.append(line.substr(2)).append("\n");
        else if (line != "Examples:" && line != "Example:")  // exit codes have their own section
            footer.paragraphs +=
                ".PP\n" + roff_prose(line.substr(0, line.find(" Exit codes: "))) + "\n";
    }
    if (!examples.empty()) footer.examples = roff_lines(examples);
    return footer;
}

std::string environment_of(const std::string& command) {
    std::string section;
    for (const Variable& variable : variables()) {
        const std::vector<std::string>& commands = variable.commands;
        const bool is_of_all = command == "tonewright";
        if (!is_of_all && !commands.empty() &&
            std::find(commands.begin(), commands.end(), command) == commands.end())
            continue;
        std::string text = variable.text;
        if (is_of_all && !commands.empty())
            text += fmt::format(" Commands: {}.", fmt::join(commands, ", "));
        section += entry("\\fB" + variable.names + "\\fR", roff_prose(text));
    }
    return section;
}

std::string exit_status() {
    std::string section;
    for (const ExitMeaning& exit : kExitMeanings)
        section += entry(fmt::format("\\fB{}\\fR", int{exit.code}), exit.text);
    return section;
}

std::string files() {
    return entry("\\fI\\(ti/.cache/tonewright\\fR",
                 "Computed fits. The next command that needs a deleted one computes it again.") +
           entry(
               "\\fIPREFIX/share/tonewright/ocio_config\\fR, "
               "\\fIPREFIX/share/tonewright/luts\\fR",
               "OpenColorIO configs and LUTs, where PREFIX is that of the installation.") +
           entry("\\fIPREFIX/share/doc/tonewright\\fR", "Documents, in Markdown.");
}

/// For all pages of commands: the commands of the same group, and the general pages.
std::string see_also(const HelpPage& program, const std::string& command) {
    std::vector<std::string> others;
    for (const HelpGroup& group : program.groups) {
        std::vector<std::string> names;
        for (const HelpEntry& other : group.entries)
            names.push_back(other.names);
        const bool is_sibling = std::find(names.begin(), names.end(), command) != names.end();
        if (!is_sibling && command != "tonewright") continue;
        for (const std::string& name : names) {
            if (name != command && !name.starts_with('-'))
                others.push_back("\\fB" + roff_escape(page_name(name)) + "\\fR(1)");
        }
    }
    if (command != "tonewright") others.insert(others.begin(), "\\fBtonewright\\fR(1)");
    others.emplace_back("\\fBtonewright\\-tone\\fR(5)");
    return fmt::format("{}\n", fmt::join(others, ",\n"));
}

std::string header(const std::string& name, int section, const std::string& date,
                   const std::string& summary) {
    return fmt::format(
        ".\\\" Generated by the build of Tonewright.\n"
        ".TH {} {} {} \"Tonewright {}\" \"Tonewright\"\n"
        // No hyphens in names that a reader copies, and no wide gaps in lists of them.
        ".nh\n.ad l\n"
        ".SH NAME\n{} \\- {}\n",
        roff_escape(name), section, date, TONEWRIGHT_VERSION, roff_escape(name), summary);
}

/// A sentence as a summary: `Plot curves.` is `plot curves`.
std::string summary_of(std::string sentence) {
    sentence[0] = lowercase(sentence.substr(0, 1))[0];
    if (sentence.ends_with('.')) sentence.pop_back();
    return roff_escape(sentence);
}

std::string page_of(const CommandTable& table, const ManualSource& source) {
    const HelpPage& help = table.page;
    const bool is_program = table.name == "tonewright";
    const Footer footer = footer_of(help.footer);
    std::string page = header(page_name(table.name), 1, source.date, summary_of(help.description));
    page += ".SH SYNOPSIS\n" + term_of(help.usage) + "\n";
    page += ".SH DESCRIPTION\n" + roff_prose(help.description) + "\n" + footer.paragraphs;
    page += is_program ? ".SH COMMANDS AND OPTIONS\n" : ".SH OPTIONS\n";
    for (const HelpGroup& group : help.groups) {
        page += ".SS " + roff_escape(group.title) + "\n";
        for (const HelpEntry& row : group.entries) {
            const bool is_command = is_program && !row.names.starts_with('-');
            page += entry(is_command ? "\\fB" + roff_escape(page_name(row.names)) + "\\fR(1)"
                                     : term_of(row.names),
                          roff_prose(row.text));
        }
    }
    page += ".SH EXIT STATUS\n" + exit_status();
    page += ".SH ENVIRONMENT\n" + environment_of(table.name);
    if (is_program) page += ".SH FILES\n" + files();
    if (!footer.examples.empty()) page += ".SH EXAMPLES\n" + footer.examples;
    return page + ".SH SEE ALSO\n" + see_also(source.tables.front().page, table.name);
}

std::string page_of_tone_files(const ManualSource& source) {
    constexpr std::size_t longest = 1 << 20;
    const std::string document = read_file(source.reference, longest, [&](const Problem& why) {
        throw FileError(within("read: " + source.reference, why));
    });
    return header("tonewright-tone", 5, source.date, "files that define tone mapping operators") +
           ".SH DESCRIPTION\n"
           "A .tone file defines an operator. The commands of \\fBtonewright\\fR(1) take its name "
           "wherever they take an operator.\n" +
           roff_of_markdown(document, "| `tonewright` |") +
           ".SH SEE ALSO\n"
           "\\fBtonewright\\fR(1),\n\\fBtonewright\\-check\\fR(1),\n"
           "\\fBtonewright\\-import\\fR(1),\n\\fBtonewright\\-list\\fR(1)\n";
}

/// A paragraph begins below a heading anyway; mandoc warns of a second beginning.
std::string without_empty_paragraphs(const std::string& page) {
    std::string result;
    bool is_below_heading = false;
    for (std::size_t begin = 0; begin < page.size();) {
        const std::size_t end = page.find('\n', begin) + 1;
        const std::string line = page.substr(begin, end - begin);
        if (!is_below_heading || line != ".PP\n") result += line;
        is_below_heading = line.starts_with(".SH ") || line.starts_with(".SS ");
        begin = end;
    }
    return result;
}

}  // namespace

void write_manual(const ManualSource& source, const std::string& folder) {
    const std::filesystem::path root = folder;
    std::filesystem::create_directories(root / "man1");
    std::filesystem::create_directories(root / "man5");
    for (const CommandTable& table : source.tables) {
        write_text_atomically((root / "man1" / (page_name(table.name) + ".1")).string(),
                              without_empty_paragraphs(page_of(table, source)));
    }
    write_text_atomically((root / "man5" / "tonewright-tone.5").string(),
                          without_empty_paragraphs(page_of_tone_files(source)));
}

TONEWRIGHT_NAMESPACE_END
