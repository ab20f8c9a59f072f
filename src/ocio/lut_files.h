// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <map>
#include <set>
#include <string>
#include <variant>
#include <vector>

#include "lut/clf.h"
#include "ocio/transforms.h"
#include "tonewright/generated_files.h"

TONEWRIGHT_NAMESPACE_BEGIN

/// Parts of a LUT file's name before the word "curve" or "cube", in the order of the name. Any
/// text; only letters, digits and underscores are used.
struct LutStem {
    std::string subject;         // "agx_blender"
    std::string qualifier = "";  // "Rec.2020, 1000 nit": which of several forms
    std::string purpose = "";    // "inverse"
};

/// Collects the LUT files of transforms, because OCIO configs cannot hold tables.
class LutFiles {
  public:
    enum class Names : unsigned char {
        /// Stable across releases, so that a changed digit is a small diff.
        stable,
        /// With a hash of the contents, for a folder that may hold files of other releases.
        hashed
    };

    /// @param folder  folder of the files, beside the config
    explicit LutFiles(std::string folder, Names names = Names::stable)
        : folder_(std::move(folder)), style_(names) {}

    /// Use of the transforms.
    struct Use {
        bool is_exact = true;
        /// OpenColorIO may have to invert them, because there are no separate inverse transforms.
        bool is_inverted = true;
        bool is_inverse = false;   // of a view
        bool makes_codes = false;  // of a display or texture, without stages after them
    };

    /// The transforms of the operations, with one file per table.
    /// @param title  the name inside the files
    OCIO::GroupTransformRcPtr to_ocio(const LoweredOps& ops, const LutStem& stem,
                                      const std::string& title, const Use& use);

    [[nodiscard]] std::vector<GeneratedFile> files() const;

  private:
    struct File {
        std::string name;
        std::string title;
        std::variant<Lut1DOp, Lut3DOp> table;
        Use use;  // of all that use it
        double least_precision = 0;
    };

    [[nodiscard]] static std::string contents_of(const File& file);

    /// Equal tables are one file, named after the first use.
    /// @param part  "curve"
    std::string file_for(File file, const LutStem& stem, const std::string& part);

    std::string folder_;
    Names style_;
    std::map<std::string, std::size_t> index_;  // of each table, by its numbers
    std::set<std::string> taken_;
    std::vector<File> files_;
};

TONEWRIGHT_NAMESPACE_END
