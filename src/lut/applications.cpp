// SPDX-License-Identifier: Apache-2.0
//
// The LUTs that applications expect. Sources: their manuals, unless an entry names another source.
#include <fmt/format.h>

#include "base/strings.h"
#include "tonewright/lut.h"
#include "tonewright/lut_applications.h"

TONEWRIGHT_NAMESPACE_BEGIN

const std::vector<LutApplication>& all_lut_applications() {
    static const std::vector<LutApplication> hosts = {
        {"resolve",
         "DaVinci Resolve",
         LutFormat::cube,
         65,
         "davinci",
         "rec1886",
         {},
         "tetrahedral",
         "Project Settings > Color Management: Open LUT Folder, copy, Update Lists; for 3D "
         "LUTs, 3D Lookup Table Interpolation: Tetrahedral. In the timeline, two nodes: Color "
         "Space Transform with the "
         "file's primaries as output color space, DaVinci Intermediate as output gamma, tone "
         "mapping None, gamut mapping None; then LUTs, the file",
         "",
         true,
         "",
         65},  // of 17, 33 and 65, the sizes that it writes
        {"nuke",
         "Nuke",
         LutFormat::cube,
         65,
         "acescct",
         "srgb",
         {},
         "tetrahedral",
         "OCIOFileTransform with the file and interpolation tetrahedral, after a conversion to "
         "ACEScct",
         "",
         false,
         "OCIOFileTransform with the file, on scene-linear Rec.709; no conversion before it"},
        {"ffmpeg",
         "ffmpeg",
         LutFormat::cube,
         65,
         "pq",
         "rec1886",
         {},
         "tetrahedral",
         // The LUT changes pixels, not the color tags of the frames: setparams sets the tags,
         // zscale reads them, and the last options write them into the file.
         "ffmpeg -i hdr10.mkv -vf "
         "zscale=matrix=gbr:range=full,format=gbrp16le,lut3d=FILE:interp=tetrahedral,"
         "setparams=color_primaries=bt709:color_trc=bt709,zscale=matrix=bt709:range=limited,"
         "sidedata=delete,format=yuv420p -color_primaries bt709 -color_trc bt709 -colorspace bt709 "
         "-c:a copy out.mkv: HDR10 (PQ, Rec.2020) in, BT.709 out, 4:2:0 of 8 bits; yuv420p10le for "
         "10",
         "ffmpeg 5.1 and 9.0"},
        {"premiere",
         "Premiere Pro",
         LutFormat::cube,
         65,
         "logc3",
         "rec1886",
         {},
         "tetrahedral",
         "Lumetri Color > Basic Correction > Input LUT > Browse, on a clip in ARRI LogC3",
         ""},
        // Apple's user guide, "Apply LUTs in Final Cut Pro". It names neither the interpolation nor
        // the sizes: the worse interpolation, and the size that every editor reads.
        {"fcp",
         "Final Cut Pro",
         LutFormat::cube,
         33,
         "logc3",
         "rec1886",
         {},
         "trilinear",
         "on a clip in ARRI LogC3: Info inspector > Camera LUT > Add Custom Camera LUT",
         "",
         false,
         "",
         33},
        {"photoshop",
         "Photoshop",
         LutFormat::cube,
         33,
         "srgb",
         "srgb",
         {},
         "tetrahedral",
         "Layer > New Adjustment Layer > Color Lookup > Load 3D LUT, in a document in sRGB",
         ""},
        {"affinity",
         "Affinity Photo",
         LutFormat::cube,
         33,
         "srgb",
         "srgb",
         {},
         "trilinear",
         "Layer > New Adjustment Layer > LUT Adjustment > Load LUT, in a document in sRGB",
         ""},
        {"unreal", "Unreal Engine", LutFormat::strip, 16, "srgb", "srgb", 8, "trilinear",
         "import as texture, Mip Gen Settings NoMipmaps, Texture Group ColorLookupTable; Post "
         "Process Volume > Color Grading > Misc > Color Grading LUT: works on the displayed "
         "picture",
         ""},
        {"unity",
         "Unity HDRP",
         LutFormat::cube,
         32,
         "unity_logc",
         "linear",
         {},
         "trilinear",
         "import the .cube; Volume > Tonemapping > Mode External > Lookup Texture. Its size must "
         "be "
         "the HDRP Asset's Grading LUT Size, 32 unless changed: <<size>>",
         "",
         false,
         "",
         65},  // GlobalPostProcessSettings.k_MaxLutSize
        // Core RP Library, Color.hlsl, ApplyLut2D: the slice by blue, in it u by red and v by
        // green; Unity's textures have v 0 at the bottom.
        {"unity_urp", "Unity URP", LutFormat::strip_up, 32, "srgb", "srgb", 8, "trilinear",
         "import with sRGB off, no mip maps, no compression; Volume > Color Lookup > Lookup "
         "Texture. Its height must be the URP Asset's Grading LUT Size, 32 unless changed: "
         "<<size>>. "
         "Works on the displayed picture",
         ""},
        {"godot", "Godot", LutFormat::strip, 32, "srgb", "srgb", 8, "trilinear",
         "import as Texture3D, Slices Horizontal as many as the picture is high, 32 unless "
         "changed: "
         "<<size>>; Environment > Adjustments > Color "
         "Correction: works on the displayed picture",
         ""},
        {"obs",
         "OBS Studio",
         LutFormat::cube,
         33,
         "srgb",
         "srgb",
         {},
         "tetrahedral",
         "Filters > + > Apply LUT > Path",
         ""},
        {"mpv",
         "mpv",
         LutFormat::cube,
         65,
         "pq",
         "srgb",
         {},
         "tetrahedral",
         "mpv --vo=gpu-next --lut=FILE --lut-type=conversion --target-trc=srgb "
         "--target-prim=bt.709 hdr10.mkv",
         "mpv 0.41.0; mpv 0.35.1, which is trilinear"},
        {"gmic",
         "G'MIC, GIMP with G'MIC",
         LutFormat::cube,
         33,
         "srgb",
         "srgb",
         {},
         "trilinear",
         "gmic in.tif FILE div[1] 255 'fill[0]' "
         "'I(#1,R/255*(w#1-1),G/255*(h#1-1),B/255*(d#1-1),1,0)*255' keep[0] "
         "-o out.tif; in GIMP: Filters > G'MIC-Qt > Colors > Apply External CLUT",
         "G'MIC 2.9.4"},
        {"darktable",
         "darktable",
         LutFormat::cube,
         33,
         "srgb",
         "srgb",
         {},
         "tetrahedral",
         "preferences > processing > 3D LUT root folder; module LUT 3D, application color space "
         "sRGB",
         "darktable 4.2.1"},
        {"rawtherapee", "RawTherapee", LutFormat::hald, 64, "srgb", "srgb", 16, "trilinear",
         "Preferences > Image Processing > HaldCLUT directory; Color > Film Simulation",
         "RawTherapee 5.9"},
        {"imagemagick", "ImageMagick, GraphicsMagick", LutFormat::hald, 64, "srgb", "srgb", 16,
         "trilinear", "convert in.png FILE -hald-clut out.png",
         "ImageMagick 6.9.11 and 7.1.2, GraphicsMagick 1.3.40"},
        {"flame", "Flame, Lustre", LutFormat::threedl, 33, "acescct", "rec1886", 12, "trilinear",
         "LUT Editor > Import, on a picture in ACEScct", ""},
        {"houdini",
         "Houdini",
         LutFormat::houdini,
         64,
         "acescct",
         "srgb",
         {},
         "trilinear",
         "in a compositing network: Lookup COP with the file, after a conversion to ACEScct; to "
         "look "
         "only: right mouse button on the viewer's LUT button, load it",
         ""},
        {"icc", "ICC device link: Photoshop, ImageMagick, LittleCMS", LutFormat::icc, 33, "srgb",
         "srgb", 16, "tetrahedral",
         "Photoshop, on a picture in sRGB: Layer > New Adjustment Layer > Color Lookup > Device "
         "Link > Load; convert in.png -profile FILE +profile '*' out.png; tificc -l FILE -c 0 -w "
         "16 in.tif out.tif",
         "LittleCMS 2.14 and ImageMagick 6.9.11, 16 bits"},
        {"ocio",
         "OpenColorIO",
         LutFormat::clf,
         33,
         "acescct",
         "srgb",
         {},
         "tetrahedral",
         "FileTransform with the file and interpolation tetrahedral, after a conversion to "
         "ACEScct; the config has no such step",
         "OpenColorIO 2.1.2",
         false,
         "FileTransform with the file, on scene-linear Rec.709; no conversion before it"},
        {"threejs",
         "three.js",
         LutFormat::cube,
         33,
         "srgb",
         "srgb",
         {},
         "trilinear",
         "new LUTCubeLoader().setType(FloatType), because its default is 8 bits; then "
         "LUTPass after OutputPass: works on the displayed picture",
         "three.js r187 in Chromium 156"},
    };
    return hosts;
}

