// SPDX-License-Identifier: Apache-2.0
#include "tonewright/color.h"

#include <gtest/gtest.h>

#include "tonewright/error.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

void expect_matrix(const Matrix3& actual, const Matrix3& expected, double tolerance) {
    for (std::size_t i = 0; i < 3; ++i) {
        for (std::size_t j = 0; j < 3; ++j) {
            EXPECT_NEAR(actual[i][j], expected[i][j], tolerance) << "row " << i << ", column " << j;
        }
    }
}

// Golden values computed independently in double from the chromaticities of the standards (15
// decimals printed): half a unit of the last place is 5e-16, 1e-12 leaves room for the order of
// sums.
constexpr double kGolden = 1e-12;

TEST(Color, MatricesFromChromaticities) {
    expect_matrix(rgb_to_rgb(kRec709, kRec2020),
                  {{{0.627403895934699, 0.329283038377884, 0.043313065687417},
                    {0.069097289358232, 0.919540395075459, 0.011362315566309},
                    {0.016391438875150, 0.088013307877226, 0.895595253247625}}},
                  kGolden);
    expect_matrix(rgb_to_rgb(kRec2020, kRec709),
                  {{{1.660491002108434, -0.587641138788549, -0.072849863319885},
                    {-0.124550474521591, 1.132899897125959, -0.008349422604369},
                    {-0.018150763354905, -0.100578898008007, 1.118729661362911}}},
                  kGolden);
    expect_matrix(rgb_to_rgb(kRec709, kAP1),
                  {{{0.613097402401187, 0.339523146184106, 0.047379451414707},
                    {0.070193722469582, 0.916353879057345, 0.013452398473074},
                    {0.020615592882227, 0.109569772938136, 0.869814634179638}}},
                  kGolden);
    expect_matrix(rgb_to_rgb(kAP1, kRec709),
                  {{{1.705050992657984, -0.621792120657006, -0.083258872000978},
                    {-0.130256417507043, 1.140804736575401, -0.010548319068358},
                    {-0.024003356804618, -0.128968976064971, 1.152972332869588}}},
                  kGolden);
    expect_matrix(rgb_to_rgb(kRec709, kAP0),
                  {{{0.439632981919491, 0.382988698151554, 0.177378319928955},
                    {0.089776442958842, 0.813439428748981, 0.096784128292177},
                    {0.017541170383173, 0.111546553302387, 0.870912276314441}}},
                  kGolden);
    expect_matrix(rgb_to_rgb(kAP0, kAP1),
                  {{{1.451439316145666, -0.236510746893740, -0.214928569251925},
                    {-0.076553773396021, 1.176229699833573, -0.099675926437552},
                    {0.008316148425698, -0.006032449791021, 0.997716301365324}}},
                  kGolden);
    const Matrix3 ap1 = rgb_to_xyz(kAP1);
    EXPECT_NEAR(ap1[1][0], 0.272228716780914, kGolden);
    EXPECT_NEAR(ap1[1][1], 0.674081765811148, kGolden);
    EXPECT_NEAR(ap1[1][2], 0.053689517407937, kGolden);
}

TEST(Color, CamerasGoToAcesByTheirMakersMatrices) {
    // ARRI in the Academy's IDT.ARRI.Alexa-v3-logC-EI800.ctl (a1.v2), six decimals.
    expect_matrix(rgb_to_rgb(kArriWideGamut3, kAP0),
                  {{{0.680206, 0.236137, 0.083658},
                    {0.085415, 1.017471, -0.102886},
                    {0.002057, -0.062563, 1.060506}}},
                  1e-6);
    // Sony in the Academy's IDT.Sony.SLog3_SGamut3.ctl (a1.v1), ten decimals.
    expect_matrix(rgb_to_rgb(kSGamut3, kAP0),
                  {{{0.7529825954, 0.1433702162, 0.1036471884},
                    {0.0217076974, 1.0153188355, -0.0370265329},
                    {-0.0094160528, 0.0033704179, 1.0060456349}}},
                  2e-10);
    // To other gamuts through ACES2065-1, and back.
    expect_matrix(rgb_to_rgb(kArriWideGamut3, kRec709),
                  multiply(rgb_to_rgb(kAP0, kRec709), rgb_to_rgb(kArriWideGamut3, kAP0)), kGolden);
    for (const Primaries& camera : {kArriWideGamut3, kArriWideGamut4, kSGamut3, kSGamut3Cine}) {
        expect_matrix(multiply(rgb_to_rgb(kRec2020, camera), rgb_to_rgb(camera, kRec2020)),
                      kIdentity3, kGolden);
    }
}

