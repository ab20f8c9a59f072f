// SPDX-License-Identifier: Apache-2.0
//
// libFuzzer: files of camera responses take any bytes. The first line is the curve's name. Curves
// that are read do not fall, and lie in [0, 1].
#include <algorithm>
#include <cstdint>
#include <cstdlib>
#include <string_view>
#include <vector>

#include "operators/camera_response/response_curve.h"
#include "tonewright/error.h"

namespace {

bool rises(const std::vector<double>& numbers) {
    return std::is_sorted(numbers.begin(), numbers.end()) && numbers.front() >= 0 &&
           numbers.back() <= 1;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    using namespace tonewright;  // NOLINT(google-build-using-namespace): this is its program
    const std::string_view bytes(reinterpret_cast<const char*>(data), size);
    const std::size_t end = std::min(bytes.find('\n'), size);
    try {
        const ResponseCurves curves =
            parse_response_curves(bytes.substr(std::min(end + 1, size)), "x", bytes.substr(0, end));
        for (const auto& table : curves) {
            const std::vector<double>& at = table->positions;
            if (table->samples.size() < 2 || !rises(table->samples)) std::abort();
            if (!at.empty() && (at.size() != table->samples.size() || !rises(at))) std::abort();
        }
    } catch (const Error& e) {
        // One line, always.
        if (std::string_view(e.what()).find('\n') != std::string_view::npos) std::abort();
    }
    return 0;
}
