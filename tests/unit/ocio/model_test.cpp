// SPDX-License-Identifier: Apache-2.0
//
// The model of a config before it becomes OpenColorIO objects: the rules that give files their
// spaces.
#include "ocio/model.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <regex>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "ocio/config_builder.h"
#include "ocio/operator_facts.h"
#include "pipeline/stand_ins.h"
#include "tonewright/engine.h"
#include "tonewright/ocio.h"
#include "tonewright/registry.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

/// Finds a space like OpenColorIO: the first rule whose extension or expression the whole path has.
std::string space_of_file(const ConfigModel& model, const std::string& path) {
    for (const ConfigModel::FileRule& rule : model.file_rules) {
        const std::regex wanted = rule.regex.empty()
                                      ? std::regex(".*\\." + rule.extension, std::regex::icase)
                                      : std::regex(rule.regex);
        if (std::regex_match(path, wanted)) return rule.space;
    }
    return model.default_space;
}

TEST(FileRules, CamerasAndProgramsNamesOfFiles) {
    const ConfigModel model = make_config_model();
    // Names as cameras, DaVinci Resolve, Nuke, Maya, Arnold, Substance Painter, Houdini, film
    // scanners and people who convert by hand write them.
    const std::vector<std::pair<const char*, const char*>> files = {
        {"clip_S-Log3_S-Gamut3.Cine.mov", "S-Log3 S-Gamut3.Cine"},
        {"x.slog3_sgamut3cine.dpx", "S-Log3 S-Gamut3.Cine"},
        {"slog3_sgamut3cine", "S-Log3 S-Gamut3.Cine"},
        {"A001_SGamut3.CineSLog3_v2.exr", "S-Log3 S-Gamut3.Cine"},
        {"A001_SLog3_4K_SGamut3Cine.mxf", "S-Log3 S-Gamut3.Cine"},
        {"fx6 S-Log3-S-Gamut3.Cine 0012.mp4", "S-Log3 S-Gamut3.Cine"},
        {"clip_S-Log3_S-Gamut3.mov", "S-Log3 S-Gamut3"},
        {"a.slog3.dpx", "S-Log3 S-Gamut3"},
        {"venice_slog3_sgamut3cine.0001.dpx", "S-Log3 Venice S-Gamut3.Cine"},
        {"slog3_sgamut3_venice.exr", "S-Log3 Venice S-Gamut3"},
        {"A001C003_LogC4.mxf", "ARRI LogC4"},
        {"a35_AWG4_LogC4_v1.0001.exr", "ARRI LogC4"},
        {"plate_arri_logc4.dpx", "ARRI LogC4"},
        {"a.LogC3.dpx", "ARRI LogC3 (EI800)"},
        {"plate_AlexaV3LogC.0001.dpx", "ARRI LogC3 (EI800)"},
        {"plate_arri_logc3_ei800.dpx", "ARRI LogC3 (EI800)"},
        {"ALEXA_LOGC_AWG.mov", "ARRI LogC3 (EI800)"},
        {"M001_Log3G10.mov", "Log3G10 REDWideGamutRGB"},
        {"red_REDWideGamutRGB_Log3G10.exr", "Log3G10 REDWideGamutRGB"},
        {"log3g10_rwg.dpx", "Log3G10 REDWideGamutRGB"},
        {"gh6_V-Log_V-Gamut.mov", "V-Log V-Gamut"},
        {"c300_CLog2_CGamut.mxf", "CanonLog2 CinemaGamut D55"},
        {"r5_Canon-Log3.mp4", "CanonLog3 CinemaGamut D55"},
        {"x_davinci_intermediate.mov", "DaVinci Intermediate WideGamut"},
        {"x_DWG_DI.mov", "DaVinci Intermediate WideGamut"},
        {"clip_DaVinci Intermediate WideGamut.0001.dpx", "DaVinci Intermediate WideGamut"},
        {"clip_DaVinci.mov", "Gamma 2.4 Rec.709 - Texture"},
        {"scan.0001.dpx", "Cineon"},
        {"scan.cin", "Cineon"},
        {"scan_adx10.dpx", "ADX10"},
        {"plate_rec709.0001.dpx", "Gamma 2.4 Rec.709 - Texture"},
        {"render_rec709.exr", "Linear Rec.709"},
        {"comp_acescct.0001.dpx", "ACEScct"},
        {"comp_acescc.0001.exr", "ACEScc"},
        {"/plates/shot_acescg.0001.exr", "ACEScg"},
        {"sh010_ACES2065-1.exr", "ACES2065-1"},
        {"/plates/shot_lin_ap0_v2.exr", "ACES2065-1"},
        {"sky_lin_rec2020.exr", "Linear Rec.2020"},
        {"tex_lin_srgb.png", "Linear Rec.709"},
        {"mat_BaseColor_ACES - ACEScg.exr", "ACEScg"},
        {"mat_Base_Color_sRGB - Texture.1001.png", "sRGB - Texture"},
        {"mat_Roughness_Utility - Raw.1001.png", "Non-Color"},
        {"photo_DisplayP3.heic", "sRGB Encoded P3-D65 - Texture"},
        {"wood_srgb_texture_acescg.png.tx", "ACEScg"},
        {"wood_sRGB - Texture_ACEScg.png.tx", "ACEScg"},
        {"wood.png.tx", "sRGB - Texture"},
        {"sky.exr.tx", "Linear Rec.709"},
        {"wood.tx", "sRGB - Texture"},
        {"photo.jxl", "sRGB - Texture"},
        {"photo.HEIC", "sRGB - Texture"},
        {"photo.avif", "sRGB - Texture"},
        {"photo.jp2", "sRGB - Texture"},
        {"clip.mov", "Gamma 2.4 Rec.709 - Texture"},
        {"hdr_Rec.2100-PQ.avif", "Rec.2100-PQ"},
        {"shot_srgb.exr", "sRGB - Texture"},
        {"wood_raw.png", "Non-Color"},
        {"/raw/wood.png", "sRGB - Texture"},
        {"/acescg/data/sky.exr", "Linear Rec.709"},
        {"/show_logc4_v1/sky.exr", "Linear Rec.709"},
        {"C:\\plates\\logc4.mov", "ARRI LogC4"},
        {"rawhide.png", "sRGB - Texture"},
        {"slogan.png", "sRGB - Texture"},
        {"technologc3.exr", "Linear Rec.709"},
    };
    for (const auto& [path, space] : files)
        EXPECT_EQ(space_of_file(model, path), space) << path;
}

