// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>

#include "tonewright/version.h"

TONEWRIGHT_NAMESPACE_BEGIN

/// The page as one HTML file: the viewer, and what it shows.
/// @param archive  a ZIP archive with page.json and the files that it names
[[nodiscard]] std::string make_report_page(std::string_view archive);

TONEWRIGHT_NAMESPACE_END
