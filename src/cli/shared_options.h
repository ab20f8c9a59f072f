// SPDX-License-Identifier: Apache-2.0
//
// Options that several commands share.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "cli/command.h"
#include "cli/options.h"
#include "cli/picture_options.h"

TONEWRIGHT_NAMESPACE_BEGIN

/// --set, --look.
void add_operator_options(const Command& command, ViewOptions& options);

/// These and --exposure, --input, --display, --input-units, --reference-white.
void add_view_options(const Command& command, ViewOptions& options);

/// --input-units, --reference-white.
void add_input_units(const Command& command, std::string& units, double& reference_white,
                     const char* group);

/// --input-encoding, --lut-space, for a command that has one operator.
/// @param group  the title in the help
void add_lut_input_options(const Command& command, LutOptions& options,
                           const char* group = "LUT as the operator");

/// --lut, --interpolation, --input-encoding, --lut-space, for a command that has an operator and
/// add_view_options().
/// @param op      the option of the operator
/// @param others  options that apply to operators only
void add_lut_options(const Command& command, LutOptions& options, const Option& op,
                     const std::vector<std::string>& others);

/// --max-pixels.
Option add_max_pixels(const Command& command, std::optional<double>& value);

/// --resize.
void add_resize(const Command& command, std::string& resize, const char* group);
/// --layer, --subimage, --max-pixels.
void add_picture_choice(const Command& command, PictureChoice& choice, const char* group);
/// --layer, --max-pixels, --subimage, --threads, --timeout, --unpremult, --no-unpremult.
void add_picture_input(const Command& command, PictureInput& options);

/// Adds --delta, --percentiles, --key, ... and --meter-region.
/// @param method  the option of the metering method, which they need; null: they need none
void add_exposure_options(const Command& command, ExposureOptions& options, const Option* method);

/// --adapt, --fps, ..., --meter-frames, --meter-cache.
/// @param method  what --adapt needs; null: nothing
void add_shot_options(const Command& command, ShotOptions& options, const Option& frames,
                      const Option* method);

TONEWRIGHT_NAMESPACE_END
