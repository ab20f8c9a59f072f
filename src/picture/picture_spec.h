// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <OpenImageIO/typedesc.h>

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

#include "tonewright/version.h"

TONEWRIGHT_NAMESPACE_BEGIN

/// Bytes of a value of the type. OIIO::TypeDesc serves as plain data here: its functions that are
/// not inline belong to a library whose table of strings takes 24 MB and 30 ms at every start.
[[nodiscard]] TONEWRIGHT_API std::size_t size_of(const OIIO::TypeDesc& type);
/// True for half, float and double.
[[nodiscard]] TONEWRIGHT_API bool is_floating_point(const OIIO::TypeDesc& type);
/// The name of a single value's type, as OIIO::TypeDesc::c_str() gives it.
[[nodiscard]] TONEWRIGHT_API const char* name_of(const OIIO::TypeDesc& type);

/// Names of attributes and channels do not differ by the case of their letters (ASCII).
[[nodiscard]] TONEWRIGHT_API bool is_equal_but_for_case(std::string_view a, std::string_view b);
[[nodiscard]] TONEWRIGHT_API bool starts_with_but_for_case(std::string_view text,
                                                           std::string_view start);

/// One attribute of a header, as OIIO::ParamValue.
struct PictureAttribute {
    std::string name;
    OIIO::TypeDesc type;
    std::vector<std::byte> data;     // packed; empty for text
    std::vector<std::string> texts;  // of type STRING, one for each element

    /// The numbers, of a type that matches.
    template <class Number>
    [[nodiscard]] const Number* numbers() const {
        return reinterpret_cast<const Number*>(data.data());
    }
};

/// Size, channels and attributes of a picture: OIIO::ImageSpec with the same names and meanings,
/// for code that starts without OpenImageIO's libraries. Attributes are those that OpenImageIO's
/// readers give.
struct TONEWRIGHT_API PictureSpec {
    int x = 0, y = 0, z = 0;  // origin of the data window
    int width = 0, height = 0, depth = 1;
    int full_x = 0, full_y = 0, full_z = 0;  // origin of the display window
    int full_width = 0, full_height = 0, full_depth = 1;
    int tile_width = 0, tile_height = 0, tile_depth = 0;  // 0: rows
    int nchannels = 0;
    OIIO::TypeDesc format;                       // the widest of the channels
    std::vector<OIIO::TypeDesc> channelformats;  // empty: all are of `format`
    std::vector<std::string> channelnames;
    int alpha_channel = -1;
    int z_channel = -1;
    bool deep = false;
    std::vector<PictureAttribute> attributes;

    [[nodiscard]] OIIO::TypeDesc channelformat(int channel) const {
        const auto at = static_cast<std::size_t>(channel);
        return at < channelformats.size() ? channelformats[at] : format;
    }
    /// Empty: it has none.
    [[nodiscard]] std::string_view channel_name(int channel) const {
        const auto at = static_cast<std::size_t>(channel);
        return at < channelnames.size() ? std::string_view(channelnames[at]) : std::string_view();
    }
    [[nodiscard]] std::size_t pixel_bytes() const {
        return size_of(format) * static_cast<std::size_t>(nchannels);
    }
    [[nodiscard]] std::size_t scanline_bytes() const {
        return pixel_bytes() * static_cast<std::size_t>(width);
    }

    /// Sets an attribute; names are equal whatever the case of their letters.
    /// @param value  packed; of type STRING, an array of std::string
    void attribute(std::string_view name, OIIO::TypeDesc type, const void* value);
    void attribute(std::string_view name, int value);
    void attribute(std::string_view name, float value);
    void attribute(std::string_view name, std::string_view value);
    void erase_attribute(std::string_view name);
    /// Null: there is none.
    [[nodiscard]] const PictureAttribute* find_attribute(std::string_view name) const;
    /// Null: there is none of this type.
    [[nodiscard]] const PictureAttribute* find_attribute(std::string_view name,
                                                         const OIIO::TypeDesc& type) const;
    /// An attribute of one whole number; also of a text that is one.
    [[nodiscard]] int get_int_attribute(std::string_view name, int otherwise = 0) const;
    /// An attribute of one number; also of a text that is one.
    [[nodiscard]] float get_float_attribute(std::string_view name, float otherwise = 0) const;
    /// An attribute of one text.
    [[nodiscard]] std::string get_string_attribute(std::string_view name,
                                                   std::string_view otherwise = {}) const;
};

/// Copies all but the attributes, to or from OpenImageIO's type.
template <class To, class From>
void copy_structure(const From& from, To& to) {
    to.x = from.x;
    to.y = from.y;
    to.z = from.z;
    to.width = from.width;
    to.height = from.height;
    to.depth = from.depth;
    to.full_x = from.full_x;
    to.full_y = from.full_y;
    to.full_z = from.full_z;
    to.full_width = from.full_width;
    to.full_height = from.full_height;
    to.full_depth = from.full_depth;
    to.tile_width = from.tile_width;
    to.tile_height = from.tile_height;
    to.tile_depth = from.tile_depth;
    to.nchannels = from.nchannels;
    to.format = from.format;
    to.channelformats = from.channelformats;
    to.channelnames = from.channelnames;
    to.alpha_channel = from.alpha_channel;
    to.z_channel = from.z_channel;
    to.deep = from.deep;
}

TONEWRIGHT_NAMESPACE_END
