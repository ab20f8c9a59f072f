// SPDX-License-Identifier: Apache-2.0
#include "base/strings.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <filesystem>

#include "tonewright/error.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

char lower(char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c; }

bool is_digit(char c) { return c >= '0' && c <= '9'; }

/// Cost of an inserted, dropped or replaced letter. Other digits mean another thing, not a typing
/// error.
std::size_t cost_of(char a, char b = ' ') { return is_digit(a) || is_digit(b) ? 2 : 1; }

/// Damerau-Levenshtein distance (optimal string alignment): two swapped letters are one error.
std::size_t edit_distance(std::string_view a, std::string_view b) {
    std::vector<std::vector<std::size_t>> rows(a.size() + 1,
                                               std::vector<std::size_t>(b.size() + 1));
    for (std::size_t j = 0; j < b.size(); ++j)
        rows[0][j + 1] = rows[0][j] + cost_of(b[j]);
    for (std::size_t i = 0; i < a.size(); ++i) {
        std::vector<std::size_t>& row = rows[i + 1];
        row[0] = rows[i][0] + cost_of(a[i]);
        for (std::size_t j = 0; j < b.size(); ++j) {
            const std::size_t change = a[i] == b[j] ? 0 : cost_of(a[i], b[j]);
            row[j + 1] = std::min(
                {rows[i][j] + change, rows[i][j + 1] + cost_of(a[i]), row[j] + cost_of(b[j])});
            if (i > 0 && j > 0 && a[i] == b[j - 1] && a[i - 1] == b[j])
                row[j + 1] = std::min(row[j + 1], rows[i - 1][j - 1] + 1);
        }
    }
    return rows[a.size()][b.size()];
}

/// The words of a folded name.
std::vector<std::string_view> words_of(std::string_view name) {
    constexpr std::string_view kBetween = "_.:,()/";
    std::vector<std::string_view> words;
    while (!name.empty()) {
        const std::size_t end = std::min(name.find_first_of(kBetween), name.size());
        if (end > 0) words.push_back(name.substr(0, end));
        name.remove_prefix(std::min(end + 1, name.size()));
    }
    return words;
}

std::string joined_words(std::string_view name) {
    std::string joined;
    for (const std::string_view word : words_of(name))
        joined += word;
    return joined;
}

/// The code point at the beginning of a text, and its bytes; no bytes where it is not UTF-8.
struct Utf8Character {
    std::uint32_t point = 0;
    std::size_t length = 0;
};
Utf8Character utf8_character(std::string_view text) {
    const auto byte = [&](std::size_t i) { return static_cast<unsigned char>(text[i]); };
    if (byte(0) < 0x80) return {byte(0), 1};
    const std::size_t length = byte(0) >= 0xf0 ? 4 : byte(0) >= 0xe0 ? 3 : 2;
    if (byte(0) < 0xc2 || byte(0) > 0xf4 || text.size() < length) return {};
    std::uint32_t point = byte(0) & (0x7f >> length);
    for (std::size_t i = 1; i < length; ++i) {
        if ((byte(i) & 0xc0) != 0x80) return {};
        point = point << 6 | (byte(i) & 0x3f);
    }
    constexpr std::uint32_t kSmallest[] = {0, 0, 0x80, 0x800, 0x10000};
    const bool is_character =
        point >= kSmallest[length] && point <= 0x10ffff && (point < 0xd800 || point > 0xdfff);
    return is_character ? Utf8Character{point, length} : Utf8Character{};
}

/// Length in bytes of the character that a text begins with; 0 for a control character or a byte
/// that is not UTF-8. Controls of two bytes (C1) and marks that change the direction of writing
/// count as controls.
std::size_t utf8_length(std::string_view text) {
    const auto [point, length] = utf8_character(text);
    const bool is_control =
        point < 0x20 || (point >= 0x7f && point < 0xa0) || (point >= 0x200e && point <= 0x200f) ||
        (point >= 0x2028 && point <= 0x202e) || (point >= 0x2066 && point <= 0x2069);
    return is_control ? 0 : length;
}

}  // namespace

