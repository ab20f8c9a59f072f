// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <functional>
#include <limits>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "tonewright/color.h"
#include "tonewright/error.h"
#include "tonewright/expr.h"

TONEWRIGHT_NAMESPACE_BEGIN

/// Largest finite half float. Every backend limits scene-linear values to this range after the
/// exposure, because OpenColorIO's half-domain tables end there. All backends then agree for every
/// input.
inline constexpr double kHalfMax = 65504.0;
inline constexpr double kInfinity = std::numeric_limits<double>::infinity();

// ---------------------------------------------------------------------------------------------
// Stages: the structure of an operator, for LUTs and OpenColorIO. Lowering looks at the kind of a
// stage, never at the name of the operator.

/// Linear mixing of channels: y = M x.
struct MatrixStage {
    Matrix3 m;
    /// Its name in the source of the operator, in lower_snake: a shader's function gets this name.
    /// Empty: none. The text must live as long as a string literal.
    const char* name = "";
};

/// One function for each channel by itself.
struct CurveStage {
    /// Functions of input 0. If one curve serves all channels, the three are the same node.
    std::array<Expr, 3> f;
    /// Analytic inverse, if the source has one; functions of input 0.
    std::optional<std::array<Expr, 3>> inverse;
    const char* name = "";  // see MatrixStage::name

    [[nodiscard]] bool is_uniform() const { return same(f[0], f[1]) && same(f[1], f[2]); }
};

/// Scales all three channels by f(n)/n: hue and chromaticity stay, only the norm n is mapped.
/// If n <= 0, the result is black, so the ratio is never 0/0.
struct ToneScaleStage {
    enum class Norm : unsigned char { luminance, max_rgb };
    Norm norm = Norm::luminance;
    /// Weights of the luminance; unused with max_rgb.
    Vector3 weights = kRec709Weights;
    /// Function of the norm, which is input 0; f(0) must be 0.
    Expr f;
};

/// Maps the largest and the smallest channel by one curve. The middle channel keeps its relative
/// position: c' = f(min) + (f(max) - f(min)) (c - min)/(max - min). Keeps the hue of HSV.
struct HuePreservingStage {
    Expr f;  // function of input 0
};

/// Works on the hexcone of HSV and keeps its hue. With p = max - offset(min):
/// c' = value(p) - chroma(p) (max - c). The largest channel becomes value(p), and the distances of
/// the others from it are multiplied by chroma(p). Defined for inputs >= 0.
struct HexconeStage {
    Expr offset;  // function of the smallest channel; 0 <= offset(x) <= x
    Expr value;   // function of p
    Expr chroma;  // function of p
};

/// min(max(x, lo), hi) per channel; either end may be infinite.
struct ClampStage {
    double lo = 0;
    double hi = kInfinity;
    /// The limit of scene-linear values, in a view that exposes its input first. Engines give such
    /// a pipeline all numbers, not those within +-kHalfMax. @see limits_input()
    bool is_input_limit = false;
};

/// A channel-mixing stage: three functions of red, green and blue (inputs 0, 1, 2), which no chain
/// of the other stages expresses.
struct CrossTalkStage {
    std::array<Expr, 3> f;
    const char* name = "";  // see MatrixStage::name
};

/// A 3D LUT by definition, such as Blender's AgX. One curve maps every channel to the axes of the
/// LUT, which is interpolated in tetrahedra. The interpolation is part of the definition.
struct GridStage {
    Expr shaper;  // function of input 0; limited to [0, 1]
    std::shared_ptr<const Grid> grid;
};

using Stage = std::variant<MatrixStage, CurveStage, ToneScaleStage, HuePreservingStage,
                           HexconeStage, ClampStage, CrossTalkStage, GridStage>;
using Pipeline = std::vector<Stage>;

