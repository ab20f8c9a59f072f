// SPDX-License-Identifier: Apache-2.0
#include "tonewright/registry.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <random>
#include <set>

#include "base/format_number.h"
#include "base/strings.h"
#include "tonewright/pipeline.h"
#include "tonewright/view.h"
#include "unit/errors.h"
#include "unit/pipeline/shown.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

TEST(Resolve, OneGrammarForAll) {
    const auto label_of = [](std::string_view text) { return resolve_operator(text).label; };
    for (const char* text : {"hable", "Hable", "HABLE", "Hable (Uncharted 2)", " hable "})
        EXPECT_EQ(label_of(text), "hable") << text;
    for (const char* text : {"AgX", "agx", "AgX (Blender)", "agx-blender", "AGX BLENDER"})
        EXPECT_EQ(label_of(text), "agx_blender") << text;
    for (const char* text :
         {"AgX Punchy", "agx_punchy", "AgX - Punchy", "agx_blender:look=punchy", "AgX:look=Punchy",
          "agx_blender look=punchy", "AgX Punchy:look=punchy"})
        EXPECT_EQ(label_of(text), "agx_blender look=punchy") << text;
    for (const char* text : {"hable:white=4:exposure_bias=1", "Hable:Exposure-Bias=1:WHITE=4",
                             "hable white=4 exposure_bias=1"})
        EXPECT_EQ(label_of(text), "hable exposure_bias=1 white=4") << text;
    EXPECT_EQ(label_of("reinhard:luminance"), "reinhard:luminance");
    EXPECT_EQ(label_of("Reinhard:Apply=Hue-Preserving"), "reinhard apply=hue_preserving");
    EXPECT_EQ(label_of("reinhard:luminance:apply=channels"), "reinhard:luminance apply=channels")
        << "the operator's default, but not the preset's";
    EXPECT_EQ(resolve_operator("hable:white=4", {{"White", "4"}}).settings,
              (Settings{{"white", "4"}}));
}

/// Every operator with each preset and look, and with a setting that is hard to write.
TEST(Resolve, PrintedNamesResolve) {
    const auto expect_same = [](const ResolvedOperator& op) {
        const ResolvedOperator again = resolve_picture_operator(operator_text(op));
        EXPECT_EQ(again.op, op.op) << operator_text(op);
        EXPECT_EQ(again.params, op.params) << operator_text(op);
        EXPECT_EQ(resolve_picture_operator(op.label).params, op.params) << op.label;
    };
    for (const OperatorVariant& v : all_variants())
        expect_same(resolve_operator(v.name, {}, v.look));
    for (const Operator& op : local_operators())
        expect_same(resolve_picture_operator(op.id));
    expect_same(
        resolve_operator("reinhard_extended:luminance", {{"white", "2.5"}, {"apply", "max"}}));
    const std::string primaries = "0.64 0.33 0.3 0.6 0.15 0.06 0.3127 0.329";
    const ResolvedOperator spaced = resolve_operator("aces_20", {{"primaries", primaries}});
    EXPECT_EQ(operator_text(spaced), "aces_20:primaries=" + primaries);
    expect_same(spaced);
    EXPECT_EQ(operator_text(resolve_operator("hable", {{"white", "11.2"}})), "hable")
        << "the default says nothing";
}

TEST(Resolve, NamesMeanOneOperator) {
    std::map<std::string, std::string> meant;
    const auto claim = [&](const std::string& name, const std::string& what) {
        const auto [known, is_new] = meant.emplace(folded_name(name), what);
        EXPECT_TRUE(is_new || known->second == what)
            << name << " is " << known->second << " and " << what;
        EXPECT_EQ(name.find(':'), std::string::npos) << name;
    };
    for (const Operator& op : all_operators()) {
        for (const std::string& name : {op.id, op.view, op.title}) {
            claim(name, op.id);
            EXPECT_EQ(&find_operator(name), &op) << name;
        }
        for (const std::string& name : {op.view, op.title}) {
            for (const Look& look : op.looks)
                claim(name + " " + look.title, op.id + " look=" + look.id);
        }
    }
}

