# SPDX-License-Identifier: Apache-2.0
"""Sanitizers take addresses, memory and time, so their builds are not held to limits of these."""

import subprocess


def is_sanitized(program):
    libraries = subprocess.run(["ldd", program], capture_output=True, text=True, check=False).stdout
    return "libasan" in libraries or "libtsan" in libraries
