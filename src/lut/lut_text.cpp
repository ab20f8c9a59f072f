// SPDX-License-Identifier: Apache-2.0
//
// Formats: Adobe, "Cube LUT Specification 1.0" (2013); Blackmagic Design, DaVinci Resolve's own
// .cube; Academy S-2014-006 (CLF); SideFX, HDK, "Lookup Tables"; Rising Sun Research, cineSpace;
// the others as implemented in OpenColorIO.
#include "lut/lut_text.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cctype>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <limits>
#include <optional>
#include <utility>

#include "base/strings.h"
#include "tonewright/error.h"
#include "tonewright/lut.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

/// Limits of OpenColorIO.
constexpr int kLargestCube = 129;
constexpr int kLargestTable = 1048576;
/// Longest line in formats that OpenColorIO reads by line into a buffer of 4096.
constexpr std::size_t kLongestLine = 4000;

/// OpenColorIO 2.1 copies these words into buffers of 16 and 64 without a look at their length.
constexpr std::size_t kLongestDepth = 15;
constexpr std::size_t kLongestFrom = 63;

constexpr std::string_view kBlank = " \t\r\v\f";

/// Parses the whole text; overflow is infinite, underflow is 0.
std::optional<double> parse_number(std::string_view text) {
    if (text.size() > 1 && text.front() == '+' && text[1] != '-') text.remove_prefix(1);
    double value = 0;
    const auto r = std::from_chars(text.data(), text.data() + text.size(), value);
    if (text.empty() || r.ptr != text.data() + text.size()) return std::nullopt;
    if (r.ec == std::errc::result_out_of_range) {
        const std::size_t e = text.find_first_of("eE");
        const bool is_tiny = e != std::string_view::npos && text.substr(e + 1, 1) == "-";
        return is_tiny ? 0.0 : HUGE_VAL;
    }
    return r.ec == std::errc() ? std::optional(value) : std::nullopt;
}

bool is_float(double value) {
    return std::fabs(value) <= static_cast<double>(std::numeric_limits<float>::max());
}

/// The file, word by word or line by line.
class Text {
  public:
    Text(const std::string& path, std::string_view text) : path_(path), rest_(text) {}

    /// @return false at the end
    bool next_line() {
        if (rest_.empty()) return false;
        ++number_;
        const std::size_t end = rest_.find('\n');
        line_ = rest_.substr(0, end);
        rest_.remove_prefix(end == std::string_view::npos ? rest_.size() : end + 1);
        if (line_.find('\0') != std::string_view::npos)
            fail("the line holds bytes that are not text; expected a text file");
        words_ = line_;
        return true;
    }
    /// The next word of the line; empty at its end.
    std::string_view word() {
        const std::size_t begin = words_.find_first_not_of(kBlank);
        if (begin == std::string_view::npos) return {};
        words_.remove_prefix(begin);
        const std::string_view result = words_.substr(0, words_.find_first_of(kBlank));
        words_.remove_prefix(result.size());
        return result;
    }
    /// Before any of its words is taken.
    void rewind() { words_ = line_; }
    /// Moves to the first line that has a word and is no comment, before its first word.
    bool next_filled(bool has_comments = true) {
        while (next_line()) {
            const std::string_view first = word();
            rewind();
            if (!first.empty() && !(has_comments && first.front() == '#')) return true;
        }
        return false;
    }
    /// Text that OpenColorIO reads into its own buffer.
    void check_length() const {
        if (line_.size() > kLongestLine)
            fail(fmt::format("the line has {} characters; expected at most {}", line_.size(),
                             kLongestLine));
    }
    [[nodiscard]] std::string_view line() const { return line_; }

    /// Skips the line, whose first word is a keyword of an application. It may change the meaning
    /// of the table, so the user must know.
    void ignore_keyword(std::string_view keyword) {
        if (!note_.empty()) return;
        note_ =
            fmt::format("line {}: keyword {} is unknown and ignored", number_, printable(keyword));
    }
    /// One line about what was ignored; empty if nothing was.
    [[nodiscard]] const std::string& note() const { return note_; }

    [[nodiscard]] int line_number() const { return number_; }

    [[noreturn]] void fail(const std::string& reason) const { fail_at(number_, reason); }
    [[noreturn]] void fail_at(int line, const std::string& reason) const {
        throw FileError(fmt::format("read: {}: line {}: {}", path_, std::max(line, 1), reason));
    }
    /// "line 3: 0 0 x; expected three numbers".
    [[noreturn]] void refuse(const std::string& expected) const {
        const bool is_blank = line_.find_first_not_of(kBlank) == std::string_view::npos;
        fail((is_blank ? "the line is empty" : printable(trimmed(line_))) + "; expected " +
             expected);
    }
    /// "line 2: LUT_3D_SIZE is 1000; expected [2, 129]".
    [[noreturn]] void refuse(std::string_view name, std::string_view value,
                             const std::string& expected) const {
        fail(fmt::format("{} is {}; expected {}", printable(name),
                         value.empty() ? "missing" : printable(value), expected));
    }
    /// At the end of the file: "line 9: the file ends; expected 9 rows".
    [[noreturn]] void end(const std::string& expected) const {
        fail("the file ends; expected " + expected);
    }
    [[noreturn]] void end_early(std::size_t found, std::size_t expected) const {
        fail(fmt::format("the table ends after {} rows; expected {}", found, expected));
    }
    [[noreturn]] void too_many_rows(std::size_t expected) const {
        fail(fmt::format("the table has more than {0} rows; expected {0}", expected));
    }

    double number(std::string_view name, std::string_view text) const {
        const std::optional<double> value = parse_number(text);
        if (!value) refuse(name, text, "a number");
        if (!is_float(*value)) refuse(name, text, "a finite number");
        return *value;
    }
    int size(std::string_view name, std::string_view text, int lo, int hi) const {
        int value = 0;
        const auto r = std::from_chars(text.data(), text.data() + text.size(), value);
        const std::string expected = fmt::format("a whole number in [{}, {}]", lo, hi);
        if (r.ptr != text.data() + text.size() || r.ec != std::errc() || value < lo || value > hi)
            refuse(name, text, expected);
        return value;
    }
    /// Reads the rest of the line as this many finite numbers.
    std::array<float, 3> numbers(int count) {
        static constexpr std::array<const char*, 4> kNames = {"no", "one", "two", "three"};
        const std::string expected = fmt::format(
            "{} number{}", kNames[static_cast<std::size_t>(count)], count == 1 ? "" : "s");
        std::array<float, 3> values{};
        for (int i = 0; i < count; ++i) {
            const std::string_view text = word();
            if (text.empty()) refuse(expected);
            values[static_cast<std::size_t>(i)] = static_cast<float>(number("number", text));
        }
        if (!word().empty()) refuse(expected);
        return values;
    }