TEST(Resolve, UnknownNamesGetTheNearest) {
    EXPECT_EQ(resolve_error("habel"),
              "operator is habel; expected an id from the list of operators; did you mean hable?");
    EXPECT_EQ(resolve_error("foo"), "operator is foo; expected an id from the list of operators");
    EXPECT_EQ(
        resolve_error("filmic"),
        "operator is filmic; expected aces_hill:threejs, hable:no_bias, hable:gdc, aces_narkowicz, "
        "hejl_burgess_dawson, hable:godot or lottes:vtk; programs that use the name: the list of "
        "engines; Blender's Filmic is a table without a formula: give its LUT file as the operator "
        "(docs/choosing.md); filmic formulas are hable and unreal");
    EXPECT_EQ(resolve_error("agx_blender:punchy"),
              "agx_blender: preset is punchy; expected formula or hdr; did you mean look=punchy?");
    EXPECT_EQ(resolve_error("photoshop"),
              "operator is photoshop; expected an id from the list of operators");
    EXPECT_EQ(resolve_error("reinhard_extended", {{"whit", "2"}}),
              "reinhard_extended: parameter is whit; expected white, apply, "
              "color_correction, saturation or saturation_from; did you mean white?");
    EXPECT_EQ(resolve_error("clamp", {{"white", "2"}}),
              "clamp: parameter is white; expected apply");
    EXPECT_EQ(resolve_error("reinhard_extended:lumnance"),
              "reinhard_extended: preset is lumnance; expected luminance, max or cesium; did you "
              "mean luminance?");
    EXPECT_EQ(resolve_error("reinhard_extended:"),
              "reinhard_extended: preset is ; expected luminance, max or cesium");
    EXPECT_EQ(resolve_error("ue3:filmic"),
              "ue3: preset is filmic; expected none: ue3 has no presets");
    EXPECT_EQ(resolve_error("agx_sobotka", {}, "goldn"),
              "agx_sobotka: look is goldn; expected golden or punchy; did you mean golden?");
    EXPECT_EQ(resolve_error("hable", {}, "golden"),
              "hable: look is golden; expected none: hable has no looks");
    EXPECT_EQ(resolve_error("reinhard", {{"apply", "chanels"}}),
              "reinhard: apply is chanels; expected channels, luminance, max or "
              "hue_preserving; did you mean channels?");
    EXPECT_EQ(resolve_error("reinhard", {{"apply", ""}}),
              "reinhard: apply is ; expected channels, luminance, max or hue_preserving");
}

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

TEST(Registry, OperatorsAreDescribed) {
    std::set<std::string> views;
    for (const Operator& op : all_operators()) {
        SCOPED_TRACE(op.id);
        EXPECT_TRUE(views.insert(lower(op.view)).second) << "OCIO compares views without case";
        EXPECT_LE(op.view.size(), 63U) << "Blender's limit";
        for (const std::string* text :
             {&op.title, &op.view, &op.character, &op.source, &op.license, &op.negatives}) {
            EXPECT_TRUE(is_line(*text)) << "one line of plain text: " << *text;
        }
        for (const std::string& warning : op.warnings)
            EXPECT_TRUE(is_line(warning) && warning.back() != '.') << warning;
        const bool is_bound_as_usual =
            op.bounds.simd == 1e-6 && op.bounds.ocio_cpu == 0 && op.bounds.ocio_gpu == 0;
        EXPECT_TRUE(is_bound_as_usual || is_line(op.bounds.reason)) << "a bound needs its reason";
        ASSERT_NE(op.build, nullptr);
        EXPECT_TRUE(op.output == OutputKind::display_linear || op.code_power > 1);
    }
}

