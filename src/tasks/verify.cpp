// SPDX-License-Identifier: Apache-2.0
#include "tasks/verify.h"

#include <algorithm>
#include <filesystem>

TONEWRIGHT_NAMESPACE_BEGIN

VerifyResult verify(const VerifyRequest& request, const VerifyListener& listener) {
    VerifyOptions options = request.options;
    if (request.is_quick) {
        options.gamut_grid_size = 9;
        options.random_count = 10000;
    }
    VerifyResult result;
    if (request.has_lint && !options.config.empty() && options.operators.empty()) {
        const std::filesystem::path given(options.config);
        result.lint = lint_config(
            std::filesystem::is_directory(given) ? given / "config.ocio" : given, options.with_gpu);
        if (listener.on_lint) listener.on_lint(*result.lint);
        result.is_ok = std::none_of(result.lint->begin(), result.lint->end(), [](const auto& f) {
            return f.level == LintFinding::Level::error;
        });
    }
    result.rows = verify(options, listener.on_row);
    result.failed = static_cast<std::size_t>(std::count_if(
        result.rows.begin(), result.rows.end(), [](const ParityRow& row) { return !row.is_ok; }));
    result.is_ok = result.is_ok && result.failed == 0;
    return result;
}

bool is_same(const LutMatch& match) {
    return match.mean <= (match.definition->is_defect() ? 1.0 / 255 : 1e-2);
}

TONEWRIGHT_NAMESPACE_END
