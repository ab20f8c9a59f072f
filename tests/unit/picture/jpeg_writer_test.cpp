// SPDX-License-Identifier: Apache-2.0
#include "picture/jpeg_writer.h"

#include <OpenImageIO/imageio.h>
#include <gtest/gtest.h>

#include <cerrno>
#include <functional>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "tonewright/error.h"
#include "unit/folder.h"
#include "unit/picture/written_files.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

using OIIO::ImageSpec;
using OIIO::TypeDesc;

constexpr int kAllRows = 1 << 20;

std::string write_ours(const std::string& path, const ImageSpec& spec,
                       const std::vector<float>& values, int batch = kAllRows,
                       unsigned threads = 2) {
    const TestFile file(path);
    const std::unique_ptr<RowWriter> writer = create_jpeg(file, picture_spec(spec), threads);
    if (!writer) return {};
    give_rows(*writer, TypeDesc::FLOAT, values, batch);
    EXPECT_EQ(fault_of_jpeg(path, writer->spec()), "");
    return read(path);
}

/// Both files of a picture with these attributes are equal.
void expect_equal(const std::string& what, ImageSpec spec,
                  const std::function<void(ImageSpec&)>& change = {}) {
    const Folder folder;
    if (change) change(spec);
    const std::vector<float> values = values_of(spec, Content::noise);
    const std::string ours = write_ours(folder / "ours.jpg", spec, values);
    write_by_oiio(folder / "oiio.jpg", spec, values);
    ASSERT_NE(ours, "") << what;
    EXPECT_TRUE(ours == read(folder / "oiio.jpg")) << what;
}

const ImageSpec kSmall(21, 13, 3, TypeDesc::UINT8);

TEST(JpegWriter, FilesEqualThoseOfOpenImageIO) {
    for (const int channels : {1, 3}) {
        for (const auto& [width, height] :
             std::vector<std::pair<int, int>>{{1, 1}, {1, 9}, {9, 1}, {13, 7}, {300, 200}}) {
            for (const TypeDesc type : {TypeDesc::UINT8, TypeDesc::UINT16, TypeDesc::HALF})
                expect_equal("layout", ImageSpec(width, height, channels, type));
        }
    }
    const Folder folder;
    for (const Content content : {Content::flat, Content::ramp, Content::edges}) {
        const std::vector<float> values = values_of(kSmall, content);
        write_by_oiio(folder / "oiio.jpg", kSmall, values);
        EXPECT_EQ(write_ours(folder / "ours.jpg", kSmall, values), read(folder / "oiio.jpg"));
    }
}

TEST(JpegWriter, CompressionEqualsThatOfOpenImageIO) {
    for (const char* compression : {"jpeg", "jpeg:75", "jpeg:1", "jpeg:100", "jpeg:300", "jpeg:0",
                                    "JPEG:90", "zip", "zip:5", ""})
        expect_equal(compression, kSmall,
                     [&](ImageSpec& spec) { spec.attribute("compression", compression); });
    for (const int quality : {0, 50, 100})
        expect_equal("quality", kSmall,
                     [&](ImageSpec& spec) { spec.attribute("CompressionQuality", quality); });
    for (const char* sampling : {"4:4:4", "4:2:2", "4:2:0", "4:1:1", "4:4:0", ""}) {
        for (const int channels : {1, 3})
            expect_equal(sampling, ImageSpec(50, 40, channels, TypeDesc::UINT8),
                         [&](ImageSpec& spec) { spec.attribute("jpeg:subsampling", sampling); });
    }
    expect_equal("progressive", kSmall,
                 [](ImageSpec& spec) { spec.attribute("jpeg:progressive", 1); });
}

