// SPDX-License-Identifier: Apache-2.0
//
// A program outside Tonewright's tree that tone maps a picture and writes a config.
#include <tonewright/ocio.h>
#include <tonewright/tonemap.h>

#include <cmath>
#include <cstdio>

int main() {
    OIIO::ImageBuf picture(OIIO::ImageSpec(2, 2, 3, OIIO::TypeDesc::FLOAT));
    const float gray[3] = {0.18F, 0.18F, 0.18F};
    for (int y = 0; y < 2; ++y) {
        for (int x = 0; x < 2; ++x)
            picture.setpixel(x, y, gray);
    }
    tonewright::TonemapOptions options;
    options.op = tonewright::resolve_picture_operator("hable");
    options.display = "linear";
    const OIIO::ImageBuf shown = tonewright::tonemap(picture, options);
    if (shown.has_error()) {
        std::printf("%s\n", shown.geterror().c_str());
        return 1;
    }
    const double value = static_cast<double>(shown.getchannel(1, 1, 0, 2));
    // tests/data/operators.csv has the number and its origin.
    constexpr double kExpected = 0.128338449;
    std::printf("tonemap: %.9f, expected %.9f\n", value, kExpected);
    // Single precision, and 0.18 is not a float: 1e-7.
    if (!(std::fabs(value - kExpected) <= 1e-7)) return 1;

    tonewright::ConfigOptions config;
    config.profiles = {"2.1"};
    config.views = {"hable"};
    config.displays = {"srgb"};
    const auto files = tonewright::make_config(config);
    std::printf("config: %zu files\n", files.size());
    return files.empty() ? 1 : 0;
}
