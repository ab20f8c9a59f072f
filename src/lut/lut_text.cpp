// SPDX-License-Identifier: Apache-2.0
#include "lut/lut_text.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>

#include "base/strings.h"
#include "lut/formats/formats.h"
#include "lut/formats/text_lines.h"
#include "tonewright/error.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

/// OpenColorIO 2.1 copies these words into a buffer of 64 without a look at their length.
constexpr std::size_t kLongestFrom = 63;

/// Removes blanks and a whole number from the beginning, like scanf's %d.
bool skip_integer(std::string_view& text) {
    text.remove_prefix(std::min(text.find_first_not_of(kBlank), text.size()));
    if (text.starts_with('-') || text.starts_with('+')) text.remove_prefix(1);
    const std::size_t digits = std::min(text.find_first_not_of("0123456789"), text.size());
    text.remove_prefix(digits);
    return digits > 0;
}

std::size_t length_of_word(std::string_view& text) {
    text.remove_prefix(std::min(text.find_first_not_of(kBlank), text.size()));
    const std::size_t length = std::min(text.find_first_of(kBlank), text.size());
    text.remove_prefix(length);
    return length;
}

/// Words that OpenColorIO's readers of .spi1d and of Discreet's tables copy into small buffers.
/// @param is_first  the first line that is neither blank nor a comment
/// @returns  what is wrong; empty if nothing is
std::string overlong_word(std::string_view line, bool is_first) {
    line = trimmed(line);
    if (line.starts_with("From")) {
        std::string_view rest = line.substr(4);
        if (length_of_word(rest) > kLongestFrom || length_of_word(rest) > kLongestFrom)
            return fmt::format("a word after From is long; expected at most {} characters",
                               kLongestFrom);
    }
    if (!is_first) return "";
    (void)length_of_word(line);
    if (skip_integer(line) && skip_integer(line) && length_of_word(line) > kLongestDepth)
        return fmt::format("a word after two sizes is long; expected at most {} characters",
                           kLongestDepth);
    return "";
}

/// If OpenColorIO's reader of a format fails, it tries all others. None of them may find a size to
/// allocate in free text (comments, metadata, descriptions).
/// @param is_own_mark  the first line belongs to the format of the extension
void check_for_other_readers(TextLines& text, std::string_view bytes, bool is_own_mark) {
    struct Size {
        std::string_view name;
        int largest;
    };
    static constexpr Size kSizes[] = {
        {"lut_3d_size", kLargestCube},
        {"lut_1d_size", kLargestTable},
        {"length", kLargestTable},                           // spi1d
        {"in", kLargestCube * kLargestCube * kLargestCube},  // Pandora
    };
    const bool is_first = text.next_line();
    const std::string first = lowercase(text.line());
    if (is_first && !is_own_mark &&
        (first.starts_with("# truelight") || first.starts_with("#inventor")))
        text.refuse("no Truelight cube, and no Nuke .vf");
    bool has_words = false;
    if (bytes.substr(std::min<std::size_t>(36, bytes.size()), 4) == "acsp")
        text.fail("the file has the signature of an ICC profile; expected text");
    do {
        const std::string line = lowercase(text.word().substr(0, 64));
        const bool is_filled = !line.empty() && line.front() != '#';
        const std::string fault = overlong_word(text.line(), is_filled && !has_words);
        if (!fault.empty()) text.fail(fault);
        has_words = has_words || is_filled;
        const Size* size = std::find_if(std::begin(kSizes), std::end(kSizes),
                                        [&](const Size& s) { return line.starts_with(s.name); });
        if (size == std::end(kSizes)) continue;
        std::string_view word = std::string_view(line).substr(size->name.size());
        const std::string next(text.word());
        if (word.empty()) word = next;
        if (word.starts_with('+')) word.remove_prefix(1);
        long value = 0;
        const auto r = std::from_chars(word.data(), word.data() + word.size(), value);
        const bool is_too_large = r.ec == std::errc::result_out_of_range;
        if (is_too_large || (r.ec == std::errc() && (value < 0 || value > size->largest)))
            text.refuse(fmt::format("no size of another format above {}", size->largest));
    } while (text.next_line());
}

