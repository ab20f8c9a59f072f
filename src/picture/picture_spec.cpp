// SPDX-License-Identifier: Apache-2.0
#include "picture/picture_spec.h"

#include <algorithm>
#include <charconv>
#include <cstring>
#include <utility>

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

template <class T>
T value_of(const PictureAttribute& attribute) {
    T value{};
    std::memcpy(&value, attribute.data.data(), sizeof value);
    return value;
}

bool is_single(const PictureAttribute& attribute) {
    return attribute.type.aggregate == OIIO::TypeDesc::SCALAR && attribute.type.arraylen == 0;
}

char lowercase(char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c + ('a' - 'A')) : c; }

/// The number that is all of the text.
template <class Number>
Number number_of(const std::string& text, Number otherwise) {
    Number value{};
    const char* const end = text.data() + text.size();
    const auto [stop, error] = std::from_chars(text.data(), end, value);
    return error == std::errc() && stop == end ? value : otherwise;
}

}  // namespace

std::size_t size_of(const OIIO::TypeDesc& type) {
    using T = OIIO::TypeDesc;
    const auto count = static_cast<std::size_t>(type.aggregate) *
                       static_cast<std::size_t>(type.arraylen > 0 ? type.arraylen : 1);
    switch (type.basetype) {
        case T::UINT8:
        case T::INT8:
            return count;
        case T::UINT16:
        case T::INT16:
        case T::HALF:
            return 2 * count;
        case T::UINT32:
        case T::INT32:
        case T::FLOAT:
            return 4 * count;
        case T::UINT64:
        case T::INT64:
        case T::DOUBLE:
            return 8 * count;
        default:
            return 0;
    }
}

bool is_floating_point(const OIIO::TypeDesc& type) {
    using T = OIIO::TypeDesc;
    return type.basetype == T::HALF || type.basetype == T::FLOAT || type.basetype == T::DOUBLE;
}

const char* name_of(const OIIO::TypeDesc& type) {
    switch (type.basetype) {
        case OIIO::TypeDesc::NONE:
            return "void";
        case OIIO::TypeDesc::UINT8:
            return "uint8";
        case OIIO::TypeDesc::INT8:
            return "int8";
        case OIIO::TypeDesc::UINT16:
            return "uint16";
        case OIIO::TypeDesc::INT16:
            return "int16";
        case OIIO::TypeDesc::UINT32:
            return "uint";
        case OIIO::TypeDesc::INT32:
            return "int";
        case OIIO::TypeDesc::UINT64:
            return "uint64";
        case OIIO::TypeDesc::INT64:
            return "int64";
        case OIIO::TypeDesc::HALF:
            return "half";
        case OIIO::TypeDesc::FLOAT:
            return "float";
        case OIIO::TypeDesc::DOUBLE:
            return "double";
        case OIIO::TypeDesc::STRING:
            return "string";
        case OIIO::TypeDesc::PTR:
            return "pointer";
        default:
            return "unknown";
    }
}

bool is_equal_but_for_case(std::string_view a, std::string_view b) {
    return a.size() == b.size() && std::equal(a.begin(), a.end(), b.begin(), [](char x, char y) {
               return lowercase(x) == lowercase(y);
           });
}

bool starts_with_but_for_case(std::string_view text, std::string_view start) {
    return is_equal_but_for_case(text.substr(0, start.size()), start);
}

void PictureSpec::attribute(std::string_view name, OIIO::TypeDesc type, const void* value) {
    PictureAttribute made = {std::string(name), type, {}, {}};
    if (type.basetype == OIIO::TypeDesc::STRING) {
        const auto* const texts = static_cast<const std::string*>(value);
        made.texts.assign(texts, texts + (type.arraylen > 0 ? type.arraylen : 1));
    } else {
        const auto* const bytes = static_cast<const std::byte*>(value);
        made.data.assign(bytes, bytes + size_of(type));
    }
    const auto old = std::find_if(attributes.begin(), attributes.end(), [&](const auto& other) {
        return is_equal_but_for_case(other.name, name);
    });
    if (old == attributes.end()) {
        attributes.push_back(std::move(made));
    } else {
        *old = std::move(made);
    }
}

void PictureSpec::attribute(std::string_view name, int value) {
    attribute(name, OIIO::TypeDesc(OIIO::TypeDesc::INT), &value);
}

void PictureSpec::attribute(std::string_view name, float value) {
    attribute(name, OIIO::TypeDesc(OIIO::TypeDesc::FLOAT), &value);
}

void PictureSpec::attribute(std::string_view name, std::string_view value) {
    const std::string text(value);
    attribute(name, OIIO::TypeDesc(OIIO::TypeDesc::STRING), &text);
}

void PictureSpec::erase_attribute(std::string_view name) {
    std::erase_if(attributes, [&](const auto& attribute) {
        return is_equal_but_for_case(attribute.name, name);
    });
}

const PictureAttribute* PictureSpec::find_attribute(std::string_view name) const {
    const auto found = std::find_if(attributes.begin(), attributes.end(), [&](const auto& other) {
        return is_equal_but_for_case(other.name, name);
    });
    return found == attributes.end() ? nullptr : &*found;
}

const PictureAttribute* PictureSpec::find_attribute(std::string_view name,
                                                    const OIIO::TypeDesc& type) const {
    const PictureAttribute* const found = find_attribute(name);
    return found && found->type == type ? found : nullptr;
}

int PictureSpec::get_int_attribute(std::string_view name, int otherwise) const {
    const PictureAttribute* const found = find_attribute(name);
    if (!found || !is_single(*found)) return otherwise;
    switch (found->type.basetype) {
        case OIIO::TypeDesc::INT:
            return value_of<int>(*found);
        case OIIO::TypeDesc::UINT:
            return static_cast<int>(value_of<unsigned>(*found));
        case OIIO::TypeDesc::INT16:
            return value_of<short>(*found);
        case OIIO::TypeDesc::UINT16:
            return value_of<unsigned short>(*found);
        case OIIO::TypeDesc::INT8:
            return value_of<signed char>(*found);
        case OIIO::TypeDesc::UINT8:
            return value_of<unsigned char>(*found);
        case OIIO::TypeDesc::STRING:
            return number_of(found->texts.front(), otherwise);
        default:
            return otherwise;
    }
}

float PictureSpec::get_float_attribute(std::string_view name, float otherwise) const {
    const PictureAttribute* const found = find_attribute(name);
    if (!found || !is_single(*found)) return otherwise;
    switch (found->type.basetype) {
        case OIIO::TypeDesc::FLOAT:
            return value_of<float>(*found);
        case OIIO::TypeDesc::DOUBLE:
            return static_cast<float>(value_of<double>(*found));
        case OIIO::TypeDesc::STRING:
            return number_of(found->texts.front(), otherwise);
        case OIIO::TypeDesc::UNKNOWN:
        case OIIO::TypeDesc::PTR:
            return otherwise;
        default:
            return static_cast<float>(get_int_attribute(name));
    }
}

std::string PictureSpec::get_string_attribute(std::string_view name,
                                              std::string_view otherwise) const {
    const PictureAttribute* const found = find_attribute(name);
    return std::string(found && is_single(*found) && !found->texts.empty()
                           ? std::string_view(found->texts.front())
                           : otherwise);
}

TONEWRIGHT_NAMESPACE_END
