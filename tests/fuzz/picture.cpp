// SPDX-License-Identifier: Apache-2.0
//
// libFuzzer: pictures of LUTs. The first bytes choose the size and the channels, the others are
// pixels. A LUT that is read has all its nodes, and they are finite.
#include <OpenImageIO/imagebuf.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <string_view>
#include <vector>

#include "image/lut_picture.h"
#include "tonewright/error.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    using namespace tonewright;  // NOLINT(google-build-using-namespace): this is its program
    constexpr std::array<std::array<int, 2>, 6> kSizes = {
        {{8, 8}, {27, 27}, {4, 2}, {9, 3}, {16, 4}, {0, 0}}};
    if (size < 4) return 0;
    auto [width, height] = kSizes.at(data[0] % kSizes.size());
    if (width == 0) {
        width = data[1] % 32 + 1;
        height = data[2] % 32 + 1;
    }
    OIIO::ImageSpec spec(width, height, data[3] % 6 + 1, OIIO::TypeDesc::FLOAT);
    if (data[3] >= 128)
        spec.attribute("ImageDescription", "3D LUT as a strip, green from the bottom up");
    spec.x = data[3] >= 64 ? -3 : 0;
    std::vector<float> pixels(spec.image_pixels() * static_cast<std::size_t>(spec.nchannels), 1.0F);
    std::memcpy(pixels.data(), data + 4, std::min(size - 4, pixels.size() * sizeof(float)));
    try {
        const Lut lut = lut_of_picture(OIIO::ImageBuf(spec, pixels.data()), "x.exr");
        const auto n = static_cast<std::size_t>(lut.size);
        if (n < 2 || lut.values.size() != 3 * n * n * n) std::abort();
        for (const float v : lut.values) {
            if (!std::isfinite(v)) std::abort();
        }
    } catch (const FileError& e) {
        // One line, always.
        if (std::string_view(e.what()).find('\n') != std::string_view::npos) std::abort();
    }
    return 0;
}
