# SPDX-License-Identifier: Apache-2.0
"""How fast an OpenColorIO is at views of a config, on one thread: for table.py, which runs it with another one's Python.

    $TONEWRIGHT_NEWER_OCIO python3 tests/bench/newer_ocio.py CONFIG VIEW...

Prints JSON: the version, and Mpix/s of every view without loss and by default, each the best of some runs over
3840x2160 RGBA float32 noise between -10 and +6 stops.
"""

import json
import sys
import time

import numpy as np
import PyOpenColorIO as OCIO

WIDTH, HEIGHT, CHANNELS = 3840, 2160, 4
RUNS = 5
FLAGS = {"lossless": OCIO.OPTIMIZATION_LOSSLESS, "default": OCIO.OPTIMIZATION_DEFAULT}


def rate(processor, flags, noise):
    """Mpix/s in place, its fastest way."""
    float32 = OCIO.BIT_DEPTH_F32
    cpu = processor.getOptimizedCPUProcessor(float32, float32, flags)
    best = np.inf
    for _ in range(RUNS):
        pixels = noise.copy()
        start = time.perf_counter()
        cpu.apply(OCIO.PackedImageDesc(pixels, WIDTH, HEIGHT, CHANNELS))
        best = min(best, time.perf_counter() - start)
    return WIDTH * HEIGHT / best / 1e6


def main():
    config = OCIO.Config.CreateFromFile(sys.argv[1])
    noise = np.exp2(np.random.default_rng(1).uniform(-10, 6, (HEIGHT, WIDTH, CHANNELS))).astype(np.float32)
    rates = {}
    for view in sys.argv[2:]:
        transform = OCIO.DisplayViewTransform(src="lin_rec709", display="sRGB", view=view)
        processor = config.getProcessor(transform)
        rates[view] = {name: rate(processor, flags, noise) for name, flags in FLAGS.items()}
    print(json.dumps({"version": OCIO.__version__, "views": rates}))


if __name__ == "__main__":
    main()
