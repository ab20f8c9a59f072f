// SPDX-License-Identifier: Apache-2.0
#include "picture/jpeg_metadata.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <string_view>
#include <utility>
#include <vector>

#include "base/strings.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

using T = OIIO::TypeDesc;

// Exif 2.3, table 2: types of fields.
constexpr std::uint16_t kAscii = 2;
constexpr std::uint16_t kShort = 3;
constexpr std::uint16_t kLong = 4;
constexpr std::uint16_t kRational = 5;
constexpr std::uint16_t kUndefined = 7;

/// Exif 2.3, tables 4 and 7; IPTC IIM 4.2, chapter 6.
struct Tag {
    std::string_view attribute;
    std::uint16_t exif;
    std::uint16_t type;
    std::uint8_t iptc = 0;    // 0: none
    bool is_private = false;  // in Exif's own directory
};
constexpr std::array<Tag, 12> kTags = {{{"Software", 0x131, kAscii, 65},
                                        {"Artist", 0x13B, kAscii, 80},
                                        {"Copyright", 0x8298, kAscii, 116},
                                        {"ImageDescription", 0x10E, kAscii, 120},
                                        {"DateTime", 0x132, kAscii},
                                        {"Orientation", 0x112, kShort},
                                        {"XResolution", 0x11A, kRational},
                                        {"YResolution", 0x11B, kRational},
                                        {"ExposureTime", 0x829A, kRational, 0, true},
                                        {"FNumber", 0x829D, kRational, 0, true},
                                        {"Exif:ImageHistory", 0x9213, kAscii, 0, true},
                                        {"Exif:ColorSpace", 0xA001, kShort, 0, true}}};

const Tag* find_tag(const PictureAttribute& attribute) {
    const auto* const found = std::find_if(kTags.begin(), kTags.end(), [&](const Tag& tag) {
        return is_same_name(tag.attribute, attribute.name);
    });
    return found == kTags.end() ? nullptr : found;
}

/// OpenImageIO writes some attributes of these names, which this file does not know.
bool is_left_to_openimageio(const PictureAttribute& attribute) {
    constexpr std::array<std::string_view, 9> kGroups = {
        "Exif", "GPS", "IPTC", "photoshop", "tiff", "crs", "GPano", "aux", "rdf"};
    constexpr std::array<std::string_view, 6> kNames = {"Make",    "Model",    "ExposureTime",
                                                        "FNumber", "Keywords", "ImageHistory"};
    const std::string_view name = attribute.name;
    const std::size_t colon = name.find(':');
    const auto is_name = [&](std::string_view other) { return is_same_name(name, other); };
    const auto is_group = [&](std::string_view group) {
        return colon != std::string_view::npos && is_same_name(name.substr(0, colon), group);
    };
    return std::any_of(kGroups.begin(), kGroups.end(), is_group) ||
           std::any_of(kNames.begin(), kNames.end(), is_name) ||
           (is_name("ResolutionUnit") && attribute.type != T(T::STRING));
}

template <class Number>
void append(std::string& to, Number number) {
    std::array<char, sizeof number> bytes{};
    std::memcpy(bytes.data(), &number, sizeof number);
    to.append(bytes.data(), bytes.size());
}

/// A directory of fields. The values that do not fit into their fields stand before it.
class Directory {
  public:
    /// @param block  from the header on, which the offsets count from
    void add(std::string& block, std::uint16_t tag, std::uint16_t type, std::uint32_t count,
             std::string value) {
        std::string& field = fields_.emplace_back(tag, "").second;
        append(field, tag);
        append(field, type);
        append(field, count);
        constexpr std::size_t kInField = 4;
        if (value.size() <= kInField) {
            value.resize(kInField);
            field += value;
        } else {
            append(field, static_cast<std::uint32_t>(block.size()));
            block += value;
        }
    }
    void sort() { std::sort(fields_.begin(), fields_.end()); }
    [[nodiscard]] bool empty() const { return fields_.empty(); }
    [[nodiscard]] std::string bytes() const {
        std::string all;
        append(all, static_cast<std::uint16_t>(fields_.size()));
        for (const auto& [tag, field] : fields_)
            all += field;
        append(all, std::uint32_t{0});  // no next directory
        return all;
    }

  private:
    std::vector<std::pair<std::uint16_t, std::string>> fields_;
};

