// SPDX-License-Identifier: Apache-2.0
//
// ACES 2.0: the Academy's output transform, for displays with any peak and any primaries.
//
// Source    Academy of Motion Picture Arts and Sciences, ACES 2: aces-core, Lib.Academy.Tonescale
//           and Lib.Academy.OutputTransform; as OpenColorIO 2.4.2 and later have it,
//           ops/fixedfunction/ACES2 (2.4.0, 2.4.1 and early aces-core raise the logarithm of the
//           focus gain to 1/0.55 instead of 2). Its color appearance model is a simplified form of
//           Hellwig and Fairchild, "Brightness, lightness, colorfulness, and chroma in CIECAM02 and
//           CAM16", Color Research and Application 47, 2022.
// In        scene-linear RGB, working primaries AP1 (ACEScg); domain [0, 8r], r = 128 + 768
//           log100(peak/100). The standard clamps to this domain. Its input is ACES2065-1, which it
//           converts to AP1 for the clamp.
// Out       display-linear RGB in the limiting primaries, 1.0 = 100 cd/m2; [0, peak/100].
// Kind      3D. Converts the color to J, M, h (lightness, colorfulness, hue) of the model; applies
//           a tone scale to J; compresses chroma with J, within the reach of AP1; moves colors
//           outside the display's hull along lines towards an anchor on the J axis; converts to
//           RGB. Monotone on the neutral axis: yes; invertible where nothing is clamped.
// Keeps     0 -> 0, r -> peak/100; hue h; grays have R = G = B in the limiting primaries.
// Differs   nowhere, not even in the tables: their 360 entries and the coarse tolerances of their
//           searches are visible in pictures. h itself is only needed for table lookups: the sines
//           and cosines of its multiples are polynomials of a/M and b/M. Powers that meet their own
//           inverse are left out, which only changes rounding. J and M are in units of the peak's
//           J. Left out: the variants with a D60 white inside D65 primaries and for cinemas, which
//           only scale or convert the output.
// Check     AP0 mid gray 0.18 -> 0.09999932511 (100 cd/m2), AP0 (4, 0.5, 0.1) -> (1, 0.2329307895,
//           0.1916180599) (check_values.json).
#include <algorithm>
#include <charconv>
#include <cmath>
#include <functional>
#include <memory>
#include <numbers>
#include <tuple>
#include <utility>

#include "base/bounded_cache.h"
#include "base/format_number.h"
#include "operators/family.h"
#include "pipeline/hue_structure.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

// Tables (double) and pixels (Expr) share formulas, which are templates of the scalar type. These
// overloads give double the functions of Expr.
double pow(double base, double exponent) { return std::pow(base, exponent); }
double sqrt(double x) { return std::sqrt(x); }
double log2(double x) { return std::log2(x); }
double abs(double x) { return std::fabs(x); }
double min(double a, double b) { return std::min(a, b); }
double max(double a, double b) { return std::max(a, b); }
double less(double a, double b) { return a < b ? 1 : 0; }
double select(double condition, double a, double b) { return condition != 0 ? a : b; }

/// A length or divisor below this counts as 0.
constexpr double kTiny = 1e-12;

template <class T>
T square(const T& x) {
    return x * x;
}

template <class T>
std::array<T, 3> transform(const Matrix3& m, const std::array<T, 3>& v) {
    const auto row = [&](std::size_t i) -> T {
        return m[i][0] * v[0] + m[i][1] * v[1] + m[i][2] * v[2];
    };
    return {row(0), row(1), row(2)};
}

// ---------------------------------------------------------------------------------------------
// The color appearance model: adapting luminance L_A 100, background Y_b 20, surround factor 0.59,
// N_c 0.9, full adaptation to the white of the given RGB.

constexpr double kLuminanceLevel = 0.7937005275461673;  // F_L of L_A, CIECAM02
constexpr double kConePower = 0.42;
constexpr double kConeHalf = 27.13;
constexpr double kConeLimit = 0.99;                    // of the compressed response, in the inverse
constexpr double kLightnessPower = 1.137056021344975;  // 0.59 (1.48 + sqrt(Y_b / 100))
constexpr double kOpponentScale = 400 * 43 * 0.9;

/// The cones of CAM16, as primaries.
constexpr Primaries kCam16 = {
    "CAM16", {0.8336, 0.1735}, {2.3854, -1.4659}, {0.087, -0.125}, {0.333, 0.333}};

// clang-format off
constexpr Matrix3 kOpponent = {{{2 / 3.05, 1 / 3.05,   1 / (20 * 3.05)},
                                {1.0,      -12.0 / 11, 1.0 / 11},
                                {1.0 / 9,  1.0 / 9,    -2.0 / 9}}};
// clang-format on

/// Achromatic response (of white: cone_response(kLuminanceLevel)) and the two opponent ones.
template <class T>
struct Opponent {
    T achromatic, a, b;
};

/// For a cone's x >= 0.
template <class T>
T cone_response(const T& x) {
    const T y = pow(x, kConePower);
    return y / (kConeHalf + y);
}

template <class T>
T cone_of_response(const T& response) {
    const T y = min(response, kConeLimit);
    return pow(kConeHalf * y / (1 - y), 1 / kConePower);
}

/// Extended to negatives as odd functions.
template <class T>
T signed_cone_response(const T& x) {
    const T y = cone_response<T>(abs(x));
    return select(less(x, 0), -y, y);
}

