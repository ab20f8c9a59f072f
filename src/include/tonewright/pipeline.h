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

/// Largest finite half float. Every form limits scene-linear values to +-this, because OCIO's
/// half-domain tables end there: so all forms agree about every input.
inline constexpr double kHalfMax = 65504.0;
inline constexpr double kInfinity = std::numeric_limits<double>::infinity();

// ---------------------------------------------------------------------------------------------
// Stages: what LUT makers and OCIO need to know about the structure of an operator. Lowering asks
// the stage what it is, never the operator for its name.

/// Linear mixing of channels: y = M x.
struct MatrixStage {
    Matrix3 m;
    /// What its source calls it, lower_snake: the name of a shader's function. Empty: none. It is
    /// a literal, or lives as long as one.
    const char* name = "";
};

/// One function of each channel alone.
struct CurveStage {
    /// Of input 0. The three are the same node when one curve serves all channels.
    std::array<Expr, 3> f;
    /// Analytic inverse where the source has one; of input 0.
    std::optional<std::array<Expr, 3>> inverse;
    const char* name = "";  // as a matrix's

    [[nodiscard]] bool is_uniform() const { return same(f[0], f[1]) && same(f[1], f[2]); }
};

/// All three channels scaled by f(n)/n: hue and chromaticity stay, only the norm n is mapped.
/// Where n <= 0 the result is black: the ratio is never 0/0.
struct ToneScaleStage {
    enum class Norm : unsigned char { luminance, max_rgb };
    Norm norm = Norm::luminance;
    /// Of the luminance; not read for max_rgb.
    Vector3 weights = kRec709Weights;
    /// Of input 0, the norm; f(0) must be 0.
    Expr f;
};

/// The largest and the smallest channel mapped by one curve; the middle one keeps its place between
/// them: c' = f(min) + (f(max) - f(min)) (c - min)/(max - min). Keeps the hue of HSV.
struct HuePreservingStage {
    Expr f;  // of input 0
};

/// Works on the hexcone of HSV and keeps its hue. With p = max - offset(min):
/// c' = value(p) - chroma(p) (max - c). So the largest channel becomes value(p), and every distance
/// from it is multiplied by chroma(p). Defined for inputs >= 0.
struct HexconeStage {
    Expr offset;  // of input 0, the smallest channel; 0 <= offset(x) <= x
    Expr value;   // of input 0, p
    Expr chroma;  // of input 0, p
};

/// min(max(x, lo), hi) per channel; either end may be infinite.
struct ClampStage {
    double lo = 0;
    double hi = kInfinity;
};

/// True cross-talk: three functions of red, green, blue (inputs 0, 1, 2), which no chain of the
/// other stages expresses.
struct CrossTalkStage {
    std::array<Expr, 3> f;
    const char* name = "";  // as a matrix's
};

/// A picture that a host defines by a cube: every channel placed on the cube's axes by one curve,
/// and the cube interpolated in tetrahedra. The interpolation is part of the definition.
struct LatticeStage {
    Expr shaper;  // of input 0; limited to [0, 1]
    std::shared_ptr<const Lattice> lattice;
};

using Stage = std::variant<MatrixStage, CurveStage, ToneScaleStage, HuePreservingStage,
                           HexconeStage, ClampStage, CrossTalkStage, LatticeStage>;
using Pipeline = std::vector<Stage>;

[[nodiscard]] TONEWRIGHT_API MatrixStage exposure_stage(double stops);
/// One curve for all channels; `f` is of input 0.
[[nodiscard]] TONEWRIGHT_API CurveStage curve_stage(const Expr& f);
[[nodiscard]] TONEWRIGHT_API CurveStage curve_stage(const Expr& f, const Expr& inverse);
/// The stage with the name that its source has for it.
template <class NamedStage>
[[nodiscard]] NamedStage named(const char* name, NamedStage stage) {
    stage.name = name;
    return stage;
}

