// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>
#include <algorithm>
#include <array>
#include <cerrno>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <map>
#include <string_view>
#include <system_error>

#include <OpenImageIO/filesystem.h>
#include <OpenImageIO/strutil.h>

#include "base/input_file.h"
#include "base/strings.h"
#include "image/converted_picture.h"
#include "image/heif_reader.h"
#include "image/luminance_chroma.h"
#include "image/picture_file.h"
#include "image/resize.h"
#include "image/source_picture.h"
#include "image/spec_conversion.h"
#include "image/tonemap_file.h"
#include "picture/exr_reader.h"
#include "picture/file_reader.h"
#include "picture/picture_description.h"
#include "picture/source_pixels.h"
#include "tonewright/image_io.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

using OIIO::ImageBuf;
using OIIO::ROI;

/// If a file is truncated, OpenImageIO's reader delivers the previous contents of its memory. SMPTE
/// ST 268:2003, table 1 (offsets in bytes), if the pixels of the first element are not compressed.
void check_dpx_size(const std::string& path) {
    std::array<unsigned char, 808> header{};
    std::ifstream file(path, std::ios::binary);
    if (!file.read(reinterpret_cast<char*>(header.data()), header.size()))
        cannot_read(path, "the file is truncated or damaged");
    const bool is_little = header[0] == 'X';
    const auto number = [&](std::size_t at, std::size_t bytes) {
        std::uint64_t value = 0;
        for (std::size_t i = 0; i < bytes; ++i)
            value = value << 8 | header[at + (is_little ? bytes - 1 - i : i)];
        return value;
    };
    const std::uint64_t width = number(772, 4);
    const std::uint64_t height = number(776, 4);
    const std::uint64_t bits = number(803, 1);
    const std::uint64_t packing = number(804, 2);
    const std::uint64_t encoding = number(806, 2);
    std::uint64_t per_pixel = 0;
    switch (number(800, 1)) {  // the descriptor: ST 268:2003, table 1, field 21.6
        case 50:
            per_pixel = 3;
            break;
        case 51:
        case 52:
            per_pixel = 4;
            break;
        case 1:
        case 2:
        case 3:
        case 4:
        case 6:
            per_pixel = 1;
            break;
        default:
            return;  // subsampled or of a maker's own
    }
    if (encoding != 0) return;
    const std::uint64_t samples = width * per_pixel;
    std::uint64_t row = 0;
    if (bits == 10 && (packing == 1 || packing == 2)) {
        row = (samples + 2) / 3 * 4;
    } else if (bits == 12 && (packing == 1 || packing == 2)) {
        row = samples * 2;
    } else {
        row = (samples * bits + 7) / 8;
    }
    const std::uint64_t offset = number(4, 4);
    std::error_code error;
    const std::uint64_t size = std::filesystem::file_size(path, error);
    if (error || offset == 0xFFFFFFFFU || offset + row * height <= size) return;
    cannot_read(path, fmt::format("the file is truncated: it has {} bytes; expected {}", size,
                                  offset + row * height));
}

/// OpenImageIO's reader of JPEG 2000 decodes the picture while it opens it. ISO/IEC 15444-1: the
/// codestream begins with the markers SOC and SIZ (A.5.1), alone or in a box `jp2c` (I.4).
void check_jpeg2000_size(const std::string& path, double max_pixels) {
    std::ifstream file(path, std::ios::binary);
    const auto number = [&](std::size_t bytes) {
        std::uint64_t value = 0;
        for (std::size_t i = 0; i < bytes; ++i)
            value = value << 8 | static_cast<std::uint64_t>(file.get() & 0xFF);
        return value;
    };
    constexpr std::uint64_t kSocAndSiz = 0xFF4FFF51;
    constexpr std::uint64_t kCodestream = 0x6A703263;  // "jp2c"
    constexpr std::uint64_t kSignature = 0x6A502020;   // "jP  "
    std::uint64_t first = number(4);
    if (first != kSocAndSiz) {
        if (number(4) != kSignature) return;
        std::uint64_t at = 0;
        std::uint64_t type = kSignature;
        while (type != kCodestream) {
            // A box that extends to the end of the file, or one without its own header.
            if (first == 1) first = number(8);
            if (first < 8 || first > INT64_MAX - at) return;
            at += first;
            file.seekg(static_cast<std::streamoff>(at));
            first = number(4);
            type = number(4);
            if (!file) return;
        }
        if (first == 1) (void)number(8);
        if (number(4) != kSocAndSiz) return;
    }
    (void)number(4);  // length of the segment, capabilities
    const auto right = static_cast<double>(number(4));
    const auto bottom = static_cast<double>(number(4));
    const auto left = static_cast<double>(number(4));
    const auto top = static_cast<double>(number(4));
    if (!file) return;  // the reader has the reason
    const double width = std::max(right - left, 0.0);
    const double height = std::max(bottom - top, 0.0);
    if (width * height > max_pixels) refuse_size(path, width, height, max_pixels);
}

