// SPDX-License-Identifier: Apache-2.0
#include "tonewright/color.h"
#include "tonewright/error.h"

TONEWRIGHT_NAMESPACE_BEGIN

Matrix3 multiply(const Matrix3& a, const Matrix3& b) noexcept {
    Matrix3 m{};
    for (std::size_t i = 0; i < 3; ++i) {
        for (std::size_t j = 0; j < 3; ++j) {
            m[i][j] = a[i][0] * b[0][j] + a[i][1] * b[1][j] + a[i][2] * b[2][j];
        }
    }
    return m;
}

Vector3 multiply(const Matrix3& m, const Vector3& v) noexcept {
    Vector3 r{};
    for (std::size_t i = 0; i < 3; ++i)
        r[i] = m[i][0] * v[0] + m[i][1] * v[1] + m[i][2] * v[2];
    return r;
}

Matrix3 scale(const Matrix3& m, double factor) noexcept {
    Matrix3 r = m;
    for (auto& row : r) {
        for (double& x : row)
            x *= factor;
    }
    return r;
}

Matrix3 inverse(const Matrix3& m) {
    const auto minor = [&](std::size_t i, std::size_t j) {
        const std::size_t r0 = (i + 1) % 3;
        const std::size_t r1 = (i + 2) % 3;
        const std::size_t c0 = (j + 1) % 3;
        const std::size_t c1 = (j + 2) % 3;
        return m[r0][c0] * m[r1][c1] - m[r0][c1] * m[r1][c0];  // cyclic order carries the sign
    };
    const double determinant =
        m[0][0] * minor(0, 0) + m[0][1] * minor(0, 1) + m[0][2] * minor(0, 2);
    if (determinant == 0) throw Error("matrix: determinant is 0; expected an invertible matrix");
    Matrix3 r{};
    for (std::size_t i = 0; i < 3; ++i) {
        for (std::size_t j = 0; j < 3; ++j)
            r[i][j] = minor(j, i) / determinant;
    }
    return r;
}

Vector3 xyz_of(Chromaticity xy) noexcept { return {xy.x / xy.y, 1.0, (1 - xy.x - xy.y) / xy.y}; }

Matrix3 rgb_to_xyz(const Primaries& p) {
    // Any multiple of a primary works; the amounts are computed below.
    const auto column = [](Chromaticity xy) {
        return xy.y == 0 ? Vector3{xy.x, 0, 1 - xy.x} : xyz_of(xy);
    };
    const Vector3 r = column(p.red);
    const Vector3 g = column(p.green);
    const Vector3 b = column(p.blue);
    const Matrix3 columns = {{{r[0], g[0], b[0]}, {r[1], g[1], b[1]}, {r[2], g[2], b[2]}}};
    // Amounts of the primaries for which (1,1,1) is the white.
    const Vector3 amount = multiply(inverse(columns), xyz_of(p.whitepoint));
    Matrix3 m = columns;
    for (auto& row : m) {
        for (std::size_t j = 0; j < 3; ++j)
            row[j] *= amount[j];
    }
    return m;
}

namespace {

/// Scales the cone responses from one white to another.
Matrix3 adaptation(const Matrix3& cone, Chromaticity from, Chromaticity to) {
    if (from == to) return kIdentity3;
    const Vector3 source = multiply(cone, xyz_of(from));
    const Vector3 target = multiply(cone, xyz_of(to));
    const Matrix3 gains = {{{target[0] / source[0], 0, 0},
                            {0, target[1] / source[1], 0},
                            {0, 0, target[2] / source[2]}}};
    return multiply(inverse(cone), multiply(gains, cone));
}

/// CIE 159:2004, CIECAM02: its transform CAT02.
constexpr Matrix3 kCat02 = {
    {{0.7328, 0.4296, -0.1624}, {-0.7036, 1.6975, 0.0061}, {0.0030, 0.0136, 0.9834}}};

/// Gamuts whose makers state their matrix to ACES2065-1 with CAT02 instead of Bradford: the
/// Academy's input transforms by ARRI (CSC.Arri.LogC3_to_ACES.a2.v1, CSC.Arri.LogC4_to_ACES.a2.v1),
/// by Sony (CSC.Sony.SLog3_SGamut3_to_ACES.a2.v1, CSC.Sony.SLog3_SGamut3Cine_to_ACES.a2.v1) and by
/// Canon (CSC.Canon.CanonLog2_CGamut-D55_to_ACES.a2.v1).
/// Blackmagic Design states none for DaVinci Wide Gamut.
bool is_adapted_by_cat02(const Primaries& p) {
    return p == kArriWideGamut3 || p == kArriWideGamut4 || p == kSGamut3 || p == kSGamut3Cine ||
           p == kCinemaGamut;
}

/// Adapts with Bradford if the whites differ.
Matrix3 by_bradford(const Primaries& from, const Primaries& to) {
    const Matrix3 adapt = bradford_adaptation(from.whitepoint, to.whitepoint);
    return multiply(inverse(rgb_to_xyz(to)), multiply(adapt, rgb_to_xyz(from)));
}

Matrix3 to_ap0(const Primaries& p) {
    if (!is_adapted_by_cat02(p)) return by_bradford(p, kAP0);
    const Matrix3 adapt = adaptation(kCat02, p.whitepoint, kAcesWhite);
    return multiply(inverse(rgb_to_xyz(kAP0)), multiply(adapt, rgb_to_xyz(p)));
}

}  // namespace

Matrix3 bradford_adaptation(Chromaticity from, Chromaticity to) {
    // Lam 1985, as printed in ICC.1:2010, annex E.3.
    constexpr Matrix3 cone = {
        {{0.8951, 0.2664, -0.1614}, {-0.7502, 1.7135, 0.0367}, {0.0389, -0.0685, 1.0296}}};
    return adaptation(cone, from, to);
}

Matrix3 rgb_to_rgb(const Primaries& from, const Primaries& to) {
    if (from == to) return kIdentity3;
    if (is_adapted_by_cat02(from) || is_adapted_by_cat02(to))
        return multiply(inverse(to_ap0(to)), to_ap0(from));
    return by_bradford(from, to);
}

Matrix3 rgb_to_xyz_d65(const Primaries& p) {
    if (is_adapted_by_cat02(p)) return multiply(rgb_to_xyz(kRec709), rgb_to_rgb(p, kRec709));
    return multiply(bradford_adaptation(p.whitepoint, kD65), rgb_to_xyz(p));
}

TONEWRIGHT_NAMESPACE_END
