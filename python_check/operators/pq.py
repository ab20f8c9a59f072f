# SPDX-License-Identifier: Apache-2.0
"""The perceptual quantiser of SMPTE ST 2084, on which ICtCp and the EETFs stand."""

import numpy as np

M1, M2 = 2610 / 16384, 2523 / 32
C1, C2, C3 = 107 / 128, 2413 / 128, 2392 / 128
PEAK = 10000.0  # cd/m2 of code value 1


def positive(x):
    """The value where it is above 0, else 0; of a complex one the real part decides.

    >>> positive(np.array([-1.0, 2.0])).tolist()
    [0.0, 2.0]
    """
    return np.where(x.real > 0, x, 0)


def pq_encode(nits):
    """cd/m2 -> code value; below 0 counts as 0, above 10,000 the formula goes on above 1.

    References
    ----------
    SMPTE ST 2084:2014, equations 5.1 and 5.2.

    >>> pq_encode(np.array([0, 100, 203, 1000.0])).round(12).tolist()
    [7.30956e-07, 0.508078421517, 0.580688881042, 0.751827096247]
    """
    y = (positive(nits) / PEAK) ** M1
    return ((C1 + C2 * y) / (1 + C3 * y)) ** M2


def pq_decode(code):
    """Code value -> cd/m2; 0 up to PQ(0) = c1^m2.

    >>> pq_decode(pq_encode(np.array([0.01, 203, 65504.0]))).round(6).tolist()
    [0.01, 203.0, 65504.0]
    """
    p = positive(code) ** (1 / M2)
    return PEAK * (positive(p - C1) / (C2 - C3 * p)) ** (1 / M1)
