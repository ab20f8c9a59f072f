// SPDX-License-Identifier: Apache-2.0
//
// libFuzzer: ICC profiles of any bytes as colors of a picture. The first byte chooses the channels.
// A profile that is read gives finite light for every number.
#include <array>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <string>
#include <string_view>

#include "lut/icc_source.h"
#include "tonewright/error.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    using namespace tonewright;  // NOLINT(google-build-using-namespace): this is its program
    if (size == 0) return 0;
    const std::string bytes(reinterpret_cast<const char*>(data) + 1, size - 1);
    try {
        const IccSource source = color_of_icc(bytes, data[0] % 2 == 0 ? 3 : 1, "x.png");
        std::array<float, 15> numbers = {0,        0.5F, 1,    NAN,  -1, 2, 1e30F, -1e30F,
                                         INFINITY, 0.1F, 0.2F, 0.9F, 1,  0, 0.01F};
        if (source.color.convert) {
            source.color.convert(numbers.data(), numbers.data(), numbers.size() / 3);
            for (const float v : numbers) {
                if (!std::isfinite(v)) std::abort();
            }
        }
        const std::array<Expr, 3> f = compose(source.color.decode);
        for (const Vector3& rgb : {Vector3{0, 0.5, 1}, Vector3{-2, 3, 0.1}}) {
            for (const Expr& channel : f) {
                if (!std::isfinite(evaluate(channel, rgb))) std::abort();
            }
        }
    } catch (const Error& e) {
        // One line, always.
        if (std::string_view(e.what()).find('\n') != std::string_view::npos) std::abort();
    }
    return 0;
}
