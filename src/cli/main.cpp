// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <cstdio>
#include <exception>
#include <string>
#include <system_error>

#include "base/atomic_file.h"
#include "cli/command.h"
#include "cli/options.h"
#include "tonewright/error.h"
#include "tonewright/version.h"

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

int run(int argc, char** argv) {
    try {
        CommandLine program("tonewright",
                            "Tone mapping operators: one definition, the same picture everywhere.",
                            TONEWRIGHT_VERSION);
        program.footer(
            "Examples:\n"
            "  tonewright list                                       operators, displays, spaces\n"
            "  tonewright apply in.exr out.png --operator agx_sobotka\n"
            "  tonewright config -o ocio_config                      the OpenColorIO config\n"
            "  echo 0.18 0.18 0.18 | tonewright eval hable\n"
            "Exit codes: 0 ok, 1 a check or a frame of --frames failed, 2 wrong usage, 3 a file "
            "could not be read or written.");
        for (const auto add : {add_list, add_eval, add_apply, add_meter, add_bake, add_config,
                               add_verify, add_chart, add_sheet, add_compare, add_plot})
            add(program);
        const int exit_code = program.run(argc, argv);
        if (std::fflush(stdout) != 0) return report("write: standard output: cannot write", kFile);
        return exit_code;
    } catch (const std::system_error& e) {  // what printing throws
        return report("write: standard output: " + e.code().message(), kFile);
    } catch (const FileError& e) {
        return report(e.what(), kFile);
    } catch (const Error& e) {
        return report(e.what(), kUsage);
    } catch (const std::exception& e) {
        return report(e.what(), kCheckFailed);
    }
}

}  // namespace
TONEWRIGHT_NAMESPACE_END

int main(int argc, char** argv) {
    tonewright::remove_unfinished_files_on_signals();
    return tonewright::run(argc, argv);
}
