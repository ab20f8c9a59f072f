// SPDX-License-Identifier: Apache-2.0
#include <OpenImageIO/filesystem.h>
#include <OpenImageIO/imagecache.h>
#include <OpenImageIO/imageio.h>

#include <cstddef>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "base/strings.h"
#include "image/openimageio_writers.h"
#include "image/picture_file.h"
#include "image/spec_conversion.h"
#include "image/tonemap_file.h"

TONEWRIGHT_NAMESPACE_BEGIN

PictureWriter::PictureWriter(const std::string& path, WriteOptions options, int nthreads)
    : path_(path),
      writer_(path, std::move(options), static_cast<unsigned>(thread_count(nthreads)),
              all_writers()) {}

OIIO::ImageSpec PictureWriter::file_spec(const OIIO::ImageSpec& picture) {
    OIIO::ImageSpec spec = image_spec(writer_.planned(picture_spec(picture)));
    const auto out = OIIO::ImageOutput::create(writer_.format());
    if (out->supports("ioproxy") == 0) {
        spec.format = OIIO::TypeUnknown;
        return spec;
    }
    // Formats lack some types. One pixel in memory shows the replacement.
    std::vector<unsigned char> memory;
    OIIO::Filesystem::IOVecOutput proxy(memory);
    const OIIO::ImageSpec pixel(1, 1, spec.nchannels, spec.format);
    const std::vector<float> black(static_cast<std::size_t>(spec.nchannels));
    out->set_ioproxy(&proxy);
    if (!out->open(path_, pixel)) writer_.fail(problem_of_library(out->geterror()));
    spec.format = out->spec().format;
    out->write_scanline(0, 0, OIIO::TypeFloat, black.data());
    out->close();
    return spec;
}

void PictureWriter::open(const OIIO::ImageSpec& picture) { writer_.open(picture_spec(picture)); }

void PictureWriter::write_rows(const OIIO::ImageBuf& rows) {
    const OIIO::ImageSpec& spec = rows.spec();
    RowFitter::Rows fitted = {rows.ybegin(), rows.yend(), spec.format,
                              static_cast<const std::byte*>(rows.localpixels())};
    std::vector<std::byte> packed;
    const auto pixel = static_cast<OIIO::stride_t>(spec.pixel_bytes());
    if (!fitted.pixels || rows.pixel_stride() != pixel ||
        rows.scanline_stride() != pixel * spec.width) {
        packed.resize(spec.image_bytes());
        if (!rows.get_pixels(rows.roi(), spec.format, packed.data()))
            writer_.fail(problem_of_library(rows.geterror()));
        fitted.pixels = packed.data();
    }
    writer_.write_rows(fitted);
}

void PictureWriter::finish() {
    writer_.finish();
    forget_cached();
}

void PictureWriter::forget_cached() const {
    auto cache = OIIO::ImageCache::create(true);  // a pointer, or since 3.0 a shared one
    if (!cache) return;                           // no memory for a first one
    cache->invalidate(OIIO::ustring(path_));
    OIIO::ImageCache::destroy(cache);
}

TONEWRIGHT_NAMESPACE_END
