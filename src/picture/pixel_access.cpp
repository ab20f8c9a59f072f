// SPDX-License-Identifier: Apache-2.0
#include "picture/pixel_access.h"

#include <OpenImageIO/fmath.h>
#include <OpenImageIO/half.h>

#include <cstdint>
#include <cstring>
#include <type_traits>

#include "picture/half_float.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

// Values go through memcpy: a caller's buffer may have any alignment.

template <class Pixel, class Value>
void load(const std::byte* from, std::ptrdiff_t stride, Value* to, std::size_t count) noexcept {
    for (std::size_t i = 0; i < count; ++i, from += stride) {
        Pixel pixel;
        std::memcpy(&pixel, from, sizeof pixel);
        to[i] = OIIO::convert_type<Pixel, Value>(pixel);
    }
}

template <class Pixel, class Value>
void store(const Value* from, std::byte* to, std::ptrdiff_t stride, std::size_t count) noexcept {
    for (std::size_t i = 0; i < count; ++i, to += stride) {
        const Pixel pixel = OIIO::convert_type<Value, Pixel>(from[i]);
        std::memcpy(to, &pixel, sizeof pixel);
    }
}

template <class Pixel>
void run_to_float(const std::byte* from, float* to, std::size_t count) noexcept {
    if constexpr (std::is_same_v<Pixel, half>) {
        if (half_to_float(from, to, count)) return;
    }
    load<Pixel, float>(from, sizeof(Pixel), to, count);
}

template <class Pixel>
void run_from_float(const float* from, std::byte* to, std::size_t count) noexcept {
    if constexpr (std::is_same_v<Pixel, half>) {
        if (float_to_half(from, to, count)) return;
    }
    store<Pixel, float>(from, to, sizeof(Pixel), count);
}

template <std::size_t size>
void copy_bits(const std::byte* from, std::ptrdiff_t from_stride, std::byte* to,
               std::ptrdiff_t to_stride, std::size_t count) noexcept {
    for (std::size_t i = 0; i < count; ++i, from += from_stride, to += to_stride) {
        std::memmove(to, from, size);  // in place, source and destination are one
    }
}

template <class Pixel>
const PixelAccess* access_as() noexcept {
    static constexpr PixelAccess access = {
        load<Pixel, float>,  store<Pixel, float>,   load<Pixel, double>,     store<Pixel, double>,
        run_to_float<Pixel>, run_from_float<Pixel>, copy_bits<sizeof(Pixel)>};
    return &access;
}

}  // namespace

const PixelAccess* pixel_access(const OIIO::TypeDesc& type) noexcept {
    switch (type.basetype) {
        case OIIO::TypeDesc::UINT8:
            return access_as<std::uint8_t>();
        case OIIO::TypeDesc::INT8:
            return access_as<std::int8_t>();
        case OIIO::TypeDesc::UINT16:
            return access_as<std::uint16_t>();
        case OIIO::TypeDesc::INT16:
            return access_as<std::int16_t>();
        case OIIO::TypeDesc::UINT32:
            return access_as<std::uint32_t>();
        case OIIO::TypeDesc::INT32:
            return access_as<std::int32_t>();
        case OIIO::TypeDesc::HALF:
            return access_as<half>();
        case OIIO::TypeDesc::FLOAT:
            return access_as<float>();
        case OIIO::TypeDesc::DOUBLE:
            return access_as<double>();
        default:
            return nullptr;
    }
}

TONEWRIGHT_NAMESPACE_END
