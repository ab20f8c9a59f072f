// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <memory>

#include "base/atomic_file.h"
#include "base/input_file.h"
#include "base/system_files.h"
#include "cli/archive.h"
#include "cli/command.h"
#include "cli/elapsed_line.h"
#include "cli/messages.h"
#include "cli/options.h"
#include "cli/suggestions.h"
#include "tonewright/error.h"
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
    bool is_updated = false;
    bool is_removed = false;
    bool has_backup = false;
};

/// "studio.ocio.bak", or with the first number that is free.
void write_backup(const std::string& path) {
    namespace fs = std::filesystem;
    std::string backup = path + ".bak";
    for (int number = 2; fs::exists(backup); ++number)
        backup = fmt::format("{}.bak{}", path, number);
    remove_leftovers({backup});
    const std::string text = read_file(path, std::string::npos, [&](const Problem& why) {
        throw FileError(within("read: " + path, why));
    });
    AtomicFile copy(backup, path);
    int error = copy.write(text);
    if (error == 0) error = copy.keep();
    if (error != 0) throw FileError(within("write: " + backup, problem_of_system(error)));
    fmt::print("backup: {}\n", backup);
}

/// "1 view", "2 views".
std::string counted(std::size_t count, std::string_view noun) {
    return fmt::format("{} {}{}", count, noun, count == 1 ? "" : "s");
}

/// True if the file has these contents already.
bool is_written(const std::filesystem::path& path, const std::string& contents) {
    std::error_code error;
    if (!std::filesystem::is_regular_file(path, error) ||
        std::filesystem::file_size(path, error) != contents.size())
        return false;
    std::ifstream file(path, std::ios::binary);
    return std::string(std::istreambuf_iterator<char>(file), {}) == contents;
}

/// Links to the folder of the tables, relative, so that both folders can be moved together.
void link_folders(const std::filesystem::path& tables, const ExtendedConfig& changed,
                  std::vector<std::filesystem::path>& written) {
    namespace fs = std::filesystem;
    for (const std::string& link : changed.missing_links) {
        std::error_code error;
        const fs::path target = fs::relative(tables, fs::path(link).parent_path(), error);
        if (!error) fs::create_directory_symlink(target, link, error);
        if (error) {
            throw FileError(fmt::format("write: {}: {}; expected a link to {}", link,
                                        error.message(), tables.string()));
        }
        written.emplace_back(link);
        fmt::print("linked {} to {}\n", link, target.string());
    }
}

/// Replaces the config after all checks; until then the old one stays. A run that is killed between
/// config and record leaves the new record as NAME.new, which the next run finds.
void replace_config(const ExtendedConfig& changed, const Options& options) {
    namespace fs = std::filesystem;
    const std::string& path = changed.path;
    const fs::path folder = fs::absolute(path).parent_path();
    std::vector<fs::path> written;
    const fs::path record = folder / changed.record.path;
    const fs::path new_record = record.string() + ".new";
    // Files that an earlier release wrote beside a link are where the link to the folder belongs.
    const bool is_moved = std::any_of(changed.unused_files.begin(), changed.unused_files.end(),
                                      [](const fs::path& file) { return file.is_absolute(); });
    std::vector<ExtendedView> views;
    try {
        require_writable_folder(record.parent_path().string());
        for (const GeneratedFile& file : changed.files) {
            const fs::path table = folder / file.path;
            // Its name has the hash of its contents, unless it was damaged since.
            if (is_written(table, file.contents)) continue;
            std::error_code ignored;
            if (!fs::exists(table, ignored)) written.push_back(table);
            write_text_atomically(table.string(), file.contents);
        }
        {
            // Beside the config, so that its relative paths work; never kept.
            const std::string name = (folder / ".tonewright.ocio").string();
            remove_leftovers({name});
            AtomicFile trial(name, path);  // as private as the config
            if (const int error = trial.write(changed.text))
                throw FileError(within("write: " + path, problem_of_system(error)));
            views = changed.check(trial.path().string());
        }
        if (!is_moved) link_folders(record.parent_path(), changed, written);
        if (options.has_backup) write_backup(path);
        written.push_back(new_record);
        write_text_atomically(new_record.string(), changed.record.contents);
        write_text_atomically(path, changed.text);
        written.clear();
        std::error_code error, ignored;
        if (!options.is_removed) {
            fs::rename(new_record, record, error);
        } else if (fs::remove(record, error); !error) {
            fs::remove(new_record, error);
        }
        if (error) throw FileError("write: " + record.string() + ": " + error.message());
        for (const std::string& file : changed.unused_files) {
            fs::remove(folder / file, ignored);
            if (is_moved) fs::remove((folder / file).parent_path(), ignored);  // if it is empty
        }
        fs::remove(record.parent_path(), ignored);  // if it is empty
        if (is_moved) link_folders(record.parent_path(), changed, written);
        for (const std::string& link : changed.folder_links) {
            if (!fs::exists(record.parent_path(), ignored)) fs::remove(link, ignored);
        }
    } catch (...) {
        std::error_code ignored;
        for (const fs::path& file : written)
            fs::remove(file, ignored);
        fs::remove(record.parent_path(), ignored);
        throw;
    }
    if (path != options.into) fmt::print("edited {}, to which {} links\n", path, options.into);
    for (const auto& [kind, names] : changed.added) {
        if (!names.empty())
            fmt::print("added {}: {}\n", counted(names.size(), kind), fmt::join(names, ", "));
    }
    const auto tables = std::count_if(
        changed.unused_files.begin(), changed.unused_files.end(),
        [](const fs::path& file) { return file.string().find(".yaml") == std::string::npos; });
    if (tables > 0) {
        fmt::print("removed {} from {}/\n", counted(static_cast<std::size_t>(tables), "table"),
                   record.parent_path().filename().string());
    }
    if (views.empty()) return;
    fmt::print("\n{:<28} {:<40} {:>9} {:>9}\n", "display", "view", "max error", "99.9 %");
    for (const ExtendedView& v : views)
        fmt::print("{:<28} {:<40} {:>9.1e} {:>9.1e}\n", v.display, v.view, v.max, v.p999);
}

