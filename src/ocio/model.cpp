// SPDX-License-Identifier: Apache-2.0
#include "ocio/model.h"
#include "base/strings.h"
#include "tonewright/registry.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <map>
#include <set>

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

using Space = ConfigModel::Space;
using SpaceKind = ConfigModel::SpaceKind;

constexpr const char* kTextureSpace = "sRGB - Texture";
constexpr const char* kVideoSpace = "Gamma 2.4 Rec.709 - Texture";

struct StandardView {
    const char* id;
    const char* look = "";
    /// The tables of the HDR forms are larger than all others together.
    bool is_sdr_only = false;
};

/// The views that the config has when nobody asks for others. The first is what applications start
/// with: what artists know by the name of AgX, from Blender, where nothing clips and lights of all
/// colors fade to white. Then the two standards, a rendering that leaves colors of products alone,
/// and the curves that games and engines are known for.
constexpr std::array<StandardView, 12> kStandardViews = {{
    {"agx_blender"},
    {"agx_blender", "punchy"},
    {"aces_20", "", true},
    {"aces_13"},
    {"khronos_neutral"},
    {"reinhard_extended"},
    {"hable"},
    {"uchimura"},
    {"aces_narkowicz"},
    {"agx_sobotka"},
    {"clamp"},
    {"false_color"},
}};

/// What OpenColorIO 2.0 has built-in transforms for; names and aliases as in the ACES configs.
struct BuiltinSpace {
    const char* name;
    std::vector<std::string> aliases;
    const char* family;
    const char* description;
    const char* style;
    const char* interop_id = "";
};

const std::vector<BuiltinSpace>& builtin_spaces() {
    static const std::vector<BuiltinSpace> spaces = {
        {"ACEScct",
         {"acescct_ap1", "ACES - ACEScct"},
         "ACES",
         "Academy S-2016-001: AP1, log with a linear toe; for grading.",
         "ACEScct_to_ACES2065-1",
         "ocio:acescct_ap1_scene"},
        {"ACEScc",
         {"acescc_ap1", "ACES - ACEScc"},
         "ACES",
         "Academy S-2014-003: AP1, pure log; for grading.",
         "ACEScc_to_ACES2065-1",
         "ocio:acescc_ap1_scene"},
        {"ADX10",
         {"Input - ADX - ADX10"},
         "Input/Film",
         "Film scans of 10 bits, SMPTE ST 2065-3, with the Academy's unbuild.",
         "ADX10_to_ACES2065-1",
         "ocio:adx10_apd_scene"},
        {"ADX16",
         {"Input - ADX - ADX16"},
         "Input/Film",
         "Film scans of 16 bits, SMPTE ST 2065-3, with the Academy's unbuild.",
         "ADX16_to_ACES2065-1",
         "ocio:adx16_apd_scene"},
        {"ARRI LogC3 (EI800)",
         {"arri_logc3_ei800", "logc3ei800_alexawide",
          "Input - ARRI - V3 LogC (EI800) - Wide Gamut"},
         "Input/ARRI",
         "ARRI LogC3 of exposure index 800, ALEXA Wide Gamut.",
         "ARRI_ALEXA-LOGC-EI800-AWG_to_ACES2065-1",
         "ocio:arrilogc3_awg3_scene"},
        {"CanonLog2 CinemaGamut D55",
         {"canonlog2_cgamut_d55", "Input - Canon - Canon-Log2 - Cinema Gamut (Daylight)"},
         "Input/Canon",
         "Canon Log 2, Cinema Gamut, daylight.",
         "CANON_CLOG2-CGAMUT_to_ACES2065-1",
         "ocio:canonlog2_cgamutd55_scene"},
        {"CanonLog3 CinemaGamut D55",
         {"canonlog3_cgamut_d55", "Input - Canon - Canon-Log3 - Cinema Gamut (Daylight)"},
         "Input/Canon",
         "Canon Log 3, Cinema Gamut, daylight.",
         "CANON_CLOG3-CGAMUT_to_ACES2065-1",
         "ocio:canonlog3_cgamutd55_scene"},
        {"V-Log V-Gamut",
         {"vlog_vgamut", "Input - Panasonic - V-Log - V-Gamut"},
         "Input/Panasonic",
         "Panasonic V-Log, V-Gamut.",
         "PANASONIC_VLOG-VGAMUT_to_ACES2065-1",
         "ocio:vlog_vgamut_scene"},
        {"Log3G10 REDWideGamutRGB",
         {"log3g10_rwg", "Input - RED - REDLog3G10 - REDWideGamutRGB"},
         "Input/RED",
         "RED Log3G10, REDWideGamutRGB.",
         "RED_LOG3G10-RWG_to_ACES2065-1",
         "ocio:redlog3g10_rwg_scene"},
        {"REDLogFilm REDWideGamutRGB",
         {"redlogfilm_rwg"},
         "Input/RED",
         "REDlogFilm, REDWideGamutRGB.",
         "RED_REDLOGFILM-RWG_to_ACES2065-1"},
        {"S-Log3 S-Gamut3",
         {"slog3_sgamut3", "Input - Sony - S-Log3 - S-Gamut3"},
         "Input/Sony",
         "Sony S-Log3, S-Gamut3.",
         "SONY_SLOG3-SGAMUT3_to_ACES2065-1",
         "ocio:slog3_sgamut3_scene"},
        {"S-Log3 S-Gamut3.Cine",
         {"slog3_sgamut3cine", "Input - Sony - S-Log3 - S-Gamut3.Cine"},
         "Input/Sony",
         "Sony S-Log3, S-Gamut3.Cine.",
         "SONY_SLOG3-SGAMUT3.CINE_to_ACES2065-1",
         "ocio:slog3_sgamut3cine_scene"},
        {"S-Log3 Venice S-Gamut3",
         {"slog3_sgamut3_venice", "Input - Sony - S-Log3 - Venice S-Gamut3"},
         "Input/Sony",
         "Sony VENICE, S-Log3, S-Gamut3.",
         "SONY_SLOG3-SGAMUT3-VENICE_to_ACES2065-1",
         "ocio:slog3_sgamut3venice_scene"},
        {"S-Log3 Venice S-Gamut3.Cine",
         {"slog3_sgamut3cine_venice", "Input - Sony - S-Log3 - Venice S-Gamut3.Cine"},
         "Input/Sony",
         "Sony VENICE, S-Log3, S-Gamut3.Cine.",
         "SONY_SLOG3-SGAMUT3.CINE-VENICE_to_ACES2065-1",
         "ocio:slog3_sgamut3cinevenice_scene"},
    };
    return spaces;
}