  private:
    const std::string& path_;
    std::string_view rest_;
    std::string_view line_;
    std::string_view words_;
    std::string note_;
    int number_ = 0;
};

bool begins_keyword(std::string_view word) {
    return std::isalpha(static_cast<unsigned char>(word.front())) != 0;
}

/// Three equal sizes of a 3D LUT.
int read_edge(Text& text) {
    int n = 0;
    for (int c = 0; c < 3; ++c) {
        const int size = text.size("size", text.word(), 2, kLargestCube);
        if (c > 0 && size != n) text.refuse("three equal sizes");
        n = size;
    }
    if (!text.word().empty()) text.refuse("three sizes");
    return n;
}

/// Rows of three numbers, as many as declared.
class Rows {
  public:
    void expect(std::size_t count) { expected_ += count; }
    [[nodiscard]] std::size_t found() const { return found_; }
    std::array<float, 3> add(Text& text) {
        if (expected_ == 0) text.refuse("a size before the first row");
        const std::array<float, 3> row = text.numbers(3);
        if (++found_ > expected_) text.too_many_rows(expected_);
        return row;
    }
    void finish(const Text& text) const {
        if (expected_ == 0) text.end("a size and as many rows");
        if (found_ < expected_) text.end_early(found_, expected_);
    }

  private:
    std::size_t expected_ = 0;
    std::size_t found_ = 0;
};

std::size_t cubed(int n) {
    const auto edge = static_cast<std::size_t>(n);
    return edge * edge * edge;
}

bool begins_number(std::string_view word) {
    return std::isdigit(static_cast<unsigned char>(word.front())) || word.front() == '-' ||
           word.front() == '+' || word.front() == '.' || lowercase(word) == "nan" ||
           lowercase(word) == "inf";
}

/// Keywords that are misspelled or not supported, and whose meaning would be lost.
bool is_known_to_others(std::string_view key) {
    return key.starts_with("lut_1d_") || key.starts_with("lut_2d_") || key.starts_with("lut_3d_") ||
           key.starts_with("domain_");
}

CubeText read_cube(Text& text) {
    CubeText result;
    Rows rows;
    std::vector<std::string> seen;
    std::array<double, 3> lo = {0, 0, 0};
    std::array<double, 3> hi = {1, 1, 1};
    int domain_line = 0;
    const auto has = [&](std::string_view key) {
        return std::find(seen.begin(), seen.end(), key) != seen.end();
    };
    while (text.next_filled()) {
        const std::string_view first = text.word();
        if (begins_number(first)) {
            text.rewind();
            const std::array<float, 3> row = rows.add(text);
            const bool is_of_table = rows.found() <= static_cast<std::size_t>(result.table.size);
            std::vector<float>& values = is_of_table ? result.table.rows : result.cube.rows;
            values.insert(values.end(), row.begin(), row.end());
            continue;
        }
        const std::string key = lowercase(first);
        if (rows.found() > 0) text.refuse("three numbers");
        if (key == "title") continue;
        if (has(key)) text.fail(std::string(first) + " appears twice; expected once");
        if (key == "lut_1d_size") {
            result.table.size = text.size(first, text.word(), 2, kLargestTable);
            rows.expect(static_cast<std::size_t>(result.table.size));
        } else if (key == "lut_3d_size") {
            result.cube.size = text.size(first, text.word(), 2, kLargestCube);
            rows.expect(cubed(result.cube.size));
        } else if (key == "domain_min" || key == "domain_max") {
            for (double& v : key == "domain_min" ? lo : hi)
                v = text.number(first, text.word());
            domain_line = text.line_number();
        } else if (key == "lut_1d_input_range" || key == "lut_3d_input_range") {
            CubeText::Table& table = key == "lut_1d_input_range" ? result.table : result.cube;
            table.lo.fill(text.number(first, text.word()));
            table.hi.fill(text.number(first, text.word()));
            if (!(table.lo[0] < table.hi[0])) text.refuse("the first number below the second");
        } else if (begins_keyword(first) && !is_known_to_others(key) && !has("lut_1d_size") &&
                   !has("lut_3d_size")) {
            // OpenColorIO and ffmpeg skip such lines there, and fail at them after the size.
            text.ignore_keyword(first);
            continue;
        } else {
            text.refuse("keyword", first,
                        "TITLE, LUT_1D_SIZE, LUT_3D_SIZE, DOMAIN_MIN, DOMAIN_MAX, "
                        "LUT_1D_INPUT_RANGE, LUT_3D_INPUT_RANGE or three numbers");
        }
        if (!text.word().empty()) text.refuse("no more on this line");
        seen.push_back(key);
        const bool is_adobe = has("domain_min") || has("domain_max");
        if (is_adobe && (has("lut_1d_input_range") || has("lut_3d_input_range")))
            text.refuse("DOMAIN_MIN and DOMAIN_MAX, or input ranges, not both");
        if (is_adobe && has("lut_1d_size") && has("lut_3d_size"))
            text.refuse("input ranges where there are two tables");
    }
    for (std::size_t c = 0; c < 3; ++c) {
        if (lo[c] < hi[c]) continue;
        text.fail_at(domain_line,
                     fmt::format("DOMAIN_MIN is {}, DOMAIN_MAX {}; expected DOMAIN_MIN "
                                 "below DOMAIN_MAX in each channel",
                                 fmt::join(lo, " "), fmt::join(hi, " ")));
    }
    if (domain_line > 0) {
        CubeText::Table& table = result.cube.size > 0 ? result.cube : result.table;
        table.lo = lo;
        table.hi = hi;
    }
    rows.finish(text);
    result.note = text.note();
    return result;
}

