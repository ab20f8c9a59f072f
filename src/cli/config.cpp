// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <filesystem>
#include <memory>

#include "base/atomic_file.h"
#include "cli/archive.h"
#include "cli/command.h"
#include "cli/options.h"
#include "tonewright/generated_files.h"
#include "tonewright/ocio.h"

TONEWRIGHT_NAMESPACE_BEGIN

namespace {

struct Options {
    std::string folder;
    std::string into;
    std::string archive;
    ConfigOptions config;
    std::vector<std::string> operators;
    std::vector<std::string> names;
};

/// In place, when everything has been checked; else the config stays as it was.
void extend(const std::string& path, const ConfigOptions& options) {
    namespace fs = std::filesystem;
    const ExtendedConfig extended = extend_config(path, options);
    const fs::path folder = fs::absolute(path).parent_path();
    std::vector<fs::path> written;
    const fs::path trial = folder / (".tonewright-" + fs::path(path).filename().string());
    std::vector<ExtendedView> views;
    try {
        for (const GeneratedFile& file : extended.files) {
            const fs::path table = folder / file.path;
            if (fs::exists(table)) continue;  // its name has the hash of its contents
            fs::create_directories(table.parent_path());
            write_text_atomically(table.string(), file.contents);
            written.push_back(table);
        }
        write_text_atomically(trial.string(), extended.text);
        written.push_back(trial);
        views = extended.check(trial.string());
        fs::rename(trial, path);
    } catch (...) {
        std::error_code ignored;
        for (const fs::path& file : written)
            fs::remove(file, ignored);
        if (!extended.files.empty())  // its folder, where nothing else is in it
            fs::remove((folder / extended.files.front().path).parent_path(), ignored);
        throw;
    }
    fmt::print("{:<28} {:<40} {:>9} {:>9}\n", "display", "view", "max error", "99.9 %");
    for (const ExtendedView& v : views)
        fmt::print("{:<28} {:<40} {:>9.1e} {:>9.1e}\n", v.display, v.view, v.max, v.p999);
}

int run_config(Options& options) {
    ConfigOptions& wanted = options.config;
    if (options.operators.size() != options.names.size()) {
        throw Error(fmt::format("config: {} --operator and {} --name; expected one name for each",
                                options.operators.size(), options.names.size()));
    }
    for (std::size_t i = 0; i < options.operators.size(); ++i)
        wanted.custom.push_back({options.names[i], options.operators[i]});
    if (!options.into.empty()) {
        extend(options.into, wanted);
        return kOk;
    }
    if (options.folder.empty() && options.archive.empty())
        throw Error("config: -o is missing; expected -o, --archive or --into");
    wanted.working = find_input_space(wanted.working).id;
    const std::filesystem::path archive(options.archive);
    if (!options.archive.empty() && archive.extension() != ".ocioz") {
        throw Error("config: archive is " + options.archive +
                    "; expected a name that ends in .ocioz: OpenColorIO knows it by that");
    }
    check_config_options(wanted);
    if (!options.folder.empty()) require_writable_folder(options.folder);
    if (!options.archive.empty())
        require_writable_folder(std::filesystem::absolute(archive).parent_path().string());
    const std::vector<GeneratedFile> files = make_config(wanted);
    if (!options.folder.empty()) write_generated_files(options.folder, files, "config.ocio");
    if (options.archive.empty()) return kOk;
    std::vector<GeneratedFile> packed;
    for (const GeneratedFile& file : files) {
        if (file.path == "config.ocio" || file.path.starts_with("luts/")) packed.push_back(file);
    }
    write_text_atomically(options.archive, make_archive(packed));
    return kOk;
}

}  // namespace

void add_config(CommandLine& program) {
    auto options = std::make_shared<Options>();
    const Command command =
        program.add("config", "an OpenColorIO config of operators, for any application");
    const Option out =
        command.add("-o", options->folder, "folder to write: config.ocio, luts/, probe.csv");
    const Option into = command.add("--into", options->into,
                                    "a config of yours to add to: views, looks and output spaces, "
                                    "with their tables in tonewright/ beside it");
    out.excludes(into);
    command
        .add("--archive", options->archive,
             "file.ocioz to write, with or without -o: a config and its tables in one, for "
             "OpenColorIO 2.2 and newer")
        .excludes(into);
    ConfigOptions& config = options->config;
    command
        .add("--profile", config.profiles,
             "of OpenColorIO: 2.0, 2.1 and 2.5, comma separated; the first is config.ocio "
             "(and --archive's), the others config-2.0.ocio and so on")
        .separated_by(',')
        .show_default("2.1,2.0,2.5")
        .excludes(into);
    command
        .add("--views", config.views,
             "views (\"AgX Punchy\") or operators, comma separated, in order, standard or all; "
             "default: standard, a dozen, without the large HDR forms")
        .separated_by(',');
    command.add("--displays", config.displays, "displays, comma separated; default: all")
        .separated_by(',');
    command
        .add("--looks", config.looks,
             "looks (\"AgX - Punchy\"), comma separated, or none; default: all of the views")
        .separated_by(',');
    command.add("--working", config.working, "space that applications compute in").show_default();
    command
        .add("--operator", options->operators,
             "a view of your own: ID[:PRESET][:PARAMETER=VALUE...]; repeat for more")
        .one_value_each();
    command.add("--name", options->names, "its name, one for each --operator, in their order")
        .one_value_each();
    command
        .add("--exposure-views", config.exposure_stops,
             "every view once more with so many stops more light, comma separated")
        .separated_by(',')
        .range(-16.0, 16.0);
    command.footer(
        "Examples:\n  tonewright config -o ocio_config\n"
        "  tonewright config -o everything --views all\n"
        "  tonewright config -o studio --working acescg --views AgX,aces_20 --displays "
        "srgb,rec1886 "
        "\\\n    --operator reinhard_extended:white=6 --name \"Studio Reinhard\"\n"
        "  tonewright config --archive tonewright.ocioz\n"
        "  tonewright config --into studio.ocio --views AgX,hable\n"
        "  oiiotool --colorconfig ocio_config/config.ocio in.exr --ociodisplay sRGB Hable \\\n"
        "    --iscolorspace sRGB -o out.png");
    command.action([options] { return run_config(*options); });
}

TONEWRIGHT_NAMESPACE_END
