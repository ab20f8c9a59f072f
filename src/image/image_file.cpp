// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <string_view>
#include <utility>

#include "base/strings.h"
#include "image/picture_file.h"
#include "tonewright/image_io.h"

TONEWRIGHT_NAMESPACE_BEGIN

OIIO::ImageBuf read_image(const std::string& path) { return PictureReader(path).read_all(); }

void write_image_atomically(const OIIO::ImageBuf& image, const std::string& path,
                            const OIIO::TypeDesc& type) {
    const auto refuse = [&](const std::string& reason) {
        throw FileError(fmt::format("{}: cannot write: {}", path, reason));
    };
    if (image.deep()) refuse("the picture is deep; expected flat pixels");
    if (!image.initialized())
        refuse(image.has_error() ? first_line(image.geterror()) : "there is no picture");
    PictureWriter writer(path, type);
    writer.open(image.spec());
    writer.write_rows(image);
    writer.finish();
}

OIIO::TypeDesc parse_pixel_type(std::string_view text) {
    static const std::vector<std::pair<std::string, OIIO::TypeDesc>> types = {
        {"uint8", OIIO::TypeDesc::UINT8},
        {"uint16", OIIO::TypeDesc::UINT16},
        {"half", OIIO::TypeDesc::HALF},
        {"float", OIIO::TypeDesc::FLOAT}};
    std::vector<std::string> names;
    for (const auto& [name, type] : types) {
        if (name == text) return type;
        names.push_back(name);
    }
    throw Error(fmt::format("pixel type is {}; expected {}{}", text, join_choices(names),
                            did_you_mean(text, names)));
}

TONEWRIGHT_NAMESPACE_END
