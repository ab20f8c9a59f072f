// SPDX-License-Identifier: Apache-2.0
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
#include <chrono>
#include <csignal>
#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <map>
#include <memory>
#include <numeric>
#include <optional>
#include <regex>
#include <set>
#include <string>
#include <string_view>
#include <system_error>
#include <utility>

#include "image/message.h"
#include "image/picture_file.h"
#include "lut/numbers.h"

namespace tonewright {
namespace {

namespace fs = std::filesystem;
using OIIO::ImageBuf;
using OIIO::ImageSpec;
using OIIO::ROI;

std::string reason_of(int error_number) { return std::generic_category().message(error_number); }

/// Where the bytes go in the end: symbolic links are followed.
/// @returns  empty, and the reason in `why`, when that is no place for a file.
fs::path resolve_target(const std::string& path, std::string& why) {
    std::error_code error;
    fs::path target = path;
    if (fs::is_symlink(fs::symlink_status(target, error))) {
        target = fs::weakly_canonical(target, error);
        if (error) why = error.message();
    }
    // Renaming over a device or a directory would destroy it, or fail late.
    const fs::file_status status = fs::status(target, error);
    if (fs::exists(status) && !fs::is_regular_file(status)) {
        why = fs::is_directory(status) ? "it is a directory" : "it is no regular file";
    }
    return target;
}

// Names of temporary files: .<stem>.<machine>.<pid>.<n>.tmp.<extension>. The extension stays last:
// it selects the format.

/// What of a picture's name is in those of its temporary files. Names have at most 255 bytes.
std::pair<std::string, std::string> name_parts(const fs::path& target) {
    return {target.stem().string().substr(0, 200), target.extension().string()};
}

/// Tells the machine apart, and the container: where a process id means one process.
const std::string& machine_tag() {
    static const std::string tag = [] {
        std::array<char, 256> host{};
        (void)::gethostname(host.data(), host.size() - 1);
        std::error_code none;
        return content_hash(host.data() + fs::read_symlink("/proc/self/ns/pid", none).string());
    }();
    return tag;
}

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

// ---------------------------------------------------------------------------------------------

/// The temporary files that there are now, for a signal's handler: whoever takes a name out removes
/// the file.
std::array<std::atomic<const char*>, 256> unfinished_names;
static_assert(std::atomic<const char*>::is_always_lock_free);

/// A signal's handler removes them just now: who makes a file after this leaves it behind.
std::atomic<bool> is_ending = false;

void wait_for_end() {
    while (is_ending)
        ::pause();
}

class UnfinishedName {
  public:
    explicit UnfinishedName(const std::string& path) {
        auto name = std::make_unique<char[]>(path.size() + 1);
        std::copy(path.begin(), path.end(), name.get());
        for (std::atomic<const char*>& place : unfinished_names) {
            const char* none = nullptr;
            if (!place.compare_exchange_strong(none, name.get())) continue;
            (void)name.release();
            place_ = &place;
            return;
        }
    }
    ~UnfinishedName() {
        if (place_) delete[] place_->exchange(nullptr);
    }
    UnfinishedName(const UnfinishedName&) = delete;
    UnfinishedName& operator=(const UnfinishedName&) = delete;

  private:
    std::atomic<const char*>* place_ = nullptr;  // null: so many at once that this one stays
};

void remove_unfinished(int number) {
    is_ending = true;
    for (std::atomic<const char*>& place : unfinished_names) {
        if (const char* name = place.exchange(nullptr)) ::unlink(name);
    }
    ::signal(number, SIG_DFL);
    ::raise(number);
}

}  // namespace

void remove_unfinished_files_on_signals() {
    for (const int number : {SIGINT, SIGTERM, SIGHUP}) {
        // nohup stays in force.
        if (::signal(number, remove_unfinished) == SIG_IGN) ::signal(number, SIG_IGN);
    }
}

void remove_leftovers(const std::vector<std::string>& paths) {
    std::map<fs::path, std::set<std::pair<std::string, std::string>>> names_of_folders;
    for (const std::string& path : paths) {
        std::string why;
        const fs::path target = resolve_target(path, why);
        const fs::path folder = target.parent_path();
        names_of_folders[folder.empty() ? "." : folder].insert(name_parts(target));
    }
    static const std::regex pattern(R"(\.(.+)\.([0-9a-f]{8})\.(\d{1,9})\.\d+\.tmp(\..*)?)");
    const auto yesterday = fs::file_time_type::clock::now() - std::chrono::hours(24);
    for (const auto& [folder, names] : names_of_folders) {
        std::error_code error;
        for (fs::directory_iterator entry(folder, error), end; !error && entry != end;
             entry.increment(error)) {
            const std::string name = entry->path().filename().string();
            std::smatch match;
            if (!name.starts_with('.') || !std::regex_match(name, match, pattern) ||
                !names.contains({match[1], match[4]})) {
                continue;
            }
            const bool is_of_nobody =
                match[2] == machine_tag() && ::kill(std::stoi(match[3]), 0) != 0 && errno == ESRCH;
            std::error_code unknown, ignored;
            const bool is_old = fs::last_write_time(entry->path(), unknown) < yesterday && !unknown;
            if (is_of_nobody || is_old) fs::remove(entry->path(), ignored);
        }
    }
}

/// A file that is being written under a name of its own; removed again unless it was kept.
class PictureWriter::TemporaryFile {
  public:
    explicit TemporaryFile(const fs::path& target) : target_(target) {
        static std::atomic<unsigned> count = 0;
        const auto [stem, extension] = name_parts(target);
        path_ = target.parent_path() / fmt::format(".{}.{}.{}.{}.tmp{}", stem, machine_tag(),
                                                   ::getpid(), count++, extension);
        name_.emplace(path_.string());
    }
    ~TemporaryFile() {
        if (path_.empty()) return;
        std::error_code ignored;
        fs::remove(path_, ignored);
    }
    TemporaryFile(const TemporaryFile&) = delete;
    TemporaryFile& operator=(const TemporaryFile&) = delete;

    [[nodiscard]] const fs::path& path() const { return path_; }

    /// Renaming asks the folder alone, and would replace a file that may not be written.
    /// @returns  0 or an errno.
    [[nodiscard]] int check_target() const {
        return ::access(target_.c_str(), W_OK) == 0 || errno == ENOENT ? 0 : errno;
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
        name_.reset();
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
    std::optional<UnfinishedName> name_;
};

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
    std::string why;
    const fs::path target = resolve_target(path, why);
    if (!why.empty()) fail(why);
    out_ = OIIO::ImageOutput::create(target.string());
    if (!out_) {
        fail(target.has_extension() ? first_line(OIIO::geterror())
                                    : "the name has no extension that selects a format");
    }
    out_->threads(nthreads);
    temporary_ = std::make_unique<TemporaryFile>(target);
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
    wait_for_end();
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
    if (is_ending) temporary_.reset();
    wait_for_end();
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

}  // namespace tonewright
