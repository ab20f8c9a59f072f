// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "tonewright/generated_files.h"

TONEWRIGHT_NAMESPACE_BEGIN

/// The files of src/tasks/conformance/: runners for engines, and README.md, a template.
[[nodiscard]] const std::vector<GeneratedFile>& conformance_files();

TONEWRIGHT_NAMESPACE_END
