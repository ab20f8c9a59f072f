// SPDX-License-Identifier: Apache-2.0
#include <OpenImageIO/filesystem.h>
#include <OpenImageIO/imagebufalgo.h>
#include <OpenImageIO/imagecache.h>
#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <numeric>
#include <optional>
#include <string>
#include <string_view>
#include <utility>

#include "base/atomic_file.h"
#include "base/strings.h"
#include "image/picture_file.h"
#include "tonewright/error.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

namespace fs = std::filesystem;
using OIIO::ImageBuf;
using OIIO::ImageSpec;
using OIIO::ROI;

/// The channels that a format takes: all (empty), or color and alpha, or color.
std::vector<int> channels_to_write(const ImageSpec& spec, const OIIO::ImageOutput& out) {
    const bool takes_alpha = out.supports("alpha") != 0;
    if (out.supports("nchannels") != 0 && takes_alpha) return {};
    const int color_count = spec.nchannels < 3 ? 1 : 3;
    std::vector<int> channels(static_cast<std::size_t>(color_count));
    std::iota(channels.begin(), channels.end(), 0);
    if (takes_alpha && spec.alpha_channel >= color_count) channels.push_back(spec.alpha_channel);
    if (static_cast<int>(channels.size()) == spec.nchannels) return {};
    return channels;
}

}  // namespace

/// What OIIO's writers write to. They do not look whether their last bytes reached the disk (PNG at
/// none), and libjpeg ends the process when one did not. So this takes everything, and remembers.
class PictureWriter::FileProxy final : public OIIO::Filesystem::IOProxy {
  public:
    explicit FileProxy(const fs::path& path) : IOProxy(path.string(), Write) {
        const int file =
            ::open(path.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_NOFOLLOW | O_CLOEXEC, 0666);
        if (file >= 0) file_ = ::fdopen(file, "wb");
        if (!file_) {
            errno_ = errno;
            return;
        }
        std::setvbuf(file_, nullptr, _IOFBF, std::size_t{1} << 20);  // some write byte by byte
    }
    ~FileProxy() override {
        if (file_) std::fclose(file_);
    }
    FileProxy(const FileProxy&) = delete;
    FileProxy& operator=(const FileProxy&) = delete;

    [[nodiscard]] const char* proxytype() const override { return "tonewright"; }
    bool seek(int64_t offset) override {
        if (offset == m_pos) return true;
        if (!errno_ && ::fseeko(file_, offset, SEEK_SET) != 0) errno_ = errno;
        m_pos = offset;
        return true;
    }
    std::size_t write(const void* bytes, std::size_t size) override {
        if (!errno_ && std::fwrite(bytes, 1, size, file_) != size) errno_ = errno ? errno : EIO;
        m_pos += static_cast<int64_t>(size);
        size_ = std::max(size_, m_pos);
        return size;
    }
    std::size_t pwrite(const void* bytes, std::size_t size, int64_t offset) override {
        const int64_t here = m_pos;
        seek(offset);
        write(bytes, size);
        seek(here);
        return size;
    }
    [[nodiscard]] std::size_t size() const override { return static_cast<std::size_t>(size_); }

    /// What went wrong so far: an errno, or 0.
    [[nodiscard]] int error_number() const { return errno_; }
    /// Hands everything to the system. @returns  0 or an errno.
    [[nodiscard]] int finish() {
        if (!file_) return errno_;
        if (std::fclose(std::exchange(file_, nullptr)) != 0 && !errno_) errno_ = errno;
        return errno_;
    }

  private:
    std::FILE* file_ = nullptr;
    int errno_ = 0;
    int64_t size_ = 0;
};

// ---------------------------------------------------------------------------------------------

PictureWriter::PictureWriter(const std::string& path, const OIIO::TypeDesc& type, int nthreads)
    : path_(path), type_(type) {
    temporary_ = std::make_unique<AtomicFile>(path);
    if (!temporary_->refusal().empty()) fail(temporary_->refusal());
    const fs::path& target = temporary_->target();
    out_ = OIIO::ImageOutput::create(target.string());
    if (!out_) {
        fail(target.has_extension() ? first_line(OIIO::geterror())
                                    : "the name has no extension that selects a format");
    }
    out_->threads(nthreads);
}

