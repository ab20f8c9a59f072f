// SPDX-License-Identifier: Apache-2.0
#include <OpenImageIO/filesystem.h>
#include <OpenImageIO/imagebufalgo.h>
#include <OpenImageIO/imagecache.h>
#include <fcntl.h>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <charconv>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <filesystem>
#include <fstream>
#include <map>
#include <memory>
#include <numeric>
#include <optional>
#include <string>
#include <string_view>
#include <utility>

#include "base/atomic_file.h"
#include "base/strings.h"
#include "base/system_files.h"
#include "image/color_tags.h"
#include "image/format_limits.h"
#include "image/picture_file.h"
#include "image/png_chunks.h"
#include "tonewright/engine.h"
#include "tonewright/error.h"
#include "tonewright/view.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

namespace fs = std::filesystem;
using OIIO::ImageBuf;
using OIIO::ImageSpec;
using OIIO::ROI;

/// Compressions of the formats that have several, or a quality, by OpenImageIO's names. Its writers
/// silently replace an unknown name by the default.
struct FormatCompressions {
    std::string_view format;
    std::vector<std::string> names;
    std::vector<std::string> with_quality;
};
const FormatCompressions* compressions_of(std::string_view format) {
    static const std::vector<FormatCompressions> all = {
        {"openexr",
         {"none", "rle", "zip", "zips", "piz", "pxr24", "b44", "b44a", "dwaa", "dwab"},
         {"dwaa", "dwab"}},
        {"tiff", {"none", "lzw", "zip", "packbits", "jpeg"}, {"jpeg"}},
        {"jpeg", {"jpeg"}, {"jpeg"}},
        {"webp", {"webp", "lossless"}, {"webp"}},
        {"heif", {"heic", "none"}, {"heic"}},
        {"avif", {"avif"}, {"avif"}},
        {"png", {"default", "filtered", "huffman", "rle", "fixed"}, {}},
        {"targa", {"none", "rle"}, {}},
        {"iff", {"none", "rle"}, {}},
    };
    const auto found =
        std::find_if(all.begin(), all.end(), [&](const auto& row) { return row.format == format; });
    return found == all.end() ? nullptr : &*found;
}

/// A share of 0 to 1 as percent, rounded up, so that a single pixel is not 0 %.
std::string percent_text(double share) {
    return fmt::format("{:.3g}", std::ceil(1000 * share) / 10);
}

/// Rows of the blocks that a compression of OpenEXR makes (ImfCompressor.cpp); 0 for other names.
int rows_of_block(std::string_view compression) {
    static const std::map<std::string_view, int> rows = {
        {"none", 1}, {"rle", 1},  {"zips", 1},  {"zip", 16},  {"pxr24", 16},
        {"piz", 32}, {"b44", 32}, {"b44a", 32}, {"dwaa", 32}, {"dwab", 256}};
    const auto found = rows.find(compression.substr(0, compression.find(':')));
    return found == rows.end() ? 0 : found->second;
}

/// Only heif files need this check, because the name does not state the codec. ISO/IEC 14496-12,
/// 4.3: the brand of a file is in its box `ftyp`.
std::string brand_of(const fs::path& path) {
    std::ifstream file(path, std::ios::binary);
    std::array<char, 12> start{};
    file.read(start.data(), start.size());
    return {start.data() + 8, 4};
}

/// A reason of a temporary file, whose name says nothing to a user.
std::string without_name(const std::string& text, const std::string& name) {
    const std::string begin = name + ": ";
    return text.starts_with(begin) ? text.substr(begin.size()) : text;
}

std::string title_of(const OIIO::TypeDesc& type) {
    if (type == OIIO::TypeDesc::UINT8) return "8 bits";
    if (type == OIIO::TypeDesc::UINT16) return "16 bits";
    return type.c_str();
}

}  // namespace

