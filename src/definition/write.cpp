// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <cmath>
#include <string>

#include "base/format_number.h"
#include "base/strings.h"
#include "definition/primaries_names.h"
#include "definition/recipe.h"
#include "definition/table_stages.h"
#include "formula/formula.h"
#include "tonewright/definition.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

/// A number of TOML. The integer -0 would be 0, and integers end at 2^63.
std::string number(double value) {
    constexpr double kLargestInteger = 0x1p53;
    const bool is_no_integer = value == 0 ? std::signbit(value) : std::abs(value) > kLargestInteger;
    const std::string text = shortest(value);
    const bool has_digits_only = text.find_first_not_of("-0123456789") == std::string::npos;
    return is_no_integer && has_digits_only ? text + ".0" : text;
}

std::string quoted(std::string_view text) {
    std::string result = "\"";
    for (const char c : text) {
        if (c == '"' || c == '\\') result += '\\';
        result += c == '\n' || c == '\t' ? ' ' : c;
    }
    return result + "\"";
}

std::string numbers(std::initializer_list<double> values) {
    std::string text;
    for (const double v : values)
        text += (text.empty() ? "[" : ", ") + number(v);
    return text + "]";
}

std::string primaries_text(const Primaries& primaries) {
    for (const auto& [name, known] : named_primaries()) {
        if (known == primaries) return quoted(name);
    }
    const auto pair = [](const char* name, Chromaticity c) {
        return std::string(name) + " = " + numbers({c.x, c.y});
    };
    return "{ " + pair("red", primaries.red) + ", " + pair("green", primaries.green) + ", " +
           pair("blue", primaries.blue) + ", " + pair("white", primaries.whitepoint) + " }";
}

class Writer {
  public:
    explicit Writer(const ResolvedOperator& resolved)
        : resolved_(resolved), op_(*resolved.op), live_(live_parameters(op_)) {}

    std::string write() {
        if (op_.is_local()) throw Error("it looks at the surroundings of a pixel");
        write_head();
        for (const ParameterSpec& spec : op_.parameters) {
            if (std::find(live_.begin(), live_.end(), spec.name) != live_.end())
                write_parameter(spec);
        }
        write_declarations();
        if (is_table_) {
            text_ += "\n[[stage]]\n";
            write_lut({op_.file, resolved_.params.text("input"), space_of_table(resolved_), {}});
            return std::move(text_);
        }
        write_stages("stage", resolved_);
        if (op_.build_inverse) {
            Operator back = op_;
            back.build = op_.build_inverse;
            ResolvedOperator inverse = resolved_;
            inverse.op = &back;
            write_stages("inverse", inverse);
        }
        return std::move(text_);
    }

  private:
    /// A LUT is one stage, which names its file.
    void write_lut(const StageRecipe::Lut& lut) {
        text_line("lut", lut.path);
        text_line("input", lut.input.empty() ? std::string(kNoEncoding) : lut.input);
        text_line("space", lut.space);
    }

    void line(const std::string& key, const std::string& value) {
        text_ += key + " = " + value + "\n";
    }
    void text_line(const std::string& key, const std::string& value) {
        if (!value.empty()) line(key, quoted(value));
    }

    void write_head() {
        if (resolved_.label != op_.id) text_ += "# " + one_line(resolved_.label) + "\n";
        line("tonewright", "1");
        text_line("id", op_.id);
        text_line("title", op_.title);
        text_line("view", op_.view);
        text_line("character", op_.character);
        text_line("source", op_.source);
        text_line("license", op_.license);
        text_line("negatives", op_.negatives);
        std::string warnings;
        for (const std::string& warning : op_.warnings)
            warnings += (warnings.empty() ? "" : ", ") + quoted(warning);
        if (!warnings.empty()) line("warnings", "[" + warnings + "]");
        const Primaries output = resolved_.output_primaries();
        text_ += "\n[primaries]\n";
        line("working", primaries_text(op_.working));
        const std::string display = resolved_.output_display();
        if (!(output == op_.working) && display.empty()) line("output", primaries_text(output));
        const bool has_peak = op_.peak && !is_table_;
        if (resolved_.output() == OutputKind::display_linear && !has_peak) return;
        text_ += "\n[output]\n";
        if (resolved_.output() == OutputKind::code_value) {
            line("kind", quoted("code_value"));
            if (display.empty()) {
                line("power", number(op_.code_power));
            } else {
                line("display", quoted(display));
            }
        }
        if (op_.peak && display.empty()) line("peak", peak_text());
    }

