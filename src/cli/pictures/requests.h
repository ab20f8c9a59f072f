// SPDX-License-Identifier: Apache-2.0
//
// Options of the picture commands as requests of the tasks: text becomes numbers here.
#pragma once

#include <string>

#include "cli/picture_options.h"
#include "tasks/pictures/contained.h"
#include "tonewright/meter.h"
#include "tonewright/tonemap.h"

TONEWRIGHT_NAMESPACE_BEGIN

/// Sets the number of threads of OpenImageIO and OpenEXR. With a timeout, does nothing: the
/// processes of the pictures have their own thread pools. @see run_contained
void use_threads(const PictureInput& input);
/// @throws Error  --resize is a size that no picture can have
void check_resize(const char* command, const std::string& resize, const PictureChoice& choice);

/// @throws Error
[[nodiscard]] MeterOptions meter_options_of(const ExposureOptions& options,
                                            const LightOptions& light, const PictureInput& picture);
/// @throws Error
[[nodiscard]] ExposureRule rule_of(const ExposureOptions& options);
/// @throws Error
[[nodiscard]] Adaptation adaptation_of(const ShotOptions& options);

TONEWRIGHT_NAMESPACE_END