TEST(FileRules, AliasesOfCameraSpacesAreWordsOfTheirFiles) {
    // A pipeline that writes a space's name or alias into a file's name gets that space back.
    const ConfigModel model = make_config_model();
    std::set<std::string> names;
    for (const ConfigModel::Space& space : model.spaces) {
        if (space.encoding != "log") continue;
        for (std::string alias : space.aliases) {
            if (alias.find(' ') != std::string::npos || alias.starts_with("ocio:")) continue;
            EXPECT_EQ(space_of_file(model, "plate_" + alias + ".0001.exr"), space.name) << alias;
            names.insert(alias);
        }
    }
    EXPECT_GE(names.size(), 15U);
}

TEST(FileRules, NamesAndSpacesExist) {
    const ConfigModel model = make_config_model();
    std::set<std::string> names;
    for (const ConfigModel::FileRule& rule : model.file_rules) {
        EXPECT_TRUE(names.insert(rule.name).second) << rule.name;
        EXPECT_TRUE(std::any_of(model.spaces.begin(), model.spaces.end(), [&](const auto& space) {
            return space.name == rule.space;
        })) << rule.space;
    }
}

TEST(Views, StandardIsAViewAndInLowerCaseTheSet) {
    ConfigOptions options;
    options.views = {"Hable", "Standard"};
    const ConfigModel model = make_config_model(options);
    ASSERT_EQ(model.views.size(), 2U);
    EXPECT_EQ(model.views[1].op.op->id, "clamp");
    options.views = {"standard"};
    EXPECT_EQ(make_config_model(options).views.size(), 12U);
}

