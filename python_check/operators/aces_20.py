# SPDX-License-Identifier: Apache-2.0
"""The output transform of ACES 2.0 for any peak and limiting primaries, and its inverse.

Everything between scene and display happens in J, M, h of a simplified color appearance model in which every space's
white is fully adapted to: `Model` is that model for one set of primaries, `Transform` the tables and the steps for one
display. Tables have 360 entries, and the tolerances of their searches are part of the definition.

References
----------
Academy of Motion Picture Arts and Sciences, ACES 2: aces-core, Lib.Academy.OutputTransform and Lib.Academy.Tonescale,
as OpenColorIO 2.4.2 and later have them (ops/fixedfunction/ACES2; 2.4.0, 2.4.1 and early aces-core raise the logarithm
of the focus gain to 1/0.55 instead of 2). The model: L. Hellwig, M. D. Fairchild, "Brightness, lightness,
colorfulness, and chroma in CIECAM02 and CAM16", Color Research and Application 47, 2022.
"""

from functools import lru_cache

import numpy as np

from .spaces import PRIMARIES, chromaticities, rgb_to_rgb, sanitize, xyz

# The model's constants: adapting luminance 100, background 20, surround c = 0.59, N_c = 0.9.
CZ = 0.59 * (1.48 + np.sqrt(0.2))
ICZ = 1 / CZ
K4 = (1 / 501) ** 4
F_L = 0.2 * K4 * 500 + 0.1 * (1 - K4) ** 2 * 500 ** (1 / 3)
CAM16 = ((0.8336, 0.1735), (2.3854, -1.4659), (0.087, -0.125), (0.333, 0.333))
CORNERS = np.array([[1, 0, 0], [1, 1, 0], [0, 1, 0], [0, 1, 1], [0, 0, 1], [1, 0, 1]], float)  # R Y G C B M
SIZE = 360


def xy_to_xyz(primaries):
    """Matrix of linear RGB to CIE XYZ with Y = 1 at white, from xy of red, green, blue, white."""
    columns = np.stack([xyz(p) for p in primaries[:3]], axis=-1)
    return columns * np.linalg.solve(columns, xyz(primaries[3]))


M16 = np.linalg.inv(xy_to_xyz(CAM16))


def phi(x):
    """Cone response, compressed; odd.

    >>> float(phi(np.array(F_L)).round(17))
    0.03236802625138552
    """
    y = np.abs(x) ** 0.42
    return np.sign(x) * y / (27.13 + y)


def phi_inverse(x):
    """Its inverse up to 0.99, and what that gives beyond.

    >>> float(phi_inverse(phi(np.array(-3.0))).round(12))
    -3.0
    """
    y = np.minimum(np.abs(x), 0.99)
    return np.sign(x) * (27.13 * y / (1 - y)) ** (1 / 0.42)


A_W = phi(F_L)  # the achromatic response to white, before it is scaled to 1
AAB = np.array([[2, 1, 1 / 20], [1, -12 / 11, 1 / 11], [1 / 9, 1 / 9, -2 / 9]])
AAB *= np.array([[400 / (400 * 3.05 * A_W)], [400 * 43 * 0.9], [400 * 43 * 0.9]])
AAB_INVERSE = np.linalg.inv(AAB)


def j_of_a(a):
    return 100 * a**CZ


def a_of_j(j):
    return (j / 100) ** ICZ


def luminance_of_a(a):
    """cd/m2 of an achromatic response >= 0."""
    return phi_inverse(A_W * a) * 100 / F_L


def j_of_luminance(y):
    """J of cd/m2 >= 0.

    >>> float(j_of_luminance(np.array(100.0)).round(12))
    100.0
    """
    return j_of_a(phi(y * F_L / 100) / A_W)


