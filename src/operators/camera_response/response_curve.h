// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <memory>
#include <string>
#include <string_view>

#include "tonewright/expr.h"

TONEWRIGHT_NAMESPACE_BEGIN

/// Response of film or a camera to light: normalized irradiance in [0, 1] -> pixel value in [0, 1],
/// rising, with straight lines between the measured points. One curve each for red, green and blue;
/// equal curves share one table.
using ResponseCurves = std::array<std::shared_ptr<const Table>, 3>;

/// Reads response curves from a text file. The contents determine the layout, not the file name:
///
/// * the database of response functions (DoRF): six lines a curve, its name, the kind of graph,
///   `I =`, the irradiances, `B =`, the pixel values. Every channel is a curve of its own;
/// * `.rf`: columns with blanks between, irradiance and one or three pixel values;
/// * CSV: the same with commas, and perhaps a first line of names.
///
/// A line that begins with # is a comment. If neighboring irradiances are equal, the last one
/// counts.
///
/// @param curve  of DoRF: a curve's name, which then serves all channels, or what three names have
///               before Red, Green, Blue (or R, G, B); may be empty when nothing else could be
///               meant. Of four columns: red, green or blue for all channels, empty for each its
///               own.
/// @throws FileError  the file cannot be read or holds no such curves; `<file>:<line>: <reason>;
///                    expected <what>`.
/// @throws Error      the file has no curve of this name, or several and none is named.
[[nodiscard]] ResponseCurves read_response_curves(const std::string& file,
                                                  std::string_view curve = {});

/// Reads the text of a file; messages call the file `file`.
[[nodiscard]] ResponseCurves parse_response_curves(std::string_view text, const std::string& file,
                                                   std::string_view curve = {});

TONEWRIGHT_NAMESPACE_END