/// The reason why a picture could not be opened, in one line.
/// @param reported  OpenImageIO's message
Problem why_not_open(const std::string& path, const std::string& reported) {
    if (std::optional<Problem> why = why_not_readable(path)) return *std::move(why);
    std::error_code error;
    if (std::filesystem::file_size(path, error) == 0) return {.value = "the file is empty"};
    return problem_of_library(reported);
}

/// DICOM PS3.10, 7.1: a preamble of 128 bytes, then "DICM".
bool is_dicom(const std::string& path) {
    std::array<char, 132> head{};
    std::ifstream file(path, std::ios::binary);
    return file.read(head.data(), head.size()) && std::string_view(head.data() + 128, 4) == "DICM";
}

/// Opens a file with the reader of its extension; if that says no, with the first that says yes.
/// `ImageInput::open` does the same, with two differences that matter: it takes the text after a ?
/// as arguments of a reader, and it tries DCMTK on every file, which ends the process if memory is
/// short (3.6.7, while it loads its dictionary).
std::unique_ptr<OIIO::ImageInput> open_file(const std::string& path,
                                            const OIIO::ImageSpec& config) {
    OIIO::ImageSpec spec;
    std::string reason;
    const auto opened = [&](const std::string& format) {
        std::unique_ptr<OIIO::ImageInput> in = OIIO::ImageInput::create(format);
        if (!in) return in;
        (void)in->geterror();  // of an earlier reader at this address
        if (in->open(path, spec, config)) return in;
        if (reason.empty()) reason = in->geterror();
        // Its own file, but damaged or too large for memory: another reader would give less of it.
        if (in->valid_file(path)) cannot_read(path, why_not_open(path, reason));
        return std::unique_ptr<OIIO::ImageInput>();
    };
    const std::string extension = extension_of(path);
    if (!extension.empty()) {
        if (std::unique_ptr<OIIO::ImageInput> in = opened(extension.substr(1))) return in;
    }
    const std::string first_reason = reason;
    for (const std::string& format :
         OIIO::Strutil::splits(OIIO::get_string_attribute("input_format_list"), ",")) {
        if (format == "null" || (format == "dicom" && !is_dicom(path))) continue;
        if (std::unique_ptr<OIIO::ImageInput> in = opened(format)) return in;
    }
    (void)OIIO::geterror();  // of create()
    cannot_read(path, why_not_open(path, first_reason.empty() ? "no reader knows its format"
                                                              : first_reason));
}

}  // namespace

std::unique_lock<std::recursive_mutex> lock_header(const std::string& path) {
    // Recursive: a picture may be one of the plugin, which opens another.
    static std::recursive_mutex mutex;
    return extension_of(path) == ".exr" ? std::unique_lock<std::recursive_mutex>()
                                        : std::unique_lock(mutex);
}

std::unique_ptr<OIIO::ImageInput> open_picture(const std::string& path,
                                               const OIIO::ImageSpec* config, double max_pixels) {
    // A reader would wait forever for the end of a pipe. A name without a file may be one that a
    // reader understands: "shot.exr.tonewright?op=hable".
    if (const std::string why = why_no_file(path); !why.empty()) cannot_read(path, why);
    if (is_heif(path)) return open_heif(path, max_pixels);
    check_jpeg2000_size(path, max_pixels);
    // OpenImageIO multiplies straight color by alpha in the file's type: in 8 bits, little is left
    // of color with low alpha.
    OIIO::ImageSpec straight;
    straight.attribute("oiio:UnassociatedAlpha", 1);
    if (!config) config = &straight;
    const std::unique_lock lock = lock_header(path);
    // A name without a file is one that a reader understands, or has its reason in the system.
    if (why_not_readable(path)) {
        std::unique_ptr<OIIO::ImageInput> in;
        if (path.find('?') != std::string::npos) in = OIIO::ImageInput::open(path, config);
        if (!in) cannot_read(path, why_not_open(path, OIIO::geterror()));
        return in;
    }
    return open_file(path, *config);
}

