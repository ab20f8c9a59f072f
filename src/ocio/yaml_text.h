// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <yaml-cpp/yaml.h>

#include <string>
#include <string_view>
#include <vector>

#include "tonewright/version.h"

TONEWRIGHT_NAMESPACE_BEGIN

/// As OpenColorIO writes its configs: its tags, lists and short maps on one line, long texts as
/// blocks.
void emit_as_config(YAML::Emitter& out, const YAML::Node& node);

/// A YAML text that gets more items and stays byte for byte what it is otherwise: comments, order,
/// line ends, styles and quotes. Block and flow styles alike.
class TONEWRIGHT_API YamlText {
  public:
    struct Insertion {
        std::size_t at;  // in the text as it was
        std::string text;
    };

    /// @throws YAML::Exception
    explicit YamlText(const std::string& text);

    [[nodiscard]] const YAML::Node& root() const { return root_; }

    /// Behind the last item of a sequence of the text.
    /// @throws YAML::Exception  for one that cannot be found
    void append(const YAML::Node& sequence, const std::vector<YAML::Node>& items);
    /// A new key of the whole, behind the others.
    void add(const std::string& key, const std::vector<YAML::Node>& items);
    void add_text(const std::string& key, const std::string& value);
    /// Behind the last character of a text. @throws YAML::Exception  as append()
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