void check_cube(Text& text) { (void)read_cube(text); }

/// Triplets of a 3D LUT in the other order.
std::vector<float> red_fastest(const std::vector<float>& blue_fastest, int size) {
    const auto n = static_cast<std::size_t>(size);
    std::vector<float> turned(blue_fastest.size());
    for (std::size_t i = 0; i < n * n * n; ++i) {
        const std::size_t to = (i % n * n + i / n % n) * n + i / (n * n);
        std::copy_n(&blue_fastest[3 * i], 3, &turned[3 * to]);
    }
    return turned;
}

/// DaVinci's .dat, as ffmpeg reads it: a size (33 without one), then rows with blue fastest.
CubeText read_dat(Text& text) {
    CubeText result;
    if (!text.next_filled()) text.end("3DLUTSIZE or three numbers");
    result.cube.size = 33;
    const std::string_view first = text.word();
    if (first == "3DLUTSIZE") {
        result.cube.size = text.size(first, text.word(), 2, kLargestCube);
        if (!text.word().empty()) text.refuse("no more on this line");
        if (!text.next_filled()) text.end("three numbers");
    } else {
        text.rewind();
    }
    Rows rows;
    rows.expect(cubed(result.cube.size));
    std::vector<float> blue_fastest;
    do {
        const std::array<float, 3> row = rows.add(text);
        blue_fastest.insert(blue_fastest.end(), row.begin(), row.end());
    } while (text.next_filled());
    rows.finish(text);
    result.cube.rows = red_fastest(blue_fastest, result.cube.size);
    return result;
}

void check_dat(Text& text) { (void)read_dat(text); }

/// FilmLight's Truelight cube: values of the 1D LUT are positions in the 3D LUT, from 0 to N - 1.
void check_cub(Text& text) {
    if (!text.next_line() || !lowercase(text.line()).starts_with("# truelight cube"))
        text.refuse("# Truelight Cube v2.0");
    std::size_t lengths[2] = {0, 0};  // of the 1D and of the 3D LUT
    std::size_t found[2] = {0, 0};
    std::optional<std::size_t> section;
    while (text.next_line()) {
        const std::string_view first = text.word();
        if (first.empty()) continue;
        if (first.front() != '#') {
            if (!section) text.refuse("# InputLUT or # Cube before the first row");
            text.rewind();
            text.numbers(3);
            if (++found[*section] > lengths[*section]) text.too_many_rows(lengths[*section]);
            continue;
        }
        const std::string_view key = text.word();
        const std::string name = lowercase(key);
        if (name == "width") {
            if (lengths[1] > 0) text.fail("width appears twice; expected once");
            lengths[1] = cubed(read_edge(text));
        } else if (name == "lutlength") {
            if (lengths[0] > 0) text.fail("lutLength appears twice; expected once");
            lengths[0] = static_cast<std::size_t>(text.size(key, text.word(), 2, kLargestTable));
            if (!text.word().empty()) text.refuse("one size");
        } else if (name == "inputlut") {
            section = 0;
        } else if (name == "cube") {
            section = 1;
        } else if (name == "end") {
            break;
        }
    }
    for (const std::size_t i : {0, 1}) {
        if (found[i] < lengths[i]) text.end_early(found[i], lengths[i]);
    }
    if (lengths[0] + lengths[1] == 0) text.fail("the file has no table; expected # width");
}

/// Nuke's .vf: a 3D LUT with blue fastest.
void check_vf(Text& text) {
    if (!text.next_line() || !lowercase(text.line()).starts_with("#inventor"))
        text.refuse("#Inventor V2.1 ascii");
    Rows rows;
    bool has_size = false;
    bool is_open = false;
    while (text.next_filled()) {
        const std::string_view first = text.word();
        const std::string key = lowercase(first);
        if (is_open) {
            text.rewind();
            rows.add(text);
        } else if (key == "grid_size") {
            if (has_size) text.fail("grid_size appears twice; expected once");
            has_size = true;
            rows.expect(cubed(read_edge(text)));
        } else if (key == "global_transform") {
            for (int i = 0; i < 16; ++i)
                (void)text.number(first, text.word());
            if (!text.word().empty()) text.refuse("16 numbers");
        } else if (key == "data") {
            is_open = true;
        } else if (key == "element_size" || key == "world_origin") {
            continue;  // the same as global_transform, in parts
        } else if (begins_keyword(first)) {
            text.ignore_keyword(first);
        } else {
            text.refuse("keyword", first, "grid_size, global_transform or data");
        }
    }
    if (!is_open) text.end("data");
    rows.finish(text);
}

/// Pandora's .mga and .m3d: whole numbers, with blue fastest. OpenColorIO reads rows with an index
/// before the three numbers, ffmpeg rows without one.
CubeText read_pandora(Text& text) {
    constexpr int kLargest = 131071;  // twice the 16-bit range
    CubeText result;
    int largest = 0;
    bool is_open = false;
    while (!is_open && text.next_filled()) {
        const std::string_view first = text.word();
        const std::string key = lowercase(first);
        const auto value = [&](std::string_view wanted) {
            if (lowercase(text.word()) != wanted) text.refuse(fmt::format("{} {}", key, wanted));
        };
        if (key == "channel") {
            value("3d");
        } else if (key == "in") {
            const int nodes =
                text.size(first, text.word(), 8, kLargestCube * kLargestCube * kLargestCube);
            result.cube.size = static_cast<int>(std::lround(std::cbrt(nodes)));
            if (cubed(result.cube.size) != static_cast<std::size_t>(nodes))
                text.refuse("in and N x N x N, such as 4913 with N = 17");
        } else if (key == "out") {
            largest = text.size(first, text.word(), 2, 65536) - 1;
        } else if (key == "format") {
            value("lut");
        } else if (key == "values") {
            for (const char* channel : {"red", "green", "blue"})
                value(channel);
            is_open = true;
        } else {
            text.refuse("keyword", first, "channel, in, out, format or values");
        }
        if (!text.word().empty()) text.refuse("no more on this line");
    }
    if (!is_open) text.end("values red green blue");
    if (result.cube.size == 0 || largest == 0) text.refuse("in and out before values");
    const std::size_t expected = cubed(result.cube.size);
    std::vector<float> blue_fastest;
    std::size_t columns = 0;
    while (text.next_filled()) {
        std::vector<int> row;
        for (std::string_view word = text.word(); !word.empty() && row.size() < 5;
             word = text.word())
            row.push_back(text.size("number", word, -kLargest, std::numeric_limits<int>::max()));
        if (columns == 0) columns = row.size();
        if (row.size() != columns || columns < 3 || columns > 4)
            text.refuse("three numbers, or an index and three numbers");
        if (blue_fastest.size() == 3 * expected) text.too_many_rows(expected);
        for (std::size_t c = columns - 3; c < columns; ++c) {
            if (row[c] > kLargest) text.refuse(fmt::format("numbers of at most {}", kLargest));
            blue_fastest.push_back(static_cast<float>(row[c]) / static_cast<float>(largest));
        }
    }
    if (blue_fastest.size() < 3 * expected) text.end_early(blue_fastest.size() / 3, expected);
    result.cube.rows = red_fastest(blue_fastest, result.cube.size);
    return result;
}

