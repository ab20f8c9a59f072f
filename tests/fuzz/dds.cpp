// SPDX-License-Identifier: Apache-2.0
//
// libFuzzer: DDS volumes take any bytes. A volume that is read has all its nodes, and they are
// finite.
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <string_view>

#include "lut/dds.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    using namespace tonewright;  // NOLINT(google-build-using-namespace): this is its program
    try {
        const Lut lut = parse_dds("x.dds", {reinterpret_cast<const char*>(data), size});
        const auto n = static_cast<std::size_t>(lut.size);
        if (lut.size < 2 || lut.values.size() != 3 * n * n * n) std::abort();
        for (const float v : lut.values) {
            if (!std::isfinite(v)) std::abort();
        }
    } catch (const FileError& e) {
        // One line, always.
        if (std::string_view(e.what()).find('\n') != std::string_view::npos) std::abort();
    }
    return 0;
}
