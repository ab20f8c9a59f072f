// SPDX-License-Identifier: Apache-2.0
#include "tonewright/engines.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <set>
#include <string>

#include "tonewright/registry.h"
#include "unit/errors.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

std::string operator_of(std::string_view name) {
    const EngineToneMapper* row = find_engine_tone_mapper(name);
    return row ? row->op : "none";
}

TEST(Engines, NamesAsPeopleTypeThem) {
    for (const char* name :
         {"three.js ACESFilmicToneMapping", "threejs aces filmic", "three ACES",
          "THREE.JS: aces-filmic", "three_js ACESFilmic", "three.js 0.187.0 ACES"})
        EXPECT_EQ(operator_of(name), "aces_hill:threejs") << name;
    for (const char* name : {"Babylon.js Standard", "babylon standard", "BabylonJS STANDARD"})
        EXPECT_EQ(operator_of(name), "exponential:babylon") << name;
    EXPECT_EQ(operator_of("babylon aces"), "aces_hill");
    EXPECT_EQ(operator_of("PlayCanvas ACES2"), "aces_hill:threejs");
    EXPECT_EQ(operator_of("playcanvas 1.60.0 aces2"), "aces_hill") << "an older version";
    EXPECT_EQ(operator_of("three.js AgX r160"), "agx_threejs");
    EXPECT_EQ(operator_of("three.js AgX"), "agx_threejs:r161") << "the newest version";
    EXPECT_EQ(operator_of("Unity Neutral"), "hable:unity_neutral");
    EXPECT_EQ(operator_of("Godot Filmic"), "hable:godot") << "Forward+ comes first";
    EXPECT_EQ(operator_of("cesium aces"), "aces_cesium");
    for (const char* name : {"", "three.js", "three.js unknown", "ACES", "aces_hill"})
        EXPECT_EQ(find_engine_tone_mapper(name), nullptr) << name;
}

TEST(Engines, ResolveWithSettings) {
    EXPECT_EQ(resolve_operator("Godot Filmic").label, "hable:godot");
    EXPECT_EQ(resolve_operator("Godot Filmic:white=3").label, "hable:godot white=3");
    EXPECT_EQ(resolve_operator("babylon ACES prescale=2").label, "aces_hill prescale=2");
}

TEST(Engines, OwnNamesComeFirst) {
    EXPECT_EQ(resolve_operator("AgX").label, "agx_blender");
    EXPECT_EQ(resolve_operator("AgX three.js").label, "agx_threejs");
    EXPECT_EQ(resolve_operator("Standard").label, "clamp");
}

TEST(Engines, RefuseWhatNoOperatorComputes) {
    EXPECT_EQ(error_of([] { (void)resolve_operator("Blender Filmic"); }),
              "operator is Blender Filmic, which no operator computes (a table without a formula; "
              "give its LUT file as the operator); expected an id from the list of operators");
    const std::string unknown = error_of([] { (void)resolve_operator("babylon foo"); });
    EXPECT_NE(unknown.find("Babylon.js with Standard, ACES"), std::string::npos) << unknown;
}

TEST(Engines, AmbiguousNamesListTheirMeanings) {
    try {
        (void)resolve_operator("aces");
        FAIL();
    } catch (const AmbiguousNameError& e) {
        EXPECT_EQ(e.name(), "aces");
        EXPECT_EQ(e.problem().kind, Problem::Kind::usage);
        for (const char* op : {"aces_hill:threejs", "aces_hill, ", "aces_cesium", "aces_20"})
            EXPECT_NE(e.text().find(op), std::string::npos) << op;
    }
    for (const std::string& name : ambiguous_names())
        EXPECT_THROW((void)resolve_operator(name), AmbiguousNameError) << name;
}

TEST(Engines, MeaningsNameTheirPrograms) {
    const std::vector<NameMeaning> meanings = meanings_of("Hejl");
    const auto of = [&](std::string_view op) {
        const auto found = std::find_if(meanings.begin(), meanings.end(),
                                        [&](const NameMeaning& m) { return m.op == op; });
        return found == meanings.end() ? std::vector<std::string>{} : found->uses;
    };
    EXPECT_EQ(of("hable_gdc:playcanvas"), std::vector<std::string>{"PlayCanvas TONEMAP_HEJL"});
    EXPECT_EQ(of("hejl_2015"), std::vector<std::string>{"Hejl 2015"}) << "an operator's own title";
    EXPECT_TRUE(meanings_of("hable_gdc").empty()) << "no program's name";
    EXPECT_TRUE(meanings_of("ha\nble").empty()) << "a typing error";
    std::set<std::string> operators;
    for (const NameMeaning& meaning : meanings_of("Filmic"))
        EXPECT_TRUE(operators.insert(meaning.op).second) << meaning.op;
    EXPECT_TRUE(operators.contains("")) << "Blender's";
}

TEST(Engines, NotesOnNames) {
    EXPECT_NE(note_on_name("AgX").find("Blender's here"), std::string::npos);
    EXPECT_NE(note_on_name("agx:look=punchy").find("<<list=engines>>"), std::string::npos);
    EXPECT_NE(note_on_name("Filament ACES").find("aces_filament is the nearest"),
              std::string::npos);
    for (const char* name : {"agx_blender", "AgX Punchy", "three.js ACES", "hable"})
        EXPECT_EQ(note_on_name(name), "") << name;
}

TEST(Engines, VerdictsHaveNames) {
    EXPECT_EQ(name_of(EngineToneMapper::Verdict::equal), "equal");
    EXPECT_EQ(name_of(EngineToneMapper::Verdict::nearest), "nearest");
    EXPECT_EQ(name_of(EngineToneMapper::Verdict::none), "none");
}

}  // namespace
TONEWRIGHT_NAMESPACE_END
