// SPDX-License-Identifier: Apache-2.0
//
// Layout of the file: Khronos, "KTX File Format Specification", version 2.0, and "Khronos Data
// Format Specification", 1.3, for its descriptor.
#include "base/ktx2.h"

#include <bit>
#include <cstddef>
#include <cstdint>

#include "base/half_value.h"
#include "base/little_endian.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

constexpr std::uint32_t kSamples = 4;
constexpr std::uint32_t kDescriptor = 104;  // begins after the header and the index
constexpr std::uint32_t kDescriptorSize = 4 + 24 + 16 * kSamples;
constexpr std::uint32_t kKeys = kDescriptor + kDescriptorSize;

void append(std::string& bytes, std::uint64_t value, int size) {
    for (int i = 0; i < size; ++i)
        bytes += static_cast<char>(static_cast<unsigned char>(value >> (8 * i)));
}

/// A pair of a key and its text, padded to four bytes. Keys stand in alphabetical order.
void append_pair(std::string& bytes, const std::string& key, const std::string& text) {
    append(bytes, key.size() + text.size() + 2, 4);
    bytes.append(key).append(1, '\0').append(text).append(1, '\0');
    bytes.resize((bytes.size() + 3) / 4 * 4);
}

/// A basic descriptor block: linear RGB, primaries of Rec.709, four signed floats.
std::string descriptor(std::uint32_t bits) {
    std::string block;
    append(block, kDescriptorSize, 4);
    append(block, 0, 4);
    append(block, 2, 2);
    append(block, kDescriptorSize - 4, 2);
    append(block, 0x00010101, 4);
    append(block, 0, 4);
    append(block, std::uint64_t{kSamples} * bits / 8, 8);
    for (std::uint32_t i = 0; i < kSamples; ++i) {
        constexpr std::uint32_t kSignedFloat = 0xC0;
        constexpr std::uint32_t kAlpha = 15;
        append(block, bits * i, 2);
        append(block, bits - 1, 1);
        append(block, kSignedFloat | (i == 3 ? kAlpha : i), 1);
        append(block, 0, 4);
        append(block, std::bit_cast<std::uint32_t>(-1.0F), 4);
        append(block, std::bit_cast<std::uint32_t>(1.0F), 4);
    }
    return block;
}

}  // namespace

std::string ktx2_file(const std::vector<float>& rgba, const std::array<int, 3>& size,
                      Ktx2Texel texel, const std::string& notes) {
    const bool is_half = texel == Ktx2Texel::half;
    std::string texels;
    if (is_half) {
        for (const float value : rgba)
            append(texels, half_bits(static_cast<double>(value)), 2);
    } else {
        texels = little_endian_bytes(rgba);
    }
    std::string keys;
    append_pair(keys, "KTXwriter", "Tonewright " TONEWRIGHT_VERSION);
    if (!notes.empty()) append_pair(keys, "Tonewright", notes);
    constexpr std::size_t kAlignment = 16;  // of a texel, and of the level
    const std::size_t begin = (kKeys + keys.size() + kAlignment - 1) / kAlignment * kAlignment;
    std::string file("\xABKTX 20\xBB\r\n\x1A\n", 12);
    const std::uint32_t format = is_half ? 97 : 109;  // VK_FORMAT_R16G16B16A16_SFLOAT, R32...
    const auto depth = size[2] == 1 ? 0U : static_cast<std::uint32_t>(size[2]);
    const auto number = [](std::size_t value) { return static_cast<std::uint32_t>(value); };
    for (const std::uint32_t value :
         {format, is_half ? 2U : 4U, static_cast<std::uint32_t>(size[0]),
          static_cast<std::uint32_t>(size[1]), depth, 0U, 1U, 1U, 0U, kDescriptor, kDescriptorSize,
          kKeys, number(keys.size())})
        append(file, value, 4);
    append(file, 0, 16);  // no global data of a supercompression
    for (const std::size_t value : {begin, texels.size(), texels.size()})
        append(file, value, 8);
    file += descriptor(is_half ? 16 : 32) + keys;
    file.resize(begin);
    return file + texels;
}

TONEWRIGHT_NAMESPACE_END
