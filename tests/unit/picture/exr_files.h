// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <OpenImageIO/imageio.h>
#include <fcntl.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <memory>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include "picture/exr_attributes.h"
#include "picture/exr_header.h"
#include "picture/exr_reader.h"
#include "picture/exr_writer.h"
#include "picture/picture_spec.h"
#include "picture/row_files.h"
#include "unit/folder.h"

/// EXR files of OpenImageIO, which is the reference of our reader and writer.
TONEWRIGHT_NAMESPACE_BEGIN

/// Bits of all numbers of a type: also infinities, NaN and subnormal numbers.
inline std::vector<std::byte> noise_of(OIIO::TypeDesc type, std::size_t count, unsigned seed) {
    std::mt19937 random(seed);
    std::vector<std::byte> bytes(count * type.size());
    for (std::size_t i = 0; i < bytes.size(); ++i) {
        // Neighbors share their upper bits, as in pictures: every compression packs them.
        const bool is_upper = i % type.size() == type.size() - 1;
        bytes[i] = static_cast<std::byte>(is_upper && random() % 8 != 0 ? 0x3C : random());
    }
    return bytes;
}

/// Pixels of a file's picture as OpenImageIO reads them, in the type of its spec.
struct ReadPicture {
    OIIO::ImageSpec spec;
    std::vector<std::byte> pixels;
};
/// @returns  what could be read; with `error`, nothing after the first error
inline std::vector<ReadPicture> read_by_oiio(const std::string& path, std::string* error) {
    std::vector<ReadPicture> pictures;
    const auto in = OIIO::ImageInput::open(path);
    if (!in) {
        *error = OIIO::geterror();
        if (error->empty()) *error = "unknown";
        return pictures;
    }
    for (int i = 0; in->seek_subimage(i, 0); ++i) {
        ReadPicture picture;
        picture.spec = in->spec();
        const std::size_t values =
            picture.spec.image_pixels() * static_cast<std::size_t>(picture.spec.nchannels);
        picture.pixels.resize(values * picture.spec.format.size());
        if (!in->read_image(i, 0, 0, picture.spec.nchannels, picture.spec.format,
                            picture.pixels.data())) {
            *error = in->geterror() + "?";
            break;
        }
        pictures.push_back(std::move(picture));
    }
    (void)in->geterror();
    return pictures;
}

/// All rows of a picture, some at a time.
inline std::vector<std::byte> all_rows(RowReader& reader, int picture, int step) {
    const PictureSpec& spec = reader.spec(picture);
    if (spec.tile_height > 0)
        step = (step + spec.tile_height - 1) / spec.tile_height * spec.tile_height;
    std::vector<std::byte> pixels(spec.scanline_bytes() * static_cast<std::size_t>(spec.height));
    const int end = spec.y + spec.height;
    for (int y = spec.y; y < end; y += step) {
        reader.read_rows(
            picture, y, std::min(y + step, end),
            pixels.data() + spec.scanline_bytes() * static_cast<std::size_t>(y - spec.y));
    }
    return pixels;
}

/// OpenImageIO's attribute in our type.
inline PictureAttribute attribute_of(const OIIO::ParamValue& value) {
    PictureAttribute made = {value.name().string(), value.type(), {}, {}};
    if (value.type().basetype == OIIO::TypeDesc::STRING) {
        const auto count = static_cast<int>(value.type().basevalues());
        for (int i = 0; i < count; ++i)
            made.texts.push_back(value.get_ustring_indexed(i).string());
    } else {
        const auto* const bytes = static_cast<const std::byte*>(value.data());
        made.data.assign(bytes, bytes + value.type().size());
    }
    return made;
}

inline PictureSpec spec_of(const OIIO::ImageSpec& from) {
    PictureSpec spec;
    copy_structure(from, spec);
    for (const OIIO::ParamValue& value : from.extra_attribs)
        spec.attributes.push_back(attribute_of(value));
    return spec;
}

inline void expect_same_attribute(const PictureAttribute& expected, const PictureSpec& spec) {
    const PictureAttribute* const found = spec.find_attribute(expected.name);
    ASSERT_TRUE(found) << expected.name;
    EXPECT_EQ(found->name, expected.name);
    EXPECT_TRUE(found->type == expected.type)
        << expected.name << ": " << found->type.c_str() << ", not " << expected.type.c_str();
    EXPECT_TRUE(found->data == expected.data) << expected.name;
    EXPECT_EQ(found->texts, expected.texts) << expected.name;
}

/// @param left_out  attributes that are not compared
inline void expect_same_spec(const OIIO::ImageSpec& expected, const PictureSpec& spec,
                             const std::vector<std::string>& left_out = {}) {
    PictureSpec wanted = spec_of(expected);
    PictureSpec given = spec;
    for (const std::string& name : left_out) {
        wanted.erase_attribute(name);
        given.erase_attribute(name);
    }
    EXPECT_EQ(std::vector<int>({given.x, given.y, given.z, given.width, given.height, given.depth}),
              std::vector<int>(
                  {wanted.x, wanted.y, wanted.z, wanted.width, wanted.height, wanted.depth}));
    EXPECT_EQ(std::vector<int>({given.full_x, given.full_y, given.full_z, given.full_width,
                                given.full_height, given.full_depth}),
              std::vector<int>({wanted.full_x, wanted.full_y, wanted.full_z, wanted.full_width,
                                wanted.full_height, wanted.full_depth}));
    EXPECT_EQ(std::vector<int>({given.tile_width, given.tile_height, given.tile_depth}),
              std::vector<int>({wanted.tile_width, wanted.tile_height, wanted.tile_depth}));
    EXPECT_EQ(given.nchannels, wanted.nchannels);
    EXPECT_EQ(given.channelnames, wanted.channelnames);
    EXPECT_TRUE(given.format == wanted.format) << given.format.c_str();
    EXPECT_TRUE(given.channelformats == wanted.channelformats);
    EXPECT_EQ(given.alpha_channel, wanted.alpha_channel);
    EXPECT_EQ(given.z_channel, wanted.z_channel);
    EXPECT_EQ(given.deep, wanted.deep);
    EXPECT_EQ(given.attributes.size(), wanted.attributes.size());
    for (const PictureAttribute& attribute : wanted.attributes)
        expect_same_attribute(attribute, given);
}

