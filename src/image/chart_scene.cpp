// SPDX-License-Identifier: Apache-2.0
//
// The two pictures of the test chart: a ray-traced still life, and a sunset. They show highlights
// that roll off, saturated lights, glows, and dark areas beside bright ones.
#include "image/chart_scene.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "measure/chart_colors.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

struct Vec {
    double x = 0;
    double y = 0;
    double z = 0;
};
Vec operator+(const Vec& a, const Vec& b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
Vec operator-(const Vec& a, const Vec& b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
Vec operator*(const Vec& a, const Vec& b) { return {a.x * b.x, a.y * b.y, a.z * b.z}; }
Vec operator*(double s, const Vec& a) { return {s * a.x, s * a.y, s * a.z}; }
double dot(const Vec& a, const Vec& b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
Vec normalize(const Vec& a) { return (1 / std::sqrt(dot(a, a))) * a; }
Vec reflect(const Vec& d, const Vec& n) { return d - 2 * dot(d, n) * n; }
Vec blend(const Vec& a, const Vec& b, double t) { return (1 - t) * a + t * b; }
double smooth(double edge0, double edge1, double x) {
    const double t = std::clamp((x - edge0) / (edge1 - edge0), 0.0, 1.0);
    return t * t * (3 - 2 * t);
}

/// Colors are scene-linear Rec.709.
struct Sphere {
    Vec center;
    double radius;
    Vec diffuse;       // reflectance
    Vec mirror;        // reflectance straight on
    double highlight;  // peak of the key light's reflection
    double gloss;      // exponent of the highlight
    Vec emission;      // at its center; 0 at its edge, so that edges stay smooth when tone mapped
};

constexpr double kGap = 0.01;

Vec lamp(std::size_t i) { return {kLamps[i][0], kLamps[i][1], kLamps[i][2]}; }

const std::array<Sphere, 9> kSpheres = {{
    // On the floor, lit: gray card, plastic, gold, ceramic, chrome.
    {{-2.5, 0.58, 0.15}, 0.58, {0.18, 0.18, 0.18}, {0, 0, 0}, 0, 1, {}},
    {{-1.25, 0.58, -0.2}, 0.58, {0.50, 0.012, 0.008}, {0.04, 0.04, 0.04}, 120, 900, {}},
    {{0.0, 0.58, -0.35}, 0.58, {0.02, 0.012, 0.003}, {1.0, 0.70, 0.29}, 500, 700, {}},
    {{1.25, 0.58, -0.2}, 0.58, {0.010, 0.07, 0.46}, {0.05, 0.05, 0.05}, 240, 1800, {}},
    {{2.5, 0.58, 0.15}, 0.58, {0.0, 0.0, 0.0}, {0.85, 0.86, 0.87}, 500, 2500, {}},
    // Emissive spheres above and at the back: red, green, blue, and the magenta of a neon tube.
    {{-2.0, 1.72, 0.9}, 0.42, {}, {}, 0, 1, lamp(0)},
    {{-0.68, 1.86, 1.1}, 0.42, {}, {}, 0, 1, lamp(1)},
    {{0.68, 1.86, 1.1}, 0.42, {}, {}, 0, 1, lamp(2)},
    {{2.0, 1.72, 0.9}, 0.42, {}, {}, 0, 1, lamp(3)},
}};

const Vec kToKey = normalize({-0.55, 0.95, -0.75});
/// Light from a white matt surface that faces the key light, and under the open sky.
const Vec kKey = {2.3, 2.15, 1.9};
const Vec kSky = {0.05, 0.065, 0.09};

bool shines(const Sphere& s) { return s.emission.x + s.emission.y + s.emission.z > 0; }

/// Distance to the sphere along the ray, or a negative number.
double hit(const Sphere& s, const Vec& from, const Vec& direction) {
    const Vec to = from - s.center;
    const double b = dot(to, direction);
    const double h = b * b - dot(to, to) + s.radius * s.radius;
    return h < 0 ? -1 : -b - std::sqrt(h);
}

/// Part of the key light, a disc of a few degrees, that reaches the point.
double key_light_at(const Vec& point) {
    double light = 1;
    for (const Sphere& s : kSpheres) {
        const Vec to = s.center - point;
        const double along = dot(to, kToKey);
        if (along <= 0) continue;
        const Vec off = to - along * kToKey;
        const double edge = std::sqrt(dot(off, off)) - s.radius;  // below 0: within the shadow
        const double softness = 0.08 * along;
        light = std::min(light, smooth(-softness, softness, edge));
    }
    return light;
}

/// Fraction of the sky over a surface that the spheres do not cover.
double sky_at(const Vec& point, const Vec& normal) {
    double open = 1;
    for (const Sphere& s : kSpheres) {
        const Vec to = s.center - point;
        const double d2 = dot(to, to);
        if (d2 < s.radius * s.radius * 1.0001) continue;  // the surface of this sphere itself
        const double facing = std::max(0.0, dot(normal, to) / std::sqrt(d2));
        open *= 1 - facing * s.radius * s.radius / d2;
    }
    return open;
}

/// Reflected light of a matt surface: key, sky, and the emissive spheres.
Vec matt_light(const Vec& point, const Vec& normal) {
    const double toward_key = std::max(0.0, dot(normal, kToKey));
    Vec light = 0.5 * (1 + normal.y) * sky_at(point, normal) * kSky;
    if (toward_key > 0) light = light + toward_key * key_light_at(point) * kKey;
    for (const Sphere& s : kSpheres) {
        if (!shines(s)) continue;
        const Vec to = s.center - point;
        const double d2 = dot(to, to);
        if (d2 < s.radius * s.radius * 1.0001) continue;
        const double facing = std::max(0.0, dot(normal, to) / std::sqrt(d2));
        // On average, its disc is 4/7 as bright as its center.
        light = light + facing * s.radius * s.radius / d2 * 4 / 7 * s.emission;
    }
    return light;
}

Vec backdrop(const Vec& direction) {
    const double up = std::max(0.0, direction.y);
    Vec wall =
        blend({0.030, 0.028, 0.032}, {0.004, 0.005, 0.009}, std::sqrt(std::min(1.0, 2.2 * up)));
    // A soft box behind the camera, which mirrors show.
    if (direction.z < 0) {
        const double box = smooth(0.36, 0.30, std::fabs(direction.x - 0.35)) *
                           smooth(0.22, 0.17, std::fabs(direction.y - 0.62));
        wall = wall + 9 * box * Vec{1, 0.97, 0.92};
    }
    return wall;
}

Vec trace(const Vec& from, const Vec& direction, int depth) {
    const Sphere* nearest = nullptr;
    double distance = 1e9;
    for (const Sphere& s : kSpheres) {
        const double t = hit(s, from, direction);
        if (t > kGap && t < distance) {
            distance = t;
            nearest = &s;
        }
    }
    if (!nearest) {
        if (direction.y >= -1e-6) return backdrop(direction);
        const double t = -from.y / direction.y;
        const Vec point = from + t * direction;
        const double fog = 1 - std::exp(-0.0035 * t * t);
        const Vec horizon = backdrop({direction.x, 0, direction.z});
        const Vec matt = 0.065 * matt_light(point, {0, 1, 0});
        // A little polished: the floor shows a dim image of objects, but none of the small
        // highlights.
        Vec image{};
        if (depth > 0) {
            const double grazing = std::pow(1 + direction.y, 5);
            const Vec seen = trace(point, reflect(direction, {0, 1, 0}), depth - 1);
            image = (0.03 + 0.25 * grazing) *
                    Vec{std::min(seen.x, 2.0), std::min(seen.y, 2.0), std::min(seen.z, 2.0)};
        }
        return blend(matt + image, horizon, fog);
    }
    const Sphere& s = *nearest;
    const Vec point = from + distance * direction;
    const Vec normal = (1 / s.radius) * (point - s.center);
    const double straight = std::max(0.0, -dot(normal, direction));
    if (shines(s)) return std::pow(straight, 1.5) * s.emission;

    Vec color = s.diffuse * matt_light(point, normal);
    if (s.highlight > 0) {
        const Vec halfway = normalize(kToKey - direction);
        const double lobe = std::pow(std::max(0.0, dot(normal, halfway)), s.gloss);
        const double tint = std::max({s.mirror.x, s.mirror.y, s.mirror.z});
        color = color + key_light_at(point) * s.highlight * lobe / tint * s.mirror;
    }
    if (depth > 0 && s.mirror.x > 0) {
        const double schlick = std::pow(1 - straight, 5);
        const Vec mirror = blend(s.mirror, {1, 1, 1}, schlick);
        color = color + mirror * trace(point, reflect(direction, normal), depth - 1);
    }
    return color;
}

Rgb to_rgb(const Vec& v) {
    return {static_cast<float>(v.x), static_cast<float>(v.y), static_cast<float>(v.z)};
}

}  // namespace

void draw_spheres(Canvas& canvas, int x0, int y0, int x1, int y1) {
    const Vec eye = {0, 1.9, -7.2};
    const Vec forward = normalize(Vec{0, 0.92, 0} - eye);
    const Vec right = {1, 0, 0};
    const Vec up = {0, forward.z, -forward.y};
    const double aspect = static_cast<double>(x1 - x0) / (y1 - y0);
    const double zoom =
        0.240 * std::max(1.0, 1.82 / aspect);  // the row of spheres stays in the frame
    constexpr int kSamples = 3;                // each way
    const double width = x1 - x0;
    const double height = y1 - y0;
    canvas.paint(x0, y0, x1, y1, [&](double u, double v) {
        Vec sum{};
        for (int i = 0; i < kSamples * kSamples; ++i) {
            const double du = ((i % kSamples + 0.5) / kSamples - 0.5) / width;
            const int row = i / kSamples;
            const double dv = ((row + 0.5) / kSamples - 0.5) / height;
            const double sx = (2 * (u + du) - 1) * zoom * aspect;
            const double sy = (1 - 2 * (v + dv)) * zoom;
            sum = sum + trace(eye, normalize(forward + sx * right + sy * up), 2);
        }
        return to_rgb(1.0 / (kSamples * kSamples) * sum);
    });
}

void draw_sunset(Canvas& canvas, int x0, int y0, int x1, int y1) {
    const double aspect = static_cast<double>(x1 - x0) / (y1 - y0);
    const double pixel = 1.0 / (y1 - y0);
    const auto ridge = [](double x, double base, double height, double frequency, double phase) {
        return base + height * (std::sin(frequency * x + phase) +
                                0.5 * std::sin(2.3 * frequency * x + 2 * phase) +
                                0.25 * std::sin(5.1 * frequency * x + 3 * phase));
    };
    canvas.paint(x0, y0, x1, y1, [&](double u, double v) {
        const double x = u * aspect;
        const double sun_x = x - 0.66 * aspect;
        const double sun_y = v - 0.60;
        const double from_sun = std::sqrt(sun_x * sun_x + sun_y * sun_y);
        const double height = 1 - v;
        Vec sky = blend({1.9, 0.62, 0.16}, {0.10, 0.17, 0.42}, smooth(0.22, 1.05, height));
        sky = sky + 26 * std::exp(-from_sun * 9) * Vec{1, 0.45, 0.10} +
              2.4 * std::exp(-from_sun * 2.6) * Vec{1, 0.30, 0.10};
        sky = blend(sky, {2000, 1450, 760}, smooth(0.050 + pixel, 0.050 - pixel, from_sun));
        const double far = ridge(x, 0.30, 0.035, 2.6, 0.7);
        const double near = ridge(x, 0.16, 0.045, 1.7, 2.1);
        const Vec haze =
            blend({0.16, 0.055, 0.035}, {0.50, 0.16, 0.05}, std::exp(-std::fabs(sun_x) * 1.6));
        sky = blend(sky, haze, smooth(far + pixel, far - pixel, height));
        return to_rgb(
            blend(sky, {0.006, 0.005, 0.007}, smooth(near + pixel, near - pixel, height)));
    });
}

TONEWRIGHT_NAMESPACE_END