/// What the stage is called in messages and docs: "matrix", "curve", "tone scale", "hue-preserving
/// curve", "hexcone", "clamp", "cross-talk", "lattice".
[[nodiscard]] TONEWRIGHT_API std::string_view stage_kind(const Stage& stage);
/// True when no pixel changes.
[[nodiscard]] TONEWRIGHT_API bool is_identity(const Stage& stage);
/// True when an output channel depends on another input channel.
[[nodiscard]] TONEWRIGHT_API bool mixes_channels(const Stage& stage);
/// True when the three channels are treated alike and apart: a 1D table holds it.
[[nodiscard]] TONEWRIGHT_API bool is_per_channel(const Pipeline& pipeline);
/// The three outputs as expressions of `rgb`.
[[nodiscard]] TONEWRIGHT_API std::array<Expr, 3> apply_stage(const Stage& stage,
                                                             const std::array<Expr, 3>& rgb);
/// The whole chain as three expressions of inputs 0, 1, 2.
[[nodiscard]] TONEWRIGHT_API std::array<Expr, 3> compose(const Pipeline& pipeline);
/// Drops identities, multiplies neighboring matrices (in double), joins neighboring clamps. The
/// picture is the same; the reference engine does not do it, every lowering does.
[[nodiscard]] TONEWRIGHT_API Pipeline simplify(const Pipeline& pipeline);
/// A readable listing, one stage a line.
[[nodiscard]] TONEWRIGHT_API std::string to_string(const Pipeline& pipeline);

// ---------------------------------------------------------------------------------------------
// Parameters

/// What operators ask of a whole picture: relative luminance (0.2126, 0.7152, 0.0722) and channels
/// of Rec.709 light, negatives and NaN counted as 0.
struct SceneStatistics {
    /// exp(mean ln L) over the pixels with L > 0.
    double log_average = 0;
    double mean_luminance = 0;
    /// Of the pixels with L > 0.
    double minimum_luminance = 0;
    double maximum_luminance = 0;
    Vector3 mean_rgb{};
    Vector3 maximum_rgb{};
};

/// What operators ask of the display that their picture is for.
struct DisplayFacts {
    Primaries primaries;
    bool is_hdr = false;
    /// cd/m2, on a display that shows light 1 at 100 cd/m2; 100 of an SDR display.
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
    /// A number that an operator takes through Params::expr(): one expression serves every value.
    /// @see fixed_parameters()
    bool is_live = true;
    /// Of an enumeration.
    std::vector<std::string> choices;
    /// Of an enumeration or text.
    std::string default_choice;
    /// Not null: a number that a picture has. Where a whole picture is at hand and the user has not
    /// set it, this is its value (limited to the interval), else the default.
    std::function<double(const SceneStatistics&)> from_picture = {};
    /// What from_picture takes: "maximum luminance of the picture".
    std::string statistic;
    /// Not null: a value that the display decides. In a view of a display, where the user has not
    /// set it, this is its value; else, and where this is empty, the default.
    std::function<std::string(const DisplayFacts&)> from_display = {};
};

[[nodiscard]] TONEWRIGHT_API ParameterSpec number_parameter(std::string name, std::string unit,
                                                            double value, double min, double max,
                                                            std::string help);
/// The same, none of them live: the operator branches on their numbers, or derives others from them
/// that no expression holds.
[[nodiscard]] TONEWRIGHT_API std::vector<ParameterSpec> fixed_parameters(
    std::vector<ParameterSpec> specs);
[[nodiscard]] TONEWRIGHT_API ParameterSpec choice_parameter(std::string name,
                                                            std::vector<std::string> choices,
                                                            std::string value, std::string help);
/// Free text: a file, a name in it. Empty by default.
[[nodiscard]] TONEWRIGHT_API ParameterSpec text_parameter(std::string name, std::string help);
/// A number with a default, and a value of its own for every picture.
[[nodiscard]] TONEWRIGHT_API ParameterSpec statistic_parameter(
    ParameterSpec number, std::string statistic, double (*from_picture)(const SceneStatistics&));

