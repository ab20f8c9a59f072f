// SPDX-License-Identifier: Apache-2.0
#include "picture/compression.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <map>
#include <vector>

#include "base/strings.h"
#include "picture/color_tags.h"
#include "tonewright/error.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

/// Compressions of the formats that have several, or a quality, by OpenImageIO's names. Its writers
/// silently replace an unknown name by the default.
struct FormatCompressions {
    std::string_view format;
    std::vector<std::string> names;
    std::vector<std::string> with_quality;
};
const FormatCompressions* compressions_of(std::string_view format) {
    static const std::vector<FormatCompressions> all = {
        {"openexr",
         {"none", "rle", "zip", "zips", "piz", "pxr24", "b44", "b44a", "dwaa", "dwab"},
         {"dwaa", "dwab"}},
        {"tiff", {"none", "lzw", "zip", "packbits", "jpeg"}, {"jpeg"}},
        {"jpeg", {"jpeg"}, {"jpeg"}},
        {"webp", {"webp", "lossless"}, {"webp"}},
        {"heif", {"heic", "none"}, {"heic"}},
        {"avif", {"avif"}, {"avif"}},
        {"png", {"default", "filtered", "huffman", "rle", "fixed"}, {}},
        {"targa", {"none", "rle"}, {}},
        {"iff", {"none", "rle"}, {}},
    };
    const auto found =
        std::find_if(all.begin(), all.end(), [&](const auto& row) { return row.format == format; });
    return found == all.end() ? nullptr : &*found;
}

std::string_view format_of(std::string_view codec) { return codec == "avif" ? "heif" : codec; }

void check_name_and_quality(const std::string& path, std::string_view codec,
                            const CompressionOptions& options) {
    const std::string& text = options.compression;
    const int quality = options.quality;
    const std::string_view format = format_of(codec);
    const FormatCompressions* known = compressions_of(codec);
    const std::size_t colon = std::min(text.find(':'), text.size());
    const std::string name = text.substr(0, colon);
    if (!name.empty()) {
        if (!known) {
            throw Error(
                fmt::format("{}: compression is {}; expected none, because {} has one method only",
                            path, text, format));
        }
        if (std::find(known->names.begin(), known->names.end(), name) == known->names.end()) {
            throw Error(fmt::format("{}: compression is {}; expected {}{}", path, text,
                                    join_choices(known->names), did_you_mean(name, known->names)));
        }
    }
    const bool has_number = colon < text.size();
    if (has_number) {
        const std::string_view digits = std::string_view(text).substr(colon + 1);
        int number = 0;
        const auto [end, error] =
            std::from_chars(digits.data(), digits.data() + digits.size(), number);
        if (error != std::errc() || end != digits.data() + digits.size() || number < 1)
            throw Error(
                fmt::format("{}: compression is {}; expected a quality of 1 or more after "
                            "the colon",
                            path, text));
    }
    if (quality == 0 && !has_number) return;
    if (quality != 0 && (quality < 1 || quality > 100))
        throw Error(fmt::format("{}: quality is {}; expected [1, 100]", path, quality));
    const std::vector<std::string> none;
    const std::vector<std::string>& with = known ? known->with_quality : none;
    const bool is_default =
        name.empty() && (format == "jpeg" || format == "webp" || format == "heif");
    if (is_default || std::find(with.begin(), with.end(), name) != with.end()) return;
    throw Error({.what = path,
                 .parameter = "quality",
                 .value = has_number ? text.substr(colon + 1) : fmt::to_string(quality),
                 .expected = with.empty()
                                 ? fmt::format("none, because {} is lossless", format)
                                 : fmt::format("<<compression={}>> with it", join_choices(with))});
}

void check_subsampling(const std::string& path, std::string_view format, const std::string& text) {
    if (text.empty()) return;
    if (format != "jpeg") {
        throw Error(fmt::format("{}: subsampling is {}; expected none, because {}", path, text,
                                format == "webp" || format == "heif"
                                    ? fmt::format("the writer of {} has one kind only (4:2:0)",
                                                  format == "webp" ? "WebP" : "HEIF and AVIF")
                                    : fmt::format("only JPEG has it, and not {}", format)));
    }
    const std::vector<std::string> names = {"4:4:4", "4:2:2", "4:2:0", "4:1:1"};
    if (std::find(names.begin(), names.end(), text) != names.end()) return;
    throw Error(fmt::format("{}: subsampling is {}; expected {}{}", path, text, join_choices(names),
                            did_you_mean(text, names)));
}

}  // namespace

void check_compression(const std::string& path, std::string_view codec,
                       const CompressionOptions& options) {
    check_name_and_quality(path, codec, options);
    check_subsampling(path, format_of(codec), options.subsampling);
}

void set_compression(PictureSpec& spec, std::string_view codec, const CompressionOptions& options) {
    // The source's compression may be one of another format, or have a quality of its own.
    const FormatCompressions* known = compressions_of(codec);
    const std::string name = spec.get_string_attribute("compression");
    const bool is_known = known && std::find(known->names.begin(), known->names.end(),
                                             name.substr(0, name.find(':'))) != known->names.end();
    if (!is_known || options.quality > 0) erase_attributes(spec, "compression");
    if (!options.compression.empty()) spec.attribute("compression", options.compression);
    if (options.quality > 0) spec.attribute("CompressionQuality", options.quality);
    // OpenImageIO selects AV1 by the name of a file, but only without another compression.
    if (codec == "avif" && options.compression.empty()) {
        spec.attribute("compression",
                       options.quality > 0 ? fmt::format("avif:{}", options.quality) : "avif");
    }
    if (codec != "jpeg") return;
    // Half the resolution of chroma shows most where a thin line is saturated: pure red on black
    // becomes half as bright. ImageMagick and libvips use the same limit.
    constexpr int kFullChromaQuality = 90;
    constexpr int kDefaultQuality = 98;  // of OpenImageIO's writer
    const int quality = quality_of(spec, kDefaultQuality);
    spec.attribute("jpeg:subsampling", !options.subsampling.empty()    ? options.subsampling
                                       : quality >= kFullChromaQuality ? "4:4:4"
                                                                       : "4:2:0");
}

int quality_of(const PictureSpec& spec, int otherwise) {
    const std::string name = spec.get_string_attribute("compression");
    const std::size_t colon = name.find(':');
    if (colon == std::string::npos) return spec.get_int_attribute("CompressionQuality", otherwise);
    int quality = 0;
    std::from_chars(name.data() + colon + 1, name.data() + name.size(), quality);
    return quality;
}

int rows_of_block(std::string_view compression) {
    static const std::map<std::string_view, int> rows = {
        {"none", 1}, {"rle", 1},  {"zips", 1},  {"zip", 16},  {"pxr24", 16},
        {"piz", 32}, {"b44", 32}, {"b44a", 32}, {"dwaa", 32}, {"dwab", 256}};
    const auto found = rows.find(compression.substr(0, compression.find(':')));
    return found == rows.end() ? 0 : found->second;
}

TONEWRIGHT_NAMESPACE_END