class Model:
    """RGB of some primaries <-> A, a, b and J, M, h (degrees).

    >>> Model(PRIMARIES["ap0"]).jmh(np.array([4, 0.5, 0.1])).round(7).tolist()
    [132.6020332, 209.4532799, 23.0899941]
    """

    def __init__(self, primaries):
        to_cone = M16 @ xy_to_xyz(primaries)
        self.to_cone = to_cone * (F_L / to_cone.sum(-1, keepdims=True))
        self.from_cone = np.linalg.inv(self.to_cone)

    def aab(self, rgb):
        return phi(rgb @ self.to_cone.T) @ AAB.T

    def jmh(self, rgb):
        a, r, s = np.moveaxis(self.aab(rgb), -1, 0)
        lit = a > 0
        h = np.degrees(np.arctan2(s, r))
        jmh = np.stack([j_of_a(np.where(lit, a, 0)), np.hypot(r, s), np.where(h < 0, h + 360, h)], axis=-1)
        return np.where(lit[..., None], jmh, 0.0)

    def rgb(self, jmh):
        j, m, h = np.moveaxis(jmh, -1, 0)
        h = np.radians(h)
        aab = np.stack([a_of_j(np.maximum(j, 0)), m * np.cos(h), m * np.sin(h)], axis=-1)
        return phi_inverse(aab @ AAB_INVERSE.T) @ self.from_cone.T


AP0, AP1 = Model(PRIMARIES["ap0"]), Model(PRIMARIES["ap1"])


def bisect(lo, hi, goes_up, tolerance):
    """Halve [lo, hi] (arrays of one length) until `tolerance`; `goes_up(middle)` says where lo moves. Returns both."""
    while np.max(hi - lo) > tolerance:
        middle = (lo + hi) / 2
        up = goes_up(middle)
        lo, hi = np.where(up, middle, lo), np.where(up, hi, middle)
    return lo, hi


def toe(x, limit, slope, knee):
    """Compresses [0, limit] towards 0 and leaves what is above."""
    knee = np.maximum(knee, 0.001)
    slope = np.sqrt(slope * slope + knee * knee)
    scale = (limit + slope) / (limit + knee)
    p = scale * x - slope
    return np.where(x > limit, x, (p + np.sqrt(np.maximum(p * p + 4 * knee * scale * x, 0))) / 2)


def toe_inverse(x, limit, slope, knee):
    """Inverse of toe; the forward goes down to -knee only, so what is below that is taken as there.

    >>> float(toe_inverse(toe(0.2, 1.0, 2.0, 0.3), 1.0, 2.0, 0.3).round(12))
    0.2
    """
    knee = np.maximum(knee, 0.001)
    slope = np.sqrt(slope * slope + knee * knee)
    scale = (limit + slope) / (limit + knee)
    return np.where(x > limit, x, x * (x + slope) / (scale * np.where(x > limit, 1, np.maximum(x + knee, 1e-9))))


def chroma_norm(h):
    """The hue-dependent part of the chroma norm; `h` in degrees."""
    h = np.radians(h)
    return (11.34072 * np.cos(h) + 16.46899 * np.cos(2 * h) + 7.88380 * np.cos(3 * h) + 14.66441 * np.sin(h)
            - 6.37224 * np.sin(2 * h) + 9.19364 * np.sin(3 * h) + 77.12896)


