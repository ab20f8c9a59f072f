// SPDX-License-Identifier: Apache-2.0
#include "tonewright/definition.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <functional>
#include <memory>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "tonewright/engine.h"
#include "tonewright/registry.h"
#include "tonewright/view.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

const std::string kHead = "tonewright = 1\nid = \"my\"\n";
const std::string kStage = "[[stage]]\ncurve = \"max(x, 0)\"\n";

std::shared_ptr<const Operator> parsed(const std::string& rest) {
    return parse_operator(kHead + rest, "my.tone");
}

Pipeline built(const Operator& op, const Settings& settings = {}, const std::string& look = {}) {
    return resolve(op, nullptr, settings, look).build();
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

void expect_error(const std::function<void()>& call, const std::string& words) {
    try {
        call();
        ADD_FAILURE() << "no error; expected " << words;
    } catch (const Error& e) {
        const std::string message = e.what();
        EXPECT_NE(message.find(words), std::string::npos) << message;
        EXPECT_EQ(message.find('\n'), std::string::npos) << message;
    }
}

void expect_same(const Pipeline& a, const Pipeline& b, const std::string& what) {
    const std::array<Expr, 3> x = compose(a);
    const std::array<Expr, 3> y = compose(b);
    for (std::size_t i = 0; i < 3; ++i)
        EXPECT_TRUE(same(x.at(i), y.at(i))) << what << ", channel " << i;
}

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

// What the engines get is what a built-in's file gives them, so that it runs at the same speed.
// TOML's integers end at 2^63, and double precision holds all of them up to 2^53.
TEST(Definition, LargeNumbersReadBack) {
    const auto op = parsed(
        "[[stage]]\nmatrix = [[11060664309660294, 1e300, -0.0], [0, 1, 0], [0, 0, 1]]\n"
        "[[stage]]\nclamp = [-12345678901234567168.0, inf]\n");
    const auto matrix = std::get<MatrixStage>(built(*op)[0]);
    EXPECT_EQ(matrix.m[0][0], 11060664309660294.0);
    const auto again = parse_operator(definition_of(resolve(*op, nullptr, {}, "")), "again.tone");
    const Pipeline stages = built(*again);
    EXPECT_EQ(std::get<MatrixStage>(stages[0]).m, matrix.m);
    EXPECT_TRUE(std::signbit(std::get<MatrixStage>(stages[0]).m[0][2]));
    EXPECT_EQ(std::get<ClampStage>(stages[1]).lo, -12345678901234567168.0);
}

TEST(Definition, OwnCurveIsTheExpressionOfABuiltIn) {
    const auto op = parsed(
        "[parameter.white]\ndefault = 4\nmin = 0.01\nmax = 65504\n"
        "[[stage]]\nclamp = [0, 65504]\n"
        "[[stage]]\ncurve = \"x/(1 + x)\"\n");
    expect_same(built(*op), resolve_operator("reinhard").build(), "reinhard");
}

TEST(Definition, StagesAreThoseOfOperators) {
    const auto op = parsed(R"tone(
[primaries]
working = "ap1"
output = { red = [0.64, 0.33], green = [0.3, 0.6], blue = [0.15, 0.06], white = [0.3127, 0.329] }
[output]
kind = "code_value"
power = 2.4
peak = "1 + k"
[parameter.k]
default = 0.5
min = 0
max = 1
unit = "stops"
doc = "what it does"
[[stage]]
matrix = [[1, 0, 0], [0, "2*3", 0], [0, 0, "1 - k"]]
name = "rotate"
[[stage]]
clamp = [0, inf]
[[stage]]
tone_scale = "x/(x + k)"
[[stage]]
curve = "x/(x + k)"
apply = "max"
[[stage]]
curve = "x*x"
inverse = "sqrt(x)"
[[stage]]
curve = ["x", "x*2", "x*3"]
[[stage]]
hue_preserving = "x*k"
[[stage]]
hexcone = { offset = "x*0.04", value = "x", chroma = "1" }
[[stage]]
temporaries = "low = min(min(r, g), b)"
cross_talk = ["r - low", "g - low*k", "b"]
)tone");
    EXPECT_TRUE(op->working == kAP1);
    const ResolvedOperator resolved = resolve(*op, nullptr, {}, "");
    EXPECT_TRUE(resolved.output_primaries() == kRec709);
    EXPECT_EQ(op->output, OutputKind::code_value);
    EXPECT_EQ(op->code_power, 2.4);
    EXPECT_EQ(resolved.peak(), 1.5);
    const Expr x = Expr::input(0);
    const Expr g = Expr::input(1);
    const Expr b = Expr::input(2);
    const Expr low = min(min(x, g), b);
    // The luminance of ACEScg: SMPTE RP 177 on its primaries.
    const Vector3 weights = rgb_to_xyz(kAP1)[1];
    const Pipeline expected = {
        MatrixStage{{{{1, 0, 0}, {0, 6, 0}, {0, 0, 0.5}}}},
        ClampStage{0, kInfinity},
        ToneScaleStage{ToneScaleStage::Norm::luminance, weights, x / (x + 0.5)},
        ToneScaleStage{ToneScaleStage::Norm::max_rgb, {}, x / (x + 0.5)},
        curve_stage(x * x, sqrt(x)),
        CurveStage{{x, x * 2, x * 3}, std::nullopt},
        HuePreservingStage{x * 0.5},
        HexconeStage{x * 0.04, x, 1},
        CrossTalkStage{{x - low, g - low * 0.5, b}}};
    const Pipeline stages = resolved.build();
    ASSERT_EQ(stages.size(), expected.size());
    for (std::size_t i = 0; i < stages.size(); ++i) {
        EXPECT_EQ(stage_kind(stages[i]), stage_kind(expected[i])) << i;
        expect_same({stages[i]}, {expected[i]}, "stage " + std::to_string(i));
    }
    EXPECT_STREQ(std::get<MatrixStage>(stages[0]).name, "rotate");
    EXPECT_TRUE(std::get<CurveStage>(stages[4]).inverse.has_value());
    // A live parameter stays a uniform: of the matrix, too.
    const std::vector<Expr> live = [&] {
        const std::array<Expr, 3> rgb = compose(build_live(resolved, {"k"}));
        return std::vector<Expr>(rgb.begin(), rgb.end());
    }();
    EXPECT_EQ(uniforms_of(live), std::vector<std::string>{"k"});
    const auto bound = bind_uniforms(build_live(resolved, {"k"}), {{"k", 0.5}});
    expect_same(bound, stages, "bound");
}

TEST(Definition, ChoicesAndLooksChooseStagesAndValues) {
    const auto op = parsed(R"tone(
[parameter.mode]
default = "soft"
choices = ["soft", "hard"]
[parameter.n]
default = 1
min = 0
max = 9
[look.red]
title = "Red"
[[stage]]
curve = "mode == mode.soft ? x*2 : x*3"
[[stage]]
when = "look == look.red"
curve = ["x*5", "x", "x"]
[[stage]]
when = "n > 4"
curve = "x*7"
)tone");
    const auto red_of_1 = [&](const Settings& settings, const std::string& look) {
        return evaluate(compose(built(*op, settings, look))[0], std::array{1.0, 1.0, 1.0});
    };
    EXPECT_EQ(red_of_1({}, ""), 2);
    EXPECT_EQ(red_of_1({{"mode", "hard"}}, ""), 3);
    EXPECT_EQ(red_of_1({}, "red"), 10);
    EXPECT_EQ(red_of_1({{"n", "5"}}, ""), 14);
    EXPECT_TRUE(live_parameters(*op).empty()) << "n decides which stages there are";
}

TEST(Definition, ParametersComeFromPicturesAndDisplays) {
    const auto op = parsed(
        "[parameter.a]\ndefault = 1\nmin = 0\nmax = 9\nfrom_picture = \"log_average\"\n"
        "[parameter.p]\ndefault = 100\nmin = 100\nmax = 2000\nfrom_display = \"peak\"\n"
        "[parameter.gamut]\ndefault = \"rec709\"\nchoices = [\"rec709\", \"p3d65\", \"rec2020\"]\n"
        "from_display = \"gamut\"\n" +
        kStage);
    SceneStatistics statistics;
    statistics.log_average = 0.5;
    const ResolvedOperator resolved = resolve(*op, nullptr, {}, "");
    EXPECT_EQ(resolve_for_picture(resolved, statistics).settings.at("a"), "0.5");
    const ResolvedOperator shown = resolve_for_display(resolved, {kP3D65, true, 1000});
    EXPECT_EQ(shown.params.number("p"), 1000);
    EXPECT_EQ(shown.params.choice("gamut"), "p3d65");
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

TEST(Definition, ErrorsShowTheLine) {
    try {
        (void)parsed("[[stage]]\ncurve = \"\"\"\na = x\n  a + foo\n\"\"\"\n");
        FAIL();
    } catch (const DefinitionError& e) {
        EXPECT_EQ(e.excerpt(), "    a + foo\n        ^");
    }
}

/// Operators that no formula says, and why.
const std::set<std::string> kNotPrinted = {"aces_20", "agx_blender", "camera_response"};
/// Operators that fold their constants in another order where a parameter is no uniform.
const std::set<std::string> kTwoForms = {"aldridge", "drago", "log_tonemap", "logarithmic"};

TEST(Definition, EveryBuiltInReadsBackAsTheSameExpression) {
    std::set<std::string> refused;
    std::size_t count = 0;
    for (const OperatorVariant& variant : all_variants()) {
        const ResolvedOperator op = resolve_operator(variant.name, {}, variant.look);
        const std::string what = variant.name + " " + variant.look;
        std::string text;
        try {
            text = definition_of(op);
        } catch (const Error& e) {
            if (refused.insert(op.op->id).second) std::cout << e.what() << "\n";
            continue;
        }
        ++count;
        std::shared_ptr<const Operator> own;
        try {
            own = parse_operator(text, op.op->id + ".tone");
        } catch (const DefinitionError& e) {
            ADD_FAILURE() << what << ": " << e.what() << "\n" << e.excerpt() << "\n";
            continue;
        }
        const ResolvedOperator again = resolve(*own, nullptr, {}, "");
        EXPECT_EQ(live_parameters(*own), live_parameters(*op.op)) << what;
        const std::vector<std::string> live = live_parameters(*op.op);
        const Pipeline live_stages = build_live(op, live);
        expect_same(build_live(again, live), live_stages, what + " live");
        UniformValues values;
        for (const std::string& name : live)
            values.emplace(name, op.params.number(name));
        expect_same(again.build(), bind_uniforms(live_stages, values), what + " bound");
        if (!kTwoForms.contains(op.op->id)) {
            expect_same(again.build(), op.build(), what);
            EXPECT_EQ(again.build().size(), op.build().size()) << what;
        }
        EXPECT_TRUE(own->working == op.op->working) << what;
        EXPECT_TRUE(again.output_primaries() == op.output_primaries()) << what;
        EXPECT_EQ(again.peak(), op.peak()) << what;
        EXPECT_EQ(own->output, op.op->output) << what;
        if (op.op->output == OutputKind::code_value) {
            EXPECT_EQ(own->code_power, op.op->code_power) << what;
        }
        EXPECT_EQ(own->bounds.simd, op.op->bounds.simd) << what;
    }
    EXPECT_EQ(refused, kNotPrinted);
    EXPECT_LE(refused.size(), 12U);
    EXPECT_GT(count, 70U);
}

TEST(Definition, OperatorSetGivesTextsMoreNames) {
    OperatorSet set;
    set.add(parsed("title = \"My Curve\"\n" + kStage));
    const ResolvedOperator op = resolve_operator("my curve", {}, "", set);
    EXPECT_EQ(op.op->id, "my");
    EXPECT_EQ(op.owner.use_count(), 2);
    EXPECT_THROW((void)resolve_operator("my curve"), Error);
    EXPECT_THROW(set.add(parsed(kStage)), Error) << "it has an operator of this id";
    EXPECT_THROW(set.add(parse_operator(
                     "tonewright = 1\nid = \"agx\"\ntitle = \"Hable\"\n" + kStage, "a.tone")),
                 Error);
}

TEST(Definition, TextsHaveSettingsAfterTheFile) {
    const std::string path = TONEWRIGHT_TEST_DATA "/../../docs/examples/reinhard_055.tone";
    EXPECT_EQ(resolve_operator(path).params.number("k"), 0.55);
    for (const char* rest : {":firm", ":k=0.3", " k=0.3", ": k=0.3", ":firm:k=0.3", ":K=0.3"}) {
        const ResolvedOperator op = resolve_operator(path + rest);
        EXPECT_EQ(op.params.number("k"), 0.3) << rest;
        // The text that names it reads back.
        EXPECT_EQ(resolve_operator(operator_text(op)).params.number("k"), 0.3) << rest;
    }
    EXPECT_THROW((void)resolve_operator(path + ":none"), Error);
    EXPECT_THROW((void)resolve_operator(path + ".tone"), FileError);
}

/// A 3D LUT of two nodes a side that inverts its channels, behind a 1D table that squares 0, 1/2
/// and 1. A file named "stated" says what goes in and comes out.
TableFile small_table(const std::string& path) {
    if (path.find("missing") != std::string::npos) throw FileError("read: " + path + ": gone");
    std::vector<double> nodes;
    for (int i = 0; i < 8; ++i) {
        for (const int place : {i / 4, i / 2 % 2, i % 2})
            nodes.push_back(1 - place);
    }
    const auto table = std::make_shared<const Table>(Table{{0, 0.25, 1}});
    TableFile file;
    file.stages = {
        curve_stage(lookup(table, Expr::input())),
        LatticeStage{Expr::input(), std::make_shared<const Lattice>(2, [nodes] { return nodes; })}};
    file.title = "Small";
    if (path.find("stated") != std::string::npos) {
        file.encoding = "log2:-10:6.5";
        file.space = "lin_ap1";
        file.display = "rec1886";
    }
    return file;
}

std::array<double, 3> shown_by(const Pipeline& pipeline, double r, double g, double b) {
    const std::array<Expr, 3> rgb = compose(pipeline);
    const std::array<double, 3> in = {r, g, b};
    return {evaluate(rgb[0], in), evaluate(rgb[1], in), evaluate(rgb[2], in)};
}

TEST(LutStage, TakesPathsFromTheFolderOfTheFile) {
    std::string read;
    const auto op = parse_operator(kHead + "[[stage]]\nlut = \"luts/a.cube\"\ninput = \"none\"\n",
                                   "ops/my.tone", [&](const std::string& path) {
                                       read = path;
                                       return small_table(path);
                                   });
    EXPECT_EQ(read, "ops/luts/a.cube");
    const std::array<double, 3> shown = shown_by(built(*op), 0.5, 0.25, 2);
    EXPECT_EQ(shown, (std::array<double, 3>{0.75, 0.875, 0}));  // 1 - table
}

TEST(LutStage, EncodesLightForTheLut) {
    // 0.18 is 10 stops of 16.5 above the lower end, between entries 1 and 2 of the table.
    const double code = 10 / 16.5;
    const double wanted = 1 - (0.25 + (code - 0.5) * 1.5);
    for (const char* text : {"lut = \"a.cube\"\ninput = \"log2\"\n", "lut = \"stated.cube\"\n",
                             "lut = \"a.cube\"\ninput = \"log2\"\nspace = \"lin_ap1\"\n"}) {
        const auto op = parse_operator(kHead + "[[stage]]\n" + text, "my.tone", small_table);
        // Rows of a matrix between primaries of white sum to 1, but for the rounding of white.
        for (const double channel : shown_by(built(*op), 0.18, 0.18, 0.18))
            EXPECT_NEAR(channel, wanted, 1e-6) << text;
    }
}

TEST(LutStage, RefusesUnsupportedFiles) {
    const auto error = [](const std::string& stage) -> std::string {
        try {
            (void)parse_operator(kHead + "[[stage]]\n" + stage, "my.tone", small_table);
        } catch (const DefinitionError& e) {
            return e.what();
        }
        return "no error";
    };
    EXPECT_EQ(error("lut = \"missing.cube\"\ninput = \"none\"\n"),
              "my.tone:4:7: read: missing.cube: gone");
    EXPECT_EQ(error("lut = \"a.cube\"\n").substr(0, 62),
              "my.tone:4:7: the LUT does not say which encoding it expects; e");
    EXPECT_EQ(error("lut = \"my.tone\"\n").substr(0, 46),
              "my.tone:4:7: lut is \"my.tone\"; expected a file");
    EXPECT_EQ(error("lut = 3\n"), "my.tone:4:7: lut is 3; expected text in quotes");
    EXPECT_EQ(error("lut = \"a.cube\"\ninput = \"acesct\"\n").substr(0, 44),
              "my.tone:5:9: input encoding is acesct; expec");
    EXPECT_EQ(error("lut = \"a.cube\"\ninput = \"none\"\nspace = \"lin_ap1\"\n"),
              "my.tone:5:9: space is lin_ap1; expected an input encoding beside it");
}

TEST(LutOperator, HasTheParametersThatTheFileStates) {
    const auto op = load_operator("my luts/Stated Film.cube", small_table);
    EXPECT_EQ(op->id, "stated_film");
    EXPECT_EQ(op->view, "Small");
    // The name has a capital letter: the stub does not take it for a file that states anything.
    EXPECT_NE(resolve(*op, nullptr, {}, "").caution().find("unknown"), std::string::npos);
    const auto stated = load_operator("stated.cube", small_table);
    const ResolvedOperator resolved = resolve(*stated, nullptr, {}, "");
    EXPECT_EQ(resolved.params.text("input"), "log2:-10:6.5");
    EXPECT_EQ(resolved.output_display(), "rec1886");
    EXPECT_EQ(resolved.caution(), "");
    EXPECT_THROW((void)load_operator("stated.cube"), FileError) << "without a reader";
    EXPECT_THROW((void)resolve(*stated, nullptr, {{"output", "paper"}}, ""), Error);
    // The space that the file states belongs to its own encoding.
    const ResolvedOperator slog = resolve(*stated, nullptr, {{"input", "slog3"}}, "");
    EXPECT_TRUE(std::get<MatrixStage>(slog.build()[0]).m ==
                rgb_to_rgb(kRec709, find_input_space("lin_sgamut3").primaries));
}

/// In linear light of Rec.709.
std::array<double, 3> of_formula(const char* text, double r, double g, double b) {
    const OperatorSet set({}, OperatorSet::Formulas::yes);
    return shown_by(
        build_view(make_view(resolve_operator(text, {}, {}, set), "lin_rec709", 0, "linear")), r, g,
        b);
}

TEST(InlineFormula, IsAnOperator) {
    using Color = std::array<double, 3>;
    EXPECT_EQ(of_formula("x/(1+x)", 1, 3, -2), (Color{0.5, 0.75, 0}));
    EXPECT_EQ(of_formula(" x ", 0.25, 2, 0), (Color{0.25, 2, 0}));
    EXPECT_EQ(of_formula("x < 0.5 ? x : 1 - 0.25/x", 0.25, 1, 2), (Color{0.25, 0.75, 0.875}));
    EXPECT_EQ(of_formula("a = x*2; a/(1 + a)", 0.5, 1.5, 0), (Color{0.5, 0.75, 0}));
    EXPECT_EQ(of_formula("0.25*r + 0.5*g + 0.25*b", 1, 2, 4), (Color{2.25, 2.25, 2.25}));
    EXPECT_EQ(of_formula("b, min(r, g), r/2", 1, 2, 4), (Color{4, 1, 0.5}));
    EXPECT_EQ(of_formula("x, x*2, x*4", 1, 1, 1), (Color{1, 2, 4}));
    const auto op = formula_operator("x/(1+x)");
    EXPECT_EQ(op->name(), "x/(1+x)");
    EXPECT_EQ(operator_text(resolve(*op, nullptr, {}, "")), "x/(1+x)");
    EXPECT_EQ(resolve(*op, nullptr, {}, "").caution(), "");
}

TEST(InlineFormula, ThatEncodesHasACaution) {
    const auto op = formula_operator("pow(x/(1 + x), 1/2.2)");
    // (0.18/1.18)^(1/2.2) = 0.4254
    EXPECT_EQ(resolve(*op, nullptr, {}, "").caution(),
              "pow(x/(1 + x), 1/2.2): mid gray 0.18 becomes 0.425, as code values would; expected "
              "linear light, which --display encodes");
}

TEST(InlineFormula, ComesAfterNamesAndFiles) {
    for (const char* text : {"x", "x/(1+x)", "r, g, b", "max(x, 0)", "1 - exp(-x)", "x^2", "x==1",
                             "x != 1", "a=x; a", "y = x", "return x;"})
        EXPECT_TRUE(may_be_formula(text)) << text;
    for (const char* text : {"", "hable", "AgX (Blender)", "AgX (Blendr)", "r", "2+3", "xyz(1)",
                             "reinhard:white=4", "1.x", "hable white=4", "my_curve:x=1"})
        EXPECT_FALSE(may_be_formula(text)) << text;
    const OperatorSet set({}, OperatorSet::Formulas::yes);
    EXPECT_EQ(resolve_operator("AgX (Blender)", {}, {}, set).op->id, "agx_blender");
    EXPECT_EQ(resolve_operator("hable:white=4", {}, {}, set).op->id, "hable");
    expect_error([] { (void)resolve_operator("x/(1+x)"); }, "expected an id from");
}

TEST(InlineFormula, HasSteps) {
    using Color = std::array<double, 3>;
    EXPECT_EQ(of_formula("x == 1", 1, 2, 0.5), (Color{1, 0, 0}));
    EXPECT_EQ(of_formula("x >= 1 ? 1 : x", 1, 2, 0.5), (Color{1, 1, 0.5}));
    EXPECT_EQ(of_formula("x != 1", 1, 2, 0.5), (Color{0, 1, 1}));
    EXPECT_EQ(of_formula("a=x; a", 1, 2, 0.5), (Color{1, 2, 0.5}));
    const char* const what =
        "; a formula is an expression of x, or of r, g and b, with steps before it: a = x*2; a/(1 "
        "+ "
        "a)";
    for (const char* text : {"y = x/(1+x)", "return x;", "x=1", "x &&", "f(x) = x"})
        expect_error([&] { (void)formula_operator(text); }, what);
}

TEST(InlineFormula, ThatIsWrongSaysWhere) {
    const std::pair<const char*, const char*> wrong[] = {
        {"x^2", "operator is x^2: column 2: ^ is no power here; expected pow(a, b)"},
        {"x/(1+y)", "operator is x/(1+y): column 6: name is y; expected x"},
        {"r + x", "column 1: name is r"},
        {"r, g", "it has 2 formulas; expected one or three"},
        {"r, g, b*", "column 9: found the end"},
        {"1/x", "infinity for the color 0 0 0"},
        {"x/(x + pow(x, 0.55))", "no number for the color 0 0 0"},
    };
    for (const auto& [text, words] : wrong)
        expect_error([t = text] { (void)formula_operator(t); }, words);
    expect_error([] { (void)formula_operator("x" + std::string(5000, '+')); }, "at most 4096");
    for (const char* text : {"x +\n0*x", "x # c", "x // \\", "x/(1+x) */ b", "x\t\\"})
        expect_error([text] { (void)formula_operator(text); }, "expected a .tone file");
}

TEST(LutOperator, IsShownAsItIsOnItsOwnDisplay) {
    const auto op = load_operator("stated.cube", small_table);
    const ResolvedOperator resolved = resolve(*op, nullptr, {}, "");
    const auto on = [&](const char* display) {
        return shown_by(build_view(make_view(resolved, "lin_rec709", 0, display)), 0.1, 0.3, 0.2);
    };
    const std::array<double, 3> code = on("native");
    EXPECT_EQ(on("rec1886"), code);
    for (std::size_t i = 0; i < 3; ++i) {
        EXPECT_NEAR(on("linear").at(i), std::pow(code.at(i), 2.4), 1e-15);  // ITU-R BT.1886
        EXPECT_NEAR(on("g22").at(i), std::pow(code.at(i), 2.4 / 2.2), 1e-15);
    }
}

TEST(LutOperator, IsWrittenAsOneStage) {
    const auto op = load_operator("stated.cube", small_table);
    for (const Settings& settings :
         {Settings{}, Settings{{"input", "slog3"}, {"output", "linear"}},
          Settings{{"input", "none"}}, Settings{{"output", "rec2100_pq"}}}) {
        const ResolvedOperator resolved = resolve(*op, nullptr, settings, "");
        const auto again = parse_operator(definition_of(resolved), "again.tone", small_table);
        const ResolvedOperator read = resolve(*again, nullptr, {}, "");
        // The lattices are two objects of equal numbers.
        for (const char* display : {"native", "linear", "srgb", "rec2100_pq"}) {
            const auto shown = [&](const ResolvedOperator& of) {
                return shown_by(build_view(make_view(of, "lin_rec709", 0, display)), 0.1, 0.3, 0.2);
            };
            EXPECT_EQ(shown(read), shown(resolved)) << display;
        }
    }
}

TEST(LutOperator, TextsNameFiles) {
    for (const char* text : {"film.cube", "FILM.CUBE:input=acescct", "a.dds output=linear",
                             "dir.lut/film.clf", "my film.exr"}) {
        EXPECT_TRUE(names_a_lut(text)) << text;
    }
    for (const char* text : {"my.tone", "hable:film.cube", "film.cubes", "film.cube/x", "agx"})
        EXPECT_FALSE(names_a_lut(text)) << text;
    EXPECT_EQ(
        resolve_operator("stated.cube:output=linear", {}, {}, OperatorSet(small_table)).output(),
        OutputKind::display_linear);
}

TEST(Definition, TextsNameFiles) {
    for (const char* text : {"my.tone", "MY.TONE", "./my.tone:soft", "a:b.tone", "C:\\x\\my.tone",
                             "my.tone:k=2", "my.tone k=2", "my op.tone", "x.tone.tone"})
        EXPECT_TRUE(names_a_file(text)) << text;
    for (const char* text : {"agx_blender", "agx_blender:punchy", "my.tones", "tone",
                             "my.tonex:k=2", "camera_response:file=a.tone", "hable:b.tone", ""})
        EXPECT_FALSE(names_a_file(text)) << text;
}

}  // namespace
TONEWRIGHT_NAMESPACE_END
