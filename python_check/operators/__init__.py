# SPDX-License-Identifier: Apache-2.0
"""The operators and the display side, in NumPy, derived from their publications.

The second opinion on the C++ operators: written from the papers, posts and standards cited in the modules, never
from the C++, in float64 and without any shared code. Names of operators and parameters are those of
`tonewright list`.

An operator takes scene-linear in its working primaries (`WORKING`), ``rgb : (..., 3) array, 1.0 = diffuse white``,
limits it to [0, 65504] first, and returns its own ("native") output: display-linear in the same primaries, or code
values where `CODE_POWER` names it. `view` adds input space, exposure and display.

Each family is a module with the dicts OPERATORS (name -> function), WORKING (name -> primaries, where they are not
Rec.709) and CODE_POWER (name -> power, where it puts out code values); the latter two may be missing.
"""

import numpy as np

from . import (aces, agx, camera_response, eetf, exposure, false_color, filmic, frostbite, gt7, hable, khronos_neutral,
               reinhard, somewhat_boring, statistics, uchimura, unreal)
from .aces import HILL_IN, HILL_OUT, hill_curve
from .agx import AGX_INSET, AGX_LOG2, AGX_LOOKS, agx_shape, agx_sigmoid, cdl
from .base import (HALF_MAX, MANTIUK, REC709_WEIGHTS, REC2020_WEIGHTS, apply_curve, curve_contrast, limit_scene, log1p,
                   luminance, mantiuk_saturation)
from .spaces import (DISPLAYS, INPUTS, PRIMARIES, power_encode, rgb_to_rgb, rgb_to_xyz, sanitise, srgb_encode, xyz)

FAMILIES = (exposure, reinhard, hable, filmic, uchimura, statistics, aces, unreal, agx, khronos_neutral, gt7, frostbite,
            somewhat_boring, eetf, camera_response, false_color)

OPERATORS, CODE_POWER, WORKING = {}, {}, {}
for _family in FAMILIES:
    OPERATORS.update(_family.OPERATORS)
    CODE_POWER.update(getattr(_family, "CODE_POWER", {}))
    WORKING.update(getattr(_family, "WORKING", {}))
WORKING = {name: WORKING.get(name, "rec709") for name in OPERATORS}


def view(operator, rgb, settings=None, look="", exposure=0.0, input="lin_rec709", display="srgb"):
    """What `tonewright eval` prints: input space -> working primaries -> exposure -> operator -> display.

    For a display: code values are decoded, limited to [0, 1] in the working primaries where the display holds them
    whole, converted to the display's primaries, limited to [0, 1] there, and encoded.

    Parameters
    ----------
    operator : key of OPERATORS
    rgb : (..., 3) array, scene-linear in `input`; any float, NaN and infinities included
    settings : dict, parameters of the operator that differ from its defaults
    look : str, look of the operator, or empty
    exposure : stops
    input : key of INPUTS
    display : key of DISPLAYS, or 'native' (the operator's own output), or 'linear' (display-linear Rec.709, unclamped)

    Returns
    -------
    (..., 3) array

    >>> view("agx_sobotka", [0.18, 0.18, 0.18], display="g22").round(4).tolist()
    [0.5, 0.5, 0.5]
    """
    working = WORKING[operator]
    scene = sanitise(rgb) @ rgb_to_rgb(INPUTS[input], working).T * 2.0**exposure
    out = OPERATORS[operator](scene, **(settings or {}), **({"look": look} if look else {}))
    if display == "native":
        return out
    if operator in CODE_POWER:
        out = np.maximum(out, 0) ** CODE_POWER[operator]
    if display == "linear":
        return out @ rgb_to_rgb(working, "rec709").T
    primaries, encode = DISPLAYS[display]
    to_display = rgb_to_rgb(working, primaries)
    if (to_display > -1e-9).all():  # no working colour needs negative light of the display
        out = np.clip(out, 0, 1)
    return encode(np.clip(out @ to_display.T, 0, 1))