/// A parameter with a default, and a value of its own for every display.
[[nodiscard]] TONEWRIGHT_API ParameterSpec
display_parameter(ParameterSpec spec, std::string (*from_display)(const DisplayFacts&));

/// Text as typed by a user: name -> value.
using Settings = std::map<std::string, std::string>;

struct Operator;
struct Preset;
struct ResolvedOperator;

/// Complete, checked values of an operator's parameters, and its look.
class TONEWRIGHT_API Params {
  public:
    /// @pre the operator declares a number parameter of this name, which is not live here
    [[nodiscard]] double number(std::string_view name) const;
    /// The number as a constant; a uniform of that name where it is live.
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

/// Where an operator departs from what every tone curve is expected to do. Declared in its file and
/// held to be true by the law tests; lists and docs warn with it.
struct DocumentedDifference {
    enum class Kind : unsigned char {
        black,                // native value of black: value
        crushes_black,        // grays up to value are shown as black
        never_reaches_white,  // the largest gray is shown at value < 1, display-linear
        exceeds_white,        // native light goes up to value > 1 (kInfinity: without end)
        not_monotone,         // brighter grays may be shown darker, up to scene-linear value
        tints_gray,           // the sRGB code values of a gray differ by up to value
        jumps,                // neighboring grays differ by up to value, native
    };
    Kind kind;
    double value;
    /// Id of the preset or look that it is true of, whatever is said in general; empty: in general.
    std::string when;
};

/// What the kinds are called in .tone files and JSON, in their order: "black", ...
[[nodiscard]] TONEWRIGHT_API const std::vector<std::string>& difference_names();
/// "lifts black to 0.0029".
[[nodiscard]] TONEWRIGHT_API std::string to_string(const DocumentedDifference& deviation);

/// What SimdEngine keeps to unless told otherwise.
inline constexpr double kSimdError = 1e-6;

/// Error bounds that an operator's nature makes wider than its structure's, in display code values.
struct DeclaredBounds {
    double simd = kSimdError;
    double simd_goal = kSimdError;  // what SimdEngine is made for; `simd` is for colors beyond all
                                    // gamuts, too
    double ocio_cpu = 0;            // 0: as its structure has it
    double ocio_gpu = 0;
    double cube = 0;  // where the lowering to OCIO needs a 3D cube, of 65^3; 0: a code of 10 bits
    double cube_hdr = 0;  // the same on HDR displays; 0: as `cube`
    std::string reason;
};

/// What the numbers that an operator puts out are.
enum class OutputKind : unsigned char {
    display_linear,  // display light, 1 = display peak
    code_value,      // already encoded with a pure power: decode before any display's encoding
};

struct ScenePlanes;  // local.h

/// One tone mapping operator: everything that any form of it needs to know.
struct Operator {
    std::string id;         // lower_snake; a dialect has the name of what it reproduces
    std::string title;      // "Hable (Uncharted 2)"
    std::string view;       // its name as a view of the OCIO config; unique, at most 63 bytes
    std::string character;  // one line: what it looks like, what it is good and bad at
    std::string source;     // full citation, equation numbers
    std::string licence;    // of the source
    std::string negatives;  // what it does with values below 0
    /// The primaries that its stages work in, of input and output.
    Primaries working = kRec709;
    OutputKind output = OutputKind::display_linear;
    /// Of the output's code values; read only for OutputKind::code_value.
    double code_power = 2.2;
    std::vector<ParameterSpec> parameters;
    std::vector<Preset> presets;
    std::vector<Look> looks;
    /// What else a user should know; sentences without a full stop.
    std::vector<std::string> warnings;
    std::vector<DocumentedDifference> deviations;
    DeclaredBounds bounds;
    /// Operators of one name and different pictures: "AgX". Docs compare them. Empty: none.
    std::string dialects;
    /// Shows what is in a picture, not a picture: false colors.
    bool is_diagnostic = false;
    /// A known defect reproduces a mistake that programs make. This says what is wrong, in words
    /// that follow "a defect: ". Empty for every other operator.
    std::string defect;
    /// The operator that the program meant, as resolve_operator() reads it. Only of a defect.
    std::string meant;
    /// Working-space scene-linear, finite -> the operator's own output.
    std::function<Pipeline(const Params& params)> build = {};
    /// The inverse where the source has one: the operator's own output -> working-space
    /// scene-linear. Null: build_inverse_view() inverts the stages.
    std::function<Pipeline(const Params& params)> build_inverse = {};
    /// Of the output. Null: `working`.
    std::function<Primaries(const Params& params)> output_primaries = {};
    /// Largest light of the output on a display that can show more than white. Null: 1.
    std::function<double(const Params& params)> peak = {};
    /// The display whose code values come out, or `linear`. Null: `output` says what comes out.
    std::function<std::string(const Params& params)> display = {};
    /// What a user should know about these parameters; an empty text: nothing. May be null.
    std::function<std::string(const Params& params)> caution = {};
    /// Not null: what a pixel becomes depends on its surroundings, and this is the operator, for
    /// whole pictures (local.h). build() is what is left for a pixel by itself: nothing.
    void (*run_local)(ScenePlanes& picture, const Params& params) = nullptr;

