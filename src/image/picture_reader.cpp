// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <filesystem>
#include <system_error>

#include "base/strings.h"
#include "image/picture_file.h"
#include "tonewright/image_io.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

using OIIO::ImageBuf;

[[noreturn]] void cannot_read(const std::string& path, const std::string& reason) {
    throw FileError(fmt::format("{}: cannot read: {}", path, reason));
}

}  // namespace

std::string why_not_open(const std::string& path, const std::string& reported) {
    namespace fs = std::filesystem;
    std::error_code error;
    const fs::file_status status = fs::status(path, error);
    if (!fs::exists(status)) return std::generic_category().message(ENOENT);
    if (fs::is_directory(status)) return "it is a directory";
    if (::access(path.c_str(), R_OK) != 0) return std::generic_category().message(errno);
    if (fs::is_regular_file(status) && fs::file_size(path, error) == 0) return "the file is empty";
    return first_line(reported);
}

PictureReader::PictureReader(const std::string& path, int nthreads, int subimage)
    : path_(path), subimage_(subimage), in_(OIIO::ImageInput::open(path)) {
    // Not through ImageBuf: it asks the shared cache, which may know an older file of this name,
    // and it passes over errors that a reader reports while it delivers pixels.
    if (!in_) cannot_read(path, why_not_open(path, OIIO::geterror()));
    in_->threads(nthreads);
    if (!in_->seek_subimage(subimage, 0))
        cannot_read(path, fmt::format("it has no subimage {}; the first is 0", subimage));
    spec_ = in_->spec();
    if (spec_.deep)
        cannot_read(path, "the picture is deep; expected flat pixels (oiiotool --flatten)");
    spec_.channelformats.clear();  // all channels are read in the widest of them
}

PictureReader::~PictureReader() = default;

int PictureReader::row_step() const { return std::max(spec_.tile_height, 1); }

void PictureReader::check(bool was_read) const {
    if (was_read && !in_->has_error()) return;
    const std::string reported = in_->geterror();
    // Readers of DPX and PNM say nothing about a file that ends too early.
    cannot_read(path_,
                reported.empty() ? "the file is truncated or damaged" : first_line(reported));
}

void PictureReader::read_rows(int ybegin, int yend, std::byte* to) {
    const OIIO::ImageSpec& s = spec_;
    check(s.tile_width > 0
              ? in_->read_tiles(subimage_, 0, s.x, s.x + s.width, ybegin, yend, s.z, s.z + 1, 0,
                                s.nchannels, s.format, to)
              : in_->read_scanlines(subimage_, 0, ybegin, yend, s.z, 0, s.nchannels, s.format, to));
}

ImageBuf PictureReader::read_all() {
    ImageBuf image(spec_, OIIO::InitializePixels::No);
    if (!image.localpixels()) {
        cannot_read(path_, fmt::format("no memory for {} x {} pixels", spec_.width, spec_.height));
    }
    check(in_->read_image(subimage_, 0, 0, spec_.nchannels, image.spec().format,
                          image.localpixels()));
    return image;
}

int rows_of_batch(std::size_t bytes_per_row, int step, std::size_t batch_bytes) {
    constexpr int kLeast = 64;
    const auto rows = static_cast<int>(batch_bytes / std::max<std::size_t>(bytes_per_row, 1));
    const int unit = (kLeast + step - 1) / step * step;
    return std::max(rows / unit, 1) * unit;
}

OIIO::ImageSpec spec_of_rows(const OIIO::ImageSpec& picture, int ybegin, int yend) {
    OIIO::ImageSpec spec = picture;
    spec.y = ybegin;
    spec.height = yend - ybegin;
    spec.tile_width = spec.tile_height = spec.tile_depth = 0;
    return spec;
}

void check_is_complete(PictureReader& reader) {
    const OIIO::ImageSpec& spec = reader.spec();
    if (spec.depth > 1) {
        (void)reader.read_all();
        return;
    }
    const int step = rows_of_batch(spec.scanline_bytes(), reader.row_step());
    const int yend = spec.y + spec.height;
    std::vector<std::byte> rows(spec.scanline_bytes() * static_cast<std::size_t>(step));
    for (int y = spec.y; y < yend; y += step)
        reader.read_rows(y, std::min(y + step, yend), rows.data());
}

TONEWRIGHT_NAMESPACE_END