/// The file of OIIO's writers. They do not check whether their last bytes reached the disk (PNG:
/// none of them), and libjpeg ends the process after a failed write. This file therefore accepts
/// everything, and remembers the first error.
class PictureWriter::FileProxy final : public OIIO::Filesystem::IOProxy {
  public:
    explicit FileProxy(AtomicFile& target) : IOProxy(target.path().string(), Write) {
        const int file = target.create();
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

    /// Inserts `bytes` at `place`, which the writer passes once.
    void insert(std::size_t place, std::string bytes) {
        place_ = static_cast<int64_t>(place);
        inserted_ = std::move(bytes);
    }

    /// Replaces bytes that were written.
    /// @param place  in the file, after what was inserted
    void patch(std::size_t place, std::string_view bytes) {
        if (!errno_ && ::fseeko(file_, static_cast<off_t>(place), SEEK_SET) != 0) errno_ = errno;
        put(bytes.data(), bytes.size());
    }

    /// Begins to count the blocks of an OpenEXR file, each of which begins with its first row and
    /// its size in bytes, four bytes each.
    void begin_blocks() { next_block_ = m_pos; }
    [[nodiscard]] int blocks() const { return blocks_; }

    [[nodiscard]] const char* proxytype() const override { return "tonewright"; }
    bool seek(int64_t offset) override {
        if (offset == m_pos) return true;
        if (!errno_ && ::fseeko(file_, offset + shift_, SEEK_SET) != 0) errno_ = errno;
        m_pos = offset;
        return true;
    }
    std::size_t write(const void* bytes, std::size_t size) override {
        const auto* from = static_cast<const char*>(bytes);
        std::size_t before = 0;
        if (!inserted_.empty() && m_pos <= place_ && m_pos + static_cast<int64_t>(size) > place_) {
            before = static_cast<std::size_t>(place_ - m_pos);
            put(from, before);
            put(inserted_.data(), inserted_.size());
            shift_ = static_cast<int64_t>(inserted_.size());
            inserted_.clear();
        }
        put(from + before, size - before);
        if (next_block_ >= 0) count_blocks(from, size);
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

    /// The first error: an errno, or 0.
    [[nodiscard]] int error_number() const { return errno_; }
    /// Passes everything to the system.
    /// @returns  0 or an errno
    [[nodiscard]] int finish() {
        if (!file_) return errno_;
        if (std::fclose(std::exchange(file_, nullptr)) != 0 && !errno_) errno_ = errno;
        return errno_;
    }

  private:
    void put(const char* bytes, std::size_t size) {
        if (errno_ || size == 0) return;
        if (std::fwrite(bytes, 1, size, file_) != size) errno_ = errno ? errno : EIO;
    }

    void count_blocks(const char* bytes, std::size_t size) {
        const int64_t end = m_pos + static_cast<int64_t>(size);
        for (int64_t at = std::max(m_pos, next_block_); at < end && at < next_block_ + 8; ++at) {
            block_[static_cast<std::size_t>(at - next_block_)] =
                static_cast<unsigned char>(bytes[at - m_pos]);
            if (at - next_block_ < 7) continue;
            ++blocks_;
            std::uint32_t rest = 0;
            for (std::size_t i = 8; i-- > 4;)
                rest = rest << 8U | block_[i];
            next_block_ = at + 1 + rest;
            at = next_block_ - 1;
        }
    }

    std::FILE* file_ = nullptr;
    int errno_ = 0;
    int64_t size_ = 0;
    int64_t next_block_ = -1;  // where one begins
    std::array<unsigned char, 8> block_{};
    int blocks_ = 0;
    std::string inserted_;  // not yet
    int64_t place_ = 0;
    int64_t shift_ = 0;  // of what follows it
};

/// Measures the light of rows that hold code values of an HDR display.
class PictureWriter::LightLevelMeter {
  public:
    explicit LightLevelMeter(const Display& display) : to_light_(display.decode) {}

    /// @param type   of the file, whose rounded values count
    /// @param alpha  -1: none
    void add(const ImageBuf& rows, const OIIO::TypeDesc& type, int alpha) {
        const ROI part = rows.roi();
        const auto channels = static_cast<std::size_t>(rows.nchannels());
        const bool is_gray = channels < 3;
        const float most = type == OIIO::TypeDesc::UINT8 ? 255 : 65535;
        const auto width = static_cast<std::size_t>(part.width());
        std::vector<float> pixels(width * channels);
        std::vector<float> rgb(3 * width);
        for (int y = part.ybegin; y < part.yend; ++y) {
            ROI line = part;
            line.ybegin = y;
            line.yend = y + 1;
            rows.get_pixels(line, OIIO::TypeFloat, pixels.data());
            for (std::size_t i = 0; i < width; ++i) {
                const float* pixel = &pixels[i * channels];
                const bool is_hidden = alpha >= 0 && pixel[alpha] <= 0;
                for (std::size_t c = 0; c < 3; ++c) {
                    const float code = is_hidden ? 0 : pixel[is_gray ? 0 : c];
                    rgb[3 * i + c] = std::round(std::clamp(code, 0.0F, 1.0F) * most) / most;
                }
            }
            to_light_.run_rgb(rgb.data(), rgb.data(), width);
            for (std::size_t i = 0; i < width; ++i) {
                const auto light =
                    static_cast<double>(std::max({rgb[3 * i], rgb[3 * i + 1], rgb[3 * i + 2]}));
                largest_ = std::max(largest_, light);
                sum_ += light;
            }
            count_ += static_cast<double>(width);
        }
    }
    [[nodiscard]] LightLevels levels() const {
        return {largest_ * kUnitLuminance, sum_ / std::max(count_, 1.0) * kUnitLuminance};
    }

  private:
    SimdEngine to_light_;
    double largest_ = 0;
    double sum_ = 0;
    double count_ = 0;
};

// ---------------------------------------------------------------------------------------------

std::string date_text(std::time_t seconds) {
    std::tm utc{};
    ::gmtime_r(&seconds, &utc);
    std::array<char, 32> text{};
    (void)std::strftime(text.data(), text.size(), "%Y:%m:%d %H:%M:%S", &utc);
    return text.data();
}

std::string source_date() {
    const char* const value = std::getenv("SOURCE_DATE_EPOCH");
    if (!value || !*value) return {};
    const std::string_view text = value;
    constexpr std::int64_t kYear10000 = 253402300800;  // DateTime has four digits for a year
    std::int64_t seconds = -1;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), seconds);
    if (error != std::errc() || end != text.data() + text.size() || seconds < 0 ||
        seconds >= kYear10000) {
        throw Error(fmt::format("SOURCE_DATE_EPOCH is {}; expected seconds since 1970, [0, {})",
                                text, kYear10000));
    }
    return date_text(static_cast<std::time_t>(seconds));
}

PictureWriter::PictureWriter(const std::string& path, WriteOptions options, int nthreads)
    : path_(path), options_(std::move(options)) {
    temporary_ = std::make_unique<AtomicFile>(path);
    if (!temporary_->refusal().empty()) fail(temporary_->refusal());
    const fs::path& target = temporary_->target();
    out_ = OIIO::ImageOutput::create(target.string());
    if (!out_) {
        fail(target.has_extension() ? first_line(OIIO::geterror())
                                    : "the name has no extension that selects a format");
    }
    out_->threads(nthreads);
    check_compression();
    check_subsampling();
    if (options_.bits > 0 && !format_limits(format()).has_bits) {
        throw Error(
            fmt::format("{}: type is uint{}; expected uint8, uint16, half or float, because "
                        "only DPX has 10 and 12 bits",
                        path_, options_.bits));
    }
}