    /// The .tone or LUT file that it was read from, as its path was given. Empty: it is built in.
    std::string file = {};

    [[nodiscard]] bool is_local() const { return run_local != nullptr; }
    [[nodiscard]] bool is_defect() const { return !defect.empty(); }
    /// What resolve_operator() finds it by.
    [[nodiscard]] const std::string& name() const { return file.empty() ? id : file; }
};

/// An operator with its parameters fixed.
struct ResolvedOperator {
    const Operator* op;
    Params params;
    /// `id`, `id:preset`, or with the settings that differ from the defaults: names it in reports.
    std::string label;
    /// The preset and settings that it was resolved from; null: no preset.
    const Preset* preset = nullptr;
    Settings settings;

    /// Keeps an operator that is not built in alive.
    std::shared_ptr<const Operator> owner = {};

    /// `id` or `id:preset`; of a file, its path.
    [[nodiscard]] std::string name() const {
        return preset ? op->name() + ":" + preset->id : op->name();
    }

    [[nodiscard]] Pipeline build() const { return op->build(params); }
    /// What the numbers of the output are, with these parameters.
    [[nodiscard]] OutputKind output() const {
        if (!op->display) return op->output;
        return op->display(params) == "linear" ? OutputKind::display_linear
                                               : OutputKind::code_value;
    }
    /// What a user should know about these parameters; empty: nothing.
    [[nodiscard]] std::string caution() const { return op->caution ? op->caution(params) : ""; }
    /// Id of the display whose code values come out. Empty: they are light, or code values of
    /// Operator::code_power.
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

/// Names of the operator's live parameters; none of a local operator.
[[nodiscard]] TONEWRIGHT_API std::vector<std::string> live_parameters(const Operator& op);

/// The operator with these parameters as uniforms of their names, the others as they are resolved.
/// bind_uniforms() of its stages is what resolve() builds with the same values. What resolve()
/// refuses, parameters that contradict each other, is not looked for.
/// @throws Error  a parameter that the operator does not have or that is not live.
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

/// The operator's settings, and the values that a picture's statistics give to parameters that
/// neither the settings nor the preset set.
[[nodiscard]] TONEWRIGHT_API Settings settings_for_picture(const ResolvedOperator& resolved,
                                                           const SceneStatistics& statistics);

/// The same operator for a display: parameters that neither the user nor the preset set and that a
/// display decides get its values. The label stays.
[[nodiscard]] TONEWRIGHT_API ResolvedOperator resolve_for_display(const ResolvedOperator& resolved,
                                                                  const DisplayFacts& display);

TONEWRIGHT_NAMESPACE_END
