// SPDX-License-Identifier: Apache-2.0
#include "picture/jpeg_writer.h"

#include <fmt/format.h>

// jpeglib.h needs it.
#include <cstdio>

#include <jpeglib.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <charconv>
#include <cmath>
#include <csetjmp>
#include <cstdint>
#include <optional>
#include <string_view>
#include <utility>
#include <vector>

#include "base/strings.h"
#include "base/system_files.h"
#include "picture/file_bytes.h"
#include "picture/jpeg_metadata.h"
#include "picture/read_back.h"
#include "picture/row_codes.h"
#include "tonewright/error.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

using T = OIIO::TypeDesc;

/// libjpeg's state of an error: it jumps to the function that called it. Nothing with a destructor
/// may live in between.
struct Errors {
    jpeg_error_mgr manager{};
    std::jmp_buf place{};
    std::string reason;  // libjpeg's, or empty
    std::optional<FileError> file;
};

/// libjpeg knows only the first member.
Errors& errors_of(j_common_ptr jpeg) { return *static_cast<Errors*>(jpeg->client_data); }

extern "C" {
[[noreturn]] void leave_jpeg(j_common_ptr jpeg) {
    Errors& errors = errors_of(jpeg);
    std::array<char, JMSG_LENGTH_MAX> message{};
    jpeg->err->format_message(jpeg, message.data());
    errors.reason = message.data();
    std::longjmp(errors.place, 1);  // NOLINT(cert-err52-cpp)
}
void ignore_jpeg_message(j_common_ptr /*jpeg*/) {}
}

void set_errors(j_common_ptr jpeg, Errors& errors) {
    jpeg->err = jpeg_std_error(&errors.manager);
    errors.manager.error_exit = leave_jpeg;
    errors.manager.output_message = ignore_jpeg_message;
    jpeg->client_data = &errors;
}

/// The file that libjpeg writes to.
struct Destination {
    jpeg_destination_mgr manager{};
    int file = -1;
    std::vector<JOCTET> buffer = std::vector<JOCTET>(std::size_t{1} << 16);
};

void begin_buffer(Destination& to) {
    to.manager.next_output_byte = to.buffer.data();
    to.manager.free_in_buffer = to.buffer.size();
}
void write_buffer(j_compress_ptr jpeg, std::size_t count) {
    auto& to = *reinterpret_cast<Destination*>(jpeg->dest);
    try {
        write_all(to.file, to.buffer.data(), count);
        begin_buffer(to);
        return;
    } catch (const FileError& error) {
        errors_of(reinterpret_cast<j_common_ptr>(jpeg)).file = error;
    }
    leave_jpeg(reinterpret_cast<j_common_ptr>(jpeg));
}

extern "C" {
void begin_jpeg_file(j_compress_ptr jpeg) {
    begin_buffer(*reinterpret_cast<Destination*>(jpeg->dest));
}
boolean write_jpeg_buffer(j_compress_ptr jpeg) {
    write_buffer(jpeg, reinterpret_cast<Destination*>(jpeg->dest)->buffer.size());
    return TRUE;
}
void end_jpeg_file(j_compress_ptr jpeg) {
    const auto& to = *reinterpret_cast<Destination*>(jpeg->dest);
    write_buffer(jpeg, to.buffer.size() - to.manager.free_in_buffer);
}
}

/// Dots per inch, per centimeter or as a ratio.
struct Density {
    std::uint8_t unit = 0;
    std::uint16_t x = 1, y = 1;
};
Density density_of(const PictureSpec& spec) {
    Density density;
    const std::string unit = spec.get_string_attribute("ResolutionUnit");
    if (is_same_name(unit, "in")) density.unit = 1;
    if (is_same_name(unit, "cm")) density.unit = 2;
    float x = spec.get_float_attribute("XResolution");
    float y = spec.get_float_attribute("YResolution");
    const float aspect = spec.get_float_attribute("PixelAspectRatio");
    if (aspect <= 0) {
        if (x <= 0 && y <= 0) return density;
        if (x <= 0) x = y;
        if (y <= 0) y = x;
    } else if (x > 0) {
        // Photoshop, Nuke and OpenImageIO use the inverse of the ratio that JFIF states.
        y = x / aspect;
    } else if (y > 0) {
        x = y * aspect;
    } else {
        constexpr float kUsual = 72;
        x = aspect >= 1 ? kUsual : kUsual * aspect;
        y = aspect >= 1 ? kUsual * aspect : kUsual;
    }
    const auto dots = [](float number) {
        constexpr float kMost = 65535;
        return static_cast<std::uint16_t>(std::fmin(std::fmax(number + 0.5F, 1.0F), kMost));
    };
    density.x = dots(x);
    density.y = dots(y);
    return density;
}

