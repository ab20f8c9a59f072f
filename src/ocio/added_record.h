// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "ocio/yaml_text.h"
#include "tonewright/ocio.h"

TONEWRIGHT_NAMESPACE_BEGIN

/// What `--into` has put into a config, in a file beside the config's tables: enough to take it out
/// again, whatever else has been changed in the config since.
struct AddedRecord {
    /// A text in the config, and what stands before it.
    struct Piece {
        std::string before;
        std::string text;
    };
    /// In the order in which they were put in.
    std::vector<Piece> pieces;
    /// Tables, by their paths beside the config.
    std::vector<std::string> files;
    /// Of the last time.
    ConfigOptions options;

    /// Its path beside the config: "tonewright/studio.ocio.yaml".
    [[nodiscard]] static std::string path_of(const std::string& config);
    /// @throws FileError  for one that is missing or damaged
    [[nodiscard]] static AddedRecord read(const std::string& config);
    [[nodiscard]] std::string text() const;

    /// @param result  the config's text with the insertions
    void add(const std::vector<YamlText::Insertion>& insertions, const std::string& result);
    /// The config's text without the pieces.
    /// @throws FileError  where one of them is not there any more, or has been changed
    [[nodiscard]] std::string without(std::string text, const std::string& config) const;
};

TONEWRIGHT_NAMESPACE_END
