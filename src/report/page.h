// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>

#include "tonewright/version.h"

TONEWRIGHT_NAMESPACE_BEGIN

/// The page as one HTML file: the viewer, and what it shows.
/// @param archive     a ZIP archive with page.json, references.js and the files that page.json
/// names
/// @param references  what references.js is: besides the viewer, the page's policy lets only this
///                    script run
[[nodiscard]] std::string make_report_page(std::string_view archive, std::string_view references);

TONEWRIGHT_NAMESPACE_END