/// `jpeg:QUALITY`, or CompressionQuality.
int quality_of(const PictureSpec& spec) {
    constexpr int kDefault = 98;
    const std::string text = spec.get_string_attribute("compression", "jpeg");
    const std::size_t colon = std::min(text.find(':'), text.size());
    if (!is_same_name(std::string_view(text).substr(0, colon), "jpeg")) return kDefault;
    int quality = spec.get_int_attribute("CompressionQuality", kDefault);
    if (colon < text.size()) {
        quality = 0;
        std::from_chars(text.data() + colon + 1, text.data() + text.size(), quality);
    }
    return std::clamp(quality, 1, 100);
}

/// Samples of luma for each one of chroma, horizontally and vertically.
std::optional<std::pair<int, int>> sampling_of(const PictureSpec& spec) {
    const std::string text = spec.get_string_attribute("jpeg:subsampling");
    if (text == "4:4:4") return {{1, 1}};
    if (text == "4:2:2") return {{2, 1}};
    if (text == "4:2:0") return {{2, 2}};
    if (text == "4:1:1") return {{4, 1}};
    return {};
}

/// ICC.1:2022, B.4: the segments APP2 of a profile.
std::vector<std::string> profile_segments(const PictureSpec& spec) {
    constexpr std::size_t kMost = 65519;
    const PictureAttribute* const found = spec.find_attribute("ICCProfile");
    if (!found || found->data.empty()) return {};
    const std::size_t count = (found->data.size() + kMost - 1) / kMost;
    std::vector<std::string> segments;
    for (std::size_t i = 0; i < count; ++i) {
        std::string& segment = segments.emplace_back("ICC_PROFILE\0", 12);
        segment += {static_cast<char>(i + 1), static_cast<char>(count)};
        segment.append(reinterpret_cast<const char*>(found->data.data()) + i * kMost,
                       std::min(kMost, found->data.size() - i * kMost));
    }
    return segments;
}

void write_marker(j_compress_ptr jpeg, int marker, const std::string& bytes) {
    if (bytes.empty()) return;
    jpeg_write_marker(jpeg, marker, reinterpret_cast<const JOCTET*>(bytes.data()),
                      static_cast<unsigned>(bytes.size()));
}

/// Frees what libjpeg holds, also where the constructor of the writer throws.
struct Compressor {
    jpeg_compress_struct jpeg{};

    Compressor() = default;
    ~Compressor() { jpeg_destroy_compress(&jpeg); }
    Compressor(const Compressor&) = delete;
    Compressor& operator=(const Compressor&) = delete;
};

class JpegWriter final : public RowWriter {
  public:
    JpegWriter(int file, const PictureSpec& spec, const JpegMetadata& metadata, unsigned threads);

    [[nodiscard]] const PictureSpec& spec() const override { return spec_; }
    void write_rows(int row_count, OIIO::TypeDesc type, const std::byte* rows) override;
    void finish() override;

  private:
    bool start(const JpegMetadata& metadata, const std::vector<std::string>& profile);
    bool encode(std::size_t row_count);
    bool end();
    void check(bool is_done) const {
        if (is_done) return;
        if (errors_.file) throw FileError(*errors_.file);
        throw FileError(errors_.reason);
    }

    PictureSpec spec_;
    unsigned threads_;
    RowCodes to_codes_;
    Errors errors_;
    Destination to_;
    Compressor compressor_;
    jpeg_compress_struct& jpeg_ = compressor_.jpeg;
    std::vector<std::uint8_t> codes_;
};

JpegWriter::JpegWriter(int file, const PictureSpec& spec, const JpegMetadata& metadata,
                       unsigned threads)
    : spec_(spec), threads_(threads), to_codes_(spec) {
    to_.file = file;
    to_.manager.init_destination = begin_jpeg_file;
    to_.manager.empty_output_buffer = write_jpeg_buffer;
    to_.manager.term_destination = end_jpeg_file;
    set_errors(reinterpret_cast<j_common_ptr>(&jpeg_), errors_);
    check(start(metadata, profile_segments(spec)));
}

bool JpegWriter::start(const JpegMetadata& metadata, const std::vector<std::string>& profile) {
    if (setjmp(errors_.place) != 0) return false;  // NOLINT(cert-err52-cpp)
    jpeg_create_compress(&jpeg_);
    jpeg_.dest = &to_.manager;
    jpeg_.image_width = static_cast<JDIMENSION>(spec_.width);
    jpeg_.image_height = static_cast<JDIMENSION>(spec_.height);
    jpeg_.input_components = spec_.nchannels;
    jpeg_.in_color_space = spec_.nchannels == 1 ? JCS_GRAYSCALE : JCS_RGB;
    jpeg_set_defaults(&jpeg_);
    const Density density = density_of(spec_);
    jpeg_.density_unit = density.unit;
    jpeg_.X_density = density.x;
    jpeg_.Y_density = density.y;
    jpeg_set_quality(&jpeg_, quality_of(spec_), TRUE);
    const auto sampling = sampling_of(spec_);
    if (sampling && spec_.nchannels == 3) {
        jpeg_.comp_info[0].h_samp_factor = sampling->first;
        jpeg_.comp_info[0].v_samp_factor = sampling->second;
    }
    if (spec_.get_int_attribute("jpeg:progressive") != 0) jpeg_simple_progression(&jpeg_);
    jpeg_start_compress(&jpeg_, TRUE);
    write_marker(&jpeg_, JPEG_COM, metadata.comment);
    write_marker(&jpeg_, JPEG_APP0 + 1, metadata.exif);
    write_marker(&jpeg_, JPEG_APP0 + 13, metadata.iptc);
    for (const std::string& segment : profile)
        write_marker(&jpeg_, JPEG_APP0 + 2, segment);
    return true;
}

