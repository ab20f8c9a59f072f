// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "lut/formats/cube_text.h"

TONEWRIGHT_NAMESPACE_BEGIN

class TextLines;

// One function for each format; each throws a FileError with path, line and reason.

[[nodiscard]] CubeText read_cube(TextLines& text);
[[nodiscard]] CubeText read_dat(TextLines& text);
[[nodiscard]] CubeText read_pandora(TextLines& text);
[[nodiscard]] CubeText read_look(TextLines& text);

void check_itx(TextLines& text);
void check_spi1d(TextLines& text);
void check_spi3d(TextLines& text);
void check_spimtx(TextLines& text);
void check_csp(TextLines& text);
void check_3dl(TextLines& text);
/// Houdini's .lut, and Discreet's 1D tables with the same extension.
void check_lut(TextLines& text);
void check_discreet_tables(TextLines& text);
void check_cub(TextLines& text);
void check_vf(TextLines& text);
// XML: it is well-formed, and arrays have their declared size. OpenColorIO reports the other
// errors.
void check_clf(TextLines& text);
void check_cc(TextLines& text);

TONEWRIGHT_NAMESPACE_END