std::string_view PictureWriter::format() const { return out_->format_name(); }

std::string_view PictureWriter::codec() const {
    const bool is_avif = format() == "heif" &&
                         OIIO::Strutil::iequals(temporary_->target().extension().string(), ".avif");
    return is_avif ? "avif" : format();
}

void PictureWriter::check_compression() const {
    const std::string& text = options_.compression;
    const int quality = options_.quality;
    const FormatCompressions* known = compressions_of(codec());
    const std::size_t colon = std::min(text.find(':'), text.size());
    const std::string name = text.substr(0, colon);
    if (!name.empty()) {
        if (!known) {
            throw Error(
                fmt::format("{}: compression is {}; expected none, because {} has one method only",
                            path_, text, format()));
        }
        if (std::find(known->names.begin(), known->names.end(), name) == known->names.end()) {
            throw Error(fmt::format("{}: compression is {}; expected {}{}", path_, text,
                                    join_choices(known->names), did_you_mean(name, known->names)));
        }
    }
    const bool has_number = colon < text.size();
    if (has_number) {
        const std::string_view digits = std::string_view(text).substr(colon + 1);
        int number = 0;
        const auto [end, error] =
            std::from_chars(digits.data(), digits.data() + digits.size(), number);
        if (error != std::errc() || end != digits.data() + digits.size() || number < 1)
            throw Error(
                fmt::format("{}: compression is {}; expected a quality of 1 or more after "
                            "the colon",
                            path_, text));
    }
    if (quality == 0 && !has_number) return;
    if (quality != 0 && (quality < 1 || quality > 100))
        throw Error(fmt::format("{}: quality is {}; expected [1, 100]", path_, quality));
    const std::vector<std::string> none;
    const std::vector<std::string>& with = known ? known->with_quality : none;
    const bool is_default =
        name.empty() && (format() == "jpeg" || format() == "webp" || format() == "heif");
    if (is_default || std::find(with.begin(), with.end(), name) != with.end()) return;
    throw Error({.what = path_,
                 .parameter = "quality",
                 .value = has_number ? text.substr(colon + 1) : fmt::to_string(quality),
                 .expected = with.empty()
                                 ? fmt::format("none, because {} is lossless", format())
                                 : fmt::format("<<compression={}>> with it", join_choices(with))});
}

void PictureWriter::check_subsampling() const {
    const std::string& text = options_.subsampling;
    if (text.empty()) return;
    if (format() != "jpeg") {
        throw Error(fmt::format("{}: subsampling is {}; expected none, because {}", path_, text,
                                format() == "webp" || format() == "heif"
                                    ? fmt::format("the writer of {} has one kind only (4:2:0)",
                                                  format() == "webp" ? "WebP" : "HEIF and AVIF")
                                    : fmt::format("only JPEG has it, and not {}", format())));
    }
    const std::vector<std::string> names = {"4:4:4", "4:2:2", "4:2:0", "4:1:1"};
    if (std::find(names.begin(), names.end(), text) != names.end()) return;
    throw Error(fmt::format("{}: subsampling is {}; expected {}{}", path_, text,
                            join_choices(names), did_you_mean(text, names)));
}

void PictureWriter::set_compression(ImageSpec& spec) const {
    // The source's compression may be one of another format, or have a quality of its own.
    const FormatCompressions* known = compressions_of(codec());
    const std::string name = spec.get_string_attribute("compression");
    const bool is_known = known && std::find(known->names.begin(), known->names.end(),
                                             name.substr(0, name.find(':'))) != known->names.end();
    if (!is_known || options_.quality > 0) erase_attributes(spec, "compression");
    if (!options_.compression.empty()) spec.attribute("compression", options_.compression);
    if (options_.quality > 0) spec.attribute("CompressionQuality", options_.quality);
    // OpenImageIO selects AV1 by the name of a file, but only without another compression.
    if (codec() == "avif" && options_.compression.empty()) {
        spec.attribute("compression",
                       options_.quality > 0 ? fmt::format("avif:{}", options_.quality) : "avif");
    }
    if (format() != "jpeg") return;
    // Half the resolution of chroma shows most where a thin line is saturated: pure red on black
    // becomes half as bright. ImageMagick and libvips use the same limit.
    constexpr int kFullChromaQuality = 90;
    constexpr int kDefaultQuality = 98;  // of OpenImageIO's writer
    const int quality = spec.decode_compression_metadata("jpeg", kDefaultQuality).second;
    spec.attribute("jpeg:subsampling", !options_.subsampling.empty()   ? options_.subsampling
                                       : quality >= kFullChromaQuality ? "4:4:4"
                                                                       : "4:2:0");
}

PictureWriter::~PictureWriter() = default;

void PictureWriter::fail(const std::string& reason) const {
    fail(Problem{.kind = Problem::Kind::file, .value = reason});
}

void PictureWriter::fail(const Problem& why) const {
    throw FileError(within(path_ + ": cannot write", why));
}

void PictureWriter::check_disk() const {
    if (proxy_ && proxy_->error_number()) fail(problem_of_system(proxy_->error_number()));
}

ImageBuf PictureWriter::checked(ImageBuf&& changed) const {
    if (changed.has_error()) fail(problem_of_library(changed.geterror()));
    return std::move(changed);
}