TEST(JpegWriter, AttributesEqualThoseOfOpenImageIO) {
    const auto with = [](const char* name, const auto& value) {
        return [=](ImageSpec& spec) { spec.attribute(name, value); };
    };
    for (const char* name : {"Software", "Artist", "Copyright", "ImageDescription", "DateTime",
                             "Comment", "tonewright:operator"}) {
        for (const char* text : {"ab", "abc", "abcd", "2026:11:30 12:34:56"})
            expect_equal(name, kSmall, with(name, text));
    }
    for (const int orientation : {0, 1, 6})
        expect_equal("Orientation", kSmall, with("Orientation", orientation));
    for (const char* space : {"sRGB", "Linear", "Gamma2.2", "Rec.2100-PQ"})
        expect_equal(space, kSmall, with("oiio:ColorSpace", space));
    expect_equal("numbers", kSmall, with("framesPerSecond", 24.0F));
    for (const char* name : {"ExposureTime", "FNumber", "XResolution", "YResolution"}) {
        for (const float number :
             {0.0F, 1.0F, 2.8F, 30.0F, 0.01F, 0.3F, 1.0F / 3, 72.5F, 300.0F, 1e-7F})
            expect_equal(name, kSmall, with(name, number));
    }
    expect_equal("history", kSmall, with("Exif:ImageHistory", "oiiotool a.exr -o b.exr"));
    for (const int space : {1, 65535})
        expect_equal("Exif:ColorSpace", kSmall, with("Exif:ColorSpace", space));
    expect_equal("Exif's directory", kSmall, [](ImageSpec& spec) {
        spec.attribute("Exif:ImageHistory", "oiiotool a.exr -o b.exr");
        spec.attribute("FNumber", 5.6F);
        spec.attribute("Software", "s");
        spec.attribute("ExposureTime", 30.0F);
        spec.attribute("oiio:ColorSpace", "sRGB");
    });
    expect_equal("all", kSmall, [](ImageSpec& spec) {
        spec.attribute("Copyright", "someone");
        spec.attribute("Orientation", 6);
        spec.attribute("DateTime", "2026:11:30 12:34:56");
        spec.attribute("oiio:ColorSpace", "sRGB");
        spec.attribute("XResolution", 300.0F);
        spec.attribute("Software", "Tonewright 0.1.0: agx_blender, exposure 0, display srgb");
        spec.attribute("ImageDescription", "a picture");
        spec.attribute("Artist", "a; b");
        const std::string profile(568, 'p');
        spec.attribute("ICCProfile", TypeDesc(TypeDesc::UINT8, 568), profile.data());
    });
}

TEST(JpegWriter, InversesAreFractions) {
    // OpenImageIO 2.4 writes 1/0.
    const Folder folder;
    ImageSpec spec = kSmall;
    spec.attribute("ExposureTime", 1.0F / 64);
    write_ours(folder / "a.jpg", spec, values_of(spec, Content::flat));
    const auto in = OIIO::ImageInput::open(folder / "a.jpg");
    ASSERT_TRUE(in);
    EXPECT_EQ(in->spec().get_float_attribute("ExposureTime"), 1.0F / 64);
}

TEST(JpegWriter, EmptyTextsAreLeftOut) {
    // OpenImageIO 2.4 ends the process for them.
    const Folder folder;
    ImageSpec spec = kSmall;
    const std::vector<float> values = values_of(spec, Content::flat);
    const std::string expected = write_ours(folder / "a.jpg", spec, values);
    for (const char* name : {"Software", "Artist", "Copyright", "ImageDescription", "DateTime"})
        spec.attribute(name, "");
    EXPECT_EQ(write_ours(folder / "a.jpg", spec, values), expected);
}

TEST(JpegWriter, DensityEqualsThatOfOpenImageIO) {
    for (const char* unit : {"", "in", "cm", "none", "inch"}) {
        for (const float x : {0.0F, 72.0F, 3000.0F}) {
            for (const float y : {0.0F, 300.0F}) {
                for (const float aspect : {0.0F, 1.0F, 0.5F, 2.0F, -1.0F}) {
                    expect_equal(unit, kSmall, [&](ImageSpec& spec) {
                        if (*unit) spec.attribute("ResolutionUnit", unit);
                        if (x != 0) spec.attribute("XResolution", x);
                        if (y != 0) spec.attribute("YResolution", y);
                        if (aspect != 0) spec.attribute("PixelAspectRatio", aspect);
                    });
                }
            }
        }
    }
}

TEST(JpegWriter, LargeProfileIsWhole) {
    // Three segments; OpenImageIO 2.4 takes the last one from a wrong place.
    const Folder folder;
    std::string profile(150000, '\0');
    for (std::size_t i = 0; i < profile.size(); ++i)
        profile[i] = static_cast<char>(i * i >> 8);
    ImageSpec spec = kSmall;
    const TypeDesc type(TypeDesc::UINT8, static_cast<int>(profile.size()));
    spec.attribute("ICCProfile", type, profile.data());
    ASSERT_NE(write_ours(folder / "a.jpg", spec, values_of(spec, Content::flat)), "");
    const auto in = OIIO::ImageInput::open(folder / "a.jpg");
    ASSERT_TRUE(in);
    const OIIO::ParamValue* const found = in->spec().find_attribute("ICCProfile", type);
    ASSERT_TRUE(found);
    EXPECT_TRUE(profile == std::string(static_cast<const char*>(found->data()), profile.size()));
}

TEST(JpegWriter, BytesDependNeitherOnThreadsNorOnBatches) {
    const Folder folder;
    const ImageSpec spec(200, 150, 3, TypeDesc::UINT8);
    const std::vector<float> values = values_of(spec, Content::noise);
    const std::string expected = write_ours(folder / "a.jpg", spec, values, kAllRows, 1);
    for (const int batch : {1, 7, 64, 149}) {
        for (const unsigned threads : {0U, 1U, 3U})
            EXPECT_TRUE(write_ours(folder / "a.jpg", spec, values, batch, threads) == expected)
                << batch;
    }
}