[[nodiscard]] TONEWRIGHT_API MatrixStage exposure_stage(double stops);
/// One curve for all channels; `f` is a function of input 0.
[[nodiscard]] TONEWRIGHT_API CurveStage curve_stage(const Expr& f);
[[nodiscard]] TONEWRIGHT_API CurveStage curve_stage(const Expr& f, const Expr& inverse);
/// The stage with its name in the source of the operator.
template <class NamedStage>
[[nodiscard]] NamedStage named(const char* name, NamedStage stage) {
    stage.name = name;
    return stage;
}

/// The name of the kind in messages and docs: "matrix", "curve", "tone scale", "hue-preserving
/// curve", "hexcone", "clamp", "cross-talk", "grid".
[[nodiscard]] TONEWRIGHT_API std::string_view stage_kind(const Stage& stage);
/// True if the stage changes no pixel.
[[nodiscard]] TONEWRIGHT_API bool is_identity(const Stage& stage);
/// True if an output channel depends on another input channel.
[[nodiscard]] TONEWRIGHT_API bool mixes_channels(const Stage& stage);
/// True if one function maps each channel by itself, so that a 1D table can represent the pipeline.
[[nodiscard]] TONEWRIGHT_API bool is_per_channel(const Pipeline& pipeline);
/// The three outputs, as expressions of `rgb`.
[[nodiscard]] TONEWRIGHT_API std::array<Expr, 3> apply_stage(const Stage& stage,
                                                             const std::array<Expr, 3>& rgb);
/// True if engines limit the input to +-kHalfMax: no stage of the pipeline is the input's limit.
[[nodiscard]] TONEWRIGHT_API bool limits_input(const Pipeline& pipeline);
/// The whole pipeline as three expressions of inputs 0, 1, 2.
[[nodiscard]] TONEWRIGHT_API std::array<Expr, 3> compose(const Pipeline& pipeline);
/// Drops identities, multiplies neighboring matrices (in double), and joins neighboring clamps. The
/// picture stays the same. Every backend does this, except the reference engine.
[[nodiscard]] TONEWRIGHT_API Pipeline simplify(const Pipeline& pipeline);
/// A readable listing, one stage a line.
[[nodiscard]] TONEWRIGHT_API std::string to_string(const Pipeline& pipeline);

// ---------------------------------------------------------------------------------------------
// Parameters

/// Statistics of a whole picture that operators use: relative luminance (0.2126, 0.7152, 0.0722)
/// and channels of Rec.709 light. Negatives and NaN count as 0.
struct SceneStatistics {
    /// exp(mean ln L) over the pixels with L > 0.
    double log_average = 0;
    double mean_luminance = 0;
    /// Over the pixels with L > 0.
    double minimum_luminance = 0;
    double maximum_luminance = 0;
    Vector3 mean_rgb{};
    Vector3 maximum_rgb{};
};

/// Facts about the display that operators use.
struct DisplayFacts {
    Primaries primaries;
    bool is_hdr = false;
    /// cd/m2, if the display shows scene-linear 1.0 at 100 cd/m2; 100 for an SDR display.
    double peak = 100;
};

/// One named, typed, bounded parameter of an operator.
struct ParameterSpec {
    enum class Kind : unsigned char { number, choice, text };
    Kind kind = Kind::number;
    std::string name;
    std::string unit;  // "scene-linear", "stops", "cd/m2", "" for pure numbers
    double default_value = 0;
    double min = 0;  // closed interval
    double max = 1;
    std::string help;
    /// The operator reads the number through Params::expr(): one expression serves every value.
    /// @see fixed_parameters()
    bool is_live = true;
    /// Values of a choice.
    std::vector<std::string> choices;
    /// Default of a choice or text.
    std::string default_choice;
    /// Not null: if there is a whole picture and the user has not set the number, this function
    /// gives it (limited to the interval). Otherwise the default holds.
    std::function<double(const SceneStatistics&)> from_picture = {};
    /// The name of that number: "maximum luminance of the picture".
    std::string statistic;
    /// Not null: in a view of a display, if the user has not set the value, this function gives it.
    /// Otherwise, or if the function gives an empty text, the default holds.
    std::function<std::string(const DisplayFacts&)> from_display = {};
};

