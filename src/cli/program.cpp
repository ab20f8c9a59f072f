// SPDX-License-Identifier: Apache-2.0
#include "cli/program.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdio>
#include <exception>
#include <system_error>

#include "base/strings.h"
#include "cli/command.h"
#include "tonewright/error.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

/// One line on stderr, whatever the library's message looked like.
int report(const std::string& message, int exit_code) {
    std::string line = message;
    while (!line.empty() && (line.back() == '\n' || line.back() == ' '))
        line.pop_back();
    for (char& c : line) {
        if (c == '\n' || c == '\r') c = ' ';
    }
    fmt::print(stderr, "tonewright: {}\n", line);
    return exit_code;
}

}  // namespace

int run_program(int argc, char** argv, const std::vector<AddCommand>& commands) {
    CLI::App program("Tone mapping operators: one definition, the same picture everywhere.",
                     "tonewright");
    program.set_version_flag("--version", TONEWRIGHT_VERSION);
    program.require_subcommand(1);
    program.footer(
        "Examples:\n"
        "  tonewright list                                       operators, displays, spaces\n"
        "  tonewright apply in.exr out.png --operator agx_sobotka\n"
        "  tonewright config -o ocio_config                      the OpenColorIO config\n"
        "  echo 0.18 0.18 0.18 | tonewright eval hable\n"
        "Exit codes: 0 ok, 1 a check or a frame of --frames failed, 2 wrong usage, 3 a file could "
        "not be read or written.");
    int exit_code = kOk;
    for (const AddCommand add : commands)
        add(program, exit_code);
    try {
        // CLI11 would only say that a subcommand is required.
        const std::vector<std::string> flags = {"-h", "--help", "--version"};
        const std::string first = argc > 1 ? argv[1] : flags[0];
        std::vector<std::string> names;
        for (const CLI::App* command : program.get_subcommands([](CLI::App*) { return true; })) {
            names.push_back(command->get_name());
        }
        if (std::find(names.begin(), names.end(), first) == names.end() &&
            std::find(flags.begin(), flags.end(), first) == flags.end()) {
            throw Error("command is " + first + "; expected " + join_choices(names) +
                        did_you_mean(first, names));
        }
        program.parse(argc, argv);
        if (std::fflush(stdout) != 0) return report("write: standard output: cannot write", kFile);
    } catch (const std::system_error& e) {  // what printing throws
        return report("write: standard output: " + e.code().message(), kFile);
    } catch (const CLI::Success& e) {
        return program.exit(e);  // --help, --version
    } catch (const CLI::ParseError& e) {
        return report(e.what(), kUsage);
    } catch (const FileError& e) {
        return report(e.what(), kFile);
    } catch (const Error& e) {
        return report(e.what(), kUsage);
    } catch (const std::exception& e) {
        return report(e.what(), kCheckFailed);
    }
    return exit_code;
}

TONEWRIGHT_NAMESPACE_END