TEST(ViewTransforms, AreNamedByThePeakOfTheirPicture) {
    const ConfigModel model = make_config_model({.views = {"aces_13", "AgX"}});
    for (const ConfigModel::View& view : model.views) {
        std::set<std::string> hdr;
        for (const DisplayedView& shown : displayed_views(view, model.displays)) {
            EXPECT_LE(shown.transform.size(), 63U) << shown.transform;
            if (!shown.display->is_hdr) continue;
            EXPECT_NE(shown.transform.find("1000 nit"), std::string::npos) << shown.transform;
            hdr.insert(shown.transform);
        }
        // ACES 1.3 exceeds the peak of 1000 in blue, but for HLG, where light ends there.
        EXPECT_EQ(hdr.size(), view.op.op->id == "aces_13" ? 3U : 2U) << view.name;
    }
}

TEST(ViewDescriptions, SayWhereBlenderLimitsColorsOtherwise) {
    const ResolvedOperator op = resolve_operator("aces_13");
    for (const char* display : {"rec2100_pq", "rec2100_hlg", "rec2020"})
        EXPECT_NE(blender_difference(make_view(op, "lin_ap0", 0, display).op), "") << display;
    for (const char* display : {"srgb", "display_p3", "p3d65_pq"})
        EXPECT_EQ(blender_difference(make_view(op, "lin_ap0", 0, display).op), "") << display;
    EXPECT_EQ(blender_difference(resolve_operator("agx_blender")), "");
}

TEST(ViewDescriptions, NameTheConstantsOfOperatorsThatMeasure) {
    const ConfigModel model = make_config_model({.views = {"drago", "hable"}});
    EXPECT_NE(model.views[0].description.find("maximum 100 for the maximum luminance"),
              std::string::npos)
        << model.views[0].description;
    EXPECT_EQ(stand_ins(model.views[1].op), "");
    // A value that the user sets is no stand-in.
    EXPECT_EQ(stand_ins(resolve_operator("drago", {{"maximum", "7"}})).find("maximum"),
              std::string::npos);
}

std::string lower(std::string text) {
    for (char& c : text)
        c = c >= 'A' && c <= 'Z' ? static_cast<char>(c + 32) : c;
    return text;
}

TEST(ConfigModel, NamesFitApplications) {
    const ConfigModel model = make_config_model({.views = {"all"}});
    std::set<std::string> taken;
    const auto claim = [&](const std::string& name) {
        EXPECT_LE(name.size(), 63U) << name << ": Blender cuts it";
        EXPECT_TRUE(taken.insert(lower(name)).second) << name << " twice: OCIO ignores case";
        for (const char c : name)
            EXPECT_TRUE(c >= 32 && c < 127) << name;
    };
    for (const auto& [role, space] : model.roles)
        claim(role);
    for (const ConfigModel::Space& space : model.spaces) {
        claim(space.name);
        for (const std::string& alias : space.aliases)
            claim(alias);
        EXPECT_FALSE(space.description.empty()) << space.name;
    }
    std::set<std::string> views = {lower(kUntonemappedView), lower(kRawView)};
    for (const ConfigModel::View& view : model.views) {
        EXPECT_LE(view.name.size(), 63U) << view.name;
        EXPECT_TRUE(views.insert(lower(view.name)).second) << view.name;
    }
}

TEST(ConfigModel, StandardViewsBeginWithAgxAndEndWithRaw) {
    const ConfigModel model = make_config_model();
    ASSERT_GE(model.views.size(), 12U);
    // Blender's names.
    EXPECT_EQ(model.views[0].name, "AgX");
    EXPECT_EQ(model.views[1].name, "AgX Punchy");
    for (const char* name :
         {"ACES 1.3", "ACES 2.0", "Khronos PBR Neutral", "False Color", "Standard"}) {
        EXPECT_TRUE(std::any_of(model.views.begin(), model.views.end(), [&](const auto& v) {
            return v.name == name;
        })) << name;
    }
    ASSERT_FALSE(model.looks.empty());
    EXPECT_TRUE(std::any_of(model.looks.begin(), model.looks.end(),
                            [](const auto& look) { return look.name == "AgX - Punchy"; }));
}