[[nodiscard]] TONEWRIGHT_API ParameterSpec number_parameter(std::string name, std::string unit,
                                                            double value, double min, double max,
                                                            std::string help);
/// The same parameters, none of them live: the operator branches on their numbers, or derives
/// numbers from them that no expression can compute.
[[nodiscard]] TONEWRIGHT_API std::vector<ParameterSpec> fixed_parameters(
    std::vector<ParameterSpec> specs);
[[nodiscard]] TONEWRIGHT_API ParameterSpec choice_parameter(std::string name,
                                                            std::vector<std::string> choices,
                                                            std::string value, std::string help);
/// Free text, such as a file name. Empty by default.
[[nodiscard]] TONEWRIGHT_API ParameterSpec text_parameter(std::string name, std::string help);
/// A number with a default, which each picture can replace.
[[nodiscard]] TONEWRIGHT_API ParameterSpec statistic_parameter(
    ParameterSpec number, std::string statistic, double (*from_picture)(const SceneStatistics&));

/// A parameter with a default, which each display can replace.
[[nodiscard]] TONEWRIGHT_API ParameterSpec
display_parameter(ParameterSpec spec, std::string (*from_display)(const DisplayFacts&));

/// Texts that a user typed: name -> value.
using Settings = std::map<std::string, std::string>;

struct Operator;
struct Preset;
struct ResolvedOperator;

/// Complete, checked values of an operator's parameters, and its look.
class TONEWRIGHT_API Params {
  public:
    /// @pre the operator declares a number parameter of this name, which is not live here
    [[nodiscard]] double number(std::string_view name) const;
    /// The number as a constant, or as a uniform of that name if it is live.
    /// @pre the operator declares a number parameter of this name
    [[nodiscard]] Expr expr(std::string_view name) const;
    /// @pre the operator declares an enumeration of this name
    [[nodiscard]] const std::string& choice(std::string_view name) const;
    /// @pre the operator declares a text parameter of this name
    [[nodiscard]] const std::string& text(std::string_view name) const;
    /// Id of the look, or empty.
    [[nodiscard]] const std::string& look() const { return look_; }

    friend bool operator==(const Params& a, const Params& b) {
        return a.numbers_ == b.numbers_ && a.choices_ == b.choices_ && a.texts_ == b.texts_ &&
               a.look_ == b.look_ && a.live_ == b.live_;
    }

  private:
    friend ResolvedOperator resolve(const Operator&, const Preset*, const Settings&,
                                    std::string_view);
    friend Pipeline build_live(const ResolvedOperator&, const std::vector<std::string>&);
    std::map<std::string, double, std::less<>> numbers_;
    std::map<std::string, std::string, std::less<>> choices_;
    std::map<std::string, std::string, std::less<>> texts_;
    std::string look_;
    std::set<std::string, std::less<>> live_;
};

// ---------------------------------------------------------------------------------------------
// Operators

struct Look {
    std::string id;
    std::string title;
    std::string help;
};

/// A named set of parameter values: `reinhard:luminance`.
struct Preset {
    std::string id;
    std::string title;
    Settings settings;
};

/// A law of tone curves that an operator breaks. The operator's file declares it, the law tests
/// check that it is true, and lists and docs show it.
struct DocumentedDifference {
    enum class Kind : unsigned char {
        black,                // native value of black: value
        crushes_black,        // grays up to value are shown as black
        never_reaches_white,  // the largest gray is shown at value < 1, display-linear
        exceeds_white,        // native light goes up to value > 1 (kInfinity: unbounded)
        not_monotone,         // brighter grays may be shown darker, up to scene-linear value
        tints_gray,           // the sRGB code values of a gray differ by up to value
        jumps,                // neighboring grays differ by up to value, native
    };
    Kind kind;
    double value;
    /// Id of the preset or look that it applies to, in place of a general one; empty: general.
    std::string when;
};