ImageBuf PictureWriter::select_channels(const ImageBuf& picture) const {
    const std::vector<float> opaque(channels_.size(), 1.0F);
    std::vector<std::string> names;
    const bool becomes_rgb = channels_.size() >= 3 && channels_[0] == channels_[1];
    for (std::size_t c = 0; c < channels_.size(); ++c) {
        const bool is_new = (becomes_rgb && c < 3) || channels_[c] < 0;
        constexpr std::array kNew = {'R', 'G', 'B', 'A'};
        names.push_back(is_new ? std::string(1, kNew.at(c))
                               : std::string(picture.spec().channel_name(channels_[c])));
    }
    ImageBuf selected = checked(OIIO::ImageBufAlgo::channels(
        picture, static_cast<int>(channels_.size()), channels_, opaque, names));
    const auto alpha = std::find(channels_.begin(), channels_.end(), picture.spec().alpha_channel);
    selected.specmod().alpha_channel =
        alpha == channels_.end() ? -1 : static_cast<int>(alpha - channels_.begin());
    return selected;
}

void PictureWriter::plan_alpha(ImageSpec& spec) {
    using Alpha = WriteOptions::Alpha;
    const bool is_straight =
        spec.alpha_channel >= 0 && spec.get_int_attribute("oiio:UnassociatedAlpha", 0) != 0;
    const FileAlpha kind = format_limits(format()).alpha;
    const bool keeps = kind == FileAlpha::straight || kind == FileAlpha::either;
    multiplies_by_alpha_ =
        is_straight && (options_.alpha == Alpha::over || (options_.alpha == Alpha::keep && !keeps));
    if (multiplies_by_alpha_ || spec.alpha_channel < 0 || options_.alpha == Alpha::ignore)
        erase_attributes(spec, "oiio:UnassociatedAlpha");
}

ImageSpec PictureWriter::plan(const ImageSpec& picture) {
    ImageSpec spec = picture;
    spec.tile_width = spec.tile_height = spec.tile_depth = 0;  // those of the file it came from
    spec.channelformats.clear();
    // A single level is not a texture: OpenEXR's writer would wait for the others.
    if (spec.get_string_attribute("textureformat") == "Plain Texture")
        erase_attributes(spec, "textureformat");
    const bool is_over = options_.alpha == WriteOptions::Alpha::over && spec.alpha_channel >= 0;
    const std::array<float, 3>& back = options_.background;
    if (is_over && spec.nchannels < 3 && (back[0] != back[1] || back[1] != back[2])) {
        fail(
            fmt::format("alpha is over:{},{},{}; expected three equal numbers, because the picture "
                        "is gray",
                        back[0], back[1], back[2]));
    }
    plan_alpha(spec);
    const FormatLimits& limits = format_limits(format());
    channels_ =
        file_channels(spec, limits, options_.alpha == WriteOptions::Alpha::ignore || is_over);
    if (channels_.empty())
        fail(fmt::format("the picture is in color; expected gray for {}", limits.title));
    std::vector<int> all(static_cast<std::size_t>(spec.nchannels));
    std::iota(all.begin(), all.end(), 0);
    if (channels_ == all) channels_.clear();
    if (!channels_.empty()) {
        // One pixel shows the format's names and order of channels.
        ImageSpec pixel = spec;
        pixel.width = pixel.height = pixel.depth = 1;
        pixel = select_channels(ImageBuf(pixel)).spec();
        pixel.width = spec.width;
        pixel.height = spec.height;
        pixel.depth = spec.depth;
        spec = std::move(pixel);
    }

    // Viewers show the display window. Formats without data windows store only that.
    const ROI window = picture.roi_full();
    const ROI data = picture.roi();
    last_row_ = data.yend;
    next_row_ = data.ybegin;
    const bool same = window.xbegin == data.xbegin && window.xend == data.xend &&
                      window.ybegin == data.ybegin && window.yend == data.yend;
    const bool is_kept = limits.windows == FileWindows::all ||
                         (limits.windows == FileWindows::not_negative && data.xbegin >= 0 &&
                          data.ybegin >= 0 && window.xbegin == 0 && window.ybegin == 0 &&
                          window.xend >= data.xend && window.yend >= data.yend);
    if (!same && !is_kept) {
        const double most = std::max(options_.max_pixels, 4 * static_cast<double>(data.npixels()));
        if (static_cast<double>(window.npixels()) > most) {
            throw FileError(
                {.what = path_ + ": cannot write",
                 .value =
                     fmt::format("the display window is {} x {} pixels, the data window {} x {}",
                                 window.width(), window.height(), data.width(), data.height()),
                 .expected = fmt::format(
                     "at most {:.0f} pixels (<<max_pixels>>) to fill with black", most)});
        }
        window_ = window;
        window_->chbegin = 0;
        window_->chend = spec.nchannels;
        next_row_ = window.ybegin;
        spec.x = spec.y = spec.z = spec.full_x = spec.full_y = spec.full_z = 0;
        spec.width = spec.full_width = window.width();
        spec.height = spec.full_height = window.height();
        spec.depth = spec.full_depth = window.depth();
    }

    if (const std::string refusal = size_refusal(limits, spec.width, spec.height); !refusal.empty())
        fail(refusal);

    // OIIO's writers divide integers, rounding down, and for "Gamma2.2" and similar spaces some
    // divide by a power of alpha: 0.25 of 0.5 becomes 1.
    const bool is_associated =
        spec.alpha_channel >= 0 && spec.get_int_attribute("oiio:UnassociatedAlpha", 0) == 0;
    divides_by_alpha_ = is_associated && limits.alpha == FileAlpha::straight;
    if (divides_by_alpha_) spec.attribute("oiio:UnassociatedAlpha", 1);
    // Displays end at 1, light does not: above it, an opaque surface is clipped, too.
    const std::optional<TaggedColor> shown = tagged_color(picture);
    const bool is_light = shown && shown->curve && shown->curve->exponent == 1;
    surface_light_ = is_light ? static_cast<float>(kMostSurfaceLight) : 1.0F;
    becomes_straight_ =
        divides_by_alpha_ || (is_associated && limits.alpha == FileAlpha::straight_by_writer);
    alpha_ = spec.alpha_channel < spec.nchannels ? spec.alpha_channel : -1;
    // OpenEXR's viewers show color with zero alpha, and elements such as flames have nothing else.
    watches_cover_ =
        alpha_ >= 0 && options_.alpha == WriteOptions::Alpha::keep && format() != "openexr";

    OIIO::TypeDesc type = limits.is_8_bit ? OIIO::TypeDesc::UINT8 : options_.type;
    const std::optional<TaggedColor> color = tagged_color(picture);
    // ITU-R BT.2100-2 has 10 and 12 bits: 8 show bands.
    if (type == OIIO::TypeUnknown && format() == "png" && color && color->code_points &&
        picture.format.is_floating_point()) {
        type = OIIO::TypeDesc::UINT16;
    }
    spec.set_format(type == OIIO::TypeUnknown ? picture.format : type);
    if (type != OIIO::TypeUnknown)
        erase_attributes(spec, "oiio:BitsPerSample");  // overrules the type
    if (options_.bits > 0) spec.attribute("oiio:BitsPerSample", options_.bits);
    set_compression(spec);
    if (format() != "openexr") {  // the only format whose color tags they are
        erase_attributes(spec, "colorInteropID");
        if (format() != "png" || !options_.write_provenance) erase_attributes(spec, "tonewright:*");
    }
    return spec;
}

