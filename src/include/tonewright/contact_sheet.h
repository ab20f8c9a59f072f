// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <OpenImageIO/imagebuf.h>

#include <array>
#include <string>
#include <utility>
#include <vector>

#include "tonewright/error.h"

TONEWRIGHT_NAMESPACE_BEGIN

/// Texts and patches around the pictures of a contact sheet. Empty parts are left out.
struct SheetAnnotations {
    /// Above the pictures: a heading, and a dimmer remark.
    std::string heading = {};
    std::string remark = {};
    /// Below the pictures: a row of patches (label and sRGB code values) under a heading.
    std::vector<std::pair<std::string, std::array<float, 3>>> legend = {};
    std::string legend_heading = {};
};

/// Pictures side by side in a grid, each with its label below, on dark neutral gray.
///
/// Each picture is scaled into its cell without distortion (its display window and pixel aspect
/// ratio count), in linear light. Rows are as high as their tallest picture.
///
/// @param labeled    label (printable ASCII; other characters show as `?`; cut to the cell's
///                    width; after a line break a second line, smaller and dimmer) and picture in
///                    sRGB code values, any pixel type; gray is shown as gray; alpha is not used:
///                    associated color is shown on black.
/// @param columns     1 or more.
/// @param cell_width  width of a picture in pixels, [16, 16384].
/// @param around      texts and patches around the pictures
/// @returns           uint8 RGB, sRGB.
/// @throws Error      no pictures, or a number out of range, or a picture that cannot be read.
[[nodiscard]] TONEWRIGHT_API OIIO::ImageBuf make_contact_sheet(
    const std::vector<std::pair<std::string, OIIO::ImageBuf>>& labeled, int columns, int cell_width,
    const SheetAnnotations& around = {});

TONEWRIGHT_NAMESPACE_END