/// Names of the kinds in .tone files and JSON, in the order of Kind: "black", ...
[[nodiscard]] TONEWRIGHT_API const std::vector<std::string>& difference_names();
/// "lifts black to 0.0029".
[[nodiscard]] TONEWRIGHT_API std::string to_string(const DocumentedDifference& difference);

/// Default error bound of SimdEngine.
inline constexpr double kSimdError = 1e-6;

/// Error bounds of an operator that are wider than those of its structure, in display code values.
struct DeclaredBounds {
    double simd = kSimdError;       // for all colors, also those beyond all gamuts
    double simd_goal = kSimdError;  // the bound that SimdEngine is compiled for
    double ocio_cpu = 0;            // 0: the bound of its structure
    double ocio_gpu = 0;
    double lut3d = 0;      // if OpenColorIO needs a 3D LUT of 65^3; 0: one 10-bit code
    double lut3d_hdr = 0;  // the same on HDR displays; 0: the value of `lut3d`
    std::string reason;
};

/// Meaning of an operator's output.
enum class OutputKind : unsigned char {
    display_linear,  // display light, 1 = display peak
    code_value,      // already encoded with a pure power: decode before any display's encoding
};

struct ScenePlanes;  // local.h

/// One tone mapping operator: everything that its backends need to know.
struct Operator {
    std::string id;         // lower_snake; a dialect is named after the program it reproduces
    std::string title;      // "Hable (Uncharted 2)"
    std::string view;       // name as a view of the OCIO config; unique, at most 63 bytes
    std::string character;  // one line: its look, strengths and weaknesses
    std::string source;     // full citation, equation numbers
    std::string license;    // of the source
    std::string negatives;  // how it treats values below 0
    /// Primaries of the stages, the input and the output.
    Primaries working = kRec709;
    OutputKind output = OutputKind::display_linear;
    /// Power of the output's code values; used only with OutputKind::code_value.
    double code_power = 2.2;
    std::vector<ParameterSpec> parameters;
    std::vector<Preset> presets;
    std::vector<Look> looks;
    /// Further facts that a user should know; sentences without a full stop.
    std::vector<std::string> warnings;
    std::vector<DocumentedDifference> differences;
    DeclaredBounds bounds;
    /// Name that several different operators share, such as "AgX". Docs compare these operators.
    /// Empty: none.
    std::string dialects;
    /// The operator shows facts about a picture, such as false colors.
    bool is_diagnostic = false;
    /// A known defect reproduces a mistake of programs. This text describes the mistake, in words
    /// that follow "a defect: ". Empty for every other operator.
    std::string defect;
    /// The operator that the program intended, as resolve_operator() reads it. Defects only.
    std::string meant;
    /// Working-space scene-linear, finite -> the operator's own output.
    std::function<Pipeline(const Params& params)> build = {};
    /// The source's own inverse: the operator's own output -> working-space scene-linear. Null:
    /// build_inverse_view() inverts the stages.
    std::function<Pipeline(const Params& params)> build_inverse = {};
    /// Primaries of the output. Null: `working`.
    std::function<Primaries(const Params& params)> output_primaries = {};
    /// Largest light of the output on an HDR display. Null: 1.
    std::function<double(const Params& params)> peak = {};
    /// The display whose code values are the output, or `linear`. Null: `output` decides.
    std::function<std::string(const Params& params)> display = {};
    /// A caution about these parameters; an empty text: none. May be null.
    std::function<std::string(const Params& params)> caution = {};
    /// Not null: a local operator, which maps a pixel by its surroundings. This function runs it on
    /// whole pictures (local.h), and build() gives the identity.
    void (*run_local)(ScenePlanes& picture, const Params& params) = nullptr;

    /// Path of the .tone or LUT file that defines the operator, as given. Empty: built in.
    std::string file = {};

    [[nodiscard]] bool is_local() const { return run_local != nullptr; }
    [[nodiscard]] bool is_defect() const { return !defect.empty(); }
    /// The name by which resolve_operator() finds it.
    [[nodiscard]] const std::string& name() const { return file.empty() ? id : file; }
};