ImageSpec PictureWriter::file_spec(const ImageSpec& picture) {
    ImageSpec spec = plan(picture);
    if (out_->supports("ioproxy") == 0) {
        spec.format = OIIO::TypeUnknown;
        return spec;
    }
    // Formats lack some types. One pixel in memory shows the replacement.
    std::vector<unsigned char> memory;
    OIIO::Filesystem::IOVecOutput proxy(memory);
    const std::string name = temporary_->path().string();
    const auto out = OIIO::ImageOutput::create(name);
    const ImageSpec pixel(1, 1, spec.nchannels, spec.format);
    const std::vector<float> black(static_cast<std::size_t>(spec.nchannels));
    out->set_ioproxy(&proxy);
    if (!out->open(name, pixel)) fail(problem_of_library(out->geterror()));
    spec.format = out->spec().format;
    out->write_scanline(0, 0, OIIO::TypeFloat, black.data());
    out->close();
    return spec;
}

void PictureWriter::open(const ImageSpec& picture) {
    if (const int error = temporary_->check_target()) fail(problem_of_system(error));
    ImageSpec spec = plan(picture);
    // These writers record the time of writing.
    if (format() == "openexr" || format() == "tiff" || format() == "dpx") {
        if (const std::string date = source_date();
            !date.empty() && !spec.find_attribute("DateTime"))
            spec.attribute("DateTime", date);
    }
    const ColorDescription color = describe_color(spec, format());
    if (!color.icc.empty()) {
        spec.attribute("ICCProfile",
                       OIIO::TypeDesc(OIIO::TypeDesc::UINT8, static_cast<int>(color.icc.size())),
                       color.icc.data());
    }
    // libtiff reads its own directories again if there is an EXIF directory (as in a picture tagged
    // sRGB), and a proxy for writing cannot be read: the file would lack its first directory.
    std::string name = temporary_->path().string();
    if (out_->supports("ioproxy") && format() != "tiff") {
        proxy_ = std::make_unique<FileProxy>(*temporary_);
        check_disk();
        if (!color.chunk.empty()) {
            // The levels are known at the end: until then, a chunk without light has their place.
            proxy_->insert(kAfterPngHeader, color.chunk + clli_chunk({}));
            light_levels_place_ = kAfterPngHeader + color.chunk.size();
            light_levels_ =
                std::make_unique<LightLevelMeter>(find_display(tagged_color(spec)->name));
        }
        out_->set_ioproxy(proxy_.get());
        name = fs::path(path_).filename().string();
    } else {
        // Opens this file, and not a link that another program put there.
        const int file = temporary_->create();
        if (file < 0) fail(problem_of_system(errno));
        ::close(file);
    }
    const bool is_open = [&] {
        const FileCreation creation;  // the writer may open the file by its name
        return out_->open(name, spec);
    }();
    if (!is_open) fail(problem_of_library(out_->geterror()));
    if (proxy_ && format() == "openexr") {
        rows_of_block_ = rows_of_block(out_->spec().get_string_attribute("compression", "zip"));
        proxy_->begin_blocks();
    }
    warn_of_limits(spec, color.missing);
    if (const std::string text = cut_off(picture); options_.warn && !text.empty())
        options_.warn(text);
}

void PictureWriter::warn_of_limits(const ImageSpec& requested, const std::string& missing) const {
    if (!options_.warn) return;
    std::vector<std::string> limits;
    if (!missing.empty()) limits.push_back(missing);
    const OIIO::TypeDesc type = out_->spec().format;
    if (options_.type != OIIO::TypeUnknown && options_.type != type && format() != "null") {
        limits.push_back(
            fmt::format("pixels are {}, not {}", title_of(type), title_of(options_.type)));
    }
    const std::optional<TaggedColor> color = tagged_color(requested);
    if (color && color->code_points && type == OIIO::TypeDesc::UINT8) {
        limits.emplace_back("gradients in 8 bits show bands");
    }
    if (!limits.empty()) options_.warn(fmt::format("{}", fmt::join(limits, "; ")));
}

