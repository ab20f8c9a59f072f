// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <vector>

#include "operators/agx_sigmoid.h"
#include "tonewright/color.h"

/// Blender's AgX for SDR displays: the nodes of its 3D LUTs, and their formula, for double and for
/// Expr. operators/agx_blender.cpp cites the sources.
///
/// The build computes the nodes of the default 3D LUT (tools/write_nodes.cpp), because they take
/// longer than the rest of an engine. So this header includes no more than that program needs.
TONEWRIGHT_NAMESPACE_BEGIN
namespace agx_cube {

// clang-format off
/// FilmLight's matrix of E-Gamut to XYZ under D65, as the configuration has it.
inline constexpr Matrix3 kEGamutToXyz = {{
    { 0.7053968501,  0.1640413283,   0.08101774865},
    { 0.2801307241,  0.8202066415,  -0.1003373656},
    {-0.1037815116, -0.07290725703,  1.265746519}}};

/// Matrices of the generator of the 3D LUTs.
inline constexpr Matrix3 kXyzToRec2020 = {{
    { 1.7166634277958805, -0.3556733197301399, -0.2533680878902478},
    {-0.6666738361988869,  1.6164557398246981,  0.0157682970961337},
    { 0.0176424817849772, -0.0427769763827532,  0.9422432810184308}}};
inline constexpr Matrix3 kRec2020ToXyz = {{
    {0.6369535067850740, 0.1446191846692331, 0.1688558539228734},
    {0.2626983389565560, 0.6780087657728165, 0.0592928952706273},
    {0.0,                0.0280731358475570, 1.0608272349505707}}};
inline constexpr Matrix3 kXyzToRec709 = {{
    { 3.2410032329763588, -1.5373989694887856, -0.4986158819963629},
    {-0.9692242522025164,  1.8759299836951759,  0.0415542263400847},
    { 0.0556394198519755, -0.2040112061239099,  1.0571489771875333}}};
inline constexpr Matrix3 kXyzToP3 = {{
    { 2.4935091239346101, -0.9313881794047790, -0.4027127567416516},
    {-0.8294732139295544,  1.7626305796003032,  0.0236242371055886},
    { 0.0358512644339181, -0.0761839369220759,  0.9570295866943110}}};
// clang-format on

/// Rec.2020 weights of the luminance in the guard rails, one set for the 3D LUTs for SDR and for
/// the looks, and one for the generator since 2025, which made the 3D LUT for HDR.
inline constexpr Vector3 kRailWeights = {0.2658180370250449, 0.59846986045365, 0.1357121025213052};
inline constexpr Vector3 kRailWeights2025 = {0.2589235355689848, 0.6104985346066525,
                                             0.13057792982436284};

inline constexpr double kMidGray = 0.18;
/// Smallest divisor and smallest argument of a logarithm.
inline constexpr double kTiny = 1e-30;

template <class T>
using Color = std::array<T, 3>;

template <class T>
T smallest(const Color<T>& c) {
    return min(min(c[0], c[1]), c[2]);
}
template <class T>
T largest(const Color<T>& c) {
    return max(max(c[0], c[1]), c[2]);
}
template <class T>
T luminance(const Color<T>& c, const Vector3& weights) {
    return weights[0] * c[0] + weights[1] * c[1] + weights[2] * c[2];
}

/// Lifts and scales colors outside the gamut, with Rec.2020 channels below 0, into it. A color of
/// luminance 0 becomes black.
template <class T>
Color<T> scene_rail(const Color<T>& c, const Vector3& weights) {
    const T off = max(-smallest(c), 0);
    Color<T> out = {c[0] + off, c[1] + off, c[2] + off};
    const T y = luminance(out, weights);
    const T ratio = max(1 - 0.5 * off / max(y, kTiny), 0);
    for (T& v : out)
        v = v * ratio;
    return out;
}

/// The same for display-linear colors, in the gamut of a display. The weight of the complement
/// falls with the luminance, by y^0.08.
/// @param weights  of the gamut's channels; they sum to 1.
template <class T>
Color<T> display_rail(const Color<T>& c, const Vector3& weights) {
    const auto fade = [](const T& y) -> T { return min(pow(max(y, 0), 0.08), 1); };
    const T off = max(-smallest(c), 0);
    Color<T> out = {c[0] + off, c[1] + off, c[2] + off};
    const T y = luminance(out, weights);
    const T before = 2 * y - off - y * fade(y - off);
    const T after = y * (2 - fade(y));
    const T ratio = max(before / max(after, kTiny), 0);
    for (T& v : out)
        v = v * ratio;
    return out;
}

/// Blender's sigmoid: mid gray is unchanged after the 2.4 power.
inline AgxSigmoid sigmoid(double shoulder_power) {
    return {10 / 16.5, std::pow(kMidGray, 1 / 2.4), 2.4, 1.5, shoulder_power};
}

/// Maps stops from 10 below to 6.5 above mid gray to [0, 1], and continues above 1.
template <class T>
T stops_of(const T& x) {
    constexpr double lowest = kMidGray / 1024;
    return max((log2(max(x, lowest) / kMidGray) + 10) / 16.5, 0);
}

template <class T>
T sdr_light(const T& x) {
    static const AgxSigmoid curve = sigmoid(1.5);
    return pow(max(curve(stops_of(x)), 0), 2.4);
}

/// (c - min)/(max - min): the position of each channel between the others. Grays: 0.
template <class T>
Color<T> places(const Color<T>& c) {
    const T lo = smallest(c);
    const T spread = largest(c) - lo;
    Color<T> out = c;
    for (T& v : out) {
        v = if_less(
            T(0), spread, [&]() -> T { return (v - lo) / spread; }, []() -> T { return 0; });
    }
    return out;
}

/// Scene color in the inset, >= 0 -> display-linear. Its hue is 40 % the curve's and 60 % the
/// scene's.
template <class T>
Color<T> sdr_map(const Color<T>& scene) {
    Color<T> out = {sdr_light(scene[0]), sdr_light(scene[1]), sdr_light(scene[2])};
    const T lo = smallest(out);
    const T spread = largest(out) - lo;
    const Color<T> place = places(scene);
    for (std::size_t i = 0; i < 3; ++i)
        out[i] = 0.4 * out[i] + 0.6 * (lo + spread * place[i]);
    return out;
}

/// Weights of the luminance of Rec.2020 for the channels of another gamut of the same white.
inline Vector3 weights_of(const Primaries& gamut, const Vector3& weights) {
    const Matrix3 m = rgb_to_rgb(gamut, kRec2020);
    Vector3 out{};
    for (std::size_t i = 0; i < 3; ++i)
        out[i] = weights[0] * m[0][i] + weights[1] * m[1][i] + weights[2] * m[2][i];
    return out;
}

template <class T>
Color<T> times(const Matrix3& m, const Color<T>& c) {
    Color<T> out = c;
    for (std::size_t i = 0; i < 3; ++i)
        out[i] = m[i][0] * c[0] + m[i][1] * c[1] + m[i][2] * c[2];
    return out;
}

/// Scene value of a node, from its position on an axis.
template <class T>
T light_at(const T& place) {
    return kMidGray * exp2(25 * place - 10);
}

inline constexpr int kEdge = 57;

/// Code values of a 2.4 power.
struct SdrNode {
    Matrix3 to_limit;
    Vector3 weights;
    bool has_rail;

