// SPDX-License-Identifier: Apache-2.0
#include "picture/exr_header.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstring>
#include <map>
#include <numeric>
#include <tuple>
#include <utility>

#include "base/strings.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

using T = OIIO::TypeDesc;

struct NamedCompression {
    exr_compression_t compression;
    std::string_view name;
};
constexpr std::array kCompressions = {NamedCompression{EXR_COMPRESSION_NONE, "none"},
                                      NamedCompression{EXR_COMPRESSION_RLE, "rle"},
                                      NamedCompression{EXR_COMPRESSION_ZIPS, "zips"},
                                      NamedCompression{EXR_COMPRESSION_ZIP, "zip"},
                                      NamedCompression{EXR_COMPRESSION_PIZ, "piz"},
                                      NamedCompression{EXR_COMPRESSION_PXR24, "pxr24"},
                                      NamedCompression{EXR_COMPRESSION_B44, "b44"},
                                      NamedCompression{EXR_COMPRESSION_B44A, "b44a"},
                                      NamedCompression{EXR_COMPRESSION_DWAA, "dwaa"},
                                      NamedCompression{EXR_COMPRESSION_DWAB, "dwab"}};

/// The place of a channel within its layer, and then its name.
using ChannelPlace = std::tuple<std::string_view, std::size_t, std::string_view>;

constexpr std::array<std::string_view, 20> kColorOrder = {
    "r",     "red", "g",  "green", "b",  "blue", "y",  "real", "imag",  "a",
    "alpha", "ar",  "ra", "ag",    "ga", "ab",   "ba", "z",    "depth", "zback"};
/// Channels of layers that hold a position or a normal.
constexpr std::array<std::string_view, 21> kVectorOrder = {
    "r", "red",   "g",  "green", "b",  "blue", "x",  "y",  "z",     "real", "imag",
    "a", "alpha", "ar", "ra",    "ag", "ga",   "ab", "ba", "depth", "zback"};

template <std::size_t kCount>
std::size_t index_in(const std::array<std::string_view, kCount>& order, std::string_view suffix) {
    const std::string name = lowercase(suffix);
    return static_cast<std::size_t>(std::find(order.begin(), order.end(), name) - order.begin());
}

/// "diffuse." of "diffuse.R"; empty without a layer.
std::string_view layer_of(std::string_view name) { return name.substr(0, name.rfind('.') + 1); }
std::string_view suffix_of(std::string_view name) { return name.substr(name.rfind('.') + 1); }

bool is_suffix(std::string_view name, std::string_view a, std::string_view b) {
    const std::string suffix = lowercase(suffix_of(name));
    return suffix == a || suffix == b;
}