/// "the data window ... lies outside the display window"; empty if nothing is cut off.
std::string PictureWriter::cut_off(const ImageSpec& picture) const {
    const ROI data = picture.roi();
    ROI shown = window_ ? OIIO::roi_intersection(data, picture.roi_full()) : data;
    shown.chbegin = data.chbegin;
    shown.chend = data.chend;
    const double lost =
        shown.width() > 0 && shown.height() > 0 && shown.depth() > 0
            ? 1 - static_cast<double>(shown.npixels()) / static_cast<double>(data.npixels())
            : 1;
    if (lost <= 0) return {};
    if (lost >= 1) {
        return fmt::format(
            "all of the data window lies outside the display window, so the picture "
            "is black; {} has no data window",
            format());
    }
    return fmt::format(
        "{} % of the data window lies outside the display window and is left out; {} has no data "
        "window",
        percent_text(lost), format());
}

void PictureWriter::watch_cover(const ImageBuf& rows) {
    if (!watches_cover_ || (has_cover_ && !becomes_straight_)) return;
    ROI line = rows.roi();
    line.zend = line.zbegin + 1;
    const auto channels = static_cast<std::size_t>(rows.nchannels());
    const auto colors = std::min(alpha_, 3);
    // Operators lift black by up to two codes of 8 bits (AgX: 0.7), also where nothing is.
    constexpr float kVisible = 2.0F / 255;
    std::vector<float> pixels(static_cast<std::size_t>(line.width()) * channels);
    for (int y = rows.ybegin(); y < rows.yend(); ++y) {
        line.ybegin = y;
        line.yend = y + 1;
        rows.get_pixels(line, OIIO::TypeFloat, pixels.data());
        for (std::size_t i = 0; i < pixels.size(); i += channels) {
            const float alpha = pixels[i + static_cast<std::size_t>(alpha_)];
            if (alpha != 0) has_cover_ = true;
            const float* const color = &pixels[i];
            const float most = *std::max_element(color, color + colors);
            const float carried = surface_light_ * std::max(alpha, 0.0F);
            if (alpha < 1 && most > carried + kVisible) ++lost_count_;
        }
        pixel_count_ += line.width();
    }
}

void PictureWriter::warn_of_cover() const {
    if (!watches_cover_ || !options_.warn) return;
    if (!has_cover_) {
        options_.warn(
            "alpha is 0 everywhere, so viewers show nothing; <<alpha=ignore>> leaves it out, "
            "<<alpha=opaque>> makes it 1");
    } else if (becomes_straight_ && lost_count_ > 0) {
        options_.warn(
            fmt::format("{} % of the pixels have more light than their alpha carries (flames, "
                        "glass), and {} cannot hold it; <<alpha=opaque>> or ignore keeps it, as "
                        "does EXR",
                        percent_text(lost_count_ / std::max(pixel_count_, 1.0)), format()));
    }
}

ImageBuf PictureWriter::over_background(const ImageBuf& rows) const {
    ImageBuf result = rows.copy(OIIO::TypeFloat);
    const int alpha = rows.spec().alpha_channel;
    const int colors = std::min(alpha, 3);
    const std::array<float, 3>& background = options_.background;
    for (ImageBuf::Iterator<float> p(result); !p.done(); ++p) {
        const float cover = std::isfinite(p[alpha]) ? std::clamp<float>(p[alpha], 0, 1) : 0;
        for (int c = 0; c < colors; ++c)
            p[c] = p[c] + (1 - cover) * background[static_cast<std::size_t>(c)];
    }
    return result;
}

OIIO::TypeDesc PictureWriter::row_type() const {
    return out_->spec().format == OIIO::TypeHalf && !divides_by_alpha_ && !multiplies_by_alpha_
               ? OIIO::TypeHalf
               : OIIO::TypeFloat;
}

bool PictureWriter::keeps_orientation() const { return format() == "jpeg" || format() == "tiff"; }

bool PictureWriter::is_bottom_up() const {
    return format() == "openexr" &&
           out_->spec().get_string_attribute("openexr:lineOrder") == "decreasingY";
}

void PictureWriter::write_rows(const ImageBuf& rows) {
    ImageBuf changed;
    const ImageBuf* fitted = &rows;
    const auto change = [&](ImageBuf&& to) {
        changed = checked(std::move(to));
        fitted = &changed;
    };
    if (multiplies_by_alpha_) {
        ImageBuf associated = fitted->copy(OIIO::TypeFloat);
        multiply_by_alpha(associated);
        change(std::move(associated));
    }
    if (options_.alpha == WriteOptions::Alpha::over && fitted->spec().alpha_channel >= 0)
        change(over_background(*fitted));
    if (!channels_.empty()) {
        change(select_channels(*fitted));
    }
    watch_cover(*fitted);
    if (alpha_ >= 0 && options_.alpha == WriteOptions::Alpha::opaque) {
        ImageBuf opaque = fitted->copy(fitted->spec().format);
        ROI cover = opaque.roi();
        cover.chbegin = alpha_;
        cover.chend = alpha_ + 1;
        const std::vector<float> one(static_cast<std::size_t>(opaque.nchannels()), 1.0F);
        OIIO::ImageBufAlgo::fill(opaque, one, cover);
        change(std::move(opaque));
    }
    if (!window_) {
        write_part(*fitted);
        return;
    }
    // Adds the black rows above the first and below the last, some at a time.
    const int data_end = rows.roi().yend;
    const int end = data_end == last_row_ ? window_->yend : std::min(data_end, window_->yend);
    const std::size_t row_bytes = static_cast<std::size_t>(window_->width()) *
                                  static_cast<std::size_t>(window_->nchannels()) * sizeof(float);
    const int step = rows_of_batch(row_bytes, 1, window_->height());
    while (next_row_ < end) {
        ROI part = *window_;
        part.ybegin = next_row_;
        part.yend = std::min(next_row_ + step, end);
        next_row_ = part.yend;
        ImageBuf shown = checked(OIIO::ImageBufAlgo::cut(*fitted, part));
        shown.set_origin(0, part.ybegin - window_->ybegin);
        write_part(shown);
    }
}

