// SPDX-License-Identifier: Apache-2.0
#include "picture/header_tags.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <fstream>
#include <optional>
#include <span>
#include <sstream>

#include "base/format_number.h"
#include "base/strings.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

using OIIO::TypeDesc;

/// No profile of a picture is longer. A chunk that declares more is skipped.
constexpr std::uint64_t kLongestBlock = std::uint64_t{64} << 20;
/// Headers with more blocks are hostile.
constexpr int kMostBlocks = 100000;

/// A file that is read block by block. Past its end, everything is 0 and ok() is false.
class HeaderFile {
  public:
    explicit HeaderFile(const std::string& path) : file_(path, std::ios::binary) {
        file_.seekg(0, std::ios::end);
        size_ = static_cast<std::uint64_t>(std::max<std::streamoff>(file_.tellg(), 0));
        file_.seekg(0);
    }
    [[nodiscard]] bool ok() const { return static_cast<bool>(file_); }
    [[nodiscard]] std::uint64_t size() const { return size_; }
    [[nodiscard]] std::uint64_t position() {
        return static_cast<std::uint64_t>(std::max<std::streamoff>(file_.tellg(), 0));
    }
    bool seek(std::uint64_t to) {
        if (to > size_) return false;
        file_.seekg(static_cast<std::streamoff>(to));
        return ok();
    }
    /// The next bytes; empty if there are not so many, or too many.
    std::string bytes(std::uint64_t count) {
        if (count > kLongestBlock || position() + count > size_) {
            file_.setstate(std::ios::failbit);
            return {};
        }
        std::string text(count, '\0');
        file_.read(text.data(), static_cast<std::streamsize>(count));
        return ok() ? text : std::string();
    }
    std::uint64_t number(unsigned count, bool is_little) {
        return parse(bytes(count), 0, count, is_little);
    }
    /// 0 where the text is too short.
    static std::uint64_t parse(std::string_view text, std::size_t at, unsigned count,
                               bool is_little) {
        std::uint64_t value = 0;
        if (at + count > text.size()) return 0;
        for (unsigned i = 0; i < count; ++i) {
            const std::size_t byte = is_little ? at + count - 1 - i : at + i;
            value = value << 8U | static_cast<unsigned char>(text[byte]);
        }
        return value;
    }
    std::string line() {
        std::string text;
        std::getline(file_, text);
        return text;
    }
    /// Text that ends with a byte 0; names of OpenEXR have 255 characters at most.
    std::string name() {
        std::array<char, 256> text{};
        file_.getline(text.data(), text.size(), '\0');
        return text.data();
    }

  private:
    std::ifstream file_;
    std::uint64_t size_ = 0;
};

void set_bytes(PictureSpec& spec, const char* name, const std::string& bytes) {
    if (bytes.empty()) return;
    spec.attribute(name, TypeDesc(TypeDesc::UINT8, static_cast<int>(bytes.size())), bytes.data());
}

/// An Exif block, which is a small TIFF file: JEITA CP-3451, 4.5.
class ExifBlock {
  public:
    explicit ExifBlock(std::string_view bytes) : bytes_(bytes) {
        if (bytes_.starts_with(std::string_view("Exif\0\0", 6))) bytes_.remove_prefix(6);
        is_little_ = bytes_.starts_with("II");
    }
    /// The directory that the header names.
    [[nodiscard]] std::uint64_t first() const { return number(4, 4); }
    /// Place of a tag's entry in a directory; 0: none.
    [[nodiscard]] std::size_t find(std::uint64_t directory, std::uint64_t tag) const {
        if (!(is_little_ || bytes_.starts_with("MM")) || directory > bytes_.size()) return 0;
        const std::uint64_t count = number(directory, 2);
        for (std::uint64_t i = 0; i < count; ++i) {
            const std::size_t at = directory + 2 + 12 * i;
            if (number(at, 2) == tag) return at;
        }
        return 0;
    }
    [[nodiscard]] std::uint64_t number(std::size_t at, unsigned count) const {
        return HeaderFile::parse(bytes_, at, count, is_little_);
    }
    [[nodiscard]] std::string_view text(std::size_t at, std::size_t count) const {
        return at < bytes_.size() ? bytes_.substr(at, count) : std::string_view();
    }