PictureWriter::~PictureWriter() = default;

void PictureWriter::fail(const std::string& reason) const {
    throw FileError(fmt::format("{}: cannot write: {}", path_, reason));
}

void PictureWriter::check_disk() const {
    if (proxy_ && proxy_->error_number()) fail(reason_of(proxy_->error_number()));
}

ImageBuf PictureWriter::checked(ImageBuf&& changed) const {
    if (changed.has_error()) fail(first_line(changed.geterror()));
    return std::move(changed);
}

ImageSpec PictureWriter::plan(const ImageSpec& picture) {
    ImageSpec spec = picture;
    spec.tile_width = spec.tile_height = spec.tile_depth = 0;  // those of the file it came from
    spec.channelformats.clear();
    // One level alone is no texture: OpenEXR's writer would wait for the others.
    if (spec.get_string_attribute("textureformat") == "Plain Texture")
        spec.erase_attribute("textureformat");
    channels_ = channels_to_write(spec, *out_);
    if (!channels_.empty()) {
        // One pixel shows what becomes of names and places of channels.
        ImageSpec pixel = spec;
        pixel.width = pixel.height = pixel.depth = 1;
        const ImageBuf kept = checked(OIIO::ImageBufAlgo::channels(
            ImageBuf(pixel), static_cast<int>(channels_.size()), channels_));
        pixel = kept.spec();
        pixel.width = spec.width;
        pixel.height = spec.height;
        pixel.depth = spec.depth;
        spec = std::move(pixel);
    }

    // What a viewer shows of a picture is its display window. Formats that have none hold just
    // that.
    const ROI window = picture.roi_full();
    const ROI data = picture.roi();
    last_row_ = data.yend;
    next_row_ = data.ybegin;
    const bool same = window.xbegin == data.xbegin && window.xend == data.xend &&
                      window.ybegin == data.ybegin && window.yend == data.yend;
    if (!same && !out_->supports("displaywindow")) {
        window_ = window;
        window_->chbegin = 0;
        window_->chend = spec.nchannels;
        next_row_ = window.ybegin;
        spec.x = spec.y = spec.z = spec.full_x = spec.full_y = spec.full_z = 0;
        spec.width = spec.full_width = window.width();
        spec.height = spec.full_height = window.height();
        spec.depth = spec.full_depth = window.depth();
    }

    // PNG wants color that is not multiplied by alpha. OIIO's writer divides integers, rounding
    // down, and for "Gamma2.2" and its like it divides by a power of alpha: 0.25 of 0.5 becomes 1.
    divides_by_alpha_ = std::string_view(out_->format_name()) == "png" && spec.alpha_channel >= 0 &&
                        spec.get_int_attribute("oiio:UnassociatedAlpha", 0) == 0;
    if (divides_by_alpha_) spec.attribute("oiio:UnassociatedAlpha", 1);

    spec.set_format(type_ == OIIO::TypeUnknown ? picture.format : type_);
    if (type_ != OIIO::TypeUnknown)
        spec.erase_attribute("oiio:BitsPerSample");  // overrules the type
    return spec;
}

ImageSpec PictureWriter::file_spec(const ImageSpec& picture) {
    ImageSpec spec = plan(picture);
    if (out_->supports("ioproxy") == 0) {
        spec.format = OIIO::TypeUnknown;
        return spec;
    }
    // Formats have not every type. One pixel in memory shows what they make of it.
    std::vector<unsigned char> memory;
    OIIO::Filesystem::IOVecOutput proxy(memory);
    const std::string name = temporary_->path().string();
    const auto out = OIIO::ImageOutput::create(name);
    const ImageSpec pixel(1, 1, spec.nchannels, spec.format);
    const std::vector<float> black(static_cast<std::size_t>(spec.nchannels));
    out->set_ioproxy(&proxy);
    if (!out->open(name, pixel)) fail(first_line(out->geterror()));
    spec.format = out->spec().format;
    out->write_scanline(0, 0, OIIO::TypeFloat, black.data());
    out->close();
    return spec;
}