void check_pandora(Text& text) { (void)read_pandora(text); }

/// Iridas .itx: a 3D LUT without a domain.
void check_itx(Text& text) {
    Rows rows;
    bool has_size = false;
    while (text.next_filled()) {
        const std::string_view first = text.word();
        if (begins_number(first)) {
            text.rewind();
            rows.add(text);
        } else if (lowercase(first) == "lut_3d_size" && rows.found() == 0) {
            rows.expect(cubed(text.size(first, text.word(), 2, kLargestCube)));
            has_size = true;
        } else if (!has_size && begins_keyword(first) && !is_known_to_others(lowercase(first))) {
            text.ignore_keyword(first);
        } else {
            text.refuse("LUT_3D_SIZE or three numbers");
        }
    }
    rows.finish(text);
}

/// OpenColorIO reads "Length9" like "Length 9".
bool begins_spi1d_keyword(std::string_view key) {
    return key.starts_with("Version") || key.starts_with("From") || key.starts_with("Length") ||
           key.starts_with("Components");
}

void check_spi1d(Text& text) {
    std::optional<int> length;
    std::optional<int> components;
    bool has_version = false;
    bool is_open = false;
    while (!is_open && text.next_filled()) {
        text.check_length();
        const std::string_view key = text.word();
        if (key == "Version") {
            has_version = text.size(key, text.word(), 1, 1) == 1;
        } else if (key == "From") {
            const double from = text.number(key, text.word());
            const double to = text.number(key, text.word());
            if (!(from < to)) text.refuse("the first number below the second");
        } else if (key == "Length") {
            length = text.size(key, text.word(), 2, kLargestTable);
        } else if (key == "Components") {
            components = text.size(key, text.word(), 1, 3);
        } else if (key == "{") {
            is_open = true;
        } else if (begins_keyword(key) && !begins_spi1d_keyword(key)) {
            text.ignore_keyword(key);
        } else {
            text.refuse("keyword", key, "Version, From, Length, Components or {");
        }
    }
    if (!has_version) text.fail("Version is missing; expected Version 1 before {");
    if (!length) text.fail("Length is missing; expected Length and a number before {");
    if (!components) text.fail("Components is missing; expected Components 1, 2 or 3 before {");
    if (!is_open) text.end("{");
    const auto expected = static_cast<std::size_t>(*length);
    std::size_t found = 0;
    while (text.next_filled(false)) {
        text.check_length();
        if (text.word() == "}") {
            if (found < expected) text.end_early(found, expected);
            return;
        }
        text.rewind();
        text.numbers(*components);
        if (++found > expected) text.too_many_rows(expected);
    }
    if (found < expected) text.end_early(found, expected);
    text.end("}");
}

void check_spi3d(Text& text) {
    if (!text.next_line() || !lowercase(text.line()).starts_with("spilut"))
        text.refuse("SPILUT 1.0");
    if (!text.next_line()) text.end("3 3");
    text.numbers(2);
    if (!text.next_line()) text.end("three sizes");
    const int n = read_edge(text);
    std::vector<bool> is_there(cubed(n));
    std::size_t found = 0;
    while (text.next_filled()) {
        text.check_length();
        std::size_t node = 0;
        for (int c = 0; c < 3; ++c) {
            node = node * static_cast<std::size_t>(n) +
                   static_cast<std::size_t>(text.size("index", text.word(), 0, n - 1));
        }
        text.numbers(3);
        if (is_there[node]) text.refuse("every node once");
        is_there[node] = true;
        ++found;
    }
    if (found < is_there.size()) text.end_early(found, is_there.size());
}

/// cineSpace: three preluts, then the table.
void check_csp(Text& text) {
    const auto next = [&](const char* expected) {
        if (!text.next_filled(false)) text.end(expected);
    };
    const auto only = [&](const char* expected) {
        if (!text.word().empty()) text.refuse(expected);
    };
    next("CSPLUTV100");
    if (lowercase(text.word()) != "csplutv100") text.refuse("CSPLUTV100");
    next("1D or 3D");
    const std::string kind = lowercase(text.word());
    if (kind != "1d" && kind != "3d") text.refuse("1D or 3D");
    next("a prelut");
    if (lowercase(text.line()).starts_with("begin metadata")) {
        do {
            if (!text.next_line()) text.end("END METADATA");
        } while (!lowercase(text.line()).starts_with("end metadata"));
        next("a prelut");
    }
    for (int c = 0; c < 3; ++c) {
        if (c > 0) next("a prelut");
        const int points = text.size("prelut's size", text.word(), 0, kLargestTable);
        only("one size");
        if (points < 2) continue;
        double last = -std::numeric_limits<double>::infinity();
        for (const bool is_input : {true, false}) {
            next("the numbers of a prelut");
            int found = 0;
            for (std::string_view word = text.word(); !word.empty(); word = text.word()) {
                const double value = text.number("number", word);
                if (is_input && !(value > last)) text.refuse("rising numbers");
                last = value;
                if (++found > points) break;
            }
            if (found != points)
                text.fail(fmt::format("the prelut has {} {} numbers; expected {}",
                                      found > points ? "more than" : "only",
                                      found > points ? points : found, points));
        }
    }
    next("the table's size");
    Rows rows;
    if (kind == "1d") {
        rows.expect(static_cast<std::size_t>(text.size("size", text.word(), 2, kLargestTable)));
    } else {
        int n = 0;
        for (int c = 0; c < 3; ++c) {
            const int size = text.size("size", text.word(), 2, kLargestCube);
            if (c > 0 && size != n) text.refuse("three equal sizes");
            n = size;
        }
        rows.expect(cubed(n));
    }
    only("the table's size");
    while (text.next_filled(false))
        rows.add(text);
    rows.finish(text);
}

