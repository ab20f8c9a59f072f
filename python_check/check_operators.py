# SPDX-License-Identifier: Apache-2.0
"""Compares `tonewright eval` with operators.py: every operator, settings, looks, inputs, displays, exposures.

    python3 check_operators.py build/release/bin/tonewright

Prints one line per run; exits 1 when a colour is outside the tolerance. The last line is `N passed, M failed`.
"""

import subprocess
import sys

import numpy as np

import operators

# `eval` prints 9 significant digits: up to 5e-9 of the value. 1e-9 more for double arithmetic in another order.
RELATIVE = 6e-9
# Where the result is a difference (Hable's E/F, saturation, S(0)), 1e-16 of the terms is left beside 0, and the
# looks' power of 0.8 raises that to 2e-13.
ABSOLUTE = 1e-12
# Pure-power displays have an infinite slope at black: 1e-16 of light is 2e-7 in code for a 2.4 power.
ABSOLUTE_POWER = 3e-7
POWER_DISPLAYS = ("rec1886", "g22", "rec2020")

HABLE_GDC = {"shoulder_strength": 0.22, "linear_strength": 0.3, "toe_numerator": 0.01}
HABLE_ALL = {"shoulder_strength": 0.3, "linear_strength": 0.4, "linear_angle": 0.2, "toe_strength": 0.25,
             "toe_numerator": 0.015, "toe_denominator": 0.4, "white": 6, "exposure_bias": 1.5}
UCHIMURA_ALL = {"max_brightness": 4, "contrast": 1.2, "linear_start": 0.3, "linear_length": 0.5,
                "black_tightness": 2, "pedestal": 0.02}
APPLY = ("channels", "luminance", "max")
# Operator -> sets of settings; "look" among them is the look.
SETTINGS = {
    "clamp": [{}],
    "reinhard": [{}, *({"apply": a} for a in APPLY)],
    "reinhard_extended": [{}, *({"white": w, "apply": a} for w in (1.5, 16) for a in APPLY)],
    "reinhard_jodie": [{}],
    "hable": [{}, HABLE_GDC, HABLE_ALL, {"white": 4}, {"exposure_bias": 1}],
    "uchimura": [{}, {"max_brightness": 10}, {"contrast": 0.8}, {"black_tightness": 1}, {"pedestal": 0.05},
                 UCHIMURA_ALL],
    "aces_narkowicz": [{}, {"prescale": 0.6}, {"prescale": 1.8}],
    "aces_hill": [{}],
    "agx_sobotka": [{}, {"look": "golden"}, {"look": "punchy"}],
    "agx_minimal": [{}, {"order": 6}, {"order": 7}],
}


def probes():
    """Colours as (n, 3): greys, hues, out of gamut, beyond every limit, random."""
    grey = 0.18 * 2.0 ** np.arange(-12, 12.01, 0.5)
    hues = [(1, 0, 0), (0, 1, 0), (0, 0, 1), (1, 1, 0), (0, 1, 1), (1, 0, 1), (0.8, 0.1, 0.05), (0.05, 0.1, 2)]
    limits = [0.0, -0.0, 1e-310, 1e-10, -0.1, -5.0, 1.0, 4.0, 11.2, 65504.0, 70000.0, 1e30, np.inf, -np.inf, np.nan]
    rng = np.random.default_rng(20240229)
    scene = 0.18 * 2.0 ** rng.uniform(-12, 12, (300, 3))
    signs = np.where(rng.random((100, 3)) < 0.4, -1, 1)
    return np.concatenate([
        np.repeat(grey[:, None], 3, axis=1),
        *(np.array(hues) * gain for gain in (0.01, 0.18, 1, 8, 1000)),
        np.repeat(np.array(limits)[:, None], 3, axis=1),
        np.stack([limits, np.roll(limits, 5), np.roll(limits, 7)], axis=1),
        scene,
        signs * 0.18 * 2.0 ** rng.uniform(-6, 6, (100, 3)),
    ])


def runs():
    """Keyword arguments of operators.view for every run."""
    for operator, sets in SETTINGS.items():
        for settings in sets:
            view = {"operator": operator, "settings": {k: v for k, v in settings.items() if k != "look"},
                    "look": settings.get("look", "")}
            for display in ("native", "linear", "srgb"):
                yield {**view, "display": display}
        for display in operators.DISPLAYS:
            yield {"operator": operator, "display": display, "exposure": -1.5}
        for space in operators.INPUTS:
            yield {"operator": operator, "input": space, "display": "linear", "exposure": 2}


def command(binary, view):
    """`tonewright eval` for a run; also the text that names the run."""
    options = [f"--set={name}={value}" for name, value in view.get("settings", {}).items()]
    options += [f"--{name}={view[name]}" for name in ("look", "exposure", "input", "display") if view.get(name)]
    return [binary, "eval", view["operator"], "--engine=reference", *options], " ".join(options).replace("--", "")


def evaluate(arguments, rgb):
    """Colours through the program; raises ValueError when it does not answer with as many."""
    text = "".join(f"{r!r} {g!r} {b!r}\n" for r, g, b in rgb.tolist())
    result = subprocess.run(arguments, input=text, capture_output=True, text=True, check=False)
    if result.returncode:
        raise ValueError(f"exit {result.returncode}: {result.stderr.strip()}")
    out = np.array([line.split() for line in result.stdout.splitlines()], float)
    if out.shape != rgb.shape:
        raise ValueError(f"printed {out.shape}, expected {rgb.shape}")
    return out


def compare(binary, view, rgb):
    """One line of the table and whether the run passed."""
    arguments, label = command(binary, view)
    expected = operators.view(rgb=rgb, **view)
    line = f"{view['operator']:18s} {label[:88]:88s} {len(rgb):5d}"
    try:
        actual = evaluate(arguments, rgb)
    except ValueError as error:
        return f"{line}  FAIL {error}", False
    floor = ABSOLUTE_POWER if view["display"] in POWER_DISPLAYS else ABSOLUTE
    error = np.abs(actual - expected)
    ratio = error / (RELATIVE * np.abs(expected) + floor)
    ok = bool((ratio <= 1).all())  # NaN fails
    line = f"{line} {error.max():9.2e} {ratio.max():9.3g}  {'ok' if ok else 'FAIL'}"
    if not ok:
        i = np.unravel_index(np.argmax(np.where(np.isnan(ratio), np.inf, ratio)), ratio.shape)[0]
        line += f"\n  in {rgb[i].tolist()}: is {actual[i].tolist()}, expected {expected[i].tolist()}"
    return line, ok


def main(arguments):
    if len(arguments) != 1:
        print("usage: check_operators.py TONEWRIGHT", file=sys.stderr)
        return 2
    rgb = probes()
    print(f"{'operator':18s} {'settings':88s} {'N':>5s} {'max error':>9s} {'x toler.':>9s}")
    results = []
    for view in runs():
        line, ok = compare(arguments[0], view, rgb)
        print(line)
        results.append(ok)
    print(f"{sum(results)} passed, {len(results) - sum(results)} failed")
    return 0 if all(results) else 1


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
