// SPDX-License-Identifier: Apache-2.0
//
// What people start. OpenImageIO brings some 250 libraries, which take a fifth of a second to load:
// commands that need no pictures run here, without it, and for all others this becomes the whole
// program (main.cpp), which lies beside it, or in ../libexec/tonewright where it is installed.
#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <string>

#include "cli/command.h"
#include "cli/picture_output.h"
#include "cli/program.h"

namespace tonewright {
namespace {

char** arguments = nullptr;

constexpr const char* kWholeProgram = "tonewright-pictures";

[[noreturn]] void become_whole_program() {
    namespace fs = std::filesystem;
    std::error_code error;
    const fs::path self = fs::read_symlink("/proc/self/exe", error);
    if (error) throw FileError("start: /proc/self/exe: " + error.message());
    const fs::path own = self.parent_path();
    std::string why;
    for (const fs::path& folder : {own, own.parent_path() / TONEWRIGHT_LIBEXEC}) {
        const std::string path = (folder / kWholeProgram).string();
        ::execv(path.c_str(), arguments);
        why += fmt::format("{}{}: {}", why.empty() ? "" : "; ", path, std::strerror(errno));
    }
    throw FileError("start: " + why);
}

}  // namespace

void require_lut_picture(const std::string&, int) { become_whole_program(); }
void write_shipped_luts(const std::string&) { become_whole_program(); }
void write_lut_picture(const Lut&, LutFormat, const std::string&, int) { become_whole_program(); }
void write_plot_picture(const CurvePlot&, const std::string&, int) { become_whole_program(); }
Lut load_lut_picture(const std::string&) { become_whole_program(); }

}  // namespace tonewright

int main(int argc, char** argv) {
    using namespace tonewright;  // NOLINT(google-build-using-namespace): this is its program
    arguments = argv;
    constexpr const char* kOwn[] = {"list", "eval", "bake", "config", "plot"};
    const bool is_own =
        argc > 1 && std::any_of(std::begin(kOwn), std::end(kOwn),
                                [&](const char* name) { return std::strcmp(name, argv[1]) == 0; });
    if (is_own)
        return run_program(argc, argv, {add_list, add_eval, add_bake, add_config, add_plot});
    try {
        become_whole_program();
    } catch (const FileError& e) {
        fmt::print(stderr, "tonewright: {}\n", e.what());
        return kFile;
    }
}