/// Pictures and textures in the code values of a display's curve, for other primaries too.
struct TextureSpace {
    const char* name;
    std::vector<std::string> aliases;
    const char* display;
    const Primaries* primaries;
    const char* interop_id;
};

const std::vector<TextureSpace>& texture_spaces() {
    static const std::vector<TextureSpace> spaces = {
        {kTextureSpace,
         {"srgb_tx", "Utility - sRGB - Texture", "sRGB Encoded Rec.709 (sRGB)"},
         "srgb",
         &kRec709,
         "srgb_rec709_scene"},
        {"Gamma 2.2 Rec.709 - Texture",
         {"g22_rec709_tx", "Gamma 2.2 Encoded Rec.709"},
         "g22",
         &kRec709,
         "g22_rec709_scene"},
        {kVideoSpace,
         {"g24_rec709_tx", "g24_rec709_scene", "Gamma 2.4 Encoded Rec.709"},
         "rec1886",
         &kRec709,
         "ocio:g24_rec709_scene"},
        {"sRGB Encoded AP1 - Texture",
         {"srgb_encoded_ap1_tx", "srgb_ap1"},
         "srgb",
         &kAP1,
         "srgb_ap1_scene"},
        {"Gamma 2.2 AP1 - Texture",
         {"g22_ap1_tx", "Gamma 2.2 Encoded AP1"},
         "g22",
         &kAP1,
         "g22_ap1_scene"},
        {"sRGB Encoded P3-D65 - Texture",
         {"srgb_encoded_p3d65_tx"},
         "srgb",
         &kP3D65,
         "srgb_p3d65_scene"},
    };
    return spaces;
}