/// An operator with its parameters fixed.
struct ResolvedOperator {
    /// Null: none yet.
    const Operator* op = nullptr;
    Params params;
    /// Name in reports: `id` or `id:preset`, with the settings that differ from the defaults.
    std::string label;
    /// The preset and settings that it was resolved from; null: no preset.
    const Preset* preset = nullptr;
    Settings settings;

    /// Keeps an operator alive that is not built in.
    std::shared_ptr<const Operator> owner = {};

    /// `id` or `id:preset`; the path instead of the id, if a file defines the operator.
    [[nodiscard]] std::string name() const {
        return preset ? op->name() + ":" + preset->id : op->name();
    }

    [[nodiscard]] Pipeline build() const { return op->build(params); }
    /// Meaning of the output with these parameters.
    [[nodiscard]] OutputKind output() const {
        if (!op->display) return op->output;
        return op->display(params) == "linear" ? OutputKind::display_linear
                                               : OutputKind::code_value;
    }
    /// A caution about these parameters; empty: none.
    [[nodiscard]] std::string caution() const { return op->caution ? op->caution(params) : ""; }
    /// Id of the display whose code values are the output. Empty: the output is light, or has the
    /// power Operator::code_power.
    [[nodiscard]] std::string output_display() const {
        return op->display && output() == OutputKind::code_value ? op->display(params) : "";
    }
    /// Primaries of the output.
    [[nodiscard]] Primaries output_primaries() const {
        return op->output_primaries ? op->output_primaries(params) : op->working;
    }
    /// Largest light of the output that a display should show; 1 is white.
    [[nodiscard]] double peak() const { return op->peak ? op->peak(params) : 1; }
};

/// Names of the operator's live parameters; a local operator has none.
[[nodiscard]] TONEWRIGHT_API std::vector<std::string> live_parameters(const Operator& op);

/// The operator with the named parameters as uniforms, and the others as resolved. bind_uniforms()
/// with some values gives the stages that resolve() builds with them. Contradictions between
/// parameters, which resolve() refuses, are not detected.
/// @throws Error  a parameter that the operator does not have, or that is not live
[[nodiscard]] TONEWRIGHT_API Pipeline build_live(const ResolvedOperator& resolved,
                                                 const std::vector<std::string>& uniforms);

/// The stages with the named uniforms replaced by constants.
[[nodiscard]] TONEWRIGHT_API Pipeline bind_uniforms(const Pipeline& pipeline,
                                                    const UniformValues& values);

/// @throws Error  naming the nearest id when the operator has no such preset.
[[nodiscard]] TONEWRIGHT_API const Preset& find_preset(const Operator& op, std::string_view id);

/// Checks settings against an operator's parameters and completes them.
///
/// @param preset    of the operator; null: none.
/// @param settings  parameter name -> text; they win over the preset's.
/// @param look      look id, or empty.
/// @throws Error    unknown parameter, look or choice (with the nearest name); a value that is no
///                  number or outside the parameter's interval. Values are never clamped.
[[nodiscard]] TONEWRIGHT_API ResolvedOperator resolve(const Operator& op, const Preset* preset,
                                                      const Settings& settings,
                                                      std::string_view look);

/// True if a picture's statistics decide parameters: neither the settings nor the preset set them.
[[nodiscard]] TONEWRIGHT_API bool takes_statistics(const ResolvedOperator& resolved);
/// The same operator with the values that a picture's statistics give to these parameters.
/// @throws Error  they contradict the other settings
[[nodiscard]] TONEWRIGHT_API ResolvedOperator
resolve_for_picture(const ResolvedOperator& resolved, const SceneStatistics& statistics);

/// The same operator for a display: parameters that neither the user nor the preset set and that a
/// display decides get its values. The label stays.
[[nodiscard]] TONEWRIGHT_API ResolvedOperator resolve_for_display(const ResolvedOperator& resolved,
                                                                  const DisplayFacts& display);

TONEWRIGHT_NAMESPACE_END
