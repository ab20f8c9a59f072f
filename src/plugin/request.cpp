// SPDX-License-Identifier: Apache-2.0
#include "plugin/request.h"

#include <OpenImageIO/strutil.h>
#include <fmt/format.h>

#include <algorithm>
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
    std::istringstream file(read_file(path.string(), kMostBytes, [&](const Problem& why) {
        throw FileError(within(path.string() + ": cannot read", why));
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

/// Position of `:<digits>` at the end of a text, or the text's size.
std::size_t end_without_number(std::string_view text) {
    const std::size_t colon = text.rfind(':');
    if (colon == std::string_view::npos || colon + 1 == text.size()) return text.size();
    const bool is_number =
        text.find_first_not_of("0123456789", colon + 1) == std::string_view::npos;
    return is_number ? colon : text.size();
}

}  // namespace

std::string without_contents(std::string_view message, const std::vector<std::string>& named) {
    const auto is_named = [&](std::string_view text) {
        return !text.empty() && std::any_of(named.begin(), named.end(), [&](const auto& own) {
            return own.find(text) != std::string::npos;
        });
    };
    std::string path;
    std::string line;
    constexpr std::string_view kOperation = "read: ";
    constexpr std::string_view kLine = "line ";
    if (message.starts_with(kOperation)) message.remove_prefix(kOperation.size());
    while (!message.empty() && line.empty()) {
        const std::string_view part = message.substr(0, message.find(": "));
        message.remove_prefix(std::min(part.size() + 2, message.size()));
        if (!path.empty() && part.starts_with(kLine)) {
            const std::string_view number = part.substr(kLine.size());
            if (number.find_first_not_of("0123456789") == std::string_view::npos) line = number;
            break;
        }
        // `<path>:<line>` or `<path>:<line>:<column>`
        std::string_view name = part;
        while (!is_named(name) && end_without_number(name) < name.size())
            name = name.substr(0, end_without_number(name));
        if (!is_named(name)) break;
        path = name;
        if (name.size() < part.size()) {
            const std::string_view numbers = part.substr(name.size() + 1);
            line = numbers.substr(0, numbers.find(':'));
        }
    }
    if (path.empty()) return "op names a file that cannot be read as one of an operator";
    if (const std::optional<Problem> why = why_not_readable(path))
        return fmt::format("{}: cannot read: {}", path, why->value);
    return fmt::format(
        "{}{}: cannot be read as the file of an operator; `tonewright list OPERATOR` says why",
        path, line.empty() ? "" : ":" + line);
}

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