/// Of the spaces that we have: Color Interop Forum, "Color Space Encodings for Texture Assets and
/// CG Rendering", 2025, and its ids of displays.
constexpr std::array<std::string_view, 12> kForumIds = {
    "lin_ap0_scene",      "lin_ap1_scene",       "lin_rec709_scene",    "lin_rec2020_scene",
    "lin_p3d65_scene",    "srgb_rec709_display", "srgb_p3d65_display",  "g24_rec709_display",
    "g22_rec709_display", "pq_rec2020_display",  "hlg_rec2020_display", "pq_p3d65_display"};

/// Of a linear space or a display: the one of its names that the forum has.
template <class Item>
std::string interop_id(const Item& item) {
    for (const std::string& alias : item.aliases) {
        if (std::find(kForumIds.begin(), kForumIds.end(), alias) != kForumIds.end()) return alias;
    }
    return "";
}

std::vector<std::pair<std::string, std::string>> role_table(const std::string& working) {
    const std::string acescct = "ACEScct";
    const std::string aces = find_input_space("lin_ap0").title;
    const std::string srgb = find_display("srgb").title;
    const std::string texture = kTextureSpace;
    return {
        {"aces_interchange", aces},
        {"cie_xyz_d65_interchange", "CIE-XYZ-D65"},
        {"default", working},
        {"reference", aces},
        {"scene_linear", working},
        {"rendering", working},
        {"data", kDataSpace},
        {"color_picking", srgb},
        {"color_timing", acescct},
        {"compositing_log", acescct},
        {"matte_paint", texture},
        {"texture_paint", srgb},
        // Blender: without default_byte it opens 8-bit pictures as texture_paint; its name for it
        // is sRGB.
        {"default_byte", srgb},
        {"default_float", working},
        {"default_sequencer", srgb},
        // Mari
        {"mari_monitor", texture},
        {"mari_scalar_monitor", texture},
        {"mari_color_picker", texture},
        {"mari_working", working},
        {"mari_int8", texture},
        {"mari_int16", texture},
        {"mari_int_scalar", kDataSpace},
        {"mari_scalar8", kDataSpace},
        {"mari_float", working},
        // RenderMan
        {"srgb_linear", working},
        {"srgb_texture", texture},
        // Substance Painter
        {"substance_3d_painter_standard_srgb", texture},
        {"substance_3d_painter_bitmap_import_8bit", texture},
        {"substance_3d_painter_bitmap_import_16bit", texture},
        {"substance_3d_painter_bitmap_import_floating", working},
        {"substance_3d_painter_substance_material", texture},
        {"substance_3d_painter_bitmap_export_8bit", texture},
        {"substance_3d_painter_bitmap_export_16bit", texture},
        {"substance_3d_painter_bitmap_export_floating", working},
    };
}

/// What hosts choke on: Blender cuts names at 63 bytes, OCIO looks names up without case.
void check_names(const ConfigModel& model) {
    std::map<std::string, std::string> taken;
    for (const auto& [role, space] : model.roles)
        taken[lowercase(role)] = "role " + role;
    const auto claim = [&](const std::string& name, const std::string& owner) {
        if (name.size() > 63) {
            throw Error("config: name is " + name + "; expected at most 63 bytes");
        }
        const auto [it, is_new] = taken.emplace(lowercase(name), owner);
        if (!is_new) {
            throw Error("config: name is " + name + " for " + owner + "; expected one that " +
                        it->second + " does not have");
        }
    };
    for (const Space& space : model.spaces) {
        claim(space.name, "space " + space.name);
        for (const std::string& alias : space.aliases)
            claim(alias, "space " + space.name);
    }
    std::set<std::string> views = {lowercase(kUntonemappedView), lowercase(kRawView)};
    for (const auto& view : model.views) {
        if (view.name.size() > 63)
            throw Error("config: view is " + view.name + "; expected at most 63 bytes");
        if (!views.insert(lowercase(view.name)).second) {
            throw Error("config: view is " + view.name + "; expected a name no other operator has");
        }
    }
    for (const auto& [role, name] : model.roles) {
        const std::string& wanted = name;
        const bool known = std::any_of(model.spaces.begin(), model.spaces.end(),
                                       [&](const Space& s) { return s.name == wanted; });
        if (!known)
            throw Error("config: role " + role + " is " + name +
                        "; expected a space of the config");
    }
}