/// OpenImageIO refuses Radiance files of CIE XYZ, whose pixels have the same form.
/// @returns  the file as one of RGB; empty for all other files
static std::string radiance_of_xyz(const std::string& path) {
    constexpr std::size_t kLongestHeader = 1 << 16;
    constexpr std::string_view kXyz = "32-bit_rle_xyze";
    constexpr std::string_view kRgb = "32-bit_rle_rgbe";
    std::ifstream file(path, std::ios::binary);
    std::string head(kLongestHeader, '\0');
    file.read(head.data(), static_cast<std::streamsize>(head.size()));
    head.resize(static_cast<std::size_t>(file.gcount()));
    const std::size_t end = head.find("\n\n");
    const std::size_t at = head.find(kXyz);
    if (!head.starts_with("#?") || at == std::string::npos || at > end) return {};
    constexpr std::size_t kLongest = std::size_t{4} << 30;
    std::string bytes =
        read_file(path, kLongest, [&](const Problem& why) { cannot_read(path, why); });
    return bytes.replace(at, kXyz.size(), kRgb);
}

/// One of OpenImageIO's readers.
class PictureReader::InputRows final : public RowReader {
  public:
    InputRows(const std::string& path, double max_pixels)
        : path_(path), bytes_(why_no_file(path).empty() ? radiance_of_xyz(path) : std::string()) {
        if (bytes_.empty()) {
            in_ = open_picture(path, nullptr, max_pixels);
        } else {
            memory_ = std::make_unique<OIIO::Filesystem::IOMemReader>(bytes_.data(), bytes_.size());
            in_ = OIIO::ImageInput::create("hdr");
            OIIO::ImageSpec spec;
            if (!in_ || !in_->set_ioproxy(memory_.get()) || !in_->open(path, spec)) {
                cannot_read(path, problem_of_library(in_ ? in_->geterror()
                                                         : "this format is not supported"));
            }
        }
        specs_.emplace(0, picture_spec(in_->spec()));
    }

    [[nodiscard]] std::string format() const { return in_->format_name(); }
    void use_threads(unsigned count) override { in_->threads(static_cast<int>(count)); }
    [[nodiscard]] bool has_picture(int number) override {
        const std::unique_lock lock = lock_header(path_);
        const bool is_there = in_->seek_subimage(number, 0);
        forget_errors();
        if (is_there) specs_.insert_or_assign(number, picture_spec(in_->spec()));
        return is_there;
    }
    [[nodiscard]] const PictureSpec& spec(int picture) override { return specs_.at(picture); }
    void read_rows(int picture, int ybegin, int yend, std::byte* to) override {
        const PictureSpec& s = spec(picture);
        const OIIO::TypeDesc type = s.format;
        forget_errors();
        // This reader delivers less than it declares, without an error.
        if (format() == "dpx")
            std::fill_n(to, static_cast<std::size_t>(yend - ybegin) * s.scanline_bytes(),
                        std::byte{});
        check(s.tile_width > 0
                  ? in_->read_tiles(picture, 0, s.x, s.x + s.width, ybegin, yend, s.z, s.z + 1, 0,
                                    s.nchannels, type, to)
                  : in_->read_scanlines(picture, 0, ybegin, yend, s.z, 0, s.nchannels, type, to));
    }
    void read_volume(int picture, const OIIO::TypeDesc& type, void* to) {
        forget_errors();
        check(in_->read_image(picture, 0, 0, spec(picture).nchannels, type, to));
    }

  private:
    /// OpenImageIO 2.4 stores errors by the address of a reader and by thread. If another thread
    /// destroys a reader, its errors remain for the next reader at that address.
    void forget_errors() const { (void)in_->geterror(); }
    void check(bool was_read) const {
        if (was_read && !in_->has_error()) return;
        const std::string reported = in_->geterror();
        // Readers of DPX and PNM do not report a file that ends too early.
        throw FileError(
            problem_of_library(reported.empty() ? "the file is truncated or damaged" : reported));
    }

    std::string path_;
    std::string bytes_;                                  // of a file that is read from memory
    std::unique_ptr<OIIO::Filesystem::IOProxy> memory_;  // outlives the reader
    std::unique_ptr<OIIO::ImageInput> in_;
    std::map<int, PictureSpec> specs_;
};

