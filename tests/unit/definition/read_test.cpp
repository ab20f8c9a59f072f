// SPDX-License-Identifier: Apache-2.0
#include "tonewright/definition.h"

#include <gtest/gtest.h>

#include <array>
#include <string>
#include <vector>

#include "tonewright/view.h"
#include "unit/definition/definitions.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

TEST(Definition, ReadsTheExampleOfTheDocs) {
    const auto op = load_operator(TONEWRIGHT_TEST_DATA "/../../docs/examples/reinhard_055.tone");
    EXPECT_EQ(op->id, "reinhard_055");
    EXPECT_EQ(op->view, "Reinhard 0.55");
    EXPECT_EQ(live_parameters(*op), std::vector<std::string>{"k"});
    // n/(n + n**0.55), Python 3.11.
    const std::array<Expr, 3> rgb = compose(built(*op));
    const double middle_gray = 0.18;
    const std::array<double, 3> in = {middle_gray, 16, -1};
    EXPECT_NEAR(evaluate(rgb[0], in), 0.31612027729525327, 1e-15);
    EXPECT_NEAR(evaluate(rgb[1], in), 0.7768953867957378, 1e-15);
    EXPECT_EQ(evaluate(rgb[2], in), 0);
    EXPECT_EQ(resolve(*op, &op->presets[0], {}, "").params.number("k"), 0.3);
}

TEST(Definition, ErrorsShowTheLine) {
    try {
        (void)parsed("[[stage]]\ncurve = \"\"\"\na = x\n  a + foo\n\"\"\"\n");
        FAIL();
    } catch (const DefinitionError& e) {
        EXPECT_EQ(e.excerpt(), "    a + foo\n        ^");
    }
}

/// "3:5: message" of a file that is wrong.
std::string error_of(const std::string& text) {
    try {
        (void)parse_operator(text, "my.tone");
    } catch (const DefinitionError& e) {
        const std::string message = e.what();
        EXPECT_EQ(message.substr(0, 8), "my.tone:") << message;
        EXPECT_EQ(message.find('\n'), std::string::npos) << message;
        return message.substr(8);
    }
    return "no error";
}