  private:
    std::string_view bytes_;
    bool is_little_ = false;
};

/// OpenImageIO 2.4 does not read the block in PNG and WebP.
void read_orientation(std::string_view exif, PictureSpec& spec) {
    const ExifBlock block(exif);
    constexpr std::uint64_t kOrientation = 274;
    if (const std::size_t at = block.find(block.first(), kOrientation))
        spec.attribute("Orientation", static_cast<int>(block.number(at + 8, 2)));
}

/// The index of the interoperability directory, which OpenImageIO does not read: "R03" is DCF's
/// optional color space, Adobe RGB.
void read_interoperability(std::string_view exif, PictureSpec& spec) {
    const ExifBlock block(exif);
    constexpr std::uint64_t kExif = 0x8769;
    constexpr std::uint64_t kInteroperability = 0xA005;
    const std::size_t pointer = block.find(block.first(), kExif);
    if (pointer == 0) return;
    const std::size_t inner = block.find(block.number(pointer + 8, 4), kInteroperability);
    if (inner == 0) return;
    const std::size_t index = block.find(block.number(inner + 8, 4), 1);
    if (index != 0)
        spec.attribute("Exif:InteroperabilityIndex", std::string(block.text(index + 8, 3)));
}

void set_primaries(PictureSpec& spec, const char* name, const std::array<float, 8>& xy) {
    spec.attribute(name, TypeDesc(TypeDesc::FLOAT, 8), xy.data());
}

/// W3C PNG (third edition), 11.3.2: everything that states color comes before the first IDAT. The
/// block of Exif comes after the pixels in files of older programs (PNG extensions 1.5.0).
void read_png(HeaderFile& file, PictureSpec& spec) {
    (void)file.bytes(8);
    std::array<float, 8> white_first{};
    bool has_chroma = false;
    bool is_after_pixels = false;
    for (int i = 0; i < kMostBlocks && file.ok(); ++i) {
        const std::uint64_t length = file.number(4, false);
        const std::string type = file.bytes(4);
        const std::uint64_t next = file.position() + length + 4;
        if (type == "IEND" || !file.ok()) break;
        is_after_pixels = is_after_pixels || type == "IDAT";
        constexpr std::array kColor = {"cICP", "iCCP", "sRGB", "gAMA", "cHRM"};
        if (is_after_pixels && type != "eXIf") {
            if (std::find(kColor.begin(), kColor.end(), type) != kColor.end())
                add_ignored(spec, type + ": it comes after the pixels, where PNG has no colors");
            if (!file.seek(next)) break;
            continue;
        }
        constexpr std::array kRead = {"cICP", "sRGB", "gAMA", "cHRM", "acTL", "eXIf"};
        std::string data;
        if (std::find(kRead.begin(), kRead.end(), type) != kRead.end()) data = file.bytes(length);
        const auto u32 = [&](std::size_t at) { return HeaderFile::parse(data, at, 4, false); };
        if (type == "cICP" && data.size() == 4) {
            std::array<int, 4> points{};
            for (std::size_t k = 0; k < 4; ++k)
                points[k] = static_cast<unsigned char>(data[k]);
            constexpr int kUnspecified = 2;
            if (points[0] == kUnspecified && points[1] == kUnspecified) {
                add_ignored(spec, "cICP: 2/2 (unspecified) states no color");
            } else {
                spec.attribute(kCicpTag, TypeDesc(TypeDesc::INT, 4), points.data());
            }
        } else if (type == "iCCP" && !spec.find_attribute("ICCProfile")) {
            add_ignored(spec, "iCCP: the ICC profile is damaged");
        } else if (type == "sRGB" && data.size() == 1) {
            spec.attribute(file_tag::kSrgb, static_cast<int>(data[0]));
        } else if (type == "gAMA" && data.size() == 4 && u32(0) > 0) {
            spec.attribute(file_tag::kGamma, static_cast<float>(1e5 / static_cast<double>(u32(0))));
        } else if (type == "cHRM" && data.size() == 32) {
            for (std::size_t k = 0; k < 8; ++k)
                white_first[k] = static_cast<float>(static_cast<double>(u32(4 * k)) * 1e-5);
            has_chroma = true;
        } else if (type == "acTL" && data.size() == 8 && u32(0) > 1) {
            add_ignored(spec, fmt::format("acTL: the picture is the first of {} frames", u32(0)));
        } else if (type == "eXIf" && !data.empty()) {
            read_orientation(data, spec);
        }
        if (!file.seek(next)) break;
    }
    if (has_chroma) {
        const auto& w = white_first;
        set_primaries(spec, file_tag::kPrimaries, {w[2], w[3], w[4], w[5], w[6], w[7], w[0], w[1]});
    }
}

