// SPDX-License-Identifier: Apache-2.0
#include "picture/exr_attributes.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cstdint>
#include <cstring>
#include <ctime>
#include <map>
#include <string_view>
#include <utility>
#include <vector>

#include "base/strings.h"
#include "picture/compression.h"
#include "picture/half.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

using T = OIIO::TypeDesc;

/// Attributes of OpenImageIO that have another name, or one type only, in OpenEXR.
struct Translation {
    std::string_view name;
    std::string_view exr_name;  // empty: it is left out
    T type = T(T::UNKNOWN);
};
constexpr std::array kTranslations = {
    Translation{"worldtocamera", "worldToCamera", OIIO::TypeMatrix},
    Translation{"worldtondc", "worldToNDC", OIIO::TypeMatrix},
    Translation{"worldtoscreen", "worldToScreen", OIIO::TypeMatrix},
    Translation{"datetime", "capDate", OIIO::TypeString},
    Translation{"imagedescription", "comments", OIIO::TypeString},
    Translation{"description", "comments", OIIO::TypeString},
    Translation{"copyright", "owner", OIIO::TypeString},
    Translation{"pixelaspectratio", "pixelAspectRatio", OIIO::TypeFloat},
    Translation{"xresolution", "xDensity", OIIO::TypeFloat},
    Translation{"exposuretime", "expTime", OIIO::TypeFloat},
    Translation{"fnumber", "aperture", OIIO::TypeFloat},
    Translation{"oiio:subimagename", "name", OIIO::TypeString},
    Translation{"openexr:dwacompressionlevel", "dwaCompressionLevel", OIIO::TypeFloat},
    Translation{"smpte:timecode", "timeCode", OIIO::TypeTimeCode},
    Translation{"smpte:keycode", "keyCode", OIIO::TypeKeyCode},
    Translation{"yresolution", {}},
    Translation{"planarconfig", {}},
    Translation{"type", {}},
    Translation{"tiles", {}},
    Translation{"chunkcount", {}},
    Translation{"maxsamplesperpixel", {}},
    Translation{"openexr:roundingmode", {}}};

/// Formats of OpenImageIO 2.4: attributes of others than OpenEXR ("png:compressionLevel") are left
/// out.
constexpr std::array<std::string_view, 28> kOtherFormats = {
    "tiff", "jpeg", "bmp", "cineon",    "dds",      "dicom", "dpx",     "ffmpeg", "fits", "gif",
    "heif", "hdr",  "ico", "iff",       "jpeg2000", "null",  "openvdb", "png",    "pnm",  "psd",
    "raw",  "rla",  "sgi", "softimage", "targa",    "term",  "webp",    "zfile"};

/// An attribute as the file has it.
struct Stored {
    std::string type;
    std::string bytes;
};
/// In the order of the file.
using Header = std::map<std::string, Stored>;

template <class Number>
void append(std::string& bytes, Number number) {
    bytes.append(reinterpret_cast<const char*>(&number), sizeof number);
}

/// A name that is in the header keeps its type.
void put(Header& header, std::string_view name, std::string_view type, std::string bytes) {
    constexpr std::size_t kLongestName = 255;
    const auto [at, is_new] = header.try_emplace(std::string(name.substr(0, kLongestName)),
                                                 Stored{std::string(type), {}});
    if (is_new || at->second.type == type) at->second.bytes = std::move(bytes);
}

std::string bytes_of(const PictureAttribute& attribute) {
    return {reinterpret_cast<const char*>(attribute.data.data()), attribute.data.size()};
}

/// A vector, matrix or box; empty if OpenEXR has no such type.
std::string_view aggregate_type(const T& type) {
    const bool is_int = type.basetype == T::INT || type.basetype == T::UINT;
    const bool is_float = type.basetype == T::FLOAT;
    const bool is_double = type.basetype == T::DOUBLE;
    if (!is_int && !is_float && !is_double) return {};
    const auto one_of = [&](std::string_view i, std::string_view f, std::string_view d) {
        return is_int ? i : is_float ? f : d;
    };
    // Arrays of 2, 3, 9 and 16 numbers count as vectors and matrices.
    const bool is_array = type.arraylen > 0;
    if (is_array && type.aggregate == T::VEC2 && type.arraylen == 2)
        return one_of("box2i", "box2f", {});
    if (is_array && type.aggregate != T::SCALAR) return {};
    switch (is_array ? type.arraylen : static_cast<int>(type.aggregate)) {
        case 2:
            return one_of("v2i", "v2f", "v2d");
        case 3:
            return one_of("v3i", "v3f", "v3d");
        case 9:
            return one_of({}, "m33f", "m33d");
        case 16:
            return one_of({}, "m44f", "m44d");
        default:
            return {};
    }
}