class Transform:
    """Constants and tables for a peak in cd/m2 and limiting primaries (xy of red, green, blue, white)."""

    def __init__(self, peak, primaries):
        self.peak = n = float(peak)
        self.limiting = Model(primaries)
        lp = np.log10(n / 100)
        self.r = 128 + 768 * np.log(n / 100) / np.log(100)
        self.clamp = 8 * self.r
        self.tone_constants(n)
        self.jmax = float(j_of_luminance(n))
        self.jmid = float(j_of_luminance(100 * self.ct))
        self.compression = 2.4 + 7.92 * lp
        self.saturation = max(0.2, 1.3 - 0.897 * lp)
        self.threshold = 0.5 / n
        self.chroma_scale = (0.03379 * n) ** 0.30596 - 0.45135
        self.focus = self.jmax * (1.35 + 2.3625 * lp)
        self.lower_power = 1 / (1.14 + 0.07 * lp)
        self.reach_table = self.make_reach()
        self.corners = self.display_corners()
        self.hues, self.counts = self.make_hues()
        self.cusps = self.make_cusps()
        self.inverse_gammas = 1 / self.make_gammas()

    # -- tone scale

    def tone_constants(self, n):
        self.t1, self.g = 0.04, 1.15
        m0 = n / 100
        m1 = self.flare_inverse(m0)
        q = self.r / m1
        m = m1 / (q / (q + 1)) ** self.g
        self.ct = 0.10013 * (1 + 0.14 * np.log2(n / 100))
        k = (self.flare_inverse(self.ct) / m) ** (1 / self.g)
        w2 = 0.18 / (-m1 * k / (k - 1))
        self.s2 = 100 * w2 * m1
        u2 = (q / (q + w2)) ** self.g
        self.m2 = m1 / u2
        self.tone_limit = n / (100 * u2)

    def flare_inverse(self, z):
        return (z + np.sqrt(z * (z + 4 * self.t1))) / 2

    def tone(self, y):
        """Scene luminance to display luminance, both in cd/m2 (scene-linear 1 is 100)."""
        f = self.m2 * (y / (y + self.s2)) ** self.g
        return 100 * f * f / (f + self.t1)

    def tone_inverse(self, y):
        f = self.flare_inverse(np.clip(y / 100, 0, self.tone_limit))
        lit = f > 0
        return np.where(lit, self.s2 / ((self.m2 / np.where(lit, f, 1)) ** (1 / self.g) - 1), 0)

    # -- tables

    def make_reach(self):
        """Largest M at Jmax inside AP1, for every whole degree."""
        h = np.arange(SIZE, dtype=float)

        def inside(m):
            return (AP1.rgb(np.stack([np.full(SIZE, self.jmax), m, h], -1)) >= 0).all(-1)

        lo, hi = np.zeros(SIZE), np.full(SIZE, 50.0)
        while (grow := inside(hi) & (hi < 1300)).any():
            lo, hi = np.where(grow, hi, lo), np.where(grow, hi + 50, hi)
        hi = bisect(lo, hi, inside, 1e-2)[1]
        return np.append(hi, hi[0])

    def reach(self, h):
        i = np.minimum(np.floor(h).astype(int), SIZE - 1)
        return self.reach_table[i] + (h - i) * (self.reach_table[i + 1] - self.reach_table[i])

    def display_corners(self):
        """RGB and hue of the display's corners, from the smallest hue on.

        Computed once: the tables compare these hues for equality, and NumPy may round the same sum differently at another
        address.
        """
        rgb = CORNERS * self.peak / 100
        h = self.limiting.jmh(rgb)[:, 2]
        first = h.argmin()
        return np.roll(rgb, -first, axis=0), np.roll(h, -first)

    def reach_hues(self):
        limit = a_of_j(self.jmax)
        scale = bisect(np.zeros(6), np.full(6, self.clamp),
                       lambda s: AP1.aab(s[:, None] * CORNERS)[:, 0] < limit, 1e-3)[1]
        return AP1.jmh(scale[:, None] * CORNERS)[:, 2]

    def make_hues(self):
        """Hues of the cusp table, whose samples fall on the corners' hues, and at which entries those are."""
        corners = np.unique(np.concatenate([self.corners[1], self.reach_hues()]))
        counts = []
        for k, hue in enumerate(corners):
            low = counts[-1] if counts else int(hue != 0)
            index = int(np.clip(np.floor(hue + 0.5), low, SIZE - 1))
            if counts and index == counts[-1]:
                if k >= 2 and counts[-2] != counts[-1] - 1:
                    counts[-1] -= 1
                else:
                    index += 1
            counts.append(min(index, SIZE - 1))
        hues, begin, lower = [], 0, 0.0
        for count, upper in zip([*counts, SIZE], [*corners, 360.0]):
            steps = count - begin
            hues += [lower + i * (upper - lower) / steps for i in range(steps)]
            begin, lower = count, upper
        return np.array(hues), counts

    def make_cusps(self):
        """J and M of the display's cusp for every hue of the table; M enlarged for the smoothed corner."""
        rgb, h = self.corners
        rgb = np.concatenate([rgb[-1:], rgb, rgb[:1]])
        h = np.concatenate([[h[-1] - 360], h, [h[0] + 360]])
        k = np.searchsorted(h, self.hues, side="right") - 1
        lower, upper = rgb[k], rgb[k + 1]

        def jmh(t):
            return self.limiting.jmh(lower + t[:, None] * (upper - lower))

        def is_low(t):
            hue = jmh(t)[:, 2]
            return np.where(hue < h[k], False, np.where(hue >= h[k + 1], True, hue <= self.hues))

        lo, hi = bisect(np.zeros(SIZE), np.ones(SIZE), is_low, 1e-7)
        cusps = jmh(np.where(self.hues == h[k], 0, (lo + hi) / 2))[:, :2]
        return cusps * (1, 1 + 0.27 * 0.12)

    def make_gammas(self):
        """Power of the upper hull: the smallest for which the hull is outside of the display at five heights."""
        jc, mc = (np.repeat(column[:, None], 5, 1) for column in self.cusps.T)
        hue = np.repeat(self.hues[:, None], 5, 1)
        j = jc + (self.jmax - jc) * np.array([0.01, 0.1, 0.5, 0.8, 0.99])
        line = self.line(j, mc, j, jc, mc)

        def fits(gamma):
            m = self.boundary(line, jc, mc, 1 / gamma[:, None])
            rgb = self.limiting.rgb(np.stack([line[0] + line[1] * m, m, hue], -1))
            return (rgb > self.peak / 100).any(-1).all(-1)

        lo, hi = np.zeros(SIZE), np.full(SIZE, 0.4)
        while (grow := ~fits(hi) & (hi < 5)).any():
            lo, hi = np.where(grow, hi, lo), np.where(grow, hi + 0.4, hi)
        return bisect(lo, hi, lambda gamma: ~fits(gamma), 1e-5)[1]

    def cusp(self, h):
        """J, M and 1/gamma at hues."""
        at = np.concatenate([[self.hues[-1] - 360], self.hues, [self.hues[0] + 360]])
        wrap = [-1, *range(SIZE), 0]
        columns = (*self.cusps.T, self.inverse_gammas)
        return [np.interp(h, at, column[wrap]) for column in columns]

    # -- chroma compression

    def chroma_steps(self, j_tone, h):
        """(norm, limit, arguments of the two toes) at a tone-mapped J."""
        nj = j_tone / self.jmax
        rest = np.maximum(0, 1 - nj)
        norm = self.chroma_scale * chroma_norm(h)
        limit = nj**ICZ * self.reach(h) / norm
        expand = (limit - 0.001, rest * self.saturation, np.sqrt(nj * nj + self.threshold))
        return norm, limit, expand, (limit, nj * self.compression, rest)

    def compress_chroma(self, j, j_tone, m, h):
        norm, limit, expand, compress = self.chroma_steps(j_tone, h)
        x = m * (j_tone / j) ** ICZ / norm
        x = limit - toe(limit - x, *expand)
        return toe(x, *compress) * norm

    def expand_chroma(self, j, j_tone, m, h):
        norm, limit, expand, compress = self.chroma_steps(j_tone, h)
        x = toe_inverse(m / norm, *compress)
        x = limit - toe_inverse(limit - x, *expand)
        return x * norm * (j_tone / j) ** -ICZ

    # -- gamut compression

    def focus_gain(self, jx, jc):
        jt = jc + 0.3 * (self.jmax - jc)
        rise = 1 + np.log10((self.jmax - jt) / np.maximum(1e-4, self.jmax - jx)) ** 2
        return self.focus * np.where(jx > jt, rise, 1)

    def line(self, j, m, jx, jc, mc):
        """The line that (j, m) is moved along: J where it meets the J axis, slope, J where the cusp's does, its end."""
        jf = jc + (self.jmid - jc) * np.minimum(1, 1.3 - jc / self.jmax)
        gain = self.focus_gain(jx, jc)

        def axis(j, m):
            m = m / gain
            a = m / jf
            b1, b2, c2 = 1 - m, 1 + m + self.jmax * a, self.jmax * m + j
            below = 2 * j / (b1 + np.sqrt(b1 * b1 + 4 * a * j))
            above = 2 * c2 / (b2 + np.sqrt(np.maximum(b2 * b2 - 4 * a * c2, 0)))
            return np.where(j < jf, below, above)

        at = axis(j, m)
        slope = np.where(at < jf, at, self.jmax - at) * (at - jf) / (jf * gain)
        return at, slope, axis(jc, mc)

    def boundary(self, line, jc, mc, inverse_gamma):
        """M of the display's hull on the line, its cusp rounded."""
        at, slope, at_cusp = line

        def end(at, slope, power, j0, m0, reference):
            s = reference * np.maximum(at / reference, 0) ** power
            # Where the line is no flatter than the hull they never meet; no real display comes near.
            return s * m0 / np.maximum(j0 - slope * m0, 1e-12 * self.jmax)

        lower = end(at, slope, self.lower_power, jc, mc, at_cusp)
        upper = end(self.jmax - at, -slope, inverse_gamma, self.jmax - jc, mc, self.jmax - at_cusp)
        e = 0.12 * mc
        w = np.maximum(e - np.abs(lower - upper), 0) / e
        return np.minimum(lower, upper) - w**3 * e / 6

    def move_along(self, j, m, h, jx, is_inverse):
        """Gamut compression, or its inverse, with the focus gain for jx. J in (0, Jmax], M > 0."""
        jc, mc, inverse_gamma = self.cusp(h)
        line = at, slope, _ = self.line(j, m, jx, jc, mc)
        edge = self.boundary(line, jc, mc, inverse_gamma)
        reach = self.jmax * (at / self.jmax) ** ICZ * self.reach(h) / (self.jmax - slope * self.reach(h))
        p = np.maximum(edge / reach, 0.75)
        th = p * edge
        moves = (m > th) & (p < 1) & (edge > 0)
        th, edge, reach = (np.where(moves, v, w) for v, w in ((th, 0.75), (edge, 1), (reach, 2)))
        k = (reach - th) / ((reach - th) / (edge - th) - 1)
        y = np.where(moves, m - th, 0) / k
        if is_inverse:
            y = np.where(y >= 1, 1, y / np.where(y >= 1, 1, 1 - y))
        else:
            y = y / (1 + y)
        moved = np.where(moves, th + k * y, m)
        is_empty = edge <= 0
        return np.where(is_empty, j, at + slope * moved), np.where(is_empty, 0, moved)

    def gamut(self, j, m, h, is_inverse=False):
        """(J, M) moved into the display's hull, or back."""
        inside = (j > 0) & (m > 0) & (j <= self.jmax)
        j_, m_ = np.where(inside, j, 1), np.where(inside, m, 1)
        jx = j_
        if is_inverse:
            jc = self.cusp(h)[0]
            jx = np.where(j_ <= jc + 0.3 * (self.jmax - jc), j_, self.move_along(j_, m_, h, j_, True)[0])
        moved = self.move_along(j_, m_, h, jx, is_inverse)
        return np.where(inside, moved[0], np.maximum(j, 0)), np.where(inside, moved[1], 0)

    # -- the whole

    def forward(self, ap1):
        """Scene-linear AP1 to display light in the limiting primaries, 1 = 100 cd/m2, not limited to the peak."""
        ap0 = np.clip(ap1, 0, self.clamp) @ rgb_to_rgb("ap1", "ap0").T
        j, m, h = np.moveaxis(AP0.jmh(ap0), -1, 0)
        j_tone = j_of_luminance(self.tone(luminance_of_a(a_of_j(j))))
        chromatic = (j > 0) & (m > 0)
        m = np.where(chromatic, self.compress_chroma(np.where(chromatic, j, 1), j_tone, m, h), 0)
        j, m = self.gamut(j_tone, m, h)
        return self.limiting.rgb(np.stack([j, m, h], -1))

    def inverse(self, rgb):
        """Display light to scene-linear AP1."""
        jmh = self.limiting.jmh(np.clip(rgb, 0, self.peak / 100))
        j_tone, m, h = np.moveaxis(jmh, -1, 0)
        j_tone, m = self.gamut(j_tone, m, h, is_inverse=True)
        j = j_of_luminance(self.tone_inverse(luminance_of_a(a_of_j(j_tone))))
        chromatic = (j_tone > 0) & (j > 0) & (m > 0)
        m = np.where(chromatic, self.expand_chroma(np.where(chromatic, j, 1), np.where(chromatic, j_tone, 1), m, h), 0)
        ap0 = AP0.rgb(np.stack([j, m, h], -1))
        return np.clip(ap0 @ rgb_to_rgb("ap0", "ap1").T, 0, self.clamp)