TEST(Definition, MessagesHaveThePlace) {
    const std::string bad_stage = kHead + "[[stage]]\n";
    const struct {
        std::string text;
        std::string error;
    } cases[] = {
        {"", "1:1: key tonewright is missing; expected it"},
        {"tonewright = 2\n", "1:14: tonewright is 2; expected 1"},
        {"tonewright = \"1\"\n", "1:14: tonewright is \"1\"; expected a number"},
        {"tonewright = 1\n", "1:1: key id is missing; expected it"},
        {"tonewright = 1\nid = \"My Op\"\n",
         "2:6: id is \"My Op\"; expected at most 63 small letters, digits and _, a letter first"},
        {kHead, "1:1: file has no [[stage]]; expected at least one"},
        {kHead + "titel = \"x\"\n" + kStage,
         "3:1: key is titel; expected tonewright, id, title, view, character, source, license, "
         "negatives, warnings, primaries, output, parameter, preset, look, deviation, bounds, "
         "stage "
         "or inverse; did you mean title?"},
        {kHead + "[primaries]\nworking = \"rec7099\"\n" + kStage,
         "4:11: working is \"rec7099\"; expected rec709, rec2020, p3d65, ap0, ap1, egamut, awg3, "
         "awg4, sgamut3, sgamut3cine or davinci_wg; did you mean rec709?"},
        {bad_stage,
         "3:1: [[stage]] has no kind; expected matrix, curve, tone_scale, "
         "hue_preserving, hexcone, cross_talk, clamp or lut"},
        {bad_stage + "curve = \"x\"\nclamp = [0, 1]\n",
         "5:9: [[stage]] has two kinds; expected curve or clamp, and another [[stage]]"},
        {bad_stage + "curve = \"x\"\nnorm = \"max\"\n",
         "5:1: [[stage]]: key is norm; expected curve, temporaries, when, name, apply, inverse or "
         "weights"},
        {bad_stage + "curve = 3\n", "4:9: curve is 3; expected a formula in quotes"},
        {bad_stage + "curve = \"x + foo\"\n", "4:14: name is foo; expected x"},
        {bad_stage + "curve = \"\"\"\na = x\na + foo\"\"\"\n", "6:5: name is foo; expected x or a"},
        {bad_stage + "curve = '''a = x\n  a ^ 2'''\n", "5:5: found ^; write pow(a, b)"},
        {bad_stage + "curve = \"\"\"\r\na = x\r\na + foo\"\"\"\r\n",
         "6:5: name is foo; expected x or a"},
        {bad_stage + "matrix = [[1, 0], [0, 1]]\n",
         "4:10: matrix is an array of 2; expected an array of 3"},
        {bad_stage + "matrix = [[1, 0, 0], [0, 1, 0], [0, 0, nan]]\n",
         "4:40: matrix is nan; expected a finite number"},
        {bad_stage + "clamp = [1, 0]\n", "4:9: clamp begins at 1; expected at most its end, 0"},
        {bad_stage + "curve = \"sqrt(x)\"\n",
         "4:9: my: stage gives no number for the color 1e-09 5e-10 -2.5e-10; expected a finite "
         "number, as with max(x, 1e-10)"},
        {bad_stage + "curve = \"a = max(x, 0); a/(a + pow(a, 0.55))\"\n",
         "4:9: my: stage gives no number for the color 0 0 0; expected a finite number, as with "
         "max(x, 1e-10)"},
        {bad_stage + "tone_scale = \"x + 0.1\"\n",
         "4:14: formula is 0.1 at black; expected 0 where it scales colors by their norm"},
        {bad_stage + "lut = \"film.cube\"\n",
         "4:7: lut is \"film.cube\"; this program reads no LUT as a stage"},
        {kHead + "[parameter.x]\ndefault = 1\nmin = 0\nmax = 2\n" + kStage,
         "3:12: parameter is x; expected at most 63 letters, digits and _, and no function, "
         "input or other parameter"},
        {kHead + "[parameter.k]\ndefault = 3\nmin = 0\nmax = 2\n" + kStage,
         "4:11: default is 3; expected [0, 2]"},
        {kHead + "[parameter.k]\ndefault = 3\nmin = 0\n" + kStage,
         "3:1: [parameter.k]: key max is missing; expected it"},
        {kHead + "[preset.a]\nset = { kk = 3 }\n" + kStage,
         "3:9: my: parameter is kk; expected none: my has no parameters"},
        {kHead + kHead,
         "3:14: Error while parsing key-value pair: cannot redefine existing integer "
         "'tonewright'"},
        // The library's parser is undefined for some of these.
        {kHead + "title = 44\"\xEF\xB3\xBF\"\n",
         "3:11: Error while parsing decimal integer: expected digit, saw '\"'"},
        {kHead + "m=2k=@m=\"=u!2k=6\xEF\xB3\xBF{[stage]]\n",
         "3:3: Error while parsing value: could not determine value type"},
        {kHead + "titl\xC3\xA9 = 1\n", "3:5: character is not ASCII; expected it in quotes"},
        {kHead + "title = \"\"\"a\\ \xC3\xA9\"\"\"\n",
         "3:13: escape is not ASCII; expected \\n, \\t, ..."},
        // An assertion of the library's parser, which Debug and Release builds have the same way.
        {kHead + "[ = 1\n" + kStage, "3:1: line is not TOML; expected a key or a value"},
        {kHead + "[parameter.=]\n" + kStage,
         "3:12: Error while parsing key: expected bare key starting character or string delimiter, "
         "saw '='"},
        {"\xFF\xFEt\0o\0", "1:1: file is UTF-16; expected UTF-8"},
        {kHead + "title = \"\xC3\x28\"\n", ""},
        {std::string("tonewright = 1\0", 15), "1:15: file has a zero byte; expected text in UTF-8"},
        {kHead + std::string(40, 'a') + std::string(100000, '.') + "b = 1\n",
         "3:73: key has more than 32 dots; expected at most as many"},
    };
    for (const auto& c : cases) {
        const std::string error = error_of(c.text);
        if (c.error.empty()) {
            EXPECT_NE(error, "no error") << c.text;
        } else {
            EXPECT_EQ(error, c.error) << c.text.substr(0, 300);
        }
    }
    EXPECT_EQ(error_of("\xEF\xBB\xBF" + kHead + kStage), "no error") << "byte order mark";
    for (const char* title : {"'\xC3\xA9'", "\"\xC3\xA9\\\"\xC3\xA9\"", "'''\xC3\xA9'\n\xC3\xA9'''",
                              "\"\"\"\xC3\xA9\"\"\"\"\"  # \xC3\xA9", "'#'  # \"\xC3\xA9"})
        EXPECT_EQ(error_of(kHead + "title = " + title + "\n" + kStage), "no error") << title;
}

}  // namespace
TONEWRIGHT_NAMESPACE_END
