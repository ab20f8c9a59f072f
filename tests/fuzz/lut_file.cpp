// SPDX-License-Identifier: Apache-2.0
//
// libFuzzer: what is ours of reading LUTs takes any bytes. The first byte chooses the format.
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <string>

#include "lut/icc.h"
#include "lut/lut_text.h"
#include "lut/raw.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    using namespace tonewright;  // NOLINT(google-build-using-namespace): this is its program
    if (size == 0) return 0;
    std::string bytes(reinterpret_cast<const char*>(data) + 1, size - 1);
    const std::vector<std::string>& text = lut_text_extensions();
    const std::size_t kind = data[0] % (text.size() + 2);
    try {
        if (kind < text.size()) {
            (void)check_lut_text("x" + text[kind], bytes);
        } else if (kind == text.size()) {
            for (const float v : parse_raw_lut("x.raw", bytes).values) {
                if (!std::isfinite(v)) std::abort();
            }
        } else {
            const DeviceLink link("x.icc", bytes);
            const float in[] = {0.1F, 0.5F, 0.9F, -1, 2, NAN};
            float out[6] = {};
            link.run_rgb(in, out, 2);
        }
    } catch (const FileError& e) {
        // One line, always.
        if (std::string_view(e.what()).find('\n') != std::string_view::npos) std::abort();
    }
    return 0;
}
