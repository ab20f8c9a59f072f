// SPDX-License-Identifier: Apache-2.0
//
// What a program outside Tonewright's tree does with it: evaluate an operator, tone map a picture.
#include <tonewright/engine.h>
#include <tonewright/image.h>
#include <tonewright/view.h>

#include <cmath>
#include <cstdio>

#include "tonewright/registry.h"
#include "tonewright/tonemap.h"

int main() {
    const tonewright::ResolvedOperator hable = tonewright::resolve_operator("hable");
    const tonewright::ReferenceEngine engine(hable.build());
    const double mid_grey = engine({0.18, 0.18, 0.18})[1];
    // tests/data/operators.csv has the number and its origin; nine digits are given.
    constexpr double kExpected = 0.128338449;
    std::printf("hable(0.18) = %.9f, expected %.9f\n", mid_grey, kExpected);
    if (!(std::fabs(mid_grey - kExpected) <= 5e-10)) return 1;

    OIIO::ImageBuf picture(OIIO::ImageSpec(2, 2, 3, OIIO::TypeDesc::FLOAT));
    const float grey[3] = {0.18F, 0.18F, 0.18F};
    for (int y = 0; y < 2; ++y) {
        for (int x = 0; x < 2; ++x)
            picture.setpixel(x, y, grey);
    }
    tonewright::TonemapOptions options;
    options.op = "hable";
    options.display = "linear";
    const OIIO::ImageBuf shown = tonewright::tonemap(picture, options);
    if (shown.has_error()) {
        std::printf("%s\n", shown.geterror().c_str());
        return 1;
    }
    const double value = static_cast<double>(shown.getchannel(1, 1, 0, 2));
    std::printf("tonemap: %.9f\n", value);
    // Single precision, and 0.18 is not a float: 1e-7.
    return std::fabs(value - kExpected) <= 1e-7 ? 0 : 1;
}
