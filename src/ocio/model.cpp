// SPDX-License-Identifier: Apache-2.0
#include "ocio/model.h"
#include "base/strings.h"
#include "pipeline/stand_ins.h"
#include "tonewright/format_color.h"
#include "tonewright/registry.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <map>
#include <set>

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

using Space = ConfigModel::Space;
using SpaceKind = ConfigModel::SpaceKind;

struct StandardView {
    const char* id;
    const char* look = "";
    /// The tables of the HDR variants are larger than all others together.
    bool is_sdr_only = false;
};

/// Default views of the config. The first one is the default view of applications: Blender's AgX,
/// which artists know. It does not clip, and highlights of all colors fade to white. Then the two
/// standards, a view that keeps the colors of products, and well-known curves of games and engines.
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

/// Ids of the supported spaces: Color Interop Forum, "Color Space Encodings for Texture Assets and
/// CG Rendering", 2025, and its ids of displays.
constexpr std::array<std::string_view, 12> kForumIds = {
    "lin_ap0_scene",      "lin_ap1_scene",       "lin_rec709_scene",    "lin_rec2020_scene",
    "lin_p3d65_scene",    "srgb_rec709_display", "srgb_p3d65_display",  "g24_rec709_display",
    "g22_rec709_display", "pq_rec2020_display",  "hlg_rec2020_display", "pq_p3d65_display"};

/// Id of a display that the forum's list lacks, in a namespace of Tonewright: OpenColorIO 2.6 calls
/// a config compatible with HDR displays if every display has an id.
constexpr std::string_view kOwnDisplayId = "g24_rec2020_display";

/// Id of a linear space or a display: its name in the forum's list.
template <class Item>
std::string interop_id(const Item& item) {
    for (const std::string& alias : item.aliases) {
        if (std::find(kForumIds.begin(), kForumIds.end(), alias) != kForumIds.end()) return alias;
        if (alias == kOwnDisplayId) return "tonewright:" + alias;
    }
    return "";
}

Space space_of(const InputSpace& space) {
    // The ACES configs' own alias comes first.
    std::vector<std::string> aliases = space.aliases;
    const auto is_acescg = [](const std::string& alias) { return alias == "lin_ap1_acescg"; };
    aliases.insert(std::find_if_not(aliases.begin(), aliases.end(), is_acescg), space.id);
    const bool is_aces = space.id == "lin_ap0" || space.id == "lin_ap1";
    return {SpaceKind::scene_linear,
            space.title,
            aliases,
            is_aces ? "ACES" : "Utility/Linear",
            "Scene-linear, " + std::string(space.primaries.name) + " primaries.",
            "scene-linear",
            {"file-io", "working-space"},
            &space.primaries,
            nullptr,
            "",
            interop_id(space)};
}

Space space_of(const Display& display) {
    return {SpaceKind::display,
            display.title,
            display.aliases,
            "Display",
            display.source + (display.is_hdr ? "."
                                             : ". Values above white are not limited (pure "
                                               "powers: up to 2); views limit them."),
            display.is_hdr ? "hdr-video" : "sdr-video",
            {"file-io"},
            &display.primaries,
            &display,
            "",
            interop_id(display)};
}

Space space_of(const EncodedSpace& space) {
    Space result;
    result.name = space.title;
    result.aliases = space.aliases;
    result.family = space.family;
    result.description = space.description;
    result.categories = {"file-io"};
    result.interop_id = space.interop_id;
    switch (space.kind) {
        case EncodedSpace::Kind::builtin:
            result.kind = SpaceKind::builtin;
            result.encoding = "log";
            if (space.family == "ACES") result.categories.emplace_back("working-space");
            result.style = space.style;
            break;
        case EncodedSpace::Kind::log:
            result.kind = SpaceKind::log;
            result.encoding = "log";
            result.primaries = &space.primaries;
            result.curve = space.curve;
            break;
        case EncodedSpace::Kind::texture:
            result.kind = SpaceKind::texture;
            result.encoding = "sdr-video";
            result.categories.emplace_back("texture");
            result.primaries = &space.primaries;
            result.display = &find_display(space.display);
            break;
        case EncodedSpace::Kind::data:
            result.kind = SpaceKind::data;
            result.encoding = "data";
            break;
        case EncodedSpace::Kind::display_reference:
            result.kind = SpaceKind::display_reference;
            result.encoding = "display-linear";
            break;
    }
    return result;
}