TEST(Color, EGamutAsFilmLightPrintsIt) {
    // The white paper's own ten significant digits.
    expect_matrix(rgb_to_xyz(kEGamut),
                  {{{0.7053968501, 0.1640413283, 0.08101774865},
                    {0.2801307241, 0.8202066415, -0.1003373656},
                    {-0.1037815116, -0.07290725703, 1.265746519}}},
                  1e-9);
}

TEST(Color, PrimariesWithoutLuminance) {
    // The primaries of CIE XYZ itself: X and Z have no luminance, and white is that of illuminant
    // E.
    expect_matrix(rgb_to_xyz({"CIE XYZ", {1, 0}, {0, 1}, {0, 0}, {1.0 / 3, 1.0 / 3}}), kIdentity3,
                  1e-15);
}

TEST(Color, Rec709LuminanceRow) {
    const Matrix3 m = rgb_to_xyz(kRec709);
    EXPECT_NEAR(m[1][0], 0.2126390059, 5e-11);
    EXPECT_NEAR(m[1][1], 0.7151686788, 5e-11);
    EXPECT_NEAR(m[1][2], 0.0721923154, 5e-11);
}

TEST(Color, InverseTimesForwardIsIdentity) {
    for (const Primaries& p : {kRec709, kRec2020, kP3D65, kAP0, kAP1, kEGamut}) {
        const Matrix3 m = rgb_to_xyz(p);
        expect_matrix(multiply(inverse(m), m), kIdentity3, 1e-14);
        const Vector3 white = multiply(rgb_to_rgb(p, kRec709), Vector3{1, 1, 1});
        for (const double x : white)
            EXPECT_NEAR(x, 1, 1e-14) << p.name << ": white stays white";
    }
    EXPECT_THROW((void)inverse(Matrix3{}), Error);
}

TEST(Color, XyzOfWhites) {
    // CIE 15 has the tristimulus values of D65 and D50 as (95.047, 100, 108.883) and (96.422, 100,
    // 82.521); chromaticities of four decimals give them within 3e-4.
    const Vector3 d65 = xyz_of({0.3127, 0.3290});
    const Vector3 d50 = xyz_of({0.3457, 0.3585});
    const Vector3 expected65 = {0.95047, 1, 1.08883};
    const Vector3 expected50 = {0.96422, 1, 0.82521};
    for (std::size_t i = 0; i < 3; ++i) {
        EXPECT_NEAR(d65[i], expected65[i], 3e-4);
        EXPECT_NEAR(d50[i], expected50[i], 3e-4);
    }
    EXPECT_EQ(xyz_of({1.0 / 3, 1.0 / 3})[1], 1) << "luminance is 1";
}

TEST(Color, BradfordTakesWhiteToWhite) {
    // Lindbloom's matrix from D65 to D50; his whites have five digits, which moves a coefficient by
    // up to 3e-4.
    const Matrix3 m = bradford_adaptation({0.3127, 0.3290}, {0.3457, 0.3585});
    expect_matrix(m,
                  {{{1.0478112, 0.0228866, -0.0501270},
                    {0.0295424, 0.9904844, -0.0170491},
                    {-0.0092345, 0.0150436, 0.7521316}}},
                  3e-4);
    const Vector3 white = multiply(m, xyz_of({0.3127, 0.3290}));
    const Vector3 expected = xyz_of({0.3457, 0.3585});
    for (std::size_t i = 0; i < 3; ++i)
        EXPECT_NEAR(white[i], expected[i], 1e-14);
    expect_matrix(bradford_adaptation({0.3127, 0.3290}, {0.3127, 0.3290}), kIdentity3, 1e-15);
    expect_matrix(multiply(bradford_adaptation({0.3457, 0.3585}, {0.3127, 0.3290}), m), kIdentity3,
                  1e-14);
}

}  // namespace
TONEWRIGHT_NAMESPACE_END