template <class T>
T signed_cone_of_response(const T& response) {
    const T x = cone_of_response<T>(abs(response));
    return select(less(response, 0), -x, x);
}

/// For cones after their compression.
template <class T>
Opponent<T> opponent_of(const std::array<T, 3>& responses) {
    const std::array<T, 3> v = transform(kOpponent, responses);
    return {v[0], kOpponentScale * v[1], kOpponentScale * v[2]};
}

template <class T>
std::array<T, 3> cones_of(const Opponent<T>& color) {
    static const Matrix3 back = inverse(kOpponent);
    // The first column is 1: rows of kOpponent sum to 1, 0 and 0.
    const auto cone = [&](std::size_t i) -> T {
        return signed_cone_of_response<T>(color.achromatic +
                                          (back[i][1] / kOpponentScale) * color.a +
                                          (back[i][2] / kOpponentScale) * color.b);
    };
    return {cone(0), cone(1), cone(2)};
}

/// RGB of some primaries <-> cones. White, (1, 1, 1), is F_L in every cone.
struct Cones {
    Matrix3 from_rgb;
    Matrix3 to_rgb;

    explicit Cones(const Primaries& primaries)
        : from_rgb(multiply(inverse(rgb_to_xyz(kCam16)), rgb_to_xyz(primaries))) {
        for (auto& row : from_rgb) {
            const double sum = row[0] + row[1] + row[2];
            for (double& x : row)
                x *= kLuminanceLevel / sum;
        }
        to_rgb = inverse(from_rgb);
    }

    [[nodiscard]] bool has_negatives() const {
        return std::any_of(from_rgb.begin(), from_rgb.end(), [](const auto& row) {
            return std::any_of(row.begin(), row.end(), [](double x) { return x < 0; });
        });
    }
};

/// Compressed achromatic response to a luminance in units of 100 cd/m2.
template <class T>
T achromatic_of_luminance(const T& luminance) {
    return cone_response<T>(kLuminanceLevel * luminance);
}

Vector3 aab_of(const Cones& cones, const Vector3& rgb) {
    Vector3 response = transform(cones.from_rgb, rgb);
    for (double& x : response)
        x = signed_cone_response(x);
    const Opponent<double> color = opponent_of(response);
    return {color.achromatic, color.a, color.b};
}

double degrees_of(const Vector3& aab) {
    const double h = std::atan2(aab[2], aab[1]) * (180 / std::numbers::pi);
    return h < 0 ? h + 360 : h;
}

// ---------------------------------------------------------------------------------------------
// Constants of a peak

/// Lib.Academy.Tonescale: scene to display luminance, both in units of 100 cd/m2.
struct ToneScale {
    static constexpr double kFlare = 0.04;     // t_1
    static constexpr double kContrast = 1.15;  // g
    double brightest;                          // r: scene-linear that is shown at the peak
    double s2;
    double m2;
    double mid;    // c_t: what 0.18 would be shown at, but for flare
    double limit;  // of the inverse's argument

    explicit ToneScale(double peak) {
        const double stops = std::log2(peak / 100);
        brightest = 128 + 768 * std::log(peak / 100) / std::log(100);
        mid = 0.10013 * (1 + 0.14 * stops);
        const double m1 = without_flare(peak / 100);
        const double q = brightest / m1;
        const double m = m1 / std::pow(q / (q + 1), kContrast);
        const double k = std::pow(without_flare(mid) / m, 1 / kContrast);
        const double w2 = 0.18 / (-m1 * k / (k - 1));
        const double u2 = std::pow(q / (q + w2), kContrast);
        s2 = w2 * m1;
        m2 = m1 / u2;
        limit = peak / 100 / u2;
    }

    template <class T>
    [[nodiscard]] static T without_flare(const T& y) {
        return (y + sqrt(y * (y + 4 * kFlare))) / 2;
    }

    [[nodiscard]] Expr operator()(const Expr& y) const {
        const Expr f = named("f", m2 * pow(y / (y + s2), kContrast));
        return square(f) / (f + kFlare);
    }

    [[nodiscard]] Expr inverse_of(const Expr& y) const {
        const Expr w = named("w", pow(without_flare<Expr>(min(y, limit)) / m2, 1 / kContrast));
        return s2 * w / (1 - w);
    }
};

/// Constants of a peak. J and M are in units of the peak's J, which is 100 of the standard's
/// units for 100 cd/m2.
struct Constants {
    double peak;           // in units of 100 cd/m2
    double input_limit;    // 8 r
    double achromatic;     // response to the peak
    double unit;           // the peak's J in the standard's units
    double mid_j;          // J of ToneScale::mid
    double focus;          // distance
    double lower_power;    // of the lower hull
    double compression;    // of chroma, with J
    double saturation;     // of chroma's expansion before it
    double threshold;      // the same near black
    double chroma_scale;   // of the chroma norm
    double smallest_rest;  // of J below the peak, in the focus gain

    Constants(double nits, const ToneScale& tone) {
        const double lp = std::log10(nits / 100);
        const double white = cone_response(kLuminanceLevel);
        peak = nits / 100;
        input_limit = 8 * tone.brightest;
        achromatic = achromatic_of_luminance(peak);
        unit = 100 * std::pow(achromatic / white, kLightnessPower);
        mid_j = std::pow(achromatic_of_luminance(tone.mid) / achromatic, kLightnessPower);
        focus = 1.35 + 2.3625 * lp;
        lower_power = 1 / (1.14 + 0.07 * lp);
        compression = 2.4 + 7.92 * lp;
        saturation = std::max(0.2, 1.3 - 0.897 * lp);
        threshold = 0.5 / nits;
        chroma_scale = (std::pow(0.03379 * nits, 0.30596) - 0.45135) / unit;
        smallest_rest = 1e-4 / unit;
    }
};