FileReader PictureReader::open(const std::string& path, int nthreads, const ReadOptions& options) {
    if (const std::string why = why_no_file(path); !why.empty()) cannot_read(path, why);
    const auto threads = static_cast<unsigned>(thread_count(nthreads));
    if (std::unique_ptr<RowReader> rows = open_exr(path, threads))
        return {path, "openexr", std::move(rows), options};
    try {
        if (std::unique_ptr<RowReader> rows = open_luminance_chroma(path))
            return {path, "openexr", std::move(rows), options};
    } catch (const FileError& e) {
        cannot_read(path, e.problem());
    }
    // ImageBuf is not used: it asks the shared cache, which may have an older file of this name,
    // and it ignores errors that a reader reports while it delivers pixels.
    auto rows = std::make_unique<InputRows>(path, options.max_pixels);
    rows->use_threads(threads);
    input_ = rows.get();
    const std::string format = rows->format();
    return {path, format, std::move(rows), options};
}

PictureReader::PictureReader(const std::string& path, int nthreads, const ReadOptions& options)
    : path_(path), file_(open(path, nthreads, options)), nthreads_(nthreads) {
    stored_ = spec_ = image_spec(file_.spec());
    if (input_ && input_->format() == "dpx") check_dpx_size(path);
    if (options.resize.empty()) return;
    try {
        spec_ = resized_spec(stored_, options.resize, options.max_pixels);
    } catch (const PictureError& e) {
        cannot_read(path, e.problem());
    }
    resizing_.emplace();
}

PictureReader::~PictureReader() = default;

void PictureReader::convert_colors(const TonemapOptions& options) {
    SourceColor color = source_color(picture_spec(stored_), options.input);
    if (resizing_) {
        resizing_ = options;
        spec_ = light_spec(spec_, color, options.unpremult);
        color_ = std::move(color);
        resized_.reset();
        return;
    }
    if (!color.convert) return;
    spec_ = image_spec(converted_spec(picture_spec(stored_), color));
    color_ = std::move(color);
}

[[noreturn]] static void cannot_convert(const ImageBuf& picture) {
    throw FileError(problem_of_library(picture.geterror()));
}

void PictureReader::read_rows(int ybegin, int yend, std::byte* to) {
    if (resizing_) {
        const ROI rows(spec_.x, spec_.x + spec_.width, ybegin, yend, spec_.z, spec_.z + 1, 0,
                       spec_.nchannels);
        if (!resized().get_pixels(rows, OIIO::TypeFloat, to)) cannot_convert(resized());
        return;
    }
    if (!color_) {
        file_.read_rows(ybegin, yend, to);
        return;
    }
    const OIIO::ImageSpec rows = spec_of_rows(stored_, ybegin, yend);
    std::vector<std::byte> stored(rows.image_bytes());
    file_.read_rows(ybegin, yend, stored.data());
    const ImageBuf light = converted_picture(ImageBuf(rows, stored.data()), *color_);
    if (!light.get_pixels(light.roi(), OIIO::TypeFloat, to)) cannot_convert(light);
}

const ImageBuf& PictureReader::resized() {
    if (!color_) convert_colors({});
    if (!resized_) {
        const ImageBuf stored = read_all_stored();
        resized_ = with_memory_for(
            path_, [&] { return resized_light(stored, *color_, *resizing_, spec_, nthreads_); });
    }
    return *resized_;
}

ImageBuf PictureReader::read_all() {
    if (resizing_) return resized();
    ImageBuf image = read_all_stored();
    return color_ ? converted_picture(image, *color_) : std::move(image);
}

ImageBuf PictureReader::read_all_stored() {
    // Cleared, because some readers deliver less than they declare.
    ImageBuf image = with_memory_for(path_, [&] { return black_picture(stored_); });
    auto* to = static_cast<std::byte*>(image.localpixels());
    if (stored_.depth > 1 && input_) {
        try {
            input_->read_volume(file_.subimage(), stored_.format, to);
        } catch (const FileError& e) {
            cannot_read(path_, e.problem());
        }
        return image;
    }
    const int step = rows_of_batch(stored_.scanline_bytes(), row_step(), stored_.height);
    const int yend = stored_.y + stored_.height;
    for (int y = stored_.y; y < yend; y += step) {
        const int end = std::min(y + step, yend);
        file_.read_rows(y, end, to);
        to += stored_.scanline_bytes() * static_cast<std::size_t>(end - y);
    }
    return image;
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
    const int step = rows_of_batch(spec.scanline_bytes(), reader.row_step(), spec.height);
    const int yend = spec.y + spec.height;
    std::vector<std::byte> rows(spec.scanline_bytes() * static_cast<std::size_t>(step));
    for (int y = spec.y; y < yend; y += step)
        reader.read_rows(y, std::min(y + step, yend), rows.data());
}

TONEWRIGHT_NAMESPACE_END