/// Sorts channels as OpenImageIO does: by layer, then R, G, B, A, Z, then by name.
void order_channels(std::vector<ExrChannel>& channels, PictureSpec& spec) {
    struct Axes {
        bool x = false, y_or_z = false;
    };
    std::map<std::string_view, Axes> layers;
    for (const ExrChannel& channel : channels) {
        Axes& axes = layers[layer_of(channel.name)];
        axes.x = axes.x || is_suffix(channel.name, "x", "x");
        axes.y_or_z = axes.y_or_z || is_suffix(channel.name, "y", "z");
    }
    const auto place = [&](std::size_t i) {
        const std::string_view name = channels[i].name;
        const std::string_view suffix = suffix_of(name);
        const Axes& axes = layers[layer_of(name)];
        return ChannelPlace(
            layer_of(name),
            axes.x && axes.y_or_z ? index_in(kVectorOrder, suffix) : index_in(kColorOrder, suffix),
            suffix);
    };
    std::vector<std::size_t> order(channels.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::sort(order.begin(), order.end(),
              [&](std::size_t a, std::size_t b) { return place(a) < place(b); });
    bool is_one_type = true;
    for (std::size_t i = 0; i < order.size(); ++i) {
        ExrChannel& channel = channels[order[i]];
        channel.index = i;
        spec.channelnames.push_back(channel.name);
        spec.channelformats.push_back(type_of(channel.type));
        is_one_type = is_one_type && channel.type == channels.front().type;
        const auto number = static_cast<int>(i);
        if (spec.alpha_channel < 0 && is_suffix(channel.name, "a", "alpha"))
            spec.alpha_channel = number;
        if (spec.z_channel < 0 && is_suffix(channel.name, "z", "depth")) spec.z_channel = number;
    }
    spec.nchannels = static_cast<int>(order.size());
    spec.format = is_one_type ? spec.channelformats.front() : T(T::FLOAT);
    if (is_one_type) spec.channelformats.clear();
}

/// OpenImageIO's name of an attribute; empty if it leaves the attribute out.
std::string_view name_of(std::string_view exr_name) {
    static const std::map<std::string_view, std::string_view> names = {
        {"cameraTransform", "worldtocamera"},
        {"capDate", "DateTime"},
        {"comments", "ImageDescription"},
        {"owner", "Copyright"},
        {"pixelAspectRatio", "PixelAspectRatio"},
        {"xDensity", "XResolution"},
        {"expTime", "ExposureTime"},
        {"aperture", "FNumber"},
        {"chunkCount", "openexr:chunkCount"},
        {"maxSamplesPerPixel", "openexr:maxSamplesPerPixel"},
        {"dwaCompressionLevel", "openexr:dwaCompressionLevel"},
        {"dataWindow", ""},
        {"displayWindow", ""},
        {"envmap", ""},
        {"tiles", ""},
        {"type", ""}};
    const auto found = names.find(exr_name);
    return found == names.end() ? exr_name : found->second;
}

std::string text_of(const exr_attr_string_t& text) {
    // The text ends at its first zero, as OpenImageIO has it.
    const auto length = static_cast<std::size_t>(text.length);
    return {text.str, ::strnlen(text.str, length)};
}

void add_rational(PictureSpec& spec, std::string_view name, const exr_attr_rational_t& value) {
    std::int64_t number = value.num;
    std::int64_t divisor = value.denom;
    if (divisor > INT32_MAX) {
        const std::int64_t factor = std::gcd(number, divisor);
        if (factor <= 1) return;  // OIIO's type has no such number
        number /= factor;
        divisor /= factor;
    }
    const std::array<std::int32_t, 2> pair = {static_cast<std::int32_t>(number),
                                              static_cast<std::int32_t>(divisor)};
    spec.attribute(name, OIIO::TypeRational, pair.data());
}

void add_attribute(PictureSpec& spec, const exr_attribute_t& attribute) {
    const std::string_view name = name_of(attribute.name);
    if (name.empty()) return;
    const auto add = [&](const T& type, const void* value) { spec.attribute(name, type, value); };
    switch (attribute.type) {
        case EXR_ATTR_STRING:
            if (attribute.string->length > 0) spec.attribute(name, text_of(*attribute.string));
            return;
        case EXR_ATTR_INT:
            spec.attribute(name, attribute.i);
            return;
        case EXR_ATTR_FLOAT:
            spec.attribute(name, attribute.f);
            return;
        case EXR_ATTR_DOUBLE:
            return add(T(T::DOUBLE), &attribute.d);
        case EXR_ATTR_M33F:
            return add(OIIO::TypeMatrix33, attribute.m33f);
        case EXR_ATTR_M44F:
            return add(OIIO::TypeMatrix44, attribute.m44f);
        case EXR_ATTR_M33D:
            return add(T(T::DOUBLE, T::MATRIX33), attribute.m33d);
        case EXR_ATTR_M44D:
            return add(T(T::DOUBLE, T::MATRIX44), attribute.m44d);
        case EXR_ATTR_V2I:
            return add(T(T::INT, T::VEC2), attribute.v2i);
        case EXR_ATTR_V2F:
            return add(T(T::FLOAT, T::VEC2), attribute.v2f);
        case EXR_ATTR_V2D:
            return add(T(T::DOUBLE, T::VEC2), attribute.v2d);
        case EXR_ATTR_V3I:
            return add(T(T::INT, T::VEC3, T::VECTOR), attribute.v3i);
        case EXR_ATTR_V3F:
            return add(OIIO::TypeVector, attribute.v3f);
        case EXR_ATTR_V3D:
            return add(T(T::DOUBLE, T::VEC3, T::VECTOR), attribute.v3d);
        case EXR_ATTR_BOX2I:
            return add(T(T::INT, T::VEC2, 2), attribute.box2i);
        case EXR_ATTR_BOX2F:
            return add(T(T::FLOAT, T::VEC2, 2), attribute.box2f);
        case EXR_ATTR_CHROMATICITIES:
            return add(T(T::FLOAT, 8), attribute.chromaticities);
        case EXR_ATTR_TIMECODE:
            return spec.attribute(name == "timeCode" ? "smpte:TimeCode" : name, OIIO::TypeTimeCode,
                                  attribute.timecode);
        case EXR_ATTR_KEYCODE:
            return spec.attribute(name == "keyCode" ? "smpte:KeyCode" : name, OIIO::TypeKeyCode,
                                  attribute.keycode);
        case EXR_ATTR_RATIONAL:
            return add_rational(spec, name, *attribute.rational);
        case EXR_ATTR_STRING_VECTOR: {
            std::vector<std::string> texts;
            texts.reserve(static_cast<std::size_t>(attribute.stringvector->n_strings));
            for (int i = 0; i < attribute.stringvector->n_strings; ++i)
                texts.push_back(text_of(attribute.stringvector->strings[i]));
            if (!texts.empty()) add(T(T::STRING, static_cast<int>(texts.size())), texts.data());
            return;
        }
        case EXR_ATTR_FLOAT_VECTOR:
            if (attribute.floatvector->length > 0)
                add(T(T::FLOAT, attribute.floatvector->length), attribute.floatvector->arr);
            return;
        default:  // previews, and types that only their writers know
            return;
    }
}

/// @returns  false for windows beyond 2^30, which OpenEXR refuses as well
bool set_windows(PictureSpec& spec, const exr_attr_box2i_t& data, const exr_attr_box2i_t& shown) {
    for (const exr_attr_box2i_t& window : {data, shown}) {
        constexpr int kMost = INT32_MAX / 2;
        if (window.min.x <= -kMost || window.min.y <= -kMost || window.max.x >= kMost ||
            window.max.y >= kMost || window.max.x < window.min.x || window.max.y < window.min.y)
            return false;
    }
    spec.x = data.min.x;
    spec.y = data.min.y;
    spec.width = data.max.x - data.min.x + 1;
    spec.height = data.max.y - data.min.y + 1;
    spec.full_x = shown.min.x;
    spec.full_y = shown.min.y;
    spec.full_width = shown.max.x - shown.min.x + 1;
    spec.full_height = shown.max.y - shown.min.y + 1;
    spec.tile_depth = 1;
    return true;
}

/// The first attributes, in OpenImageIO's order.
void add_first_attributes(PictureSpec& spec, const exr_attribute_t* environment, bool has_levels,
                          exr_tile_level_mode_t levels, exr_tile_round_mode_t rounding) {
    spec.attribute("oiio:ColorSpace", "Linear");
    if (has_levels) spec.attribute("openexr:roundingmode", static_cast<int>(rounding));
    if (environment && environment->type == EXR_ATTR_ENVMAP) {
        constexpr std::uint8_t kCube = 1;
        const bool is_cube = environment->uc == kCube;
        spec.attribute("textureformat", is_cube ? "CubeFace Environment" : "LatLong Environment");
        if (!is_cube) spec.attribute("oiio:updirection", "y");
        spec.attribute("oiio:sampleborder", 1);
        // The display window of a file with levels is a face.
        if (is_cube && has_levels) spec.full_width = spec.full_height = spec.width;
    } else if (levels == EXR_TILE_MIPMAP_LEVELS) {
        spec.attribute("textureformat", "Plain Texture");
    }
}

/// OpenImageIO removes a hash of the pixels where it is not sure that they are unchanged.
void remove_stale_hash(PictureSpec& spec) {
    const std::string software = lowercase(spec.get_string_attribute("Software"));
    const bool is_of_maketx = software.starts_with("openimageio") || software.starts_with("maketx");
    if (spec.tile_width == 0 || !is_of_maketx || spec.get_string_attribute("textureformat").empty())
        spec.erase_attribute("oiio:SHA-1");
}

}  // namespace