enum class RoleSpace : unsigned char { working, aces, acescct, xyz, srgb, texture, data };

struct RoleRow {
    const char* role;
    RoleSpace space;
};
constexpr std::array<RoleRow, 34> kRoles = {{
    {"aces_interchange", RoleSpace::aces},
    {"cie_xyz_d65_interchange", RoleSpace::xyz},
    {"default", RoleSpace::working},
    {"reference", RoleSpace::aces},
    {"scene_linear", RoleSpace::working},
    {"rendering", RoleSpace::working},
    {"data", RoleSpace::data},
    {"color_picking", RoleSpace::srgb},
    {"color_timing", RoleSpace::acescct},
    {"compositing_log", RoleSpace::acescct},
    {"matte_paint", RoleSpace::texture},
    {"texture_paint", RoleSpace::srgb},
    // Blender: without default_byte it opens 8-bit pictures as texture_paint; its name for it
    // is sRGB.
    {"default_byte", RoleSpace::srgb},
    {"default_float", RoleSpace::working},
    {"default_sequencer", RoleSpace::srgb},
    // Mari
    {"mari_monitor", RoleSpace::texture},
    {"mari_scalar_monitor", RoleSpace::texture},
    {"mari_color_picker", RoleSpace::texture},
    {"mari_working", RoleSpace::working},
    {"mari_int8", RoleSpace::texture},
    {"mari_int16", RoleSpace::texture},
    {"mari_int_scalar", RoleSpace::data},
    {"mari_scalar8", RoleSpace::data},
    {"mari_float", RoleSpace::working},
    // RenderMan
    {"srgb_linear", RoleSpace::working},
    {"srgb_texture", RoleSpace::texture},
    // Substance Painter
    {"substance_3d_painter_standard_srgb", RoleSpace::texture},
    {"substance_3d_painter_bitmap_import_8bit", RoleSpace::texture},
    {"substance_3d_painter_bitmap_import_16bit", RoleSpace::texture},
    {"substance_3d_painter_bitmap_import_floating", RoleSpace::working},
    {"substance_3d_painter_substance_material", RoleSpace::texture},
    {"substance_3d_painter_bitmap_export_8bit", RoleSpace::texture},
    {"substance_3d_painter_bitmap_export_16bit", RoleSpace::texture},
    {"substance_3d_painter_bitmap_export_floating", RoleSpace::working},
}};

std::vector<std::pair<std::string, std::string>> role_table(const std::string& working) {
    const std::array<std::string, 7> spaces = {
        working,       find_input_space("lin_ap0").title, "ACEScct",
        "CIE-XYZ-D65", find_display("srgb").title,        kTextureSpace,
        kDataSpace};
    std::vector<std::pair<std::string, std::string>> roles;
    for (const RoleRow& row : kRoles)
        roles.emplace_back(row.role, spaces.at(static_cast<std::size_t>(row.space)));
    return roles;
}