TEST(Registry, KnownDefectsAreInNoListAndNoNameFindsThem) {
    ASSERT_GE(known_defects().size(), 5U);
    for (const Operator& defect : known_defects()) {
        SCOPED_TRACE(defect.id);
        EXPECT_TRUE(is_lower_snake(defect.id));
        EXPECT_TRUE(is_line(defect.defect) && defect.defect.back() != '.');
        EXPECT_TRUE(is_line(defect.source) && is_line(defect.license));
        EXPECT_FALSE(resolve_operator(defect.meant).op->is_defect());
        for (const std::vector<Operator>* listed : {&all_operators(), &local_operators()}) {
            for (const Operator& op : *listed)
                EXPECT_NE(op.id, defect.id);
        }
        for (const OperatorVariant& v : all_variants())
            EXPECT_NE(v.name, defect.id);
        const std::string error = resolve_error(defect.id, {});
        EXPECT_NE(error.find("expected an id"), std::string::npos) << error;
        for (const Operator& other : known_defects())
            EXPECT_EQ(error.find(other.id, error.find("expected")), std::string::npos) << error;
    }
    for (const Operator& op : all_operators())
        EXPECT_TRUE(!op.is_defect() && op.meant.empty()) << op.id;
}

TEST(Registry, ParametersAreWellFormed) {
    for (const Operator& op : all_operators()) {
        std::set<std::string> names;
        for (const ParameterSpec& p : op.parameters) {
            SCOPED_TRACE(op.id + " " + p.name);
            EXPECT_TRUE(is_lower_snake(p.name));
            EXPECT_TRUE(names.insert(p.name).second) << "twice";
            EXPECT_TRUE(is_line(p.help));
            EXPECT_EQ(p.from_picture != nullptr, !p.statistic.empty());
            switch (p.kind) {
                case ParameterSpec::Kind::number:
                    EXPECT_LT(p.min, p.max);
                    EXPECT_LE(p.min, p.default_value);
                    EXPECT_GE(p.max, p.default_value);
                    EXPECT_TRUE(std::isfinite(p.min) && std::isfinite(p.max));
                    EXPECT_TRUE(p.choices.empty());
                    break;
                case ParameterSpec::Kind::choice:
                    EXPECT_EQ(std::count(p.choices.begin(), p.choices.end(), p.default_choice), 1);
                    EXPECT_EQ(std::set<std::string>(p.choices.begin(), p.choices.end()).size(),
                              p.choices.size());
                    EXPECT_EQ(p.from_picture, nullptr);
                    break;
                case ParameterSpec::Kind::text:
                    EXPECT_TRUE(p.choices.empty());
                    EXPECT_EQ(p.from_picture, nullptr);
                    break;
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

/// The picture of a set of colors in one list of numbers.
std::vector<double> picture(const ResolvedOperator& op) {
    const std::vector<Vector3> colors = {{0, 0, 0},        {0.01, 0.01, 0.01}, {0.18, 0.18, 0.18},
                                         {0.7, 0.3, 0.05}, {2, 4, 1},          {30, 3, 9}};
    std::vector<double> numbers;
    const Pipeline pipeline = op.build();
    for (const Vector3& rgb : colors) {
        const Vector3 out = shown(pipeline, rgb);
        numbers.insert(numbers.end(), out.begin(), out.end());
    }
    return numbers;
}

/// Half of the parameters moved, by little or much: some are read with certain others only.
Settings random_settings(const Operator& op, std::mt19937& random) {
    const auto uniform = [&] { return static_cast<double>(random()) * 0x1p-32; };
    Settings settings;
    for (const ParameterSpec& p : op.parameters) {
        if (p.kind == ParameterSpec::Kind::text || uniform() < 0.5) continue;
        if (p.kind == ParameterSpec::Kind::choice) {
            settings[p.name] = p.choices[random() % p.choices.size()];
        } else {
            const double end = uniform() < 0.5 ? p.min : p.max;
            const double way = std::pow(10, -5 * uniform());
            settings[p.name] = shortest(p.default_value + way * (end - p.default_value));
        }
    }
    return settings;
}

/// True when some settings show another picture, or are refused, without what they have of `p`.
bool does_something(const Operator& op, const ParameterSpec& p) {
    std::mt19937 random(7);
    for (int i = 0; i < 2000; ++i) {
        const Settings with = random_settings(op, random);
        Settings without = with;
        if (without.erase(p.name) == 0 || resolve_error(op.id, with) != "no error") continue;
        if (resolve_error(op.id, without) != "no error") return true;
        if (picture(resolve_operator(op.id, with)) != picture(resolve_operator(op.id, without)))
            return true;
    }
    return false;
}

TEST(Registry, EveryParameterPresetAndLookHasAnEffect) {
    for (const Operator& op : all_operators()) {
        const std::vector<double> normal = picture(resolve_operator(op.id));
        for (const ParameterSpec& p : op.parameters) {
            if (p.kind == ParameterSpec::Kind::text) continue;  // names a file, or what is in it
            EXPECT_TRUE(does_something(op, p)) << op.id << ": " << p.name << " is never read";
        }
        for (const Preset& preset : op.presets) {
            const std::string name = op.id + ":" + preset.id;
            // A name for the default, beside those of the filter's other curves; and a preset that
            // counts with another bias.
            if (name == "ffmpeg:hable" || name == "drago:pfstmo") continue;
            EXPECT_NE(picture(resolve_operator(name)), normal) << name;
        }
        for (const Look& look : op.looks)
            EXPECT_NE(picture(resolve_operator(op.id, {}, look.id)), normal) << look.id;
    }
    EXPECT_NE(picture(resolve_operator("drago:pfstmo:bias=0.7")),
              picture(resolve_operator("drago:bias=0.7")));
}

TEST(Registry, DialectsAreAtLeastTwo) {
    std::map<std::string, int> count;
    for (const Operator& op : all_operators()) {
        EXPECT_TRUE(op.dialects.empty() || is_line(op.dialects)) << op.id;
        ++count[op.dialects];
    }
    count.erase("");
    for (const auto& [name, n] : count)
        EXPECT_GE(n, 2) << name;
}

TEST(Registry, PictureOperatorsIncludeLocalOnes) {
    ASSERT_FALSE(local_operators().empty());
    for (const Operator& op : local_operators()) {
        EXPECT_EQ(&find_picture_operator(op.id), &op);
        EXPECT_THROW((void)find_operator(op.id), Error) << op.id;
    }
    for (const Operator& op : all_operators()) {
        EXPECT_EQ(&find_picture_operator(op.id), &op);
        EXPECT_EQ(&find_operator(op.view), &op) << "the name of its view";
    }
    EXPECT_NE(error_of([] {
                  (void)find_picture_operator("reinhard_locall");
              }).find("did you mean reinhard_local?"),
              std::string::npos);
}

TEST(Resolve, ManyTextsAreOperatorsInTheirOrder) {
    const std::vector<ResolvedOperator> two = resolve_operators({"reinhard", "hable:white=4"});
    ASSERT_EQ(two.size(), 2U);
    EXPECT_EQ(two[0].label, "reinhard");
    EXPECT_EQ(two[1].params.number("white"), 4);
    EXPECT_TRUE(resolve_operators({}).empty());
    EXPECT_EQ(resolve_operators({"hable", "All"}).size(), all_variants().size());
    EXPECT_THROW((void)resolve_operators({"hable", "reinhardd"}), Error);
    EXPECT_THROW((void)resolve_operators({local_operators().front().id}), Error);
    for (const Operator& op : local_operators())
        EXPECT_THROW(require_no_surroundings(op), Error) << op.id;
    EXPECT_NO_THROW(require_no_surroundings(find_operator("hable")));
}

TEST(Resolve, AnOperatorsOwnSettingsTakePrecedenceOverDefaults) {
    const ResolvedOperator own = resolve_operator("reinhard_extended:white=6");
    EXPECT_EQ(with_defaults(own, {{"White", "9"}}, "").params.number("white"), 6);
    const ResolvedOperator plain = resolve_operator("reinhard_extended");
    EXPECT_EQ(with_defaults(plain, {{"White", "9"}}, "").params.number("white"), 9);
    EXPECT_EQ(with_defaults(resolve_operator("agx_sobotka"), {}, "golden").params.look(), "golden");
    EXPECT_EQ(
        with_defaults(resolve_operator("agx_sobotka:look=punchy"), {}, "golden").params.look(),
        "punchy");
    EXPECT_THROW((void)with_defaults(plain, {{"whitte", "9"}}, ""), Error);
}

}  // namespace
TONEWRIGHT_NAMESPACE_END