TEST(ConfigModel, ALookBeforeTheOperatorIsTheOperatorWithTheLook) {
    const ConfigModel model = make_config_model();
    for (const ConfigModel::Look& look : model.looks) {
        SCOPED_TRACE(look.name);
        const auto found = std::find_if(
            look.op->looks.begin(), look.op->looks.end(),
            [&](const Look& l) { return look.name == look.op->view + " - " + l.title; });
        ASSERT_NE(found, look.op->looks.end());
        Pipeline both = look.stages;
        const Pipeline plain = resolve_operator(look.op->id).build();
        both.insert(both.end(), plain.begin(), plain.end());
        const ReferenceEngine apart(both);
        const ReferenceEngine whole(resolve_operator(look.op->id, {}, found->id).build());
        for (const Vector3& v : {Vector3{0.18, 0.18, 0.18}, Vector3{4, 0.1, -0.02},
                                 Vector3{0.001, 0.5, 30}, Vector3{0, 0, 0}})
            EXPECT_EQ(apart(v), whole(v));
    }
}

TEST(ConfigModel, ViewsAreChosenByNameOperatorAndPreset) {
    const ConfigModel model =
        make_config_model({.views = {"hable", "agx punchy", "reinhard:luminance"},
                           .displays = {"rec1886"},
                           .looks = {"AgX - Greyscale"},
                           .working = "lin_ap1",
                           .custom = {{"Studio", resolve_operator("reinhard_extended:white=6")}},
                           .exposure_stops = {-1}});
    std::vector<std::string> names;
    for (const auto& view : model.views)
        names.push_back(view.name);
    const std::string luminance = names.at(2);
    EXPECT_TRUE(luminance.starts_with("Reinhard ")) << luminance;
    EXPECT_EQ(names, (std::vector<std::string>{"Hable", "AgX Punchy", luminance, "Studio",
                                               "Hable -1 stop", "AgX Punchy -1 stop",
                                               luminance + " -1 stop", "Studio -1 stop"}));
    EXPECT_EQ(model.views[3].op.params.number("white"), 6);
    ASSERT_EQ(model.displays.size(), 1U);
    EXPECT_EQ(model.displays[0]->id, "rec1886");
    ASSERT_EQ(model.looks.size(), 1U);
    EXPECT_EQ(model.default_space, "ACEScg");
    EXPECT_THROW((void)make_config_model({.views = {"AgY"}}), Error);
    EXPECT_THROW((void)make_config_model({.looks = {"AgX - Funky"}}), Error);
    EXPECT_THROW((void)make_config_model({.displays = {"crt"}}), Error);
    EXPECT_THROW((void)make_config_model({.custom = {{"Hable", resolve_operator("reinhard")}}}),
                 Error)
        << "a name twice";
    EXPECT_THROW((void)make_config_model({.custom = {{"Raw", resolve_operator("reinhard")}}}),
                 Error)
        << "ours";
}

TEST(ConfigModel, HasEveryOperatorDisplayAndSpace) {
    const ConfigModel model = make_config_model({.views = {"all"}});
    EXPECT_EQ(model.displays.size(), all_displays().size());
    for (const Operator& op : all_operators()) {
        EXPECT_EQ(std::count_if(model.views.begin(), model.views.end(),
                                [&](const auto& v) { return v.op.op == &op && v.name == op.view; }),
                  1)
            << op.id;
    }
    const auto has_space = [&](const std::string& name) {
        return std::any_of(model.spaces.begin(), model.spaces.end(),
                           [&](const auto& s) { return s.name == name; });
    };
    for (const InputSpace& space : all_input_spaces()) {
        EXPECT_EQ(has_space(space.title), !space.is_camera) << space.id;
        EXPECT_EQ(config_space_name(space.id), space.title);
    }
    for (const Display& display : all_displays())
        EXPECT_TRUE(has_space(display.title)) << display.id;
    for (const auto& [role, space] : model.roles)
        EXPECT_TRUE(has_space(space)) << role << " is " << space;
    for (const auto& rule : model.file_rules)
        EXPECT_TRUE(has_space(rule.space)) << rule.name << " is " << rule.space;
    EXPECT_TRUE(has_space(model.default_space));
    // Roles that OCIO or applications do not start without.
    for (const char* role : {"scene_linear", "aces_interchange", "cie_xyz_d65_interchange", "data",
                             "color_picking", "texture_paint", "default_byte", "default_float"}) {
        EXPECT_TRUE(std::any_of(model.roles.begin(), model.roles.end(), [&](const auto& r) {
            return r.first == role;
        })) << role;
    }
}

}  // namespace
TONEWRIGHT_NAMESPACE_END
