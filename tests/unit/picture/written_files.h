// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <OpenImageIO/imageio.h>
#include <fcntl.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "picture/picture_spec.h"
#include "picture/row_files.h"
#include "unit/noise.h"

/// The same pictures by our writers and by OpenImageIO's.
TONEWRIGHT_NAMESPACE_BEGIN

inline PictureSpec picture_spec(const OIIO::ImageSpec& from) {
    PictureSpec spec;
    copy_structure(from, spec);
    for (const OIIO::ParamValue& value : from.extra_attribs) {
        if (value.type().basetype != OIIO::TypeDesc::STRING) {
            spec.attribute(value.name().string(), value.type(), value.data());
            continue;
        }
        std::vector<std::string> texts;
        for (int i = 0; i < value.nvalues() * static_cast<int>(value.type().numelements()); ++i)
            texts.push_back(value.get_string_indexed(i));
        spec.attribute(value.name().string(), value.type(), texts.data());
    }
    return spec;
}

/// A picture of 1 to 4 channels with straight alpha.
inline OIIO::ImageSpec straight_spec(int width, int height, int channels, OIIO::TypeDesc type) {
    OIIO::ImageSpec spec(width, height, channels, type);
    spec.alpha_channel = channels % 2 == 0 ? channels - 1 : -1;
    if (spec.alpha_channel >= 0) spec.attribute("oiio:UnassociatedAlpha", 1);
    return spec;
}

enum class Content { noise, flat, ramp, edges };

/// Values of a picture, also outside of 0 to 1.
inline std::vector<float> values_of(const OIIO::ImageSpec& spec, Content content) {
    const auto row = static_cast<std::size_t>(spec.width * spec.nchannels);
    std::vector<float> values(row * static_cast<std::size_t>(spec.height));
    constexpr float kHuge = std::numeric_limits<float>::infinity();
    const std::vector<float> edges = {0,
                                      1,
                                      -1,
                                      2,
                                      0.5F,
                                      1.5F / 255,
                                      2.5F / 255,
                                      254.5F / 255,
                                      kHuge,
                                      -kHuge,
                                      std::nanf(""),
                                      1e-30F,
                                      0.5F / 65535,
                                      65534.5F / 65535};
    for (std::size_t i = 0; i < values.size(); ++i) {
        const float ramp = static_cast<float>(i % row) / static_cast<float>(row);
        values[i] = content == Content::noise  ? noise(static_cast<std::uint32_t>(i))
                    : content == Content::flat ? 0.25F
                    : content == Content::ramp ? 1.2F * ramp - 0.1F
                                               : edges[i * 7 % edges.size()];
    }
    return values;
}

/// Gives rows to a writer, some at a time.
template <class T>
void give_rows(RowWriter& writer, const OIIO::TypeDesc& type, const std::vector<T>& values,
               int batch) {
    const PictureSpec& spec = writer.spec();
    const auto row = static_cast<std::size_t>(spec.width * spec.nchannels);
    for (int y = 0; y < spec.height; y += batch) {
        writer.write_rows(
            std::min(batch, spec.height - y), type,
            reinterpret_cast<const std::byte*>(&values[row * static_cast<std::size_t>(y)]));
    }
    writer.finish();
}

/// A descriptor, closed at the end.
class TestFile {
  public:
    explicit TestFile(const std::string& path, int flags = O_WRONLY | O_CREAT | O_TRUNC)
        : file_(::open(path.c_str(), flags | O_CLOEXEC, 0600)) {}
    ~TestFile() { ::close(file_); }
    TestFile(const TestFile&) = delete;
    TestFile& operator=(const TestFile&) = delete;
    operator int() const { return file_; }  // NOLINT(google-explicit-constructor)

  private:
    int file_;
};

inline void write_by_oiio(const std::string& path, const OIIO::ImageSpec& spec,
                          const std::vector<float>& values) {
    const std::unique_ptr<OIIO::ImageOutput> out = OIIO::ImageOutput::create(path);
    ASSERT_TRUE(out && out->open(path, spec));
    ASSERT_TRUE(out->write_image(OIIO::TypeDesc::FLOAT, values.data())) << out->geterror();
    ASSERT_TRUE(out->close());
}

/// Code values of a file as they are stored.
inline std::vector<unsigned char> codes_of(const std::string& path) {
    OIIO::ImageSpec straight;
    straight.attribute("oiio:UnassociatedAlpha", 1);
    const std::unique_ptr<OIIO::ImageInput> in = OIIO::ImageInput::open(path, &straight);
    if (!in) return {};
    std::vector<unsigned char> codes(in->spec().image_bytes());
    if (!in->read_image(0, 0, 0, -1, in->spec().format, codes.data())) codes.clear();
    return codes;
}

TONEWRIGHT_NAMESPACE_END