def output_primaries(limit="rec709", primaries="", **_):
    """Those of `limit`, or xy of red, green, blue and white from a text.

    >>> output_primaries(), output_primaries(primaries="0.7 0.3, 0.2 0.7, 0.1 0.1, 0.3 0.3")
    ('rec709', ((0.7, 0.3), (0.2, 0.7), (0.1, 0.1), (0.3, 0.3)))
    """
    if not primaries:
        return limit
    xy = np.array(primaries.replace(",", " ").split(), float)
    if xy.shape != (8,):
        raise ValueError(f"primaries is {primaries!r}; expected eight numbers xr yr xg yg xb yb xw yw")
    return tuple(map(tuple, xy.reshape(4, 2).tolist()))


@lru_cache(maxsize=16)
def transform(peak, limit, primaries=""):
    """Transform by the operator's settings: `primaries` is 'xr yr xg yg xb yb xw yw', or empty for those of `limit`.

    >>> transform(1000.0, "rec2020").counts
    [24, 26, 105, 106, 147, 148, 191, 192, 267, 269, 341, 342]
    """
    return Transform(peak, chromaticities(output_primaries(limit, primaries)))


def aces_20(rgb, peak=100.0, limit="rec709", primaries=""):
    """Scene-linear AP1 to light of the limiting primaries, 1 = 100 cd/m2, in [0, peak/100].

    >>> aces_20([0.18, 0.18, 0.18]).round(9).tolist()
    [0.099999325, 0.099999325, 0.099999325]
    """
    t = transform(float(peak), limit, primaries)
    return np.clip(t.forward(sanitize(rgb)), 0, t.peak / 100)