void put_number(Header& header, std::string_view name, const PictureAttribute& attribute) {
    std::string bytes;
    const auto* const data = attribute.data.data();
    switch (attribute.type.basetype) {
        case T::INT:
        case T::UINT:
            return put(header, name, "int", bytes_of(attribute));
        case T::INT16: {
            std::int16_t value = 0;
            std::memcpy(&value, data, sizeof value);
            append(bytes, std::int32_t{value});
            return put(header, name, "int", bytes);
        }
        case T::UINT16: {
            std::uint16_t value = 0;
            std::memcpy(&value, data, sizeof value);
            append(bytes, std::int32_t{value});
            return put(header, name, "int", bytes);
        }
        case T::HALF: {
            std::uint16_t value = 0;
            std::memcpy(&value, data, sizeof value);
            append(bytes, half_value(value));
            return put(header, name, "float", bytes);
        }
        case T::FLOAT:
            return put(header, name, "float", bytes_of(attribute));
        case T::DOUBLE:
            return put(header, name, "double", bytes_of(attribute));
        default:
            return;
    }
}

void put_value(Header& header, std::string_view name, const PictureAttribute& attribute) {
    const T& type = attribute.type;
    if (type.basetype == T::STRING) {
        if (type.aggregate != T::SCALAR || attribute.texts.empty()) return;
        if (type.arraylen == 0) return put(header, name, "string", attribute.texts.front());
        std::string bytes;
        for (const std::string& text : attribute.texts) {
            append(bytes, static_cast<std::int32_t>(text.size()));
            bytes += text;
        }
        return put(header, name, "stringvector", bytes);
    }
    if (attribute.data.empty() || type.arraylen < 0) return;
    const bool is_array = type.arraylen > 0;
    if (!is_array && type.aggregate == T::SCALAR) return put_number(header, name, attribute);
    const std::string bytes = bytes_of(attribute);
    if (type == OIIO::TypeTimeCode) return put(header, name, "timecode", bytes);
    if (type == OIIO::TypeKeyCode) return put(header, name, "keycode", bytes);
    if (!is_array && type.aggregate == T::VEC2 && type.vecsemantics == T::RATIONAL &&
        (type.basetype == T::INT || type.basetype == T::UINT))
        return put(header, name, "rational", bytes);
    if (const std::string_view known = aggregate_type(type); !known.empty())
        return put(header, name, known, bytes);
    if (!is_array || type.basetype != T::FLOAT) return;
    if (attribute.data.size() == 8 * sizeof(float) && lowercase(name) == "chromaticities")
        return put(header, "chromaticities", "chromaticities", bytes);
    put(header, name, "floatvector", bytes);
}

/// True for a name that OpenImageIO's writer leaves out.
bool is_left_out(const std::string& folded) {
    if (folded.starts_with("oiio:"))
        return folded != "oiio:constantcolor" && folded != "oiio:averagecolor" &&
               folded != "oiio:sha-1";
    const std::string_view prefix = std::string_view(folded).substr(0, folded.find(':'));
    return folded.starts_with("iccprofile:") ||
           (prefix.size() < folded.size() &&
            std::find(kOtherFormats.begin(), kOtherFormats.end(), prefix) != kOtherFormats.end());
}

void put_attribute(Header& header, const PictureAttribute& attribute) {
    const std::string folded = lowercase(attribute.name);
    if (folded.empty()) return;
    // They have their own types in the header.
    if ((folded == "compression" || folded == "openexr:lineorder") &&
        attribute.type == OIIO::TypeString)
        return;
    const auto* const known =
        std::find_if(kTranslations.begin(), kTranslations.end(), [&](const Translation& row) {
            return folded == row.name ||
                   (!row.exr_name.empty() && folded == lowercase(row.exr_name));
        });
    if (known == kTranslations.end()) {
        if (!is_left_out(folded)) put_value(header, attribute.name, attribute);
        return;
    }
    if (known->exr_name.empty()) return;
    PictureAttribute typed = attribute;
    if (known->type == OIIO::TypeFloat && typed.type == T::INT) {
        std::int32_t number = 0;
        std::memcpy(&number, typed.data.data(), sizeof number);
        const auto value = static_cast<float>(number);
        std::memcpy(typed.data.data(), &value, sizeof value);
        typed.type = OIIO::TypeFloat;
    } else if (known->type == OIIO::TypeMatrix && typed.type == T(T::FLOAT, 16)) {
        typed.type = OIIO::TypeMatrix;
    }
    if (known->type.equivalent(typed.type)) put_value(header, known->exr_name, typed);
}

std::string box_of(int x, int y, int width, int height) {
    std::string bytes;
    for (const int number : {x, y, x + width - 1, y + height - 1})
        append(bytes, std::int32_t{number});
    return bytes;
}

std::string channel_list(const PictureSpec& spec) {
    std::map<std::string, exr_pixel_type_t> channels;
    const exr_pixel_type_t type = pixel_type_of(spec.format);
    for (const std::string& name : spec.channelnames)
        channels[name] = type;
    std::string bytes;
    for (const auto& [name, type_of_channel] : channels) {
        bytes += name;
        bytes += '\0';
        append(bytes, static_cast<std::int32_t>(type_of_channel));
        append(bytes, std::int32_t{0});  // perceived as logarithmic; reserved
        append(bytes, std::int32_t{1});  // sampling in x and y
        append(bytes, std::int32_t{1});
    }
    bytes += '\0';
    return bytes;
}