// ---------------------------------------------------------------------------------------------
// Gamut compression

/// Per hue: the most colorful color of the display, with M slightly enlarged, and 1/power of the
/// hull above it.
template <class T>
struct Cusp {
    T j, m, inverse_gamma;
};

/// The line along which a color is moved: J = axis + slope M.
template <class T>
struct Line {
    T axis, slope, cusp_axis;  // cusp_axis: where the line of the cusp meets the J axis
};

/// @param gain_j  J that sets the slope of the lines; for the forward direction, J of the color.
template <class T>
Line<T> line_through(const Constants& k, const T& j, const T& m, const T& gain_j,
                     const Cusp<T>& cusp) {
    const T focus_j = cusp.j + (k.mid_j - cusp.j) * min(1, 1.3 - cusp.j);
    const T threshold = cusp.j + 0.3 * (1 - cusp.j);
    const T stretch = log2((1 - threshold) / max(k.smallest_rest, 1 - gain_j)) *
                      (std::numbers::ln2 / std::numbers::ln10);
    const T gain = k.focus * select(less(threshold, gain_j), 1 + square(stretch), 1);
    // The smaller root of a quadratic equation for the J axis, which differs below and above the
    // focus.
    const auto axis = [&](const T& at_j, const T& at_m) -> T {
        const T x = at_m / gain;
        const T a = x / focus_j;
        const T is_below = less(at_j, focus_j);
        const T b = select(is_below, 1 - x, 1 + x + a);
        const T c = select(is_below, at_j, x + at_j);
        const T root = sqrt(max(b * b + 4 * a * select(is_below, c, -c), 0));
        return 2 * c / max(b + root, kTiny);
    };
    const T at = axis(j, m);
    const T slope = select(less(at, focus_j), at, 1 - at) * (at - focus_j) / (focus_j * gain);
    return {at, slope, axis(cusp.j, cusp.m)};
}

/// M where the line meets a hull that goes through (m0, j0) and is a power of J.
template <class T>
T hull(const T& axis, const T& slope, const T& power, const T& j0, const T& m0,
       const T& reference) {
    const T s = reference * pow(max(axis, 0) / max(reference, kTiny), power);
    return s * m0 / max(j0 - slope * m0, kTiny);
}

/// M where the line meets the display's hull, rounded at the cusp.
template <class T>
T boundary(const Constants& k, const Line<T>& line, const Cusp<T>& cusp) {
    const T lower = hull<T>(line.axis, line.slope, k.lower_power, cusp.j, cusp.m, line.cusp_axis);
    const T upper = hull<T>(1 - line.axis, -line.slope, cusp.inverse_gamma, 1 - cusp.j, cusp.m,
                            1 - line.cusp_axis);
    const T width = 0.12 * cusp.m;
    const T w = max(width - abs(lower - upper), 0) / width;
    return min(lower, upper) - w * w * w * width / 6;
}

// ---------------------------------------------------------------------------------------------
// Tables over the hue

constexpr std::size_t kTableSize = 360;

