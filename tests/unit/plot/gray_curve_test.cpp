// SPDX-License-Identifier: Apache-2.0
#include "plot/gray_curve.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <sstream>
#include <string>
#include <vector>

#include "plot/terminal_plot.h"
#include "tonewright/registry.h"

namespace tonewright {
namespace {

TEST(GrayCurve, StopsAreFactorsOfMidGray) {
    EXPECT_EQ(scene_of({0, 1, -2}), (std::vector<double>{0.18, 0.36, 0.045}));
}

TEST(GrayCurve, ClampShowsTheEncodedValue) {
    const View view = make_view(resolve_operator("clamp"), "lin_rec709", 0, "srgb");
    EXPECT_NEAR(gray_code(view, 0.18), 0.46135613, 1e-7);  // IEC 61966-2-1
    EXPECT_NEAR(gray_code(view, 2), 1, 1e-12);
}

TEST(GrayCurve, EqualLinesShareALabel) {
    std::vector<PlotLine> lines;
    add_line(lines, {"a", "A", "#000", 1, {}, {0, 0.5}}, "A");
    add_line(lines, {"b", "B long", "#000", 1, {}, {0, 0.5004}}, "B");
    add_line(lines, {"c", "C", "#000", 1, {}, {0, 0.6}}, "C");
    ASSERT_EQ(lines.size(), 2);
    EXPECT_EQ(lines[0].label, "A, B");
}

std::vector<std::string> lines_of(const std::string& text) {
    std::istringstream stream(text);
    std::vector<std::string> lines;
    for (std::string line; std::getline(stream, line);)
        lines.push_back(line);
    return lines;
}

TEST(TerminalPlot, FitsIntoATerminalAndMarksPlaces) {
    const auto half = [](const std::vector<double>& x) { return std::vector(x.size(), 0.6); };
    const std::vector<std::string> lines =
        lines_of(terminal_plot(half, {0.18}, TerminalText::ascii));
    ASSERT_EQ(lines.size(), 20);
    for (const std::string& line : lines)
        EXPECT_LE(line.size(), 80) << line;
    EXPECT_EQ(std::count(lines[7].begin(), lines[7].end(), '*'), 73) << "0.6 is a row";
    EXPECT_NE(lines[0].find("mid gray 0.600"), std::string::npos) << lines[0];
    EXPECT_EQ(lines[17].find('!'), 5 + 73 / 2) << "the middle of the axis";
    EXPECT_NE(lines[19].find("! where a law breaks"), std::string::npos);
    const std::string braille = terminal_plot(half, {}, TerminalText::utf8);
    EXPECT_NE(braille.find("\u2812"), std::string::npos) << braille;
}

TEST(TerminalPlot, FirstVariableThatIsSetDecidesAboutUtf8) {
    ASSERT_EQ(::setenv("LC_ALL", "", 1), 0);
    ASSERT_EQ(::setenv("LC_CTYPE", "de_DE.UTF-8", 1), 0);
    ASSERT_EQ(::setenv("LANG", "C", 1), 0);
    EXPECT_EQ(terminal_text(), TerminalText::utf8);
    ASSERT_EQ(::setenv("LC_ALL", "C", 1), 0);
    EXPECT_EQ(terminal_text(), TerminalText::ascii);
    for (const char* name : {"LC_ALL", "LC_CTYPE", "LANG"})
        ::unsetenv(name);
}

}  // namespace
}  // namespace tonewright