std::size_t ExrPart::pixel_bytes() const {
    std::size_t bytes = 0;
    for (const ExrChannel& channel : channels)
        bytes += channel.bytes();
    return bytes;
}

std::string_view compression_name(exr_compression_t compression) {
    for (const NamedCompression& named : kCompressions) {
        if (named.compression == compression) return named.name;
    }
    return {};
}

std::optional<exr_compression_t> compression_of(std::string_view name) {
    for (const NamedCompression& named : kCompressions) {
        if (named.name == name) return named.compression;
    }
    return std::nullopt;
}

OIIO::TypeDesc type_of(exr_pixel_type_t type) {
    return type == EXR_PIXEL_UINT ? T::UINT : type == EXR_PIXEL_HALF ? T::HALF : T::FLOAT;
}

exr_pixel_type_t pixel_type_of(const OIIO::TypeDesc& type) {
    return type == T::UINT ? EXR_PIXEL_UINT : type == T::HALF ? EXR_PIXEL_HALF : EXR_PIXEL_FLOAT;
}

/// True for luminance with chroma of half its resolution. "Technical Introduction to OpenEXR",
/// Luminance/Chroma Images.
static bool is_luminance_chroma(const exr_attr_chlist_t& channels) {
    int found = 0;
    for (int i = 0; i < channels.num_channels; ++i) {
        const exr_attr_chlist_entry_t& channel = channels.entries[i];
        const std::string name = text_of(channel.name);
        const bool is_chroma = name == "RY" || name == "BY";
        const int sampling = is_chroma ? 2 : 1;
        if (!is_chroma && name != "Y" && name != "A") return false;
        if (channel.x_sampling != sampling || channel.y_sampling != sampling ||
            channel.pixel_type != EXR_PIXEL_HALF)
            return false;
        found += name == "A" ? 0 : 1;
    }
    return found == 3;
}

