// SPDX-License-Identifier: Apache-2.0
#include "lut/icc.h"

#include <gtest/gtest.h>

#include "unit/lut/lut_cases.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

TEST(DeviceLink, IsWhatItWasMadeOf) {
    for (const int version : {2, 4}) {
        LutRequest r = request_for("agx_sobotka", "log2", LutFormat::icc, 17);
        r.icc_version = version;
        Lut lut = sample_lut(r);
        quantize(lut, r);
        const std::string bytes = write_lut(lut, r, {});
        EXPECT_EQ(bytes, write_lut(lut, r, {})) << "the same on every run";
        EXPECT_EQ(bytes[8], version);
        EXPECT_EQ(bytes.substr(12, 12), "linkRGB RGB ");
        EXPECT_EQ(bytes.substr(36, 4), "acsp");
        const DeviceLink link("x.icc", bytes);
        for (const Vector3& v : table_inputs(2000)) {
            std::array<float, 3> in{};
            std::array<float, 3> out{};
            for (std::size_t c = 0; c < 3; ++c)
                in[c] = static_cast<float>(v[c]);
            link.run_rgb(in.data(), out.data(), 1);
            const Vector3 expected =
                interpolate(lut, {static_cast<double>(in[0]), static_cast<double>(in[1]),
                                  static_cast<double>(in[2])});
            // LittleCMS works in 16 bits: half a step of the input, twice as steep here, and half
            // of the output.
            for (std::size_t c = 0; c < 3; ++c)
                EXPECT_NEAR(static_cast<double>(out[c]), expected[c], 2.5e-5);
        }
    }
}

}  // namespace
TONEWRIGHT_NAMESPACE_END
