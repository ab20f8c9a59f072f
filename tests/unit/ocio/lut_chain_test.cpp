// SPDX-License-Identifier: Apache-2.0
#include "ocio/lut_chain.h"

#include <gtest/gtest.h>

#include <array>
#include <string>

#include "tonewright/error.h"
#include "tonewright/lut_file.h"
#include "unit/folder.h"
#include "unit/lut/lut_cases.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

TEST(LutChain, IsOfSceneLinearInputAndMixedChannels) {
    EXPECT_TRUE(is_lut_chain(request_for("agx_sobotka", "linear", LutFormat::clf)));
    EXPECT_FALSE(is_lut_chain(request_for("agx_sobotka", "acescct", LutFormat::clf))) << "encoded";
    EXPECT_FALSE(is_lut_chain(request_for("agx_sobotka", "linear", LutFormat::cube)))
        << "a format without chains";
    EXPECT_FALSE(is_lut_chain(request_for("reinhard", "linear", LutFormat::clf)))
        << "one table is exact";
}

TEST(LutChain, OpenColorIOShowsTheViewFromTheFile) {
    const LutRequest request = request_for("agx_sobotka", "linear", LutFormat::clf);
    const LutChain chain = make_lut_chain(request, LutNodes::automatic);
    EXPECT_TRUE(chain.fits_clf);
    EXPECT_EQ(chain.operations.find("3D LUT"), std::string::npos)
        << "AgX is a matrix, a curve and a matrix";
    const Folder folder;
    write(folder / "a.clf", chain.contents);
    const LutFile file(folder / "a.clf");
    const std::array<Expr, 3> view = compose(build_view(request.view));
    for (const std::array<float, 3>& rgb : std::vector<std::array<float, 3>>{
             {0.18F, 0.18F, 0.18F}, {1, 0.2F, 0.05F}, {8, 8, 4}, {0, 0, 0}}) {
        std::array<float, 3> out{};
        file.run_rgb(rgb.data(), out.data(), 1);
        for (std::size_t c = 0; c < 3; ++c) {
            const double wanted = evaluate(
                view[c], std::array{static_cast<double>(rgb[0]), static_cast<double>(rgb[1]),
                                    static_cast<double>(rgb[2])});
            // The chain's own error, over its sample set, and float's.
            EXPECT_NEAR(static_cast<double>(out[c]), wanted, 2 * chain.error.max + 1e-5);
        }
    }
    EXPECT_LT(chain.error.max, 1e-3) << "a code of 10 bits";
}

TEST(LutChain, OptionsOfOtherLutsAreRefused) {
    LutRequest request = request_for("agx_sobotka", "linear", LutFormat::clf);
    request.decimals = 4;
    EXPECT_THROW((void)make_lut_chain(request, LutNodes::automatic), Error);
    request.decimals.reset();
    EXPECT_THROW((void)make_lut_chain(request, LutNodes::smooth), Error);
}

}  // namespace
TONEWRIGHT_NAMESPACE_END