/// Numbers of a line of a Radiance header.
std::vector<double> numbers_of(std::string_view text) {
    std::vector<double> numbers;
    std::istringstream words{std::string(text)};
    words.imbue(std::locale::classic());
    for (double value = 0; words >> value;)
        numbers.push_back(value);
    return numbers;
}

/// Stops of a factor, signed.
std::string stops_of(double factor) { return fmt::format("{:+.2f}", std::log2(factor)); }

/// Radiance: G. Ward, "Radiance File Formats" (filefmts.pdf), "Picture File Format".
void read_radiance(HeaderFile& file, PictureSpec& spec) {
    double exposure = 1;
    std::array<double, 3> correction = {1, 1, 1};
    std::vector<double> primaries;
    bool is_xyz = false;
    constexpr int kMostLines = 1000;
    for (int i = 0; i < kMostLines && file.ok(); ++i) {
        const std::string line = file.line();
        const std::string_view text = trimmed(line);
        if (text.empty()) break;
        const auto value_of = [&](std::string_view name) -> std::optional<std::string_view> {
            if (!text.starts_with(name)) return std::nullopt;
            const std::string_view rest = trimmed(text.substr(name.size()));
            if (!rest.starts_with('=')) return std::nullopt;
            return trimmed(rest.substr(1));
        };
        if (const auto v = value_of("EXPOSURE")) {
            const std::vector<double> n = numbers_of(*v);
            if (n.size() == 1 && n[0] > 0 && std::isfinite(n[0])) {
                exposure *= n[0];
            } else {
                add_ignored(spec, fmt::format("EXPOSURE: it is {}; expected a number above 0",
                                              printable(*v)));
            }
        } else if (const auto c = value_of("COLORCORR")) {
            const std::vector<double> n = numbers_of(*c);
            for (std::size_t k = 0; n.size() == 3 && k < 3; ++k)
                correction[k] *= n[k];
        } else if (const auto p = value_of("PRIMARIES")) {
            primaries = numbers_of(*p);
        } else if (const auto f = value_of("FORMAT")) {
            is_xyz = f->find("xyze") != std::string_view::npos;
        }
    }
    // The line of the size follows the empty one. OpenImageIO 2.4 mixes up two of its eight forms.
    const std::string size = file.line();
    const std::size_t second = size.find_first_of("+-", 1);
    if (size.size() > 1 && second != std::string::npos && second + 1 < size.size()) {
        // From the sides where the first row and the first column are: JEITA CP-3451, 4.6.4.
        const std::string order = {size[0], size[1], size[second], size[second + 1]};
        constexpr std::array<std::string_view, 8> kOrders = {"-Y+X", "-Y-X", "+Y-X", "+Y+X",
                                                             "+X-Y", "-X-Y", "-X+Y", "+X+Y"};
        const auto* found = std::find(kOrders.begin(), kOrders.end(), order);
        if (found != kOrders.end())
            spec.attribute("Orientation", static_cast<int>(found - kOrders.begin()) + 1);
    }
    // Radiance and pfstools divide by both numbers; OpenImageIO, ImageMagick, libvips, ffmpeg and
    // viewers show the pixels as they are stored. So do we, because hosts must agree.
    if (exposure != 1) {
        add_ignored(spec, fmt::format("EXPOSURE: it is {}, and pixels are taken as stored, as most "
                                      "readers do; for radiance before it, use <<exposure={}>>",
                                      shortest(exposure), stops_of(1 / exposure)));
    }
    if (correction != std::array<double, 3>{1, 1, 1}) {
        add_ignored(spec, fmt::format("COLORCORR: it is {} {} {}, and pixels are taken as stored, "
                                      "as most readers do",
                                      shortest(correction[0]), shortest(correction[1]),
                                      shortest(correction[2])));
    }
    if (is_xyz) {
        // CIE XYZ itself, with Radiance's white of equal energy.
        set_primaries(spec, "chromaticities", {1, 0, 0, 1, 0, 0, 1.0F / 3, 1.0F / 3});
        return;
    }
    if (primaries.empty()) return;
    std::array<float, 8> xy{};
    const bool is_complete = primaries.size() == xy.size();
    for (std::size_t k = 0; is_complete && k < xy.size(); ++k)
        xy[k] = static_cast<float>(primaries[k]);
    // ImageMagick writes zeros for "unknown".
    const bool is_absent = std::all_of(xy.begin(), xy.end(), [](float v) { return v == 0; });
    // libvips writes Radiance's default primaries into every file, whatever its colors are.
    constexpr std::array kDefault = {0.640, 0.330, 0.290, 0.600, 0.150, 0.060, 0.3333, 0.3333};
    bool is_default = true;
    for (std::size_t k = 0; k < xy.size(); ++k)
        is_default = is_default && std::fabs(static_cast<double>(xy[k]) - kDefault[k]) < 5e-4;
    if (!is_complete) {
        add_ignored(spec,
                    fmt::format("PRIMARIES: it has {} numbers; expected 8", primaries.size()));
    } else if (!is_absent && !is_default) {
        set_primaries(spec, "chromaticities", xy);
    }
}