    /// The operator with one parameter changed; where that contradicts others, as it is.
    [[nodiscard]] ResolvedOperator with(const std::string& name, double value) const {
        Settings settings = resolved_.settings;
        settings[name] = shortest(value);
        try {
            return resolve(op_, resolved_.preset, settings, resolved_.params.look());
        } catch (const Error&) {
            return resolved_;
        }
    }

    /// Operators give their peak as a number. It is a parameter, or the hundredth of one, where
    /// other values of that parameter say so.
    [[nodiscard]] std::string peak_text() const {
        for (const ParameterSpec& spec : op_.parameters) {
            if (std::find(live_.begin(), live_.end(), spec.name) == live_.end()) continue;
            const double now = resolved_.params.number(spec.name);
            const double value = (now + spec.max) / 2;
            const double peak = with(spec.name, value).peak();
            if (peak == resolved_.peak()) continue;
            for (const double unit : {1.0, 100.0}) {
                if (peak == value / unit && resolved_.peak() == now / unit)
                    return quoted(unit == 1 ? spec.name : spec.name + "/100");
            }
            throw Error("its peak depends on parameter " + spec.name);
        }
        return number(resolved_.peak());
    }

    void write_parameter(const ParameterSpec& spec) {
        text_ += "\n[parameter." + spec.name + "]\n";
        line("default", number(resolved_.params.number(spec.name)));
        line("min", number(spec.min));
        line("max", number(spec.max));
        text_line("unit", spec.unit);
        text_line("doc", spec.help);
        // The statistic that the function returns.
        if (spec.from_picture) {
            const SceneStatistics statistics = {0.25, 0.5, 0.125, 0.75, {}, {}};
            const double value = spec.from_picture(statistics);
            if (value == 0.25) line("from_picture", quoted("log_average"));
            if (value == 0.5) line("from_picture", quoted("mean_luminance"));
            if (value == 0.125) line("from_picture", quoted("minimum_luminance"));
            if (value == 0.75) line("from_picture", quoted("maximum_luminance"));
        }
        if (spec.from_display) {
            const double peak = std::clamp(1234.0, spec.min, spec.max);
            const double sdr = std::clamp(100.0, spec.min, spec.max);
            if (spec.from_display({kRec2020, true, 1234}) == shortest(peak) &&
                spec.from_display({kRec709, false, 100}) == shortest(sdr))
                line("from_display", quoted("peak"));
        }
    }

    void write_declarations() {
        const std::string& look = resolved_.params.look();
        for (const DocumentedDifference& d : op_.differences) {
            const bool is_meant = d.when.empty() || d.when == look ||
                                  (resolved_.preset && resolved_.preset->id == d.when);
            if (!is_meant) continue;
            text_ += "\n[[deviation]]\n";
            line("kind", quoted(difference_names().at(static_cast<std::size_t>(d.kind))));
            line("value", number(d.value));
        }
        const DeclaredBounds& b = op_.bounds;
        const DeclaredBounds plain;
        std::string bounds;
        const auto bound = [&](const char* key, double value, double otherwise) {
            if (value != otherwise) bounds += std::string(key) + " = " + number(value) + "\n";
        };
        bound("simd", b.simd, plain.simd);
        bound("simd_goal", b.simd_goal, plain.simd_goal);
        bound("ocio_cpu", b.ocio_cpu, plain.ocio_cpu);
        bound("ocio_gpu", b.ocio_gpu, plain.ocio_gpu);
        bound("cube", b.lut3d, plain.lut3d);
        bound("cube_hdr", b.lut3d_hdr, plain.lut3d_hdr);
        if (bounds.empty()) return;
        text_ += "\n[bounds]\n" + bounds;
        text_line("reason", b.reason);
    }

