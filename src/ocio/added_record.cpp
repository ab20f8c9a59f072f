// SPDX-License-Identifier: Apache-2.0
#include "ocio/added_record.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <system_error>

#include "base/input_file.h"
#include "base/strings.h"
#include "tonewright/error.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

namespace fs = std::filesystem;

/// Length of the context before a piece, enough to distinguish it from the same text elsewhere.
constexpr std::size_t kContext = 80;

std::string file_of(const std::string& config) {
    return (fs::absolute(config).parent_path() / AddedRecord::path_of(config)).string();
}

/// Empty: none.
std::string text_of(const std::string& path) {
    std::error_code ignored;
    if (!fs::exists(path, ignored)) return "";
    require_regular_file(path);
    std::ifstream file(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(file), {}};
}

std::vector<std::string> texts(const YAML::Node& list) {
    std::vector<std::string> found;
    for (const YAML::Node& item : list)
        found.push_back(item.as<std::string>());
    return found;
}

/// An edited record must not remove files elsewhere.
bool is_table(const std::string& file) {
    const fs::path path(file);
    return path.parent_path() == kAddedFolder && path.has_filename() && path.filename() != "." &&
           path.filename() != "..";
}

/// Number of characters before `at` that match the end of `before`.
std::size_t common_before(const std::string& text, std::size_t at, const std::string& before) {
    std::size_t count = 0;
    while (count < std::min(at, before.size()) &&
           text[at - count - 1] == before[before.size() - count - 1])
        ++count;
    return count;
}

/// Start of the piece: the position with the longest matching context, if it is unique. A piece
/// that continues a line needs that line unchanged. Lines before it may have changed.
std::size_t find_piece(const std::string& text, const AddedRecord::Piece& piece) {
    const std::string& before = piece.before;
    const bool continues_line = !piece.text.starts_with('\n') && !piece.text.starts_with("\r\n");
    const std::size_t needed = continues_line ? before.size() - (before.rfind('\n') + 1) : 0;
    std::size_t found = std::string::npos;
    std::size_t most = 0;
    bool is_only = true;
    for (std::size_t at = text.find(piece.text); at != std::string::npos;
         at = text.find(piece.text, at + 1)) {
        const std::size_t count = common_before(text, at, before);
        if (count < needed || count < most) continue;
        is_only = found == std::string::npos || count > most;
        found = at;
        most = count;
    }
    return is_only ? found : std::string::npos;
}

}  // namespace

std::string AddedRecord::path_of(const std::string& config) {
    return std::string(kAddedFolder) + "/" + fs::path(config).filename().string() + ".yaml";
}

std::optional<AddedRecord> AddedRecord::find(const std::string& config,
                                             const std::string& config_text) {
    const std::string path = file_of(config);
    const std::string mark = mark_of(config_text);
    std::string text = text_of(path + ".new");
    text = text.starts_with(mark) ? text.substr(mark.size()) : text_of(path);
    if (text.empty()) return std::nullopt;
    AddedRecord record;
    try {
        const YAML::Node root = YAML::Load(text);
        for (const YAML::Node& piece : root["added"])
            record.pieces.push_back(
                {piece["before"].as<std::string>(), piece["text"].as<std::string>()});
        record.files = texts(root["files"]);
        for (const std::string& file : record.files) {
            if (!is_table(file)) {
                throw FileError("read: " + path + ": file is " + printable(file) +
                                "; expected a table in tonewright/");
            }
        }
        const YAML::Node options = root["options"];
        record.options.views = texts(options["views"]);
        record.options.displays = texts(options["displays"]);
        record.options.looks = texts(options["looks"]);
        for (const YAML::Node& custom : options["operators"])
            record.custom.push_back(
                {custom["name"].as<std::string>(), custom["operator"].as<std::string>()});
        for (const YAML::Node& stops : options["exposures"])
            record.options.exposure_stops.push_back(stops.as<double>());
    } catch (const YAML::Exception& e) {
        throw FileError("read: " + path + ": " + one_line(e.what()));
    }
    return record;
}

AddedRecord AddedRecord::read(const std::string& config, const std::string& config_text) {
    if (std::optional<AddedRecord> record = find(config, config_text)) return *std::move(record);
    throw FileError(config + ": has no record of what was added to it; " + file_of(config) +
                    " is missing");
}

std::string AddedRecord::mark_of(const std::string& config_text) {
    return "# Config " + content_hash(config_text) + "\n";
}

std::string AddedRecord::text(const std::string& config_text) const {
    YAML::Emitter out;
    const auto list = [&](const char* key, const std::vector<std::string>& items) {
        out << YAML::Key << key << YAML::Value << YAML::BeginSeq;
        for (const std::string& item : items)
            out << YAML::DoubleQuoted << item;
        out << YAML::EndSeq;
    };
    out << YAML::BeginMap << YAML::Key << "options" << YAML::Value << YAML::BeginMap;
    list("views", options.views);
    list("displays", options.displays);
    list("looks", options.looks);
    out << YAML::Key << "operators" << YAML::Value << YAML::BeginSeq;
    for (const CustomView& view : custom) {
        out << YAML::BeginMap << YAML::Key << "name" << YAML::Value << YAML::DoubleQuoted
            << view.name << YAML::Key << "operator" << YAML::Value << YAML::DoubleQuoted << view.op
            << YAML::EndMap;
    }
    out << YAML::EndSeq << YAML::Key << "exposures" << YAML::Value << YAML::BeginSeq;
    for (const double stops : options.exposure_stops)
        out << fmt::format("{}", stops);
    out << YAML::EndSeq << YAML::EndMap;
    list("files", files);
    out << YAML::Key << "added" << YAML::Value << YAML::BeginSeq;
    for (const Piece& piece : pieces) {
        out << YAML::BeginMap << YAML::Key << "before" << YAML::Value << YAML::DoubleQuoted
            << piece.before << YAML::Key << "text" << YAML::Value << YAML::DoubleQuoted
            << piece.text << YAML::EndMap;
    }
    out << YAML::EndSeq << YAML::EndMap;
    return mark_of(config_text) +
           "# Written by `tonewright config --into`; --update and --remove read it.\n" +
           std::string(out.c_str()) + "\n";
}

void AddedRecord::add(const std::vector<YamlText::Insertion>& insertions,
                      const std::string& result) {
    std::size_t inserted = 0;
    for (const YamlText::Insertion& insertion : insertions) {
        const std::size_t at = insertion.at + inserted;
        const std::size_t length = std::min(at, kContext);
        pieces.push_back({result.substr(at - length, length), insertion.text});
        inserted += insertion.text.size();
    }
}

std::string AddedRecord::without(std::string text, const std::string& config) const {
    // The last insertion may be part of the context of the others.
    for (auto piece = pieces.rbegin(); piece != pieces.rend(); ++piece) {
        const std::size_t at = find_piece(text, *piece);
        if (at == std::string::npos) {
            throw FileError(
                fmt::format("{}: entries that were added to it were changed since: {}; "
                            "expected them as in {}",
                            config, printable(trimmed(piece->text)), path_of(config)));
        }
        text.erase(at, piece->text.size());
    }
    return text;
}

TONEWRIGHT_NAMESPACE_END