int run_config(Options& options) {
    ConfigOptions& wanted = options.config;
    if (options.operators.size() != options.names.size()) {
        throw Error(
            fmt::format("config: number of --name options is {}; expected {}, one for each "
                        "--operator",
                        options.names.size(), options.operators.size()));
    }
    for (std::size_t i = 0; i < options.operators.size(); ++i)
        wanted.custom.push_back(
            {options.names[i], resolve_operator(options.operators[i], {}, {}, operator_files())});
    wanted.others = operator_files();
    wanted.cache_folder = user_cache_folder();
    redirect_opencolorio_messages([](const std::string& text) {
        if (!message_options().is_quiet) print_message("OpenColorIO: " + text);
    });
    if (!options.into.empty()) {
        const ExtendedConfig changed = [&] {
            const ElapsedLine line("config");
            return options.is_removed ? reduce_config(options.into)
                                      : extend_config(options.into, wanted, options.is_updated);
        }();
        std::error_code ignored;
        const auto names = std::filesystem::hard_link_count(changed.path, ignored);
        if (!ignored && names > 1) {
            warn(fmt::format("{} has {} hard links: only this name gets the new contents",
                             changed.path, names));
        }
        for (const std::string& text : changed.warnings)
            warn(text);
        if (!changed.unchecked.empty()) warn(changed.unchecked);
        replace_config(changed, options);
        return kOk;
    }
    if (options.folder.empty() && options.archive.empty())
        throw Error("config: -o is missing; expected -o FOLDER, --archive FILE or --into CONFIG");
    wanted.working = find_input_space(wanted.working).id;
    const ConfigPlan plan(wanted);
    for (const std::string& text : plan.warnings())
        warn(text);
    const std::filesystem::path archive(options.archive);
    if (!options.archive.empty() && archive.extension() != ".ocioz") {
        throw Error("config: --archive is " + options.archive +
                    "; expected a name that ends in .ocioz");
    }
    if (!options.folder.empty()) require_writable_folder(options.folder);
    if (!options.archive.empty())
        require_writable_folder(std::filesystem::absolute(archive).parent_path().string());
    const ResultLine result;
    const std::vector<GeneratedFile> files = [&] {
        const ElapsedLine line("config");
        return make_config(plan);
    }();
    const auto tell = [&](const std::string& path, const std::vector<GeneratedFile>& written) {
        double bytes = 0;
        for (const GeneratedFile& file : written)
            bytes += static_cast<double>(file.contents.size());
        result.print(
            fmt::format("config: {}: {} files, {:.1f} MB", path, written.size(), bytes / 1e6));
    };
    if (!options.folder.empty()) {
        write_generated_files(options.folder, files, "config.ocio");
        tell(options.folder, files);
    }
    if (options.archive.empty()) return kOk;
    std::vector<GeneratedFile> packed;
    for (const GeneratedFile& file : files) {
        if (file.path == "config.ocio" || file.path.starts_with("luts/")) packed.push_back(file);
    }
    write_text_atomically(options.archive, make_archive(packed));
    tell(options.archive, packed);
    return kOk;
}

}  // namespace

