// SPDX-License-Identifier: Apache-2.0
#include "tonewright/format_color.h"

#include <algorithm>

#include "base/strings.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

constexpr std::string_view kLinear = "lin_rec709";
constexpr std::string_view kTexture = "sRGB - Texture";
constexpr std::string_view kVideo = "Gamma 2.4 Rec.709 - Texture";
constexpr std::string_view kFilm = "Cineon";

FormatColor row(FormatMeaning meaning, std::string_view format, std::string_view title,
                std::vector<std::string_view> extensions) {
    // Space of integers. Float files rarely hold code values, and film in floats is linear.
    const std::string_view integers = meaning == FormatMeaning::linear        ? kLinear
                                      : meaning == FormatMeaning::code_values ? kTexture
                                      : meaning == FormatMeaning::film        ? kFilm
                                                                              : kVideo;
    return {.format = format,
            .title = title,
            .extensions = std::move(extensions),
            .meaning = meaning,
            .integer_space = integers,
            .float_space = meaning == FormatMeaning::video ? kVideo : kLinear};
}

FormatColor with_rule(FormatColor row) {
    row.has_file_rule = true;
    return row;
}

FormatColor with_icc(FormatColor row) {
    row.has_icc = true;
    row.states_color = true;
    return row;
}

FormatColor with_power(FormatColor row) {
    row.has_power = true;
    return row;
}

FormatColor stating_color(FormatColor row) {
    row.states_color = true;
    return row;
}

}  // namespace

const std::vector<FormatColor>& all_format_colors() {
    using enum FormatMeaning;
    static const std::vector<FormatColor> formats = {
        with_rule(stating_color(row(linear, "openexr", "OpenEXR", {"exr"}))),
        with_rule(row(linear, "hdr", "Radiance HDR", {"hdr"})),
        // OpenImageIO's format of PFM is PNM.
        with_rule(row(linear, "pnm", "PFM", {"pfm"})),
        with_rule(with_icc(with_power(row(code_values, "png", "PNG", {"png"})))),
        with_rule(with_icc(row(code_values, "jpeg", "JPEG", {"jpg", "jpeg"}))),
        with_rule(with_icc(row(code_values, "tiff", "TIFF", {"tif", "tiff"}))),
        with_rule(with_power(row(code_values, "targa", "Targa", {"tga"}))),
        with_rule(row(code_values, "bmp", "BMP", {"bmp"})),
        with_rule(row(code_values, "gif", "GIF", {"gif"})),
        with_rule(row(code_values, "webp", "WebP", {"webp"})),
        with_rule(row(code_values, "psd", "Photoshop", {"psd"})),
        with_rule(row(code_values, "heif", "HEIF", {"heic", "heif"})),
        with_rule(row(code_values, "jpegxl", "JPEG XL", {"jxl"})),
        with_rule(row(code_values, "heif", "AVIF", {"avif"})),
        with_rule(row(code_values, "jpeg2000", "JPEG 2000", {"jp2", "j2k"})),
        with_rule(with_icc(row(code_values, "tiff", "TIFF texture", {"tx"}))),
        with_rule(with_power(row(film, "dpx", "DPX", {"dpx"}))),
        with_rule(row(film, "cineon", "Cineon", {"cin"})),
        with_rule(row(video, "FFmpeg movie", "video", {"mov", "mp4", "mxf", "mkv", "avi"})),
        // Extensions without a file rule; the others of OpenImageIO's formats.
        stating_color(row(linear, "openexr", "OpenEXR", {"sxr", "mxr"})),
        row(linear, "hdr", "Radiance HDR", {"rgbe"}),
        with_rule(row(code_values, "pnm", "PNM", {"ppm", "pgm", "pbm", "pnm"})),
        with_icc(row(code_values, "jpeg", "JPEG", {"jpe", "jif", "jfif", "jfi"})),
        with_icc(row(code_values, "tiff", "TIFF", {"env", "sm", "vsm"})),
        with_power(row(code_values, "targa", "Targa", {"tpic"})),
        row(code_values, "bmp", "BMP", {"dib"}),
        row(code_values, "psd", "Photoshop", {"pdd", "psb"}),
        row(code_values, "heif", "HEIF", {"heics"}),
        row(code_values, "jpeg2000", "JPEG 2000", {"j2c"}),
        row(video, "FFmpeg movie", "video", {"qt", "m4v", "3gp", "3g2", "mj2", "mpg"}),
        with_rule(row(code_values, "ico", "ICO", {"ico"})),
        with_rule(row(code_values, "iff", "IFF", {"iff"})),
        row(code_values, "iff", "IFF", {"z"}),
        with_rule(row(code_values, "sgi", "SGI", {"sgi"})),
        row(code_values, "sgi", "SGI", {"rgb", "rgba", "bw", "int", "inta"}),
        with_rule(with_power(row(code_values, "rla", "RLA", {"rla"}))),
        row(code_values, "dds", "DDS", {"dds"}),
        row(code_values, "softimage", "Softimage", {"pic"}),
        row(linear, "zfile", "Zfile", {"zfile"}),
        row(linear, "fits", "FITS", {"fits"}),
    };
    return formats;
}

const FormatColor* find_format_color(std::string_view format, std::string_view extension) {
    const std::string requested = lowercase(extension);
    const FormatColor* of_format = nullptr;
    for (const FormatColor& row : all_format_colors()) {
        if (!format.empty() && row.format != format) continue;
        if (std::find(row.extensions.begin(), row.extensions.end(), requested) !=
            row.extensions.end())
            return &row;
        if (format.empty()) continue;
        // PNM is PFM's format, too, and float samples of both are linear.
        const bool is_more_general = of_format && of_format->meaning == FormatMeaning::linear;
        if (!of_format || is_more_general) of_format = &row;
    }
    return of_format;
}

TONEWRIGHT_NAMESPACE_END
