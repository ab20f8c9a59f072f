// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <cstddef>
#include <string>

#include "base/atomic_file.h"
#include "base/strings.h"
#include "image/picture_file.h"
#include "image/source_picture.h"
#include "image/spec_conversion.h"
#include "tonewright/image_io.h"

TONEWRIGHT_NAMESPACE_BEGIN

OIIO::ImageBuf read_image(const std::string& path, const ReadOptions& options) {
    return with_memory_for(path, [&] { return PictureReader(path, 0, options).read_all(); });
}

OIIO::ImageBuf read_image(const std::string& path, double max_pixels) {
    return read_image(path, {.max_pixels = max_pixels});
}

void write_result_atomically(const OIIO::ImageBuf& image, const std::string& path,
                             const WriteOptions& options, const OIIO::TypeDesc& source) {
    const auto refuse = [&](const std::string& reason) {
        throw FileError(fmt::format("{}: cannot write: {}", path, reason));
    };
    if (image.deep()) refuse("the picture is deep; expected flat pixels");
    if (!image.initialized())
        refuse(image.has_error() ? first_line(image.geterror()) : "there is no picture");
    with_memory_for(path, [&] {
        remove_leftovers({path});
        PictureWriter writer(path, options);
        writer.keep_type(source);
        writer.open(image.spec());
        writer.write_rows(image);
        writer.finish();
    });
}

void write_image_atomically(const OIIO::ImageBuf& image, const std::string& path,
                            const WriteOptions& options) {
    write_result_atomically(image, path, options, OIIO::TypeUnknown);
}

void write_image_atomically(const OIIO::ImageBuf& image, const std::string& path,
                            const OIIO::TypeDesc& type) {
    WriteOptions options;
    options.type = type;
    write_image_atomically(image, path, options);
}

OIIO::ImageBuf with_associated_alpha(const OIIO::ImageBuf& image) {
    const int alpha = image.spec().alpha_channel;
    if (alpha < 0 || image.spec().get_int_attribute("oiio:UnassociatedAlpha", 0) == 0) return image;
    OIIO::ImageBuf result = image.copy(OIIO::TypeFloat);
    multiply_by_alpha(static_cast<float*>(result.localpixels()), result.spec().image_pixels(),
                      static_cast<std::size_t>(result.nchannels()), alpha);
    erase_attribute(result.specmod(), "oiio:UnassociatedAlpha");
    return result;
}

TONEWRIGHT_NAMESPACE_END