    /// @param from_xyz  the generator's matrix to the limit; null if the limit is Rec.2020, which
    ///                  has no guard rail.
    SdrNode(const Primaries& limit, const Matrix3* from_xyz)
        : to_limit(from_xyz ? multiply(multiply(*from_xyz, kRec2020ToXyz), kAgxOutsetRec2020)
                            : kAgxOutsetRec2020),
          weights(weights_of(limit, kRailWeights)),
          has_rail(from_xyz != nullptr) {}

    template <class T>
    Color<T> operator()(const Color<T>& c) const {
        const Color<T> scene = times(kAgxInsetRec2020, scene_rail(c, kRailWeights));
        Color<T> out = times(to_limit, sdr_map(scene));
        if (has_rail) out = display_rail(out, weights);
        for (T& v : out)
            v = pow(min(max(v, 0), 1), 1 / 2.4);
        return out;
    }
};

/// Red, green and blue of each node, the blue axis running fastest.
/// @param node  a functor: Rec.2020 -> color of the 3D LUT
template <class Node>
std::vector<double> cube_nodes(int edge, const Node& node) {
    const auto n = static_cast<std::size_t>(edge);
    const Matrix3 to_rec2020 = multiply(kXyzToRec2020, kEGamutToXyz);
    std::vector<double> light(n);
    for (std::size_t i = 0; i < n; ++i)
        light[i] = light_at(static_cast<double>(i) / static_cast<double>(n - 1));
    std::vector<double> all;
    all.reserve(3 * n * n * n);
    for (const double r : light) {
        for (const double g : light) {
            for (const double b : light) {
                const Vector3 value = node(times(to_rec2020, Vector3{r, g, b}));
                all.insert(all.end(), value.begin(), value.end());
            }
        }
    }
    return all;
}

/// The default 3D LUT's nodes: limit=rec709.
inline SdrNode rec709_node() { return {kRec709, &kXyzToRec709}; }

}  // namespace agx_cube
TONEWRIGHT_NAMESPACE_END
