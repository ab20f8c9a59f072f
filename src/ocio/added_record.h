// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "ocio/yaml_text.h"
#include "tonewright/ocio.h"

TONEWRIGHT_NAMESPACE_BEGIN

/// Folder beside a config for the tables and the record.
inline constexpr const char* kAddedFolder = "tonewright";

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
    /// Options of the last run, but for its custom views.
    ConfigOptions options;
    struct CustomView {
        std::string name;
        std::string op;  // for resolve_operator()
    };
    std::vector<CustomView> custom;

    /// Its path beside the config: "tonewright/studio.ocio.yaml".
    [[nodiscard]] static std::string path_of(const std::string& config);
    /// The record of a config with this text. A run that was killed after it replaced the config
    /// has left the new record as PATH.new.
    /// @throws FileError  if it is damaged
    [[nodiscard]] static std::optional<AddedRecord> find(const std::string& config,
                                                         const std::string& config_text);
    /// @throws FileError  if it is missing or damaged
    [[nodiscard]] static AddedRecord read(const std::string& config,
                                          const std::string& config_text);
    /// The first line of a record, which identifies the text of its config.
    [[nodiscard]] static std::string mark_of(const std::string& config_text);
    [[nodiscard]] std::string text(const std::string& config_text) const;

    /// @param result  the config's text with the insertions
    void add(const std::vector<YamlText::Insertion>& insertions, const std::string& result);
    /// The config's text without the pieces.
    /// @throws FileError  if one of them is missing or changed
    [[nodiscard]] std::string without(std::string text, const std::string& config) const;
};

TONEWRIGHT_NAMESPACE_END