def aces_20_inverse(rgb, peak=100.0, limit="rec709", primaries=""):
    """Its inverse: scene-linear AP1 in [0, 8r].

    >>> aces_20_inverse([1.0, 1.0, 1.0]).round(9).tolist()
    [128.0, 128.0, 128.0]
    >>> to_ap0 = rgb_to_rgb("ap1", "ap0").T
    >>> (aces_20_inverse([0.2, 0.1, 0.8]) @ to_ap0).round(9).tolist()
    [0.481954734, 0.311477121, 1.324501466]
    >>> (aces_20_inverse([9.8, 9, 5], 1000, "rec2020") @ to_ap0).round(8).tolist()
    [43.40833045, 36.38085121, 2.69991493]
    >>> (aces_20_inverse([9, 1, 0.5], 1000, "p3d65") @ to_ap0).round(9).tolist()
    [5.961081326, 1.144685038, 0.176056312]
    """
    return transform(float(peak), limit, primaries).inverse(sanitize(rgb))


OPERATORS = {"aces_20": aces_20}
INVERSES = {"aces_20": aces_20_inverse}
WORKING = {"aces_20": "ap1"}
OUTPUT_PRIMARIES = {"aces_20": output_primaries}
PEAK = {"aces_20": lambda peak=100.0, **_: peak / 100}
FROM_DISPLAY = {"aces_20": {"peak": lambda display: min(max(display.peak, 100.0), 10000.0),
                            # The standard's forms for SDR displays are of Rec.709 and P3.
                            "limit": lambda display: "p3d65" if display.primaries == "rec2020" and not display.is_hdr
                            else display.primaries}}
