// SPDX-License-Identifier: Apache-2.0
#include "plugin/request.h"

#include <OpenImageIO/strutil.h>
#include <fmt/format.h>

#include <filesystem>
#include <sstream>
#include <string_view>
#include <system_error>

#include "base/input_file.h"
#include "image/tonemap_arguments.h"
#include "tonewright/error.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

namespace fs = std::filesystem;

constexpr std::string_view kExtension = ".tonewright";

/// The part before `?`, where OpenImageIO looks for the format, too.
bool has_extension(const std::string& name) {
    return OIIO::Strutil::iends_with(name.substr(0, name.find('?')),
                                     OIIO::string_view(kExtension.data(), kExtension.size()));
}

/// A file of lines `name=value`, of which `file` names the picture, relative to the file. Messages
/// quote nothing from it, because the name may lead to a file that the host can read and its user
/// cannot.
void read_request_file(const fs::path& path, Request& request) {
    constexpr std::size_t kMostBytes = 1 << 16;
    std::istringstream file(read_file(path.string(), kMostBytes, [&](const std::string& reason) {
        throw FileError(path.string() + ": cannot read: " + reason);
    }));
    std::string line;
    for (int number = 1; std::getline(file, line); ++number) {
        constexpr std::string_view kByteOrderMark = "\xEF\xBB\xBF";
        if (number == 1 && line.starts_with(kByteOrderMark)) line.erase(0, kByteOrderMark.size());
        const std::string_view text = OIIO::Strutil::strip(line);
        if (text.empty() || text.front() == '#') continue;
        const std::size_t equals = text.find('=');
        if (equals == std::string_view::npos || equals == 0) {
            throw FileError(fmt::format("{}: line {} is not a setting; expected name=value",
                                        path.string(), number));
        }
        const std::string name(OIIO::Strutil::strip(std::string(text.substr(0, equals))));
        const std::string value(OIIO::Strutil::strip(std::string(text.substr(equals + 1))));
        if (name == "file") {
            request.picture = (path.parent_path() / value).string();
        } else if (!is_tonemap_argument(name)) {
            throw FileError(fmt::format("{}: line {} has an unknown name; expected file, {}",
                                        path.string(), number, tonemap_argument_choices()));
        } else {
            request.arguments.emplace(name, value);  // settings in the name take precedence
        }
    }
    if (request.picture.empty())
        throw FileError(path.string() + ": file is missing; expected a line file=PICTURE");
}

}  // namespace

Request parse_request(const std::string& name) {
    Request request;
    std::string base;
    if (!OIIO::Strutil::get_rest_arguments(name, base, request.arguments)) {
        throw Error("arguments are " + name.substr(base.size()) +
                    "; expected ?name=value&name=value");
    }
    if (!has_extension(base)) throw Error(base + " does not end in " + std::string(kExtension));
    std::error_code ignored;
    if (fs::is_regular_file(base, ignored)) {
        read_request_file(base, request);
    } else {
        request.picture = base.substr(0, base.size() - kExtension.size());
    }
    if (has_extension(request.picture))
        throw Error("picture is " + request.picture + "; expected one that is not tone mapped yet");
    return request;
}

TONEWRIGHT_NAMESPACE_END
