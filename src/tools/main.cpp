// SPDX-License-Identifier: Apache-2.0
//
// A program that writes files of the project and its packages. It is not installed.
#include <exception>
#include <string>

#include "cli/command.h"
#include "cli/messages.h"
#include "cli/options.h"
#include "tonewright/version.h"
#include "tools/catalogue.h"
#include "tools/manual.h"
#include "tools/npm_package.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

int run(int argc, char** argv) {
    std::string folder;
    ManualSource manual;
    CommandLine program("tonewright_tools", "Write files of the project and its packages.",
                        TONEWRIGHT_VERSION);
    const auto add = [&](const char* name, const char* description) {
        const Command command = program.add(name, "Tools", description);
        command.add("-o", "FOLDER", &folder, "folder to write", {.is_required = true});
        return command;
    };
    add("catalogue", "Write the operator catalogue: operators.md, operators/ and curves/.")
        .action([&] {
            write_catalogue(folder);
            return kOk;
        });
    add("npm", "Write the npm package tonewright-shaders, for `npm pack`.").action([&] {
        write_npm_package(folder);
        return kOk;
    });
    const Command pages = add("manual", "Write the manual pages of the command.");
    pages.add("--reference", "FILE", &manual.reference, "document about .tone files, in Markdown",
              {.is_required = true});
    pages.add("--date", "DATE", &manual.date, "date of all pages: 2026-01-31",
              {.is_required = true});
    pages.action([&] {
        manual.tables = make_command_line()->tables();
        write_manual(manual, folder);
        return kOk;
    });
    try {
        return program.run(argc, argv);
    } catch (const std::exception& e) {
        const Problem problem = command_problem(e);
        print_message(problem.what);
        return problem.kind == Problem::Kind::usage ? kUsage : kFile;
    }
}

}  // namespace
TONEWRIGHT_NAMESPACE_END

int main(int argc, char** argv) { return tonewright::run(argc, argv); }
