// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "ocio/yaml_text.h"
#include "tonewright/ocio.h"

TONEWRIGHT_NAMESPACE_BEGIN

/// Record of the entries that `--into` added to a config, in a file beside the config's tables. It
/// allows their removal after other changes of the config.
struct AddedRecord {
    /// A text in the config, and the text before it.
    struct Piece {
        std::string before;
        std::string text;
    };
    /// In the order of insertion.
    std::vector<Piece> pieces;
    /// Paths of the tables, relative to the config.
    std::vector<std::string> files;
    /// Options of the last run.
    ConfigOptions options;

    /// Its path beside the config: "tonewright/studio.ocio.yaml".
    [[nodiscard]] static std::string path_of(const std::string& config);
    /// @throws FileError  if it is missing or damaged
    [[nodiscard]] static AddedRecord read(const std::string& config);
    [[nodiscard]] std::string text() const;

    /// @param result  the config's text with the insertions
    void add(const std::vector<YamlText::Insertion>& insertions, const std::string& result);
    /// The config's text without the pieces.
    /// @throws FileError  if one of them is missing or changed
    [[nodiscard]] std::string without(std::string text, const std::string& config) const;
};

TONEWRIGHT_NAMESPACE_END