/// WebP container specification (RIFF): VP8X, ICCP, EXIF, ANIM.
void read_webp(HeaderFile& file, PictureSpec& spec) {
    (void)file.bytes(12);
    for (int i = 0; i < kMostBlocks && file.ok(); ++i) {
        const std::string type = file.bytes(4);
        const std::uint64_t length = file.number(4, true);
        const std::uint64_t next = file.position() + length + (length & 1U);
        if (!file.ok()) break;
        if (type == "ICCP") set_bytes(spec, "ICCProfile", file.bytes(length));
        if (type == "EXIF") read_orientation(file.bytes(length), spec);
        if (type == "ALPH" || (type == "VP8L" && spec.alpha_channel >= 0)) {
            add_ignored(spec,
                        "alpha: OpenImageIO multiplies colors by it in 8 bits, so dark ones "
                        "lose digits");
        }
        if (type == "ANIM") add_ignored(spec, "ANIM: the picture is the first frame of several");
        if (!file.seek(next)) break;
    }
}

/// Microsoft's BITMAPV4HEADER and BITMAPV5HEADER.
void read_bmp(HeaderFile& file, PictureSpec& spec) {
    const std::string head = file.bytes(14 + 40);
    const std::uint64_t size = HeaderFile::parse(head, 14, 4, true);
    if (!file.ok() || size < 108 || size > 124 || !file.seek(14)) return;
    const std::string v = file.bytes(size);
    const auto u32 = [&](std::size_t at) { return HeaderFile::parse(v, at, 4, true); };
    constexpr std::uint64_t kCalibrated = 0;
    constexpr std::uint64_t kSrgb = 0x73524742;      // "sRGB"
    constexpr std::uint64_t kWindows = 0x57696E20;   // "Win "
    constexpr std::uint64_t kEmbedded = 0x4D424544;  // "MBED"
    constexpr std::uint64_t kLinked = 0x4C494E4B;    // "LINK"
    const std::uint64_t space = u32(56);
    if (space == kSrgb || space == kWindows) {
        spec.attribute(file_tag::kSrgb, 0);
    } else if (space == kLinked) {
        add_ignored(spec, "bV5CSType: the ICC profile is another file");
    } else if (space == kEmbedded && size >= 124) {
        if (file.seek(14 + u32(112))) set_bytes(spec, "ICCProfile", file.bytes(u32(116)));
    } else if (space == kCalibrated) {
        // X, Y, Z of red, green and blue as fixed-point numbers with 30 bits after the point, then
        // gammas with 16.
        std::array<float, 8> xy{};
        std::array<double, 3> white{};
        bool is_stated = true;
        for (std::size_t c = 0; c < 3; ++c) {
            std::array<double, 3> xyz{};
            double sum = 0;
            for (std::size_t k = 0; k < 3; ++k) {
                xyz[k] = static_cast<double>(u32(60 + 12 * c + 4 * k)) / double{1 << 30};
                white[k] += xyz[k];
                sum += xyz[k];
            }
            is_stated = is_stated && sum > 0;
            xy[2 * c] = static_cast<float>(xyz[0] / sum);
            xy[2 * c + 1] = static_cast<float>(xyz[1] / sum);
        }
        const double gamma = static_cast<double>(u32(96)) / 65536;
        // Most writers leave all of it 0.
        if (!is_stated || !(gamma > 0)) return;
        const double sum = white[0] + white[1] + white[2];
        xy[6] = static_cast<float>(white[0] / sum);
        xy[7] = static_cast<float>(white[1] / sum);
        set_primaries(spec, file_tag::kPrimaries, xy);
        spec.attribute(file_tag::kGamma, static_cast<float>(gamma));
    }
}