/// Where a picture's name says what it is in: "plate_acescg.0001.exr". Words between separators in
/// the last part of a path, so that a folder "raw" means nothing.
std::string word_pattern(const std::string& words) {
    return R"(.*[_.\- ]()" + words + R"()[_.\- ][^/\\]*)";
}

std::vector<ConfigModel::FileRule> make_file_rules(const std::string& working) {
    std::vector<ConfigModel::FileRule> rules;
    const auto word = [&](const std::string& name, const std::string& space,
                          const std::string& words) {
        rules.push_back({name, space, "", word_pattern(words)});
    };
    word("ACEScg", find_input_space("lin_ap1").title, "acescg|ACEScg|lin_ap1");
    word("ACEScct", "ACEScct", "acescct|ACEScct");
    word("ACES2065-1", find_input_space("lin_ap0").title,
         "aces2065-1|ACES2065-1|aces2065_1|lin_ap0|ap0");
    word("Linear Rec.709", find_input_space("lin_rec709").title, "lin_rec709|lin_srgb");
    word("Linear Rec.2020", find_input_space("lin_rec2020").title, "lin_rec2020");
    word("Linear P3-D65", find_input_space("lin_p3d65").title, "lin_p3d65|lin_displayp3");
    word("sRGB", kTextureSpace, "srgb|sRGB|srgb_tx");
    word("LogC3", "ARRI LogC3 (EI800)", "logc3|LogC3|arri_logc3_ei800");
    word("S-Log3", "S-Log3 S-Gamut3", "slog3|S-Log3|slog3_sgamut3");
    word("V-Log", "V-Log V-Gamut", "vlog|V-Log|vlog_vgamut");
    word("data", kDataSpace, "raw|data|noncolor|Non-Color");
    for (const char* extension : {"exr", "hdr", "pfm"})
        rules.push_back({extension, working, extension, ""});
    for (const char* extension :
         {"png", "jpg", "jpeg", "tif", "tiff", "tga", "bmp", "gif", "webp", "psd"})
        rules.push_back({extension, kTextureSpace, extension, ""});
    for (const char* extension : {"mov", "mp4", "mxf", "mkv", "avi"})
        rules.push_back({extension, kVideoSpace, extension, ""});
    return rules;
}

bool same_stage(const Stage& a, const Stage& b) {
    static const std::array<Expr, 3> rgb = {Expr::input(0), Expr::input(1), Expr::input(2)};
    const std::array<Expr, 3> x = apply_stage(a, rgb);
    const std::array<Expr, 3> y = apply_stage(b, rgb);
    return same(x[0], y[0]) && same(x[1], y[1]) && same(x[2], y[2]);
}

/// The stages that a look puts before the operator's own; empty where it changes the operator.
Pipeline scene_look(const Operator& op, const Look& look) {
    const Pipeline with = resolve_operator(op.id, {}, look.id).build();
    const Pipeline without = resolve_operator(op.id).build();
    if (with.size() <= without.size()) return {};
    const auto begin = with.begin() + static_cast<std::ptrdiff_t>(with.size() - without.size());
    if (!std::equal(begin, with.end(), without.begin(), same_stage)) return {};
    return {with.begin(), begin};
}

std::string look_name(const Operator& op, const Look& look) { return op.view + " - " + look.title; }

std::string description_of(const Operator& op, const std::string& extra = "") {
    return op.title + extra + ": " + op.character + ". Source: " + op.source + ".";
}

ConfigModel::View view_of(const Operator& op, const std::string& look_id = "") {
    for (const Look& look : op.looks) {
        if (look.id != look_id) continue;
        return {op.view + " " + look.title, resolve_operator(op.id, {}, look.id),
                description_of(op, ", look " + look.title)};
    }
    return {op.view, resolve_operator(op.id), description_of(op)};
}

/// Every operator, and every operator with each of its looks.
std::vector<ConfigModel::View> every_view() {
    std::vector<ConfigModel::View> all;
    for (const Operator& op : all_operators()) {
        all.push_back(view_of(op));
        for (const Look& look : op.looks)
            all.push_back(view_of(op, look.id));
    }
    return all;
}

