// SPDX-License-Identifier: Apache-2.0
#include "tonewright/pipeline.h"

#include <gtest/gtest.h>

#include <map>

#include "tonewright/registry.h"
#include "tonewright/view.h"
#include "unit/errors.h"
#include "unit/pipeline/shown.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

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

TEST(Resolve, ContradictionsAreRefused) {
    EXPECT_EQ(resolve_error("hable:white=4:white=5"), "hable: white is 4 and 5; expected it once");
    EXPECT_EQ(resolve_error("hable:white=4", {{"white", "5"}}),
              "hable: white is 4 and 5; expected it once");
    EXPECT_EQ(resolve_error("hable", {{"white", "4"}, {"WHITE", "5"}}),
              "hable: white is 5 and 4; expected it once");
    EXPECT_EQ(resolve_error("AgX Punchy", {}, "greyscale"),
              "agx_blender: look is punchy and greyscale; expected one");
    EXPECT_EQ(resolve_error("reinhard:luminance:max"),
              "reinhard: preset is luminance and max; expected one");
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

TEST(Resolve, RefusesTextsThatAreNotNumbersOrOutOfRange) {
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
    // Lottes' curve x^a/(b x^(ad) + c) has a shoulder for b > 0, which is mid_out >
    // (mid_in/hdr_max)^a, and a toe for c > 0, which is mid_out < (mid_in/hdr_max)^(a(1 - d)).
    // Filament's has d = 1.
    const auto refuses_mid_out = [](const char* name, const char* mid_out,
                                    const std::string& expected) {
        const std::string said = resolve_error(name, {{"contrast", "1"}, {"mid_out", mid_out}});
        EXPECT_EQ(said.rfind(std::string(name) + ": mid_out is " + mid_out + expected, 0), 0U)
            << said;
    };
    refuses_mid_out("filament_generic", "0.0179", "; expected between 0.018");  // 0.18 / 10
    refuses_mid_out("filament_generic", "1", "; expected between 0.018");
    refuses_mid_out("lottes", "0.0224", "; expected above 0.0225");  // 0.18 / 8
    refuses_mid_out("lottes", "0.92", "; expected below 0.916");     // (0.18 / 8)^0.023
    EXPECT_EQ(resolve_error("filament_generic", {{"contrast", "1"}, {"mid_out", "0.0181"}}),
              "no error");
    EXPECT_EQ(resolve_error("lottes", {{"contrast", "1"}, {"mid_out", "0.0226"}}), "no error");
    EXPECT_EQ(resolve_error("lottes", {{"contrast", "1"}, {"mid_out", "0.91"}}), "no error");
    // E = F: h(x) = (x(Ax + CB) + DF)/(x(Ax + B) + DF) - 1 < 0, for C below 1.
    EXPECT_NE(resolve_error("hable", {{"toe_numerator", "0.3"}}), "no error");
    EXPECT_EQ(resolve_error("hable", {{"toe_numerator", "0.05"}}), "no error");
}

const std::string kResponseFile = TONEWRIGHT_TEST_DATA "/synthetic_response.rf";

TEST(Resolve, TextsAreTakenAsTheyAre) {
    const ResolvedOperator none = resolve_operator("camera_response");
    EXPECT_EQ(none.params.text("file"), "");
    EXPECT_EQ(none.params.text("curve"), "");
    EXPECT_EQ(none.params.number("iso"), 6);
    EXPECT_THROW((void)none.params.text("iso"), Error) << "a number is no text";
    EXPECT_THROW((void)none.params.number("file"), Error);
    EXPECT_THROW((void)none.params.choice("file"), Error);
    EXPECT_THROW((void)resolve_operator("reinhard").params.text("apply"), Error);

    const ResolvedOperator file = resolve_operator("camera_response", {{"file", kResponseFile}});
    EXPECT_EQ(file.params.text("file"), kResponseFile);
    EXPECT_EQ(file.label, "camera_response file=" + kResponseFile);
    EXPECT_EQ(resolve_operator("camera_response", {{"file", ""}}).label, "camera_response");
    const Vector3 gray = {0.5, 0.5, 0.5};
    EXPECT_NE(shown(file.build(), gray), shown(none.build(), gray));
    const ResolvedOperator blue =
        resolve_operator("camera_response", {{"file", kResponseFile}, {"curve", "blue"}});
    EXPECT_EQ(shown(blue.build(), gray)[0], shown(file.build(), gray)[2]);
}

TEST(Resolve, UnknownTextsAreErrors) {
    EXPECT_EQ(resolve_error("camera_response", {{"curve", "gold"}}),
              "camera_response: curve is gold; expected a file that has it");
    // A file that is missing is no wrong usage: the command exits with another code.
    EXPECT_THROW((void)resolve_operator("camera_response", {{"file", "/nonexistent.rf"}}),
                 FileError);
    const std::string missing = resolve_error("camera_response", {{"file", "/nonexistent.rf"}});
    EXPECT_EQ(missing.rfind("camera_response: /nonexistent.rf", 0), 0U) << missing;
    const std::string curve =
        resolve_error("camera_response", {{"file", kResponseFile}, {"curve", "gold"}});
    EXPECT_EQ(curve.rfind("camera_response: ", 0), 0U) << curve;
    EXPECT_NE(curve.find("gold"), std::string::npos) << curve;
}

TEST(Parameter, KindsAreMadeByTheirFunctions) {
    using Kind = ParameterSpec::Kind;
    const ParameterSpec number = number_parameter("a", "stops", 1, 0, 2, "help");
    EXPECT_EQ(number.kind, Kind::number);
    EXPECT_EQ(number.from_picture, nullptr);
    const ParameterSpec choice = choice_parameter("b", {"x", "y"}, "y", "help");
    EXPECT_EQ(choice.kind, Kind::choice);
    EXPECT_EQ(choice.default_choice, "y");
    const ParameterSpec text = text_parameter("c", "help");
    EXPECT_EQ(text.kind, Kind::text);
    EXPECT_EQ(text.default_choice, "");
    EXPECT_TRUE(text.choices.empty());
    const ParameterSpec statistic = statistic_parameter(
        number, "mean", [](const SceneStatistics& s) { return s.mean_luminance; });
    EXPECT_EQ(statistic.kind, Kind::number);
    EXPECT_EQ(statistic.name, "a");
    EXPECT_EQ(statistic.default_value, 1);
    EXPECT_EQ(statistic.statistic, "mean");
    SceneStatistics s;
    s.mean_luminance = 0.25;
    EXPECT_EQ(statistic.from_picture(s), 0.25);
}

SceneStatistics some_scene() {
    SceneStatistics s;
    s.log_average = 0.11;
    s.mean_luminance = 0.37;
    s.minimum_luminance = 0.0003;
    s.maximum_luminance = 41.7;
    s.mean_rgb = {0.5, 0.3, 0.2};
    s.maximum_rgb = {50, 40, 30};
    return s;
}

TEST(Statistics, FillUnsetParameters) {
    EXPECT_EQ(resolve_for_picture(resolve_operator("exponential"), some_scene()).settings,
              (Settings{{"average", "0.37"}}));
    EXPECT_EQ(resolve_for_picture(resolve_operator("drago"), some_scene()).settings,
              (Settings{{"log_average", "0.11"}, {"maximum", "41.7"}}));
    EXPECT_EQ(resolve_operator("exponential").params.number("average"), 1)
        << "without a picture the default";
    // An operator that asks nothing of a picture gets nothing.
    EXPECT_EQ(resolve_for_picture(resolve_operator("hable"), some_scene()).settings, Settings{});
    EXPECT_EQ(
        resolve_for_picture(resolve_operator("hable", {{"white", "4"}}), some_scene()).settings,
        (Settings{{"white", "4"}}));
}

TEST(Statistics, TheUserWins) {
    EXPECT_EQ(resolve_for_picture(resolve_operator("exponential", {{"average", "3"}}), some_scene())
                  .settings,
              (Settings{{"average", "3"}}));
    EXPECT_EQ(resolve_for_picture(resolve_operator("drago", {{"maximum", "9"}, {"bias", "0.7"}}),
                                  some_scene())
                  .settings,
              (Settings{{"bias", "0.7"}, {"log_average", "0.11"}, {"maximum", "9"}}));
}

/// A preset that lives as long as this does: no operator has one that sets a statistic.
class PresetForTest {
  public:
    // The registry's vector is const, its elements are not.
    PresetForTest(std::string_view id, Preset preset)
        : op_(const_cast<Operator&>(find_operator(id))) {
        op_.presets.push_back(std::move(preset));
    }
    ~PresetForTest() { op_.presets.pop_back(); }
    PresetForTest(const PresetForTest&) = delete;
    PresetForTest& operator=(const PresetForTest&) = delete;

  private:
    Operator& op_;
};

TEST(Statistics, ThenThePreset) {
    const PresetForTest preset("drago", {"bright", "Bright", {{"maximum", "20"}}});
    const Settings of_picture =
        resolve_for_picture(resolve_operator("drago:bright"), some_scene()).settings;
    EXPECT_EQ(of_picture, (Settings{{"log_average", "0.11"}}));
    const Params params = resolve_operator("drago:bright", of_picture).params;
    EXPECT_EQ(params.number("maximum"), 20);
    EXPECT_EQ(params.number("log_average"), 0.11);
    const Settings of_user =
        resolve_for_picture(resolve_operator("drago:bright", {{"maximum", "7"}}), some_scene())
            .settings;
    EXPECT_EQ(resolve_operator("drago:bright", of_user).params.number("maximum"), 7);
}

TEST(Statistics, AreLimitedToTheInterval) {
    SceneStatistics s = some_scene();
    s.mean_luminance = 1e9;
    EXPECT_EQ(resolve_for_picture(resolve_operator("exponential"), s).settings,
              (Settings{{"average", "65504"}}));
    EXPECT_EQ(resolve_for_picture(resolve_operator("exponential"), {}).settings,
              (Settings{{"average", "1e-06"}}));
}

TEST(Statistics, KeepEveryDigit) {
    SceneStatistics s;
    s.mean_luminance = 0.1 + 0.2;  // 0.30000000000000004
    EXPECT_EQ(resolve_operator("exponential",
                               resolve_for_picture(resolve_operator("exponential"), s).settings)
                  .params.number("average"),
              0.1 + 0.2);
}

TEST(Statistics, OfEveryPictureAreAccepted) {
    // Black; one gray; a pixel of light in the dark; the brightest there is.
    SceneStatistics uniform = {0.18, 0.18, 0.18, 0.18, {0.18, 0.18, 0.18}, {0.18, 0.18, 0.18}};
    SceneStatistics spark = {65504, 0.01, 65504, 65504, {0.01, 0.01, 0.01}, {65504, 65504, 65504}};
    SceneStatistics dim = {5e-324, 5e-324, 5e-324, 5e-324, {0, 0, 7e-323}, {0, 0, 7e-323}};
    SceneStatistics wide = {1, 100, 1e-45, 65504, {100, 100, 100}, {65504, 65504, 65504}};
    for (const SceneStatistics& s : {SceneStatistics{}, uniform, spark, dim, wide, some_scene()}) {
        for (const Operator& op : all_operators()) {
            EXPECT_EQ(
                resolve_error(op.id, resolve_for_picture(resolve_operator(op.id), s).settings),
                "no error");
            for (const Preset& preset : op.presets) {
                const std::string name = op.id + ":" + preset.id;
                EXPECT_EQ(
                    resolve_error(name, resolve_for_picture(resolve_operator(name), s).settings),
                    "no error");
            }
        }
    }
}

TEST(Parameter, FixedOnesAreNotLive) {
    const auto specs = fixed_parameters({number_parameter("a", "", 1, 0, 2, "A number."),
                                         choice_parameter("b", {"x", "y"}, "x", "A choice.")});
    ASSERT_EQ(specs.size(), 2U);
    for (const ParameterSpec& spec : specs)
        EXPECT_FALSE(spec.is_live) << spec.name;
    EXPECT_TRUE(number_parameter("a", "", 1, 0, 2, "A number.").is_live) << "else";
}

TEST(Parameter, DisplaysReplaceTheDefaultAlone) {
    Operator op;
    op.id = "peaked";
    op.parameters = {display_parameter(
        number_parameter("peak", "cd/m2", 100, 100, 4000, "Peak."), [](const DisplayFacts& d) {
            return d.is_hdr ? std::to_string(static_cast<int>(d.peak)) : std::string();
        })};
    op.build = [](const Params& p) -> Pipeline {
        return {curve_stage(Expr::input(0) / p.number("peak"))};
    };
    const auto peak = [&](const Settings& settings, const DisplayFacts& display) {
        return resolve_for_display(resolve(op, nullptr, settings, ""), display)
            .params.number("peak");
    };
    EXPECT_EQ(peak({}, {kRec2020, true, 1000}), 1000);
    EXPECT_EQ(peak({}, {kRec709, false, 100}), 100) << "an empty text: the default";
    EXPECT_EQ(peak({{"peak", "300"}}, {kRec2020, true, 1000}), 300) << "the user wins";
}

TEST(Resolve, FindPresetIgnoresCaseAndNamesTheNearest) {
    const Operator& op = find_operator("reinhard_extended");
    EXPECT_EQ(find_preset(op, "LUMINANCE").id, "luminance");
    for (const Preset& preset : op.presets)
        EXPECT_EQ(&find_preset(op, preset.id), &preset);
    EXPECT_EQ(error_of([&] {
                  (void)find_preset(op, op.presets[0].id + "x");
              }).find("reinhard_extended: preset is " + op.presets[0].id + "x; expected"),
              0U);
    // The look of an operator is no preset, and the message says so.
    const std::string error =
        error_of([] { (void)find_preset(find_operator("agx_blender"), "punchy"); });
    EXPECT_NE(error.find("did you mean look=punchy?"), std::string::npos) << error;
}

}  // namespace
TONEWRIGHT_NAMESPACE_END
