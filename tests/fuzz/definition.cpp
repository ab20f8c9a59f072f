// SPDX-License-Identifier: Apache-2.0
//
// libFuzzer: .tone files take any bytes. What is read is written and read again as the same stages.
#include <cstdint>
#include <cstdlib>
#include <memory>
#include <string>
#include <vector>

#include "tonewright/definition.h"

namespace {

/// A table of any name: a 1D table and a small 3D LUT, with a stated input.
tonewright::TableFile stub_table(const std::string& path) {
    using namespace tonewright;  // NOLINT(google-build-using-namespace): this is its program
    if (path.find("no") != std::string::npos) throw FileError("read: " + path + ": no such file");
    const auto table = std::make_shared<const Table>(Table{{0, 0.25, 1}});
    const auto grid = std::make_shared<const Grid>(2, [] { return std::vector<double>(24, 0.5); });
    TableFile file;
    file.stages = {curve_stage(lookup(table, Expr::input())), GridStage{Expr::input(), grid}};
    if (path.find("acescct") != std::string::npos) {
        file.encoding = "acescct";
        file.space = "lin_ap1";
    }
    return file;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    using namespace tonewright;  // NOLINT(google-build-using-namespace): this is its program
    const std::string_view text(reinterpret_cast<const char*>(data), size);
    try {
        const std::shared_ptr<const Operator> op = parse_operator(text, "x.tone", stub_table);
        const ResolvedOperator resolved = resolve(*op, nullptr, {}, "");
        const std::vector<std::string> live = live_parameters(*op);
        std::string written;
        try {
            written = definition_of(resolved);
        } catch (const Error&) {
            return 0;  // it has a table, or its peak a formula that cannot be found again
        }
        const std::shared_ptr<const Operator> again = parse_operator(written, "y.tone", stub_table);
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
