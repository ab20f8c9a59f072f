// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "base/format_number.h"
#include "base/strings.h"
#include "definition/recipe.h"
#include "formula/characters.h"
#include "tonewright/definition.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

using Kind = StageRecipe::Kind;
using Names = std::vector<std::string>;

/// No name of a file or an operator is much longer, and nobody types more.
constexpr std::size_t kLongestInline = 4096;

/// Marks of steps and of comparisons.
constexpr std::string_view kSteps = "=;!&|";

/// The names in a text; `2.5e3` has none.
Names names_in(std::string_view text) {
    Names names;
    for (std::size_t i = 0; i < text.size();) {
        const std::size_t begin = i;
        while (i < text.size() && (is_letter(text[i]) || is_digit(text[i]) || text[i] == '.'))
            ++i;
        if (i == begin) {
            ++i;
        } else if (is_letter(text[begin])) {
            names.emplace_back(text.substr(begin, i - begin));
        }
    }
    return names;
}

/// The parts between commas outside of brackets, with their places.
std::vector<std::pair<std::string_view, std::size_t>> parts_of(std::string_view text) {
    std::vector<std::pair<std::string_view, std::size_t>> parts;
    std::size_t begin = 0;
    int depth = 0;
    for (std::size_t i = 0; i <= text.size(); ++i) {
        const char c = i < text.size() ? text[i] : ',';
        if (c == '(') ++depth;
        if (c == ')') --depth;
        if (c != ',' || (depth > 0 && i < text.size())) continue;
        parts.emplace_back(text.substr(begin, i - begin), begin);
        begin = i + 1;
    }
    return parts;
}

[[noreturn]] void fail(std::string_view text, const std::string& message) {
    throw Error("operator is " + printable(text) + ": " + message);
}

/// Above this linear value of mid gray, which is a stop of light more, a formula probably encodes
/// its result: encoded tone curves have 0.4 to 0.5 there, and display-linear ones 0.1 to 0.25.
constexpr double kEncodedGray = 0.36;

}  // namespace

bool may_be_formula(std::string_view given) {
    const std::string_view text = trimmed(given);
    constexpr std::string_view kMarks = "+-*/^(,?<>";
    const Names names = names_in(text);
    const bool has_color = std::any_of(names.begin(), names.end(), [](const std::string& name) {
        return name == "x" || name == "r" || name == "g" || name == "b";
    });
    if (!has_color) return false;
    // Steps (`a = x; a`) and comparisons; `name:parameter=value` is an operator with a setting.
    const bool has_steps = text.find(':') == std::string_view::npos &&
                           text.find_first_of(kSteps) != std::string_view::npos;
    return text == "x" || has_steps || text.find_first_of(kMarks) != std::string_view::npos;
}

std::shared_ptr<const Operator> formula_operator(std::string_view given) {
    const std::string_view text = trimmed(given);
    if (text.size() > kLongestInline) {
        fail(text, "it has " + std::to_string(text.size()) + " characters; expected at most " +
                       std::to_string(kLongestInline) + ", or a .tone file");
    }
    // The text becomes a line of files and shaders, where a comment or a backslash would go on.
    const bool has_lines = std::any_of(text.begin(), text.end(),
                                       [](char c) { return static_cast<unsigned char>(c) < ' '; });
    if (has_lines || text.find_first_of("#\\\x7f") != std::string_view::npos ||
        text.find("//") != std::string_view::npos || text.find("*/") != std::string_view::npos)
        fail(text, "it has more than one line, a comment or a backslash; expected a .tone file");
    const Names names = names_in(text);
    const bool is_of_x = std::find(names.begin(), names.end(), "x") != names.end();
    FormulaScope scope;
    scope.inputs = is_of_x ? Names{"x"} : Names{"r", "g", "b"};
    const auto parts = parts_of(text);
    if (parts.size() != 1 && parts.size() != 3)
        fail(text, "it has " + std::to_string(parts.size()) + " formulas; expected one or three");
    StageRecipe formula;
    formula.kind = is_of_x ? Kind::curve : Kind::cross_talk;
    for (const auto& [part, begin] : parts) {
        try {
            if (part.find('^') != std::string_view::npos) {
                throw FormulaError({1, part.find('^') + 1},
                                   "^ is no power here; expected pow(a, b)");
            }
            formula.f.push_back(parse_formula(part, scope));
        } catch (const FormulaError& e) {
            const bool has_steps = text.find_first_of(kSteps) != std::string_view::npos;
            fail(text, "column " + std::to_string(begin + e.at.column) + ": " + e.text() +
                           (has_steps ? "; a formula is an expression of x, or of r, g and b, with "
                                        "steps before it: a = x*2; a/(1 + a)"
                                      : ""));
        }
    }
    if (!is_of_x && formula.f.size() == 1) formula.f.resize(3, formula.f[0]);

    StageRecipe limit;
    limit.kind = Kind::clamp;
    limit.hi = kHalfMax;
    const auto recipe = std::make_shared<OperatorRecipe>();
    recipe->stages = {limit, formula};
    auto op = std::make_shared<Operator>();
    op->id = "formula";
    op->title = printable(text, kLongestName);
    op->view = op->title;
    op->character = "a formula of scene-linear Rec.709";
    op->source = "typed";
    op->license = "of its author";
    op->negatives = "clamped at 0 before the formula";
    op->file = text;
    op->build = BuildRecipe{recipe};
    recipe->output_primaries = op->working;
    op->caution = [f = formula.f[0], is_of_x, title = op->title](const Params&) -> std::string {
        constexpr double kMidGray = 0.18;
        const std::array<double, 3> gray = {kMidGray, kMidGray, kMidGray};
        const double result = evaluate(f, Span<const double>(gray.data(), is_of_x ? 1 : 3));
        if (!(result > kEncodedGray && result < 1)) return "";
        return title + ": mid gray 0.18 becomes " + shortest(std::round(result * 1000) / 1000) +
               ", as code values would; expected linear light, which --display encodes";
    };
    try {
        (void)build_stages(*recipe, recipe->stages, {});  // its results must be finite
    } catch (const StageError& e) {
        fail(text, e.text());
    }
    return op;
}

TONEWRIGHT_NAMESPACE_END