/// TIFF 6.0 and BigTIFF: the tags of color that OpenImageIO does not list.
void read_tiff(HeaderFile& file, int page, PictureSpec& spec) {
    const std::string start = file.bytes(8);
    if (start.size() != 8) return;
    const bool is_little = start[0] == 'I';
    const bool is_big = HeaderFile::parse(start, 2, 2, is_little) == 43;
    const unsigned word = is_big ? 8 : 4;
    std::uint64_t directory =
        is_big ? file.number(8, is_little) : HeaderFile::parse(start, 4, 4, is_little);
    std::uint64_t count = 0;
    std::string entries;
    for (int i = 0; i <= page; ++i) {
        if (directory == 0 || !file.seek(directory)) return;
        count = std::min<std::uint64_t>(file.number(is_big ? 8 : 2, is_little), 4096);
        entries = file.bytes(count * (4 + 2 * word));
        directory = file.number(word, is_little);
    }
    std::vector<double> white;
    std::vector<double> primaries;
    bool has_transfer = false;
    for (std::uint64_t i = 0; i < count; ++i) {
        const std::size_t at = i * (4 + 2 * word);
        const auto field = [&](std::size_t offset, unsigned bytes) {
            return HeaderFile::parse(entries, at + offset, bytes, is_little);
        };
        const std::uint64_t tag = field(0, 2);
        constexpr std::uint64_t kWhitePoint = 318;
        constexpr std::uint64_t kPrimaryChromaticities = 319;
        constexpr std::uint64_t kTransferFunction = 301;
        has_transfer = has_transfer || tag == kTransferFunction;
        if (tag != kWhitePoint && tag != kPrimaryChromaticities) continue;
        constexpr std::uint64_t kRational = 5;
        const std::uint64_t numbers = field(4, word);
        if (field(2, 2) != kRational || numbers > 6 || !file.seek(field(4 + word, word))) continue;
        std::vector<double>& to = tag == kWhitePoint ? white : primaries;
        for (std::uint64_t k = 0; k < numbers; ++k) {
            const auto above = static_cast<double>(file.number(4, is_little));
            const auto below = static_cast<double>(file.number(4, is_little));
            to.push_back(below > 0 ? above / below : 0);
        }
    }
    if (white.size() == 2 && primaries.size() == 6) {
        std::array<float, 8> xy{};
        std::copy(primaries.begin(), primaries.end(), xy.begin());
        std::copy(white.begin(), white.end(), xy.begin() + 6);
        set_primaries(spec, file_tag::kPrimaries, xy);
    }
    if (has_transfer && !spec.find_attribute("ICCProfile"))
        add_ignored(spec, "TransferFunction: its table is not read");
}

