// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <functional>
#include <optional>
#include <vector>

#include "tonewright/lint.h"
#include "tonewright/lut_match.h"
#include "tonewright/verify.h"

TONEWRIGHT_NAMESPACE_BEGIN

struct VerifyRequest {
    VerifyOptions options = {};
    /// Takes smaller sample sets.
    bool is_quick = false;
    /// Checks the config itself, too, if its views are verified.
    bool has_lint = false;
};

/// Receives results as they come. Empty functions mean that nobody listens.
struct VerifyListener {
    std::function<void(const std::vector<LintFinding>& findings)> on_lint = {};
    std::function<void(const ParityRow& row)> on_row = {};
};

struct VerifyResult {
    /// Findings about the config. Unset: not asked for.
    std::optional<std::vector<LintFinding>> lint = {};
    std::vector<ParityRow> rows = {};
    /// Rows beyond their bound.
    std::size_t failed = 0;
    /// False for such rows, and for a config with errors.
    bool is_ok = true;
};

/// @throws Error  @see verify(const VerifyOptions&), lint_config
[[nodiscard]] VerifyResult verify(const VerifyRequest& request,
                                  const VerifyListener& listener = {});

/// True if the operator made the LUT: the difference is the error between its nodes. A defect needs
/// a closer match, one 8-bit code.
[[nodiscard]] bool is_same(const LutMatch& match);

TONEWRIGHT_NAMESPACE_END
