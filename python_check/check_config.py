# SPDX-License-Identifier: Apache-2.0
"""Parity of the OpenColorIO config in the application that runs this: its OpenColorIO against the expected numbers.

Needs PyOpenColorIO and the file probe.csv that lies beside config.ocio; nothing else. On a command line:

    python3 check_config.py [path/to/config.ocio]

without a path: $OCIO, or else the application's current config. Inside Blender, Nuke, Houdini, Maya, ... run the
file from the script editor, or

    import check_config; check_config.main(["path/to/config.ocio"])

Prints one line per display and view: the largest difference of code values between probe.csv, which is the operator
in double precision, and OpenColorIO's CPU path, with the optimizations that applications use and without. Exit
status 1 when a view is beyond its bound, 2 when there is nothing to compare.

The bounds stand in probe.csv: 1e-6 for a view of matrices, limits and tables with an entry for every half float, three
times what was measured when the config was made for the others; in light where the display's curve is infinitely
steep, near black.
"""

import csv
import os
import sys


def read_probes(path):
    """{(display, view, space): [(color, expected, how near), ...]} in the order of the file."""
    probes = {}
    with open(path, newline="") as file:
        for row in csv.DictReader(file):
            key = (row["display"], row["view"], row["space"])
            rgb = [float(row[c]) for c in ("in_r", "in_g", "in_b")]
            out = [float(row[c]) for c in ("out_r", "out_g", "out_b")]
            within = [float(row[c]) for c in ("within_r", "within_g", "within_b")]
            probes.setdefault(key, []).append((rgb, out, within))
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


def worst(processor, probes):
    """(largest error, largest error in terms of its bound) of a CPU processor; NaN is infinitely wrong."""
    largest, times = 0.0, 0.0
    for rgb, expected, within in probes:
        for shown, code, bound in zip(processor.applyRGB(rgb), expected, within):
            error = abs(shown - code)
            if error != error:
                return float("inf"), float("inf")
            largest = max(largest, error)
            times = max(times, error / bound)
    return largest, times


def compare(ocio, config, key, probes):
    """One line of the table, and whether the view is within its bound."""
    display, view, space = key
    line = "{:<12} {:<24} ".format(display, view)
    try:
        processor = config.getProcessor(space, display, view, ocio.TRANSFORM_DIR_FORWARD)
        has_cube = any(isinstance(t, ocio.Lut3DTransform) for t in processor.createGroupTransform())
        default, times = worst(processor.getDefaultCPUProcessor(), probes)
        exact = processor.getOptimizedCPUProcessor(ocio.OPTIMIZATION_LOSSLESS)
        lossless, times_lossless = worst(exact, probes)
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
    print("Largest error of code values, {} colors each; `x bound`: of the error allowed"
          .format(max(len(p) for p in probes.values())))
    print("{:<12} {:<24} {:>8} {:>8} {:>9}  {:<5} {:>5}".format(
        "display", "view", "default", "lossless", "10-bit", "form", "x bound"))
    failed = 0
    for key, colors in probes.items():
        line, ok = compare(ocio, config, key, colors)
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
