// SPDX-License-Identifier: Apache-2.0
//
// SideFX, HDK, "Lookup Tables".
#include <fmt/format.h>

#include <algorithm>
#include <string>
#include <vector>

#include "base/strings.h"
#include "lut/formats/formats.h"
#include "lut/formats/text_lines.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

struct Head {
    bool is_cube = true;
    std::vector<int> length;

    [[nodiscard]] bool has_prelut() const { return length.size() == 2; }
};

/// The lines before the blocks.
Head read_head(TextLines& text) {
    std::string type;
    Head head;
    std::vector<std::string> keys;
    bool is_open = false;
    while (!is_open && text.next_filled()) {
        const std::string_view first = text.word();
        const std::string key = lowercase(first);
        if (key == "lut:") {
            is_open = true;
        } else if (key == "version" || key == "format" || key == "sampling") {
            if (text.word().empty()) text.refuse("a value");
        } else if (key == "type") {
            const std::string_view word = text.word();
            type = lowercase(word);
            if (type != "3d" && type != "3d+1d" && type != "c")
                text.refuse(first, word, "3D, 3D+1D or C");
        } else if (key == "from" || key == "to") {
            text.numbers(2);
        } else if (key == "black" || key == "white") {
            text.numbers(1);
        } else if (key == "length") {
            for (std::string_view word = text.word(); !word.empty(); word = text.word()) {
                if (head.length.size() == 2) text.refuse("one size or two");
                head.length.push_back(text.size(first, word, 2, kLargestTable));
            }
            if (head.length.empty()) text.refuse("one size or two");
        } else {
            text.refuse("keyword", first,
                        "Version, Format, Type, From, To, Black, White, Length or LUT:");
        }
        keys.push_back(key);
    }
    for (const char* key :
         {"Version", "Format", "Type", "From", "To", "Black", "White", "Length"}) {
        if (std::find(keys.begin(), keys.end(), lowercase(key)) == keys.end())
            text.fail(fmt::format("{} is missing; expected it before LUT:", key));
    }
    if (!is_open) text.end("LUT:");
    head.is_cube = type != "c";
    if (head.is_cube && head.length[0] > kLargestCube)
        text.fail(fmt::format("Length is {}; expected [2, {}]", head.length[0], kLargestCube));
    const std::size_t sizes = type == "3d+1d" ? 2 : 1;
    if (head.length.size() != sizes)
        text.fail(fmt::format("number of sizes in Length is {}; expected {} with this Type",
                              head.length.size(), sizes));
    return head;
}

/// "Pre {", "3D {" or "{", "RGB {"; numbers; "}".
class Blocks {
  public:
    Blocks(TextLines& text, const Head& head) : text_(text), head_(head) {}

    void check() {
        while (text_.next_filled(false)) {
            for (std::string_view word = text_.word(); !word.empty(); word = text_.word())
                take(word);
        }
        if (!block_.empty() || !name_.empty()) text_.end("}");
        require(table());
        if (head_.has_prelut()) require("pre");
    }

  private:
    static const char* title_of(const std::string& id) {
        return id == "pre" ? "Pre" : id == "3d" ? "3D" : "RGB";
    }
    [[nodiscard]] std::string table() const { return head_.is_cube ? "3d" : "rgb"; }

    void take(std::string_view word) {
        if (word == "{") {
            open();
        } else if (word == "}") {
            if (block_.empty()) text_.refuse("{ before }");
            if (found_ != expected_)
                text_.fail(fmt::format("block {} has {} numbers; expected {}", title_of(block_),
                                       found_, expected_));
            blocks_.push_back(block_);
            block_.clear();
        } else if (block_.empty()) {
            if (!name_.empty()) text_.refuse("{");
            name_ = lowercase(word);
        } else {
            (void)text_.number("number", word);
            if (++found_ > expected_)
                text_.fail(fmt::format("block {0} has more than {1} numbers; expected {1}",
                                       title_of(block_), expected_));
        }
    }
    void open() {
        if (!block_.empty()) text_.refuse("} before {");
        block_ = name_.empty() ? "3d" : name_;
        name_.clear();
        if (block_ != table() && !(block_ == "pre" && head_.has_prelut()))
            text_.refuse("block", block_, head_.has_prelut() ? "Pre or 3D" : title_of(table()));
        expected_ = block_ == "3d"
                        ? 3 * cubed(head_.length[0])
                        : static_cast<std::size_t>(head_.length[block_ == "pre" ? 1 : 0]);
        found_ = 0;
    }
    void require(const std::string& block) const {
        if (std::find(blocks_.begin(), blocks_.end(), block) == blocks_.end())
            text_.end(fmt::format("a block {}", title_of(block)));
    }

    TextLines& text_;
    const Head& head_;
    std::string name_;   // of the next block
    std::string block_;  // the open one
    std::size_t found_ = 0;
    std::size_t expected_ = 0;
    std::vector<std::string> blocks_;
};

}  // namespace

void check_lut(TextLines& text) {
    TextLines ahead = text;
    if (ahead.next_filled() && lowercase(ahead.word()) == "lut:") {
        check_discreet_tables(text);
    } else {
        const Head head = read_head(text);
        Blocks(text, head).check();
    }
}

TONEWRIGHT_NAMESPACE_END
