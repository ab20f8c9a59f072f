# SPDX-License-Identifier: Apache-2.0
"""Runs DCTL as OpenCL on pocl, with the words of DCTL defined."""
import os
import tempfile

import numpy as np

try:
    import pyopencl
except ImportError:
    pyopencl = None

from executed import skip

CACHE = tempfile.TemporaryDirectory()  # else pocl, which reads the variable once, fills the user's cache
os.environ["POCL_CACHE_DIR"] = CACHE.name
# The flags that Resolve gives its OpenCL compiler.
RESOLVE = ("-cl-mad-enable", "-cl-fast-relaxed-math")
# A slider stands where SLIDER says.
WORDS = """
#define __DEVICE__ static inline
#define __CONSTANT__ __constant
#define DEFINE_UI_PARAMS(name, label, kind, value, min, max, step) __constant float name = SLIDER;
#define make_float3(x, y, z) ((float3)(x, y, z))
#define _powf pow
#define _log2f log2
#define _exp2f exp2
#define _fmaxf fmax
#define _fminf fmin
#define _fabs fabs
#define _sqrtf sqrt
#define _sinf sin
#define _cosf cos
#define _atan2f atan2
#define _floor floor
"""
KERNEL = """
kernel void run_{name}(global const float* a, global float* b) {{
    size_t i = 3 * get_global_id(0);
    float3 c = {call};
    b[i] = c.x; b[i + 1] = c.y; b[i + 2] = c.z;
}}
"""


def device():
    """pocl's. Skips the test where it is missing."""
    if not pyopencl:
        skip("pyopencl is missing (Debian: python3-pyopencl)")
    try:
        platforms = [p for p in pyopencl.get_platforms() if p.name == "Portable Computing Language"]
    except pyopencl.LogicError:  # no platform at all
        platforms = []
    if not platforms:
        skip("pocl is missing (Debian: pocl-opencl-icd)")
    return platforms[0].get_devices()[0]


class OpenCl:
    """Functions of DCTL, compiled."""

    def __init__(self, texts: dict, calls: dict, flags: tuple = RESOLVE):
        """texts: name -> DCTL. calls: name -> expression of `a` and `i`, where the color is."""
        self.context = pyopencl.Context([device()])
        self.queue = pyopencl.CommandQueue(self.context)
        source = WORDS + "".join(text + KERNEL.format(name=name, call=calls[name]) for name, text in texts.items())
        self.program = pyopencl.Program(self.context, source).build([*flags, "-cl-std=CL1.2"])

    def run(self, name: str, rgb: np.ndarray) -> np.ndarray:
        shown = np.empty_like(rgb)
        flags = pyopencl.mem_flags
        colors = pyopencl.Buffer(self.context, flags.READ_ONLY | flags.COPY_HOST_PTR, hostbuf=rgb)
        results = pyopencl.Buffer(self.context, flags.WRITE_ONLY, rgb.nbytes)
        getattr(self.program, f"run_{name}")(self.queue, (len(rgb),), None, colors, results)
        pyopencl.enqueue_copy(self.queue, shown, results)
        return shown
