// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "tonewright/version.h"

TONEWRIGHT_NAMESPACE_BEGIN

/// The operator catalogue: the index `operators.md`; in `operators/` a page for each operator and
/// one for the dialects; in `curves/` a plot of every operator and of every group of dialects. Both
/// folders have a MANIFEST.csv. The same bytes on every run.
///
/// Removes the pages and plots of operators that are gone.
/// @throws FileError
void write_catalogue(const std::string& folder);

TONEWRIGHT_NAMESPACE_END
