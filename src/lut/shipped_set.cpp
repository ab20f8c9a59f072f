// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <mutex>

#include "base/format_number.h"
#include "base/strings.h"
#include "lut/in_parallel.h"
#include "lut/shipped_set.h"
#include "tonewright/generated_files.h"
#include "tonewright/lut.h"
#include "tonewright/lut_applications.h"
#include "tonewright/registry.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

/// Operators that users ask for by name. `tonewright bake` makes LUTs of all others.
const std::vector<std::string> kOperators = {
    "agx_blender",    "agx_sobotka", "aces_13", "aces_20",         "aces_hill",
    "aces_narkowicz", "gt7",         "hable",   "khronos_neutral", "reinhard_extended",
};
/// Decimals of the numbers in .cube files.
constexpr int kDecimals = 4;

const std::string& display_of(const LutPresetSet& set) {
    return set.display.empty() ? set.host->display : set.display;
}

/// "resolve"; with another display than the application's "resolve_rec2100_pq".
std::string id_of(const LutPresetSet& set) {
    return set.display.empty() ? set.host->id : set.host->id + "_" + set.display;
}

std::string title_of(const LutPresetSet& set) {
    return set.display.empty() ? set.host->title
                               : set.host->title + ", " + find_display(set.display).title;
}

/// Identifier of an encoding in a file name, without parameters.
std::string name_part(const std::string& id) { return id.substr(0, id.find(':')); }

ShippedLut plan(const LutPresetSet& set, const std::string& id) {
    const LutApplication& host = *set.host;
    ShippedLut planned;
    planned.set = &set;
    LutRequest& request = planned.request;
    request.encoding = parse_input_encoding(host.encoding);
    request.view =
        make_view(resolve_operator(id), lut_input_of(host, find_operator(id)), 0, display_of(set));
    request.format = host.format;
    if (!host.takes_any_primaries || !is_per_channel(build_view(request.view))) {
        const auto own = set.sizes.find(id);
        request.dimension = LutDimension::three;
        request.size = own == set.sizes.end() ? set.size.value_or(host.size) : own->second;
    }
    request.bits = host.bits;
    if (host.format == LutFormat::cube) request.decimals = kDecimals;
    // `davinci`, or with other primaries than the encoding's: `davinci_rec709`.
    std::string taken = name_part(host.encoding);
    if (request.view.input != request.encoding.default_input)
        taken += request.view.input.substr(std::string_view("lin").size());
    const std::string stem = fmt::format("{}_{}_to_{}", id, taken, display_of(set));
    planned.path = fmt::format("{}/{}.{}", host.id, stem,
                               is_picture_format(host.format) ? "png" : name_of(host.format));
    planned.thumbnail = fmt::format("{}/thumbnails/{}.png", host.id, stem);
    return planned;
}

}  // namespace

void bake_shipped_lut(ShippedLut& planned) {
    const LutInterpolation interpolation = interpolation_of(planned.set->host);
    BakedLut baked = bake_lut(planned.request, LutNodes::automatic, interpolation);
    if (!is_picture_format(planned.request.format))
        planned.contents = write_lut(baked, planned.request);
    planned.lut = std::move(baked.lut);
    planned.is_fitted = baked.is_fitted;
    // A 1D table has only one figure.
    const LutError other = baked.other_error.value_or(baked.error);
    const bool is_trilinear = interpolation == LutInterpolation::trilinear;
    planned.tetrahedral = is_trilinear ? other : baked.error;
    planned.trilinear = is_trilinear ? baked.error : other;
    planned.ringing = baked.ringing;
}

