// SPDX-License-Identifier: Apache-2.0
#include "ocio/yaml_text.h"

#include <fmt/format.h>

#include <algorithm>
#include <sstream>

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

constexpr std::string_view kBlanks = " \t\r\n";

/// The caller adds the file name, as for exceptions of yaml-cpp.
[[noreturn]] void fail() {
    throw YAML::RepresentationException(
        YAML::Mark::null_mark(),
        "cannot insert into YAML that is written this way; expected UTF-8, lists, and texts "
        "without escapes");
}

std::size_t position(const YAML::Node& node) {
    const YAML::Mark mark = node.Mark();
    if (mark.is_null()) fail();
    return static_cast<std::size_t>(mark.pos);
}

YAML::Node with_flow(const YAML::Node& node) {
    YAML::Node copy = YAML::Clone(node);
    if (!copy.IsScalar()) copy.SetStyle(YAML::EmitterStyle::Flow);
    if (copy.IsSequence()) {
        for (std::size_t i = 0; i < copy.size(); ++i)
            copy[i] = with_flow(copy[i]);
    }
    if (copy.IsMap()) {
        for (auto item : copy)
            item.second = with_flow(item.second);
    }
    return copy;
}

/// One item of a list on one line. Quotes texts with several lines.
std::string flow_text(const YAML::Node& item) {
    YAML::Emitter out;
    out.SetSeqFormat(YAML::Flow);
    out.SetMapFormat(YAML::Flow);
    // The emitter breaks lines only in lists that are not nested.
    out << YAML::Flow << YAML::BeginSeq;
    emit_as_config(out, with_flow(item));
    out << YAML::EndSeq;
    std::string text = out.c_str();
    text = text.substr(1, text.size() - 2);
    std::replace(text.begin(), text.end(), '\n', ' ');
    return text;
}

/// One item of a block sequence, without a line end.
std::vector<std::string> block_lines(const YAML::Node& item) {
    YAML::Emitter out;
    out << YAML::BeginSeq;
    emit_as_config(out, item);
    out << YAML::EndSeq;
    std::vector<std::string> lines;
    std::istringstream in(out.c_str());
    for (std::string line; std::getline(in, line);)
        lines.push_back(line);
    return lines;
}

}  // namespace

void emit_as_config(YAML::Emitter& out, const YAML::Node& node) {
    const std::string& tag = node.Tag();
    const bool is_quoted = tag == "!";
    if (!tag.empty() && tag != "?" && !is_quoted) out << YAML::VerbatimTag(tag);
    const bool is_flow = node.Style() == YAML::EmitterStyle::Flow;
    const auto style = is_flow ? YAML::Flow : YAML::Block;
    switch (node.Type()) {
        case YAML::NodeType::Map:
            out << style << YAML::BeginMap;
            for (const auto& item : node) {
                out << YAML::Key << item.first.Scalar() << YAML::Value;
                emit_as_config(out, item.second);
            }
            out << YAML::EndMap;
            break;
        case YAML::NodeType::Sequence:
            out << style << YAML::BeginSeq;
            for (const auto& item : node)
                emit_as_config(out, item);
            out << YAML::EndSeq;
            break;
        case YAML::NodeType::Null:
            out << YAML::Null;
            break;
        default:
            // One of the two: yaml-cpp would keep the first one for the rest of the document.
            if (node.Scalar().find('\n') != std::string::npos) {
                out << YAML::Literal;
            } else if (is_quoted) {
                out << YAML::DoubleQuoted;
            }
            out << node.Scalar();
    }
}

namespace {
/// Byte order mark of UTF-8, which Windows editors write; positions start after it.
constexpr std::string_view kByteOrderMark = "\xEF\xBB\xBF";
}  // namespace

YamlText::YamlText(const std::string& text)
    : mark_(text.starts_with(kByteOrderMark) ? kByteOrderMark : ""),
      text_(text.substr(mark_.size())),
      line_end_(text_.find("\r\n") == std::string::npos ? "\n" : "\r\n"),
      root_(YAML::Load(text_)) {
    // yaml-cpp reads UTF-16 and UTF-32, too, and its positions are those of the text as UTF-8.
    const bool is_wide = text_.starts_with("\xFE\xFF") || text_.starts_with("\xFF\xFE");
    if (is_wide || text_.find('\0') != std::string::npos) fail();
}

std::size_t YamlText::end_of_line(std::size_t at) const {
    const std::size_t end = std::min(text_.find('\n', at), text_.size());
    return end > at && end < text_.size() && text_[end - 1] == '\r' ? end - 1 : end;
}

/// End of the last line that is indented deeper than the column, including comments. Deeper lines
/// belong to the last item or follow it.
std::size_t YamlText::end_of_block(std::size_t last_item, std::size_t column) const {
    std::size_t end = end_of_line(last_item);
    for (std::size_t at = text_.find('\n', last_item);
         at != std::string::npos && ++at < text_.size(); at = text_.find('\n', at)) {
        const std::size_t first = text_.find_first_not_of(' ', at);
        if (first == std::string::npos) break;
        const bool is_blank = end_of_line(at) <= text_.find_first_not_of(" \t", at);
        if (is_blank) continue;
        if (first - at <= column) break;
        end = end_of_line(at);
    }
    return end;
}