/// Corners of the RGB gamut in the order of their hue: R Y G C B M.
constexpr std::array<Vector3, 6> kCorners = {
    {{1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {0, 1, 1}, {0, 0, 1}, {1, 0, 1}}};

Vector3 scaled(const Vector3& v, double factor) {
    return {factor * v[0], factor * v[1], factor * v[2]};
}

/// Hues of the corners of a display, in degrees.
std::array<double, 6> corner_hues(const Cones& display, double peak) {
    std::array<double, 6> hues{};
    for (std::size_t i = 0; i < 6; ++i)
        hues[i] = degrees_of(aab_of(display, scaled(kCorners[i], peak)));
    return hues;
}

/// Index of the smallest hue.
std::size_t first_corner(const std::array<double, 6>& hues) {
    return static_cast<std::size_t>(std::min_element(hues.begin(), hues.end()) - hues.begin());
}

struct Interval {
    double lo, hi;
};

/// Halves the interval until it is at most `tolerance` long; is_low tells where lo moves up.
template <class Predicate>
Interval bisect(Interval in, double tolerance, const Predicate& is_low) {
    while (in.hi - in.lo > tolerance) {
        const double middle = (in.lo + in.hi) / 2;
        (is_low(middle) ? in.lo : in.hi) = middle;
    }
    return in;
}

/// Widens [0, step] upwards by steps while is_low(hi) and hi < highest.
template <class Predicate>
Interval bracket(double step, double highest, const Predicate& is_low) {
    Interval in{0, step};
    while (is_low(in.hi) && in.hi < highest)
        in = {in.hi, in.hi + step};
    return in;
}

class Tables {
  public:
    Tables(const Constants& constants, const Primaries& limiting)
        : k_(constants), display_(limiting) {
        find_corners();
        make_hues();
        make_cusps();
    }

    /// Largest M in AP1 at the peak's J, over the hue in turns.
    [[nodiscard]] std::shared_ptr<const Table> reach() const {
        Table table;
        for (std::size_t i = 0; i < kTableSize; ++i) {
            const double h = static_cast<double>(i) * (std::numbers::pi / 180);
            const auto is_inside = [&](double m) {
                const Vector3 rgb = rgb_of(ap1_, 1, m / k_.unit, std::cos(h), std::sin(h));
                return *std::min_element(rgb.begin(), rgb.end()) >= 0;
            };
            // The tolerance is in the standard's units.
            table.samples.push_back(bisect(bracket(50, 1300, is_inside), 1e-2, is_inside).hi /
                                    k_.unit);
        }
        table.samples.push_back(table.samples.front());
        return std::make_shared<const Table>(std::move(table));
    }

    /// J, M and 1/gamma of the cusp, over the hue in turns.
    [[nodiscard]] std::array<std::shared_ptr<const Table>, 3> cusps() const {
        std::array<Table, 3> tables;
        for (std::size_t i = 0; i < kTableSize; ++i) {
            const Cusp<double>& cusp = cusps_[i];
            const std::array<double, 3> column = {cusp.j, cusp.m, 1 / gamma_at(i)};
            for (std::size_t c = 0; c < 3; ++c) {
                tables[c].samples.push_back(column[c]);
                tables[c].positions.push_back(hues_[i] / 360);
            }
        }
        std::array<std::shared_ptr<const Table>, 3> shared;
        for (std::size_t c = 0; c < 3; ++c) {
            tables[c].samples.push_back(tables[c].samples.front());
            tables[c].positions.push_back(1 + hues_.front() / 360);
            shared[c] = std::make_shared<const Table>(std::move(tables[c]));
        }
        return shared;
    }

  private:
    [[nodiscard]] double j_of(const Vector3& aab) const {
        return std::pow(std::max(aab[0], 0.0) / k_.achromatic, kLightnessPower);
    }

    [[nodiscard]] Vector3 rgb_of(const Cones& cones, double j, double m, double cosine,
                                 double sine) const {
        const double achromatic = k_.achromatic * std::pow(std::max(j, 0.0), 1 / kLightnessPower);
        return multiply(cones.to_rgb,
                        cones_of<double>({achromatic, m * k_.unit * cosine, m * k_.unit * sine}));
    }

    /// The display's corners from the smallest hue on.
    void find_corners() {
        const std::array<double, 6> hues = corner_hues(display_, k_.peak);
        const std::size_t first = first_corner(hues);
        for (std::size_t i = 0; i < 6; ++i) {
            corners_[i] = scaled(kCorners[(first + i) % 6], k_.peak);
            corner_hues_[i] = hues[(first + i) % 6];
        }
    }

    /// Hues of AP1's corners where they are as bright as the peak.
    [[nodiscard]] double reach_hue(const Vector3& corner) const {
        const Interval found = bisect({0, k_.input_limit}, 1e-3, [&](double factor) {
            return aab_of(ap1_, scaled(corner, factor))[0] < k_.achromatic;
        });
        return degrees_of(aab_of(ap1_, scaled(corner, found.hi)));
    }

    /// Hues of the cusp table: evenly between the corners' hues, which are met exactly.
    void make_hues() {
        std::vector<double> stops(corner_hues_.begin(), corner_hues_.end());
        for (const Vector3& corner : kCorners)
            stops.push_back(reach_hue(corner));
        std::sort(stops.begin(), stops.end());
        stops.erase(std::unique(stops.begin(), stops.end()), stops.end());

        std::vector<int> index;  // of the entry at each stop
        constexpr int kLast = static_cast<int>(kTableSize) - 1;
        for (const double hue : stops) {
            const std::size_t n = index.size();
            const int lowest = n == 0 ? (hue == 0 ? 0 : 1) : index[n - 1];
            int at = std::clamp(static_cast<int>(std::lround(hue)), lowest, kLast);
            if (n > 0 && at == index[n - 1]) {
                if (n > 1 && index[n - 2] != index[n - 1] - 1) {
                    --index[n - 1];
                } else {
                    ++at;
                }
            }
            index.push_back(std::min(at, kLast));
        }
        index.push_back(static_cast<int>(kTableSize));
        stops.push_back(360);
        int begin = 0;
        double lower = 0;
        for (std::size_t i = 0; i < stops.size(); ++i) {
            const int count = index[i] - begin;
            for (int step = 0; step < count; ++step)
                hues_.push_back(lower + step * (stops[i] - lower) / count);
            begin = index[i];
            lower = stops[i];
        }
    }

    void make_cusps() {
        for (const double hue : hues_) {
            // The edge of the RGB gamut around this hue; the circle of corners is extended by one
            // on each side.
            const auto next = static_cast<std::size_t>(
                std::upper_bound(corner_hues_.begin(), corner_hues_.end(), hue) -
                corner_hues_.begin());
            const std::size_t before = next == 0 ? 5 : next - 1;
            const double lower = next == 0 ? corner_hues_[5] - 360 : corner_hues_[before];
            const double upper = next == 6 ? corner_hues_[0] + 360 : corner_hues_[next];
            const Vector3& from = corners_[before];
            const Vector3& to = corners_[next % 6];
            const auto at = [&](double t) {
                return aab_of(display_,
                              {from[0] + t * (to[0] - from[0]), from[1] + t * (to[1] - from[1]),
                               from[2] + t * (to[2] - from[2])});
            };
            const auto is_low = [&](double t) {
                const double h = degrees_of(at(t));
                return h >= lower && (h >= upper || h <= hue);
            };
            double t = 0;
            if (hue != lower) {
                const Interval found = bisect({0, 1}, 1e-7, is_low);
                t = (found.lo + found.hi) / 2;
            }
            const Vector3 aab = at(t);
            constexpr double kRounding = 1 + 0.27 * 0.12;  // compensates for the smoothing
            cusps_.push_back({j_of(aab), kRounding * std::hypot(aab[1], aab[2]) / k_.unit, 1});
        }
    }

    /// The smallest power with which the upper hull is outside of the display at five heights.
    [[nodiscard]] double gamma_at(std::size_t i) const {
        Cusp<double> cusp = cusps_[i];
        const double h = hues_[i] * (std::numbers::pi / 180);
        const double cosine = std::cos(h);
        const double sine = std::sin(h);
        std::array<Line<double>, 5> lines{};
        constexpr std::array<double, 5> kHeights = {0.01, 0.1, 0.5, 0.8, 0.99};
        for (std::size_t n = 0; n < lines.size(); ++n) {
            const double j = cusp.j + (1 - cusp.j) * kHeights[n];
            lines[n] = line_through(k_, j, cusp.m, j, cusp);
        }
        const auto is_low = [&](double gamma) {
            cusp.inverse_gamma = 1 / gamma;
            return std::any_of(lines.begin(), lines.end(), [&](const Line<double>& line) {
                const double m = boundary(k_, line, cusp);
                const Vector3 rgb = rgb_of(display_, line.axis + line.slope * m, m, cosine, sine);
                return !(*std::max_element(rgb.begin(), rgb.end()) > k_.peak);
            });
        };
        return bisect(bracket(0.4, 5, is_low), 1e-5, is_low).hi;
    }

    const Constants& k_;
    Cones display_;
    Cones ap1_{kAP1};
    std::array<Vector3, 6> corners_{};
    std::array<double, 6> corner_hues_{};
    std::vector<double> hues_;
    std::vector<Cusp<double>> cusps_;
};

// ---------------------------------------------------------------------------------------------
// Pixels

/// A hue as pixels use it.
struct Hue {
    Expr m;  // of the color: what cosine and sine were divided by
    Expr cosine;
    Expr sine;
    Expr norm;   // of chroma
    Expr reach;  // largest M in AP1 at the peak's J
    Cusp<Expr> cusp;
};

/// Compresses [0, limit] towards 0 and leaves what is above: the positive root y of
/// y^2 - (scale x - slope) y = scale knee x.
Expr toe(const Expr& x, const Expr& limit, const Expr& slope, const Expr& knee) {
    const Expr scale = named("scale", (limit + slope) / (limit + knee));
    const Expr p = named("p", scale * x - slope);
    const Expr q = named("q", knee * scale * x);
    const Expr twice = named("twice_root", abs(p) + sqrt(max(square(p) + 4 * q, 0)));
    const Expr root = select(less(p, 0), 2 * q / max(twice, kTiny), 0.5 * twice);
    return select(less(limit, x), x, root);
}

/// Inverse of toe(), which does not reach -knee: values below have no inverse.
Expr toe_inverse(const Expr& y, const Expr& limit, const Expr& slope, const Expr& knee) {
    const Expr scale = (limit + slope) / (limit + knee);
    return select(less(limit, y), y, y * (y + slope) / (scale * max(y + knee, 1e-9)));
}

class OutputTransform {
  public:
    OutputTransform(double nits, const Primaries& limiting)
        : tone_(nits), k_(nits, tone_), display_(limiting) {
        const Tables tables(k_, limiting);
        reach_ = tables.reach();
        cusps_ = tables.cusps();
    }

    [[nodiscard]] OutputTransform with_new_tables() const {
        OutputTransform copy = *this;
        for (auto* table : {&copy.reach_, &copy.cusps_[0], &copy.cusps_[1], &copy.cusps_[2]})
            *table = std::make_shared<const Table>(**table);
        return copy;
    }

    [[nodiscard]] const Constants& constants() const { return k_; }

    /// AP1 limited to the input's range -> the display's RGB, not limited.
    [[nodiscard]] CrossTalkStage forward() const {
        // The standard starts with the model of AP0, after a matrix from AP1. That equals the model
        // of AP1, because both have the same white.
        std::array<Expr, 3> cones = transform<Expr>(ap1_.from_rgb, inputs());
        for (Expr& x : cones)
            x = cone_response(x);
        return {rendered(cones)};
    }

    /// forward() in the axes of a 3D LUT. Gray plus a small multiple of the distances from it: the
    /// largest axis, HSV's value, is nearly the achromatic response, which tone scale and hull
    /// depend on.
    [[nodiscard]] HueStructure structure() const {
        const Matrix3 axes = hue_axes();
        HueStructure result = {{MatrixStage{ap1_.from_rgb},
                                curve_stage(cone_response(Expr::input())), MatrixStage{axes}},
                               {rendered(transform<Expr>(inverse(axes), inputs()))},
                               k_.peak};
        // The hull has edges at the hues of the display's corners, the compression at AP1's.
        for (const Vector3& corner : kCorners) {
            result.bends.push_back(multiply(axes, responses_of(display_, scaled(corner, k_.peak))));
            result.bends.push_back(multiply(axes, responses_of(ap1_, corner)));
        }
        return result;
    }

    /// The display's RGB, limited to its range, to AP1, not limited.
    [[nodiscard]] CrossTalkStage backward() const {
        const bool has_negatives = display_.has_negatives();
        std::array<Expr, 3> cones = transform<Expr>(display_.from_rgb, inputs());
        for (Expr& x : cones)
            x = has_negatives ? signed_cone_response(x) : cone_response(x);
        Opponent<Expr> shown = opponent_of(cones);
        shown.achromatic = max(shown.achromatic, 0);
        const Hue hue = hue_of(shown);
        const Expr shown_j =
            named("shown_j", pow(shown.achromatic / k_.achromatic, kLightnessPower));

        // The lines depend on a J that is not known yet. The standard estimates it with the J that
        // is known.
        const Expr threshold = named("threshold", hue.cusp.j + 0.3 * (1 - hue.cusp.j));
        const Expr first_j =
            named("first_j", std::get<0>(move_along_line(shown_j, hue.m, shown_j, hue, true)));
        const Expr gain_j =
            named("gain_j", select(less_equal(shown_j, threshold), shown_j, first_j));
        const auto [j, m] = move_along_line(shown_j, hue.m, gain_j, hue, true);

        const Expr achromatic = named("achromatic", achromatic_of(j));
        const Expr luminance =
            named("luminance", tone_.inverse_of(cone_of_response(achromatic) / kLuminanceLevel));
        const Expr scene = named("scene_achromatic", achromatic_of_luminance(luminance));
        const Expr scene_m =
            expand_chroma(m, j, achromatic, hue) * (scene / max(achromatic, 1e-30));
        return {rgb_of(ap1_, scene, scene_m, hue)};
    }

  private:
    /// The display's RGB, not limited, of cone responses to light.
    [[nodiscard]] std::array<Expr, 3> rendered(const std::array<Expr, 3>& responses) const {
        const Opponent<Expr> scene = opponent_of(responses);
        const Hue hue = hue_of(scene);

        const Expr luminance =
            named("luminance", cone_of_response(scene.achromatic) / kLuminanceLevel);
        const Expr achromatic = named("achromatic", achromatic_of_luminance(tone_(luminance)));
        const Expr j = named("lightness", pow(achromatic / k_.achromatic, kLightnessPower));
        // M goes with (J/J')^(1/kLightnessPower): the ratio of the achromatic responses.
        const Expr m =
            named("chroma", compress_chroma(hue.m * (achromatic / max(scene.achromatic, 1e-30)), j,
                                            achromatic, hue));

        const auto [moved_j, moved_m] = move_along_line(j, m, j, hue, false);
        return rgb_of(display_, achromatic_of(moved_j), moved_m, hue);
    }

    static Vector3 responses_of(const Cones& cones, const Vector3& rgb) {
        Vector3 response = transform(cones.from_rgb, rgb);
        for (double& x : response)
            x = signed_cone_response(x);
        return response;
    }

    /// Cone responses -> the axes of structure(): rows of sum 1.
    [[nodiscard]] Matrix3 hue_axes() const {
        constexpr double kShare = 0.05;
        // The axes lie along the responses to AP1's primaries, whose sum is gray. A response is
        // nearly a power of the channel, so the directions hardly depend on brightness.
        Matrix3 primaries{};
        for (std::size_t c = 0; c < 3; ++c) {
            const Vector3 response = responses_of(ap1_, scaled(kCorners[2 * c], 0.1));
            for (std::size_t i = 0; i < 3; ++i)
                primaries[i][c] = response[i];
        }
        const Vector3 gains = multiply(inverse(primaries), Vector3{1, 1, 1});
        for (auto& row : primaries) {
            for (std::size_t c = 0; c < 3; ++c)
                row[c] *= gains[c];
        }
        Matrix3 axes = inverse(primaries);
        for (auto& row : axes) {
            for (std::size_t c = 0; c < 3; ++c)
                row[c] = kShare * row[c] + (1 - kShare) * kOpponent[0][c];
        }
        return axes;
    }

    static std::array<Expr, 3> inputs() { return {Expr::input(0), Expr::input(1), Expr::input(2)}; }

    [[nodiscard]] Expr achromatic_of(const Expr& j) const {
        return named("response", k_.achromatic * pow(max(j, 0), 1 / kLightnessPower));
    }

    [[nodiscard]] std::array<Expr, 3> rgb_of(const Cones& cones, const Expr& achromatic,
                                             const Expr& m, const Hue& hue) const {
        const Expr length = named("length_ab", k_.unit * m);
        return transform<Expr>(
            cones.to_rgb, cones_of<Expr>({achromatic, length * hue.cosine, length * hue.sine}));
    }

    [[nodiscard]] Hue hue_of(const Opponent<Expr>& color) const {
        const Expr a = named("a", color.a / k_.unit);
        const Expr b = named("b", color.b / k_.unit);
        const Expr m = named("chroma", sqrt(square(a) + square(b)));
        const Expr divisor = max(m, kTiny);
        const Expr c = named("cos_hue", a / divisor);
        const Expr s = named("sin_hue", b / divisor);
        // cos 2h = 2 c^2 - 1, cos 3h = 4 c^3 - 3 c, sin 2h = 2 s c, sin 3h = s (4 c^2 - 1)
        const Expr polynomial =
            77.12896 - 16.46899 +
            c * (11.34072 - 3 * 7.88380 + c * (2 * 16.46899 + c * (4 * 7.88380))) +
            s * (14.66441 - 9.19364 + c * (-2 * 6.37224 + c * (4 * 9.19364)));
        const Expr angle = named("angle", atan2(b, a) * (0.5 / std::numbers::pi));
        const Expr turns = named("turns", select(less(angle, 0), angle + 1, angle));
        return {
            m,
            c,
            s,
            named("chroma_norm", k_.chroma_scale * polynomial),
            named("reach", lookup(reach_, turns)),
            {named("cusp_j", lookup(cusps_[0], turns)), named("cusp_m", lookup(cusps_[1], turns)),
             named("inverse_gamma", lookup(cusps_[2], turns))}};
    }

    /// Inputs of the chroma compression.
    struct ChromaToes {
        Expr limit;
        Expr expand_slope, expand_knee;
        Expr compress_slope, compress_knee;
    };

    [[nodiscard]] ChromaToes chroma_toes(const Expr& j, const Expr& achromatic,
                                         const Hue& hue) const {
        const auto length = [](const Expr& x, const Expr& y) {
            return sqrt(square(x) + square(y));
        };
        const Expr rest = named("rest", max(1 - j, 0));
        const Expr expand_knee = named("expand_knee", max(sqrt(square(j) + k_.threshold), 0.001));
        const Expr compress_knee = named("compress_knee", max(rest, 0.001));
        return {named("limit", achromatic / k_.achromatic * hue.reach / hue.norm),
                named("expand_slope", length(k_.saturation * rest, expand_knee)), expand_knee,
                named("compress_slope", length(k_.compression * j, compress_knee)), compress_knee};
    }

    [[nodiscard]] Expr compress_chroma(const Expr& m, const Expr& j, const Expr& achromatic,
                                       const Hue& hue) const {
        const ChromaToes t = chroma_toes(j, achromatic, hue);
        const Expr x = m / hue.norm;
        const Expr expanded = named(
            "expanded", t.limit - toe(t.limit - x, t.limit - 0.001, t.expand_slope, t.expand_knee));
        return toe(expanded, t.limit, t.compress_slope, t.compress_knee) * hue.norm;
    }

    [[nodiscard]] Expr expand_chroma(const Expr& m, const Expr& j, const Expr& achromatic,
                                     const Hue& hue) const {
        const ChromaToes t = chroma_toes(j, achromatic, hue);
        const Expr x = toe_inverse(m / hue.norm, t.limit, t.compress_slope, t.compress_knee);
        const Expr compressed =
            t.limit - toe_inverse(t.limit - x, t.limit - 0.001, t.expand_slope, t.expand_knee);
        return compressed * hue.norm;
    }

    /// J and M moved into the display's hull along a line, or the inverse. Above a fraction of the
    /// hull's M the result is start + room o/(room + o), where o is M minus the start. The room is
    /// chosen so that AP1's largest M lies on the hull.
    [[nodiscard]] std::tuple<Expr, Expr> move_along_line(const Expr& j, const Expr& m,
                                                         const Expr& gain_j, const Hue& hue,
                                                         bool is_inverse) const {
        const Line<Expr> line = line_through<Expr>(k_, j, m, gain_j, hue.cusp);
        const Expr edge = named("edge", boundary(k_, line, hue.cusp));
        const Expr reach = named("reach_chroma", hull<Expr>(line.axis, line.slope,
                                                            1 / kLightnessPower, 1, hue.reach, 1));
        const Expr start = named("start", max(edge / max(reach, kTiny), 0.75) * edge);
        const Expr over = named("over", max(m - start, 0));
        // beyond = room over/(room + over), room = n/(reach - edge)
        const Expr n = named("n", (reach - start) * (edge - start));
        const Expr d = (reach - edge) * over;
        Expr beyond = 0;
        if (is_inverse) {
            // Infinite where over equals the room; 10 is far outside AP1.
            const Expr before =
                select(less(d, n), n * over / max(n - d, 1e-30), n * over / max(d, 1e-30));
            beyond = min(before, 10);
        } else {
            beyond = named("beyond", n * over / max(n + d, 1e-30));
        }
        // A hull larger than AP1 moves no color.
        const Expr moved = named("moved", select(less(edge, reach), min(m, start) + beyond, m));
        const Expr is_chromatic = named("is_chromatic", less(0, edge) * less_equal(j, 1));
        return {select(is_chromatic, line.axis + line.slope * moved, j),
                select(is_chromatic, moved, 0)};
    }

    ToneScale tone_;
    Constants k_;
    Cones display_;
    Cones ap1_{kAP1};
    std::shared_ptr<const Table> reach_;
    std::array<std::shared_ptr<const Table>, 3> cusps_;
};

// ---------------------------------------------------------------------------------------------
// Parameters

/// Eight numbers with blanks or commas between them.
std::optional<std::array<double, 8>> read_chromaticities(std::string_view text) {
    const auto is_blank = [](char c) { return c == ' ' || c == ',' || c == '\t'; };
    std::array<double, 8> values{};
    const char* at = text.data();
    const char* end = at + text.size();
    const auto skip_blanks = [&] { at = std::find_if_not(at, end, is_blank); };
    for (double& value : values) {
        skip_blanks();
        const auto [next, error] = std::from_chars(at, end, value);
        if (error != std::errc() || (next != end && !is_blank(*next)) || !std::isfinite(value))
            return std::nullopt;
        at = next;
    }
    skip_blanks();
    if (at != end) return std::nullopt;
    return values;
}

/// True if the triangle is counterclockwise in xy, above y = 0, and contains white.
bool is_triangle_around_white(const Primaries& p) {
    const auto area = [](Chromaticity a, Chromaticity b, Chromaticity c) {
        return (b.x - a.x) * (c.y - a.y) - (c.x - a.x) * (b.y - a.y);
    };
    constexpr double kSmallest = 1e-4;
    const double lowest = std::min({p.red.y, p.green.y, p.blue.y});
    return lowest > kSmallest && area(p.red, p.green, p.whitepoint) > kSmallest &&
           area(p.green, p.blue, p.whitepoint) > kSmallest &&
           area(p.blue, p.red, p.whitepoint) > kSmallest;
}

/// True if R Y G C B M go around the circle of hues once.
bool has_hues_in_order(const Primaries& p, double peak) {
    std::array<double, 6> hues = corner_hues(Cones(p), peak);
    std::rotate(hues.begin(), hues.begin() + static_cast<std::ptrdiff_t>(first_corner(hues)),
                hues.end());
    return std::adjacent_find(hues.begin(), hues.end(), std::greater_equal<>()) == hues.end();
}

Primaries primaries_of(const Params& params) {
    const std::string& text = params.text("primaries");
    if (text.empty()) return limiting_primaries(params, kRec709);
    const auto xy = read_chromaticities(text);
    if (!xy) {
        throw Error("primaries is \"" + text +
                    "\"; expected eight numbers, x and y of red, green, blue and white: " +
                    "0.64 0.33 0.3 0.6 0.15 0.06 0.3127 0.329");
    }
    const auto& v = *xy;
    const Primaries p = {"custom", {v[0], v[1]}, {v[2], v[3]}, {v[4], v[5]}, {v[6], v[7]}};
    if (!is_triangle_around_white(p) || !has_hues_in_order(p, params.number("peak") / 100)) {
        throw Error("primaries is \"" + text +
                    "\"; expected x and y of red, green, blue and white, y above 0 and white "
                    "inside the triangle of the others");
    }
    return p;
}

/// Computing the tables takes ten milliseconds, so it is done once per display. The tables are new
/// objects each time, because expressions of one table would count as the same view for two
/// displays.
OutputTransform transform_of(const Params& params) {
    using Key = std::pair<double, Primaries>;
    static BoundedCache<Key, OutputTransform> cache(16);
    const Key key = {params.number("peak"), primaries_of(params)};
    return cache.get(key, [&] { return OutputTransform(key.first, key.second); })
        ->with_new_tables();
}

constexpr double kLowestPeak = 100;
constexpr double kHighestPeak = 10000;

}  // namespace

