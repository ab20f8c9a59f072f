// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <OpenImageIO/imagebuf.h>
#include <OpenImageIO/imagecache.h>
#include <gtest/gtest.h>

#include <cstdint>
#include <cstring>
#include <filesystem>
#include <string>
#include <vector>

#include "tonewright/version.h"
#include "unit/folder.h"
#include "unit/noise.h"

/// Small pictures for tests.
TONEWRIGHT_NAMESPACE_BEGIN

inline OIIO::ImageSpec make_spec(int width, int height, std::vector<std::string> channels,
                                 OIIO::TypeDesc type) {
    OIIO::ImageSpec spec(width, height, static_cast<int>(channels.size()), type);
    spec.alpha_channel = -1;
    for (std::size_t c = 0; c < channels.size(); ++c) {
        if (channels[c] == "A") spec.alpha_channel = static_cast<int>(c);
        if (channels[c] == "Z") spec.z_channel = static_cast<int>(c);
    }
    spec.channelnames = std::move(channels);
    return spec;
}

/// Noise up to `peak` in every channel, stored as OIIO converts it.
inline OIIO::ImageBuf make_picture(const OIIO::ImageSpec& spec, float peak = 1) {
    OIIO::ImageBuf picture(spec);
    std::vector<float> values(static_cast<std::size_t>(spec.image_pixels()) *
                              static_cast<std::size_t>(spec.nchannels));
    for (std::size_t i = 0; i < values.size(); ++i) {
        values[i] = peak * noise(static_cast<std::uint32_t>(i));
    }
    EXPECT_TRUE(picture.set_pixels(picture.roi(), OIIO::TypeDesc::FLOAT, values.data()));
    return picture;
}

inline OIIO::ImageBuf make_rgb(int width, int height, OIIO::TypeDesc type = OIIO::TypeDesc::FLOAT,
                               float peak = 1) {
    return make_picture(make_spec(width, height, {"R", "G", "B"}, type), peak);
}

/// A file's picture by way of OpenImageIO's cache. Without it, version 3 reads the file into
/// memory.
inline OIIO::ImageBuf cached_picture(const std::string& path) {
    return OIIO::ImageBuf(path, 0, 0, OIIO::ImageCache::create());
}

/// Half of a tiled OpenEXR file.
inline void write_truncated(const std::string& path) {
    OIIO::ImageBuf picture = make_rgb(200, 200, OIIO::TypeDesc::HALF);
    picture.set_write_tiles(32, 32);
    ASSERT_TRUE(picture.write(path));
    std::filesystem::resize_file(path, std::filesystem::file_size(path) / 2);
}

inline std::vector<float> pixel(const OIIO::ImageBuf& picture, int x, int y) {
    std::vector<float> values(static_cast<std::size_t>(picture.nchannels()));
    picture.getpixel(x, y, values.data(), picture.nchannels());
    return values;
}

inline void set(OIIO::ImageBuf& picture, int x, int y, const std::vector<float>& values) {
    picture.setpixel(x, y, values.data(), static_cast<int>(values.size()));
}

inline bool same_bits(const OIIO::ImageBuf& a, const OIIO::ImageBuf& b) {
    return a.spec().format == b.spec().format && a.roi() == b.roi() &&
           std::memcmp(a.localpixels(), b.localpixels(), a.spec().image_bytes()) == 0;
}

TONEWRIGHT_NAMESPACE_END
