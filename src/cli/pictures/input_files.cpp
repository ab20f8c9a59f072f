// SPDX-License-Identifier: Apache-2.0
#include "cli/pictures/input_files.h"

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
#include "tonewright/registry.h"

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

/// Sorted by name, without subfolders.
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

/// One name a line; empty lines and those that begin with `#` are left out.
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

bool is_folder(const std::string& path) {
    std::error_code ignored;
    return fs::is_directory(path, ignored);
}

std::string absolute(const std::string& path) {
    return fs::absolute(path).lexically_normal().string();
}

/// Each input's name in the folder.
std::vector<FrameFiles> into_folder(const std::vector<std::string>& inputs,
                                    const ApplyOptions& options) {
    const std::string format = lowercase(options.format);
    if (!format.empty() &&
        !picture_extensions().contains(format.front() == '.' ? format : "." + format)) {
        throw Error(
            fmt::format("apply: --format is {}; expected an extension of pictures, such as "
                        "png or exr",
                        options.format));
    }
    const bool is_named_as_picture = format.empty() && !is_folder(options.output) &&
                                     picture_extensions().contains(extension_of(options.output));
    if (is_named_as_picture) {
        throw Error(
            fmt::format("apply: -o is {}; expected a folder for several inputs, or --format with "
                        "it",
                        options.output));
    }
    std::map<std::string, std::string> input_of;
    std::vector<FrameFiles> files;
    for (const std::string& input : inputs) {
        fs::path name = fs::path(input).filename();
        if (!options.format.empty()) name.replace_extension(options.format);
        const std::string out = (fs::path(options.output) / name).string();
        const auto [other, is_new] = input_of.emplace(absolute(out), input);
        if (!is_new) {
            throw Error(
                fmt::format("apply: {} and {} would both be written to {}; expected "
                            "different file names",
                            other->second, input, out));
        }
        files.push_back({input, out, {}});
    }
    return files;
}

/// Other commands take the operator by its place.
/// @throws Error  the name is an operator's, and no file has it
void expect_picture(const std::string& name) {
    std::error_code unknown;  // too long a name, too
    if (fs::exists(name, unknown) || names_a_file(name)) return;
    try {
        // --operator says what is wrong with a setting. With a dot, it may be a file's name.
        const bool may_be_file = name.find('.') != std::string::npos;
        (void)resolve_picture_operator(may_be_file ? name : name.substr(0, name.find(':')));
    } catch (const Error&) {
        return;
    }
    throw Error(fmt::format("apply: IN is {}, an operator; expected a picture, and --operator {}",
                            name, name));
}

}  // namespace

ApplyFiles files_of(const ApplyOptions& options) {
    std::vector<std::string> named = options.pictures;
    expect_picture(named.front());
    ApplyOptions with_output = options;
    if (!options.given.contains("--output")) {
        if (named.size() != 2) {
            throw Error(fmt::format("apply: -o is missing; expected -o {}",
                                    named.size() == 1 ? "FILE" : "FOLDER"));
        }
        with_output.output = named.back();
        named.pop_back();
    }
    const std::string& output = with_output.output;
    const bool is_shot = options.given.contains("--frames");
    std::vector<std::string> inputs;
    bool has_many = false;
    for (const std::string& name : named) {
        std::vector<std::string> expanded = {name};
        const bool is_list = name.size() > 1 && name.front() == '@' && !is_shot;
        if (is_list) expanded = names_of_list(name.substr(1));
        has_many = has_many || is_list;
        for (const std::string& entry : expanded) {
            if (options.given.contains("--output") && !is_shot && is_folder(entry)) {
                const std::vector<std::string> pictures = pictures_of_folder(entry);
                inputs.insert(inputs.end(), pictures.begin(), pictures.end());
                has_many = true;
            } else {
                inputs.push_back(entry);
            }
        }
    }
    const bool is_into_folder =
        options.given.contains("--output") && !is_shot &&
        (has_many || inputs.size() > 1 || output.ends_with('/') || is_folder(output));
    if (is_into_folder) return {false, into_folder(inputs, with_output)};
    if (inputs.size() != 1) {
        throw Error(
            fmt::format("apply: --frames is {} with {} names; expected one with a "
                        "placeholder for the frame number",
                        options.frames.frames, inputs.size()));
    }
    if (!options.format.empty()) {
        throw Error(
            fmt::format("apply: --format is {}; expected -o with a folder, or the "
                        "extension in the output's name",
                        options.format));
    }
    return {true, {{inputs.front(), output, {}}}};
}

TONEWRIGHT_NAMESPACE_END
