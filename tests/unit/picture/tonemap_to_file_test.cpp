// SPDX-License-Identifier: Apache-2.0
//
// The program chooses between this and tonemap_file() by what the files are, so both must give the
// same bytes and the same messages.
#include "picture/tonemap_to_file.h"

#include <gtest/gtest.h>

#include <string>
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
    measured.op = resolve_picture_operator("reinhard_extended");
    if (RowTonemapper(measured).takes_statistics()) {
        EXPECT_FALSE(is_done(measured, file("in.exr"), file("out.png")));
    }
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