std::vector<ConfigModel::View> choose_views(const ConfigOptions& options) {
    std::vector<ConfigModel::View> views;
    const auto add = [&](ConfigModel::View view) {
        for (const auto& other : views) {
            if (other.name == view.name) return;
        }
        views.push_back(std::move(view));
    };
    const auto add_standard = [&] {
        for (const StandardView& standard : kStandardViews) {
            ConfigModel::View view = view_of(find_operator(standard.id), standard.look);
            view.is_sdr_only = standard.is_sdr_only && options.views.empty();
            add(std::move(view));
        }
    };
    if (options.views.empty()) add_standard();
    for (const std::string& wanted : options.views) {
        const std::vector<ConfigModel::View> all = every_view();
        if (wanted == "standard") {
            add_standard();
            continue;
        }
        if (wanted == "all") {
            add_standard();
            for (const auto& view : all)
                add(view);
            continue;
        }
        const auto named = std::find_if(all.begin(), all.end(), [&](const ConfigModel::View& v) {
            return lowercase(v.name) == lowercase(wanted);
        });
        if (named != all.end()) {
            add(*named);
            continue;
        }
        try {
            const ResolvedOperator op = parse_operator(wanted);
            std::string name = op.op->view;
            for (const Preset& preset : op.op->presets) {
                if (&preset == op.preset) name += " " + preset.title;
            }
            add({name, op, description_of(*op.op)});
        } catch (const Error& e) {
            std::vector<std::string> names = {"standard", "all"};
            for (const auto& view : all)
                names.push_back(view.name);
            throw Error("config: view is " + wanted +
                        "; expected the name of a view or an operator (" + e.what() + ")" +
                        did_you_mean(wanted, names));
        }
    }
    for (const auto& custom : options.custom) {
        const ResolvedOperator op = parse_operator(custom.op);
        if (custom.name.empty())
            throw Error("config: the view of " + custom.op + " has no name; expected one");
        views.push_back({custom.name, op, description_of(*op.op) + " As " + op.label + "."});
    }
    const std::size_t count = views.size();
    for (const double stops : options.exposure_stops) {
        for (std::size_t i = 0; i < count; ++i) {
            ConfigModel::View view = views[i];
            view.name += fmt::format(" {:+g} {}", stops, std::abs(stops) == 1 ? "stop" : "stops");
            view.exposure_stops = stops;
            views.push_back(view);
        }
    }
    return views;
}

std::vector<ConfigModel::Look> choose_looks(const ConfigOptions& options,
                                            const std::vector<ConfigModel::View>& views) {
    std::vector<ConfigModel::Look> all;
    for (const Operator& op : all_operators()) {
        const bool is_shown = std::any_of(views.begin(), views.end(),
                                          [&](const auto& view) { return view.op.op == &op; });
        if (!is_shown) continue;
        for (const Look& look : op.looks) {
            const Pipeline stages = scene_look(op, look);
            if (!stages.empty()) all.push_back({look_name(op, look), stages, &op, look.help});
        }
    }
    if (options.looks.empty()) return all;
    std::vector<ConfigModel::Look> chosen;
    for (const std::string& wanted : options.looks) {
        if (wanted == "none") continue;
        const auto found = std::find_if(all.begin(), all.end(), [&](const auto& look) {
            return lowercase(look.name) == lowercase(wanted);
        });
        if (found == all.end()) {
            std::vector<std::string> names = {"none"};
            for (const auto& look : all)
                names.push_back(look.name);
            throw Error("config: look is " + wanted + "; expected " + join_choices(names) +
                        did_you_mean(wanted, names));
        }
        chosen.push_back(*found);
    }
    return chosen;
}

}  // namespace

std::string config_view_name(const std::string& name, const ResolvedOperator& op,
                             const Display& display) {
    const double peak = std::min(op.peak() * kReferenceWhite, display.peak);
    if (!display.is_hdr || peak <= kReferenceWhite) return name;
    return name + fmt::format(" - HDR {:g} nits", peak);
}

std::string output_space_name(const std::string& view, const std::string& display) {
    return "Output - " + view + " - " + display;
}

