// SPDX-License-Identifier: Apache-2.0
#include "plot/terminal_plot.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <string_view>

#include "plot/gray_curve.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

constexpr int kColumns = 73;
constexpr int kRows = 16;  // 0.2 of the code values are three rows
constexpr int kLowest = -10;
constexpr int kHighest = 10;

int column_of(double stops) {
    return static_cast<int>(std::lround((stops - kLowest) / (kHighest - kLowest) * (kColumns - 1)));
}

/// Dots; a character has several.
class Dots {
  public:
    explicit Dots(TerminalText text)
        : text_(text),
          across_(text == TerminalText::utf8 ? 2 : 1),
          down_(text == TerminalText::utf8 ? 4 : 1),
          curve_(static_cast<std::size_t>(width() * height())),
          marks_(curve_) {}

    [[nodiscard]] int width() const { return kColumns * across_; }
    [[nodiscard]] int height() const { return kRows * down_; }

    /// A line from the dot of `before` to that of `value`, which are display code values.
    void add_curve(int x, double before, double value) {
        const auto [top, bottom] = std::minmax({row_of(before), row_of(value)});
        // The dots between belong to the steeper neighbor.
        for (int y = top; y <= bottom; ++y)
            curve_[index(x, y)] = true;
    }
    void add_mark(double stops) {
        for (int y = 0; y < height(); y += 2)
            marks_[index(column_of(stops) * across_, y)] = true;
    }

    [[nodiscard]] std::string character(int column, int row) const {
        if (text_ == TerminalText::ascii) {
            const std::size_t i = index(column, row);
            return curve_[i] ? "*" : is_marked(column) ? ":" : " ";
        }
        // Unicode's Braille patterns: bits in the order in which the dots are numbered.
        constexpr unsigned kBits[4][2] = {{0x01, 0x08}, {0x02, 0x10}, {0x04, 0x20}, {0x40, 0x80}};
        unsigned pattern = 0;
        for (int y = 0; y < down_; ++y) {
            for (int x = 0; x < across_; ++x) {
                const std::size_t i = index(column * across_ + x, row * down_ + y);
                if (curve_[i] || marks_[i]) pattern |= kBits[y][x];
            }
        }
        if (pattern == 0) return " ";
        const unsigned code = 0x2800 + pattern;
        return {static_cast<char>(0xE0U | (code >> 12U)),
                static_cast<char>(0x80U | ((code >> 6U) & 0x3FU)),
                static_cast<char>(0x80U | (code & 0x3FU))};
    }

  private:
    [[nodiscard]] std::size_t index(int x, int y) const {
        return static_cast<std::size_t>(y) * static_cast<std::size_t>(width()) +
               static_cast<std::size_t>(x);
    }
    [[nodiscard]] bool is_marked(int column) const { return marks_[index(column, 0)]; }
    [[nodiscard]] int row_of(double value) const {
        const double shown = std::clamp(value, 0.0, 1.0);
        return static_cast<int>(std::lround((1 - shown) * (height() - 1)));
    }

    TerminalText text_;
    int across_, down_;
    std::vector<bool> curve_, marks_;
};

/// Puts words into a line of blanks.
void put(std::string& line, int at, std::string_view words) {
    if (at < 0 || static_cast<std::size_t>(at) >= line.size()) return;
    line.replace(static_cast<std::size_t>(at), words.size(), words);
}

std::string without_blanks_behind(std::string line) {
    line.erase(line.find_last_not_of(' ') + 1);
    return line + "\n";
}

}  // namespace

TerminalText terminal_text() {
    // In the order in which setlocale() reads them, without the need of an installed locale.
    for (const char* name : {"LC_ALL", "LC_CTYPE", "LANG"}) {
        const char* const value = std::getenv(name);
        if (!value || !*value) continue;
        std::string lower = value;
        for (char& c : lower)
            c = c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
        const bool is_utf8 =
            lower.find("utf-8") != std::string::npos || lower.find("utf8") != std::string::npos;
        return is_utf8 ? TerminalText::utf8 : TerminalText::ascii;
    }
    return TerminalText::ascii;
}

std::string terminal_plot(
    const std::function<std::vector<double>(const std::vector<double>&)>& curve,
    const std::vector<double>& places, TerminalText text) {
    const bool is_utf8 = text == TerminalText::utf8;
    const double white = std::log2(1 / kMidGray);
    Dots dots(text);
    std::vector<double> stops;
    stops.reserve(static_cast<std::size_t>(dots.width()));
    for (int x = 0; x < dots.width(); ++x)
        stops.push_back(kLowest + static_cast<double>(kHighest - kLowest) * x / (dots.width() - 1));
    const std::vector<double> values = curve(scene_of(stops));
    for (int x = 0; x < dots.width(); ++x) {
        const auto i = static_cast<std::size_t>(x);
        const double before = x == 0 ? values[0] : (values[i - 1] + values[i]) / 2;
        dots.add_curve(x, before, values[i]);
        if (x > 0) dots.add_curve(x - 1, values[i - 1], before);
    }
    dots.add_mark(0);
    dots.add_mark(white);

    const std::vector<double> shown = curve({kMidGray, 1});
    constexpr int kGutter = 5;
    std::string heading(kGutter + kColumns + 1, ' ');
    const std::string gray = fmt::format("mid gray {:.3f}", shown[0]);
    put(heading, kGutter + column_of(0) - static_cast<int>(gray.size()), gray);
    put(heading, kGutter + column_of(white) + 1, fmt::format("white {:.3f}", shown[1]));
    std::string result = without_blanks_behind(heading);

    for (int row = 0; row < kRows; ++row) {
        const bool has_number = row % 3 == 0;
        std::string line = has_number ? fmt::format("{:>3.1f} ", 1 - row / 15.0) : "    ";
        line += is_utf8 ? (has_number ? "\u2524" : "\u2502") : (has_number ? "+" : "|");
        for (int column = 0; column < kColumns; ++column)
            line += dots.character(column, row);
        result += without_blanks_behind(line);
    }

    std::string axis = is_utf8 ? "    \u2514" : "    +";
    std::string numbers(kGutter + kColumns + 1, ' ');
    for (int column = 0; column < kColumns; ++column) {
        bool is_place = false;
        for (const double x : places)
            is_place = is_place || (x > 0 && column_of(std::log2(x / kMidGray)) == column);
        bool is_tick = false;
        for (int s = kLowest; s <= kHighest; s += 2) {
            if (column_of(s) != column) continue;
            is_tick = true;
            const std::string number = fmt::format("{:+d}", s);
            put(numbers, kGutter + column - static_cast<int>(number.size()) / 2,
                s == 0 ? "0" : number);
        }
        axis += is_place ? "!" : is_utf8 ? (is_tick ? "\u252C" : "\u2500") : (is_tick ? "+" : "-");
    }
    result += axis + "\n" + without_blanks_behind(numbers);
    return result + "     sRGB code value of gray, over stops from mid gray" +
           (places.empty() ? "" : "; ! where a law breaks") + "\n";
}

TONEWRIGHT_NAMESPACE_END