/// Autodesk: rows of integers, and a line of more than three integers with the positions of the
/// nodes.
void check_3dl(Text& text) {
    std::size_t rows = 0;
    bool has_mesh = false;
    while (text.next_filled()) {
        text.check_length();
        std::size_t count = 0;
        const std::string_view first = text.word();
        if (!begins_number(first) || lowercase(first) == "3dmesh") {
            // "3DMESH", "Mesh 5 12", "LUT8", "gamma 1.0"
            const std::string key = lowercase(first);
            const bool is_depth = key.starts_with("lut") && key.size() <= 5 &&
                                  key.find_first_not_of("0123456789", 3) == std::string::npos;
            if (key == "3dmesh" || key == "mesh" || key == "gamma" || is_depth) continue;
            if (rows > 0 || has_mesh || !begins_keyword(first))
                text.refuse("keyword", first, "3DMESH, Mesh, gamma, LUT8 or three numbers");
            text.ignore_keyword(first);
            continue;
        }
        constexpr int kLargest = 131071;  // twice the 16-bit range
        for (std::string_view word = first; !word.empty(); word = text.word()) {
            (void)text.size("number", word, -kLargest, kLargest);
            ++count;
        }
        if (count > 3) {
            if (has_mesh || rows > 0) text.refuse("three numbers");
            has_mesh = true;
        } else {
            if (count != 3) text.refuse("three numbers");
            if (++rows > cubed(kLargestCube))
                text.fail(fmt::format("the table has more than {0} rows; expected at most {0}",
                                      cubed(kLargestCube)));
        }
    }
    const int n = static_cast<int>(std::lround(std::cbrt(static_cast<double>(rows))));
    if (n < 2 || cubed(n) != rows)
        text.fail(fmt::format(
            "the table ends after {} rows; expected N x N x N, such as 4913 with N = 17", rows));
}

/// Houdini, and Discreet's 1D tables with the same extension.
void check_lut(Text& text) {
    std::string type;
    std::vector<int> length;
    std::vector<std::string> keys;
    bool is_open = false;
    while (!is_open && text.next_filled()) {
        const std::string_view first = text.word();
        const std::string key = lowercase(first);
        if (key == "lut:" && keys.empty()) {
            const std::string_view count = text.word();
            if (count.empty()) text.refuse("Version, Format, Type ... before it");
            // Discreet: "LUT: 3 1024", then one number per line.
            const int tables = text.size("number of tables", count, 1, 4);
            const int entries = text.size("length", text.word(), 2, 65536);
            if (text.word().size() > kLongestDepth) text.refuse("a depth such as 16f");
            const auto expected =
                static_cast<std::size_t>(tables) * static_cast<std::size_t>(entries);
            std::size_t found = 0;
            while (text.next_filled()) {
                text.numbers(1);
                if (++found > expected) text.too_many_rows(expected);
            }
            if (found < expected) text.end_early(found, expected);
            return;
        }
        if (key == "lut:") {
            is_open = true;
            break;
        }
        if (key == "version" || key == "format" || key == "sampling") {
            if (text.word().empty()) text.refuse("a value");
        } else if (key == "type") {
            const std::string_view word = text.word();
            type = lowercase(word);
            if (type != "3d" && type != "3d+1d" && type != "c")
                text.refuse(first, word, "3D, 3D+1D or C");
        } else if (key == "from" || key == "to") {
            text.numbers(2);
        } else if (key == "black" || key == "white") {
            text.numbers(1);
        } else if (key == "length") {
            for (std::string_view word = text.word(); !word.empty(); word = text.word()) {
                if (length.size() == 2) text.refuse("one size or two");
                length.push_back(text.size(first, word, 2, kLargestTable));
            }
            if (length.empty()) text.refuse("one size or two");
        } else {
            text.refuse("keyword", first,
                        "Version, Format, Type, From, To, Black, White, Length or LUT:");
        }
        keys.push_back(key);
    }
    for (const char* key :
         {"Version", "Format", "Type", "From", "To", "Black", "White", "Length"}) {
        if (std::find(keys.begin(), keys.end(), lowercase(key)) == keys.end())
            text.fail(fmt::format("{} is missing; expected it before LUT:", key));
    }
    if (!is_open) text.end("LUT:");
    const bool is_cube = type != "c";
    if (is_cube && length[0] > kLargestCube)
        text.fail(fmt::format("Length is {}; expected [2, {}]", length[0], kLargestCube));
    const std::size_t sizes = type == "3d+1d" ? 2 : 1;
    if (length.size() != sizes)
        text.fail(fmt::format("number of sizes in Length is {}; expected {} with this Type",
                              length.size(), sizes));
    // Blocks: "Pre {", "3D {" or "{", "RGB {"; numbers; "}".
    std::string block;
    std::size_t found = 0;
    std::size_t expected = 0;
    std::vector<std::string> blocks;
    std::string name;
    const auto title_of = [](const std::string& id) {
        return id == "pre" ? "Pre" : id == "3d" ? "3D" : "RGB";
    };
    while (text.next_filled(false)) {
        for (std::string_view word = text.word(); !word.empty(); word = text.word()) {
            if (word == "{") {
                if (!block.empty()) text.refuse("} before {");
                block = name.empty() ? "3d" : name;
                name.clear();
                if (block != (is_cube ? "3d" : "rgb") && !(block == "pre" && length.size() == 2))
                    text.refuse(
                        "block", block,
                        length.size() == 2 ? "Pre or 3D" : title_of(is_cube ? "3d" : "rgb"));
                expected = block == "3d"    ? 3 * cubed(length[0])
                           : block == "pre" ? static_cast<std::size_t>(length[1])
                                            : static_cast<std::size_t>(length[0]);
                found = 0;
            } else if (word == "}") {
                if (block.empty()) text.refuse("{ before }");
                if (found != expected)
                    text.fail(fmt::format("block {} has {} numbers; expected {}", title_of(block),
                                          found, expected));
                blocks.push_back(block);
                block.clear();
            } else if (block.empty()) {
                if (!name.empty()) text.refuse("{");
                name = lowercase(word);
            } else {
                (void)text.number("number", word);
                if (++found > expected)
                    text.fail(fmt::format("block {0} has more than {1} numbers; expected {1}",
                                          title_of(block), expected));
            }
        }
    }
    if (!block.empty() || !name.empty()) text.end("}");
    for (const std::string& needed :
         is_cube ? std::vector<std::string>{"3d"} : std::vector<std::string>{"rgb"}) {
        if (std::find(blocks.begin(), blocks.end(), needed) == blocks.end())
            text.end(fmt::format("a block {}", title_of(needed)));
    }
    if (length.size() == 2 && std::find(blocks.begin(), blocks.end(), "pre") == blocks.end())
        text.end("a block Pre");
}