void add_config(CommandLine& program) {
    auto options = std::make_shared<Options>();
    const Command command = program.add("config", "Write an OpenColorIO config of the operators.");
    command.group("LUTs, shaders and configs");
    const char* const output = "Output";
    const char* const contents = "Contents";
    const char* const own = "Custom views";
    const Option out =
        command.add("-o", options->folder, "folder to write: config.ocio, luts/, probe.csv");
    out.value("FOLDER").group(output);
    const Option into =
        command.add("--into", options->into,
                    "existing config that gets the views; their LUTs go to tonewright/ beside it");
    into.value("CONFIG").group(output);
    out.excludes(into);
    const Option update = command.add_flag(
        "--update", options->is_updated,
        "with --into: rebuild the added views, or replace them with those of --views");
    update.group(output).needs(into);
    command.add_flag("--remove", options->is_removed, "with --into: remove the added views")
        .group(output)
        .needs(into)
        .excludes(update);
    command
        .add_flag("--backup", options->has_backup,
                  "with --into: keep the config as it was as CONFIG.bak")
        .group(output)
        .needs(into);
    command
        .add("--archive", options->archive,
             "write the config and its LUTs as one .ocioz file (OpenColorIO 2.2 or newer)")
        .value("FILE")
        .group(output)
        .excludes(into);
    ConfigOptions& config = options->config;
    command
        .add("--profile", config.profiles,
             "OpenColorIO versions; the first is config.ocio, others config-VERSION.ocio")
        .value("LIST")
        .separated_by(',')
        .show_default("2.1,2.0,2.5")
        .group(output)
        .excludes(into);
    command
        .add("--views", config.views,
             "views (\"AgX Punchy\") or operators, in order; `none`, `all`, or "
             "`standard`, a dozen (default)")
        .value("LIST")
        .suggest(suggest_views)
        .separated_by(',')
        .group(contents);
    command.add("--displays", config.displays, "displays (default: all)")
        .value("LIST")
        .suggest(suggest_config_displays)
        .separated_by(',')
        .group(contents);
    command
        .add("--looks", config.looks,
             "looks (\"AgX - Punchy\"), or `none` (default: all looks of the views)")
        .value("LIST")
        .suggest(suggest_view_looks)
        .separated_by(',')
        .group(contents);
    command.add("--working", config.working, "color space in which applications compute")
        .value("SPACE")
        .suggest(suggest_spaces)
        .show_default()
        .group(contents);
    command
        .add("--operator", options->operators,
             "add a view: NAME[:PRESET][:PARAMETER=VALUE...], a .tone file or a LUT; repeat for "
             "more")
        .value("OPERATOR")
        .suggest(suggest_operators)
        .one_value_each()
        .group(own);
    command.add("--name", options->names, "name of the added view, one for each --operator")
        .value("NAME")
        .one_value_each()
        .group(own);
    command
        .add("--exposure-views", config.exposure_stops,
             "add every view again with this exposure, in stops")
        .value("LIST")
        .separated_by(',')
        .range(-16.0, 16.0)
        .group(own);
    command.footer(
        "LIST is separated by commas. The first standard config takes 20 seconds, because 3D LUTs "
        "are fitted and kept in ~/.cache/tonewright. The next ones take 7 seconds.\n"
        "Examples:\n"
        "  tonewright config -o ocio_config\n"
        "  tonewright config -o everything --views all\n"
        "  tonewright config -o studio --working acescg --views AgX,aces_20 \\\n"
        "    --operator reinhard_extended:white=6 --name \"Studio Reinhard\"\n"
        "  tonewright config --archive tonewright.ocioz\n"
        "  tonewright config --into studio.ocio --views AgX,hable --backup\n"
        "  tonewright config --into studio.ocio --remove\n"
        "  OCIO=ocio_config/config-2.5.ocio blender     # Blender 5.2 or newer\n"
        "  tonewright config --archive tonewright.ocioz --profile 2.5\n"
        "  oiiotool --colorconfig ocio_config/config.ocio in.exr \\\n"
        "    --ociodisplay sRGB Hable --iscolorspace sRGB -o out.png");
    command.action([options] { return run_config(*options); });
}

TONEWRIGHT_NAMESPACE_END