/// ISO/IEC 10918-1: markers up to the first scan.
void read_jpeg(HeaderFile& file, PictureSpec& spec) {
    if (file.number(2, false) != 0xFFD8) return;
    bool has_gain_map = false;
    bool has_profile = false;
    for (int i = 0; i < kMostBlocks && file.ok(); ++i) {
        const std::uint64_t marker = file.number(2, false);
        constexpr std::uint64_t kScan = 0xFFDA;
        if (marker == kScan || marker < 0xFF00) break;
        const std::uint64_t length = std::max<std::uint64_t>(file.number(2, false), 2) - 2;
        const std::uint64_t next = file.position() + length;
        constexpr std::uint64_t kApp1 = 0xFFE1;
        constexpr std::uint64_t kApp2 = 0xFFE2;
        if (marker == kApp1 || marker == kApp2) {
            const std::string data = file.bytes(length);
            has_profile = has_profile || data.starts_with("ICC_PROFILE");
            has_gain_map = has_gain_map || data.starts_with("urn:iso:std:iso:ts:21496:-1") ||
                           data.find("hdrgm:") != std::string::npos;
            if (marker == kApp1 && data.starts_with("Exif")) read_interoperability(data, spec);
            if (marker == kApp1 && data.find("tiff:Orientation") != std::string::npos &&
                !spec.find_attribute("Orientation"))
                add_ignored(spec, "XMP tiff:Orientation: the orientation of Exif alone counts");
        }
        if (!file.seek(next)) break;
    }
    if (has_gain_map) add_ignored(spec, "gain map: the picture for SDR displays is read");
    if (has_profile && !spec.find_attribute("ICCProfile"))
        add_ignored(spec, "ICC profile: a part is missing, or it is damaged");
}

/// Wavefront RLA: six numbers of 16 bits follow the windows, then the text of gamma (16 bytes) and
/// those of red, green, blue and white (24 bytes each).
void read_rla(HeaderFile& file, PictureSpec& spec) {
    constexpr std::size_t kGamma = 28;
    constexpr std::size_t kChroma = 44;
    const std::string head = file.bytes(kChroma + 4 * std::size_t{24});
    if (!file.ok()) return;
    const auto numbers = [&](std::size_t at, std::size_t count) {
        return numbers_of(head.substr(at, std::min(count, head.find('\0', at) - at)));
    };
    const std::vector<double> gamma = numbers(kGamma, 16);
    if (gamma.size() == 1 && gamma[0] > 0)
        spec.attribute(file_tag::kGamma, static_cast<float>(gamma[0]));
    // Every writer stores these numbers, whatever the colors are: not even a gamut.
    constexpr std::array kUsual = {0.67, 0.08, 0.21, 0.71, 0.14, 0.33, 0.31, 0.316};
    std::array<float, 8> xy{};
    bool is_usual = true;
    for (std::size_t c = 0; c < 4; ++c) {
        const std::vector<double> pair = numbers(kChroma + 24 * c, 24);
        if (pair.size() < 2) return;
        for (std::size_t k = 0; k < 2; ++k) {
            xy[2 * c + k] = static_cast<float>(pair[k]);
            is_usual = is_usual && pair[k] == kUsual[2 * c + k];
        }
    }
    if (!is_usual) set_primaries(spec, file_tag::kPrimaries, xy);
}

/// P. Debevec's PFM: the number after width and height is a factor, whose sign is the byte order.
void read_pfm(HeaderFile& file, PictureSpec& spec) {
    const std::string magic = file.line();
    if (magic != "PF" && magic != "Pf") return;
    std::vector<double> numbers;
    while (numbers.size() < 3 && file.ok()) {
        const std::vector<double> more = numbers_of(file.line());
        numbers.insert(numbers.end(), more.begin(), more.end());
    }
    if (numbers.size() != 3 || std::fabs(numbers[2]) == 1) return;
    const std::string factor = shortest(std::fabs(numbers[2]));
    add_ignored(spec, fmt::format("scale factor: samples are multiplied by {}, as in OpenImageIO, "
                                  "not divided, as in ffmpeg",
                                  factor));
}

/// SMPTE ST 268:2003, table 1.
void read_dpx(PictureSpec& spec) {
    const std::string transfer = spec.get_string_attribute("dpx:Transfer");
    if (starts_with_but_for_case(transfer, "Z depth")) {
        spec.attribute(file_tag::kImpossible,
                       fmt::format("dpx:Transfer is {}; expected colors, not depth", transfer));
    }
    // OpenImageIO exchanges width and height, but not the order of the pixels.
    if (spec.get_int_attribute("Orientation", 1) > 4) {
        spec.attribute(file_tag::kImpossible,
                       "the orientation is that of columns; expected rows: OpenImageIO cannot read "
                       "these DPX files");
    }
    const int low = spec.get_int_attribute("dpx:LowData", 0);
    const int high = spec.get_int_attribute("dpx:HighData", 0);
    const int bits = std::clamp(spec.get_int_attribute("oiio:BitsPerSample", 10), 1, 16);
    const int most = (1 << bits) - 1;
    const bool is_density = transfer == "Printing density" || transfer == "Logarithmic";
    const bool is_usual =
        (low == 0 && (high == 0 || high == most)) || (is_density && low == 95 && high == 685);
    if (!is_usual) {
        add_ignored(spec, fmt::format("reference levels {} and {}: codes are taken as {}", low,
                                      high, is_density ? "of 95 and 685" : "of 0 and the largest"));
    }
}

