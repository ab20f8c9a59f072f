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
/// The operators that reproduce mistakes of public programs, sorted by id. Lists and names leave
/// them out, so that no user applies a mistake by accident. match_lut() recognizes them.
[[nodiscard]] TONEWRIGHT_API const std::vector<Operator>& known_defects();
/// All operators that look at a pixel's surroundings, sorted by id. They work on pictures only.
[[nodiscard]] TONEWRIGHT_API const std::vector<Operator>& local_operators();

/// The default view of the config, and the default operator of `apply`.
inline constexpr std::string_view kDefaultOperator = "agx_blender";

// Names ignore case, and `-`, `_` and blanks are equal. An operator has three names: its id
// ("agx_blender"), its view in the config ("AgX") and its title ("AgX (Blender)").

/// Operators that names may refer to beside the built-in ones. Nothing is registered in the
/// process.
class TONEWRIGHT_API OperatorSet {
  public:
    OperatorSet() = default;
    enum class Formulas : bool { no, yes };
    /// @param tables    reads LUTs as operators, and the LUTs of .tone files
    /// @param formulas  yes: a text that is neither a name nor a file may be a formula
    explicit OperatorSet(TableReader tables, Formulas formulas = Formulas::no)
        : tables_(std::move(tables)), takes_formulas_(formulas == Formulas::yes) {}

    /// @throws Error  its id, view or title is that of another operator of the set or of a built-in
    ///                one
    void add(std::shared_ptr<const Operator> op);
    [[nodiscard]] const std::vector<std::shared_ptr<const Operator>>& operators() const {
        return operators_;
    }
    [[nodiscard]] const TableReader& tables() const { return tables_; }
    [[nodiscard]] bool takes_formulas() const { return takes_formulas_; }

  private:
    TableReader tables_;
    bool takes_formulas_ = false;
    std::vector<std::shared_ptr<const Operator>> operators_;
};

/// @throws Error  unknown name, with the nearest one; a local operator
[[nodiscard]] TONEWRIGHT_API const Operator& find_operator(std::string_view name);
/// The same, but accepts local operators.
[[nodiscard]] TONEWRIGHT_API const Operator& find_picture_operator(std::string_view name);
/// @throws Error  a local operator, which looks at a pixel's surroundings
TONEWRIGHT_API void require_no_surroundings(const Operator& op);

/// Resolves a text `name[:preset][:parameter=value...][:look=id]`, or the name of a view with a
/// look or a preset ("AgX Punchy"). A blank may replace the `:` before `parameter=`. Write `:`, a
/// blank and `\` in a value as `\:`, `\ ` and `\\`.
///
/// Instead of a name, the text may begin with the path of a .tone file or a LUT, which ends in
/// `.tone` or one of table_extensions(), at the end of the text or before a `:` or a blank. The
/// path may contain `:` and blanks. The file is read on every call, a LUT through the set's reader.
/// A text that begins with an operator's name and a `:` names that operator; with `./` before it, a
/// file.
///
/// If the set takes formulas, any other text that may_be_formula() is one, to its end:
/// "x < 1 ? x : 1". @see formula_operator
///
/// @param settings  further settings, parameter name -> text
/// @param look      look id or title, or empty
/// @throws Error    as find_operator(), find_preset(), resolve() and load_operator(); the text and
///                  the other arguments contradict each other
[[nodiscard]] TONEWRIGHT_API ResolvedOperator resolve_operator(std::string_view text,
                                                               const Settings& settings = {},
                                                               std::string_view look = {},
                                                               const OperatorSet& others = {});
/// The same, but accepts local operators.
[[nodiscard]] TONEWRIGHT_API ResolvedOperator
resolve_picture_operator(std::string_view text, const Settings& settings = {},
                         std::string_view look = {}, const OperatorSet& others = {});
/// The operator with settings and a look for what it does not state itself.
/// @throws Error  @see resolve_operator
[[nodiscard]] TONEWRIGHT_API ResolvedOperator with_defaults(const ResolvedOperator& own,
                                                            const Settings& settings,
                                                            std::string_view look);
/// The operators that the texts name; for `all`, every operator, preset and look instead.
/// @throws Error  @see resolve_operator
[[nodiscard]] TONEWRIGHT_API std::vector<ResolvedOperator> resolve_operators(
    const std::vector<std::string>& texts, const OperatorSet& others = {});
/// True if the text names a .tone file or a LUT.
[[nodiscard]] TONEWRIGHT_API bool names_a_file(std::string_view text);
/// True if the text names a LUT.
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
