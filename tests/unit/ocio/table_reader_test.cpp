// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <array>
#include <string>

#include "tonewright/definition.h"
#include "tonewright/error.h"
#include "tonewright/lut_file.h"
#include "unit/folder.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

/// Result of a file's stages for a color.
std::array<double, 3> shown(const std::string& path, const std::array<double, 3>& rgb) {
    const std::array<Expr, 3> f = compose(ocio_table_reader()(path).stages);
    return {evaluate(f[0], rgb), evaluate(f[1], rgb), evaluate(f[2], rgb)};
}

void expect_same(const std::string& path) {
    const LutFile file(path);
    for (const std::array<double, 3>& rgb : std::vector<std::array<double, 3>>{
             {0, 0, 0}, {0.25, 0.5, 0.75}, {1, 0.1, 0.3}, {0.9, 0.9, 0.05}}) {
        std::array<float, 3> out = {static_cast<float>(rgb[0]), static_cast<float>(rgb[1]),
                                    static_cast<float>(rgb[2])};
        file.run_rgb(out.data(), out.data(), 1);
        const std::array<double, 3> stages = shown(path, rgb);
        // OpenColorIO computes in float: a handful of roundings of numbers up to 2.
        for (std::size_t c = 0; c < 3; ++c)
            EXPECT_NEAR(stages[c], static_cast<double>(out[c]), 1e-6) << path << " channel " << c;
    }
}

TEST(OcioTableReader, StagesComputeWhatOpenColorIOComputes) {
    const Folder folder;
    write(folder / "m.spimtx", "0.5 0.25 0 0\n0 2 0 0\n0.1 0 1 0\n");
    expect_same(folder / "m.spimtx");
    EXPECT_NEAR(shown(folder / "m.spimtx", {1, 1, 0})[0], 0.75, 1e-12) << "rows times the column";
    write(folder / "t.spi1d",
          "Version 1\nFrom 0.0 1.0\nLength 3\nComponents 1\n{\n0.0\n0.25\n1.0\n}\n");
    expect_same(folder / "t.spi1d");
    std::string cube = "SPILUT 1.0\n3 3\n2 2 2\n";
    for (int r = 0; r < 2; ++r)
        for (int g = 0; g < 2; ++g)
            for (int b = 0; b < 2; ++b)
                cube += fmt::format("{} {} {} {} {} {}\n", r, g, b, 0.5 * r, g * (1 - 0.5 * b),
                                    0.8 * b + 0.1 * r);
    write(folder / "c.spi3d", cube);
    expect_same(folder / "c.spi3d");
    EXPECT_NE(ocio_table_reader()(folder / "c.spi3d").description.find("3D LUT"),
              std::string::npos);
}

TEST(OcioTableReader, RefusesWhatIsNoLut) {
    const Folder folder;
    write(folder / "a.spi1d",
          "Version 1\nFrom 0.0 1.0\nLength 3\nComponents 1\n{\n0.0\nnan\n1.0\n}\n");
    EXPECT_THROW((void)ocio_table_reader()(folder / "a.spi1d"), FileError) << "NaN";
    EXPECT_THROW((void)ocio_table_reader()(folder / "none.spi3d"), FileError);
}

}  // namespace
TONEWRIGHT_NAMESPACE_END
