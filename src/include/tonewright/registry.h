// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "tonewright/definition.h"
#include "tonewright/pipeline.h"

/// The built-in operators, by name.
TONEWRIGHT_NAMESPACE_BEGIN

/// All operators that map each pixel by itself, sorted by id. The table is generated from the files
/// of src/operators/.
[[nodiscard]] TONEWRIGHT_API const std::vector<Operator>& all_operators();
/// The operators that reproduce mistakes of public programs, sorted by id. They are in no list, and
/// no name finds them: a user would apply a mistake by accident. match_lut() recognizes them.
[[nodiscard]] TONEWRIGHT_API const std::vector<Operator>& known_defects();
/// All operators that look at a pixel's surroundings, sorted by id. They work on pictures only.
[[nodiscard]] TONEWRIGHT_API const std::vector<Operator>& local_operators();

/// What the config shows first, and `apply` where no operator is named.
inline constexpr std::string_view kDefaultOperator = "agx_blender";

// Names are the same in any case, and with `-`, `_` or blanks. An operator has three: its id
// ("agx_blender"), its view in the config ("AgX") and its title ("AgX (Blender)").

/// Operators that texts can name beside the built-in ones. Nothing is registered in the process.
class TONEWRIGHT_API OperatorSet {
  public:
    OperatorSet() = default;
    /// @param tables  reads LUTs that texts name as operators, and those of .tone files
    explicit OperatorSet(TableReader tables) : tables_(std::move(tables)) {}

    /// @throws Error  one of its names, id, view or title, names another operator of the set or a
    ///                built-in one
    void add(std::shared_ptr<const Operator> op);
    [[nodiscard]] const std::vector<std::shared_ptr<const Operator>>& operators() const {
        return operators_;
    }
    [[nodiscard]] const TableReader& tables() const { return tables_; }

  private:
    TableReader tables_;
    std::vector<std::shared_ptr<const Operator>> operators_;
};

/// @throws Error  with the nearest name when there is no such operator, or for a local operator.
[[nodiscard]] TONEWRIGHT_API const Operator& find_operator(std::string_view name);
/// The same, but accepts local operators.
[[nodiscard]] TONEWRIGHT_API const Operator& find_picture_operator(std::string_view name);

/// An operator and what a text says about it: `name[:preset][:parameter=value...][:look=id]`, and
/// names of views with a look or a preset ("AgX Punchy"). Blanks may stand where a `:` stands
/// before `parameter=`. `\` takes its meaning from a `:`, a blank or a `\` of a value.
///
/// Instead of a name, the path of a .tone file or a LUT: what ends in `.tone` or one of
/// table_extensions() at the end of the text or before a `:` or a blank, with all `:` and blanks
/// before that. It is read on every call, a LUT through the set's reader. A text
/// that begins with an operator's name and a `:` names that operator; `./` before it names a file.
///
/// @param settings  parameter name -> text, beside those of the text.
/// @param look      look id or title, or empty.
/// @throws Error    as find_operator(), find_preset(), resolve() and load_operator(), and where the
///                  text and the other arguments contradict each other.
[[nodiscard]] TONEWRIGHT_API ResolvedOperator resolve_operator(std::string_view text,
                                                               const Settings& settings = {},
                                                               std::string_view look = {},
                                                               const OperatorSet& others = {});
/// The same, but accepts local operators.
[[nodiscard]] TONEWRIGHT_API ResolvedOperator
resolve_picture_operator(std::string_view text, const Settings& settings = {},
                         std::string_view look = {}, const OperatorSet& others = {});
/// True where the text names a .tone file or a LUT.
[[nodiscard]] TONEWRIGHT_API bool names_a_file(std::string_view text);
/// True where the text names a LUT.
[[nodiscard]] TONEWRIGHT_API bool names_a_lut(std::string_view text);

/// The inverse of resolve_operator(): a text that names the operator with its preset, its look and
/// the settings that make a difference.
[[nodiscard]] TONEWRIGHT_API std::string operator_text(const ResolvedOperator& op);

/// An operator, `operator:preset`, or an operator with a look.
struct OperatorVariant {
    std::string name;
    std::string look;
};
/// Every operator, each with every preset and with every look.
[[nodiscard]] TONEWRIGHT_API std::vector<OperatorVariant> all_variants();

TONEWRIGHT_NAMESPACE_END
