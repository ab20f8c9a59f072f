// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <OpenImageIO/imagebufalgo.h>
#include <gtest/gtest.h>

#include <cstddef>
#include <exception>
#include <filesystem>
#include <iterator>
#include <string>
#include <vector>

#include "tonewright/error.h"
#include "tonewright/image_io.h"
#include "tonewright/registry.h"
#include "tonewright/tonemap.h"
#include "unit/folder.h"
#include "unit/image/pictures.h"

/// Files of pictures, and what readers and writers say of them.
TONEWRIGHT_NAMESPACE_BEGIN

/// A folder, and how many files it holds.
class PictureFiles : public testing::Test {
  protected:
    [[nodiscard]] std::string file(const std::string& name) const { return folder_ / name; }
    [[nodiscard]] std::size_t files() const {
        return static_cast<std::size_t>(
            std::distance(std::filesystem::directory_iterator(folder_.path()), {}));
    }

    Folder folder_;
};

/// Large enough that a file has several blocks; not compressible to nothing.
inline OIIO::ImageBuf noise_picture(int channels = 3, OIIO::TypeDesc type = OIIO::TypeDesc::FLOAT) {
    OIIO::ImageBuf picture(OIIO::ImageSpec(160, 120, channels, type));
    OIIO::ImageBufAlgo::noise(picture, "uniform", 0.0F, 1.0F, false, 7);
    return picture;
}

template <class Function>
std::string message_of(Function&& function) {
    try {
        function();
    } catch (const FileError& e) {
        return e.what();
    } catch (const std::exception& e) {
        return std::string("not a FileError: ") + e.what();
    }
    return "no error";
}

inline void expect_file_error(const std::string& message, const std::string& path,
                              const std::string& reason) {
    EXPECT_TRUE(message.starts_with(path + ": cannot ")) << message;
    EXPECT_NE(message.find(reason), std::string::npos) << message;
    EXPECT_EQ(message.find('\n'), std::string::npos) << message;
}

/// Writes a picture, and returns what the writer warned of.
inline std::vector<std::string> warnings_of(const OIIO::ImageBuf& picture, const std::string& path,
                                            WriteOptions options = {}) {
    std::vector<std::string> warnings;
    options.warn = [&](const std::string& text) { warnings.push_back(text); };
    write_image_atomically(picture, path, options);
    return warnings;
}

inline OIIO::ImageBuf shown_on(const std::string& display, int channels = 3) {
    const OIIO::ImageBuf scene =
        channels == 3 ? make_rgb(24, 17)
                      : make_picture(make_spec(24, 17, {"Y"}, OIIO::TypeDesc::FLOAT));
    return tonemap(scene, {.op = resolve_picture_operator("clamp"), .display = display});
}

TONEWRIGHT_NAMESPACE_END