void PictureWriter::open(const ImageSpec& picture) {
    if (const int error = temporary_->check_target()) fail(reason_of(error));
    const ImageSpec spec = plan(picture);
    // libtiff reads its own directories back when there is an EXIF one (a picture marked sRGB has),
    // and a proxy for writing cannot be read: the file would lack its first directory.
    std::string name = temporary_->path().string();
    if (out_->supports("ioproxy") && std::string_view(out_->format_name()) != "tiff") {
        proxy_ = std::make_unique<FileProxy>(temporary_->path());
        check_disk();
        out_->set_ioproxy(proxy_.get());
        name = fs::path(path_).filename().string();
    }
    const bool is_open = out_->open(name, spec);
    temporary_->settle();
    if (!is_open) fail(first_line(out_->geterror()));
}

OIIO::TypeDesc PictureWriter::row_type() const {
    return out_->spec().format == OIIO::TypeHalf && !divides_by_alpha_ ? OIIO::TypeHalf
                                                                       : OIIO::TypeFloat;
}

bool PictureWriter::is_bottom_up() const {
    return std::string_view(out_->format_name()) == "openexr" &&
           out_->spec().get_string_attribute("openexr:lineOrder") == "decreasingY";
}

void PictureWriter::write_rows(const ImageBuf& rows) {
    ImageBuf changed;
    const ImageBuf* fitted = &rows;
    const auto change = [&](ImageBuf&& to) {
        changed = checked(std::move(to));
        fitted = &changed;
    };
    if (!channels_.empty()) {
        change(
            OIIO::ImageBufAlgo::channels(*fitted, static_cast<int>(channels_.size()), channels_));
    }
    if (window_) {
        // Black above the first row and below the last goes with them.
        ROI part = *window_;
        part.ybegin = next_row_;
        const int end = rows.roi().yend;
        part.yend = end == last_row_ ? window_->yend : std::min(end, window_->yend);
        if (part.yend <= part.ybegin) return;
        next_row_ = part.yend;
        change(OIIO::ImageBufAlgo::cut(*fitted, part));
        changed.set_origin(0, part.ybegin - window_->ybegin);
    }
    if (divides_by_alpha_) {
        ImageBuf divided = fitted->copy(OIIO::TypeFloat);
        OIIO::ImageBufAlgo::unpremult(divided, divided);
        change(std::move(divided));
    }
    write_fitted(*fitted);
}

void PictureWriter::write_fitted(const ImageBuf& rows) {
    const ROI part = rows.roi();
    const bool written = part.height() == out_->spec().height
                             ? rows.write(out_.get())
                             : out_->write_scanlines(part.ybegin, part.yend, part.zbegin,
                                                     rows.spec().format, rows.localpixels(),
                                                     rows.pixel_stride(), rows.scanline_stride());
    check_disk();
    if (!written) fail(first_line(rows.has_error() ? rows.geterror() : out_->geterror()));
}

void PictureWriter::finish() {
    if (!out_->close()) fail(first_line(out_->geterror()));
    out_.reset();  // some write their last bytes only now
    if (proxy_) {
        if (const int error = proxy_->finish()) fail(reason_of(error));
    } else {
        try {
            PictureReader written(temporary_->path().string());
            check_is_complete(written);  // there is no other proof
        } catch (const FileError&) {
            fail("what was written cannot be read back (disk full?)");
        }
    }
    if (const int error = temporary_->keep()) fail(reason_of(error));
    // Who reads the file through OIIO's shared cache gets the new one.
    auto cache = OIIO::ImageCache::create(true);  // a pointer, or since 3.0 a shared one
    cache->invalidate(OIIO::ustring(path_));
    OIIO::ImageCache::destroy(cache);
}

TONEWRIGHT_NAMESPACE_END
