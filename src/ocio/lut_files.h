// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <string>
#include <vector>

#include "lut/clf.h"
#include "ocio/transforms.h"
#include "tonewright/generated_files.h"

TONEWRIGHT_NAMESPACE_BEGIN

/// Collects the LUT files that transforms need: OCIO configs cannot hold tables themselves.
class LutFiles {
  public:
    /// @param folder  that they are in, beside the config
    explicit LutFiles(std::string folder) : folder_(std::move(folder)) {}

    /// The transforms of the operations, with a file for every table.
    OCIO::GroupTransformRcPtr to_ocio(const LoweredOps& ops, const std::string& stem,
                                      const std::string& what, bool is_exact);

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