TEST(JpegWriter, LeavesOtherPicturesToOpenImageIO) {
    const Folder folder;
    const TestFile file(folder / "a.jpg");
    const auto is_written = [&](ImageSpec spec,
                                const std::function<void(ImageSpec&)>& change = {}) {
        if (change) change(spec);
        return create_jpeg(file, picture_spec(spec), 1) != nullptr;
    };
    const auto with = [](const char* name, const auto& value) {
        return [=](ImageSpec& spec) { spec.attribute(name, value); };
    };
    EXPECT_TRUE(is_written(kSmall));
    EXPECT_FALSE(is_written(ImageSpec(5, 3, 2, TypeDesc::UINT8)));
    EXPECT_FALSE(is_written(ImageSpec(5, 3, 4, TypeDesc::UINT8)));
    EXPECT_FALSE(is_written(ImageSpec(0, 3, 3, TypeDesc::UINT8)));
    EXPECT_FALSE(is_written(kSmall, with("oiio:dither", 1)));
    for (const char* name :
         {"Exif:LensModel", "IPTC:City", "GPano:ProjectionType", "Keywords", "Make", "crs:Version"})
        EXPECT_FALSE(is_written(kSmall, with(name, "text"))) << name;
    EXPECT_FALSE(is_written(kSmall, with("XResolution", 2000.5F)));
    EXPECT_FALSE(is_written(kSmall, with("ExposureTime", -1.0F)));
    EXPECT_FALSE(is_written(kSmall, with("ExposureTime", 3)));
    EXPECT_FALSE(is_written(kSmall, with("XResolution", "72")));
    EXPECT_FALSE(is_written(kSmall, with("ResolutionUnit", 2)));
    EXPECT_FALSE(is_written(kSmall, with("Software", 2)));
}

TEST(JpegWriter, RefusalOfTheLibraryIsAnError) {
    const Folder folder;
    const TestFile file(folder / "a.jpg");
    const auto reason = [&](const ImageSpec& spec) -> std::string {
        try {
            const auto writer = create_jpeg(file, picture_spec(spec), 1);
            return "";
        } catch (const FileError& error) {
            return error.what();
        }
    };
    ImageSpec spec = kSmall;
    spec.attribute("ImageDescription", std::string(70000, 'x'));  // a segment has 65533 bytes
    EXPECT_EQ(reason(spec), "Bogus marker length");
    EXPECT_EQ(reason(ImageSpec(70000, 3, 3, TypeDesc::UINT8)),
              "Maximum supported image dimension is 65500 pixels");
}

TEST(JpegWriter, FullDiskIsAnError) {
    const Folder folder;
    const ImageSpec spec(300, 300, 3, TypeDesc::UINT8);
    const TestFile file(folder / "a.jpg");
    const std::unique_ptr<RowWriter> writer = create_jpeg(file, picture_spec(spec), 1);
    ASSERT_TRUE(writer);
    const TestFile full("/dev/full", O_WRONLY);
    ASSERT_GE(::dup2(full, file), 0);
    try {
        give_rows(*writer, TypeDesc::FLOAT, values_of(spec, Content::noise), 64);
        FAIL() << "the rows were written";
    } catch (const FileError& error) {
        EXPECT_EQ(error.problem().error_number, ENOSPC);
    }
}

TEST(JpegWriter, MissingRowsAreAnError) {
    const Folder folder;
    const TestFile file(folder / "a.jpg");
    const std::unique_ptr<RowWriter> writer = create_jpeg(file, picture_spec(kSmall), 1);
    ASSERT_TRUE(writer);
    const std::vector<float> row(63);
    writer->write_rows(1, TypeDesc::FLOAT, reinterpret_cast<const std::byte*>(row.data()));
    EXPECT_THROW(writer->finish(), FileError);
}

TEST(JpegWriter, FaultNamesTheDifference) {
    const Folder folder;
    const std::string path = folder / "a.jpg";
    const std::string file = write_ours(path, kSmall, values_of(kSmall, Content::noise));
    const auto fault = [&](int width, int channels) {
        return fault_of_jpeg(path, picture_spec(ImageSpec(width, 13, channels, TypeDesc::UINT8)));
    };
    EXPECT_EQ(fault(21, 3), "");
    EXPECT_EQ(fault(22, 3), "what was written reads back with size 21 x 13; expected 22 x 13");
    EXPECT_EQ(fault(21, 1), "what was written reads back with channels 3; expected 1");
    const std::string incomplete =
        "what was written cannot be read back: it is no complete JPEG file";
    for (const std::string& damaged :
         {file.substr(0, file.size() - 1), file.substr(0, 20), std::string("P6"), std::string()}) {
        write(path, damaged);
        EXPECT_EQ(fault(21, 3), incomplete);
    }
}

}  // namespace
TONEWRIGHT_NAMESPACE_END