std::string folded_name(std::string_view name) {
    std::string folded;
    bool is_between = false;
    for (const char c : name) {
        if (c == '-' || c == '_' || c == ' ' || (c >= '\t' && c <= '\r')) {
            is_between = true;
            continue;
        }
        if (is_between && !folded.empty()) folded += '_';
        is_between = false;
        folded += lower(c);
    }
    return folded;
}

bool is_same_name(std::string_view a, std::string_view b) {
    return folded_name(a) == folded_name(b);
}

std::vector<std::string> likely_names(std::string_view name,
                                      const std::vector<NamedChoice>& choices) {
    constexpr std::size_t kMost = 3;
    constexpr std::size_t kLongest = 64;  // is no name, and the distance takes its square
    const std::string typed = folded_name(name);
    if (typed.empty() || typed.size() > kLongest) return {};
    const auto first_of = [&](const auto& fits) {
        std::vector<std::string> found;
        for (const NamedChoice& choice : choices) {
            bool is_fitting = fits(folded_name(choice.id));
            for (const std::string& other : choice.names)
                is_fitting = is_fitting || fits(folded_name(other));
            if (is_fitting && found.size() < kMost) found.push_back(choice.id);
        }
        return found;
    };
    const auto has_word = [&](const std::string& candidate) {
        const std::vector<std::string_view> words = words_of(candidate);
        return typed.size() > 1 && std::find(words.begin(), words.end(), typed) != words.end();
    };
    if (std::vector<std::string> found = first_of(has_word); !found.empty()) return found;
    // People omit separators, or add them: `aces2` is the beginning of aces_20.
    const std::string joined = joined_words(typed);
    const auto joined_so = [&](const std::string& candidate) {
        return joined_words(candidate) == joined;
    };
    if (std::vector<std::string> found = first_of(joined_so); !found.empty()) return found;
    const auto begins_so = [&](const std::string& candidate) {
        return joined.size() > 2 && joined_words(candidate).starts_with(joined);
    };
    if (std::vector<std::string> found = first_of(begins_so); !found.empty()) return found;

    std::string best;
    std::size_t least = std::max<std::size_t>(typed.size() / 3, 1) + 1;
    const auto measure = [&](const std::string& candidate) {
        const std::size_t distance = edit_distance(typed, folded_name(candidate));
        if (distance >= least) return;
        least = distance;
        best = candidate;
    };
    for (const NamedChoice& choice : choices) {
        measure(choice.id);
        for (const std::string& other : choice.names)
            measure(other);
    }
    if (best.empty()) return {};
    return {best};
}

namespace {

std::vector<NamedChoice> without_other_names(const std::vector<std::string>& candidates) {
    std::vector<NamedChoice> choices;
    choices.reserve(candidates.size());
    for (const std::string& candidate : candidates)
        choices.push_back({candidate});
    return choices;
}

}  // namespace

std::string nearest_name(std::string_view name, const std::vector<std::string>& candidates) {
    const std::vector<std::string> likely = likely_names(name, without_other_names(candidates));
    return likely.empty() ? "" : likely.front();
}

std::string suggested_names(std::string_view name, const std::vector<std::string>& candidates) {
    return suggested_names(name, without_other_names(candidates));
}

std::string suggested_names(std::string_view name, const std::vector<NamedChoice>& choices) {
    return join_choices(likely_names(name, choices));
}

std::string did_you_mean(std::string_view name, const std::vector<std::string>& candidates) {
    return did_you_mean(name, without_other_names(candidates));
}

std::string did_you_mean(std::string_view name, const std::vector<NamedChoice>& choices) {
    const std::string names = suggested_names(name, choices);
    return names.empty() ? "" : "; did you mean " + names + "?";
}

std::size_t find_choice(std::string_view parameter, std::string_view text,
                        const std::vector<std::string>& choices, std::string_view what) {
    for (std::size_t i = 0; i < choices.size(); ++i) {
        if (is_same_name(choices[i], text)) return i;
    }
    throw Error({.what = std::string(what),
                 .parameter = std::string(parameter),
                 .value = std::string(text),
                 .expected = join_choices(choices),
                 .suggestion = suggested_names(text, choices)});
}

