// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <set>
#include <string>
#include <unordered_map>
#include <vector>

#include "shader/language.h"
#include "tonewright/expr.h"

TONEWRIGHT_NAMESPACE_BEGIN

/// Functions that read a table or a Grid in the text.
struct TableText {
    std::string function;  // of the number, or of the color
    /// For a table with positions: the function that finds the cell of a number. Tables with the
    /// same positions share it, and `function` is a pattern with {cell} and, for straight lines
    /// between samples, {x}.
    std::string cell_function = {};
    /// The texture that the function takes after the number or the color; empty: none.
    std::string texture = {};
};

/// Prints expressions as the body of a function. Expressions that are read twice, or are too long
/// for a line, become local variables.
class FunctionBody {
  public:
    /// @param inputs  the text of input 0, 1, ...
    /// @param taken   names that variables must not have
    /// @param names   numbers that become variables of these names
    /// @param tables  functions for tables and Grids
    FunctionBody(const LanguageFacts& language, std::vector<std::string> inputs,
                 std::set<std::string> taken, std::map<double, std::string> names,
                 std::map<const void*, TableText> tables);

    /// Declares all expressions to print; call it before the first value(). Numbers that have a
    /// name become variables here.
    void count(const Expr& e);
    /// Text of the expression; adds its statements to lines().
    [[nodiscard]] std::string value(const Expr& e);
    /// Assigns it to a variable of this name, which becomes the next input.
    void add_input(const std::string& name, const std::string& value);
    [[nodiscard]] const std::string& lines() const { return lines_; }

  private:
    struct Text {
        std::string text;
        int precedence = 0;
        bool is_condition = false;
    };
    [[nodiscard]] Text print(const Expr& e);
    [[nodiscard]] Text compose(const Expr& e);
    [[nodiscard]] std::string operand(const Expr& e, int precedence);
    [[nodiscard]] std::string number(const Text& t, int precedence) const;
    [[nodiscard]] std::string condition(const Text& t) const;
    [[nodiscard]] std::string choose(const Expr& e);
    [[nodiscard]] std::string name_for(const Expr& e);
    [[nodiscard]] std::string unique(const std::string& name);
    [[nodiscard]] std::string table_value(const Expr& e);
    [[nodiscard]] std::string grid_channel(const Expr& e);
    /// A literal, or the variable that holds it.
    [[nodiscard]] std::string literal(double value) const;
    void add_line(const char* type, const std::string& name, const std::string& value);

    const LanguageFacts& language_;
    std::vector<std::string> inputs_;
    std::set<std::string> taken_;
    std::map<double, std::string> names_;      // of numbers
    std::map<double, std::string> variables_;  // of those that are read
    std::map<const void*, TableText> tables_;
    std::unordered_map<const ExprNode*, int> uses_;
    std::unordered_map<const ExprNode*, Text> known_;
    PartNames parts_;
    /// Parts by their name.
    std::map<std::string, std::vector<const ExprNode*>> named_;
    /// For powers of a variable by multiplication: the variable and the exponent.
    std::unordered_map<const ExprNode*, std::pair<std::string, int>> powers_;
    /// Colors read from Grids, by the call.
    std::map<std::string, std::string> grid_colors_;
    /// Cells found in tables, by the call.
    std::map<std::string, std::string> cells_;
    std::string lines_;
};

TONEWRIGHT_NAMESPACE_END
