// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "ocio/lut_chain.h"
#include "tasks/bake.h"
#include "tonewright/shader.h"

TONEWRIGHT_NAMESPACE_BEGIN

/// A file of an operator that an application can use.
struct ExactFile {
    /// 99.9 % of the pixels of photographs have at most this, in code values.
    double error = 0;
    std::string title;
    std::string extension;
    bool is_shader = false;
};

/// The files of one operator for applications. Applications share what was measured.
class ExactFiles {
  public:
    /// @param request  the operator, its input, its display, and the cache folder; the rest does
    /// not
    ///                 count
    explicit ExactFiles(const BakeRequest& request);

    /// The most exact first.
    [[nodiscard]] std::vector<ExactFile> of(const LutApplication& host);

  private:
    [[nodiscard]] ExactFile chain(const LutApplication& host);
    [[nodiscard]] ExactFile table(const LutApplication& host);
    [[nodiscard]] std::optional<ExactFile> shader(const ShaderApplication& application) const;

    BakeRequest request_;
    std::map<std::string, double> known_;  // errors of tables
    std::optional<LutChain> chain_;        // the same for all applications: their display is sRGB
};

TONEWRIGHT_NAMESPACE_END
