// SPDX-License-Identifier: Apache-2.0
//
// Options that several commands share, under the title that Command::title() has set unless a
// function has titles of its own.
#pragma once

#include <string>
#include <vector>

#include "cli/command.h"
#include "cli/options.h"
#include "cli/picture_options.h"

TONEWRIGHT_NAMESPACE_BEGIN

/// OPERATOR, of any kind.
void add_operator_argument(const Command& command, std::string& op, bool is_required = false);

/// --set, --look, under a title of their own.
void add_operator_options(const Command& command, ViewOptions& options);

/// These and --exposure, --input, --display, --input-units, --reference-white, under titles of
/// their own.
void add_view_options(const Command& command, ViewOptions& options,
                      const char* exposure_title = "Operator");

/// --input-units, --reference-white.
void add_input_units(const Command& command, std::string& units, double& reference_white);

/// --input and these, for pictures.
void add_light_options(const Command& command, LightOptions& options);

/// --input-encoding, --lut-space, for a command that has one operator.
void add_lut_input_options(const Command& command, LutOptions& options);

/// --lut, --interpolation, --input-encoding, --lut-space, under a title of their own, for a command
/// that has an operator and add_view_options().
/// @param others  the operator and the options that apply to operators only
void add_lut_options(const Command& command, LutOptions& options,
                     const std::vector<std::string>& others);

/// --progress, under a title of its own. @see progress.h
void add_progress(const Command& command);
/// --resize.
void add_resize(const Command& command, std::string& resize);
/// --layer, --subimage, --max-pixels.
void add_picture_choice(const Command& command, PictureChoice& choice);
/// --layer, --max-pixels, --subimage, --threads, --timeout, --unpremult, --no-unpremult, under a
/// title of their own.
void add_picture_input(const Command& command, PictureInput& options);

/// Adds --delta, --percentiles, --key, ... and --meter-region, under titles of their own.
/// @param needs  what all of them need
void add_exposure_options(const Command& command, ExposureOptions& options,
                          const std::vector<std::string>& needs = {});

/// --adapt, --fps, ..., --meter-frames, --meter-cache, under a title of their own.
/// @param needs  what --adapt needs, besides --frames
void add_shot_options(const Command& command, ShotOptions& options,
                      std::vector<std::string> needs = {});

TONEWRIGHT_NAMESPACE_END
