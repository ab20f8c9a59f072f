// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "cli/shared_options.h"
#include "tonewright/lut_applications.h"

TONEWRIGHT_NAMESPACE_BEGIN

/// Prints which files of the operator each application can use, with their errors on photographs
/// and the commands that write them, the most exact first.
/// @param host  only this application; null: all
void print_exact_forms(const ViewOptions& options, const LutApplication* host);

TONEWRIGHT_NAMESPACE_END
