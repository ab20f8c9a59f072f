// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <map>
#include <string>
#include <variant>
#include <vector>

#include "shader/float_form.h"
#include "tonewright/pipeline.h"

TONEWRIGHT_NAMESPACE_BEGIN

/// A function of one number.
struct ScalarFunction {
    std::string name;
    Expr f;  // of input 0
    Interval input = {};
};

/// A function of a color. Inputs 0, 1, 2 are its channels; input 3 + i is the result of calls[i].
struct ColorFunction {
    struct Call {
        std::size_t function;  // index of a scalar function
        Expr argument;         // of inputs 0, 1, 2 and of earlier calls
        std::string result;    // its name
    };
    std::string name;
    std::vector<Call> calls;
    std::array<Expr, 3> f;
};

struct MatrixFunction {
    std::string name;
    Matrix3 m;
};

/// Steps of the function on its color c.
struct ScaleStep {
    double factor;
};
struct MatrixStep {
    std::size_t function;
};
struct ScalarStep {  // each channel alone
    std::size_t function;
};
struct ColorStep {
    std::size_t function;
};
using ProgramStep = std::variant<ScaleStep, MatrixStep, ClampStage, ScalarStep, ColorStep>;

/// A pipeline as float functions that call each other, independent of the language.
struct ShaderProgram {
    std::vector<ScalarFunction> scalars;
    std::vector<ColorFunction> colors;
    std::vector<MatrixFunction> matrices;
    std::vector<ProgramStep> steps;
    /// Names of numbers in texts. The results of the functions do not depend on them.
    std::map<double, std::string> names = {};
};

/// The first step, or the one after the exposure, limits the color to +-kHalfMax, as in every
/// engine.
/// @param uniforms  for every uniform that the pipeline reads
[[nodiscard]] ShaderProgram make_program(const Pipeline& pipeline, const UniformRanges& uniforms);

/// The program as three expressions of the color.
[[nodiscard]] std::array<Expr, 3> compose(const ShaderProgram& program);

TONEWRIGHT_NAMESPACE_END
