// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <string_view>
#include <utility>

#include "base/atomic_file.h"
#include "base/strings.h"
#include "image/picture_file.h"
#include "tonewright/image_io.h"

TONEWRIGHT_NAMESPACE_BEGIN

OIIO::ImageBuf read_image(const std::string& path, const ReadOptions& options) {
    return with_memory_for(path, [&] { return PictureReader(path, 0, options).read_all(); });
}

OIIO::ImageBuf read_image(const std::string& path, double max_pixels) {
    return read_image(path, {.max_pixels = max_pixels});
}

void write_image_atomically(const OIIO::ImageBuf& image, const std::string& path,
                            const WriteOptions& options) {
    const auto refuse = [&](const std::string& reason) {
        throw FileError(fmt::format("{}: cannot write: {}", path, reason));
    };
    if (image.deep()) refuse("the picture is deep; expected flat pixels");
    if (!image.initialized())
        refuse(image.has_error() ? first_line(image.geterror()) : "there is no picture");
    with_memory_for(path, [&] {
        remove_leftovers({path});
        PictureWriter writer(path, options);
        writer.open(image.spec());
        writer.write_rows(image);
        writer.finish();
    });
}

void write_image_atomically(const OIIO::ImageBuf& image, const std::string& path,
                            const OIIO::TypeDesc& type) {
    WriteOptions options;
    options.type = type;
    write_image_atomically(image, path, options);
}

OIIO::TypeDesc parse_pixel_type(std::string_view text) {
    static const std::vector<std::pair<std::string, OIIO::TypeDesc>> types = {
        {"uint8", OIIO::TypeDesc::UINT8},
        {"uint16", OIIO::TypeDesc::UINT16},
        {"half", OIIO::TypeDesc::HALF},
        {"float", OIIO::TypeDesc::FLOAT}};
    std::vector<std::string> names;
    names.reserve(types.size());
    for (const auto& type : types)
        names.push_back(type.first);
    return types[find_choice("pixel type", text, names)].second;
}

TONEWRIGHT_NAMESPACE_END