/// Tags that OpenImageIO lists and that nobody applies.
void name_others(std::string_view format, PictureSpec& spec) {
    const std::string jpeg = spec.get_string_attribute("jpeg:ColorSpace");
    if (jpeg == "CMYK" || jpeg == "YCbCrK")
        add_ignored(spec, jpeg + ": CMYK is converted to RGB without a profile");
    if (spec.get_string_attribute("tiff:ColorSpace") == "CMYK")
        add_ignored(spec, "PhotometricInterpretation: CMYK is converted to RGB without a profile");
    const auto is = [&](const char* name, float usual) {  // numbers or text
        return !spec.find_attribute(name) || spec.get_float_attribute(name, usual + 1) == usual;
    };
    if (format == "fits" && (!is("Bscale", 1) || !is("Bzero", 0)))
        add_ignored(spec, "BSCALE, BZERO: pixels are taken as stored");
    if (format == "openexr" && spec.format == TypeDesc::UINT)
        add_ignored(spec, "UINT channels: whole numbers are usually ids, not light");
    if (spec.get_int_attribute("oiio:Movie", 0) != 0)
        add_ignored(spec, "frames: the picture is the first frame of several");
    for (const char* name : {"heif:GainMap", "heif:Sequence", "heif:Auxiliary"}) {
        if (spec.find_attribute(name)) {
            const std::string kind = name;
            add_ignored(spec,
                        kind == "heif:GainMap" ? "gain map: the primary picture is read"
                        : kind == "heif:Sequence"
                            ? "tracks of pictures: the still picture is read"
                            : "auxiliary pictures: " + printable(spec.get_string_attribute(name)));
        }
    }
}

/// Photoshop File Formats Specification: the mode is bytes 24 and 25.
void read_psd(HeaderFile& file, PictureSpec& spec) {
    if (!file.seek(24)) return;
    constexpr std::uint64_t kCmyk = 4;
    constexpr std::uint64_t kLab = 9;
    const std::uint64_t mode = file.number(2, false);
    if (mode == kCmyk) add_ignored(spec, "mode: CMYK is converted to RGB without a profile");
    if (mode == kLab)
        spec.attribute(file_tag::kImpossible, "mode is 9 (Lab); expected RGB or gray");
}

/// The profile that newer OpenImageIO versions store. "OpenEXR File Layout": each part's header is
/// attributes (name, type, size, value) up to an empty name.
void read_openexr_profile(HeaderFile& file, int part, PictureSpec& spec) {
    (void)file.bytes(8);
    for (int i = 0; i < kMostBlocks && part >= 0; ++i) {
        const std::string name = file.name();
        if (!file.ok()) return;
        if (name.empty()) {
            --part;
            continue;
        }
        const std::string type = file.name();
        const std::uint64_t size = file.number(4, true);
        const std::uint64_t next = file.position() + size;
        if (part == 0 && name == "ICCProfile" && type == "bytes" && size > 4) {
            // The text of a hint comes first.
            const std::uint64_t hint = file.number(4, true);
            if (hint < size - 4 && file.seek(file.position() + hint))
                set_bytes(spec, "ICCProfile", file.bytes(size - 4 - hint));
        }
        if (!file.ok() || !file.seek(next)) return;
    }
}

