// SPDX-License-Identifier: Apache-2.0
#include "picture/file_reader.h"

#include <gtest/gtest.h>

#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "unit/errors.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

/// A file in memory; the value of a sample is 100 part + channel.
class FakeRows final : public RowReader {
  public:
    explicit FakeRows(std::vector<PictureSpec> parts) : parts_(std::move(parts)) {}
    void use_threads(unsigned /*count*/) override {}
    [[nodiscard]] bool has_picture(int number) override {
        return number >= 0 && number < static_cast<int>(parts_.size());
    }
    [[nodiscard]] const PictureSpec& spec(int picture) override {
        return parts_.at(static_cast<std::size_t>(picture));
    }
    void read_rows(int picture, int ybegin, int yend, std::byte* to) override {
        const PictureSpec& is = spec(picture);
        if (is.find_attribute("damaged")) throw FileError("row 3 is damaged");
        auto* value = reinterpret_cast<float*>(to);
        for (int i = 0; i < (yend - ybegin) * is.width * is.nchannels; ++i)
            *value++ = static_cast<float>(100 * picture + i % is.nchannels);
    }

  private:
    std::vector<PictureSpec> parts_;
};

PictureSpec part(const std::string& name, const std::vector<std::string>& channels) {
    PictureSpec spec;
    spec.width = spec.full_width = 2;
    spec.height = spec.full_height = 2;
    spec.nchannels = static_cast<int>(channels.size());
    spec.channelnames = channels;
    spec.format = OIIO::TypeDesc::FLOAT;
    if (!name.empty()) spec.attribute("oiio:subimagename", name);
    return spec;
}

FileReader reader_of(const std::vector<PictureSpec>& parts, const ReadOptions& options = {},
                     const char* format = "openexr") {
    return {"a.exr", format, std::make_unique<FakeRows>(parts), options};
}

std::vector<float> first_pixel(FileReader& reader) {
    const PictureSpec& spec = reader.spec();
    std::vector<float> row(static_cast<std::size_t>(spec.width * spec.nchannels));
    reader.read_rows(0, 1, reinterpret_cast<std::byte*>(row.data()));
    row.resize(static_cast<std::size_t>(spec.nchannels));
    return row;
}

TEST(FileReader, ThePartInColorIsChosenAndNamed) {
    const std::vector<PictureSpec> parts = {part("depth", {"Z"}),
                                            part("crypto", {"crypto.R", "crypto.G", "crypto.B"}),
                                            part("beauty", {"B", "G", "R"})};
    std::string note;
    ReadOptions options;
    options.note = [&](const std::string& text) { note = text; };
    FileReader reader = reader_of(parts, options);
    EXPECT_EQ(reader.subimage(), 2);
    EXPECT_EQ(note,
              "subimage is 2 (beauty), of depth, crypto, beauty; <<subimage>> chooses another");
    // Red is the file's third channel.
    EXPECT_EQ(first_pixel(reader), (std::vector<float>{202, 201, 200}));
    EXPECT_EQ(reader_of(parts, {}, "tiff").subimage(), 0);
}

TEST(FileReader, PartsAndLayersAreChosenByName) {
    const std::vector<PictureSpec> parts = {
        part("one", {"R", "G", "B"}), part("two", {"R", "G", "B", "glow.R", "glow.G", "glow.B"})};
    ReadOptions options;
    options.subimage = "TWO";
    options.layer = "glow";
    FileReader reader = reader_of(parts, options);
    EXPECT_EQ(first_pixel(reader), (std::vector<float>{103, 104, 105}));
    EXPECT_EQ(reader.spec().channelnames, (std::vector<std::string>{"R", "G", "B"}));
    options.layer = "glowing";
    EXPECT_EQ(error_of([&] { (void)reader_of(parts, options); }),
              "a.exr: cannot read: it has no layer glowing; expected one of RGB, glow");
    options = {.subimage = "three"};
    EXPECT_EQ(
        error_of([&] { (void)reader_of(parts, options); }),
        "a.exr: cannot read: it has no subimage three; the first is 0, and names are one, two");
}

TEST(FileReader, PicturesWithoutPixelsOrWithTooManyAreRefused) {
    PictureSpec large = part("", {"R", "G", "B"});
    large.width = 2000;
    large.height = 1000;
    ReadOptions options;
    options.max_pixels = 1e6;
    EXPECT_EQ(error_of([&] { (void)reader_of({large}, options); }),
              "a.exr: cannot read: it declares 2000 x 1000 pixels; expected at most 1000000 in all "
              "(max_pixels)");
    large.width = 0;
    EXPECT_NE(error_of([&] { (void)reader_of({large}); }).find("expected at least 1 x 1"),
              std::string::npos);
    PictureSpec deep = part("", {"R", "G", "B"});
    deep.deep = true;
    EXPECT_NE(error_of([&] { (void)reader_of({deep}); }).find("the picture is deep"),
              std::string::npos);
}

TEST(FileReader, ErrorsOfRowsNameTheFile) {
    PictureSpec damaged = part("", {"R", "G", "B"});
    damaged.attribute("damaged", 1);
    FileReader reader = reader_of({damaged});
    EXPECT_EQ(error_of([&] { (void)first_pixel(reader); }), "a.exr: cannot read: row 3 is damaged");
}

TEST(FileReader, DataInsteadOfColorIsReported) {
    std::string warning;
    ReadOptions options;
    options.warn = [&](const std::string& text) { warning = text; };
    (void)reader_of({part("", {"N.X", "N.Y", "N.Z"})}, options);
    EXPECT_EQ(warning, "no layer is a picture in color: channels N.X, N.Y, N.Z are taken");
    warning.clear();
    (void)reader_of({part("", {"Y", "RY", "BY"})}, options);
    EXPECT_EQ(warning, "");
}

}  // namespace
TONEWRIGHT_NAMESPACE_END
