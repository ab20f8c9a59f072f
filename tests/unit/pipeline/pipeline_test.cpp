// SPDX-License-Identifier: Apache-2.0
#include "tonewright/pipeline.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "tonewright/view.h"

namespace tonewright {
namespace {

const Expr kX = Expr::input(0);
const Expr kR = Expr::input(0);
const Expr kG = Expr::input(1);
const Expr kB = Expr::input(2);

using Norm = ToneScaleStage::Norm;

/// By plain recursion over the expressions: no engine is under test here.
Vector3 shown(const Pipeline& pipeline, const Vector3& rgb) {
    const std::array<Expr, 3> f = compose(pipeline);
    return {evaluate(f[0], rgb), evaluate(f[1], rgb), evaluate(f[2], rgb)};
}

Vector3 shown(const Stage& stage, const Vector3& rgb) { return shown(Pipeline{stage}, rgb); }

void expect_rgb(const Vector3& actual, const Vector3& expected, double tolerance,
                const std::string& what = "") {
    for (std::size_t c = 0; c < 3; ++c) {
        EXPECT_NEAR(actual[c], expected[c], tolerance) << what << ", channel " << c;
    }
}

/// The text of the Error that `f` throws.
template <class F>
std::string error_of(const F& f) {
    try {
        f();
    } catch (const Error& e) {
        return e.what();
    }
    return "no error";
}

std::string resolve_error(std::string_view name, const Settings& settings = {},
                          std::string_view look = {}) {
    return error_of([&] { (void)resolve_operator(name, settings, look); });
}

/// Sums and products of a few doubles in another order: some units of 2^-53.
constexpr double kRounding = 1e-14;

// ---------------------------------------------------------------------------------------------
// Stages

/// One stage of each kind that changes nothing, in the order of the variant.
Pipeline identities() {
    return {MatrixStage{kIdentity3}, curve_stage(kX), ClampStage{-kInfinity, kInfinity},
            Map3Stage{{kR, kG, kB}}};
}

TEST(Stage, KindsHaveNames) {
    EXPECT_EQ(stage_kind(MatrixStage{kIdentity3}), "matrix");
    EXPECT_EQ(stage_kind(curve_stage(kX)), "curve");
    EXPECT_EQ(stage_kind(ToneScaleStage{Norm::luminance, kRec709Weights, kX}), "tone scale");
    EXPECT_EQ(stage_kind(ClampStage{}), "clamp");
    EXPECT_EQ(stage_kind(Map3Stage{{kR, kG, kB}}), "map3");
}

TEST(Stage, KnowsThatItIsAnIdentity) {
    for (const Stage& stage : identities())
        EXPECT_TRUE(is_identity(stage)) << stage_kind(stage);
    Matrix3 nearly = kIdentity3;
    nearly[2][0] = 1e-300;
    EXPECT_FALSE(is_identity(MatrixStage{nearly}));
    EXPECT_FALSE(is_identity(exposure_stage(0.001)));
    EXPECT_TRUE(is_identity(exposure_stage(0)));
    EXPECT_FALSE(is_identity(CurveStage{{kX, kX, kX * 2}, std::nullopt})) << "one channel of three";
    EXPECT_FALSE(is_identity(ClampStage{-kInfinity, 65504}));
    EXPECT_FALSE(is_identity(ClampStage{0, kInfinity}));
    EXPECT_FALSE(is_identity(Map3Stage{{kR, kB, kG}})) << "swapped channels";
}

TEST(Stage, AnIdentityChangesNoPixel) {
    Pipeline stages = identities();
    stages.push_back(ToneScaleStage{Norm::luminance, kRec709Weights, kX});
    stages.push_back(ToneScaleStage{Norm::max_rgb, {}, kX});
    const std::vector<Vector3> colours = {
        {0.2, 0.5, 4}, {-1, -2, -3}, {0, 0, 0}, {-3, 0.5, 0.1}, {65504, -65504, 1}};
    for (const Stage& stage : stages) {
        if (!is_identity(stage)) continue;
        for (const Vector3& rgb : colours) {
            // The tone scale multiplies by f(n)/n: one division, one product.
            expect_rgb(shown(stage, rgb), rgb, 65504 * 0x1p-52, std::string(stage_kind(stage)));
        }
    }
}

TEST(Stage, KnowsWhetherItMixesChannels) {
    for (const Stage& stage : identities())
        EXPECT_FALSE(mixes_channels(stage)) << stage_kind(stage);
    EXPECT_FALSE(mixes_channels(MatrixStage{{{{2, 0, 0}, {0, 3, 0}, {0, 0, 4}}}}));
    for (std::size_t i = 0; i < 3; ++i) {
        for (std::size_t j = 0; j < 3; ++j) {
            Matrix3 m = kIdentity3;
            m[i][j] = 0.5;
            EXPECT_EQ(mixes_channels(MatrixStage{m}), i != j) << "row " << i << ", column " << j;
        }
    }
    EXPECT_FALSE(mixes_channels(CurveStage{{kX, kX * 2, kX * kX}, std::nullopt}));
    EXPECT_FALSE(mixes_channels(ClampStage{0, 1}));
    EXPECT_TRUE(mixes_channels(ToneScaleStage{Norm::max_rgb, {}, kX / (1 + kX)}));
    EXPECT_TRUE(mixes_channels(Map3Stage{{kR, kG, kR + kB}}));
}

TEST(Stage, PerChannelMeansAlikeAndApart) {
    const Stage half = curve_stage(kX / 2);
    EXPECT_TRUE(is_per_channel({}));
    EXPECT_TRUE(is_per_channel({exposure_stage(1), ClampStage{0, 1}, half}));
    EXPECT_FALSE(is_per_channel({CurveStage{{kX, kX, kX / 2}, std::nullopt}}))
        << "apart, not alike";
    EXPECT_FALSE(is_per_channel({MatrixStage{{{{1, 0, 0}, {0, 1, 0}, {0, 0, 2}}}}}));
    EXPECT_FALSE(is_per_channel({Map3Stage{{kG, kB, kR}}})) << "alike, not apart";
    EXPECT_FALSE(is_per_channel({ToneScaleStage{Norm::max_rgb, {}, kX / (1 + kX)}}));
    EXPECT_TRUE(is_per_channel({Map3Stage{{kR * 2, kG * 2, kB * 2}}}))
        << "what it does counts, not how it is written";
    // There and back: a permutation's inverse is exact.
    const Matrix3 turn = {{{0, 1, 0}, {0, 0, 1}, {1, 0, 0}}};
    EXPECT_FALSE(is_per_channel({MatrixStage{turn}, half}));
    EXPECT_TRUE(is_per_channel({MatrixStage{turn}, MatrixStage{inverse(turn)}, half}));
}

TEST(Stage, MatrixActsOnColumns) {
    const MatrixStage m{{{{1, 2, 3}, {4, 5, 6}, {7, 8, 10}}}};
    EXPECT_EQ(shown(m, {1, 10, 100}), (Vector3{321, 654, 1087}));
    EXPECT_EQ(shown(m, {1, 0, 0}), (Vector3{1, 4, 7})) << "the first column";
}

TEST(Stage, CurvesBelongToTheirChannel) {
    EXPECT_EQ(shown(CurveStage{{kX + 1, kX * 2, kX * kX}, std::nullopt}, {3, 5, 7}),
              (Vector3{4, 10, 49}));
    const CurveStage same_for_all = curve_stage(kX / (1 + kX), kX / (1 - kX));
    EXPECT_TRUE(same_for_all.is_uniform());
    EXPECT_EQ(shown(same_for_all, {1, 3, 0}), (Vector3{0.5, 0.75, 0}));
    ASSERT_TRUE(same_for_all.inverse);
    for (const Expr& g : *same_for_all.inverse)
        EXPECT_EQ(evaluate(g, 0.75), 3);
    EXPECT_FALSE((CurveStage{{kX, kX + 1, kX}, std::nullopt}.is_uniform()));
    EXPECT_FALSE((CurveStage{{kX, kX, kX + 1}, std::nullopt}.is_uniform()));
}

TEST(Stage, ClampHasTwoEnds) {
    EXPECT_EQ(shown(ClampStage{-1, 2}, {-3, 0.5, 7}), (Vector3{-1, 0.5, 2}));
    EXPECT_EQ(shown(ClampStage{}, {-3, 0, 7e9}), (Vector3{0, 0, 7e9})) << "0 to infinity";
}

TEST(Stage, Map3SeesAllChannels) {
    EXPECT_EQ(shown(Map3Stage{{kR + kG, kG * kB, kB - kR}}, {2, 3, 5}), (Vector3{5, 15, 3}));
}

TEST(Stage, ToneScaleScalesByTheNorm) {
    const Expr f = kX / (1 + kX);
    // n = 4/4 + 1/2 + 2/4 = 2, f(n)/n = 1/3
    const ToneScaleStage luminance{Norm::luminance, {0.25, 0.5, 0.25}, f};
    expect_rgb(shown(luminance, {4, 1, 2}), {4.0 / 3, 1.0 / 3, 2.0 / 3}, kRounding);
    // n = 4, f(n)/n = 0.8/4
    const ToneScaleStage largest{Norm::max_rgb, {}, f};
    expect_rgb(shown(largest, {4, 1, 2}), {0.8, 0.2, 0.4}, kRounding);
    expect_rgb(shown(largest, {1, 4, 2}), {0.2, 0.8, 0.4}, kRounding);
    expect_rgb(shown(largest, {2, 1, 4}), {0.4, 0.2, 0.8}, kRounding);
    // A negative channel under a positive norm keeps its sign: n = 1 - 0.5 + 0.5 = 1, f(n)/n = 1/2
    expect_rgb(shown(luminance, {4, -1, 2}), {2, -0.5, 1}, kRounding);
}

TEST(Stage, ToneScaleIsBlackWhereTheNormIsNotPositive) {
    const Vector3 black = {0, 0, 0};
    for (const Norm norm : {Norm::luminance, Norm::max_rgb}) {
        const ToneScaleStage s{norm, kRec709Weights, kX / (1 + kX)};
        EXPECT_EQ(shown(s, black), black) << "0/0 has a limit";
        EXPECT_EQ(shown(s, {-1, -2, -3}), black);
    }
    const ToneScaleStage s{Norm::luminance, kRec709Weights, kX / (1 + kX)};
    EXPECT_EQ(shown(s, {1, -1, 1}), black) << "0.2126 - 0.7152 + 0.0722 is negative";
}

TEST(Stage, ExposureIsAPowerOfTwo) {
    EXPECT_EQ(shown(exposure_stage(3), {1, 0.25, -2}), (Vector3{8, 2, -16}));
    expect_rgb(shown(exposure_stage(-0.5), {1, 2, 0}), {std::sqrt(0.5), std::sqrt(2.0), 0},
               kRounding);
}

// ---------------------------------------------------------------------------------------------
// Pipelines

TEST(Pipeline, ComposesInOrder) {
    const Stage plus_one = curve_stage(kX + 1);
    const Stage twice = exposure_stage(1);
    EXPECT_EQ(shown(Pipeline{plus_one, twice}, {1, 2, 3}), (Vector3{4, 6, 8}));
    EXPECT_EQ(shown(Pipeline{twice, plus_one}, {1, 2, 3}), (Vector3{3, 5, 7}));
    EXPECT_EQ(shown(Pipeline{}, {1, 2, 3}), (Vector3{1, 2, 3}));
}

TEST(Pipeline, SimplifyMultipliesMatricesInTheRightOrder) {
    const Matrix3 a = {{{1, 2, 0}, {0, 1, 3}, {4, 0, 1}}};
    const Matrix3 b = {{{0, 1, 0}, {5, 0, 1}, {1, 1, 1}}};
    const Pipeline simple = simplify({MatrixStage{a}, MatrixStage{b}});
    ASSERT_EQ(simple.size(), 1U);
    // b a by hand: a's second row; five times its first plus its third; the sum of the three.
    const Matrix3 product = {{{0, 1, 3}, {9, 10, 1}, {5, 3, 4}}};
    EXPECT_EQ(std::get<MatrixStage>(simple[0]).m, product);
    EXPECT_EQ(shown(simple, {1, 0, 0}), (Vector3{0, 9, 5})) << "a b would give (10, 3, 1)";
}

TEST(Pipeline, SimplifyDropsWhatDoesNothing) {
    EXPECT_TRUE(simplify(identities()).empty());
    const Matrix3 turn = {{{0, 1, 0}, {0, 0, 1}, {1, 0, 0}}};
    const Pipeline there_and_back = {MatrixStage{turn}, curve_stage(kX),
                                     MatrixStage{inverse(turn)}};
    EXPECT_TRUE(simplify(there_and_back).empty()) << "an identity between them does not part them";
    const Stage clamp = ClampStage{0, 1};
    EXPECT_EQ(simplify({exposure_stage(1), clamp, exposure_stage(-1)}).size(), 3U)
        << "a clamp does";
    // A pair that cancels leaves a matrix before it free to meet the one after it.
    const Pipeline four = {exposure_stage(1), MatrixStage{turn}, MatrixStage{inverse(turn)},
                           exposure_stage(2)};
    const Pipeline one = simplify(four);
    ASSERT_EQ(one.size(), 1U);
    EXPECT_EQ(std::get<MatrixStage>(one[0]).m, scale(kIdentity3, 8));
}

TEST(Pipeline, SimplifyKeepsThePicture) {
    const std::vector<Vector3> colours = {{0.18, 0.18, 0.18}, {4, 0.02, 0.5},  {0, 0, 0},
                                          {-0.3, 0.4, 2},     {1e-5, 900, 30}, {-2, -3, -4}};
    for (const Operator& op : all_operators()) {
        for (const char* input : {"lin_rec709", "lin_ap1"}) {
            const Pipeline view =
                build_view(make_view(resolve_operator(op.id), input, 0, "rec2020"));
            for (const Vector3& rgb : colours) {
                // Only the multiplication of two matrices of the view moves a last bit.
                expect_rgb(shown(simplify(view), rgb), shown(view, rgb), 1e-12, op.id);
            }
        }
    }
}

TEST(Pipeline, PrintsOneStageALine) {
    const Pipeline p = {exposure_stage(1),
                        ClampStage{0, kInfinity},
                        curve_stage(kX / (1 + kX)),
                        CurveStage{{kX, kX * 2, kX * 3}, std::nullopt},
                        ToneScaleStage{Norm::luminance, kRec709Weights, kX * kX},
                        ToneScaleStage{Norm::max_rgb, {}, kX * kX},
                        Map3Stage{{kG, kB, kR}}};
    EXPECT_EQ(to_string(p),
              "matrix: [2 0 0 | 0 2 0 | 0 0 2]\n"
              "clamp: [0, inf]\n"
              "curve: x/(1 + x)\n"
              "curve: x | x*2 | x*3\n"
              "tone scale: of luminance: x*x\n"
              "tone scale: of max(r, g, b): x*x\n"
              "map3: g | b | r\n");
}

// ---------------------------------------------------------------------------------------------
// Parameters

TEST(Resolve, DefaultsAreComplete) {
    const ResolvedOperator op = resolve_operator("reinhard_extended");
    EXPECT_EQ(op.op->id, "reinhard_extended");
    EXPECT_EQ(op.params.number("white"), 4);
    EXPECT_EQ(op.params.choice("apply"), "channels");
    EXPECT_EQ(op.params.look(), "");
    EXPECT_EQ(op.label, "reinhard_extended");
    EXPECT_THROW((void)op.params.number("apply"), Error) << "a choice is no number";
    EXPECT_THROW((void)op.params.choice("white"), Error);
}

TEST(Resolve, PresetsSetAndSettingsWin) {
    const ResolvedOperator preset = resolve_operator("reinhard_extended:luminance");
    EXPECT_EQ(preset.params.choice("apply"), "luminance");
    EXPECT_EQ(preset.params.number("white"), 4) << "what the preset does not name is the default";
    EXPECT_EQ(preset.label, "reinhard_extended:luminance");

    const ResolvedOperator both =
        resolve_operator("reinhard_extended:luminance", {{"apply", "max"}, {"white", "2.5"}});
    EXPECT_EQ(both.params.choice("apply"), "max");
    EXPECT_EQ(both.params.number("white"), 2.5);
    EXPECT_EQ(both.label, "reinhard_extended:luminance apply=max white=2.5");

    const ResolvedOperator look = resolve_operator("agx_sobotka", {}, "punchy");
    EXPECT_EQ(look.params.look(), "punchy");
    EXPECT_EQ(look.label, "agx_sobotka look=punchy");
}

TEST(Resolve, ReadsNumbersAsTyped) {
    for (const auto& [text, value] : std::map<std::string, double>{{"2", 2},
                                                                   {"2.50", 2.5},
                                                                   {"1e3", 1000},
                                                                   {".5", 0.5},
                                                                   {"0.01", 0.01},
                                                                   {"65504", 65504}}) {
        EXPECT_EQ(resolve_operator("reinhard_extended", {{"white", text}}).params.number("white"),
                  value)
            << text;
    }
}

TEST(Resolve, UnknownNamesGetTheNearest) {
    EXPECT_EQ(resolve_error("habel"),
              "operator is habel; expected one of `tonewright list`; did you mean hable?");
    EXPECT_EQ(resolve_error("Reinhard"),
              "operator is Reinhard; expected one of `tonewright list`; did you mean reinhard?");
    EXPECT_EQ(resolve_error("photoshop"),
              "operator is photoshop; expected one of `tonewright list`");
    EXPECT_EQ(resolve_error("reinhard_extended", {{"whit", "2"}}),
              "reinhard_extended: parameter is whit; expected white or apply; did you mean white?");
    EXPECT_EQ(resolve_error("clamp", {{"white", "2"}}),
              "clamp: parameter is white; expected none, it has no parameters");
    EXPECT_EQ(resolve_error("reinhard:lumnance"),
              "reinhard: preset is lumnance; expected luminance or max; did you mean luminance?");
    EXPECT_EQ(resolve_error("reinhard:"), "reinhard: preset is ; expected luminance or max");
    EXPECT_EQ(resolve_error("hable:filmic"),
              "hable: preset is filmic; expected none, it has no presets");
    EXPECT_EQ(resolve_error("agx_sobotka", {}, "goldn"),
              "agx_sobotka: look is goldn; expected golden or punchy; did you mean golden?");
    EXPECT_EQ(resolve_error("hable", {}, "golden"),
              "hable: look is golden; expected none, it has no looks");
    EXPECT_EQ(resolve_error("reinhard", {{"apply", "chanels"}}),
              "reinhard: apply is chanels; expected channels, luminance or max; did you mean "
              "channels?");
    EXPECT_EQ(resolve_error("reinhard", {{"apply", ""}}),
              "reinhard: apply is ; expected channels, luminance or max");
}

TEST(Resolve, RefusesWhatIsNoNumberOrOutOfRange) {
    for (const char* text :
         {"-2",   "0",   "0.0099999", "65504.01", "1e999", "-1e999", "nan", "NaN",
          "-nan", "inf", "infinity",  "-inf",     "",      " ",      "4x",  "4 ",
          " 4",   "+4",  "0x10",      "four",     "4,5",   "4.5.6",  "1e",  "--4"}) {
        EXPECT_EQ(resolve_error("reinhard_extended", {{"white", text}}),
                  std::string("reinhard_extended: white is ") + text +
                      "; expected [0.01, 65504] scene-linear");
    }
    EXPECT_EQ(resolve_error("hable", {{"toe_numerator", "1"}}),
              "hable: toe_numerator is 1; expected [0, 0.9]")
        << "a pure number has no unit";
}

TEST(Resolve, RefusesSettingsThatContradictEachOther) {
    const Settings crossed = {{"toe_numerator", "0.5"}, {"toe_denominator", "0.3"}};
    const std::string message = resolve_error("hable", crossed);
    EXPECT_EQ(message.rfind("hable: curve at white is -", 0), 0U) << message;
    EXPECT_NE(message.find("; expected above 0 (toe_numerator below toe_denominator"),
              std::string::npos)
        << message;
    // E = F: h(x) = (x(Ax + CB) + DF)/(x(Ax + B) + DF) - 1 < 0, for C below 1.
    EXPECT_NE(resolve_error("hable", {{"toe_numerator", "0.3"}}), "no error");
    EXPECT_EQ(resolve_error("hable", {{"toe_numerator", "0.05"}}), "no error");
}

// ---------------------------------------------------------------------------------------------
// Registry

bool is_lower_snake(const std::string& id) {
    if (id.empty() || id.front() < 'a' || id.front() > 'z' || id.back() == '_') return false;
    return std::all_of(id.begin(), id.end(), [](char c) {
        return (c >= 'a' && c <= 'z') || (c >= '0' && c <= '9') || c == '_';
    });
}

bool is_line(const std::string& text) {
    return !text.empty() &&
           std::all_of(text.begin(), text.end(), [](char c) { return c >= 32 && c < 127; });
}

std::string lower(std::string text) {
    for (char& c : text)
        c = c >= 'A' && c <= 'Z' ? static_cast<char>(c + 32) : c;
    return text;
}

TEST(Registry, IsSortedByUniqueIds) {
    const auto& all = all_operators();
    ASSERT_FALSE(all.empty());
    for (std::size_t i = 0; i + 1 < all.size(); ++i)
        EXPECT_LT(all[i].id, all[i + 1].id);
    for (const Operator& op : all) {
        EXPECT_TRUE(is_lower_snake(op.id)) << op.id;
        EXPECT_EQ(&find_operator(op.id), &op);
    }
}

TEST(Registry, OperatorsSayWhatTheyAre) {
    std::set<std::string> views;
    for (const Operator& op : all_operators()) {
        SCOPED_TRACE(op.id);
        EXPECT_TRUE(views.insert(lower(op.view)).second) << "OCIO compares views without case";
        EXPECT_LE(op.view.size(), 63U) << "Blender's limit";
        for (const std::string* text :
             {&op.title, &op.view, &op.character, &op.source, &op.licence, &op.negatives}) {
            EXPECT_TRUE(is_line(*text)) << "one line of plain text: " << *text;
        }
        for (const std::string& warning : op.warnings)
            EXPECT_TRUE(is_line(warning)) << warning;
        ASSERT_NE(op.build, nullptr);
        EXPECT_TRUE(op.output == OutputKind::display_linear || op.code_power > 1);
    }
}

TEST(Registry, ParametersAreWellFormed) {
    for (const Operator& op : all_operators()) {
        std::set<std::string> names;
        for (const ParameterSpec& p : op.parameters) {
            SCOPED_TRACE(op.id + " " + p.name);
            EXPECT_TRUE(is_lower_snake(p.name));
            EXPECT_TRUE(names.insert(p.name).second) << "twice";
            EXPECT_TRUE(is_line(p.help));
            if (p.choices.empty()) {
                EXPECT_LT(p.min, p.max);
                EXPECT_LE(p.min, p.default_value);
                EXPECT_GE(p.max, p.default_value);
                EXPECT_TRUE(std::isfinite(p.min) && std::isfinite(p.max));
            } else {
                EXPECT_EQ(std::count(p.choices.begin(), p.choices.end(), p.default_choice), 1);
                EXPECT_EQ(std::set<std::string>(p.choices.begin(), p.choices.end()).size(),
                          p.choices.size());
            }
        }
    }
}

TEST(Registry, PresetsAndLooksResolve) {
    for (const Operator& op : all_operators()) {
        std::set<std::string> ids;
        for (const Preset& preset : op.presets) {
            SCOPED_TRACE(op.id + ":" + preset.id);
            EXPECT_TRUE(is_lower_snake(preset.id));
            EXPECT_TRUE(ids.insert(preset.id).second);
            EXPECT_TRUE(is_line(preset.title));
            EXPECT_FALSE(preset.settings.empty());
            EXPECT_EQ(resolve_error(op.id + ":" + preset.id), "no error");
        }
        ids.clear();
        for (const Look& look : op.looks) {
            SCOPED_TRACE(op.id + " look " + look.id);
            EXPECT_TRUE(is_lower_snake(look.id));
            EXPECT_TRUE(ids.insert(look.id).second);
            EXPECT_TRUE(is_line(look.title) && is_line(look.help));
            EXPECT_EQ(resolve_error(op.id, {}, look.id), "no error");
        }
    }
}

/// The picture of a set of colours in one list of numbers.
std::vector<double> picture(const ResolvedOperator& op) {
    const std::vector<Vector3> colours = {{0, 0, 0},        {0.01, 0.01, 0.01}, {0.18, 0.18, 0.18},
                                          {0.7, 0.3, 0.05}, {2, 4, 1},          {30, 3, 9}};
    std::vector<double> numbers;
    const Pipeline pipeline = op.build();
    for (const Vector3& rgb : colours) {
        const Vector3 out = shown(pipeline, rgb);
        numbers.insert(numbers.end(), out.begin(), out.end());
    }
    return numbers;
}

TEST(Registry, EveryParameterPresetAndLookDoesSomething) {
    for (const Operator& op : all_operators()) {
        const std::vector<double> normal = picture(resolve_operator(op.id));
        for (const ParameterSpec& p : op.parameters) {
            std::vector<std::string> values = p.choices;
            if (values.empty()) values = {shortest(p.min), shortest(p.max)};
            bool changed = false;
            for (const std::string& value : values) {
                // An end of one interval may contradict the other parameters.
                if (resolve_error(op.id, {{p.name, value}}) != "no error") continue;
                changed = changed || picture(resolve_operator(op.id, {{p.name, value}})) != normal;
            }
            EXPECT_TRUE(changed) << op.id << ": " << p.name << " is never read";
        }
        for (const Preset& preset : op.presets)
            EXPECT_NE(picture(resolve_operator(op.id + ":" + preset.id)), normal) << preset.id;
        for (const Look& look : op.looks)
            EXPECT_NE(picture(resolve_operator(op.id, {}, look.id)), normal) << look.id;
    }
}

// ---------------------------------------------------------------------------------------------
// Views

std::vector<std::string> kinds(const Pipeline& pipeline) {
    std::vector<std::string> all;
    for (const Stage& stage : pipeline)
        all.emplace_back(stage_kind(stage));
    return all;
}

Pipeline view_of(std::string_view op, std::string_view display, double stops = 0,
                 std::string_view input = "lin_rec709") {
    return build_view(make_view(resolve_operator(op), input, stops, display));
}

using Kinds = std::vector<std::string>;

TEST(View, StagesComeInOrder) {
    EXPECT_EQ(kinds(view_of("reinhard", "native")), (Kinds{"matrix", "clamp", "curve"}));
    EXPECT_EQ(kinds(view_of("reinhard", "linear")), (Kinds{"matrix", "clamp", "curve", "matrix"}));
    EXPECT_EQ(kinds(view_of("reinhard", "srgb")),
              (Kinds{"matrix", "clamp", "curve", "clamp", "curve"}));
    EXPECT_EQ(kinds(view_of("reinhard", "display_p3")),
              (Kinds{"matrix", "clamp", "curve", "clamp", "matrix", "clamp", "curve"}));
    // clamp, inset, shaper's ends, sigmoid; no negative, decode; SDR; encode
    EXPECT_EQ(
        kinds(view_of("agx_sobotka", "srgb")),
        (Kinds{"matrix", "clamp", "matrix", "clamp", "curve", "clamp", "curve", "clamp", "curve"}));
}

TEST(View, CodeValuesAreDecodedOnce) {
    for (const double x : {0.0, 0.003, 0.18, 1.0, 6.0, 15.0}) {
        const Vector3 rgb = {x, 0.6 * x, 0.2 * x};
        const Vector3 code = shown(view_of("agx_sobotka", "native"), rgb);
        Vector3 light{};
        Vector3 rec1886{};
        Vector3 srgb{};
        for (std::size_t c = 0; c < 3; ++c) {
            ASSERT_GT(code[c], -1e-12);
            ASSERT_LT(code[c], 1 + 1e-12);
            light[c] = std::pow(std::max(code[c], 0.0), 2.2);
            rec1886[c] = std::pow(light[c], 1 / 2.4);
            srgb[c] = light[c] <= 0.0031308 ? 12.92 * light[c]
                                            : 1.055 * std::pow(light[c], 1 / 2.4) - 0.055;
        }
        expect_rgb(shown(view_of("agx_sobotka", "linear"), rgb), light, kRounding, "linear");
        expect_rgb(shown(view_of("agx_sobotka", "rec1886"), rgb), rec1886, kRounding, "rec1886");
        expect_rgb(shown(view_of("agx_sobotka", "srgb"), rgb), srgb, kRounding, "srgb");
        // On a 2.2 display the operator's own code values come back.
        expect_rgb(shown(view_of("agx_sobotka", "g22"), rgb), code, 1e-12, "g22");
    }
}

TEST(View, LinearAndNativeAreNotLimited) {
    // Reinhard's equation 4 with white 4: 16 (1 + 16/16)/17
    const Vector3 bright = {16, 16, 16};
    const double over = 32.0 / 17;
    expect_rgb(shown(view_of("reinhard_extended", "native"), bright), {over, over, over},
               kRounding);
    expect_rgb(shown(view_of("reinhard_extended", "linear"), bright), {over, over, over},
               kRounding);
    expect_rgb(shown(view_of("reinhard_extended", "srgb"), bright), {1, 1, 1}, kRounding);
    // Wrensch's polynomial at 0 is -0.00232: native keeps it, light is never negative.
    EXPECT_LT(shown(view_of("agx_minimal", "native"), {0, 0, 0})[0], -0.002);
    EXPECT_EQ(shown(view_of("agx_minimal", "linear"), {0, 0, 0}), (Vector3{0, 0, 0}));
}

TEST(View, DisplayLightIsDecodedAndLimited) {
    Operator linear;
    EXPECT_EQ(shown(display_light_stages(linear), {-1, 0.5, 3}), (Vector3{0, 0.5, 1}));
    Operator code;
    code.output = OutputKind::code_value;
    code.code_power = 2;
    EXPECT_EQ(shown(display_light_stages(code), {-1, 0.5, 3}), (Vector3{0, 0.25, 1}));
}

TEST(View, ExposureIsAFactorOfTwoAStop) {
    EXPECT_EQ(shown(view_of("clamp", "linear", -3), {4, 2, 1}), (Vector3{0.5, 0.25, 0.125}));
    EXPECT_EQ(shown(view_of("clamp", "linear", 2), {0.125, 0.0625, 0.01}),
              (Vector3{0.5, 0.25, 0.04}));
    expect_rgb(shown(view_of("clamp", "linear", 0.5), {0.5, 0.25, 0}),
               {std::sqrt(0.5), std::sqrt(0.125), 0}, kRounding);
}

Vector3 multiplied_by_hand(const double (&m)[9], const Vector3& v) {
    return {m[0] * v[0] + m[1] * v[1] + m[2] * v[2], m[3] * v[0] + m[4] * v[1] + m[5] * v[2],
            m[6] * v[0] + m[7] * v[1] + m[8] * v[2]};
}

TEST(View, InputSpacesAreConverted) {
    // Saturated, inside Rec.709, and no two channels alike: a transposed or inverted matrix shows.
    // ACEScg -> Rec.709 (Bradford) in the ten digits of python_check/operators.py, rgb_to_rgb.
    const double ap1[9] = {1.7050509927,  -0.6217921207, -0.0832588720,  //
                           -0.1302564175, 1.1408047366,  -0.0105483191,  //
                           -0.0240033568, -0.1289689761, 1.1529723329};
    const Vector3 rgb = {0.6, 0.3, 0.1};
    expect_rgb(shown(view_of("clamp", "linear", 0, "lin_ap1"), rgb), multiplied_by_hand(ap1, rgb),
               1e-10, "half a unit of the tenth digit, three times");
    // ITU-R BT.2087-0, annex 2, prints BT.2020 -> BT.709 with four decimals.
    const double bt2087[9] = {1.6605,  -0.5876, -0.0728,  //
                              -0.1246, 1.1329,  -0.0083,  //
                              -0.0182, -0.1006, 1.1187};
    expect_rgb(shown(view_of("clamp", "linear", 0, "lin_rec2020"), rgb),
               multiplied_by_hand(bt2087, rgb), 6e-5, "half a unit of the fourth decimal");
    EXPECT_EQ(shown(view_of("clamp", "linear", 0, "lin_rec709"), rgb), rgb);
    // The exposure is in the same matrix.
    const Vector3 darker = multiplied_by_hand(ap1, {0.15, 0.075, 0.025});
    expect_rgb(shown(view_of("clamp", "linear", -2, "lin_ap1"), rgb), darker, 1e-10);
}

TEST(View, DisplayPrimariesAreConverted) {
    // CSS Color 4 shows the red, green and blue of sRGB in display-p3 coordinates; matrix in ten
    // digits as printed for Display P3.
    const double p3[9] = {0.8224619687, 0.1775380313, 0,  //
                          0.0331941989, 0.9668058011, 0,  //
                          0.0170826307, 0.0723974407, 0.9105199286};
    const auto srgb = [](double x) {
        return x <= 0.0031308 ? 12.92 * x : 1.055 * std::pow(x, 1 / 2.4) - 0.055;
    };
    for (const Vector3& rgb : {Vector3{1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {0.7, 0.2, 0.05}}) {
        Vector3 expected = multiplied_by_hand(p3, rgb);
        for (double& x : expected)
            x = srgb(x);
        // Half a unit of the tenth digit times the slope of the sRGB curve, 12.92.
        expect_rgb(shown(view_of("clamp", "display_p3"), rgb), expected, 2e-9);
    }
    expect_rgb(shown(view_of("clamp", "display_p3"), {1, 0, 0}), {0.91749, 0.20029, 0.13856}, 6e-6,
               "color(display-p3 0.91749 0.20029 0.13856) is #f00");
}

TEST(View, WhiteStaysWhiteOnEveryDisplay) {
    for (const InputSpace& space : all_input_spaces()) {
        for (const Display& display : all_displays()) {
            // 2 is beyond white: the clamp in between keeps it at the peak.
            expect_rgb(shown(view_of("clamp", display.id, 0, space.id), {2, 2, 2}), {1, 1, 1},
                       kRounding, space.id + " to " + display.id);
            expect_rgb(shown(view_of("clamp", display.id, 0, space.id), {0, 0, 0}), {0, 0, 0},
                       kRounding, space.id + " to " + display.id);
        }
    }
}

TEST(View, DisplaysEncodeAsTheirStandardsSay) {
    const Vector3 rgb = {0.5, 0.5, 0.5};
    // IEC 61966-2-1: 1.055 * 0.5^(1/2.4) - 0.055
    const double srgb = 0.735356983052;
    const std::map<std::string, double> expected = {{"srgb", srgb},
                                                    {"display_p3", srgb},
                                                    {"rec1886", std::pow(0.5, 1 / 2.4)},
                                                    {"rec2020", std::pow(0.5, 1 / 2.4)},
                                                    {"g22", std::pow(0.5, 1 / 2.2)}};
    EXPECT_EQ(expected.size(), all_displays().size()) << "a display without expected values";
    for (const auto& [id, code] : expected)
        expect_rgb(shown(view_of("clamp", id), rgb), {code, code, code}, 1e-12, id);
}

TEST(View, DecodingInvertsEncoding) {
    for (const Display& display : all_displays()) {
        for (const double x : {0.0, 0.001, 0.01, 0.18, 0.5, 1.0}) {
            EXPECT_NEAR(evaluate(display.decode, evaluate(display.encode, x)), x, kRounding)
                << display.id;
        }
    }
}

TEST(View, NamesAreFoundByIdTitleAliasAndInAnyCase) {
    for (const char* name : {"lin_ap1", "ACEScg", "acescg", "LIN_AP1", "ACES - ACEScg"})
        EXPECT_EQ(find_input_space(name).id, "lin_ap1") << name;
    EXPECT_EQ(find_input_space("linear").id, "lin_rec709") << "what OIIO calls an EXR";
    EXPECT_EQ(find_input_space("aces2065-1").id, "lin_ap0");
    EXPECT_EQ(find_input_space("aces2065_1").id, "lin_ap0");
    for (const char* name : {"display_p3", "Display P3", "displayP3_Display"})
        EXPECT_EQ(find_display(name).id, "display_p3") << name;
    const View view = make_view(resolve_operator("clamp"), "acescg", 0, "REC.1886");
    EXPECT_EQ(view.input, "lin_ap1") << "views hold ids";
    EXPECT_EQ(view.display, "rec1886");
}

TEST(View, NamesAreUnambiguous) {
    std::map<std::string, std::string> owner;
    const auto claim = [&](const std::string& name, const std::string& id) {
        const auto [it, is_new] = owner.emplace(lower(name), id);
        EXPECT_TRUE(is_new || it->second == id) << name << " is " << it->second << " and " << id;
    };
    for (const InputSpace& space : all_input_spaces()) {
        claim(space.id, space.id);
        claim(space.title, space.id);
        for (const std::string& alias : space.aliases)
            claim(alias, space.id);
    }
    owner.clear();
    for (const Display& display : all_displays()) {
        claim(display.id, display.id);
        claim(display.title, display.id);
        for (const std::string& alias : display.aliases)
            claim(alias, display.id);
        EXPECT_NE(lower(display.id), kLinearOutput);
        EXPECT_NE(lower(display.id), kNativeOutput);
    }
}

TEST(View, UnknownNamesGetTheNearest) {
    const auto view_error = [](std::string_view input, double stops, std::string_view display) {
        return error_of([&] { (void)make_view(resolve_operator("clamp"), input, stops, display); });
    };
    EXPECT_EQ(view_error("lin_rec708", 0, "srgb"),
              "input space is lin_rec708; expected lin_rec709, lin_ap1, lin_ap0, lin_rec2020, "
              "lin_p3d65 or lin_egamut; did you mean lin_rec709?");
    EXPECT_EQ(view_error("bayer", 0, "srgb"),
              "input space is bayer; expected lin_rec709, lin_ap1, lin_ap0, lin_rec2020, "
              "lin_p3d65 or lin_egamut");
    EXPECT_EQ(
        view_error("lin_rec709", 0, "srbg"),
        "display is srbg; expected srgb, display_p3, rec1886, rec2020, g22, linear or native; "
        "did you mean srgb?");
    EXPECT_EQ(view_error("lin_rec709", 65, "srgb"), "exposure is 65; expected [-64, 64] stops");
    EXPECT_EQ(view_error("lin_rec709", -64.5, "srgb"),
              "exposure is -64.5; expected [-64, 64] stops");
    EXPECT_EQ(view_error("lin_rec709", std::nan(""), "srgb"),
              "exposure is nan; expected [-64, 64] stops");
    EXPECT_EQ(view_error("lin_rec709", kInfinity, "srgb"),
              "exposure is inf; expected [-64, 64] stops");
    for (const double end : {-64.0, 64.0})
        EXPECT_EQ(view_error("lin_rec709", end, "srgb"), "no error");
}

TEST(View, MisspeltOutputsGetTheNearestToo) {
    EXPECT_NE(error_of([] {
                  (void)make_view(resolve_operator("clamp"), "lin_rec709", 0, "nativ");
              }).find("did you mean native?"),
              std::string::npos);
}

TEST(View, KeepsGreysWithinHalfACodeOfTenBits) {
    EXPECT_TRUE(keeps_greys({}));
    EXPECT_TRUE(keeps_greys(view_of("hable", "srgb")));
    const auto offset = [](double codes) {
        return Pipeline{CurveStage{{0.5, 0.5 + codes / 1023, 0.5}, std::nullopt}};
    };
    EXPECT_TRUE(keeps_greys(offset(0.49)));
    EXPECT_FALSE(keeps_greys(offset(0.51)));
    EXPECT_TRUE(keeps_greys(offset(-0.49)));
    EXPECT_FALSE(keeps_greys(offset(-0.51)));
    // Golden is a warm look: slopes 1, 0.9, 0.5.
    EXPECT_FALSE(keeps_greys(build_view(
        make_view(resolve_operator("agx_sobotka", {}, "golden"), "lin_rec709", 0, "srgb"))));
    // Tinted in the brightest stop alone.
    EXPECT_FALSE(keeps_greys({CurveStage{{kX, kX, select(less(8000, kX), 0, kX)}, std::nullopt}}));
    EXPECT_FALSE(keeps_greys({CurveStage{{kX, kX, select(less(kX, 4e-6), 1, kX)}, std::nullopt}}));
}

}  // namespace
}  // namespace tonewright
