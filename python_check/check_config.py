# SPDX-License-Identifier: Apache-2.0
"""Parity of the OpenColorIO config in the application that runs this: its OpenColorIO against the expected numbers.

Needs PyOpenColorIO and the file probe.csv that lies beside config.ocio; nothing else. On a command line:

    python3 check_config.py [path/to/config.ocio]

without a path: $OCIO, or else the application's current config. Inside Blender, Nuke, Houdini, Maya, ... run the
file from the script editor, or

    import check_config; check_config.main(["path/to/config.ocio"])

Prints one line per display and view: the largest difference of code values between probe.csv, which is the operator
in double precision, and OpenColorIO's CPU path, with the optimisations that applications use and without. Exit
status 1 when a view is beyond its bound, 2 when there is nothing to compare.
"""

import csv
import os
import sys

# Bounds, code values (1 = full scale):
#
# A view without a cube is matrices, limits and tables with an entry for every half float. Debian's OpenColorIO 2.1
# is within 3e-7; other versions and processors round in another order and get the rest.
EXACT = 1e-6
# The 65^3 cubes are made to hold one code of 10 bits on the sRGB curve.
CUBE = 1.0 / 1023
# Displays whose curve is a straight line at black. The others are powers, infinitely steep there: below code 0.1 what
# is left of float32 and of half floats near 0 shows as up to 1.3e-5, and cubes, whose nodes are sRGB codes, err up to
# twice as much as on the sRGB curve.
LINEAR_AT_BLACK = ("sRGB", "Display P3")
NEAR_BLACK = 0.1
EXACT_NEAR_BLACK = 2e-5
CUBE_NEAR_BLACK = 2 * CUBE
# With a negative channel, matrices subtract numbers of the size of the brightest channel, in float32: errors are
# counted relative to that, where it exceeds 1.


def tolerance(expected, rgb, display, has_cube):
    """Bound for one channel of one colour."""
    if display not in LINEAR_AT_BLACK and expected < NEAR_BLACK:
        bound = CUBE_NEAR_BLACK if has_cube else EXACT_NEAR_BLACK
    else:
        bound = CUBE if has_cube else EXACT
    if min(rgb) < 0:
        bound *= max(1.0, max(abs(v) for v in rgb))
    return bound


def read_probes(path):
    """{(display, view, space): [(colour, expected), ...]} in the order of the file."""
    probes = {}
    with open(path, newline="") as file:
        for row in csv.DictReader(file):
            key = (row["display"], row["view"], row["space"])
            rgb = [float(row[c]) for c in ("in_r", "in_g", "in_b")]
            out = [float(row[c]) for c in ("out_r", "out_g", "out_b")]
            probes.setdefault(key, []).append((rgb, out))
    return probes


def find_config(ocio, path):
    """(config, its folder); raises ValueError when there is none."""
    path = path or os.environ.get("OCIO", "")
    if path:
        if not os.path.isfile(path):
            raise ValueError("config is " + path + "; expected the path of a config.ocio")
        return ocio.Config.CreateFromFile(path), os.path.dirname(os.path.abspath(path))
    config = ocio.GetCurrentConfig()
    folder = config.getWorkingDir()
    if not folder:
        raise ValueError("config is not given; expected a path, or $OCIO, or an application that has loaded one")
    return config, folder


def worst(processor, probes, display, has_cube):
    """(largest error, largest error in terms of its tolerance) of a CPU processor; NaN is infinitely wrong."""
    largest, times = 0.0, 0.0
    for rgb, expected in probes:
        for shown, code in zip(processor.applyRGB(rgb), expected):
            error = abs(shown - code)
            if error != error:
                return float("inf"), float("inf")
            largest = max(largest, error)
            times = max(times, error / tolerance(code, rgb, display, has_cube))
    return largest, times


def compare(ocio, config, key, probes):
    """One line of the table, and whether the view is within its bound."""
    display, view, space = key
    line = "{:<12} {:<24} ".format(display, view)
    try:
        processor = config.getProcessor(space, display, view, ocio.TRANSFORM_DIR_FORWARD)
        has_cube = any(isinstance(t, ocio.Lut3DTransform) for t in processor.createGroupTransform())
        default, times = worst(processor.getDefaultCPUProcessor(), probes, display, has_cube)
        exact = processor.getOptimizedCPUProcessor(ocio.OPTIMIZATION_LOSSLESS)
        lossless, times_lossless = worst(exact, probes, display, has_cube)
    except ocio.Exception as error:
        return line + "FAILED: " + str(error).splitlines()[0], False
    times = max(times, times_lossless)
    ok = times <= 1
    return line + "{:8.1e} {:8.1e} {:9.4f}  {:<5} {:5.2f} {}".format(
        default, lossless, max(default, lossless) * 1023, "cube" if has_cube else "exact", times,
        "ok" if ok else "FAILED"), ok


def main(arguments=()):
    """Prints the table; returns 0 (every view within its bound), 1, or 2 (nothing to compare)."""
    if len(arguments) > 1:
        print("usage: check_config.py [path/to/config.ocio]")
        return 2
    try:
        import PyOpenColorIO as ocio
    except ImportError as error:
        print("check_config: PyOpenColorIO is missing here: " + str(error))
        return 2
    try:
        config, folder = find_config(ocio, arguments[0] if arguments else "")
        path = os.path.join(folder, "probe.csv")
        if not os.path.isfile(path):
            raise ValueError("config in " + folder + " has no probe.csv beside it; expected a config of Tonewright")
        probes = read_probes(path)
    except (ValueError, KeyError, OSError, ocio.Exception) as error:
        print("check_config: " + str(error).splitlines()[0])
        return 2
    if not probes:
        print("check_config: " + path + " is empty")
        return 2
    print("OpenColorIO {}, config {}".format(ocio.GetVersion(), config.getName() or folder))
    print("Largest error of code values, {} colours each; `x bound`: of the error allowed, see the top of this file"
          .format(max(len(p) for p in probes.values())))
    print("{:<12} {:<24} {:>8} {:>8} {:>9}  {:<5} {:>5}".format(
        "display", "view", "default", "lossless", "10-bit", "form", "x bound"))
    failed = 0
    for key, colours in probes.items():
        line, ok = compare(ocio, config, key, colours)
        failed += not ok
        print(line)
    print("{} passed, {} failed".format(len(probes) - failed, failed))
    return 1 if failed else 0


def is_program():
    """True when Python was started for this file. Elsewhere sys.argv is the application's, and exit would end it."""
    name = (getattr(sys, "argv", None) or [""])[0]
    return os.path.basename(name) == "check_config.py"


if __name__ == "__main__":
    if is_program():
        sys.exit(main(sys.argv[1:]))
    main()