/// A number as a fraction with the denominator 1, 10, ... or 1000000, or as 1/n.
std::optional<std::string> fraction_of(float number) {
    constexpr float kMost = 2000;  // times 1000000, it fits into 31 bits
    const bool is_whole = std::floor(number) == number;
    if (!(number >= 0 && number <= (is_whole ? 65535 : kMost))) return {};
    const double inverse = number > 0 ? 1.0 / static_cast<double>(number) : 0;
    std::uint32_t top = 1;
    std::uint32_t bottom = 1;
    constexpr double kMostInverse = 1e9;
    if (inverse >= 1 && inverse <= kMostInverse && std::floor(inverse) == inverse) {
        bottom = static_cast<std::uint32_t>(inverse);
    } else {
        constexpr float kPrecision = 1e-5F;
        constexpr std::uint32_t kMostBottom = 1000000;
        for (;; bottom *= 10, number *= 10) {
            top = static_cast<std::uint32_t>(number);
            const float rest = number - static_cast<float>(top);
            if (rest <= kPrecision || bottom >= kMostBottom) break;
        }
    }
    std::string fraction;
    append(fraction, top);
    append(fraction, bottom);
    return fraction;
}

/// Adds the field of an attribute.
/// @returns  false if OpenImageIO converts the value
bool add_field(const Tag& tag, const PictureAttribute& attribute, const PictureSpec& spec,
               std::string& block, Directory& directory) {
    std::string value;
    std::uint32_t count = 1;
    if (tag.type == kAscii) {
        if (attribute.type != T(T::STRING)) return false;
        const std::string& text = attribute.texts.front();
        if (text.empty()) return true;
        count = static_cast<std::uint32_t>(text.size() + 1);
        value.assign(text.c_str(), text.size() + 1);
    } else if (tag.type == kShort) {
        if (attribute.type != T(T::INT) && attribute.type != T(T::UINT16)) return false;
        append(value, static_cast<std::uint16_t>(spec.get_int_attribute(attribute.name)));
    } else {
        const std::optional<std::string> fraction =
            attribute.type == T(T::FLOAT) ? fraction_of(spec.get_float_attribute(attribute.name))
                                          : std::nullopt;
        if (!fraction) return false;
        value = *fraction;
    }
    directory.add(block, tag.exif, tag.type, count, value);
    return true;
}

/// Exif 2.3, 4.5.2 to 4.6.5.
std::optional<std::string> exif_of(const PictureSpec& spec) {
    std::string block = std::endian::native == std::endian::little ? "II" : "MM";
    append(block, std::uint16_t{42});
    append(block, std::uint32_t{0});  // the offset of the directory
    Directory main;
    Directory exif;
    for (const PictureAttribute& attribute : spec.attributes) {
        const Tag* const tag = find_tag(attribute);
        if (!tag && is_left_to_openimageio(attribute)) return {};
        if (tag && !add_field(*tag, attribute, spec, block, tag->is_private ? exif : main))
            return {};
    }
    std::string private_fields;
    if (!exif.empty()) {
        exif.add(block, 0x9000, kUndefined, 4, "0230");                      // version
        exif.add(block, 0x9101, kUndefined, 4, std::string("\1\2\3\0", 4));  // Y, Cb, Cr
        exif.add(block, 0xA000, kUndefined, 4, "0100");                      // FlashPix
        exif.sort();
        private_fields = exif.bytes();
        constexpr std::size_t kField = 12;
        std::string offset;
        append(offset, static_cast<std::uint32_t>(block.size() + main.bytes().size() + kField));
        main.add(block, 0x8769, kLong, 1, offset);
    }
    const auto directory_at = static_cast<std::uint32_t>(block.size());
    std::memcpy(&block[4], &directory_at, sizeof directory_at);
    return std::string("Exif\0", 6) + block + main.bytes() + private_fields;
}

/// Adobe Photoshop File Formats Specification, "Image Resource Blocks": 0x0404 holds IPTC IIM.
std::string iptc_of(const PictureSpec& spec) {
    std::string records;
    for (const Tag& tag : kTags) {
        const PictureAttribute* const found =
            tag.iptc != 0 ? spec.find_attribute(tag.attribute) : nullptr;
        if (!found || found->texts.front().empty()) continue;
        constexpr std::size_t kMost = 0xFFFE;
        const std::string text = found->texts.front().substr(0, kMost);
        records += {'\x1C', '\2', static_cast<char>(tag.iptc)};
        records += {static_cast<char>(text.size() >> 8), static_cast<char>(text.size())};
        records += text;
    }
    if (records.empty()) return {};
    std::string block(
        "Photoshop 3.0\0"
        "8BIM\4\4\0\0\0\0",
        24);
    block += {static_cast<char>(records.size() >> 8), static_cast<char>(records.size())};
    return block + records;
}

}  // namespace

std::optional<JpegMetadata> jpeg_metadata(const PictureSpec& picture) {
    PictureSpec spec = picture;
    if (is_same_name(spec.get_string_attribute("oiio:ColorSpace"), "sRGB"))
        spec.attribute("Exif:ColorSpace", 1);
    const std::optional<std::string> exif = exif_of(spec);
    if (!exif) return {};
    JpegMetadata metadata = {.comment = spec.get_string_attribute("ImageDescription"),
                             .exif = *exif,
                             .iptc = iptc_of(spec)};
    if (!metadata.comment.empty()) metadata.comment += '\0';
    return metadata;
}

TONEWRIGHT_NAMESPACE_END
