// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <string>
#include <vector>

#include "lut/clf.h"
#include "ocio/lower.h"
#include "tonewright/generated_files.h"

TONEWRIGHT_NAMESPACE_BEGIN

/// Collects the LUT files that transforms need: OCIO configs cannot hold tables themselves.
class LutFiles {
  public:
    /// @param folder  that they are in, beside the config
    explicit LutFiles(std::string folder) : folder_(std::move(folder)) {}

    /// The same chain with every table replaced by a file of its numbers.
    OCIO::GroupTransformRcPtr externalise(const OCIO::GroupTransformRcPtr& group,
                                          const std::string& stem, const std::string& what,
                                          bool is_exact);

    [[nodiscard]] const std::vector<GeneratedFile>& files() const { return files_; }

  private:
    /// Equal tables are one file; its name has the hash of its numbers, because OCIO caches by
    /// name.
    std::string file_for(const ClfTable& table, const std::string& stem, const std::string& what);

    std::string folder_;
    std::map<std::string, std::string> names_;
    std::vector<GeneratedFile> files_;
};

TONEWRIGHT_NAMESPACE_END