/// Checks limits of applications: Blender cuts names at 63 bytes, OCIO ignores the case of names.
void check_names(const ConfigModel& model) {
    std::map<std::string, std::string> taken;
    for (const auto& [role, space] : model.roles)
        taken[lowercase(role)] = "role " + role;
    const auto claim = [&](const std::string& name, const std::string& owner) {
        if (name.size() > 63) {
            throw Error({.parameter = "name", .value = name, .expected = "at most 63 bytes"});
        }
        const auto [it, is_new] = taken.emplace(lowercase(name), owner);
        if (!is_new) {
            throw Error({.parameter = "name",
                         .value = name + " for " + owner,
                         .expected = "a name that " + it->second + " does not have"});
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
            throw Error(Problem{.value = "view is " + view.name, .expected = "at most 63 bytes"});
        if (!views.insert(lowercase(view.name)).second) {
            throw Error(Problem{.value = "view is " + view.name,
                                .expected = "a name no other operator has"});
        }
    }
    for (const auto& [role, name] : model.roles) {
        const std::string& wanted = name;
        const bool known = std::any_of(model.spaces.begin(), model.spaces.end(),
                                       [&](const Space& s) { return s.name == wanted; });
        if (!known)
            throw Error(Problem{.value = fmt::format("role {} is {}", role, name),
                                .expected = "a space of the config"});
    }
}

/// Words in file names that identify a color space, in the spelling of its maker. A space stands
/// for nothing, a space, a dot, a dash or an underscore.
struct NamedSpace {
    std::string space;
    std::vector<std::string> words;
    /// Float files rarely hold code values of a display; the word then means their primaries.
    bool is_never_exr = false;
};

std::vector<NamedSpace> named_spaces() {
    const auto linear = [](const char* id) { return find_input_space(id).title; };
    return {
        {linear("lin_ap1"), {"ACEScg", "Lin AP1", "Linear AP1"}},
        {"ACEScct", {"ACEScct"}},
        {"ACEScc", {"ACEScc"}},
        {linear("lin_ap0"), {"ACES2065 1", "ACES2065", "Lin AP0", "Linear AP0", "AP0"}},
        {linear("lin_rec709"), {"Lin Rec 709", "Linear Rec 709", "Lin sRGB", "Linear sRGB"}},
        {linear("lin_rec2020"), {"Lin Rec 2020", "Linear Rec 2020"}},
        {linear("lin_p3d65"), {"Lin P3 D65", "Linear P3 D65", "Lin Display P3"}},
        {linear("lin_egamut"), {"Lin E Gamut", "Linear E Gamut"}},
        // Substance Painter, Maya and others write the whole name of the space into the file name
        // of a texture.
        {kTextureSpace, {"sRGB", "sRGB Tx", "sRGB Texture"}},
        {"sRGB Encoded AP1 - Texture", {"sRGB Encoded AP1", "sRGB AP1"}},
        {"sRGB Encoded P3-D65 - Texture", {"sRGB Encoded P3 D65", "sRGB P3 D65", "Display P3"}},
        {"Gamma 2.2 Rec.709 - Texture", {"G22 Rec 709", "Gamma 2 2 Rec 709"}, true},
        {"Gamma 2.2 AP1 - Texture", {"G22 AP1", "Gamma 2 2 AP1"}},
        {kVideoSpace, {"G24 Rec 709", "Gamma 2 4 Rec 709", "Rec 709", "BT 709", "Rec 1886"}, true},
        {find_display("rec2100_pq").title, {"Rec 2100 PQ", "Rec 2020 PQ"}},
        {find_display("rec2100_hlg").title, {"Rec 2100 HLG", "Rec 2020 HLG"}},
        {"ADX10", {"ADX10"}},
        {"ADX16", {"ADX16"}},
        {kFilmSpace, {"Cineon", "Kodak Log"}},
        {"ARRI LogC3 (EI800)",
         {"LogC", "LogC3", "LogC V3", "Alexa V3 LogC", "LogC EI800", "LogC3 EI800"}},
        {"ARRI LogC4", {"LogC4", "LogC V4", "LogC AWG4", "AWG4 LogC"}},
        {"DaVinci Intermediate WideGamut",
         {"DaVinci Intermediate", "DWG DI", "DI DWG", "DaVinci Intermediate Wide Gamut",
          "DaVinci Wide Gamut Intermediate", "DWG Intermediate"}},
        {"CanonLog2 CinemaGamut D55", {"C Log2", "Canon Log2"}},
        {"CanonLog3 CinemaGamut D55", {"C Log3", "Canon Log3"}},
        {"V-Log V-Gamut", {"V Log", "V Log V Gamut"}},
        {"Log3G10 REDWideGamutRGB", {"Log3G10"}},
        {"REDLogFilm REDWideGamutRGB", {"RED Log Film"}},
        {"S-Log3 S-Gamut3", {"S Log3", "S Gamut3", "S Log3 S Gamut3", "S Gamut3 S Log3"}},
        {"S-Log3 S-Gamut3.Cine",
         {"S Gamut3 Cine", "S Log3 Cine", "S Log3 S Gamut3 Cine", "S Gamut3 Cine S Log3"}},
        {"S-Log3 Venice S-Gamut3",
         {"Venice S Log3", "Venice S Gamut3", "S Log3 Venice S Gamut3", "S Log3 S Gamut3 Venice",
          "Venice S Log3 S Gamut3"}},
        {"S-Log3 Venice S-Gamut3.Cine",
         {"Venice S Gamut3 Cine", "S Log3 Venice S Gamut3 Cine", "S Log3 S Gamut3 Cine Venice",
          "Venice S Log3 S Gamut3 Cine"}},
        {kDataSpace, {"Raw", "Data", "Non Color", "Utility Raw"}},
    };
}

std::string uppercase(std::string text) {
    for (char& c : text)
        c = c >= 'a' && c <= 'z' ? static_cast<char>(c - 'a' + 'A') : c;
    return text;
}

/// A word as a regular expression: every part in lower case, in capitals and as it is spelled.
/// OpenColorIO's expressions have no flag to ignore case.
std::string pattern_of(const std::string& word) {
    std::string pattern;
    for (std::size_t begin = 0; begin <= word.size();) {
        const std::size_t end = std::min(word.find(' ', begin), word.size());
        const std::string part = word.substr(begin, end - begin);
        std::vector<std::string> spellings = {part};
        for (const std::string& other : {lowercase(part), uppercase(part)}) {
            if (std::find(spellings.begin(), spellings.end(), other) == spellings.end())
                spellings.push_back(other);
        }
        if (begin > 0) pattern += R"((?:_|\.|-| - | )?)";
        pattern += spellings.size() == 1 ? part : fmt::format("(?:{})", fmt::join(spellings, "|"));
        begin = end + 1;
    }
    return pattern;
}

/// Matches between separators in the last part of a path, so that a folder "raw" has no effect.
/// Avoids character sets: OpenColorIO compiles every expression for every file, and sets are
/// slowest.
std::string name_pattern(const std::string& words, bool is_never_exr) {
    return fmt::format(R"({}(?:.*(?:/|\\|_|\.|-| |\())?(?:{})(?:(?:_|\.|-| |\))(?!.*(?:/|\\)).*)?)",
                       is_never_exr ? R"((?!.*\.(?:exr|EXR)$))" : "", words);
}

/// Longer words come first: "slog3_sgamut3cine" must not match S-Gamut3.
std::vector<ConfigModel::FileRule> rules_by_word() {
    struct Word {
        std::string text;
        const NamedSpace* named;
    };
    const std::vector<NamedSpace> all = named_spaces();
    std::vector<Word> words;
    for (const NamedSpace& named : all) {
        for (const std::string& word : named.words)
            words.push_back({word, &named});
    }
    const auto letters = [](const Word& word) {
        return word.text.size() -
               static_cast<std::size_t>(std::count(word.text.begin(), word.text.end(), ' '));
    };
    std::stable_sort(words.begin(), words.end(),
                     [&](const Word& a, const Word& b) { return letters(a) > letters(b); });
    std::vector<ConfigModel::FileRule> rules;
    std::map<std::string, int> counts;
    for (auto word = words.begin(); word != words.end();) {
        // Consecutive words of one space form one rule.
        const auto end = std::find_if(
            word, words.end(), [&](const Word& other) { return other.named != word->named; });
        std::vector<std::string> patterns;
        for (auto it = word; it != end; ++it)
            patterns.push_back(pattern_of(it->text));
        const std::string& space = word->named->space;
        const int count = ++counts[space];
        rules.push_back(
            {count == 1 ? space : fmt::format("{} {}", space, count), space, "",
             name_pattern(fmt::format("{}", fmt::join(patterns, "|")), word->named->is_never_exr)});
        word = end;
    }
    return rules;
}

std::vector<ConfigModel::FileRule> make_file_rules(const std::string& working) {
    std::vector<ConfigModel::FileRule> rules;
    // Arnold's automatic textures end in the space that they were converted to,
    // "wood_sRGB - Texture_ACEScg.png.tx", and other converters keep the name of the source.
    for (const NamedSpace& named : named_spaces()) {
        const bool is_linear =
            std::any_of(all_input_spaces().begin(), all_input_spaces().end(),
                        [&](const InputSpace& s) { return s.title == named.space; });
        if (!is_linear) continue;
        std::vector<std::string> patterns;
        for (const std::string& word : named.words)
            patterns.push_back(pattern_of(word));
        rules.push_back({named.space + " tx", named.space, "",
                         fmt::format(R"((?:.*(?:/|\\|_|\.|-| ))?(?:{})(?:\..{{3,4}})?\.tx)",
                                     fmt::join(patterns, "|"))});
    }
    const std::vector<ConfigModel::FileRule> by_word = rules_by_word();
    rules.insert(rules.end(), by_word.begin(), by_word.end());
    rules.push_back({"linear tx", working, "", R"(.*\.(?:exr|hdr|EXR|HDR)\.tx)"});
    for (const FormatColor& format : all_format_colors()) {
        if (!format.has_file_rule) continue;
        const bool is_linear = format.meaning == FormatMeaning::linear;
        for (const std::string_view extension : format.extensions) {
            rules.push_back({std::string(extension),
                             is_linear ? working : std::string(format.integer_space),
                             std::string(extension), ""});
        }
    }
    return rules;
}

bool same_stage(const Stage& a, const Stage& b) {
    static const std::array<Expr, 3> rgb = {Expr::input(0), Expr::input(1), Expr::input(2)};
    const std::array<Expr, 3> x = apply_stage(a, rgb);
    const std::array<Expr, 3> y = apply_stage(b, rgb);
    return same(x[0], y[0]) && same(x[1], y[1]) && same(x[2], y[2]);
}

/// Stages of a look before those of the operator; empty if the look changes the operator itself.
Pipeline scene_look(const Operator& op, const Look& look) {
    const Pipeline with = resolve(op, nullptr, {}, look.id).build();
    const Pipeline without = resolve(op, nullptr, {}, "").build();
    if (with.size() <= without.size()) return {};
    const auto begin = with.begin() + static_cast<std::ptrdiff_t>(with.size() - without.size());
    if (!std::equal(begin, with.end(), without.begin(), same_stage)) return {};
    return {with.begin(), begin};
}

std::string look_name(const Operator& op, const Look& look) { return op.view + " - " + look.title; }

std::string description_of(const Operator& op, const std::string& extra = "") {
    std::string text = op.title + extra;
    if (!op.character.empty()) text += ": " + op.character;
    return text + (op.source.empty() ? "." : ". Source: " + op.source + ".");
}

ConfigModel::View view_of(const Operator& op, const std::string& look_id = "") {
    for (const Look& look : op.looks) {
        if (look.id != look_id) continue;
        return {op.view + " " + look.title, resolve(op, nullptr, {}, look.id),
                description_of(op, ", look " + look.title)};
    }
    return {op.view, resolve(op, nullptr, {}, ""), description_of(op)};
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
            if (other.name != view.name) continue;
            if (other.op.op->name() == view.op.op->name()) return;
            throw Error(
                Problem{.value = fmt::format("view is {}, of {} and of {}", view.name,
                                             other.op.op->name(), view.op.op->name()),
                        .expected = "names of views that differ (`view =` in a .tone file)"});
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
        if (is_same_name(wanted, "none")) continue;
        if (wanted == "standard") {  // "Standard" is the view of that name, Blender's
            add_standard();
            continue;
        }
        if (is_same_name(wanted, "all")) {
            add_standard();
            for (const auto& view : every_view())
                add(view);
            continue;
        }
        ResolvedOperator op{};
        try {
            op = resolve_operator(wanted, {}, {}, options.others);
        } catch (const FileError&) {
            throw;
        } catch (const Error& e) {
            throw Error({.parameter = "views",
                         .value = wanted,
                         .expected = fmt::format("standard, all, none, or the name of a view or an "
                                                 "operator ({})",
                                                 e.text())});
        }
        ConfigModel::View view = view_of(*op.op, op.params.look());
        for (const Preset& preset : op.op->presets) {
            if (&preset == op.preset) view.name += " " + preset.title;
        }
        view.op = op;
        add(view);
    }
    for (const auto& custom : options.custom) {
        const ResolvedOperator& op = custom.op;
        require_no_surroundings(*op.op);
        if (custom.name.empty())
            throw Error(Problem{.value = "the view of " + operator_text(op) + " has no name",
                                .expected = "one"});
        views.push_back({custom.name, op, description_of(*op.op) + " As " + op.label + "."});
    }
    if (views.empty())
        throw Error({.parameter = "views", .value = "none", .expected = "<<custom>> beside it"});
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
    std::vector<const Operator*> shown;
    for (const Operator& op : all_operators()) {
        const bool is_shown = std::any_of(views.begin(), views.end(),
                                          [&](const auto& view) { return view.op.op == &op; });
        if (is_shown) shown.push_back(&op);
    }
    for (const ConfigModel::View& view : views) {  // files
        const bool is_known = std::any_of(shown.begin(), shown.end(), [&](const Operator* op) {
            return op->name() == view.op.op->name();
        });
        if (!is_known) shown.push_back(view.op.op);
    }
    for (const Operator* const shown_op : shown) {
        const Operator& op = *shown_op;
        for (const Look& look : op.looks) {
            const Pipeline stages = scene_look(op, look);
            if (!stages.empty()) all.push_back({look_name(op, look), stages, &op, look.help});
        }
    }
    if (options.looks.empty()) return all;
    std::vector<ConfigModel::Look> chosen;
    for (const std::string& wanted : options.looks) {
        if (is_same_name(wanted, "none")) continue;
        const auto found = std::find_if(all.begin(), all.end(), [&](const auto& look) {
            return is_same_name(look.name, wanted);
        });
        if (found == all.end()) {
            std::vector<std::string> names = {"none"};
            for (const auto& look : all)
                names.push_back(look.name);
            throw Error({.parameter = "looks",
                         .value = wanted,
                         .expected = join_choices(names),
                         .suggestion = suggested_names(wanted, names)});
        }
        chosen.push_back(*found);
    }
    return chosen;
}

}  // namespace

