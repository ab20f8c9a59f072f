// SPDX-License-Identifier: Apache-2.0
#include "tools/roff.h"

#include <algorithm>
#include <cctype>
#include <vector>

#include "base/strings.h"
#include "tonewright/error.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

std::vector<std::string> lines_of(std::string_view text) {
    std::vector<std::string> lines;
    while (!text.empty()) {
        const std::size_t end = text.find('\n');
        lines.emplace_back(text.substr(0, end));
        text.remove_prefix(end == std::string_view::npos ? text.size() : end + 1);
    }
    return lines;
}

bool is_ascii(std::string_view text) {
    return std::all_of(text.begin(), text.end(), [](char c) { return (c & 0x80) == 0; });
}

/// The cells of `| a | b |`. A `|` within backticks does not end a cell.
std::vector<std::string> cells_of(std::string_view row) {
    std::vector<std::string> cells;
    std::string cell;
    bool is_code = false;
    for (const char c : row.substr(1)) {
        if (c == '`') is_code = !is_code;
        if (c == '|' && !is_code) {
            cells.emplace_back(trimmed(cell));
            cell.clear();
        } else {
            cell += c;
        }
    }
    return cells;
}

/// The first column has the entries of a list. A third column follows the second one, after its
/// heading.
std::string list_of_table(const std::vector<std::string>& rows) {
    std::string list;
    const std::vector<std::string> headings = cells_of(rows[0]);
    for (std::size_t row = 2; row < rows.size(); ++row) {
        const std::vector<std::string> cells = cells_of(rows[row]);
        std::string text = cells.size() > 1 ? cells[1] : "";
        for (std::size_t i = 2; i < cells.size(); ++i) {
            if (!cells[i].empty()) text += "; " + headings.at(i) + ": " + cells[i];
        }
        list += ".TP\n" + roff_prose(cells[0]) + "\n" + roff_prose(text) + "\n";
    }
    return list;
}

/// The paragraphs of a code block that have no plot.
std::string code_of(const std::vector<std::string>& lines) {
    std::string code;
    std::string paragraph;
    const auto finish = [&] {
        if (!is_ascii(paragraph)) paragraph.clear();
        if (!code.empty() && !paragraph.empty()) code += "\n";
        code += paragraph;
        paragraph.clear();
    };
    for (const std::string& line : lines) {
        if (line.empty())
            finish();
        else
            paragraph += line + "\n";
    }
    finish();
    return code.empty() ? "" : ".PP\n.RS 4\n" + roff_lines(code) + ".RE\n";
}

std::string uppercase(std::string text) {
    for (char& c : text)
        c = static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
    return text;
}

/// From the heading above the row to the end.
std::vector<std::string> reference_of(std::string_view markdown, std::string_view first_row) {
    std::vector<std::string> lines = lines_of(markdown);
    const auto row = std::find_if(lines.begin(), lines.end(), [&](const std::string& line) {
        return line.starts_with(first_row);
    });
    const auto heading =
        std::find_if(std::make_reverse_iterator(row), lines.rend(),
                     [](const std::string& line) { return line.starts_with("## "); });
    if (row == lines.end() || heading == lines.rend())
        throw Error("manual: no section has the row " + std::string(first_row));
    lines.erase(lines.begin(), std::prev(heading.base()));
    return lines;
}

}  // namespace

std::string roff_escape(std::string_view text) {
    std::string escaped;
    for (const char c : text) {
        switch (c) {
            case '\\':
                escaped += "\\e";
                break;
            case '-':
                escaped += "\\-";
                break;
            case '\'':
                escaped += "\\(aq";
                break;
            case '`':
                escaped += "\\(ga";
                break;
            case '^':
                escaped += "\\(ha";
                break;
            case '~':
                escaped += "\\(ti";
                break;
            // At the start of a line it would be a request.
            case '.':
                escaped += escaped.empty() ? "\\&." : ".";
                break;
            default:
                escaped += c;
        }
    }
    return escaped;
}

std::string roff_prose(std::string_view text) {
    std::string prose;
    std::string plain;
    const auto finish = [&] {
        prose += roff_escape(plain);
        plain.clear();
    };
    const auto add_bold = [&](std::string_view code) {
        finish();
        prose += "\\fB" + roff_escape(code) + "\\fR";
    };
    while (!text.empty()) {
        const std::size_t end = text.find('`', 1);
        if (text.front() == '`' && end != std::string_view::npos) {
            add_bold(text.substr(1, end - 1));
            text.remove_prefix(end + 1);
            continue;
        }
        const bool is_word_start = plain.empty() || plain.back() == ' ' || plain.back() == '(';
        if (is_word_start && text.starts_with("--")) {
            const std::size_t size =
                std::min(text.find_first_not_of("abcdefghijklmnopqrstuvwxyz-"), text.size());
            add_bold(text.substr(0, size));
            text.remove_prefix(size);
            continue;
        }
        const std::size_t middle = text.find("](");
        const std::size_t close = text.find(')');
        if (text.front() == '[' && middle < close && close != std::string_view::npos) {
            const std::string_view target = text.substr(middle + 2, close - middle - 2);
            finish();
            prose += roff_prose(text.substr(1, middle - 1));
            if (target.starts_with("http")) prose += " (" + roff_escape(target) + ")";
            text.remove_prefix(close + 1);
            continue;
        }
        plain += text.front();
        text.remove_prefix(1);
    }
    finish();
    return prose;
}

std::string roff_lines(std::string_view lines) {
    std::string text = ".nf\n";
    for (const std::string& line : lines_of(lines))
        text += roff_escape(line) + "\n";
    return text + ".fi\n";
}

std::string roff_of_markdown(std::string_view markdown, std::string_view first_row) {
    const std::vector<std::string> lines = reference_of(markdown, first_row);
    std::string page;
    for (std::size_t i = 0; i < lines.size();) {
        // All lines from here on that belong to the block, which begins at line i.
        const auto take_while = [&](const auto& belongs) {
            std::vector<std::string> block;
            while (i < lines.size() && belongs(lines[i]))
                block.push_back(lines[i++]);
            return block;
        };
        const std::string& line = lines[i];
        if (line.empty()) {
            ++i;
        } else if (line.starts_with("```")) {
            ++i;
            page += code_of(
                take_while([](const std::string& next) { return !next.starts_with("```"); }));
            ++i;
        } else if (line.starts_with('|')) {
            page += list_of_table(
                take_while([](const std::string& next) { return next.starts_with('|'); }));
        } else if (line.starts_with("## ")) {
            page += ".SH " + roff_escape(uppercase(line.substr(3))) + "\n";
            ++i;
        } else if (line.starts_with("### ")) {
            page += ".SS " + roff_escape(line.substr(4)) + "\n";
            ++i;
        } else {
            const bool is_item = line.starts_with("- ");
            std::string text = lines[i++].substr(is_item ? 2 : 0);
            for (const std::string& next : take_while([](const std::string& other) {
                     return !other.empty() && !other.starts_with("- ") &&
                            !other.starts_with("```") && !other.starts_with('|') &&
                            !other.starts_with('#');
                 }))
                text.append(" ").append(trimmed(next));
            page += (is_item ? ".IP \\(bu 2\n" : ".PP\n") + roff_prose(text) + "\n";
        }
    }
    return page;
}

TONEWRIGHT_NAMESPACE_END
