// SPDX-License-Identifier: Apache-2.0
//
// The program chooses between this and tonemap_file() by what the files are, so both must give the
// same bytes and the same messages.
#include "picture/tonemap_to_file.h"

#include <gtest/gtest.h>

#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "picture/exr_reader.h"
#include "tonewright/tonemap.h"
#include "unit/errors.h"
#include "unit/image/picture_files.h"
#include "unit/image/tonemapped.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

class TonemapOwnFile : public PictureFiles {
  protected:
    /// Messages of the pass, and the file.
    std::vector<std::string> run(const TonemapOptions& options, const std::string& in,
                                 const std::string& out, bool is_own) {
        std::vector<std::string> messages;
        WriteOptions write;
        write.write_provenance = true;
        ReadOptions read;
        write.warn = read.warn =
            read.note = [&](const std::string& text) { messages.push_back(text); };
        if (is_own) {
            EXPECT_TRUE(tonemap_own_file(RowTonemapper(options), open_exr(in, 2), in, out, write,
                                         read, {}, 2));
        } else {
            tonemap_file(Tonemapper(options), in, out, write, read, 2);
        }
        return messages;
    }
};

TEST_F(TonemapOwnFile, BytesAndMessagesAreThoseOfAllFormats) {
    for (const OIIO::TypeDesc::BASETYPE type : {OIIO::TypeDesc::HALF, OIIO::TypeDesc::FLOAT}) {
        for (const int channels : {1, 3, 4}) {
            write_image_atomically(noise_picture(channels, type), file("in.exr"), type);
            for (const std::string extension : {".png", ".exr", ".jpg"}) {
                const std::string own = file("own" + extension);
                const std::string all = file("all" + extension);
                EXPECT_EQ(run(hable(), file("in.exr"), own, true),
                          run(hable(), file("in.exr"), all, false));
                EXPECT_TRUE(read(own) == read(all)) << extension << " " << channels;
            }
        }
    }
}

TEST_F(TonemapOwnFile, EachRowIsReadOnce) {
    /// Counts the rows that a reader is asked for.
    class Counted final : public RowReader {
      public:
        Counted(std::unique_ptr<RowReader> rows, std::vector<int>& count)
            : rows_(std::move(rows)), count_(count) {
            count_.assign(static_cast<std::size_t>(rows_->spec(0).height), 0);
        }
        void use_threads(unsigned count) override { rows_->use_threads(count); }
        [[nodiscard]] bool has_picture(int number) override { return rows_->has_picture(number); }
        [[nodiscard]] const PictureSpec& spec(int picture) override { return rows_->spec(picture); }
        void read_rows(int picture, int ybegin, int yend, std::byte* to) override {
            for (int y = ybegin; y < yend; ++y)
                ++count_.at(static_cast<std::size_t>(y));
            rows_->read_rows(picture, ybegin, yend, to);
        }

      private:
        std::unique_ptr<RowReader> rows_;
        std::vector<int>& count_;
    };
    OIIO::ImageBuf picture(OIIO::ImageSpec(4000, 500, 3, OIIO::TypeDesc::HALF));
    OIIO::ImageBufAlgo::noise(picture, "uniform", 0.0F, 1.0F, false, 7);
    write_image_atomically(picture, file("in.exr"));
    for (const std::string out : {"out.png", "out.exr"}) {
        std::vector<int> count;
        auto rows = std::make_unique<Counted>(open_exr(file("in.exr"), 2), count);
        EXPECT_TRUE(tonemap_own_file(RowTonemapper(hable()), std::move(rows), file("in.exr"),
                                     file(out), {}, {}, {}, 2));
        EXPECT_EQ(count, std::vector<int>(500, 1)) << out;
    }
}

TEST_F(TonemapOwnFile, OtherPicturesAreLeftToOpenImageIO) {
    write_image_atomically(noise_picture(), file("in.tif"));
    write_image_atomically(noise_picture(), file("in.exr"));
    const auto is_done = [&](const TonemapOptions& options, const std::string& in,
                             const std::string& out, const ReadOptions& read = {},
                             const WriteOptions& write = {}) {
        return tonemap_own_file(RowTonemapper(options), open_exr(in, 1), in, out, write, read, {},
                                1);
    };
    EXPECT_FALSE(is_done(hable(), file("in.tif"), file("out.png")));
    EXPECT_FALSE(is_done(hable(), file("missing.exr"), file("out.png")));
    EXPECT_FALSE(is_done(hable(), file("in.exr"), file("out.png"), {.resize = "50%"}));
    WriteOptions verifies;
    verifies.verifies = true;
    EXPECT_FALSE(is_done(hable(), file("in.exr"), file("out.png"), {}, verifies));
    TonemapOptions measured;
    measured.op = resolve_picture_operator("drago");
    ASSERT_TRUE(RowTonemapper(measured).takes_statistics());
    EXPECT_FALSE(is_done(measured, file("in.exr"), file("out.png")));
    OIIO::ImageBuf turned = noise_picture();
    turned.specmod().attribute("Orientation", 6);
    write_image_atomically(turned, file("turned.exr"));
    EXPECT_FALSE(is_done(hable(), file("turned.exr"), file("out.png")));
    EXPECT_EQ(files(), 3U);
    EXPECT_NE(error_of([&] {
                  (void)is_done(hable(), file("in.exr"), file("out.tif"));
              }).find("only OpenImageIO"),
              std::string::npos);
}

}  // namespace
TONEWRIGHT_NAMESPACE_END