namespace {

const LutError& error_at_host(const ShippedLut& lut) {
    return interpolation_of(lut.set->host) == LutInterpolation::trilinear ? lut.trilinear
                                                                          : lut.tetrahedral;
}

std::string csv_field(const std::string& text) {
    if (text.find_first_of(",\"") == std::string::npos) return text;
    std::string out = "\"";
    for (const char c : text)
        out += c == '"' ? std::string("\"\"") : std::string(1, c);
    return out + "\"";
}

std::string error_fields(const LutError& error) {
    return fmt::format("{},{},{},{},{},{}", rounded_up(error.max, 3), rounded_up(error.p999, 3),
                       rounded_up(error.mean, 3), rounded_up(error.delta_e_max, 3),
                       rounded_up(error.delta_e_p999, 3), rounded_up(error.delta_e_mean, 3));
}

std::string manifest(const std::vector<ShippedLut>& luts) {
    std::string text =
        "path,operator,host,input_space,input_encoding,scene_lo,scene_hi,output,format,size,depth,"
        "decimals,nodes,host_interpolation,tetrahedral_max,tetrahedral_p999,tetrahedral_mean,"
        "tetrahedral_max_dE_ITP,tetrahedral_p999_dE_ITP,tetrahedral_mean_dE_ITP,trilinear_max,"
        "trilinear_p999,trilinear_mean,trilinear_max_dE_ITP,trilinear_p999_dE_ITP,"
        "trilinear_mean_dE_ITP,rays_p999,rays_fall,photographs_p999,photographs_mean,"
        "photographs_share,content_hash\n";
    for (const ShippedLut& lut : luts) {
        const LutRequest& r = lut.request;
        const PhotographError& photographs = error_at_host(lut).photographs;
        text += fmt::format(
            "{},{},{},{},{},{:.9g},{:.9g},{},{},{},{},{},{},{},{},{},{},{},{},{},{},{}\n", lut.path,
            csv_field(r.view.op.label), lut.set->host->id, r.view.input, r.encoding.id,
            r.encoding.scene_lo, r.encoding.scene_hi, r.view.display, name_of(r.format),
            lut.lut.size, r.bits ? std::to_string(*r.bits) : "",
            r.decimals ? std::to_string(*r.decimals) : "", lut.is_fitted ? "fitted" : "sampled",
            error_at_host(lut).interpolation, error_fields(lut.tetrahedral),
            error_fields(lut.trilinear), rounded_up(lut.ringing.p999, 3),
            rounded_up(lut.ringing.fall, 3), rounded_up(photographs.p999, 3),
            rounded_up(photographs.mean, 3), rounded_up(photographs.share, 3),
            content_hash(lut.contents));
    }
    return text;
}

std::string output_title(const LutRequest& request) {
    return request.view.display == kLinearOutput ? "display-linear Rec.709"
                                                 : find_display(request.view.display).title;
}

std::string size_text(const ShippedLut& lut) {
    const int n = lut.lut.size;
    if (lut.lut.dimension == 1) return fmt::format("{} entries", n);
    if (is_strip(lut.request.format)) return fmt::format("{} x {} pixels", n * n, n);
    return fmt::format("{0} x {0} x {0}", n);
}

/// In the order of the LUTs, each once.
std::vector<const LutPresetSet*> sets_of(const std::vector<ShippedLut>& luts) {
    std::vector<const LutPresetSet*> sets;
    for (const ShippedLut& lut : luts) {
        if (sets.empty() || sets.back() != lut.set) sets.push_back(lut.set);
    }
    return sets;
}

/// Operators down, applications across.
std::string overview(const std::vector<ShippedLut>& luts) {
    std::string head = "| operator |";
    std::string rule = "|---|";
    for (const LutPresetSet* set : sets_of(luts)) {
        head += fmt::format(" [{0}](#{1}) |", title_of(*set), id_of(*set));
        rule += "---|";
    }
    std::string text = head + "\n" + rule + "\n";
    for (const std::string& id : kOperators) {
        text += "| " + find_operator(id).title + " |";
        for (const LutPresetSet* set : sets_of(luts)) {
            const auto found = std::find_if(luts.begin(), luts.end(), [&](const ShippedLut& lut) {
                return lut.set == set && lut.request.view.op.op->id == id;
            });
            text += found == luts.end()
                        ? " |"
                        : fmt::format(" [![{}]({})]({}) |", id, found->thumbnail, found->path);
        }
        text += "\n";
    }
    return text;
}

/// The steps for a page: a command at their beginning is code.
std::string markdown_steps(const std::string& steps) {
    if (!steps.starts_with("ffmpeg ") && !steps.starts_with("convert ")) return steps;
    const std::string command = steps.substr(0, steps.find(": "));
    return "`" + command + "`" + steps.substr(command.size());
}

std::string lamps_of(const LutRinging& ringing) {
    constexpr double kCodes = 255;
    if (rings(ringing))
        return fmt::format("ring of {:.0f} codes", std::ceil(kCodes * ringing.fall));
    if (follows_operator(ringing)) return "follow";
    return fmt::format("99.9 % within {:.0f}", std::ceil(kCodes * ringing.p999));
}

std::string section(const LutPresetSet& set, const std::vector<ShippedLut>& luts) {
    const LutApplication& host = *set.host;
    std::string text = fmt::format("\n<a id=\"{}\"></a>\n## {}\n\n", id_of(set), title_of(set));
    if (!set.also.empty()) text += "Also for " + set.also + ".\n\n";
    text +=
        fmt::format("{}. {}\n\n", markdown_steps(host.steps),
                    host.tested.empty() ? "(Tests check the format; the application was not run.)"
                                        : "(Tested with " + host.tested + ".)");
    bool is_first = true;
    for (const ShippedLut& lut : luts) {
        if (lut.set != &set) continue;
        const LutRequest& r = lut.request;
        const LutError& error = error_at_host(lut);
        if (is_first) {
            text += fmt::format(
                "Each file: `tonewright bake OPERATOR <<application={}>>{} <<size=SIZE>>{} -o "
                "FILE`, without "
                "<<size>> where the file has entries; {} interpolation, {:+.1f} stops from 0.18 at "
                "input 1.\n\n"
                "| operator | file | size | input | output | photographs: 99.9 % | mean | above "
                "one code | lamps | every color: 99.9 % | picture |\n"
                "|---|---|---|---|---|---|---|---|---|---|---|\n",
                host.id, set.display.empty() ? "" : fmt::format(" <<display={}>>", set.display),
                r.decimals ? fmt::format(" <<decimals={}>>", *r.decimals) : "",
                interpolation_of(&host) == LutInterpolation::trilinear ? "trilinear"
                                                                       : "tetrahedral",
                std::log2(r.encoding.scene_hi / 0.18));
        }
        is_first = false;
        constexpr double kCodes = 255;
        text += fmt::format(
            "| {} | [{}]({}) | {} | {}, {} | {} | {:.2f} | {:.2f} | {:.2g} % | {} | {:.1f} | "
            "![{}]({}) |\n",
            r.view.op.op->title, lut.path.substr(lut.path.find('/') + 1), lut.path, size_text(lut),
            r.encoding.title, find_input_space(r.view.input).title, output_title(r),
            kCodes * error.photographs.p999, kCodes * error.photographs.mean,
            100 * error.photographs.share, lamps_of(lut.ringing), kCodes * error.p999,
            r.view.op.op->id, lut.thumbnail);
    }
    if (!set.nearer.empty()) text += "\nNearer: " + set.nearer + ".\n";
    return text;
}

std::string readme(const std::vector<ShippedLut>& luts) {
    std::string text =
        "# LUTs\n\nChoose your application's column and click a picture: that is the file. Load it "
        "as the application's section\nbelow says. A file takes the input that stands before "
        "`_to_` in its name; with scene-linear input it clips at 1.\nFiles with sRGB input work on "
        "a displayed picture, which has no values above white: use them only in\napplications that "
        "take no other input. `tonewright bake` makes LUTs of any other operator, look, "
        "parameter,\nsize, input or display ([LUTs](../docs/luts.md)), and `tonewright bake "
        "OPERATOR <<exact>>` lists the most exact\nfiles for each application.\n\n";
    text += overview(luts);
    text +=
        "\nThe pictures show the test chart (`tonewright chart`) through that file, with the "
        "interpolation of the\napplication.\n\n"
        "Errors are differences from the double-precision operator in 8-bit codes, [0, 255]; for "
        "Unity, of display-linear\nvalues as sRGB shows them. *Photographs* are colors as "
        "photographs and renders contain them, as far\nas the input holds them; "
        "*every color* is the sample set: grays, grids of Rec.709, Rec.2020 and AP1 at five\n"
        "exposures, random colors. *Lamps* are the test chart's lamps and hues along rising "
        "exposure: *follow* means that\n99.9 % of the errors are within 5 codes, and that no "
        "channel falls by more than two codes where the operator's\ndoes not; a *ring* of N codes "
        "is "
        "such a fall. Where photographs are more than one code off, the operator clips\nor bends "
        "between the grid points, and each section says what is nearer. `MANIFEST.csv` has the "
        "figures for\nboth interpolations as code values of 0 to 1, with the maximum and the color "
        "differences. Generated by\n`tonewright bake <<all=luts>>`; do not edit.\n";
    for (const LutPresetSet* set : sets_of(luts))
        text += section(*set, luts);
    return text;
}

}  // namespace