/// A picture of noise that OpenImageIO writes.
inline void write_by_oiio(const std::string& path, const std::vector<OIIO::ImageSpec>& specs,
                          unsigned seed) {
    const auto out = OIIO::ImageOutput::create(path);
    ASSERT_TRUE(out);
    for (std::size_t i = 0; i < specs.size(); ++i) {
        const OIIO::ImageSpec& spec = specs[i];
        const bool is_open = i > 0 ? out->open(path, spec, OIIO::ImageOutput::AppendSubimage)
                             : specs.size() > 1
                                 ? out->open(path, static_cast<int>(specs.size()), specs.data())
                                 : out->open(path, spec);
        ASSERT_TRUE(is_open) << out->geterror();
        std::vector<std::byte> pixels;
        if (spec.channelformats.empty()) {
            pixels = noise_of(spec.format,
                              spec.image_pixels() * static_cast<std::size_t>(spec.nchannels), seed);
            ASSERT_TRUE(out->write_image(spec.format, pixels.data())) << out->geterror();
        } else {
            pixels = noise_of(OIIO::TypeUInt8, spec.image_bytes(true), seed);
            ASSERT_TRUE(out->write_image(OIIO::TypeUnknown, pixels.data())) << out->geterror();
        }
    }
    ASSERT_TRUE(out->close());
}

/// A descriptor for as long as it is needed.
class Descriptor {
  public:
    explicit Descriptor(const std::string& path)
        : number_(::open(path.c_str(), O_CREAT | O_TRUNC | O_WRONLY, 0600)) {}
    ~Descriptor() { ::close(number_); }
    Descriptor(const Descriptor&) = delete;
    Descriptor& operator=(const Descriptor&) = delete;
    [[nodiscard]] int number() const { return number_; }

  private:
    int number_;
};

/// Writes rows of a type by our writer.
/// @param steps  rows of the calls, again from the first when they are used
inline void write_by_us(const std::string& path, const PictureSpec& spec, OIIO::TypeDesc type,
                        const std::vector<std::byte>& pixels, const std::vector<int>& steps) {
    const Descriptor file(path);
    const auto writer = create_exr(file.number(), spec, 2);
    ASSERT_TRUE(writer);
    const std::size_t row = type.size() * static_cast<std::size_t>(spec.nchannels) *
                            static_cast<std::size_t>(spec.width);
    int at = 0;
    for (std::size_t i = 0; at < spec.height; ++i) {
        const int count = std::min(steps[i % steps.size()], spec.height - at);
        writer->write_rows(count, type, pixels.data() + static_cast<std::size_t>(at) * row);
        at += count;
    }
    writer->finish();
}

/// The same picture, written by both libraries and read by OpenImageIO.
inline void expect_same_file(const OIIO::ImageSpec& spec, OIIO::TypeDesc type,
                             const std::vector<std::byte>& pixels, const std::vector<int>& steps) {
    const Folder folder;
    auto out = OIIO::ImageOutput::create("exr");
    ASSERT_TRUE(out->open(folder / "oiio.exr", spec)) << out->geterror();
    ASSERT_TRUE(out->write_image(type, pixels.data())) << out->geterror();
    const OIIO::ImageSpec fitted = out->spec();
    out.reset();  // for it, an environment map is not complete after close()

    PictureSpec asked = spec_of(spec);
    // The time of writing, which both add, may differ by a second.
    asked.attribute("DateTime", fitted.get_string_attribute("DateTime"));
    write_by_us(folder / "ours.exr", asked, type, pixels, steps);
    std::string error;
    const ReadPicture expected = read_by_oiio(folder / "oiio.exr", &error).at(0);
    const ReadPicture given = read_by_oiio(folder / "ours.exr", &error).at(0);
    ASSERT_EQ(error, "");
    expect_same_spec(expected.spec, spec_of(given.spec));
    const auto reader = open_exr(folder / "ours.exr", 1);
    ASSERT_TRUE(reader);
    expect_same_spec(expected.spec, reader->spec(0));
    EXPECT_TRUE(given.pixels == expected.pixels);
    {
        const Descriptor file(folder / "spec.exr");
        const auto writer = create_exr(file.number(), asked, 1);
        ASSERT_TRUE(writer);
        expect_same_spec(fitted, writer->spec());
    }
    // The header is the same, byte for byte.
    const auto compression = compression_of(fitted.get_string_attribute("compression"));
    ASSERT_TRUE(compression);
    const std::string header = exr_header_of(spec_of(fitted), *compression);
    EXPECT_TRUE(read(folder / "oiio.exr").starts_with(header));
    EXPECT_TRUE(read(folder / "ours.exr").starts_with(header));
}

/// A window with an origin beside that of the display window.
inline OIIO::ImageSpec spec_of_size(int width, int height, std::vector<std::string> names,
                                    OIIO::TypeDesc type) {
    OIIO::ImageSpec spec(width, height, static_cast<int>(names.size()), type);
    spec.channelnames = std::move(names);
    spec.x = -5;
    spec.y = -33;
    spec.full_x = 2;
    spec.full_width = 50;
    spec.full_height = 40;
    return spec;
}

TONEWRIGHT_NAMESPACE_END
