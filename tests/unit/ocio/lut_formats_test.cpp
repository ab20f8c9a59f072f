// SPDX-License-Identifier: Apache-2.0
//
// OpenColorIO reads the LUT files that Tonewright writes.
#include <OpenColorIO/OpenColorIO.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "base/format_number.h"
#include "tonewright/lut.h"
#include "unit/folder.h"
#include "unit/lut/lut_cases.h"

namespace OCIO = OCIO_NAMESPACE;

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

const Expr kX = Expr::input();

/// OCIO's results for a file, in interleaved RGB.
std::vector<float> through_ocio(const std::string& path, std::vector<float> rgb, int dimension) {
    const OCIO::FileTransformRcPtr file = OCIO::FileTransform::Create();
    file->setSrc(path.c_str());
    file->setInterpolation(dimension == 3 ? OCIO::INTERP_TETRAHEDRAL : OCIO::INTERP_LINEAR);
    const OCIO::ConfigRcPtr config = OCIO::Config::CreateRaw()->createEditableCopy();
    config->setProcessorCacheFlags(OCIO::PROCESSOR_CACHE_OFF);
    const auto cpu =
        config->getProcessor(file)->getOptimizedCPUProcessor(OCIO::OPTIMIZATION_LOSSLESS);
    OCIO::PackedImageDesc image(rgb.data(), static_cast<long>(rgb.size() / 3), 1, 3);
    cpu->apply(image);
    return rgb;
}

struct FileCase {
    const char* name;
    const char* op;
    const char* encoding;
    LutFormat format;
    int size;
};

/// Both dimensions of every format; AgX mixes channels, so a swapped axis shows.
const FileCase kFileCases[] = {
    {"cube3d.cube", "agx_sobotka", "acescct", LutFormat::cube, 33},
    {"cube1d.cube", "hable", "log2", LutFormat::cube, 4096},
    {"clf3d.clf", "agx_sobotka", "acescct", LutFormat::clf, 17},
    {"clf1d.clf", "hable", "log2", LutFormat::clf, 1024},
    {"half.clf", "hable", "linear", LutFormat::clf, 0},
    {"curve.spi1d", "hable", "log2", LutFormat::spi1d, 4096},
    {"cube.spi3d", "agx_sobotka", "acescct", LutFormat::spi3d, 33},
    {"cube.ctf", "agx_sobotka", "acescct", LutFormat::ctf, 17},
    {"half.ctf", "hable", "linear", LutFormat::ctf, 0},
    {"cube.lut", "agx_sobotka", "acescct", LutFormat::houdini, 33},
};

class LutFile : public ::testing::TestWithParam<FileCase> {};

TEST_P(LutFile, IsReadByOcioAsWeInterpolate) {
    const FileCase& test = GetParam();
    const LutRequest r = request_for(test.op, test.encoding, test.format,
                                     test.size ? std::optional(test.size) : std::nullopt);
    const Lut lut = sample_lut(r);
    const Folder folder;
    const std::string path = folder / test.name;
    write(path, write_lut(lut, r, measure_lut(lut, r)));

    std::vector<float> in;
    for (const Vector3& v : table_inputs(20000)) {
        for (const double x : v) {
            // A half-domain table takes scene light: -1 to 2^16, with the shadows well covered.
            const double scene = x < 0.1 ? -10 * x : std::exp2(40 * x - 24);
            in.push_back(static_cast<float>(lut.is_half_domain ? scene : x));
        }
    }
    const std::vector<float> out = through_ocio(path, in, lut.dimension);
    double worst = 0;
    for (std::size_t i = 0; i + 2 < in.size(); i += 3) {
        const Vector3 expected =
            interpolate(lut, {static_cast<double>(in[i]), static_cast<double>(in[i + 1]),
                              static_cast<double>(in[i + 2])});
        for (std::size_t c = 0; c < 3; ++c)
            worst = std::max(worst, std::fabs(static_cast<double>(out[i + c]) - expected[c]));
    }
    // OCIO interpolates in float32: positions of up to 4095 to 2^-12 of a step, steps of up to
    // 0.02.
    EXPECT_LE(worst, 1e-6);
    RecordProperty("worst", shortest(worst));
}

INSTANTIATE_TEST_SUITE_P(Formats, LutFile, ::testing::ValuesIn(kFileCases), [](const auto& test) {
    std::string name = test.param.name;
    std::replace(name.begin(), name.end(), '.', '_');
    return name;
});

TEST(WriteClf, HuePreservingTablesKeepHueInOcio) {
    const Folder folder;
    write(folder / "hue.ctf", half_table(kX * kX, true));
    write(folder / "curve.clf", half_table(kX * kX, false));
    // By hand: the middle channel of (1, 2, 3) stays in the middle of 1 and 9.
    const std::vector<float> in = {1, 2, 3, 3, 1, 2, 2, 3, 1, 2, 2, 2, 0, 0, 0};
    EXPECT_EQ(through_ocio(folder / "hue.ctf", in, 1),
              (std::vector<float>{1, 5, 9, 9, 1, 5, 5, 9, 1, 4, 4, 4, 0, 0, 0}));
    EXPECT_EQ(through_ocio(folder / "curve.clf", in, 1),
              (std::vector<float>{1, 4, 9, 9, 1, 4, 4, 9, 1, 4, 4, 4, 0, 0, 0}));
}

TEST(WriteLut, HostileTitlesSurviveXml) {
    Operator op = find_operator("clamp");
    op.title = R"(<b>"A" & 'B'</b> ]]>)";
    LutRequest r = request_for("clamp", "log2", LutFormat::clf, 17);
    r.view.op.op = &op;
    Lut lut;
    lut.dimension = 1;
    lut.size = 2;
    lut.channels = 1;
    lut.values = {0, 1};
    const Folder folder;
    write(folder / "hostile.clf", write_lut(lut, r, {}));
    EXPECT_EQ(through_ocio(folder / "hostile.clf", {0, 0.5F, 1}, 1),
              (std::vector<float>{0, 0.5F, 1}));
}

}  // namespace
TONEWRIGHT_NAMESPACE_END