LutInterpolation interpolation_of(const LutApplication* application) {
    if (!application) return LutInterpolation::automatic;
    return application->interpolation.starts_with("trilinear") ? LutInterpolation::trilinear
                                                               : LutInterpolation::tetrahedral;
}

const std::vector<LutPresetSet>& lut_preset_sets() {
    // All files together have at most 62 MB, so only Resolve has 65 nodes a side. Unity's 32 are
    // those of a new project.
    static const std::vector<std::string> film = {
        "agx_blender", "agx_sobotka", "aces_13", "aces_20", "gt7", "hable", "khronos_neutral"};
    static const std::vector<LutPresetSet> sets = {
        {.host = &find_lut_application("resolve"),
         .operators = {"agx_blender", "agx_sobotka", "aces_13", "aces_20", "aces_narkowicz", "gt7",
                       "hable", "khronos_neutral", "reinhard_extended"},
         .sizes = {{"agx_sobotka", 33}},
         .approximate = {"aces_13", "gt7", "khronos_neutral"},
         .nearer =
             "a [DCTL](../docs/shaders.md) (`tonewright shader gt7 <<application=resolve>> -o "
             "gt7.dctl`); for footage within Rec.709, `<<input=lin_rec709>>`"},
        {.host = &find_lut_application("resolve"),
         .operators = {"agx_blender", "aces_13", "aces_20", "gt7"},
         .size = 33,
         .approximate = {"aces_20"},
         .nearer = "65 nodes (`tonewright bake gt7 <<application=resolve>> <<display=rec2100_pq>> "
                   "-o gt7.cube`)",
         .display = "rec2100_pq"},
        {.host = &find_lut_application("nuke"),
         .also = "every application with pictures in ACEScct: After Effects, Houdini, Flame, "
                 "Baselight",
         .operators = film,
         .size = 33,
         .approximate = {film.begin(), film.end()},
         .nearer = "in applications with OpenColorIO, a ctf of scene-linear input (`tonewright "
                   "bake gt7 <<application=nuke>> -o gt7.ctf`) or the "
                   "[config](../ocio_config/README.md)"},
        {.host = &find_lut_application("premiere"),
         .also = "every editor with ARRI LogC3 footage",
         .operators = film,
         .size = 33,
         .approximate = {film.begin(), film.end()},
         .nearer = "65 nodes (`tonewright bake gt7 <<application=premiere>> -o gt7.cube`)"},
        {.host = &find_lut_application("ffmpeg"),
         .operators = film,
         .size = 49,
         .sizes = {{"hable", 33}},
         .approximate = {"agx_blender", "aces_13", "aces_20", "gt7", "hable", "khronos_neutral"},
         .nearer = "65 nodes (`tonewright bake gt7 <<application=ffmpeg>> -o gt7.cube`)"},
        {.host = &find_lut_application("unity"),
         .operators = kOperators,
         .sizes = {{"agx_blender", 48}, {"khronos_neutral", 48}},
         .approximate = {"aces_13", "aces_20", "aces_hill", "gt7"},
         .nearer = "a larger Grading LUT Size (`<<size=64>>`) or a [shader](../docs/shaders.md) "
                   "(`tonewright shader gt7 <<application=unity>> -o gt7.shader`)"},
        {.host = &find_lut_application("unreal"),
         .operators = kOperators,
         .approximate = {"khronos_neutral"},
         .nearer =
             "a [shader](../docs/shaders.md) (`tonewright shader gt7 <<application=unreal>> -o "
             "gt7.ush`)"},
        {.host = &find_lut_application("godot"),
         .operators = kOperators,
         .approximate = {"khronos_neutral"},
         .nearer =
             "a [shader](../docs/shaders.md) (`tonewright shader gt7 <<application=godot>> -o "
             "gt7.glsl`)"},
        {.host = &find_lut_application("photoshop"),
         .also = "OBS Studio, Affinity Photo, darktable, G'MIC, GIMP, three.js",
         .operators = kOperators,
         .size = 25,
         .nearer = "33 nodes (`tonewright bake gt7 <<application=photoshop>> -o gt7.cube`)"},
        {.host = &find_lut_application("imagemagick"),
         .also = "GraphicsMagick, RawTherapee",
         .operators = kOperators,
         .size = 36,
         .nearer = "64 nodes (`tonewright bake gt7 <<application=imagemagick>> -o gt7.png`)"},
    };
    return sets;
}