/// A 3 by 4 matrix.
void check_spimtx(Text& text) {
    constexpr int kNumbers = 12;
    int found = 0;
    while (text.next_line()) {
        for (std::string_view word = text.word(); !word.empty(); word = text.word()) {
            (void)text.number("number", word);
            if (++found > kNumbers)
                text.fail(
                    fmt::format("the file has more than {0} numbers; expected {0}", kNumbers));
        }
    }
    if (found < kNumbers)
        text.fail(fmt::format("the file ends after {} numbers; expected {}", found, kNumbers));
}

/// CLF, CTF and CC, which are XML: checks that elements nest and that arrays have their declared
/// size. OpenColorIO reports the line of all other errors. Names ignore case, as in OpenColorIO.
class XmlText {
  public:
    XmlText(const std::string& path, std::string_view text, std::string_view root)
        : path_(path), text_(text), root_(root) {}

    void check() {
        if (const std::size_t nul = text_.find('\0'); nul != std::string_view::npos) {
            advance(nul);
            fail("the line holds bytes that are not text; expected a text file");
        }
        const std::size_t first = text_.find_first_not_of(" \t\r\n");
        advance(first);
        if (text_[first] != '<')
            fail(printable(first_line(text_.substr(first, 100))) +
                 "; expected XML, which begins with <");
        bool has_root = false;
        for (std::size_t open = first; open != std::string_view::npos;
             open = text_.find('<', at_)) {
            advance(open);
            if (text_.substr(at_, 4) == "<!--") {
                skip_past("the comment", "-->");
            } else if (text_.substr(at_, 2) == "<?") {
                skip_past("the instruction", "?>");
            } else if (text_.substr(at_, 2) == "<!") {
                fail(printable(first_line(text_.substr(at_, 100))) +
                     "; expected no document type or entities");
            } else {
                const std::size_t end = end_of_tag();
                const std::string_view tag = text_.substr(at_ + 1, end - at_ - 1);
                if (!has_root && name_of(tag) != lowercase(root_))
                    fail(fmt::format("<{}> is the first element; expected {}",
                                     printable(title_of(tag)), root_));
                has_root = true;
                check_element(tag, end);
            }
        }
        advance(text_.size());
        if (!has_root) fail(fmt::format("the file ends; expected <{}>", root_));
        if (!open_.empty())
            fail(fmt::format("the file ends; expected </{}>", printable(open_.back().title)));
    }

  private:
    struct Element {
        std::string name;  // in lower case
        std::string title;
        bool is_half_domain = false;
    };
    static constexpr std::string_view kNameEnd = " \t\r\n/";
    static constexpr std::string_view kSpace = " \t\r\n";
    static constexpr std::size_t kDeepest = 32;

    [[noreturn]] void fail(const std::string& reason) const {
        throw FileError(fmt::format("read: {}: line {}: {}", path_, line_, reason));
    }
    void advance(std::size_t to) {
        line_ +=
            static_cast<int>(std::count(text_.begin() + static_cast<std::ptrdiff_t>(at_),
                                        text_.begin() + static_cast<std::ptrdiff_t>(to), '\n'));
        at_ = to;
    }
    void skip_past(const char* what, std::string_view end_mark) {
        const std::size_t end = text_.find(end_mark, at_);
        if (end == std::string_view::npos)
            fail(fmt::format("{} does not close; expected {}", what, end_mark));
        advance(end + end_mark.size());
    }
    /// Position of the tag's >, outside quotation marks.
    [[nodiscard]] std::size_t end_of_tag() const {
        char quote = 0;
        for (std::size_t i = at_ + 1; i < text_.size(); ++i) {
            const char c = text_[i];
            if (quote != 0) {
                if (c == quote) quote = 0;
            } else if (c == '"' || c == '\'') {
                quote = c;
            } else if (c == '>') {
                return i;
            } else if (c == '<') {
                break;
            }
        }
        fail("the tag does not close; expected >");
    }
    static std::string_view title_of(std::string_view tag) {
        return tag.substr(0, tag.find_first_of(kNameEnd));
    }
    static std::string name_of(std::string_view tag) { return lowercase(title_of(tag)); }
    /// Value of the attribute with exactly this name.
    [[nodiscard]] std::optional<std::string_view> attribute(std::string_view tag,
                                                            std::string_view name) const {
        tag.remove_prefix(std::min(tag.find_first_of(kNameEnd), tag.size()));
        while (true) {
            const std::size_t begin = tag.find_first_not_of(kNameEnd);
            if (begin == std::string_view::npos) return std::nullopt;
            tag.remove_prefix(begin);
            const std::size_t end = tag.find_first_of(" \t\r\n=");
            const std::size_t open = tag.find_first_not_of(" \t\r\n=", end);
            if (open == std::string_view::npos || (tag[open] != '"' && tag[open] != '\''))
                fail(printable(tag) + "; expected attributes such as dim=\"...\"");
            const std::size_t close = tag.find(tag[open], open + 1);
            if (close == std::string_view::npos)
                fail("the attribute does not close; expected a quotation mark");
            if (lowercase(tag.substr(0, end)) == name)
                return tag.substr(open + 1, close - open - 1);
            tag.remove_prefix(close + 1);
        }
    }

