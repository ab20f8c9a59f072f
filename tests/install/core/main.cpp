// SPDX-License-Identifier: Apache-2.0
//
// A program outside Tonewright's tree that needs one formula: reference, SIMD engine and a LUT.
#include <tonewright/engine.h>
#include <tonewright/error.h>
#include <tonewright/lut.h>
#include <tonewright/registry.h>
#include <tonewright/version.h>
#include <tonewright/view.h>

#include <cmath>
#include <cstdio>
#include <string>

int main() {
    namespace tw = tonewright;
    const tw::ResolvedOperator hable = tw::resolve_operator("hable");
    const double mid_gray = tw::ReferenceEngine(hable.build())({0.18, 0.18, 0.18})[1];
    // tests/data/operators.csv has the number and its origin; nine digits are given.
    constexpr double kExpected = 0.128338449;
    std::printf("%s: hable(0.18) = %.9f, expected %.9f\n", TONEWRIGHT_VERSION, mid_gray, kExpected);
    if (!(std::fabs(mid_gray - kExpected) <= 5e-10)) return 1;

    const float in[3] = {0.18F, 0.18F, 0.18F};
    float out[3] = {};
    tw::SimdEngine(hable.build()).run_rgb(in, out, 1);
    std::printf("SIMD: %.9f\n", static_cast<double>(out[1]));
    // Single precision, and 0.18 is not a float: 1e-7.
    if (!(std::fabs(static_cast<double>(out[1]) - kExpected) <= 1e-7)) return 1;

    tw::LutRequest request{tw::make_view(hable, "lin_rec709", 0, "srgb"),
                           tw::parse_input_encoding("acescct")};
    request.size = 17;
    request.dimension = tw::LutDimension::three;
    const tw::BakedLut baked = tw::bake_lut(request);
    const std::string text = tw::write_lut(baked.lut, request, baked.error);
    std::printf("%zu bytes of .cube\n", text.size());
    if (text.find("LUT_3D_SIZE 17") == std::string::npos) return 1;

    // An exception crosses the library's boundary with its type.
    try {
        (void)tw::resolve_operator("habel");
    } catch (const tw::Error& e) {
        std::printf("%s\n", e.what());
        return std::string(e.what()).find("did you mean hable") == std::string::npos ? 1 : 0;
    }
    return 1;
}