/// Editors on Windows write it, and OpenColorIO's readers trip over it.
std::string_view without_byte_order_mark(std::string_view text) {
    constexpr std::string_view kMark = "\xEF\xBB\xBF";
    return text.starts_with(kMark) ? text.substr(kMark.size()) : text;
}

TextLines begin(const std::string& path, std::string_view text) {
    TextLines lines(path, text);
    if (text.find_first_not_of(" \t\r\n") == std::string_view::npos)
        lines.fail("the file is empty; expected a LUT");
    return lines;
}

struct Format {
    const char* extension;
    /// One of them.
    void (*check)(TextLines& text);
    CubeText (*read)(TextLines& text) = nullptr;
};

constexpr Format kFormats[] = {
    {".cube", nullptr, read_cube},
    {".clf", check_clf},
    {".ctf", check_clf},
    {".spi1d", check_spi1d},
    {".spi3d", check_spi3d},
    {".csp", check_csp},
    {".3dl", check_3dl},
    {".lut", check_lut},
    {".itx", check_itx},
    {".spimtx", check_spimtx},
    {".cub", check_cub},
    {".vf", check_vf},
    {".mga", nullptr, read_pandora},
    {".m3d", nullptr, read_pandora},
    {".dat", nullptr, read_dat},
    {".look", nullptr, read_look},
    {".cc", check_cc},
};

/// Null: there is none.
const Format* format_of(const std::string& extension) {
    const Format* const found =
        std::find_if(std::begin(kFormats), std::end(kFormats),
                     [&](const Format& format) { return extension == format.extension; });
    return found == std::end(kFormats) ? nullptr : found;
}

}  // namespace

const std::vector<std::string>& lut_text_extensions() {
    static const std::vector<std::string> extensions = [] {
        std::vector<std::string> all;
        for (const Format& format : kFormats)
            all.emplace_back(format.extension);
        return all;
    }();
    return extensions;
}

std::string check_lut_text(const std::string& path, std::string& bytes) {
    const std::string_view text =
        bytes.erase(0, bytes.size() - without_byte_order_mark(bytes).size());
    const std::string extension = extension_of(path);
    const Format* const format = format_of(extension);
    if (!format) {
        throw FileError(fmt::format("read: {}: extension is {}; expected {}", path,
                                    extension.empty() ? "missing" : extension,
                                    join_choices(lut_text_extensions())));
    }
    TextLines lines = begin(path, text);
    if (format->check) {
        format->check(lines);
    } else {
        (void)format->read(lines);
    }
    TextLines again = begin(path, text);
    check_for_other_readers(again, text, extension == ".cub" || extension == ".vf");
    return lines.note();
}

void check_lut_words(const std::string& path, std::string_view bytes) {
    bool has_words = false;
    for (int number = 1; !bytes.empty(); ++number) {
        const std::size_t end = std::min(bytes.find('\n'), bytes.size() - 1);
        const std::string_view line = trimmed(bytes.substr(0, end + 1));
        bytes.remove_prefix(end + 1);
        const bool is_filled = !line.empty() && line.front() != '#';
        const std::string fault = overlong_word(line, is_filled && !has_words);
        if (!fault.empty())
            throw FileError(fmt::format("read: {}: line {}: {}", path, number, fault));
        has_words = has_words || is_filled;
    }
}

bool is_parsed_here(const std::string& extension) {
    const Format* const format = format_of(extension);
    return format && format->read;
}

CubeText parse_cube(const std::string& path, std::string_view text) {
    TextLines lines = begin(path, without_byte_order_mark(text));
    return format_of(extension_of(path))->read(lines);
}

TONEWRIGHT_NAMESPACE_END
