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

FormatColor linear_format(std::string_view format, std::string_view title,
                          std::vector<std::string_view> extensions) {
    return {.format = format,
            .title = title,
            .extensions = std::move(extensions),
            .meaning = FormatMeaning::linear,
            .integer_space = kLinear,
            .float_space = kLinear};
}

/// Float files rarely hold code values.
FormatColor code_format(std::string_view format, std::string_view title,
                        std::vector<std::string_view> extensions) {
    return {.format = format,
            .title = title,
            .extensions = std::move(extensions),
            .meaning = FormatMeaning::code_values,
            .integer_space = kTexture,
            .float_space = kLinear};
}

/// Files of film scanners and log recorders; other DPX files state their space in the name or in
/// the header.
FormatColor film_format(std::string_view format, std::string_view title,
                        std::vector<std::string_view> extensions) {
    return {.format = format,
            .title = title,
            .extensions = std::move(extensions),
            .meaning = FormatMeaning::film,
            .integer_space = kFilm,
            .float_space = kLinear};
}

FormatColor video_format(std::vector<std::string_view> extensions) {
    return {.format = "FFmpeg movie",
            .title = "video",
            .extensions = std::move(extensions),
            .meaning = FormatMeaning::video,
            .integer_space = kVideo,
            .float_space = kVideo};
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
    static const std::vector<FormatColor> formats = {
        with_rule(stating_color(linear_format("openexr", "OpenEXR", {"exr"}))),
        with_rule(linear_format("hdr", "Radiance HDR", {"hdr"})),
        // OpenImageIO's format of PFM is PNM.
        with_rule(linear_format("pnm", "PFM", {"pfm"})),
        with_rule(with_icc(with_power(code_format("png", "PNG", {"png"})))),
        with_rule(with_icc(code_format("jpeg", "JPEG", {"jpg", "jpeg"}))),
        with_rule(with_icc(code_format("tiff", "TIFF", {"tif", "tiff"}))),
        with_rule(with_power(code_format("targa", "Targa", {"tga"}))),
        with_rule(code_format("bmp", "BMP", {"bmp"})),
        with_rule(code_format("gif", "GIF", {"gif"})),
        with_rule(code_format("webp", "WebP", {"webp"})),
        with_rule(code_format("psd", "Photoshop", {"psd"})),
        with_rule(code_format("heif", "HEIF", {"heic", "heif"})),
        with_rule(code_format("jpegxl", "JPEG XL", {"jxl"})),
        with_rule(code_format("heif", "AVIF", {"avif"})),
        with_rule(code_format("jpeg2000", "JPEG 2000", {"jp2", "j2k"})),
        with_rule(with_icc(code_format("tiff", "TIFF texture", {"tx"}))),
        with_rule(with_power(film_format("dpx", "DPX", {"dpx"}))),
        with_rule(film_format("cineon", "Cineon", {"cin"})),
        with_rule(video_format({"mov", "mp4", "mxf", "mkv", "avi"})),
        // Extensions without a file rule; the others of OpenImageIO's formats.
        stating_color(linear_format("openexr", "OpenEXR", {"sxr", "mxr"})),
        linear_format("hdr", "Radiance HDR", {"rgbe"}),
        with_rule(code_format("pnm", "PNM", {"ppm", "pgm", "pbm", "pnm"})),
        with_icc(code_format("jpeg", "JPEG", {"jpe", "jif", "jfif", "jfi"})),
        with_icc(code_format("tiff", "TIFF", {"env", "sm", "vsm"})),
        with_power(code_format("targa", "Targa", {"tpic"})),
        code_format("bmp", "BMP", {"dib"}),
        code_format("psd", "Photoshop", {"pdd", "psb"}),
        code_format("heif", "HEIF", {"heics"}),
        code_format("jpeg2000", "JPEG 2000", {"j2c"}),
        video_format({"qt", "m4v", "3gp", "3g2", "mj2", "mpg"}),
        with_rule(code_format("ico", "ICO", {"ico"})),
        with_rule(code_format("iff", "IFF", {"iff"})),
        code_format("iff", "IFF", {"z"}),
        with_rule(code_format("sgi", "SGI", {"sgi"})),
        code_format("sgi", "SGI", {"rgb", "rgba", "bw", "int", "inta"}),
        with_rule(with_power(code_format("rla", "RLA", {"rla"}))),
        code_format("dds", "DDS", {"dds"}),
        code_format("softimage", "Softimage", {"pic"}),
        linear_format("zfile", "Zfile", {"zfile"}),
        linear_format("fits", "FITS", {"fits"}),
    };
    return formats;
}

const FormatColor* find_format_color(std::string_view format, std::string_view extension) {
    const std::string wanted = lowercase(extension);
    const FormatColor* of_format = nullptr;
    for (const FormatColor& row : all_format_colors()) {
        if (!format.empty() && row.format != format) continue;
        if (std::find(row.extensions.begin(), row.extensions.end(), wanted) != row.extensions.end())
            return &row;
        if (format.empty()) continue;
        // PNM is PFM's format, too, and float samples of both are linear.
        const bool is_more_general = of_format && of_format->meaning == FormatMeaning::linear;
        if (!of_format || is_more_general) of_format = &row;
    }
    return of_format;
}

TONEWRIGHT_NAMESPACE_END
