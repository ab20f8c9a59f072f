// SPDX-License-Identifier: Apache-2.0
#include <cstdio>
#include <exception>
#include <new>
#include <string>
#include <string_view>
#include <system_error>

#include "base/atomic_file.h"
#include "base/strings.h"
#include "cli/command.h"
#include "cli/completion.h"
#include "cli/manual.h"
#include "cli/messages.h"
#include "cli/options.h"
#include "tonewright/definition.h"
#include "tonewright/error.h"
#include "tonewright/version.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

int report(const std::string& message, int exit_code) {
    print_message(message);
    return exit_code;
}

std::string exit_codes() {
    std::string codes;
    for (const ExitMeaning& exit : kExitMeanings) {
        if (!codes.empty()) codes += ", ";
        codes += std::to_string(exit.code) + " " + exit.text;
    }
    return codes;
}

int run(int argc, char** argv) {
    const std::string command = argc > 1 ? one_line(argv[1]) + ": " : "";
    try {
        CommandLine program(
            "tonewright",
            "Tone map pictures, and write operators as LUTs, shaders and OpenColorIO configs.",
            TONEWRIGHT_VERSION);
        program.footer(
            "Examples:\n"
            "  tonewright apply in.exr out.png --operator agx_blender\n"
            "  tonewright compare in.exr -o sheet.png\n"
            "  tonewright bake agx_blender --for resolve -o agx.cube\n"
            "  tonewright config -o ocio_config\n"
            "`tonewright COMMAND --help` explains a command. Exit codes: " +
            exit_codes() + ".");
        for (const auto add : {add_apply, add_compare, add_meter, add_sheet, add_chart, add_bake,
                               add_shader, add_config, add_list, add_import, add_eval, add_plot,
                               add_check, add_verify, add_report})
            add(program);
        int exit_code = kOk;
        if (argc > 1 && std::string_view(argv[1]) == "complete") {  // for the scripts of shells
            const std::string text = to_text(complete(program.tables(), {argv + 2, argv + argc}));
            std::fputs(text.c_str(), stdout);
        } else if (argc == 5 && std::string_view(argv[1]) == "manual") {  // for the build
            write_manual({program.tables(), argv[3], argv[4]}, argv[2]);
        } else {
            exit_code = program.run(argc, argv);
        }
        if (std::fflush(stdout) != 0) return report("write: standard output: cannot write", kFile);
        return exit_code;
    } catch (const std::system_error& e) {  // what printing throws, and a thread that has no stack
        if (e.code() == std::errc::resource_unavailable_try_again)
            return report(command + "not enough memory or threads", kFile);
        return report("write: standard output: " + e.code().message(), kFile);
    } catch (const std::bad_alloc&) {
        return report(command + "not enough memory", kFile);
    } catch (const DefinitionError& e) {
        report(e.what(), kFile);
        print_excerpt(e.excerpt());
        return kFile;
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
