// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <system_error>

#include "base/atomic_file.h"
#include "base/input_file.h"
#include "base/system_files.h"
#include "ocio/extend.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

/// "studio.ocio.bak", or with the first number that is free.
std::string write_backup(const std::string& path) {
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
    return backup;
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
                  std::vector<std::filesystem::path>& written, ChangedConfig& result) {
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
        result.links.push_back({link, target.string()});
    }
}

/// A file or a link of this name is the user's.
void remove_empty_folder(const std::filesystem::path& path) {
    std::error_code ignored;
    if (std::filesystem::symlink_status(path, ignored).type() ==
        std::filesystem::file_type::directory)
        std::filesystem::remove(path, ignored);
}

/// Replaces the config after all checks; until then the old one stays. A run that is killed between
/// config and record leaves the new record as NAME.new, which the next run finds.
ChangedConfig replace_config(const ExtendedConfig& changed, const ConfigChange& change) {
    namespace fs = std::filesystem;
    const std::string& path = changed.path;
    const fs::path folder = fs::absolute(path).parent_path();
    std::vector<fs::path> written;
    const fs::path record = folder / changed.record.path;
    const fs::path new_record = record.string() + ".new";
    // Files that an earlier release wrote beside a link are where the link to the folder belongs.
    const bool is_moved = std::any_of(changed.unused_files.begin(), changed.unused_files.end(),
                                      [](const fs::path& file) { return file.is_absolute(); });
    ChangedConfig result;
    result.path = path;
    result.added = changed.added;
    result.folder = record.parent_path().filename().string();
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
            result.views = changed.check(trial.path().string());
        }
        if (!is_moved) link_folders(record.parent_path(), changed, written, result);
        if (change.has_backup) result.backup = write_backup(path);
        written.push_back(new_record);
        write_text_atomically(new_record.string(), changed.record.contents);
        write_text_atomically(path, changed.text);
        written.clear();
        std::error_code error, ignored;
        if (change.kind != ConfigChange::Kind::remove) {
            fs::rename(new_record, record, error);
        } else if (fs::remove(record, error); !error) {
            fs::remove(new_record, error);
        }
        if (error) throw FileError("write: " + record.string() + ": " + error.message());
        for (const std::string& file : changed.unused_files) {
            fs::remove(folder / file, ignored);
            if (is_moved) remove_empty_folder((folder / file).parent_path());
        }
        remove_empty_folder(record.parent_path());
        if (is_moved) link_folders(record.parent_path(), changed, written, result);
        for (const std::string& link : changed.folder_links) {
            if (!fs::exists(record.parent_path(), ignored)) fs::remove(link, ignored);
        }
    } catch (...) {
        std::error_code ignored;
        for (const fs::path& file : written)
            fs::remove(file, ignored);
        remove_empty_folder(record.parent_path());
        throw;
    }
    result.removed_tables = static_cast<std::size_t>(std::count_if(
        changed.unused_files.begin(), changed.unused_files.end(),
        [](const fs::path& file) { return file.string().find(".yaml") == std::string::npos; }));
    return result;
}

}  // namespace

ChangedConfig change_config(const std::string& path, const ConfigChange& change) {
    using Kind = ConfigChange::Kind;
    const ConfigOptions& options = change.options;
    if (change.kind == Kind::remove &&
        !(options.views.empty() && options.custom.empty() && options.displays.empty() &&
          options.looks.empty() && options.exposure_stops.empty())) {
        throw Error(Problem{.value = "views, displays, looks or exposures are given to be removed",
                            .expected = "none, because everything that was added is removed"});
    }
    const ExtendedConfig changed =
        change.kind == Kind::remove
            ? reduce_config(path)
            : extend_config(path, change.options, change.kind == Kind::update);
    if (change.warn) {
        std::error_code ignored;
        const auto names = std::filesystem::hard_link_count(changed.path, ignored);
        if (!ignored && names > 1) {
            change.warn(fmt::format("{} has {} hard links: only this name gets the new contents",
                                    changed.path, names));
        }
        for (const std::string& text : changed.warnings)
            change.warn(text);
        if (!changed.unchecked.empty()) change.warn(changed.unchecked);
    }
    return replace_config(changed, change);
}

TONEWRIGHT_NAMESPACE_END
