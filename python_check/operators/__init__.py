# SPDX-License-Identifier: Apache-2.0
"""The operators and the display side, in NumPy, derived from their publications.

The second opinion on the C++ operators: written from the papers, posts and standards cited in the modules, never
from the C++, in float64 and without any shared code. Names of operators and parameters are those of
`tonewright list`.

An operator takes scene-linear in its working primaries (`WORKING`), ``rgb : (..., 3) array, 1.0 = diffuse white``,
limits it to [0, 65504] first, and returns its own ("native") output: display-linear in the same primaries, or code
values where `CODE_POWER` names it. `view` adds input space, exposure and display.

Each family is a module with the dict OPERATORS (name -> function), and where they are needed

* WORKING: name -> primaries, where they are not Rec.709;
* CODE_POWER: name -> power, where it puts out code values;
* DECODE: name -> function of the settings, which gives the function code -> light; instead of that power;
* OUTPUT_PRIMARIES: name -> function of the settings, where it puts out other primaries than the working ones;
* PEAK: name -> function of the settings, the largest light that it puts out for HDR displays, where that is not 1;
* FROM_DISPLAY: name -> setting -> function of a `spaces.Display`, what a display decides where the user has not.
"""

import numpy as np

from . import (aces, aces_13, aces_20, agx, agx_blender, camera_response, defects, eetf, engine_curves, exposure,
               false_color, ffmpeg, filmic, frostbite, gt7, hable, khronos_neutral, reinhard, somewhat_boring, statistics,
               uchimura, unreal)
from .aces import HILL_IN, HILL_OUT, hill_curve
from .agx import AGX_INSET, AGX_LOG2, AGX_LOOKS, agx_shape, agx_sigmoid, cdl
from .base import (HALF_MAX, MANTIUK, REC709_WEIGHTS, REC2020_WEIGHTS, apply_curve, curve_contrast, limit_scene, log1p,
                   luminance, mantiuk_saturation)
from .spaces import (DISPLAYS, INPUTS, PRIMARIES, UNIT, power_encode, rgb_to_rgb, rgb_to_xyz, sanitize, srgb_encode,
                     xyz)

FAMILIES = (exposure, reinhard, hable, filmic, uchimura, statistics, ffmpeg, engine_curves, aces, aces_13, aces_20,
            unreal, agx, agx_blender, khronos_neutral, gt7, frostbite, somewhat_boring, eetf, camera_response, false_color, defects)

OPERATORS, CODE_POWER, DECODE, WORKING, OUTPUT_PRIMARIES, PEAK, FROM_DISPLAY = ({
    name: value for family in FAMILIES for name, value in getattr(family, kind, {}).items()
} for kind in ("OPERATORS", "CODE_POWER", "DECODE", "WORKING", "OUTPUT_PRIMARIES", "PEAK", "FROM_DISPLAY"))
# No name of the command line finds them.
DEFECTS = tuple(defects.OPERATORS)
WORKING = {name: WORKING.get(name, "rec709") for name in OPERATORS}


def view(operator, rgb, settings=None, look="", exposure=0.0, input="lin_rec709", display="srgb",
         reference_white=UNIT):
    """The numbers of `tonewright eval`: input space -> working primaries -> exposure -> operator -> display.

    For a display: settings that it decides are decided; code values are decoded; light is limited to [0, white] in its
    own primaries where the display holds them whole, converted to the display's primaries, limited to [0, white] there,
    and encoded. For an HDR display the limit is the peak of the operator instead of white, or that of the display where
    this is less, and 1 is shown at the reference white.

    Parameters
    ----------
    operator : key of OPERATORS
    rgb : (..., 3) array, scene-linear in `input`; any float, NaN and infinities included
    settings : dict, parameters of the operator that differ from its defaults
    look : str, look of the operator, or empty
    exposure : stops
    input : key of INPUTS
    display : key of DISPLAYS, or 'native' (the operator's own output), or 'linear' (display-linear Rec.709, unclamped)
    reference_white : cd/m2 of light 1 on an HDR display

    Returns
    -------
    (..., 3) array

    >>> view("agx_sobotka", [0.18, 0.18, 0.18], display="g22").round(4).tolist()
    [0.5, 0.5, 0.5]
    >>> view("clamp", [4.0, 4.0, 4.0], display="rec2100_pq", reference_white=203).round(9).tolist()
    [0.580688881, 0.580688881, 0.580688881]
    """
    settings = dict(settings or {})
    if display in DISPLAYS:
        shown_on = DISPLAYS[display]
        facts = shown_on._replace(peak=shown_on.peak * UNIT / reference_white) if shown_on.is_hdr else shown_on
        settings = {**{name: decide(facts) for name, decide in FROM_DISPLAY.get(operator, {}).items()}, **settings}
    working = WORKING[operator]
    # A sun of 300,000 at -17 stops keeps its color: the limit comes after the exposure.
    scene = sanitize(np.asarray(rgb, float) * 2.0**exposure) @ rgb_to_rgb(INPUTS[input], working).T
    out = OPERATORS[operator](scene, **settings, **({"look": look} if look else {}))
    if display == "native":
        return out
    if operator in DECODE:
        out = DECODE[operator](**settings)(np.maximum(out, 0))
    elif operator in CODE_POWER:
        out = np.maximum(out, 0) ** CODE_POWER[operator]
    primaries = OUTPUT_PRIMARIES[operator](**settings) if operator in OUTPUT_PRIMARIES else working
    if display == "linear":
        return out @ rgb_to_rgb(primaries, "rec709").T
    peak = min(PEAK[operator](**settings) if operator in PEAK else 1.0, shown_on.largest)
    to_display = rgb_to_rgb(primaries, shown_on.primaries)
    if (to_display > -1e-9).all():  # none of its colors needs negative light of the display
        out = np.clip(out, 0, peak)
    out = np.clip(out @ to_display.T, 0, peak)
    if shown_on.is_hdr:
        out = np.minimum(out * reference_white / UNIT, shown_on.largest)
    return shown_on.encode(out)