std::vector<Operator> define_aces_20() {
    Operator op;
    op.id = "aces_20";
    op.title = "ACES 2.0";
    op.view = "ACES 2.0";
    op.character =
        "the Academy's rendering of 2024: film-like contrast, highlights fade to white and keep "
        "their hue, the same look on displays of any peak; shows mid gray 0.18 at 0.10";
    op.source =
        "Academy of Motion Picture Arts and Sciences, ACES 2: aces-core, "
        "Lib.Academy.OutputTransform, Lib.Academy.Tonescale; OpenColorIO 2.4.2, ACES2";
    op.license =
        "Academy license (aces-core), BSD-3-Clause (OpenColorIO); none of their code is used";
    op.negatives = "clamped at 0 in AP1, before the first non-linear step";
    op.dialects = "ACES";
    op.working = kAP1;
    op.bounds = {
        .simd = 3e-5,
        .simd_goal = 2.4e-5,
        .lut3d = 0.2,
        .lut3d_hdr = 0.4,
        .reason =
            "simd: twice as fast as with 1e-6, which needs double precision throughout; 3D LUT: "
            "the gamut compression bends in every direction, and jumps near the edge of AP1"};
    op.parameters = fixed_parameters({
        // The tone scale is designed for 100 cd/m2 and above; below 49.8 its compression reverses.
        display_parameter(number_parameter("peak", "cd/m2", 100, kLowestPeak, kHighestPeak,
                                           "peak luminance of the display"),
                          [](const DisplayFacts& display) {
                              return shortest(std::clamp(display.peak, kLowestPeak, kHighestPeak));
                          }),
        // For SDR displays the standard only has Rec.709 and P3 variants.
        display_parameter(limit_parameter({"rec709", "p3d65", "rec2020"}, "rec709"),
                          [](const DisplayFacts& display) -> std::string {
                              if (display.primaries == kRec709) return "rec709";
                              const bool is_p3 = display.primaries == kP3D65 || !display.is_hdr;
                              return is_p3 ? "p3d65" : "rec2020";
                          }),
        text_parameter("primaries",
                       "any other display: eight numbers, x and y of red, green, blue and white "
                       "(empty: limit decides)"),
    });
    op.warnings = {"a display clips a peak above its own: SDR displays show up to 100 cd/m2",
                   "primaries with a white other than D65 are adapted to the display's white; the "
                   "standard's D60 variants, which are not adapted, are not included"};
    op.output_primaries = primaries_of;
    op.peak = [](const Params& p) { return p.number("peak") / 100; };
    op.build = [](const Params& p) -> Pipeline {
        const OutputTransform output = transform_of(p);
        const Constants& k = output.constants();
        const CrossTalkStage forward = output.forward();
        declare_hue_structure(forward, output.structure());
        return {ClampStage{0, k.input_limit}, forward, ClampStage{0, k.peak}};
    };
    op.build_inverse = [](const Params& p) -> Pipeline {
        const OutputTransform output = transform_of(p);
        const Constants& k = output.constants();
        return {ClampStage{0, k.peak}, output.backward(), ClampStage{0, k.input_limit}};
    };
    return {op};
}

TONEWRIGHT_NAMESPACE_END
