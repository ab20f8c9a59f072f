// SPDX-License-Identifier: Apache-2.0
//
// libFuzzer: .tone files take any bytes. What is read is written and read again as the same stages.
#include <cstdint>
#include <cstdlib>
#include <string>

#include "tonewright/definition.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    using namespace tonewright;  // NOLINT(google-build-using-namespace): this is its program
    const std::string_view text(reinterpret_cast<const char*>(data), size);
    try {
        const std::shared_ptr<const Operator> op = parse_operator(text, "x.tone");
        const ResolvedOperator resolved = resolve(*op, nullptr, {}, "");
        const std::vector<std::string> live = live_parameters(*op);
        std::string written;
        try {
            written = definition_of(resolved);
        } catch (const Error&) {
            return 0;  // its peak has a formula that cannot be found again
        }
        const std::shared_ptr<const Operator> again = parse_operator(written, "y.tone");
        const auto a = compose(build_live(resolved, live));
        const auto b = compose(build_live(resolve(*again, nullptr, {}, ""), live));
        for (std::size_t i = 0; i < 3; ++i) {
            if (!same(a[i], b[i])) std::abort();
        }
    } catch (const DefinitionError& e) {
        // One line, always.
        if (std::string_view(e.what()).find('\n') != std::string_view::npos) std::abort();
    }
    return 0;
}
