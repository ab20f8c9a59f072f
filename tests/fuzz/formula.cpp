// SPDX-License-Identifier: Apache-2.0
//
// libFuzzer: formulas take any text. What is read is printed and read again as the same expression.
#include <cstdint>
#include <cstdlib>
#include <string>

#include "formula/formula.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    using namespace tonewright;  // NOLINT(google-build-using-namespace): this is its program
    const std::string_view text(reinterpret_cast<const char*>(data), size);
    FormulaScope scope;
    scope.inputs = {"x", "g", "b"};
    scope.names.emplace("k", FormulaValue{Expr::uniform("k")});
    scope.names.emplace("mode.soft", FormulaValue{1});
    try {
        const Expr e = parse_formula(text, scope);
        const std::string again = whole_formula(e, scope.inputs);
        // The limits count what a formula says, the printed one says a little more.
        if (again.size() < kLongestFormula / 2 && size < 4096 &&
            !same(parse_formula(again, scope), e))
            std::abort();
    } catch (const FormulaError& e) {
        if (std::string_view(e.what()).find('\n') != std::string_view::npos) std::abort();
        if (caret_lines(text, e.at).find('^') == std::string::npos) std::abort();
    }
    return 0;
}