bool JpegWriter::encode(std::size_t row_count) {
    if (setjmp(errors_.place) != 0) return false;  // NOLINT(cert-err52-cpp)
    for (std::size_t row = 0; row < row_count; ++row) {
        JSAMPROW codes = &codes_[row * spec_.scanline_bytes()];
        jpeg_write_scanlines(&jpeg_, &codes, 1);
    }
    return true;
}

bool JpegWriter::end() {
    if (setjmp(errors_.place) != 0) return false;  // NOLINT(cert-err52-cpp)
    jpeg_finish_compress(&jpeg_);
    return true;
}

void JpegWriter::write_rows(int row_count, OIIO::TypeDesc type, const std::byte* rows) {
    constexpr std::size_t kRows = 64;  // at a time
    auto rest = static_cast<std::size_t>(row_count);
    while (rest > 0) {
        const std::size_t count = std::min(rest, kRows);
        codes_.resize(std::max(codes_.size(), count * spec_.scanline_bytes()));
        to_codes_.convert(count, type, rows, codes_.data(), spec_.scanline_bytes(), threads_);
        check(encode(count));
        rows += count * to_codes_.row_bytes(type);
        rest -= count;
    }
}

void JpegWriter::finish() {
    if (jpeg_.next_scanline != jpeg_.image_height) {
        throw FileError(fmt::format("{} rows were written; expected {}", jpeg_.next_scanline,
                                    jpeg_.image_height));
    }
    check(end());
}

/// Numbers of OpenImageIO's attributes that this writer reads without conversion.
bool has_plain_numbers(const PictureSpec& spec) {
    for (const std::string_view name : {"XResolution", "YResolution", "PixelAspectRatio"}) {
        const PictureAttribute* const found = spec.find_attribute(name);
        if (found && found->type != T(T::FLOAT)) return false;
    }
    return true;
}

/// Facts that libjpeg finds.
struct FoundJpeg {
    JDIMENSION width = 0, height = 0;
    int channels = 0;
};

bool read_header(std::FILE* file, jpeg_decompress_struct& jpeg, Errors& errors, FoundJpeg& found) {
    if (setjmp(errors.place) != 0) return false;  // NOLINT(cert-err52-cpp)
    jpeg_create_decompress(&jpeg);
    jpeg_stdio_src(&jpeg, file);
    jpeg_read_header(&jpeg, TRUE);
    found = {jpeg.image_width, jpeg.image_height, jpeg.num_components};
    return true;
}

bool ends_as_jpeg(std::FILE* file) {
    // ITU-T T.81, B.1.1.3: EOI.
    std::array<std::uint8_t, 2> last{};
    return std::fseek(file, -2, SEEK_END) == 0 && std::fread(last.data(), 1, 2, file) == 2 &&
           last[0] == 0xFF && last[1] == JPEG_EOI;
}

}  // namespace

std::unique_ptr<RowWriter> create_jpeg(int file, const PictureSpec& spec, unsigned threads) {
    const bool is_written_here =
        spec.width >= 1 && spec.height >= 1 && spec.depth <= 1 && spec.tile_width == 0 &&
        (spec.nchannels == 1 || spec.nchannels == 3) &&
        spec.get_int_attribute("oiio:dither") == 0 && has_plain_numbers(spec);
    if (!is_written_here) return nullptr;
    const std::optional<JpegMetadata> metadata = jpeg_metadata(spec);
    if (!metadata) return nullptr;
    PictureSpec written = spec;
    written.format = T(T::UINT8);
    written.channelformats.clear();
    return std::make_unique<JpegWriter>(file, written, *metadata, threads);
}

std::string fault_of_jpeg(const std::string& path, const PictureSpec& spec) {
    const std::unique_ptr<std::FILE, int (*)(std::FILE*)> file(std::fopen(path.c_str(), "rb"),
                                                               std::fclose);
    if (!file) return "what was written cannot be read back: " + reason_of(errno);
    Errors errors;
    jpeg_decompress_struct jpeg{};
    set_errors(reinterpret_cast<j_common_ptr>(&jpeg), errors);
    FoundJpeg found;
    const bool is_read = read_header(file.get(), jpeg, errors, found);
    jpeg_destroy_decompress(&jpeg);
    if (!is_read || !ends_as_jpeg(file.get()))
        return "what was written cannot be read back: it is no complete JPEG file";
    return fault_of_shape(static_cast<int>(found.width), static_cast<int>(found.height),
                          found.channels, spec);
}

TONEWRIGHT_NAMESPACE_END
