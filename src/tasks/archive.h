// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "tonewright/generated_files.h"

TONEWRIGHT_NAMESPACE_BEGIN

/// The bytes of a ZIP archive of the files. With a config.ocio and its tables, OpenColorIO 2.2 and
/// newer read it as an .ocioz. The same files give the same bytes.
[[nodiscard]] std::string make_archive(const std::vector<GeneratedFile>& files);

TONEWRIGHT_NAMESPACE_END
