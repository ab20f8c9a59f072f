// SPDX-License-Identifier: Apache-2.0
#include "lut/stated_input.h"

#include <fmt/format.h>

#include <algorithm>
#include <vector>

#include "base/strings.h"
#include "tonewright/lut.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

/// Text between two texts; all text after the first one if the second is empty.
std::optional<std::string_view> between(std::string_view text, std::string_view before,
                                        std::string_view after) {
    if (!text.starts_with(before)) return std::nullopt;
    text.remove_prefix(before.size());
    const std::size_t end = after.empty() ? text.size() : text.find(after);
    if (end == std::string_view::npos) return std::nullopt;
    return text.substr(0, end);
}

/// Converts the numbers of a title to parameters of an encoding's name.
std::string parametrized(std::string_view title) {
    if (const auto white = between(title, "PQ (SMPTE ST 2084), scene-linear 1 at ", " cd/m2"))
        return fmt::format("pq:{}", *white);
    if (const auto white =
            between(title, "HLG (ITU-R BT.2100) scene light, scene-linear 1 at ", " cd/m2"))
        return fmt::format("hlg:{}", *white);
    for (const auto& [before, name] :
         {std::pair("log2(x / 0.18) from ", "log2"), std::pair("scene-linear from ", "linear")}) {
        const auto low = between(title, before, " to ");
        if (!low) continue;
        const std::string_view rest =
            title.substr(std::string_view(before).size() + low->size() + 4);
        return fmt::format("{}:{}:{}", name, *low, rest.substr(0, rest.find(' ')));
    }
    return {};
}

/// The encoding that has this title.
std::optional<std::string> encoding_of(std::string_view title) {
    std::vector<std::string> ids = input_encoding_names();
    if (const std::string id = parametrized(title); !id.empty()) ids.push_back(id);
    for (const std::string& id : ids) {
        try {
            const InputEncoding encoding = parse_input_encoding(id);
            // A scene-linear table has its range in the file, so its input is scene-linear.
            if (encoding.title == title) return encoding.is_linear ? "linear" : encoding.id;
        } catch (const Error&) {
            continue;  // no file of Tonewright has this number
        }
    }
    return std::nullopt;
}

/// The space whose title the text begins with.
std::optional<std::string> space_of(std::string_view text) {
    const InputSpace* longest = nullptr;
    for (const InputSpace& space : all_input_spaces()) {
        const bool is_longer = !longest || space.title.size() > longest->title.size();
        if (text.starts_with(space.title) && is_longer) longest = &space;
    }
    return longest ? std::optional(longest->id) : std::nullopt;
}

std::optional<StatedInput> parse_input(std::string_view line) {
    StatedInput stated;
    stated.text = line;
    constexpr std::string_view kLight = "scene-linear ";
    constexpr std::string_view kOfLight = ", of scene-linear ";
    std::optional<std::string> encoding;
    std::optional<std::string> space;
    if (const std::size_t at = line.rfind(kOfLight); at != std::string_view::npos) {
        encoding = encoding_of(line.substr(0, at));
        space = space_of(line.substr(at + kOfLight.size()));
    } else if (line.starts_with(kLight)) {
        encoding = "linear";
        space = space_of(line.substr(kLight.size()));
        stated.text = line.substr(0, line.find(','));
    }
    if (!encoding || !space) return std::nullopt;
    stated.encoding = *encoding;
    stated.space = *space;
    return stated;
}

/// Parses the line of write_lut().
std::optional<std::string> parse_display(std::string_view line) {
    if (line.starts_with("display-linear Rec.709")) return std::string(kLinearOutput);
    for (const Display& display : all_displays()) {
        if (line.starts_with(display.title + " code values")) return display.id;
    }
    return std::nullopt;
}

/// First line after `mark` that `parse` understands, in a file of Tonewright.
template <class Stated>
std::optional<Stated> find_stated(std::string_view contents, std::string_view mark,
                                  std::optional<Stated> (*parse)(std::string_view)) {
    // A device link of version 4 stores text in 16 bits.
    std::string text;
    std::copy_if(contents.begin(), contents.end(), std::back_inserter(text),
                 [](char c) { return c != '\0'; });
    if (text.find("Tonewright: ") == std::string::npos) return std::nullopt;
    for (std::size_t at = text.find(mark); at != std::string::npos; at = text.find(mark, at + 1)) {
        const std::size_t begin = at + mark.size();
        const std::string_view line =
            std::string_view(text).substr(begin, text.find_first_of("\r\n<", begin) - begin);
        if (auto stated = parse(trimmed(line))) return stated;
    }
    return std::nullopt;
}

}  // namespace

std::optional<StatedInput> read_stated_input(std::string_view contents) {
    return find_stated(contents, "Input: ", parse_input);
}

std::optional<std::string> read_stated_display(std::string_view contents) {
    return find_stated(contents, "Output: ", parse_display);
}

TONEWRIGHT_NAMESPACE_END
