// SPDX-License-Identifier: Apache-2.0
#include "picture/exr_attributes.h"

#include <OpenImageIO/imageio.h>
#include <gtest/gtest.h>

#include <cstddef>
#include <string>
#include <vector>

#include "unit/folder.h"
#include "unit/picture/exr_files.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

using OIIO::ImageSpec;
using OIIO::TypeDesc;

TEST(ExrAttributes, AreThoseOfOpenImageIO) {
    using T = TypeDesc;
    OIIO::attribute("debug", 0);  // it prints what it does not write
    ImageSpec spec = spec_of_size(20, 20, {"R", "", "R"}, OIIO::TypeHalf);
    spec.attribute("Software", "tests");
    spec.attribute("Copyright", "someone");
    spec.attribute("ImageDescription", "a picture");
    spec.attribute("DateTime", "2002:06:23 21:30:10");
    spec.attribute("empty", "");
    spec.attribute("oiio:subimagename", "beauty");
    spec.attribute("oiio:ColorSpace", "Linear");
    spec.attribute("oiio:SHA-1", "0123");
    spec.attribute("png:compressionLevel", 3);
    spec.attribute("ICCProfile:version", 3);
    spec.attribute("tonewright:operator", "aces");
    spec.attribute("an attribute whose name is longer than 31 letters", 3);
    spec.attribute("Orientation", 6);
    spec.attribute("ExposureTime", 1);  // becomes float
    spec.attribute("FNumber", "wrong type");
    spec.attribute("XResolution", 100.0F);
    spec.attribute("YResolution", 50.0F);
    spec.attribute("ResolutionUnit", "cm");
    spec.attribute("screenWindowWidth", 0.45F);
    spec.attribute("screenWindowCenter", "wrong type");
    std::vector<double> numbers(32);
    for (std::size_t i = 0; i < numbers.size(); ++i)
        numbers[i] = 0.25 * static_cast<double>(i) + 1;
    std::vector<float> floats(numbers.begin(), numbers.end());
    std::vector<int> ints = {1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15, 16};
    const auto add = [&](const std::string& name, T type) {
        const void* data = type.basetype == T::FLOAT    ? static_cast<const void*>(floats.data())
                           : type.basetype == T::DOUBLE ? static_cast<const void*>(numbers.data())
                                                        : static_cast<const void*>(ints.data());
        spec.attribute(name, type, data);
    };
    int count = 0;
    for (const T::BASETYPE base :
         {T::INT, T::UINT, T::FLOAT, T::DOUBLE, T::HALF, T::INT16, T::UINT16, T::UINT8, T::INT64}) {
        for (const int length : {0, 2, 3, 4, 8, 9, 16}) {
            for (const T::AGGREGATE aggregate :
                 {T::SCALAR, T::VEC2, T::VEC3, T::VEC4, T::MATRIX33, T::MATRIX44}) {
                const T type(base, aggregate, length);
                if (type.size() <= floats.size() * sizeof(float) && type.size() <= 64)
                    add("a" + std::to_string(count++), type);
            }
        }
    }
    add("worldtocamera", T(T::FLOAT, 16));
    add("worldtoNDC", T(T::FLOAT, T::MATRIX44));
    add("chromaticities", T(T::FLOAT, 8));
    add("smpte:TimeCode", OIIO::TypeTimeCode);
    const std::vector<int> key = {1, 2, 3, 4, 5, 4, 64};  // within OpenEXR's limits
    spec.attribute("smpte:KeyCode", OIIO::TypeKeyCode, key.data());
    add("framesPerSecond", OIIO::TypeRational);
    add("floats", T(T::FLOAT, 7));
    const std::vector<OIIO::ustring> texts = {OIIO::ustring("one"), OIIO::ustring("two")};
    spec.attribute("multiView", T(T::STRING, 2), texts.data());
    expect_same_file(spec, OIIO::TypeHalf, noise_of(OIIO::TypeHalf, 1200, 1), {20});
    for (const char* texture : {"LatLong Environment", "CubeFace Environment"}) {
        spec.attribute("textureformat", texture);
        expect_same_file(spec, OIIO::TypeHalf, noise_of(OIIO::TypeHalf, 1200, 1), {20});
    }
}

TEST(ExrAttributes, FitToExrReplacesTypesThatOpenExrLacks) {
    for (const TypeDesc& type : {OIIO::TypeUInt8, OIIO::TypeUInt16, TypeDesc(TypeDesc::DOUBLE)}) {
        const ImageSpec spec(5, 5, 3, type);
        const Folder folder;
        PictureSpec fitted = spec_of(spec);
        fit_to_exr(fitted);
        const auto out = OIIO::ImageOutput::create("exr");
        ASSERT_TRUE(out->open(folder / "oiio.exr", spec));
        EXPECT_TRUE(fitted.format == out->spec().format) << type.c_str();
    }
}

}  // namespace
TONEWRIGHT_NAMESPACE_END
