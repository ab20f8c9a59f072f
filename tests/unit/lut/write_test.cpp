// SPDX-License-Identifier: Apache-2.0
#include "tonewright/lut.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <set>
#include <sstream>

#include "unit/errors.h"
#include "unit/hard_floats.h"
#include "unit/lut/lut_cases.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

TEST(LutFormatName, RoundTrips) {
    EXPECT_EQ(parse_lut_format("cube"), LutFormat::cube);
    EXPECT_EQ(parse_lut_format("clf"), LutFormat::clf);
    EXPECT_EQ(parse_lut_format("spi1d"), LutFormat::spi1d);
    EXPECT_EQ(parse_lut_format("spi3d"), LutFormat::spi3d);
    EXPECT_EQ(parse_lut_format("raw"), LutFormat::raw);
    EXPECT_EQ(lut_format_names().size(), 15U);
    for (const std::string& name : lut_format_names())
        EXPECT_EQ(name_of(parse_lut_format(name)), name);
    EXPECT_EQ(error_of([] { (void)parse_lut_format("cub"); }),
              "format is cub; expected cube, clf, ctf, spi1d, spi3d, csp, resolve_cube, 3dl, "
              "lut, icc, hald, strip, strip_up, raw or ktx2; did you mean cube?");
}

/// A .cube file by the specification (Adobe, Cube LUT 1.0): keywords, then lines of three numbers.
struct CubeFile {
    int dimension = 0;
    int size = 0;
    std::string title;
    Vector3 domain_min{0, 0, 0};
    Vector3 domain_max{1, 1, 1};
    std::vector<std::string> comments;
    std::vector<float> values;
};

CubeFile parse_cube(const std::string& text) {
    CubeFile cube;
    std::istringstream lines(text);
    std::string line;
    while (std::getline(lines, line)) {
        std::istringstream words(line);
        std::string first;
        words >> first;
        if (first.empty()) continue;
        if (first[0] == '#') {
            cube.comments.push_back(line);
        } else if (first == "TITLE") {
            cube.title = line.substr(6);
        } else if (first == "LUT_1D_SIZE" || first == "LUT_3D_SIZE") {
            cube.dimension = first[4] - '0';
            words >> cube.size;
        } else if (first == "DOMAIN_MIN" || first == "DOMAIN_MAX") {
            Vector3& end = first == "DOMAIN_MIN" ? cube.domain_min : cube.domain_max;
            words >> end[0] >> end[1] >> end[2];
        } else {
            EXPECT_EQ(line.find_first_not_of("-0123456789. "), std::string::npos) << line;
            std::istringstream numbers(line);
            int count = 0;
            for (std::string number; numbers >> number; ++count)
                cube.values.push_back(std::strtof(number.c_str(), nullptr));
            EXPECT_EQ(count, 3) << line;
        }
    }
    return cube;
}

TEST(WriteLut, CubeReadsBackBitForBit) {
    LutRequest r = request_for("agx_sobotka", "acescct", LutFormat::cube, 17);
    Lut lut;
    lut.size = 17;
    lut.values = hard_floats(3 * 17 * 17 * 17);
    LutError error;
    error.max = 0.0123;
    error.p999 = 0.00456;
    error.mean = 0.000789;
    error.delta_e_max = 3.21;
    error.interpolation = "tetrahedral";
    LutError trilinear = error;
    trilinear.max = 0.0234;
    trilinear.interpolation = "trilinear";
    const CubeFile cube = parse_cube(write_lut(lut, r, error, trilinear));
    EXPECT_EQ(cube.dimension, 3);
    EXPECT_EQ(cube.size, 17);
    EXPECT_EQ(cube.title.front(), '"');
    EXPECT_EQ(cube.title.back(), '"');
    EXPECT_EQ(std::count(cube.title.begin(), cube.title.end(), '"'), 2);
    EXPECT_EQ(cube.values, lut.values) << "red fastest, no float changed";
    std::string header;
    for (const std::string& comment : cube.comments)
        header += comment + "\n";
    for (const char* what :
         {"AgX (Sobotka)", "Source: ", "ACEScct", "ACEScg", "sRGB", "max 1.23e-02",
          "99.9 % 4.56e-03", "mean 7.89e-04", "dE_ITP (ITU-R BT.2124), tetrahedral", "max 3.21e+00",
          "222.861", "trilinear interpolation, inside the input range: max 2.34e-02",
          "Clips nothing", "3D LUT, size 17, numbers "}) {
        EXPECT_NE(header.find(what), std::string::npos) << what << " is not in\n" << header;
    }
}

