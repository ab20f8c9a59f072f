// SPDX-License-Identifier: Apache-2.0
//
// Picture files: whole or not at all, in both directions.
#include <OpenImageIO/filesystem.h>
#include <OpenImageIO/imagebufalgo.h>
#include <OpenImageIO/imagecache.h>
#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cerrno>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <numeric>
#include <string_view>
#include <system_error>
#include <utility>

#include "image/message.h"
#include "tonewright/image.h"

namespace tonewright {
namespace {

namespace fs = std::filesystem;
using OIIO::ImageBuf;
using OIIO::ImageSpec;

[[noreturn]] void cannot(const char* verb, const std::string& path, const std::string& reason) {
    throw FileError(fmt::format("{}: cannot {}: {}", path, verb, reason));
}

std::string reason_of(int error_number) { return std::generic_category().message(error_number); }

// ---------------------------------------------------------------------------------------------
// Writing

/// A file that is being written under a name of its own; removed again unless it was kept.
class TemporaryFile {
  public:
    explicit TemporaryFile(const fs::path& target) : target_(target) {
        // Unique among processes and threads. The extension stays last: it selects the format.
        // Names have at most 255 bytes.
        static std::atomic<unsigned> count = 0;
        const std::string stem = target.stem().string().substr(0, 200);
        path_ = target.parent_path() / fmt::format(".{}.{}.{}.tmp{}", stem, ::getpid(), count++,
                                                   target.extension().string());
    }
    ~TemporaryFile() {
        if (path_.empty()) return;
        std::error_code ignored;
        fs::remove(path_, ignored);
    }
    TemporaryFile(const TemporaryFile&) = delete;
    TemporaryFile& operator=(const TemporaryFile&) = delete;

    [[nodiscard]] const fs::path& path() const { return path_; }

    /// Writes the file's bytes. @returns  0 or an errno.
    [[nodiscard]] int fill(const std::vector<unsigned char>& bytes) const {
        const int file =
            ::open(path_.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_NOFOLLOW | O_CLOEXEC, 0666);
        if (file < 0) return errno;
        int error = 0;
        for (std::size_t done = 0; done < bytes.size() && !error;) {
            const ssize_t n = ::write(file, bytes.data() + done, bytes.size() - done);
            if (n >= 0) {
                done += static_cast<std::size_t>(n);
            } else if (errno != EINTR) {
                error = errno;
            }
        }
        if (::close(file) != 0 && !error) error = errno;
        return error;
    }

    /// Syncs the file and gives it its final name. @returns  0 or an errno.
    [[nodiscard]] int keep() {
        const int file = ::open(path_.c_str(), O_RDONLY | O_CLOEXEC);
        if (file < 0) return errno;
        struct stat old {};
        if (::stat(target_.c_str(), &old) == 0) (void)::fchmod(file, old.st_mode & 07777);
        const int error = ::fsync(file) == 0 ? 0 : errno;
        ::close(file);
        if (error) return error;
        if (::rename(path_.c_str(), target_.c_str()) != 0) return errno;
        path_.clear();
        // The new name is on the disk when its directory is. Some file systems cannot sync one.
        const fs::path folder = target_.has_parent_path() ? target_.parent_path() : fs::path(".");
        const int directory = ::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
        if (directory >= 0) {
            (void)::fsync(directory);
            ::close(directory);
        }
        return 0;
    }

