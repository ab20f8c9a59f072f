// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "image/canvas.h"

TONEWRIGHT_NAMESPACE_BEGIN

/// Draws the chart's small scene into the pixels [x0, x1) x [y0, y1): lit spheres with highlights
/// up to 500, spheres that shine, and their light on the floor. Scene-linear Rec.709.
void draw_spheres(Canvas& canvas, int x0, int y0, int x1, int y1);

/// An evening sky, its sun of 2000 over dark hills. Scene-linear Rec.709.
void draw_sunset(Canvas& canvas, int x0, int y0, int x1, int y1);

TONEWRIGHT_NAMESPACE_END