    void check_element(std::string_view tag, std::size_t end) {
        if (tag.starts_with('/')) {
            tag.remove_prefix(1);
            if (open_.empty() || name_of(tag) != open_.back().name)
                fail(fmt::format("</{}> closes no element; expected {}", printable(tag),
                                 open_.empty() ? "nothing after the document"
                                               : "</" + printable(open_.back().title) + ">"));
            open_.pop_back();
            advance(end + 1);
            return;
        }
        const std::string name = name_of(tag);
        // OpenColorIO would read any file named there.
        if (name == "reference") fail("Reference is not supported; expected the transform itself");
        const Element parent = open_.empty() ? Element() : open_.back();
        const bool is_closed = tag.ends_with('/');
        if (!is_closed) {
            if (open_.size() == kDeepest)
                fail(
                    fmt::format("elements are more than {0} deep; expected at most {0}", kDeepest));
            const std::string_view is_half = attribute(tag, "halfdomain").value_or("");
            open_.push_back({name, std::string(title_of(tag)), lowercase(is_half) == "true"});
        }
        std::size_t count = 0;
        if (name == "array") count = declared(sizes_of(tag, "Array"), parent);
        if (name == "indexmap") {
            const std::vector<int> sizes = sizes_of(tag, "IndexMap");
            count = static_cast<std::size_t>(sizes[0]);
        }
        advance(end + 1);
        if (name == "array") check_array(count, parent.is_half_domain, is_closed);
        if (!is_closed && holds_numbers(name)) check_numbers(tag.substr(0, name.size()));
        if (name == "indexmap") {
            const std::string_view body =
                is_closed ? "" : text_.substr(at_, text_.find('<', at_) - at_);
            const auto found = static_cast<std::size_t>(std::count(body.begin(), body.end(), '@'));
            if (found != count)
                fail(fmt::format("IndexMap has {} entries; expected {}", found, count));
        }
    }

    /// Elements of color corrections and ranges, which OpenColorIO parses as floats.
    static bool holds_numbers(std::string_view name) {
        static constexpr std::array<std::string_view, 8> kNames = {
            "slope",      "offset",     "power",       "saturation",
            "mininvalue", "maxinvalue", "minoutvalue", "maxoutvalue"};
        return std::find(kNames.begin(), kNames.end(), name) != kNames.end();
    }
    /// Checks the element that has just begun. OpenColorIO refuses text that is no number.
    void check_numbers(std::string_view element) const {
        std::string_view body = text_.substr(at_, text_.find('<', at_) - at_);
        while (true) {
            body.remove_prefix(std::min(body.find_first_not_of(kSpace), body.size()));
            if (body.empty()) return;
            const std::string_view word = body.substr(0, body.find_first_of(kSpace));
            body.remove_prefix(word.size());
            const std::optional<double> value = parse_number(word);
            if (value && !is_float(*value))
                fail(fmt::format("{} is {}; expected a finite number", printable(element),
                                 printable(word)));
        }
    }

    /// Numbers of dim: one to four, none above the largest table.
    [[nodiscard]] std::vector<int> sizes_of(std::string_view tag, const char* element) const {
        const std::optional<std::string_view> dim = attribute(tag, "dim");
        if (!dim) fail(fmt::format("{} has no dim; expected dim=\"...\"", element));
        std::vector<int> sizes;
        for (std::size_t i = 0; i < dim->size();) {
            if (kSpace.find((*dim)[i]) != std::string_view::npos) {
                ++i;
                continue;
            }
            int value = 0;
            const auto r = std::from_chars(dim->data() + i, dim->data() + dim->size(), value);
            if (r.ec != std::errc() || value < 1 || sizes.size() == 4)
                refuse(*dim, "one to four whole numbers above 0");
            if (value > kLargestTable)
                refuse(*dim, fmt::format("numbers of at most {}", kLargestTable));
            sizes.push_back(value);
            i = static_cast<std::size_t>(r.ptr - dim->data());
        }
        if (sizes.empty()) refuse(*dim, "one to four whole numbers above 0");
        return sizes;
    }
    /// Declared count of numbers of an Array.
    [[nodiscard]] std::size_t declared(const std::vector<int>& sizes,
                                       const Element& element) const {
        const std::string& parent = element.name;
        const std::string dim = fmt::format("{}", fmt::join(sizes, " "));
        if (parent == "lut3d" || parent == "inverselut3d") {
            const bool is_cube = sizes.size() == 4 && sizes[0] == sizes[1] &&
                                 sizes[0] == sizes[2] && sizes[3] == 3 && sizes[0] >= 2 &&
                                 sizes[0] <= kLargestCube;
            if (!is_cube) refuse(dim, fmt::format("N N N 3 with N in [2, {}]", kLargestCube));
            return 3 * cubed(sizes[0]);
        }
        if (parent == "lut1d" || parent == "inverselut1d") {
            if (sizes.size() != 2 || sizes[0] < 2 || (sizes[1] != 1 && sizes[1] != 3))
                refuse(dim, fmt::format("N 1 or N 3 with N in [2, {}]", kLargestTable));
        } else if (parent == "matrix") {
            if (sizes.size() < 2 || sizes.size() > 3 || sizes[0] > 4 || sizes[1] > 5)
                refuse(dim, "a matrix's, such as 3 3");
        } else {
            fail(fmt::format(
                "Array is inside {}; expected LUT1D, LUT3D, InverseLUT1D, InverseLUT3D or Matrix",
                parent.empty() ? "no element" : printable(element.title)));
        }
        return static_cast<std::size_t>(sizes[0]) * static_cast<std::size_t>(sizes[1]);
    }
    [[noreturn]] void refuse(std::string_view dim, const std::string& expected) const {
        fail("dim is " + (dim.empty() ? "empty" : printable(dim)) + "; expected " + expected);
    }