TEST(WriteLut, HeaderDescribesItsNumbers) {
    const auto header_of = [](const char* op, const char* display) {
        const LutRequest r = request_for(op, "log2", LutFormat::cube, 17, display);
        return write_lut(sample_lut(r), r, {});
    };
    // Unreal Engine 3's curve has a power of 2.2 baked in, Hable's gives light.
    for (const auto& [op, display, what] :
         {std::array{"ue3", "native", "Output: the operator's own code values, power 2.2"},
          {"hable", "native", "Output: the operator's own display-linear values"},
          {"ue3", "linear", "Output: display-linear Rec.709, unclamped"},
          {"hable", "rec1886", "BT.1886"}}) {
        const std::string header = header_of(op, display);
        EXPECT_NE(header.find(what), std::string::npos)
            << op << " " << display << header.substr(0, 900);
    }
}

TEST(WriteLut, CurveCubeRepeatsItsChannel) {
    const LutRequest r = request_for("hable", "log2", LutFormat::cube, 64);
    const Lut lut = sample_lut(r);
    const CubeFile cube = parse_cube(write_lut(lut, r, measure_lut(lut, r)));
    EXPECT_EQ(cube.dimension, 1);
    EXPECT_EQ(cube.size, 64);
    EXPECT_EQ(cube.domain_min, (Vector3{0, 0, 0}));
    EXPECT_EQ(cube.domain_max, (Vector3{1, 1, 1}));
    ASSERT_EQ(cube.values.size(), 192U);
    for (std::size_t i = 0; i < 64; ++i) {
        for (std::size_t c = 0; c < 3; ++c)
            EXPECT_EQ(cube.values[3 * i + c], lut.values[i]);
    }
    const LutRequest linear = request_for("hable", "linear:0:16", LutFormat::cube, 64);
    const CubeFile ends = parse_cube(write_lut(sample_lut(linear), linear, {}));
    EXPECT_EQ(ends.domain_max, (Vector3{16, 16, 16}));
}

TEST(WriteLut, Spi1dIsLaidOutAsItsReadersWant) {
    const LutRequest r = request_for("hable", "linear:0:16", LutFormat::spi1d, 33);
    const Lut lut = sample_lut(r);
    std::istringstream text(write_lut(lut, r, {}));
    std::string line;
    for (const char* expected : {"Version 1", "From 0 16", "Length 33", "Components 1", "{"}) {
        std::getline(text, line);
        EXPECT_EQ(line, expected);
    }
    for (const float expected : lut.values) {
        std::getline(text, line);
        EXPECT_EQ(std::strtof(line.c_str(), nullptr), expected);
    }
    std::getline(text, line);
    EXPECT_EQ(line, "}");
    EXPECT_FALSE(std::getline(text, line)) << "nothing behind";
}

TEST(WriteLut, Spi3dNamesItsNodes) {
    const LutRequest r = request_for("agx_sobotka", "log2", LutFormat::spi3d, 17);
    const Lut lut = sample_lut(r);
    std::istringstream text(write_lut(lut, r, {}));
    std::string line;
    for (const char* expected : {"SPILUT 1.0", "3 3", "17 17 17"}) {
        std::getline(text, line);
        EXPECT_EQ(line, expected);
    }
    std::set<std::size_t> nodes;
    while (std::getline(text, line)) {
        std::istringstream words(line);
        std::size_t red = 0;
        std::size_t g = 0;
        std::size_t b = 0;
        words >> red >> g >> b;
        const std::size_t node = (b * 17 + g) * 17 + red;
        ASSERT_TRUE(nodes.insert(node).second) << line;
        for (std::size_t c = 0; c < 3; ++c) {
            std::string number;
            words >> number;
            ASSERT_EQ(std::strtof(number.c_str(), nullptr), lut.values[3 * node + c]) << line;
        }
    }
    EXPECT_EQ(nodes.size(), 17U * 17 * 17);
}

TEST(LutFormatName, KindsOfFormats) {
    const std::set<LutFormat> pictures = {LutFormat::hald, LutFormat::strip, LutFormat::strip_up};
    for (const std::string& name : lut_format_names()) {
        const LutFormat format = parse_lut_format(name);
        EXPECT_EQ(is_picture_format(format), pictures.count(format) == 1) << name;
        EXPECT_EQ(is_strip(format), format == LutFormat::strip || format == LutFormat::strip_up)
            << name;
    }
    for (const char* path : {"a.png", "a.PNG", "a.b.tif", "lut.exr"})
        EXPECT_TRUE(is_lut_picture(path)) << path;
    for (const char* path : {"a.cube", "png", "a.png.cube", "", "a.icc"})
        EXPECT_FALSE(is_lut_picture(path)) << path;
}

}  // namespace
TONEWRIGHT_NAMESPACE_END