    void write_stages(const std::string& key, const ResolvedOperator& of) {
        const Pipeline pipeline = build_live(of, live_);
        const auto begin = [&] { text_ += "\n[[" + key + "]]\n"; };
        const auto write = [&](const Stage& stage) {
            begin();
            std::visit([&](const auto& s) { write_stage(s); }, stage);
        };
        const auto* const file = of.op->build.target<BuildRecipe>();
        if (!file) {
            std::for_each(pipeline.begin(), pipeline.end(), write);
            return;
        }
        // A LUT is written as its file, not as its stages.
        auto next = pipeline.begin();
        const OperatorRecipe& recipe = *file->recipe;
        for (const StageRecipe* const stage :
             stages_used(recipe, recipe.*file->stages, of.params)) {
            if (stage->kind == StageRecipe::Kind::lut) {
                begin();
                write_lut(stage->lut);
                next += static_cast<std::ptrdiff_t>(stage->lut.stages.size());
            } else {
                write(*next++);
            }
        }
    }

    static std::string formula(const std::string& text) {
        if (text.find('\n') == std::string::npos) return quoted(text);
        return "\"\"\"\n" + text + "\n\"\"\"";
    }

    std::string whole(const Expr& e) { return formula(whole_formula(e, {"x"})); }

    /// Several formulas, their temporaries before them.
    std::vector<std::string> formulas(const std::vector<Expr>& exprs,
                                      const std::vector<std::string>& inputs) {
        const FormulaText text = formula_text(exprs, inputs);
        if (!text.temporaries.empty())
            line("temporaries", "\"\"\"\n" + text.temporaries + "\"\"\"");
        std::vector<std::string> result;
        for (const std::string& value : text.values)
            result.push_back(quoted(value));
        return result;
    }

    static std::string three(const std::vector<std::string>& values, std::size_t begin = 0) {
        return "[\n    " + values[begin] + ",\n    " + values[begin + 1] + ",\n    " +
               values[begin + 2] + ",\n]";
    }

    void write_stage(const MatrixStage& s) {
        std::string rows;
        for (const auto& row : s.m)
            rows += "    " + numbers({row[0], row[1], row[2]}) + ",\n";
        line("matrix", "[\n" + rows + "]");
        text_line("name", s.name);
    }
    void write_stage(const CurveStage& s) {
        const bool is_one =
            s.is_uniform() && (!s.inverse || (same((*s.inverse)[0], (*s.inverse)[1]) &&
                                              same((*s.inverse)[1], (*s.inverse)[2])));
        if (is_one) {
            line("curve", whole(s.f[0]));
            if (s.inverse) line("inverse", whole((*s.inverse)[0]));
        } else {
            std::vector<Expr> all(s.f.begin(), s.f.end());
            if (s.inverse) all.insert(all.end(), s.inverse->begin(), s.inverse->end());
            const std::vector<std::string> values = formulas(all, {"x"});
            line("curve", three(values));
            if (s.inverse) line("inverse", three(values, 3));
        }
        text_line("name", s.name);
    }
    void write_stage(const ToneScaleStage& s) {
        line("tone_scale", whole(s.f));
        if (s.norm == ToneScaleStage::Norm::max_rgb) {
            line("norm", quoted("max"));
        } else {
            line("weights", numbers({s.weights[0], s.weights[1], s.weights[2]}));
        }
    }
    void write_stage(const HuePreservingStage& s) { line("hue_preserving", whole(s.f)); }
    void write_stage(const HexconeStage& s) {
        const std::vector<std::string> values = formulas({s.offset, s.value, s.chroma}, {"x"});
        line("hexcone.offset", values[0]);
        line("hexcone.value", values[1]);
        line("hexcone.chroma", values[2]);
    }
    void write_stage(const ClampStage& s) { line("clamp", numbers({s.lo, s.hi})); }
    void write_stage(const CrossTalkStage& s) {
        line("cross_talk", three(formulas({s.f[0], s.f[1], s.f[2]}, {"r", "g", "b"})));
        text_line("name", s.name);
    }
    void write_stage(const GridStage&) { throw Error("it has a 3D table"); }

    const ResolvedOperator& resolved_;
    const Operator& op_;
    const std::vector<std::string> live_;
    const bool is_table_ = is_table_operator(op_);
    std::string text_;
};

}  // namespace

std::string definition_of(const ResolvedOperator& op) {
    try {
        return Writer(op).write();
    } catch (const FileError&) {
        throw;
    } catch (const Error& e) {
        throw Error(op.label + " has no definition in formulas: " + e.text());
    }
}

TONEWRIGHT_NAMESPACE_END