std::string local_time() {
    const std::time_t now = std::time(nullptr);
    std::tm parts = {};
    ::localtime_r(&now, &parts);
    return fmt::format("{:4}:{:02}:{:02} {:02}:{:02}:{:02}", parts.tm_year + 1900, parts.tm_mon + 1,
                       parts.tm_mday, parts.tm_hour, parts.tm_min, parts.tm_sec);
}

void fit_channel_names(PictureSpec& spec) {
    std::vector<std::string>& names = spec.channelnames;
    names.resize(static_cast<std::size_t>(spec.nchannels));
    for (std::size_t c = 1; c < names.size(); ++c) {
        const auto here = names.begin() + static_cast<std::ptrdiff_t>(c);
        if (names[c].empty() || std::find(names.begin(), here, names[c]) != here)
            names[c] = fmt::format("channel{}", c);
    }
    if (!names.empty() && names.front().empty()) names.front() = std::string("R");
}

void fit_density(PictureSpec& spec) {
    constexpr float kCmPerInch = 2.54F;
    const float x = spec.get_float_attribute("XResolution");
    const float y = spec.get_float_attribute("YResolution");
    if (x == 0 || y == 0) return;
    if (spec.get_float_attribute("PixelAspectRatio") == 0)
        spec.attribute("PixelAspectRatio", x / y);
    if (spec.get_string_attribute("ResolutionUnit") != "cm") return;
    spec.attribute("XResolution", x / kCmPerInch);
    spec.attribute("YResolution", y / kCmPerInch);
}

}  // namespace

void fit_to_exr(PictureSpec& spec) {
    fit_channel_names(spec);
    if (spec.full_width <= 0) spec.full_width = spec.width;
    if (spec.full_height <= 0) spec.full_height = spec.height;
    spec.depth = std::max(spec.depth, 1);
    const bool is_wide = spec.format.basetype == T::FLOAT || spec.format.basetype == T::DOUBLE;
    spec.format = spec.format.basetype == T::UINT ? T::UINT : is_wide ? T::FLOAT : T::HALF;
    const std::string compression = spec.get_string_attribute("compression", "zip");
    if (lowercase(compression).starts_with("dwa")) {
        constexpr float kDefault = 45;  // of OpenEXR
        const int quality = quality_of(spec, 0);
        spec.attribute("openexr:dwaCompressionLevel",
                       quality > 0 ? static_cast<float>(quality) : kDefault);
    }
    spec.attribute("compression", compression.substr(0, compression.find(':')));
    if (!spec.find_attribute("openexr:lineOrder"))
        spec.attribute("openexr:lineOrder", "increasingY");
    if (!spec.find_attribute("DateTime")) spec.attribute("DateTime", local_time());
    fit_density(spec);
}

std::string exr_header_of(const PictureSpec& spec, exr_compression_t compression) {
    Header header;
    put(header, "channels", "chlist", channel_list(spec));
    put(header, "compression", "compression", {static_cast<char>(compression)});
    put(header, "dataWindow", "box2i", box_of(spec.x, spec.y, spec.width, spec.height));
    put(header, "displayWindow", "box2i",
        box_of(spec.full_x, spec.full_y, spec.full_width, spec.full_height));
    put(header, "lineOrder", "lineOrder", {static_cast<char>(EXR_LINEORDER_INCREASING_Y)});
    std::string one;
    append(one, 1.0F);
    put(header, "pixelAspectRatio", "float", one);
    put(header, "screenWindowCenter", "v2f", std::string(2 * sizeof(float), '\0'));
    put(header, "screenWindowWidth", "float", one);
    const std::string environment = lowercase(spec.get_string_attribute("textureformat"));
    if (environment == "cubeface environment") put(header, "envmap", "envmap", {'\1'});
    if (environment == "latlong environment") put(header, "envmap", "envmap", {'\0'});
    for (const PictureAttribute& attribute : spec.attributes)
        put_attribute(header, attribute);

    constexpr std::size_t kLongestShortName = 31;
    const auto is_long = [](const std::string& name) { return name.size() > kLongestShortName; };
    bool has_long_names = std::any_of(spec.channelnames.begin(), spec.channelnames.end(), is_long);
    std::string attributes;
    for (const auto& [name, stored] : header) {
        has_long_names = has_long_names || is_long(name);
        attributes += name;
        attributes += '\0';
        attributes += stored.type;
        attributes += '\0';
        append(attributes, static_cast<std::int32_t>(stored.bytes.size()));
        attributes += stored.bytes;
    }
    attributes += '\0';

    constexpr std::uint32_t kMagic = 20000630;  // OpenEXR File Layout
    constexpr std::uint32_t kVersion = 2;
    constexpr std::uint32_t kLongNames = 0x400;
    std::string bytes;
    append(bytes, kMagic);
    append(bytes, has_long_names ? kVersion | kLongNames : kVersion);
    return bytes + attributes;
}

TONEWRIGHT_NAMESPACE_END
