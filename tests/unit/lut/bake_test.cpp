// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include "tonewright/lut.h"
#include "unit/lut/lut_cases.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

TEST(Bake, SampledNodesAreThoseOfSampleLut) {
    const LutRequest request = request_for("agx_sobotka", "log2", LutFormat::cube, 17);
    const BakedLut baked = bake_lut(request, LutNodes::sampled);
    EXPECT_FALSE(baked.is_fitted);
    EXPECT_EQ(baked.lut.values, sample_lut(request).values);
    ASSERT_TRUE(baked.other_error) << "of the other interpolation";
    EXPECT_EQ(baked.error.interpolation, "tetrahedral");
    EXPECT_EQ(baked.other_error->interpolation, "trilinear");
    EXPECT_EQ(bake_lut(request, LutNodes::sampled, LutInterpolation::trilinear).error.max,
              baked.other_error->max);
}

TEST(Bake, DecimalsMoveNoNumberByMoreThanHalfOfTheLast) {
    LutRequest request = request_for("agx_sobotka", "log2", LutFormat::cube, 17);
    const Lut exact = sample_lut(request);
    request.decimals = 4;
    const BakedLut baked = bake_lut(request, LutNodes::sampled);
    ASSERT_EQ(baked.lut.values.size(), exact.values.size());
    for (std::size_t i = 0; i < exact.values.size(); ++i)
        ASSERT_NEAR(baked.lut.values[i], exact.values[i], 5.1e-5F) << "and the rounding of float";
}

TEST(Bake, AMaximalErrorChoosesTheSmallestSizeThatMeetsIt) {
    const LutRequest request = request_for("agx_sobotka", "log2", LutFormat::cube);
    LutRequest small = request;
    small.size = 17;
    const double error = bake_lut(small, LutNodes::sampled).error.photographs.p999;
    EXPECT_EQ(bake_lut(request, LutNodes::sampled, LutInterpolation::automatic, error).lut.size,
              17);
    EXPECT_GT(
        bake_lut(request, LutNodes::sampled, LutInterpolation::automatic, 0.9 * error, 33).lut.size,
        17);
    EXPECT_THROW((void)bake_lut(request, LutNodes::sampled, LutInterpolation::automatic, 1e-9, 17),
                 Error)
        << "none meets it";
    EXPECT_THROW((void)bake_lut(small, LutNodes::sampled, LutInterpolation::automatic, 0.1), Error)
        << "a size and an error";
}

}  // namespace
TONEWRIGHT_NAMESPACE_END