    void check_array(std::size_t expected, bool is_half_domain, bool is_closed) {
        std::size_t found = 0;
        while (!is_closed && at_ < text_.size() && text_[at_] != '<') {
            if (text_[at_] == '\n') ++line_;
            if (kSpace.find(text_[at_]) != std::string_view::npos) {
                ++at_;
                continue;
            }
            const std::size_t end = std::min(text_.find_first_of(" \t\r\n<", at_), text_.size());
            check_number(text_.substr(at_, end - at_), is_half_domain);
            at_ = end;
            if (++found > expected)
                fail(fmt::format("the Array has more than {0} numbers; expected {0}", expected));
        }
        if (found != expected)
            fail(fmt::format("the Array has {} numbers; expected {}", found, expected));
    }
    void check_number(std::string_view text, bool is_half_domain) const {
        const std::optional<double> value = parse_number(text);
        if (!value) fail("number is " + printable(text) + "; expected a number");
        // Some entries of a half-domain table belong to infinities and NaN.
        if (!is_float(*value) && !is_half_domain)
            fail("number is " + printable(text) + "; expected a finite number");
    }

    const std::string& path_;
    std::string_view text_;
    std::string_view root_;
    std::vector<Element> open_;
    std::size_t at_ = 0;
    int line_ = 1;
};

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

/// The contents of the only element of this name.
std::string_view element_of(const Text& text, std::string_view xml, const std::string& name) {
    const std::string begin_tag = "<" + name + ">";
    const std::string end_tag = "</" + name + ">";
    const std::size_t begin = xml.find(begin_tag);
    const std::size_t end = xml.find(end_tag);
    if (begin == std::string_view::npos || end == std::string_view::npos || end < begin)
        text.fail(fmt::format("{} is missing; expected it in LUT", begin_tag));
    if (xml.find(begin_tag, begin + 1) != std::string_view::npos)
        text.fail(fmt::format("{} appears twice; expected once", begin_tag));
    return xml.substr(begin + begin_tag.size(), end - begin - begin_tag.size());
}

std::string without_quotes_and_blanks(std::string_view text) {
    std::string kept(text);
    std::erase_if(kept,
                  [](char c) { return c == '"' || kBlank.find(c) != kBlank.npos || c == '\n'; });
    return kept;
}

/// Iridas .look: the 3D LUT as hexadecimal digits of little-endian floats, with red fastest.
CubeText read_look(const std::string& path, std::string_view xml) {
    XmlText(path, xml, "look").check();
    Text text(path, xml);
    const std::string_view lut = element_of(text, xml, "LUT");
    if (xml.find("<mask>") != std::string_view::npos &&
        !without_quotes_and_blanks(element_of(text, xml, "mask")).empty())
        text.fail("it has a mask; expected a look of the whole picture");
    CubeText result;
    result.cube.size = text.size("size", without_quotes_and_blanks(element_of(text, lut, "size")),
                                 2, kLargestCube);
    const std::string digits = without_quotes_and_blanks(element_of(text, lut, "data"));
    constexpr std::size_t kDigitsOfColor = 24;
    const std::size_t expected = kDigitsOfColor * cubed(result.cube.size);
    if (digits.size() != expected)
        text.fail(fmt::format("data has {} digits; expected {}", digits.size(), expected));
    for (std::size_t at = 0; at < digits.size(); at += 8) {
        std::uint32_t bits = 0;
        for (std::size_t byte = 4; byte-- > 0;) {
            std::uint32_t value = 0;
            const char* const first = digits.data() + at + 2 * byte;
            if (std::from_chars(first, first + 2, value, 16).ptr != first + 2)
                text.fail("data is " + printable(digits.substr(at, 8)) +
                          "; expected hexadecimal digits");
            bits = bits << 8U | value;
        }
        const float value = std::bit_cast<float>(bits);
        if (!std::isfinite(value))
            text.fail("data has a number that is not finite; expected finite ones");
        result.cube.rows.push_back(value);
    }
    return result;
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
void check_for_other_readers(Text& text, std::string_view bytes, bool is_own_mark) {
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

Text begin(const std::string& path, std::string_view text) {
    Text lines(path, text);
    if (text.find_first_not_of(" \t\r\n") == std::string_view::npos)
        lines.fail("the file is empty; expected a LUT");
    return lines;
}

struct Format {
    const char* extension;
    void (*check)(Text& text);
    const char* root = nullptr;  // of XML, which has no function
};

constexpr Format kFormats[] = {
    {".cube", check_cube},
    {".clf", nullptr, "ProcessList"},
    {".ctf", nullptr, "ProcessList"},
    {".spi1d", check_spi1d},
    {".spi3d", check_spi3d},
    {".csp", check_csp},
    {".3dl", check_3dl},
    {".lut", check_lut},
    {".itx", check_itx},
    {".spimtx", check_spimtx},
    {".cub", check_cub},
    {".vf", check_vf},
    {".mga", check_pandora},
    {".m3d", check_pandora},
    {".dat", check_dat},
    {".look", nullptr, "look"},
    {".cc", nullptr, "ColorCorrection"},
};

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
    for (const Format& format : kFormats) {
        if (extension != format.extension) continue;
        Text lines = begin(path, text);
        if (format.check) {
            format.check(lines);
        } else {
            XmlText(path, text, format.root).check();
        }
        Text again = begin(path, text);
        check_for_other_readers(again, text, extension == ".cub" || extension == ".vf");
        return lines.note();
    }
    throw FileError(fmt::format("read: {}: extension is {}; expected {}", path,
                                extension.empty() ? "missing" : extension,
                                join_choices(lut_text_extensions())));
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
    return extension == ".cube" || extension == ".dat" || extension == ".mga" ||
           extension == ".m3d" || extension == ".look";
}

CubeText parse_cube(const std::string& path, std::string_view text) {
    Text lines = begin(path, without_byte_order_mark(text));
    const std::string extension = extension_of(path);
    if (extension == ".look") return read_look(path, without_byte_order_mark(text));
    if (extension == ".dat") return read_dat(lines);
    return extension == ".cube" ? read_cube(lines) : read_pandora(lines);
}

TONEWRIGHT_NAMESPACE_END