const LutApplication& find_lut_application(std::string_view id) {
    std::vector<std::string> ids;
    std::vector<NamedChoice> choices;
    for (const LutApplication& host : all_lut_applications()) {
        if (is_same_name(host.id, id) || is_same_name(host.title, id)) return host;
        ids.push_back(host.id);
        choices.push_back({host.id, {host.title}});
    }
    throw Error({.parameter = "application",
                 .value = std::string(id),
                 .expected = join_choices(ids),
                 .suggestion = suggested_names(id, choices)});
}

bool reads_chains(const LutApplication& application, LutFormat format) {
    return !application.chain_steps.empty() &&
           (format == LutFormat::clf || format == LutFormat::ctf);
}

std::string lut_encoding_of(const LutApplication& application, LutFormat format) {
    return reads_chains(application, format) ? "linear" : application.encoding;
}

const std::string& lut_steps_of(const LutApplication& application, LutFormat format) {
    return reads_chains(application, format) ? application.chain_steps : application.steps;
}

void check_lut_size(const LutApplication& application, int size) {
    if (size <= application.largest_size) return;
    throw Error(
        {.parameter = "size",
         .value = fmt::to_string(size),
         .expected = fmt::format("at most {} for {}", application.largest_size, application.id)});
}

bool is_table_for(const LutApplication& application, const View& view) {
    return application.takes_any_primaries && is_per_channel(build_view(view));
}

bool has_usual_input(const LutApplication& application, const LutRequest& request) {
    const InputEncoding& encoding = request.encoding;
    if (encoding.is_linear && reads_chains(application, request.format))
        return request.view.input == encoding.default_input;
    return encoding.id == parse_input_encoding(application.encoding).id &&
           request.view.input == lut_input_of(application, *request.view.op.op);
}

bool takes_any_display(const LutApplication& application) {
    // After a log of scene light, applications show or write the output of the LUT as it is.
    for (const std::string_view log : {"davinci", "acescct", "logc3"}) {
        if (application.encoding == log) return true;
    }
    return false;
}

std::string lut_input_of(const LutApplication& application, const Operator& op) {
    if (!application.takes_any_primaries)
        return parse_input_encoding(application.encoding).default_input;
    // In Rec.709, an operator of Rec.709 clips on the sides of the grid. The others take Rec.2020,
    // which holds the colors of displays and nearly all of cameras: cells of AP1 and AP0 are wider
    // (docs/luts.md has the errors).
    return op.working == kRec709 ? "lin_rec709" : "lin_rec2020";
}

TONEWRIGHT_NAMESPACE_END