void YamlText::append(const YAML::Node& sequence, const std::vector<YAML::Node>& items) {
    if (items.empty()) return;
    if (!sequence.IsSequence()) fail();
    if (sequence.Style() == YAML::EmitterStyle::Flow) {
        std::string text;
        for (const YAML::Node& item : items)
            text += (text.empty() ? "" : ", ") + flow_text(item);
        append_to_flow(sequence, text);
        return;
    }
    if (sequence.size() == 0) fail();
    const auto column = static_cast<std::size_t>(sequence.Mark().column);
    if (text_.compare(position(sequence), 1, "-") != 0) fail();
    std::string text;
    for (const YAML::Node& item : items) {
        const std::vector<std::string> lines = block_lines(item);
        if (lines.size() > 1) text += line_end_;
        for (const std::string& line : lines)
            text += line_end_ + (line.empty() ? "" : std::string(column, ' ') + line);
    }
    insertions_.push_back(
        {end_of_block(position(sequence[sequence.size() - 1]), column), std::move(text)});
}

void YamlText::add(const std::string& key, const std::vector<YAML::Node>& items) {
    if (items.empty()) return;
    if (!root_.IsMap()) fail();
    if (root_.Style() == YAML::EmitterStyle::Flow) {
        std::string text;
        for (const YAML::Node& item : items)
            text += (text.empty() ? "" : ", ") + flow_text(item);
        append_to_flow(root_, fmt::format("{}: [{}]", key, text));
        return;
    }
    const std::string margin(static_cast<std::size_t>(root_.Mark().column), ' ');
    std::string text = line_end_ + line_end_ + margin + key + ":";
    for (const YAML::Node& item : items) {
        for (const std::string& line : block_lines(item)) {
            text += line_end_;
            if (!line.empty()) text.append(margin).append("  ").append(line);
        }
    }
    append_to_document(std::move(text));
}

void YamlText::add_text(const std::string& key, const std::string& value) {
    if (!root_.IsMap()) fail();
    const std::string text = fmt::format("{}: {}", key, value);
    if (root_.Style() == YAML::EmitterStyle::Flow) {
        append_to_flow(root_, text);
        return;
    }
    const std::string margin(static_cast<std::size_t>(root_.Mark().column), ' ');
    append_to_document(line_end_ + line_end_ + margin + text);
}

/// Position before the end marker of the document, if there is one.
void YamlText::append_to_document(std::string lines) {
    std::size_t end = text_.size();
    for (const std::string_view mark : {"\n...", "\n---"}) {
        const std::size_t found = text_.find(mark, position(root_));
        end = std::min(end, found);
    }
    const std::size_t last = text_.find_last_not_of(kBlanks, end == 0 ? 0 : end - 1);
    behind_.push_back({last == std::string::npos ? 0 : last + 1, std::move(lines)});
}

/// Position before the closing bracket, and before a comment there.
void YamlText::append_to_flow(const YAML::Node& collection, const std::string& items) {
    std::size_t at = position(collection);
    // Position after its tag and its anchor.
    while (at < text_.size() && text_[at] != '[' && text_[at] != '{') {
        at = text_.find_first_of(kBlanks, at);
        at = at == std::string::npos ? text_.size() : text_.find_first_not_of(kBlanks, at);
        at = std::min(at, text_.size());
    }
    int depth = 0;
    char last =
        0;  // the last character that is neither blank nor in a comment, and the rest of the line
    std::size_t behind = at;
    for (; at < text_.size(); ++at) {
        const char c = text_[at];
        const bool begins = last == '[' || last == '{' || last == ',' || last == ':' || last == 0 ||
                            (at > 0 && kBlanks.find(text_[at - 1]) != std::string_view::npos);
        if (kBlanks.find(c) != std::string_view::npos) continue;
        if (c == '#' && begins) {
            at = std::min(text_.find('\n', at), text_.size() - 1);
            continue;
        }
        if ((c == '"' || c == '\'') && begins) {
            for (++at; at < text_.size() && text_[at] != c; ++at)
                at += c == '"' && text_[at] == '\\' ? 1 : 0;
            // A doubled quote is an escaped quote: the text continues.
            while (c == '\'' && text_.compare(at, 2, "''") == 0)
                at = std::min(text_.find('\'', at + 2), text_.size());
        } else if (c == '[' || c == '{') {
            ++depth;
        } else if (c == ']' || c == '}') {
            --depth;
            if (depth == 0) break;
        }
        last = text_[std::min(at, text_.size() - 1)];
        behind = at + 1;
    }
    if (at >= text_.size() || depth != 0) fail();
    const bool is_first = last == '[' || last == '{';
    const std::string separator = is_first && collection.size() == 0 ? "" : ", ";
    insertions_.push_back({behind, (last == ',' ? " " : separator) + items});
}

void YamlText::append_text(const YAML::Node& scalar, std::string_view more) {
    if (!scalar.IsScalar()) fail();
    std::size_t at = position(scalar);
    const std::string& value = scalar.Scalar();
    if (at < text_.size() && (text_[at] == '"' || text_[at] == '\'')) {
        const std::string quote(1, text_[at]);
        if (text_.compare(at + 1, value.size() + 1, value + quote) != 0) fail();
        ++at;
    } else if (value.empty() || text_.compare(at, value.size(), value) != 0) {
        fail();
    }
    insertions_.push_back({at + value.size(), std::string(more)});
}

std::vector<YamlText::Insertion> YamlText::insertions() const {
    // The last list may end at the end of the document: its items come first.
    std::vector<Insertion> sorted = insertions_;
    sorted.insert(sorted.end(), behind_.begin(), behind_.end());
    for (Insertion& insertion : sorted)
        insertion.at += mark_.size();
    std::stable_sort(sorted.begin(), sorted.end(),
                     [](const Insertion& a, const Insertion& b) { return a.at < b.at; });
    return sorted;
}

std::string YamlText::result() const {
    const std::string whole = std::string(mark_) + text_;
    std::string result;
    std::size_t from = 0;
    for (const Insertion& insertion : insertions()) {
        result.append(whole, from, insertion.at - from);
        result += insertion.text;
        from = insertion.at;
    }
    return result.append(whole, from);
}

TONEWRIGHT_NAMESPACE_END
