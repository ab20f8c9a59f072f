// SPDX-License-Identifier: Apache-2.0
#include "image/source_picture.h"

#include <OpenImageIO/imagebufalgo.h>
#include <fmt/format.h>

#include <algorithm>
#include <new>
#include <string>

#include "base/strings.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

/// With the name of its file.
std::string error_of(const OIIO::ImageBuf& picture) {
    const std::string text = first_line(picture.geterror());
    const std::string name(picture.name());
    return text.find(name) == std::string::npos ? name + ": " + text : text;
}

}  // namespace

void check_source(const OIIO::ImageBuf& source) {
    const OIIO::ImageSpec& spec = source.spec();  // opens the file
    if (!source.initialized()) {
        throw Error(source.has_error() ? error_of(source)
                                       : "source is not initialized; expected a picture");
    }
    // OpenImageIO 3 reads the whole file here. Earlier errors are no news of it.
    const bool had_error = source.has_error();
    (void)source.localpixels();
    if (!had_error && source.has_error()) throw Error(error_of(source));
    if (source.deep()) {
        throw Error("source is deep; expected flat pixels (oiiotool --flatten)");
    }
    check_pixel_type("source", spec.format);
}

void check_was_read(const OIIO::ImageBuf& source, bool is_complete) {
    if (is_complete && (source.localpixels() || !source.has_error())) return;
    throw Error(source.has_error() ? error_of(source) : "source cannot be read");
}

OIIO::ImageBuf black_picture(const OIIO::ImageSpec& spec) {
    OIIO::ImageBuf picture(spec, OIIO::InitializePixels::No);
    if (!picture.localpixels()) {
        (void)picture.geterror();  // which would be printed otherwise
        throw std::bad_alloc();
    }
    OIIO::ImageBufAlgo::zero(picture);
    return picture;
}

TONEWRIGHT_NAMESPACE_END