void PictureWriter::write_part(const ImageBuf& rows) {
    if (!divides_by_alpha_) {
        write_fitted(rows);
        return;
    }
    ImageBuf divided = rows.copy(OIIO::TypeFloat);
    OIIO::ImageBufAlgo::unpremult(divided, divided);
    write_fitted(checked(std::move(divided)));
}

void PictureWriter::write_fitted(const ImageBuf& rows) {
    const ROI part = rows.roi();
    if (options_.verifies) {
        const ImageSpec& file = out_->spec();
        kept_.resize(static_cast<std::size_t>(file.width) * static_cast<std::size_t>(file.height) *
                     static_cast<std::size_t>(file.nchannels));
        const std::size_t at = static_cast<std::size_t>(part.ybegin - file.y) *
                               static_cast<std::size_t>(file.width) *
                               static_cast<std::size_t>(file.nchannels);
        rows.get_pixels(part, OIIO::TypeFloat, &kept_[at]);
    }
    if (light_levels_) light_levels_->add(rows, out_->spec().format, alpha_);
    bool written = false;
    if (format() == "heif") {
        // OpenImageIO 2.4 copies rows as long as libheif's, which have padding: the last one needs
        // something behind it.
        constexpr std::size_t kPadding = 1024;
        const OIIO::TypeDesc type = out_->spec().format;
        const std::size_t values =
            static_cast<std::size_t>(part.npixels()) * static_cast<std::size_t>(rows.nchannels());
        std::vector<std::byte> pixels(values * type.size() + kPadding);
        written = rows.get_pixels(part, type, pixels.data()) &&
                  out_->write_scanlines(part.ybegin, part.yend, part.zbegin, type, pixels.data());
    } else if (part.height() == out_->spec().height) {
        written = rows.write(out_.get());
    } else {
        written =
            out_->write_scanlines(part.ybegin, part.yend, part.zbegin, rows.spec().format,
                                  rows.localpixels(), rows.pixel_stride(), rows.scanline_stride());
    }
    check_disk();
    if (!written) fail(problem_of_library(rows.has_error() ? rows.geterror() : out_->geterror()));
    rows_written_ += part.height();
    check_blocks();
}

void PictureWriter::check_blocks() const {
    if (rows_of_block_ == 0) return;
    const int height = out_->spec().height;
    const int first = is_bottom_up() ? (height - 1) % rows_of_block_ + 1 : rows_of_block_;
    int complete = rows_written_ < first ? 0 : 1 + (rows_written_ - first) / rows_of_block_;
    if (rows_written_ == height) complete = (height - 1) / rows_of_block_ + 1;
    if (proxy_->blocks() < complete)
        fail("OpenEXR could not compress all rows (not enough memory?)");
}

void PictureWriter::check_written(const ImageSpec& requested, std::string_view file_format,
                                  bool is_avif) const {
    if (is_avif && !brand_of(temporary_->path()).starts_with("avi")) {
        fail(
            "this OpenImageIO writes HEVC under the name of AVIF, not AV1; write a PNG file, and "
            "use avifenc");
    }
    if (file_format == "null" || file_format == "term") return;
    std::optional<PictureReader> written;
    try {
        written.emplace(temporary_->path().string(), 0, ReadOptions{.max_pixels = kUnlimited});
    } catch (const FileError& e) {
        // Writers without our own file do not report a full disk.
        fail(fmt::format("what was written cannot be read back{}: {}",
                         has_proxy_ ? "" : " (disk full?)",
                         without_name(e.what(), temporary_->path().string())));
    }
    const ImageSpec& is = written->spec();
    const auto differs = [&](const char* what, const auto& found, const auto& expected) {
        fail(fmt::format("what was written reads back with {} {}; expected {}", what, found,
                         expected));
    };
    if (is.width != requested.width || is.height != requested.height) {
        differs("size", fmt::format("{} x {}", is.width, is.height),
                fmt::format("{} x {}", requested.width, requested.height));
    }
    // The reader of GIF adds alpha, and that of FITS has only signed integers.
    const bool adds_alpha = file_format == "gif" && is.nchannels == requested.nchannels + 1;
    const bool drops_alpha = file_format == "webp" && is.nchannels == requested.nchannels - 1;
    if (is.nchannels != requested.nchannels && !adds_alpha && !drops_alpha)
        differs("channels", is.nchannels, requested.nchannels);
    if (is.format != requested.format && file_format != "fits")
        differs("type", is.format.c_str(), requested.format.c_str());
    if (format_limits(file_format).windows != FileWindows::none &&
        (is.x != requested.x || is.y != requested.y || is.full_width != requested.full_width ||
         is.full_height != requested.full_height)) {
        differs(
            "window",
            fmt::format("{}+{}+{} of {} x {}", is.width, is.x, is.y, is.full_width, is.full_height),
            fmt::format("{}+{}+{} of {} x {}", requested.width, requested.x, requested.y,
                        requested.full_width, requested.full_height));
    }
    if (options_.verifies) {
        check_pixels(*written, requested, file_format);
    } else if (!has_proxy_) {
        try {
            check_is_complete(*written);  // there is no other proof
        } catch (const FileError&) {
            fail("what was written cannot be read back (disk full?)");
        }
    }
}