namespace {

bool is_application(const LutPresetSet& set, const std::string& name) {
    return is_same_name(set.host->id, name) || is_same_name(set.host->title, name);
}

}  // namespace

void require_preset_set(const std::string& application) {
    std::vector<std::string> names;
    std::vector<NamedChoice> choices;
    for (const LutPresetSet& set : lut_preset_sets()) {
        if (is_application(set, application)) return;
        names.emplace_back(set.host->id);
        choices.push_back({set.host->id, {set.host->title}});
    }
    throw Error({.parameter = "application",
                 .value = application,
                 .expected = join_choices(names) + " with <<all>>",
                 .suggestion = suggested_names(application, choices)});
}

std::vector<ShippedLut> plan_shipped_luts(const std::string& application) {
    if (!application.empty()) require_preset_set(application);
    std::vector<ShippedLut> luts;
    for (const LutPresetSet& set : lut_preset_sets()) {
        if (!application.empty() && !is_application(set, application)) continue;
        for (const std::string& id : set.operators)
            luts.push_back(plan(set, id));
    }
    return luts;
}

std::vector<ShippedLut> bake_shipped_luts(
    const std::string& application,
    const std::function<void(std::size_t done, std::size_t total)>& progress) {
    std::vector<ShippedLut> luts = plan_shipped_luts(application);
    std::mutex mutex;
    std::size_t done = 0;
    in_parallel(luts.size(), 0, [&](std::size_t i) {
        bake_shipped_lut(luts[i]);
        const std::lock_guard lock(mutex);
        ++done;
        if (progress) progress(done, luts.size());
    });
    return luts;
}

std::vector<GeneratedFile> describe_shipped_luts(const std::vector<ShippedLut>& luts) {
    return {{"README.md", readme(luts)}, {"MANIFEST.csv", manifest(luts)}};
}

TONEWRIGHT_NAMESPACE_END