ConfigModel make_config_model(const ConfigOptions& options) {
    ConfigModel model;
    model.name = kConfigName;
    model.description =
        "Tone mapping operators of the field as OpenColorIO views, each measured against a "
        "double-precision reference. Generated by Tonewright; do not edit.";

    for (const InputSpace& space : all_input_spaces()) {
        if (space.is_camera) continue;
        std::vector<std::string> aliases = {space.id};
        if (space.id == "lin_ap1") aliases.insert(aliases.begin(), "lin_ap1_acescg");
        aliases.insert(aliases.end(), space.aliases.begin(), space.aliases.end());
        const bool is_aces = space.id == "lin_ap0" || space.id == "lin_ap1";
        model.spaces.push_back(
            {SpaceKind::scene_linear,
             space.title,
             aliases,
             is_aces ? "ACES" : "Utility/Linear",
             "Scene-linear, " + std::string(space.primaries.name) + " primaries.",
             "scene-linear",
             {"file-io", "working-space"},
             &space.primaries,
             nullptr,
             "",
             interop_id(space)});
    }
    for (const BuiltinSpace& space : builtin_spaces()) {
        const bool is_working = std::string_view(space.family) == "ACES";
        model.spaces.push_back({SpaceKind::builtin, space.name, space.aliases, space.family,
                                space.description, "log",
                                is_working ? std::vector<std::string>{"file-io", "working-space"}
                                           : std::vector<std::string>{"file-io"},
                                nullptr, nullptr, space.style, space.interop_id});
    }
    for (const TextureSpace& space : texture_spaces()) {
        const Display& display = find_display(space.display);
        model.spaces.push_back({SpaceKind::texture,
                                space.name,
                                space.aliases,
                                "Utility/Texture",
                                "Pictures and textures of " + std::string(space.primaries->name) +
                                    " primaries in the code values of " + display.source +
                                    ", read as scene light.",
                                "sdr-video",
                                {"file-io", "texture"},
                                space.primaries,
                                &display,
                                "",
                                space.interop_id});
    }
    model.spaces.push_back({SpaceKind::data,
                            kDataSpace,
                            {"Utility - Raw", "Generic Data", "Non-Colour Data", "Raw"},
                            "Utility",
                            "Data that is not colour (normals, depth, masks): never converted.",
                            "data",
                            {"file-io"},
                            nullptr,
                            nullptr,
                            "",
                            "data"});
    model.spaces.push_back({SpaceKind::display_reference,
                            "CIE-XYZ-D65",
                            {"cie_xyz_d65_display"},
                            "Display",
                            "The display reference: CIE XYZ, D65, Y = 1 is display white.",
                            "display-linear",
                            {"file-io"},
                            nullptr,
                            nullptr,
                            "",
                            "ocio:lin_ciexyzd65_display"});
    // All of them, whichever displays are chosen: pictures come in their code values.
    for (const Display& display : all_displays()) {
        std::vector<std::string> aliases = {display.title + kDisplaySuffix};
        aliases.insert(aliases.end(), display.aliases.begin(), display.aliases.end());
        model.spaces.push_back(
            {SpaceKind::display,
             display.title,
             aliases,
             "Display",
             display.source + (display.is_hdr ? "."
                                              : ". Light above white is not limited here (pure "
                                                "powers: up to 2); views are."),
             display.is_hdr ? "hdr-video" : "sdr-video",
             {"file-io"},
             &display.primaries,
             &display,
             "",
             interop_id(display)});
        if (options.displays.empty()) model.displays.push_back(&display);
    }
    for (const std::string& name : options.displays) {
        const Display* display = &find_display(name);
        if (std::find(model.displays.begin(), model.displays.end(), display) ==
            model.displays.end())
            model.displays.push_back(display);
    }
    model.views = choose_views(options);
    model.looks = choose_looks(options, model.views);
    model.default_space = find_input_space(options.working).title;
    model.roles = role_table(model.default_space);
    model.file_rules = make_file_rules(model.default_space);
    for (Space& space : model.spaces) {
        const auto has = [&](const std::string& id) {
            return std::find(space.aliases.begin(), space.aliases.end(), id) != space.aliases.end();
        };
        const bool is_role =  // "data"
            std::any_of(model.roles.begin(), model.roles.end(),
                        [&](const auto& role) { return role.first == space.interop_id; });
        if (!space.interop_id.empty() && !has(space.interop_id) && !is_role)
            space.aliases.push_back(space.interop_id);
    }
    check_names(model);
    return model;
}

TONEWRIGHT_NAMESPACE_END
