// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "formula/formula.h"
#include "tonewright/pipeline.h"

TONEWRIGHT_NAMESPACE_BEGIN

/// A stage of a definition: its formulas have the parameters, choices and the look as uniforms.
struct StageRecipe {
    enum class Kind : unsigned char {
        matrix,          // f: nine entries, row by row
        curve,           // f: one or three; inverse: none, or as many
        tone_scale,      // f: one
        hue_preserving,  // f: one
        hexcone,         // f: offset, value, chroma
        cross_talk,      // f: three
        clamp,           // lo, hi
        lut,             // lut
    };
    Kind kind = Kind::matrix;
    std::vector<Expr> f;
    std::vector<Expr> inverse;
    ToneScaleStage::Norm norm = ToneScaleStage::Norm::luminance;
    Vector3 weights{};
    double lo = 0;
    double hi = kInfinity;
    /// Path, encoding and space of its input, stages.
    struct Lut {
        std::string path;
        std::string input;
        std::string space;
        Pipeline stages;
    } lut;
    const char* name = "";
    /// The stage is there where this is not 0.
    Expr when = 1;
    TextPosition at;
};

/// Contents of a .tone file beside the data of the Operator.
struct OperatorRecipe {
    std::vector<StageRecipe> stages;
    std::vector<StageRecipe> inverse;
    std::optional<Expr> peak;
    Primaries output_primaries{};
    std::vector<ParameterSpec> parameters;
    std::vector<std::string> looks;
};

/// The name of the uniform of an operator's look.
inline constexpr const char* kLookName = "look";
inline constexpr std::size_t kMostStages = 64;
inline constexpr std::size_t kMostNames = 64;    // of parameters, presets, looks, choices of one
inline constexpr std::size_t kLongestName = 63;  // of a view; Blender cuts what is longer

/// At most 63 small letters, digits and _, a letter first.
[[nodiscard]] bool is_id(std::string_view text);
/// Formulas use the name for a color, or for the look.
[[nodiscard]] bool is_taken_name(std::string_view name);
/// Why an operator with the other parameters has none of this name; empty if it may.
[[nodiscard]] std::string why_no_parameter(const std::string& name,
                                           const std::vector<ParameterSpec>& others);

/// An error of a stage that gives no finite number: the message, and the position of the stage.
class StageError : public Error {
  public:
    StageError(TextPosition where, const std::string& message) : Error(message), at(where) {}
    TextPosition at;
};

/// The stages whose `when` is not 0 with these parameters, which none that is live decides.
[[nodiscard]] std::vector<const StageRecipe*> stages_used(const OperatorRecipe& recipe,
                                                          const std::vector<StageRecipe>& stages,
                                                          const Params& params);

/// The stages with these parameters; those that are live stay uniforms.
/// @throws StageError  a stage gives no finite number for a color of the sample set. It is not
///                     looked for where a parameter is live.
[[nodiscard]] Pipeline build_stages(const OperatorRecipe& recipe,
                                    const std::vector<StageRecipe>& stages, const Params& params);
/// The number, which no live parameter decides.
[[nodiscard]] double number_of(const OperatorRecipe& recipe, const Expr& e, const Params& params);

/// Operator::build and build_inverse of what a file defines: definition_of() finds its LUTs here.
struct BuildRecipe {
    std::shared_ptr<const OperatorRecipe> recipe;
    std::vector<StageRecipe> OperatorRecipe::*stages = &OperatorRecipe::stages;
    Pipeline operator()(const Params& params) const {
        return build_stages(*recipe, (*recipe).*stages, params);
    }
};

/// A name that lives as long as the process, as stages want it.
[[nodiscard]] const char* kept_name(const std::string& name);

TONEWRIGHT_NAMESPACE_END