std::string join_choices(const std::vector<std::string>& choices) {
    std::string s;
    for (std::size_t i = 0; i < choices.size(); ++i) {
        if (i) s += i + 1 == choices.size() ? " or " : ", ";
        s += choices[i];
    }
    return s;
}

std::string lowercase(std::string_view text) {
    std::string result(text);
    std::transform(result.begin(), result.end(), result.begin(), lower);
    return result;
}

std::string extension_of(const std::string& path) {
    return lowercase(std::filesystem::path(path).extension().string());
}

std::string_view trimmed(std::string_view text) {
    constexpr std::string_view kBlanks = " \t\v\f\r\n";
    const std::size_t begin = text.find_first_not_of(kBlanks);
    if (begin == std::string_view::npos) return {};
    return text.substr(begin, text.find_last_not_of(kBlanks) - begin + 1);
}

namespace {

/// Libraries that run out of memory name the exception or the function that failed.
bool is_about_memory(std::string_view message) {
    constexpr std::array<std::string_view, 3> kWords = {"bad_alloc", "no memory for",
                                                        "allocate memory"};
    return std::any_of(kWords.begin(), kWords.end(),
                       [&](std::string_view words) { return message.find(words) != message.npos; });
}
constexpr const char* kNotEnoughMemory = "not enough memory";

}  // namespace

Problem problem_of_library(std::string_view text) {
    Problem problem;
    if (is_about_memory(text)) problem.kind = Problem::Kind::memory;
    problem.value = first_line(text);
    return problem;
}

std::string first_line(std::string_view text) {
    if (is_about_memory(text)) return kNotEnoughMemory;
    const std::size_t begin = text.find_first_not_of("\r\n ");
    if (begin == std::string_view::npos) return "unknown error";
    return std::string(text.substr(begin, text.find_first_of("\r\n", begin) - begin));
}

std::string one_line(std::string_view text, std::size_t longest) {
    if (is_about_memory(text)) return kNotEnoughMemory;
    std::string line;
    bool is_blank = false;
    for (std::size_t i = 0; i < text.size() && line.size() < longest;) {
        const char c = text[i];
        if (c == ' ' || (c >= '\t' && c <= '\r')) {
            is_blank = !line.empty();
            ++i;
            continue;
        }
        if (is_blank) line += ' ';
        is_blank = false;
        const std::size_t length = utf8_length(text.substr(i));
        if (length == 0) {
            line += '?';
            ++i;
        } else {
            line += text.substr(i, length);
            i += length;
        }
    }
    return text.size() > longest && line.size() >= longest ? line + "..." : line;
}

std::string utf8_text(std::string_view text) {
    std::string result;
    result.reserve(text.size());
    for (std::size_t i = 0; i < text.size();) {
        const std::size_t length = utf8_character(text.substr(i)).length;
        if (length == 0) {
            result += fmt::format("\\x{:02x}", static_cast<unsigned char>(text[i]));
        } else {
            result += text.substr(i, length);
        }
        i += std::max<std::size_t>(length, 1);
    }
    return result;
}

std::string printable(std::string_view text, std::size_t longest) {
    std::string result(text.substr(0, longest));
    for (char& c : result) {
        if (c < ' ' || c > '~') c = '?';
    }
    return result + (text.size() > longest ? "..." : "");
}

std::string content_hash(std::string_view contents) {
    std::uint32_t hash = 2166136261U;
    for (const char c : contents) {
        hash ^= static_cast<unsigned char>(c);
        hash *= 16777619U;
    }
    return fmt::format("{:08x}", hash);
}

std::string xml_escape(std::string_view text) {
    std::string out;
    for (const char c : text) {
        if (c == '&') {
            out += "&amp;";
        } else if (c == '<') {
            out += "&lt;";
        } else if (c == '>') {
            out += "&gt;";
        } else if (c == '"') {
            out += "&quot;";
        } else {
            out += c;
        }
    }
    return out;
}

TONEWRIGHT_NAMESPACE_END
