// SPDX-License-Identifier: Apache-2.0
#include "image/openimageio_writers.h"

#include <OpenImageIO/imagebuf.h>
#include <OpenImageIO/imageio.h>
#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "base/atomic_file.h"
#include "base/strings.h"
#include "base/system_files.h"
#include "image/output_file.h"
#include "image/spec_conversion.h"
#include "image/written_picture.h"
#include "picture/compression.h"
#include "picture/png_chunks.h"
#include "tonewright/error.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

/// One of OpenImageIO's writers.
class OutputRows final : public RowWriter {
  public:
    OutputRows(std::unique_ptr<OIIO::ImageOutput> out, const PictureSpec& spec, const NewFile& to)
        : out_(std::move(out)) {
        out_->threads(static_cast<int>(to.threads));
        std::string name = to.path;
        // libtiff reads its own directories again if there is an EXIF directory (as in a picture
        // tagged sRGB), and a proxy for writing cannot be read: the file would lack its first
        // directory.
        if (out_->supports("ioproxy") && format() != "tiff") {
            proxy_ = std::make_unique<OutputFile>(to.file.release(), name);
            check_disk();
            if (!to.chunks.empty()) proxy_->insert(kAfterPngHeader, std::string(to.chunks));
            out_->set_ioproxy(proxy_.get());
            name = to.target;
        } else {
            (void)to.file.close();
        }
        const bool is_open = [&] {
            const FileCreation creation;  // the writer may open the file by its name
            return out_->open(name, image_spec(spec));
        }();
        if (!is_open) fail(problem_of_library(out_->geterror()));
        spec_ = picture_spec(out_->spec());
        if (proxy_ && format() == "openexr") {
            rows_of_block_ = rows_of_block(spec_.get_string_attribute("compression", "zip"));
            proxy_->begin_blocks();
        }
        is_bottom_up_ = format() == "openexr" &&
                        spec_.get_string_attribute("openexr:lineOrder") == "decreasingY";
    }

    [[nodiscard]] const PictureSpec& spec() const override { return spec_; }
    [[nodiscard]] bool is_opened_by_name() const override { return !proxy_; }
    void write_rows(int row_count, OIIO::TypeDesc type, const std::byte* rows) override {
        const bool is_whole = row_count == spec_.height;
        const int ybegin = is_bottom_up_ ? spec_.y + spec_.height - rows_written_ - row_count
                                         : spec_.y + rows_written_;
        const bool is_written = is_whole ? write_whole(type, rows)
                                         : write_scanlines(ybegin, ybegin + row_count, type, rows);
        check_disk();
        if (!is_written) fail(problem_of_library(out_->geterror()));
        rows_written_ += row_count;
        check_blocks();
    }
    void finish() override {
        if (!out_->close()) fail(problem_of_library(out_->geterror()));
        out_.reset();  // some write their last bytes only now
        if (const int error = proxy_ ? proxy_->finish() : 0) fail(problem_of_system(error));
    }

  private:
    [[noreturn]] static void fail(Problem why) { throw FileError(std::move(why)); }
    [[nodiscard]] std::string_view format() const { return out_->format_name(); }
    void check_disk() const {
        if (proxy_ && proxy_->error_number()) fail(problem_of_system(proxy_->error_number()));
    }
    bool write_whole(const OIIO::TypeDesc& type, const std::byte* rows) {
        if (format() == "heif") return write_scanlines(spec_.y, spec_.y + spec_.height, type, rows);
        OIIO::ImageSpec all = out_->spec();
        all.set_format(type);
        // The buffer is read only.
        OIIO::ImageBuf picture(all, const_cast<std::byte*>(rows));
        if (picture.write(out_.get())) return true;
        if (picture.has_error()) fail(problem_of_library(picture.geterror()));
        return false;
    }
    bool write_scanlines(int ybegin, int yend, const OIIO::TypeDesc& type, const std::byte* rows) {
        if (format() != "heif") return out_->write_scanlines(ybegin, yend, spec_.z, type, rows);
        // OpenImageIO 2.4 copies rows as long as libheif's, which have padding: the last one needs
        // something behind it.
        constexpr std::size_t kPadding = 1024;
        const std::size_t values = static_cast<std::size_t>(yend - ybegin) *
                                   static_cast<std::size_t>(spec_.width) *
                                   static_cast<std::size_t>(spec_.nchannels);
        std::vector<std::byte> pixels(values * spec_.format.size() + kPadding);
        return OIIO::convert_pixel_values(type, rows, spec_.format, pixels.data(),
                                          static_cast<int>(values)) &&
               out_->write_scanlines(ybegin, yend, spec_.z, spec_.format, pixels.data());
    }
    /// OpenEXR 3.1 forgets that it could not compress a block of rows, such as without memory: it
    /// writes no more of this call, and takes later rows from before the given ones.
    void check_blocks() const {
        if (rows_of_block_ == 0) return;
        const int height = spec_.height;
        const int first = is_bottom_up_ ? (height - 1) % rows_of_block_ + 1 : rows_of_block_;
        int complete = rows_written_ < first ? 0 : 1 + (rows_written_ - first) / rows_of_block_;
        if (rows_written_ == height) complete = (height - 1) / rows_of_block_ + 1;
        if (proxy_->blocks() < complete)
            fail({.kind = Problem::Kind::file,
                  .value = "OpenEXR could not compress all rows (not enough memory?)"});
    }

    PictureSpec spec_;
    bool is_bottom_up_ = false;
    int rows_written_ = 0;
    int rows_of_block_ = 0;  // of an OpenEXR file, else 0
    // The order matters: at its end, the writer writes to the file.
    std::unique_ptr<OutputFile> proxy_;  // of writers that do not open files themselves
    std::unique_ptr<OIIO::ImageOutput> out_;
};

std::string format_of(const std::string& path) {
    const std::unique_ptr<OIIO::ImageOutput> out = OIIO::ImageOutput::create(path);
    if (out) return out->format_name();
    throw FileError(std::filesystem::path(path).has_extension()
                        ? first_line(OIIO::geterror())
                        : "the name has no extension that selects a format");
}

std::unique_ptr<RowWriter> create(const std::string& format, const PictureSpec& spec,
                                  const NewFile& to) {
    if (std::unique_ptr<RowWriter> own = own_writers().create(format, spec, to)) return own;
    std::unique_ptr<OIIO::ImageOutput> out = OIIO::ImageOutput::create(format);
    if (!out) throw FileError(first_line(OIIO::geterror()));
    return std::make_unique<OutputRows>(std::move(out), spec, to);
}

}  // namespace

const FormatWriters& all_writers() {
    static const FormatWriters writers = {format_of, create, fault_of};
    return writers;
}

TONEWRIGHT_NAMESPACE_END