  private:
    fs::path target_;
    fs::path path_;
};

/// Where the bytes go in the end: symbolic links are followed.
fs::path resolve_target(const std::string& path) {
    std::error_code error;
    fs::path target = path;
    if (fs::is_symlink(fs::symlink_status(target, error))) {
        target = fs::weakly_canonical(target, error);
        if (error) cannot("write", path, error.message());
    }
    // Renaming over a device or a directory would destroy it, or fail late.
    const fs::file_status status = fs::status(target, error);
    if (fs::exists(status) && !fs::is_regular_file(status)) {
        cannot("write", path,
               fs::is_directory(status) ? "it is a directory" : "it is no regular file");
    }
    return target;
}

/// The channels that a format takes: all, or color and alpha, or color.
std::vector<int> channels_to_write(const ImageSpec& spec, const OIIO::ImageOutput& out) {
    const bool takes_any_number = out.supports("nchannels") != 0;
    const bool takes_alpha = out.supports("alpha") != 0;
    std::vector<int> channels;
    if (takes_any_number && takes_alpha) {
        channels.resize(static_cast<std::size_t>(spec.nchannels));
        std::iota(channels.begin(), channels.end(), 0);
        return channels;
    }
    const int color_count = spec.nchannels < 3 ? 1 : 3;
    for (int c = 0; c < color_count; ++c)
        channels.push_back(c);
    if (takes_alpha && spec.alpha_channel >= color_count) channels.push_back(spec.alpha_channel);
    return channels;
}

/// A picture as a format can hold it: `image`, or a changed copy that is put into `storage`.
const ImageBuf& fit_to_format(const ImageBuf& image, const OIIO::ImageOutput& out,
                              ImageBuf& storage, const std::string& path) {
    const ImageBuf* fitted = &image;
    const auto change = [&](ImageBuf&& changed) {
        if (changed.has_error()) cannot("write", path, first_line(changed.geterror()));
        storage = std::move(changed);
        fitted = &storage;
    };
    const std::vector<int> channels = channels_to_write(image.spec(), out);
    const int count = static_cast<int>(channels.size());
    if (count < image.nchannels()) change(OIIO::ImageBufAlgo::channels(image, count, channels));

    // What a viewer shows of a picture is its display window. Formats that have none hold just
    // that.
    const OIIO::ROI window = fitted->roi_full();
    const OIIO::ROI data = fitted->roi();
    const bool same = window.xbegin == data.xbegin && window.xend == data.xend &&
                      window.ybegin == data.ybegin && window.yend == data.yend;
    if (!same && !out.supports("displaywindow")) {
        change(OIIO::ImageBufAlgo::cut(*fitted, window));
    }

    // PNG wants color that is not multiplied by alpha. OIIO's writer divides integers, rounding
    // down, and for "Gamma2.2" and its like it divides by a power of alpha: 0.25 of 0.5 becomes 1.
    const ImageSpec& spec = fitted->spec();
    if (std::string_view(out.format_name()) == "png" && spec.alpha_channel >= 0 &&
        spec.get_int_attribute("oiio:UnassociatedAlpha", 0) == 0) {
        ImageBuf divided = fitted->copy(OIIO::TypeFloat);
        OIIO::ImageBufAlgo::unpremult(divided, divided);
        divided.specmod().attribute("oiio:UnassociatedAlpha", 1);
        change(std::move(divided));
    }
    return *fitted;
}

/// @param name  for the writer, which opens it where it has no memory to write to.
void write_pixels(const ImageBuf& image, const ImageSpec& spec, OIIO::ImageOutput& out,
                  const fs::path& name, const std::string& path) {
    if (!out.open(name.string(), spec)) cannot("write", path, first_line(out.geterror()));
    const bool written = image.write(&out);
    const bool closed = out.close();
    if (!written || !closed) {
        const std::string error = image.has_error() ? image.geterror() : out.geterror();
        cannot("write", path, first_line(error));
    }
}

// ---------------------------------------------------------------------------------------------
// Reading

std::string why_not_open(const std::string& path, const std::string& reported) {
    std::error_code error;
    const fs::file_status status = fs::status(path, error);
    if (!fs::exists(status)) return reason_of(ENOENT);
    if (fs::is_directory(status)) return "it is a directory";
    if (::access(path.c_str(), R_OK) != 0) return reason_of(errno);
    if (fs::is_regular_file(status) && fs::file_size(path, error) == 0) return "the file is empty";
    return first_line(reported);
}

}  // namespace

ImageBuf read_image(const std::string& path) {
    // Not through ImageBuf: it asks the shared cache, which may know an older file of this name,
    // and it passes over errors that a reader reports while it delivers pixels.
    const std::unique_ptr<OIIO::ImageInput> in = OIIO::ImageInput::open(path);
    if (!in) cannot("read", path, why_not_open(path, OIIO::geterror()));
    const ImageSpec spec = in->spec();
    if (spec.deep)
        cannot("read", path, "the picture is deep; expected flat pixels (oiiotool --flatten)");
    ImageBuf image(spec, OIIO::InitializePixels::No);
    if (!image.localpixels()) {
        cannot("read", path, fmt::format("no memory for {} x {} pixels", spec.width, spec.height));
    }
    const bool read =
        in->read_image(0, 0, 0, spec.nchannels, image.spec().format, image.localpixels());
    if (!read || in->has_error()) {
        const std::string reported = in->geterror();
        // Readers of DPX and PNM say nothing about a file that ends too early.
        cannot("read", path,
               reported.empty() ? "the file is truncated or damaged" : first_line(reported));
    }
    return image;
}

void write_image_atomically(const ImageBuf& image, const std::string& path,
                            const OIIO::TypeDesc& type) {
    if (image.deep()) cannot("write", path, "the picture is deep; expected flat pixels");
    if (!image.initialized()) {
        cannot("write", path,
               image.has_error() ? first_line(image.geterror()) : "there is no picture");
    }
    const fs::path target = resolve_target(path);
    const std::unique_ptr<OIIO::ImageOutput> out = OIIO::ImageOutput::create(target.string());
    if (!out) {
        cannot("write", path,
               target.has_extension() ? first_line(OIIO::geterror())
                                      : "the name has no extension that selects a format");
    }

    ImageBuf storage;
    const ImageBuf& fitted = fit_to_format(image, *out, storage, path);
    ImageSpec spec = fitted.spec();
    spec.tile_width = spec.tile_height = spec.tile_depth = 0;  // those of the file it came from
    spec.channelformats.clear();
    spec.set_format(type == OIIO::TypeUnknown ? image.spec().format : type);
    if (type != OIIO::TypeUnknown)
        spec.erase_attribute("oiio:BitsPerSample");  // overrules the type

    TemporaryFile temporary(target);
    // libtiff reads its own directories back when there is an EXIF one (a picture marked sRGB has),
    // and OIIO's memory writer cannot be read: the file would lack its first directory.
    const bool reads_back = std::string_view(out->format_name()) == "tiff";
    if (out->supports("ioproxy") && !reads_back) {
        // OIIO's writers do not look whether their last bytes reached the disk (PNG at none), and
        // libjpeg ends the process when one did not. So they encode into memory, and we write.
        OIIO::Filesystem::IOVecOutput memory;
        out->set_ioproxy(&memory);
        write_pixels(fitted, spec, *out, target.filename(), path);
        if (const int error = temporary.fill(memory.buffer()))
            cannot("write", path, reason_of(error));
    } else {
        write_pixels(fitted, spec, *out, temporary.path(), path);
        try {
            (void)read_image(temporary.path().string());  // the only proof that it is complete
        } catch (const FileError&) {
            cannot("write", path, "what was written cannot be read back (disk full?)");
        }
    }
    if (const int error = temporary.keep()) cannot("write", path, reason_of(error));
    // Who reads the file through OIIO's shared cache gets the new one.
    OIIO::ImageCache* cache = OIIO::ImageCache::create(true);
    cache->invalidate(OIIO::ustring(path));
    OIIO::ImageCache::destroy(cache);
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

}  // namespace tonewright