/// Tags of OpenEXR that describe another rendering than the pixels.
void read_openexr(PictureSpec& spec) {
    for (const char* name : {"renderingTransform", "lookModTransform"}) {
        if (!spec.find_attribute(name)) continue;
        add_ignored(spec, fmt::format("{}: the transform {} is not applied", name,
                                      printable(spec.get_string_attribute(name))));
    }
    const float white = spec.get_float_attribute("whiteLuminance", 0);
    if (white > 0) {
        add_ignored(spec, fmt::format("whiteLuminance: 1.0 is {} cd/m2, and pixels are taken as "
                                      "relative",
                                      shortest(static_cast<double>(white))));
    }
    std::array<float, 2> neutral{};
    // OpenEXR, ImfStandardAttributes.h: the white of files without chromaticities is D65.
    std::array<float, 8> ends = {0, 0, 0, 0, 0, 0, 0.3127F, 0.3290F};
    const PictureAttribute* stated =
        spec.find_attribute("adoptedNeutral", TypeDesc(TypeDesc::FLOAT, TypeDesc::VEC2));
    if (!stated) return;
    std::copy_n(stated->numbers<float>(), neutral.size(), neutral.begin());
    if (const PictureAttribute* xy =
            spec.find_attribute("chromaticities", TypeDesc(TypeDesc::FLOAT, 8)))
        std::copy_n(xy->numbers<float>(), ends.size(), ends.begin());
    constexpr float kSame = 1e-3F;  // of programs that round to three digits
    if (std::fabs(neutral[0] - ends[6]) > kSame || std::fabs(neutral[1] - ends[7]) > kSame) {
        add_ignored(spec, fmt::format("adoptedNeutral: colors are not adapted to the white {}, {}",
                                      shortest(static_cast<double>(neutral[0])),
                                      shortest(static_cast<double>(neutral[1]))));
    }
}

/// Encodings that OpenImageIO 2.4 delivers as if they were RGB.
void check_photometric(PictureSpec& spec) {
    const std::string space = spec.get_string_attribute("tiff:ColorSpace");
    const int photometric = spec.get_int_attribute("tiff:PhotometricInterpretation", 0);
    // TIFF 6.0, Adobe's TIFF Technical Notes, and SGI's LogLuv (G. Ward Larson, 1998).
    const char* name = photometric == 8       ? "CIELab"
                       : photometric == 9     ? "ICCLab"
                       : photometric == 10    ? "ITULab"
                       : photometric == 32844 ? "LogL"
                       : photometric == 32845 ? "LogLuv"
                                              : nullptr;
    if (!name) return;
    spec.attribute(
        file_tag::kImpossible,
        fmt::format("PhotometricInterpretation is {} ({}); expected RGB or gray: convert "
                    "it first, such as to OpenEXR",
                    photometric, name));
}

}  // namespace

void add_ignored(PictureSpec& spec, const std::string& line) {
    std::string all = spec.get_string_attribute(file_tag::kIgnored);
    if (!all.empty()) all += '\n';
    spec.attribute(file_tag::kIgnored, all + line);
}

std::vector<std::string> ignored_of(const PictureSpec& spec) {
    std::vector<std::string> lines;
    std::istringstream text(std::string(spec.get_string_attribute(file_tag::kIgnored)));
    for (std::string line; std::getline(text, line);)
        lines.push_back(line);
    return lines;
}

void complete_header(const std::string& path, std::string_view format, int subimage,
                     PictureSpec& spec) {
    spec.attribute(file_tag::kFormat, std::string(format));
    spec.attribute(file_tag::kColorSpace, spec.get_string_attribute("oiio:ColorSpace"));
    HeaderFile file(path);
    name_others(format, spec);
    if (format == "openexr") read_openexr(spec);
    if (format == "dpx") read_dpx(spec);
    if (!file.ok() || file.size() == 0) return;
    if (format == "png") read_png(file, spec);
    if (format == "hdr") read_radiance(file, spec);
    if (format == "webp") read_webp(file, spec);
    if (format == "bmp") read_bmp(file, spec);
    if (format == "jpeg") read_jpeg(file, spec);
    if (format == "rla") read_rla(file, spec);
    if (format == "psd") read_psd(file, spec);
    if (format == "pnm") read_pfm(file, spec);
    if (format == "openexr") read_openexr_profile(file, subimage, spec);
    if (format == "tiff") {
        check_photometric(spec);
        read_tiff(file, subimage, spec);
    }
}

TONEWRIGHT_NAMESPACE_END