void PictureWriter::check_pixels(PictureReader& written, const ImageSpec& requested,
                                 std::string_view file_format) const {
    const ImageBuf is = [&] {
        try {
            return written.read_all().copy(OIIO::TypeFloat);
        } catch (const FileError& e) {
            // Writers without our own file do not report a full disk.
            fail(fmt::format("what was written cannot be read back{}: {}",
                             has_proxy_ ? "" : " (disk full?)",
                             without_name(e.what(), temporary_->path().string())));
        }
    }();
    const std::string compression = requested.get_string_attribute("compression");
    constexpr std::array<std::string_view, 7> kLossless = {"none", "rle", "zip",     "zips",
                                                           "piz",  "lzw", "packbits"};
    const bool is_lossless_exr =
        compression.empty() ||
        std::find(kLossless.begin(), kLossless.end(), compression) != kLossless.end();
    constexpr std::array<std::string_view, 9> kExact = {"png", "targa", "bmp", "sgi", "dpx",
                                                        "pnm", "rla",   "ico", "iff"};
    const bool is_exact = std::find(kExact.begin(), kExact.end(), file_format) != kExact.end() ||
                          (is_lossless_exr && (file_format == "openexr" || file_format == "tiff"));
    const OIIO::TypeDesc type = requested.format;
    const bool is_integer = !type.is_floating_point();
    // One code value: half for rounding, half for dither.
    const int bits = options_.bits > 0 ? options_.bits : static_cast<int>(8 * type.size());
    const double step = 1.001 / (std::exp2(bits) - 1);
    const int channels = std::min(is.nchannels(), requested.nchannels);
    std::vector<float> pixel(static_cast<std::size_t>(is.nchannels()));
    double worst = 0;
    // Compression changes pixels, but hardly the sums of blocks.
    constexpr int kBlock = 8;
    const int columns = (requested.width + kBlock - 1) / kBlock;
    const int block_rows = (requested.height + kBlock - 1) / kBlock;
    std::vector<double> sums(static_cast<std::size_t>(columns) *
                             static_cast<std::size_t>(block_rows) *
                             static_cast<std::size_t>(channels));
    for (ImageBuf::ConstIterator<float> p(is); !p.done(); ++p) {
        const std::size_t at = (static_cast<std::size_t>(p.y() - requested.y) *
                                    static_cast<std::size_t>(requested.width) +
                                static_cast<std::size_t>(p.x() - requested.x)) *
                               static_cast<std::size_t>(requested.nchannels);
        for (int c = 0; c < channels; ++c) {
            auto should = static_cast<double>(kept_[at + static_cast<std::size_t>(c)]);
            if (is_integer || !is_exact) should = std::clamp(should, 0.0, 1.0);
            const double found = is_exact ? static_cast<double>(p[c])
                                          : std::clamp(static_cast<double>(p[c]), 0.0, 1.0);
            const double allowed = is_integer                     ? step
                                   : type == OIIO::TypeDesc::HALF ? std::fabs(should) / 1024 + 1e-7
                                                                  : std::fabs(should) * 1e-6;
            const double difference = std::fabs(found - should);
            worst = std::max(worst, difference > allowed || std::isnan(difference)
                                        ? std::max(difference, 1e-9)
                                        : 0);
            const int block =
                (p.y() - requested.y) / kBlock * columns + (p.x() - requested.x) / kBlock;
            sums[static_cast<std::size_t>(block) * static_cast<std::size_t>(channels) +
                 static_cast<std::size_t>(c)] += found - should;
        }
    }
    // Bound of the loss by compression of the lowest quality. Channels in another order, rows at
    // another place and black pictures lose more.
    constexpr double kLossyMean = 0.1;
    const double sum = std::accumulate(sums.begin(), sums.end(), 0.0,
                                       [](double all, double x) { return all + std::fabs(x); });
    const double mean = sum / (static_cast<double>(kept_.size()) + 1e-9);
    if (is_exact && worst > 0)
        fail(fmt::format("what was written reads back with pixels that differ by {:.3g}", worst));
    // GIF has 256 colors, and alpha of one bit.
    if (!is_exact && file_format != "gif" && !(mean <= kLossyMean)) {
        fail(fmt::format("what was written reads back with pixels that differ by {:.3g} on average",
                         mean));
    }
}

void PictureWriter::finish() {
    warn_of_cover();
    const bool is_avif = codec() == "avif";
    const std::string file_format(format());
    const ImageSpec requested = out_->spec();
    if (!out_->close()) fail(problem_of_library(out_->geterror()));
    out_.reset();  // some write their last bytes only now
    if (light_levels_) proxy_->patch(light_levels_place_, clli_chunk(light_levels_->levels()));
    if (proxy_) {
        if (const int error = proxy_->finish()) fail(problem_of_system(error));
        has_proxy_ = true;
    }
    check_written(requested, file_format, is_avif);
    if (const int error = temporary_->keep()) fail(problem_of_system(error));
    // Readers that use OIIO's shared cache get the new file.
    auto cache = OIIO::ImageCache::create(true);  // a pointer, or since 3.0 a shared one
    if (!cache) return;                           // no memory for a first one
    cache->invalidate(OIIO::ustring(path_));
    OIIO::ImageCache::destroy(cache);
}

TONEWRIGHT_NAMESPACE_END
