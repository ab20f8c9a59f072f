// SPDX-License-Identifier: Apache-2.0
#include "picture/file_writer.h"

#include <OpenImageIO/imagebuf.h>
#include <gtest/gtest.h>

#include <memory>
#include <string>
#include <vector>

#include "unit/errors.h"
#include "unit/folder.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

PictureSpec rgb(int width, int height) {
    PictureSpec spec;
    spec.width = spec.full_width = width;
    spec.height = spec.full_height = height;
    spec.nchannels = 3;
    spec.channelnames = {"R", "G", "B"};
    spec.format = OIIO::TypeDesc::FLOAT;
    return spec;
}

void write_picture(FileWriter& writer, const PictureSpec& spec, const std::vector<float>& pixels) {
    writer.open(spec);
    writer.write_rows(
        {0, spec.height, OIIO::TypeDesc::FLOAT, reinterpret_cast<const std::byte*>(pixels.data())});
    writer.finish();
}

TEST(FileWriter, FilesOfOurWritersAreReadByOpenImageIO) {
    const Folder folder;
    const std::vector<float> pixels = {0, 0.25F, 1, 0.5F, 0.125F, 0.75F};
    for (const char* name : {"a.png", "a.exr", "a.jpg"}) {
        const std::string path = folder / name;
        FileWriter writer(path, {}, 2, own_writers());
        write_picture(writer, rgb(2, 1), pixels);
        OIIO::ImageBuf picture(path);
        ASSERT_TRUE(picture.read(0, 0, true, OIIO::TypeDesc::FLOAT)) << picture.geterror();
        for (int i = 0; i < 6; ++i) {
            const float found = picture.getchannel(i / 3, 0, 0, i % 3);
            // Half a code of 8 bits, and the rounding of floats; JPEG of
            // quality 98 rounds the coefficients of a block to steps of 1 to 5 codes.
            const float bound = std::string(name) == "a.exr"   ? 0
                                : std::string(name) == "a.png" ? 0.501F / 255
                                                               : 5.0F / 255;
            EXPECT_NEAR(found, pixels[static_cast<std::size_t>(i)], bound) << name << " " << i;
        }
    }
    EXPECT_EQ(folder.files(), (std::vector<std::string>{"a.exr", "a.jpg", "a.png"}));
}

TEST(FileWriter, OtherFormatsAreRefusedBeforeAFileIsThere) {
    const Folder folder;
    EXPECT_EQ(error_of([&] { FileWriter(folder / "a.tif", {}, 1, own_writers()); }),
              folder / "a.tif" + ": cannot write: only OpenImageIO writes this format");
    EXPECT_NE(error_of([&] {
                  FileWriter(folder / "a.png", {.bits = 10}, 1, own_writers());
              }).find("type is uint10"),
              std::string::npos);
    EXPECT_TRUE(folder.files().empty());
}

TEST(FileWriter, InfiniteHalvesAreCounted) {
    const Folder folder;
    std::string warning;
    WriteOptions options;
    options.type = OIIO::TypeDesc::HALF;
    options.warn = [&](const std::string& text) { warning = text; };
    FileWriter writer(folder / "a.exr", options, 1, own_writers());
    // IEEE 754: halves end at 65504; 65520 and more round to infinity.
    write_picture(writer, rgb(4, 1), {65519, 0, 0, 65520, 0, 0, 1, 1, 1, 0, -70000, 0});
    EXPECT_EQ(warning,
              "50 % of the pixels are infinite, because half ends at 65504; <<pixel_type=float>> "
              "keeps them");
}

TEST(FileWriter, AFailedFileLeavesNothingAndKeepsTheOldOne) {
    class FullDisk final : public RowWriter {
      public:
        explicit FullDisk(PictureSpec spec) : spec_(std::move(spec)) {}
        [[nodiscard]] const PictureSpec& spec() const override { return spec_; }
        void write_rows(int /*row_count*/, OIIO::TypeDesc /*type*/,
                        const std::byte* /*rows*/) override {
            throw FileError("No space left on device");
        }
        void finish() override {}

      private:
        PictureSpec spec_;
    };
    FormatWriters writers = own_writers();
    writers.create = [](const std::string&, const PictureSpec& spec, const NewFile&) {
        return std::make_unique<FullDisk>(spec);
    };
    const Folder folder;
    write(folder / "a.png", "old");
    FileWriter writer(folder / "a.png", {}, 1, writers);
    EXPECT_EQ(error_of([&] {
                  write_picture(writer, rgb(1, 1), {0, 0, 0});
              }),
              folder / "a.png" + ": cannot write: No space left on device");
    EXPECT_EQ(read(folder / "a.png"), "old");
}

TEST(FileWriter, AFaultOfTheFinishedFileKeepsTheOldOne) {
    FormatWriters writers = own_writers();
    writers.fault_of = [](const WrittenFile& written) {
        EXPECT_EQ(written.format, "png");
        EXPECT_EQ(written.spec.width, 1);
        return "it is black";
    };
    const Folder folder;
    write(folder / "a.png", "old");
    {
        FileWriter writer(folder / "a.png", {}, 1, writers);
        EXPECT_EQ(error_of([&] {
                      write_picture(writer, rgb(1, 1), {0, 0, 0});
                  }),
                  folder / "a.png" + ": cannot write: it is black");
    }
    EXPECT_EQ(folder.files(), std::vector<std::string>{"a.png"});
    EXPECT_EQ(read(folder / "a.png"), "old");
}

}  // namespace
TONEWRIGHT_NAMESPACE_END