std::optional<ExrPart> read_header(exr_const_context_t file, int part, int part_count) {
    ExrPart result;
    PictureSpec& spec = result.spec;
    exr_storage_t storage = EXR_STORAGE_LAST_TYPE;
    exr_attr_box2i_t data = {};
    exr_attr_box2i_t shown = {};
    const exr_attr_chlist_t* channels = nullptr;
    if (exr_get_storage(file, part, &storage) != EXR_ERR_SUCCESS ||
        exr_get_data_window(file, part, &data) != EXR_ERR_SUCCESS ||
        exr_get_display_window(file, part, &shown) != EXR_ERR_SUCCESS ||
        exr_get_compression(file, part, &result.compression) != EXR_ERR_SUCCESS ||
        exr_get_channels(file, part, &channels) != EXR_ERR_SUCCESS || !channels)
        return std::nullopt;
    if ((storage != EXR_STORAGE_SCANLINE && storage != EXR_STORAGE_TILED) ||
        compression_name(result.compression).empty() || !set_windows(spec, data, shown))
        return std::nullopt;
    result.is_luminance_chroma = is_luminance_chroma(*channels);
    for (int i = 0; i < channels->num_channels; ++i) {
        const exr_attr_chlist_entry_t& channel = channels->entries[i];
        std::string name = text_of(channel.name);
        if (result.is_luminance_chroma) {
            name = name == "Y" ? "G" : name == "RY" ? "R" : name == "BY" ? "B" : name;
        } else if (channel.x_sampling != 1 || channel.y_sampling != 1) {
            return std::nullopt;
        }
        result.channels.push_back({.name = std::move(name),
                                   .type = channel.pixel_type,
                                   .is_perceptually_linear = channel.p_linear != 0});
    }
    if (result.channels.empty()) return std::nullopt;
    order_channels(result.channels, spec);

    exr_tile_level_mode_t levels = EXR_TILE_ONE_LEVEL;
    exr_tile_round_mode_t rounding = EXR_TILE_ROUND_DOWN;
    result.is_tiled = storage == EXR_STORAGE_TILED;
    if (result.is_tiled) {
        std::uint32_t width = 0;
        std::uint32_t height = 0;
        if (exr_get_tile_descriptor(file, part, &width, &height, &levels, &rounding) !=
                EXR_ERR_SUCCESS ||
            width < 1 || height < 1 || width > INT32_MAX || height > INT32_MAX)
            return std::nullopt;
        spec.tile_width = static_cast<int>(width);
        spec.tile_height = static_cast<int>(height);
        result.rows_of_block = spec.tile_height;
    } else if (exr_get_scanlines_per_chunk(file, part, &result.rows_of_block) != EXR_ERR_SUCCESS) {
        return std::nullopt;
    }

    const exr_attribute_t* environment = nullptr;
    if (exr_get_attribute_by_name(file, part, "envmap", &environment) != EXR_ERR_SUCCESS)
        environment = nullptr;
    add_first_attributes(spec, environment, levels != EXR_TILE_ONE_LEVEL, levels, rounding);
    spec.attribute("compression", compression_name(result.compression));
    std::int32_t count = 0;
    if (exr_get_attribute_count(file, part, &count) != EXR_ERR_SUCCESS) return std::nullopt;
    std::string name;
    for (int i = 0; i < count; ++i) {
        const exr_attribute_t* attribute = nullptr;
        if (exr_get_attribute_by_index(file, part, EXR_ATTR_LIST_SORTED_ORDER, i, &attribute) !=
            EXR_ERR_SUCCESS)
            return std::nullopt;
        if (attribute->type == EXR_ATTR_STRING && std::string_view(attribute->name) == "name")
            name = text_of(*attribute->string);
        add_attribute(spec, *attribute);
    }
    if (const float density = spec.get_float_attribute("XResolution"); density != 0) {
        const float aspect = spec.get_float_attribute("PixelAspectRatio");
        spec.attribute("YResolution", density * (aspect != 0 ? aspect : 1.0F));
        spec.attribute("ResolutionUnit", "in");
    }
    if (!name.empty()) spec.attribute("oiio:subimagename", name);
    spec.attribute("oiio:subimages", part_count);
    remove_stale_hash(spec);
    return result;
}

TONEWRIGHT_NAMESPACE_END
