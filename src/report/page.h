// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>

#include "tonewright/version.h"

TONEWRIGHT_NAMESPACE_BEGIN

/// viewer.html, with the places for the data.
extern const char* const kReportViewer;

/// The page as one HTML file: the viewer, and what it shows.
/// @param archive     a ZIP archive: page.json, the files that it names, references.js
/// @param references  the text of references.js. The page's policy lets the viewer and this script
///                    run, and no other.
[[nodiscard]] std::string make_report_page(std::string_view archive, std::string_view references);

TONEWRIGHT_NAMESPACE_END
