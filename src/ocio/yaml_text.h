// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <yaml-cpp/yaml.h>

#include <string>
#include <string_view>
#include <vector>

#include "tonewright/version.h"

TONEWRIGHT_NAMESPACE_BEGIN

/// Writes YAML like OpenColorIO: tags, lists and short maps on one line, long texts as blocks.
void emit_as_config(YAML::Emitter& out, const YAML::Node& node);

/// A YAML text to which items are added. All other bytes stay the same: comments, order, line ends,
/// styles and quotes. Supports block and flow styles.
class TONEWRIGHT_API YamlText {
  public:
    struct Insertion {
        std::size_t at;  // in the text as it was
        std::string text;
    };

    /// @throws YAML::Exception
    explicit YamlText(const std::string& text);

    [[nodiscard]] const YAML::Node& root() const { return root_; }

    /// Inserts after the last item of a sequence of the text.
    /// @throws YAML::Exception  if the sequence is not found
    void append(const YAML::Node& sequence, const std::vector<YAML::Node>& items);
    /// Adds a new top-level key after the others.
    void add(const std::string& key, const std::vector<YAML::Node>& items);
    void add_text(const std::string& key, const std::string& value);
    /// Inserts after the last character of a text. @throws YAML::Exception  as append()
    void append_text(const YAML::Node& scalar, std::string_view more);

    /// In the order of the text.
    [[nodiscard]] std::vector<Insertion> insertions() const;
    [[nodiscard]] std::string result() const;

  private:
    [[nodiscard]] std::size_t end_of_line(std::size_t at) const;
    [[nodiscard]] std::size_t end_of_block(std::size_t last_item, std::size_t column) const;
    void append_to_document(std::string lines);
    void append_to_flow(const YAML::Node& collection, const std::string& items);

    std::string_view mark_;
    std::string text_;
    std::string line_end_;
    YAML::Node root_;
    std::vector<Insertion> insertions_;
    std::vector<Insertion> behind_;  // the document
};

TONEWRIGHT_NAMESPACE_END
