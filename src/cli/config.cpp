// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <memory>

#include "cli/command.h"
#include "cli/messages.h"
#include "cli/options.h"
#include "cli/progress.h"
#include "cli/shared_options.h"
#include "cli/suggestions.h"
#include "tasks/config.h"
#include "tonewright/error.h"
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

/// "1 view", "2 views".
std::string counted(std::size_t count, std::string_view noun) {
    return fmt::format("{} {}{}", count, noun, count == 1 ? "" : "s");
}

void change_existing(const Options& options) {
    ConfigChange change;
    using Kind = ConfigChange::Kind;
    if (options.is_updated) change.kind = Kind::update;
    if (options.is_removed) change.kind = Kind::remove;
    change.options = options.config;
    change.has_backup = options.has_backup;
    const ChangedConfig changed = with_progress("config", [&](const Listener& listener) {
        change.warn = listener.warn;
        return change_config(options.into, change);
    });
    for (const ChangedConfig::Link& link : changed.links)
        fmt::print("linked {} to {}\n", link.path, link.target);
    if (!changed.backup.empty()) fmt::print("backup: {}\n", changed.backup);
    if (changed.path != options.into)
        fmt::print("edited {}, to which {} links\n", changed.path, options.into);
    for (const auto& [kind, names] : changed.added) {
        if (!names.empty())
            fmt::print("added {}: {}\n", counted(names.size(), kind), fmt::join(names, ", "));
    }
    if (changed.removed_tables > 0) {
        fmt::print("removed {} from {}/\n", counted(changed.removed_tables, "table"),
                   changed.folder);
    }
    if (changed.views.empty()) return;
    fmt::print("\n{:<28} {:<40} {:>9} {:>9}\n", "display", "view", "max error", "99.9 %");
    for (const ExtendedView& v : changed.views)
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
    print_opencolorio_messages();
    if (!options.into.empty()) {
        change_existing(options);
        return kOk;
    }
    if (options.folder.empty() && options.archive.empty())
        throw Error("config: -o is missing; expected -o FOLDER, --archive FILE or --into CONFIG");
    wanted.working = find_input_space(wanted.working).id;
    const ResultLine result;
    const std::vector<WrittenConfig> written =
        with_progress("config", [&](const Listener& listener) {
            return write_config({wanted, options.folder, options.archive}, listener);
        });
    for (const WrittenConfig& w : written) {
        result.print(fmt::format("config: {}: {} files, {:.1f} MB", w.path, w.files,
                                 static_cast<double>(w.bytes) / 1e6));
    }
    return kOk;
}

}  // namespace

void add_config(CommandLine& program) {
    auto options = std::make_shared<Options>();
    const Command command = program.add("config", "LUTs, shaders and configs",
                                        "Write an OpenColorIO config of the operators.");
    command.title("Output");
    command.add("-o", "FOLDER", &options->folder, "folder to write: config.ocio, luts/, probe.csv");
    command.add("--into", "CONFIG", &options->into,
                "existing config that gets the views; their LUTs go to tonewright/ beside it",
                {.excludes = {"-o"}});
    command.add_flag("--update", &options->is_updated,
                     "with --into: rebuild the added views, or replace them with those of --views",
                     {.needs = {"--into"}});
    command.add_flag("--remove", &options->is_removed, "with --into: remove the added views",
                     {.needs = {"--into"}, .excludes = {"--update"}});
    command.add_flag("--backup", &options->has_backup,
                     "with --into: keep the config as it was as CONFIG.bak", {.needs = {"--into"}});
    command.add("--archive", "FILE", &options->archive,
                "write the config and its LUTs as one .ocioz file (OpenColorIO 2.2 or newer)",
                {.excludes = {"--into"}});
    ConfigOptions& config = options->config;
    command.add("--profile", "LIST", &config.profiles,
                "OpenColorIO versions; the first is config.ocio, others config-VERSION.ocio",
                {.excludes = {"--into"}, .separator = ',', .default_text = "2.1,2.0,2.5"});
    command.title("Contents");
    command.add("--views", "LIST", &config.views,
                "views (\"AgX Punchy\") or operators, in order; `none`, `all`, or "
                "`standard`, a dozen (default)",
                {.suggest = suggest_views, .separator = ','});
    command.add("--displays", "LIST", &config.displays, "displays (default: all)",
                {.suggest = suggest_config_displays, .separator = ','});
    command.add("--looks", "LIST", &config.looks,
                "looks (\"AgX - Punchy\"), or `none` (default: all looks of the views)",
                {.suggest = suggest_view_looks, .separator = ','});
    command.add("--working", "SPACE", &config.working, "color space in which applications compute",
                {.suggest = suggest_spaces});
    command.title("Custom views");
    command.add("--operator", "OPERATOR", &options->operators,
                "add a view: NAME[:PRESET][:PARAMETER=VALUE...], a .tone file or a LUT; repeat for "
                "more",
                {.suggest = suggest_operators, .takes_one_each = true});
    command.add("--name", "NAME", &options->names,
                "name of the added view, one for each --operator", {.takes_one_each = true});
    command.add("--exposure-views", "LIST", &config.exposure_stops,
                "add every view again with this exposure, in stops",
                {.range = {{-16.0, 16.0}}, .separator = ','});
    add_progress(command);
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