std::string config_view_name(const std::string& name, const ResolvedOperator& op,
                             const Display& display) {
    const double peak = std::min(op.peak() * kUnitLuminance, display.peak);
    if (!display.is_hdr || peak <= kUnitLuminance) return name;
    return name + fmt::format(" - HDR {:g} nits", peak);
}

std::string output_space_name(const std::string& view, const std::string& display) {
    return "Output - " + view + " - " + display;
}

ConfigModel make_config_model(const ConfigOptions& options) {
    ConfigModel model;
    model.cache_folder = options.cache_folder;
    model.name = kConfigName;
    model.description =
        "Tone mapping operators as OpenColorIO views, each measured against a double-precision "
        "reference. Generated by Tonewright; do not edit.";

    for (const InputSpace& space : all_input_spaces()) {
        if (!space.is_camera) model.spaces.push_back(space_of(space));
    }
    for (const EncodedSpace& space : all_encoded_spaces())
        model.spaces.push_back(space_of(space));
    // Adds all display spaces, also those of displays that are left out, because pictures may be in
    // their code values.
    for (const Display& display : all_displays()) {
        model.spaces.push_back(space_of(display));
        if (options.displays.empty()) model.displays.push_back(&display);
    }
    for (const std::string& name : options.displays) {
        const Display* display = &find_display(name);
        if (std::find(model.displays.begin(), model.displays.end(), display) ==
            model.displays.end())
            model.displays.push_back(display);
    }
    model.views = choose_views(options);
    for (auto& view : model.views) {
        if (const std::string constants = stand_ins(view.op); !constants.empty())
            view.description += " Cannot measure pictures here: uses " + constants + ".";
    }
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
