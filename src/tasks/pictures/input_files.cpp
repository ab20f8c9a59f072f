// SPDX-License-Identifier: Apache-2.0
#include "tasks/pictures/input_files.h"

#include <OpenImageIO/imageio.h>
#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <map>
#include <set>
#include <sstream>
#include <system_error>

#include "base/input_file.h"
#include "base/strings.h"
#include "tonewright/error.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

namespace fs = std::filesystem;

/// The extensions that OpenImageIO reads, with the dot.
std::set<std::string> picture_extensions() {
    std::set<std::string> extensions;
    std::istringstream formats(OIIO::get_string_attribute("extension_list"));
    for (std::string format; std::getline(formats, format, ';');) {  // "tiff:tif,tiff"
        std::istringstream names(format.substr(std::min(format.find(':') + 1, format.size())));
        for (std::string name; std::getline(names, name, ',');)
            extensions.insert("." + lowercase(name));
    }
    return extensions;
}

std::string absolute(const std::string& path) {
    return fs::absolute(path).lexically_normal().string();
}

}  // namespace

bool is_folder(const std::string& path) {
    std::error_code ignored;
    return fs::is_directory(path, ignored);
}

bool is_picture_extension(const std::string& extension) {
    return picture_extensions().contains(extension);
}

std::vector<std::string> pictures_of_folder(const std::string& folder) {
    const std::set<std::string> extensions = picture_extensions();
    std::vector<std::string> pictures;
    std::error_code error;
    for (fs::directory_iterator entry(folder, error), end; !error && entry != end;
         entry.increment(error)) {
        const std::string path = entry->path().string();
        std::error_code ignored;
        if (entry->path().filename().string().starts_with('.') || !entry->is_regular_file(ignored))
            continue;
        if (extensions.contains(extension_of(path))) pictures.push_back(path);
    }
    if (error) throw FileError(folder + ": cannot read: " + error.message());
    if (pictures.empty()) throw FileError(folder + ": cannot read: the folder has no pictures");
    std::sort(pictures.begin(), pictures.end());
    return pictures;
}

std::vector<std::string> names_of_list(const std::string& path) {
    constexpr std::size_t kMostBytes = std::size_t{1} << 26;
    std::istringstream lines(read_file(path, kMostBytes, [&](const Problem& why) {
        throw FileError(within(path + ": cannot read", why));
    }));
    std::vector<std::string> names;
    for (std::string line; std::getline(lines, line);) {
        const std::string_view name = trimmed(line);
        if (!name.empty() && name.front() != '#') names.emplace_back(name);
    }
    if (names.empty()) throw FileError(path + ": cannot read: the list is empty");
    return names;
}

std::pair<std::vector<std::string>, bool> expanded_inputs(const std::vector<std::string>& names,
                                                          bool takes_folders) {
    std::vector<std::string> inputs;
    bool has_many = false;
    for (const std::string& name : names) {
        std::vector<std::string> expanded = {name};
        const bool is_list = name.size() > 1 && name.front() == '@';
        if (is_list) expanded = names_of_list(name.substr(1));
        has_many = has_many || is_list;
        for (const std::string& entry : expanded) {
            if (takes_folders && is_folder(entry)) {
                const std::vector<std::string> pictures = pictures_of_folder(entry);
                inputs.insert(inputs.end(), pictures.begin(), pictures.end());
                has_many = true;
            } else {
                inputs.push_back(entry);
            }
        }
    }
    return {inputs, has_many};
}

std::vector<FrameFiles> files_into_folder(const std::vector<std::string>& pictures,
                                          const std::string& folder, const std::string& format) {
    std::map<std::string, std::string> input_of;
    std::vector<FrameFiles> files;
    for (const std::string& picture : pictures) {
        fs::path name = fs::path(picture).filename();
        if (!format.empty()) name.replace_extension(format);
        const std::string out = (fs::path(folder) / name).string();
        const auto [other, is_new] = input_of.emplace(absolute(out), picture);
        if (!is_new) {
            throw Error({.value = fmt::format("{} and {} would both be written to {}",
                                              other->second, picture, out),
                         .expected = "different file names"});
        }
        files.push_back({picture, out, {}});
    }
    return files;
}

TONEWRIGHT_NAMESPACE_END
