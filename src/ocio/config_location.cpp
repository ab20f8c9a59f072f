// SPDX-License-Identifier: Apache-2.0
#include "ocio/config_location.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <optional>
#include <system_error>

#include "tonewright/error.h"
#include "tonewright/ocio.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

namespace fs = std::filesystem;

/// Linux follows as many.
constexpr int kMostLinks = 40;

fs::path folder_of(const std::string& config) {
    std::error_code ignored;
    const fs::path folder = fs::absolute(config).parent_path();
    const fs::path real = fs::canonical(folder, ignored);
    return real.empty() ? folder : real;
}

fs::path tables_of(const std::string& config) { return folder_of(config) / kAddedFolder; }

/// Also through a link to a folder that is not there yet.
bool is_same_folder(fs::path folder, const fs::path& tables) {
    std::error_code ignored;
    for (int i = 0; i < kMostLinks && fs::is_symlink(fs::symlink_status(folder, ignored)); ++i)
        folder = folder.parent_path() / fs::read_symlink(folder, ignored);
    return fs::weakly_canonical(folder, ignored) == fs::weakly_canonical(tables, ignored);
}

/// True if nothing but these files is in the folder.
bool has_only(const fs::path& folder, const std::vector<std::string>& files) {
    std::error_code error;
    for (fs::directory_iterator entry(folder, error), end; !error && entry != end;
         entry.increment(error)) {
        if (std::find(files.begin(), files.end(), entry->path().string()) == files.end())
            return false;
    }
    return !error;
}

}  // namespace

ConfigLocation locate_config(const std::string& path) {
    std::error_code error;
    ConfigLocation location{path, {}};
    fs::path name = path;
    for (int i = 0; i < kMostLinks && fs::is_symlink(fs::symlink_status(name, error)); ++i) {
        location.links.push_back(fs::absolute(name).string());
        name = name.parent_path() / fs::read_symlink(name, error);
        if (error) return {path, {}};
    }
    if (location.links.empty()) return location;
    name = fs::canonical(path, error);
    if (error) return {path, {}};
    location.file = name.string();
    return location;
}

FoundRecord read_record(const ConfigLocation& location, const std::string& text) {
    if (auto record = AddedRecord::find(location.file, text))
        return {*std::move(record), location.file};
    for (const std::string& link : location.links) {
        if (auto record = AddedRecord::find(link, text)) return {*std::move(record), link};
    }
    return {AddedRecord::read(location.file, text), location.file};
}

std::vector<std::string> folders_to_link(const ConfigLocation& location,
                                         const std::vector<std::string>& moved) {
    const fs::path tables = tables_of(location.file);
    std::vector<std::string> folders;
    for (const std::string& link : location.links) {
        const fs::path folder = tables_of(link);
        if (is_same_folder(folder, tables)) continue;
        std::error_code ignored;
        const auto type = fs::symlink_status(folder, ignored).type();
        const bool is_free =
            type == fs::file_type::not_found ||
            (type == fs::file_type::directory && !moved.empty() && has_only(folder, moved));
        if (!is_free) {
            throw FileError(fmt::format(
                "{} is a link to {}, and OpenColorIO looks for tables beside the link: {} "
                "is there; expected nothing, or a link to {}",
                link, location.file, folder.string(), tables.string()));
        }
        if (std::find(folders.begin(), folders.end(), folder.string()) == folders.end())
            folders.push_back(folder.string());
    }
    return folders;
}

std::vector<std::string> linked_folders(const ConfigLocation& location) {
    const fs::path tables = tables_of(location.file);
    std::vector<std::string> folders;
    for (const std::string& link : location.links) {
        const fs::path folder = tables_of(link);
        std::error_code ignored;
        if (fs::is_symlink(fs::symlink_status(folder, ignored)) && is_same_folder(folder, tables))
            folders.push_back(folder.string());
    }
    return folders;
}

TONEWRIGHT_NAMESPACE_END
