// SPDX-License-Identifier: Apache-2.0
#include "ocio/aces_20/hue_cube.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <functional>
#include <string>
#include <utility>

#include "base/bounded_cache.h"
#include "base/number_cache.h"
#include "base/random.h"
#include "lut/cube_solver.h"
#include "lut/fit_key.h"
#include "lut/in_parallel.h"
#include "lut/least_squares.h"
#include "lut/picture_color.h"
#include "tonewright/engine.h"
#include "tonewright/view.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

constexpr std::size_t kEntries = 4096;
/// Lowest stop; darker values count as black.
constexpr double kBlack = -24;
/// Darker values are nearly linear on the value axis, for all hues.
constexpr double kToe = 0.005;
/// Version of fit_hue_cube(): change it if the nodes of the same problem change.
constexpr int kVersion = 5;
/// Power of the codes in the third channel and in the fit: that of Rec.1886, the steepest near
/// black.
constexpr double kCodePower = 1 / 2.4;
/// Share of the samples that are drawn for the cells; the others are colors of pictures and tests.
constexpr double kWeightOfCells = 0.1;
/// Share of the most colorful saturation: nodes between it and gray take part in the fit.
constexpr double kBeyondFringe = 1.02;
/// Range of the nodes above the display's peak, in code values.
constexpr double kLargestCode = 1.06;
/// Ranges of the ratios x and y in the nodes; grays are in the middle.
constexpr double kLowestX = -0.1;
constexpr double kLowestY = 0.4;
constexpr double kRatioRange = 0.7;
/// Ratios of a neutral color.
constexpr double kNeutralX = 0.2;
constexpr double kNeutralY = 0.6;

/// OpenColorIO's RGB_TO_HSV for positive channels.
Vector3 hsv_of(const Vector3& rgb) {
    const auto& [r, g, b] = rgb;
    const double hi = std::max({r, g, b});
    const double lo = std::min({r, g, b});
    const double chroma = hi - lo;
    if (!(chroma > 0)) return {0, 0, hi};
    const double sixths = r == hi   ? (g - b) / chroma
                          : g == hi ? 2 + (b - r) / chroma
                                    : 4 + (r - g) / chroma;
    return {sixths < 0 ? sixths / 6 + 1 : sixths / 6, chroma / hi, hi};
}

Vector3 rgb_of(const Vector3& hsv) {
    const double sixths = 6 * hsv[0];
    const Vector3 pure = {std::fabs(sixths - 3) - 1, 2 - std::fabs(sixths - 2),
                          2 - std::fabs(sixths - 4)};
    Vector3 rgb{};
    for (std::size_t c = 0; c < 3; ++c)
        rgb[c] = hsv[2] * (1 - hsv[1] * (1 - std::clamp(pure[c], 0.0, 1.0)));
    return rgb;
}

/// Linear between points of rising x; constant beyond the ends.
class Polyline {
  public:
    Polyline() = default;
    Polyline(std::vector<double> x, std::vector<double> y) : x_(std::move(x)), y_(std::move(y)) {}

    [[nodiscard]] double operator()(double x) const {
        if (x <= x_.front()) return y_.front();
        if (x >= x_.back()) return y_.back();
        const auto next =
            static_cast<std::size_t>(std::upper_bound(x_.begin(), x_.end(), x) - x_.begin());
        const double t = (x - x_[next - 1]) / (x_[next] - x_[next - 1]);
        return y_[next - 1] + t * (y_[next] - y_[next - 1]);
    }
    [[nodiscard]] Polyline inverse() const { return {y_, x_}; }
    [[nodiscard]] double lowest() const { return *std::min_element(y_.begin(), y_.end()); }
    [[nodiscard]] double highest() const { return *std::max_element(y_.begin(), y_.end()); }

  private:
    std::vector<double> x_;
    std::vector<double> y_;
};

/// Extends the points of a function of the hue, in turns, around the circle.
Polyline around(std::vector<std::pair<double, double>> points) {
    std::sort(points.begin(), points.end());
    std::vector<double> x = {points.back().first - 1};
    std::vector<double> y = {points.back().second};
    for (const auto& [hue, value] : points) {
        if (hue - x.back() < 1e-9) continue;
        x.push_back(hue);
        y.push_back(value);
    }
    x.push_back(points.front().first + 1);
    y.push_back(points.front().second);
    return {std::move(x), std::move(y)};
}

/// `count` positions in [lo, hi], spaced by a density.
/// @param fixed  rising, from lo to hi: positions that must be included
std::vector<double> spaced(std::size_t count, const std::vector<double>& fixed,
                           const auto& density) {
    constexpr std::size_t kSteps = 8000;
    const double lo = fixed.front();
    const double hi = fixed.back();
    std::vector<double> at(kSteps + 1);
    std::vector<double> sum(kSteps + 1);
    for (std::size_t i = 0; i <= kSteps; ++i) {
        at[i] = lo + (hi - lo) * static_cast<double>(i) / kSteps;
        if (i > 0) sum[i] = sum[i - 1] + density((at[i] + at[i - 1]) / 2);
    }
    const Polyline to_sum(at, sum);
    const Polyline to_place = to_sum.inverse();
    // Adds positions one by one where the steps are longest.
    std::vector<std::size_t> steps(fixed.size() - 1, 1);
    const auto length = [&](std::size_t k) {
        return (to_sum(fixed[k + 1]) - to_sum(fixed[k])) / static_cast<double>(steps[k]);
    };
    for (std::size_t used = steps.size(); used + 1 < count; ++used) {
        std::size_t longest = 0;
        for (std::size_t k = 1; k < steps.size(); ++k) {
            if (length(k) > length(longest)) longest = k;
        }
        ++steps[longest];
    }
    std::vector<double> places;
    for (std::size_t k = 0; k < steps.size(); ++k) {
        for (std::size_t i = 0; i < steps[k]; ++i) {
            places.push_back(i == 0
                                 ? fixed[k]
                                 : to_place(to_sum(fixed[k]) + length(k) * static_cast<double>(i)));
        }
    }
    places.push_back(hi);
    return places;
}

/// Makes the values rising, each at an entry of a table over [0, 1].
std::vector<double> at_entries(std::vector<double> places) {
    constexpr double kLast = kEntries - 1;
    for (double& x : places)
        x = std::round(x * kLast) / kLast;
    std::sort(places.begin(), places.end());
    places.erase(std::unique(places.begin(), places.end()), places.end());
    return places;
}

/// Position in [0, 1] of each node's value.
Polyline place_of(const std::vector<double>& nodes) {
    std::vector<double> places(nodes.size());
    for (std::size_t i = 0; i < nodes.size(); ++i)
        places[i] = static_cast<double>(i) / static_cast<double>(nodes.size() - 1);
    return {nodes, std::move(places)};
}

template <class F>
Table3 make_table(const F& f) {
    Table3 table;
    table.reserve(3 * kEntries);
    for (std::size_t i = 0; i < kEntries; ++i) {
        for (const double x : f(static_cast<double>(i) / (kEntries - 1)))
            table.push_back(static_cast<float>(x));
    }
    return table;
}

/// Interpolates like OpenColorIO.
Vector3 look_up(const Table3& table, const Vector3& x) {
    Vector3 y{};
    for (std::size_t c = 0; c < 3; ++c) {
        const double position = std::clamp(x[c], 0.0, 1.0) * (kEntries - 1);
        const auto i = std::min(static_cast<std::size_t>(position), kEntries - 2);
        const double t = position - static_cast<double>(i);
        y[c] = (1 - t) * static_cast<double>(table[3 * i + c]) +
               t * static_cast<double>(table[3 * i + 3 + c]);
    }
    return y;
}

Vector3 affine(const AffineStep& step, const Vector3& x) {
    Vector3 y = multiply(step.m, x);
    for (std::size_t c = 0; c < 3; ++c)
        y[c] += step.offset[c];
    return y;
}

std::vector<Vector3> through(const ReferenceEngine& engine, std::vector<Vector3> colors) {
    std::array<std::vector<double>, 3> planes;
    for (std::size_t c = 0; c < 3; ++c) {
        for (const Vector3& color : colors)
            planes[c].push_back(color[c]);
    }
    const std::array<double*, 3> at = {planes[0].data(), planes[1].data(), planes[2].data()};
    engine.run({at[0], at[1], at[2]}, at, colors.size());
    for (std::size_t i = 0; i < colors.size(); ++i)
        colors[i] = {planes[0][i], planes[1][i], planes[2][i]};
    return colors;
}

class Maker {
  public:
    Maker(const HueStructure& structure, double top, const HueCubeOptions& options)
        : structure_(structure),
          top_(top),
          options_(options),
          to_axes_(structure.to_axes),
          shown_({structure.of_axes}) {}

    HueCube run() {
        cube_.edge = options_.edge;
        find_stops();
        find_fringe();
        find_cusps();
        find_bends();
        place_nodes();
        improve_places();
        make_steps();
        make_places();
        make_behind();
        fit();
        return std::move(cube_);
    }

  private:
    /// Axes of a color, with the value in [0, 1].
    [[nodiscard]] Vector3 axes_of(const Vector3& light) const {
        Vector3 axes = to_axes_(light);
        for (double& x : axes)
            x *= cube_.gain;
        return axes;
    }

    /// Display RGB of hue, saturation and value.
    [[nodiscard]] Vector3 rgb_at(const Vector3& hsv) const {
        Vector3 axes = rgb_of(hsv);
        for (double& x : axes)
            x /= cube_.gain;
        return shown_(axes);
    }

    /// Value of a neutral color, in stops.
    void find_stops() {
        cube_.gain = 1 / to_axes_({top_, top_, top_})[0];
        constexpr int kSteps = 20000;
        std::vector<double> value;
        std::vector<double> stops;
        last_stop_ = std::log2(top_);
        for (int i = 0; i <= kSteps; ++i) {
            const double s = kBlack + (last_stop_ - kBlack) * i / kSteps;
            const double light = std::exp2(s);
            const double v = axes_of({light, light, light})[0];
            if (!value.empty() && !(v > value.back())) continue;
            value.push_back(v);
            stops.push_back(s);
        }
        stops_ = Polyline(std::move(value), std::move(stops));
        value_ = stops_.inverse();
    }

    /// Saturation of the most colorful color of each hue, with a channel at 0.
    void find_fringe() {
        constexpr std::array<Vector3, 7> kCorners = {
            {{1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {0, 1, 1}, {0, 0, 1}, {1, 0, 1}, {1, 0, 0}}};
        constexpr int kPerEdge = 96;
        std::vector<std::pair<double, double>> points;
        for (std::size_t e = 0; e < 6; ++e) {
            for (int i = 0; i < kPerEdge; ++i) {
                Vector3 light{};
                for (std::size_t c = 0; c < 3; ++c) {
                    light[c] =
                        kCorners[e][c] + i * (kCorners[e + 1][c] - kCorners[e][c]) / kPerEdge;
                }
                const Vector3 hsv = hsv_of(axes_of(light));
                points.emplace_back(hsv[0], hsv[1]);
                for (const double gain : {0x1p-10, 1.0, top_}) {
                    largest_saturation_ = std::max(
                        largest_saturation_,
                        hsv_of(axes_of({gain * light[0], gain * light[1], gain * light[2]}))[1]);
                }
            }
        }
        fringe_ = around(std::move(points));
    }

    /// Stops at which the largest channel is as far below the peak as the smallest is above 0. On
    /// the hull, that is the cusp.
    [[nodiscard]] double cusp_at(double hue, double saturation) const {
        double lo = kBlack;
        double hi = last_stop_;
        for (int i = 0; i < 40; ++i) {
            const double middle = (lo + hi) / 2;
            const Vector3 rgb = rgb_at({hue, saturation, value_(middle)});
            const double sum =
                std::max({rgb[0], rgb[1], rgb[2]}) + std::min({rgb[0], rgb[1], rgb[2]});
            (sum < structure_.peak ? lo : hi) = middle;
        }
        return lo;
    }

    void find_cusps() {
        constexpr int kHues = 720;
        // The cusp is slightly lower with less saturation: a plane for all hues.
        constexpr double kPart = 0.9;
        std::vector<std::pair<double, double>> stops(kHues);
        std::vector<double> saturation(kHues);
        std::vector<double> lower(kHues);
        in_parallel(kHues, options_.thread_count, [&](std::size_t i) {
            const double hue = static_cast<double>(i) / kHues;
            saturation[i] = fringe_(hue);
            stops[i] = {hue, cusp_at(hue, saturation[i])};
            lower[i] = cusp_at(hue, kPart * saturation[i]);
        });
        double change = 0;
        double square = 0;
        for (std::size_t i = 0; i < kHues; ++i) {
            const double s = saturation[i];
            change += (stops[i].second - lower[i]) * (1 - kPart) * s;
            square += (1 - kPart) * s * (1 - kPart) * s;
        }
        tilt_ = change / square;
        for (std::size_t i = 0; i < stops.size(); ++i)
            stops[i].second -= tilt_ * saturation[i];
        cusp_ = around(std::move(stops));
        all_cusps_ = cusp_;
        const double tilted = std::fabs(tilt_) * largest_saturation_;
        lowest_ = kBlack - cusp_.lowest() + tilted;
        whole_ = last_stop_ + tilted - cusp_.lowest() - lowest_;
        toe_ = kToe / std::exp2(cusp_.highest());
    }

    /// Builds the stages before the nodes.
    void make_steps() {
        // hue -> sum, rising: steepness hue + cusp.
        double steepest = 0;
        for (std::size_t i = 1; i < kEntries; ++i) {
            const double a = static_cast<double>(i - 1) / (kEntries - 1);
            const double b = static_cast<double>(i) / (kEntries - 1);
            steepest = std::max(steepest, (cusp_(a) - cusp_(b)) / (b - a));
        }
        const double k = 1.25 * steepest + 1;
        const double first = cusp_(0);
        std::vector<double> hue(kEntries);
        std::vector<double> sum(kEntries);
        for (std::size_t i = 0; i < kEntries; ++i) {
            hue[i] = static_cast<double>(i) / (kEntries - 1);
            sum[i] = hue[i] + (cusp_(hue[i]) - first) / k;
        }
        const Polyline sum_of(hue, sum);
        const Polyline hue_of = sum_of.inverse();
        cube_.spread = make_table([&](double x) -> Vector3 {
            return {sum_of(x), x, (stops_(x) - kBlack) / (last_stop_ - kBlack)};
        });
        cube_.back = make_table([&](double x) -> Vector3 { return {hue_of(x), x, x}; });

        // stops - tilt saturation - k sum, then + k hue - first: stops from the cusp.
        const double tilted = std::fabs(tilt_) * largest_saturation_;
        const double all = last_stop_ - kBlack;
        const double low = kBlack - k - tilted;
        const double range = last_stop_ + tilted - low;
        cube_.less_sum = {{{{1, 0, 0},
                            {0, 1 / largest_saturation_, 0},
                            {-k / range, -tilt_ / range, all / range}}},
                          {0, 0, (kBlack - low) / range}};
        cube_.plus_hue = {{{{1, 0, 0}, {0, 1, 0}, {k / whole_, 0, range / whole_}}},
                          {0, 0, (low - first - lowest_) / whole_}};
    }

    [[nodiscard]] double with_toe(double stops) const { return std::log2(std::exp2(stops) + toe_); }
    [[nodiscard]] double without_toe(double place) const {
        return std::log2(std::max(std::exp2(place) - toe_, 0x1p-40));
    }

    /// Positions that need nodes: where the stage bends.
    void find_bends() {
        std::vector<double> bends = {0, 1};
        for (int i = 1; i < 6; ++i)
            bends.push_back(i / 6.0);
        for (const Vector3& color : structure_.bends)
            bends.push_back(hsv_of(color)[0]);
        fixed_ = {at_entries(std::move(bends)),
                  {0, 1},
                  {with_toe(lowest_), with_toe(0), with_toe(lowest_ + whole_)}};
        const double cusp = with_toe(0);
        const double toe = std::log2(toe_);
        density_[0] = [](double) { return 1.0; };
        density_[1] = [](double x) { return 1 / std::sqrt(1.02 - x); };
        // Equal steps in stops above the toe and in linear below, shortest at the cusp.
        density_[2] = [=](double x) {
            return 1 + 5 * std::exp(-std::fabs(x - cusp) / 1.2) + 1.5 * std::exp((toe - x) / 2);
        };
    }

    void place_nodes() {
        const auto n = static_cast<std::size_t>(options_.edge);
        for (std::size_t axis = 0; axis < 3; ++axis)
            nodes_[axis] = spaced(n, fixed_[axis], density_[axis]);
        // Linear between the nodes, so that it adds no curvature to the stage.
        std::vector<double> cusps;
        for (const double hue : nodes_[0])
            cusps.push_back(all_cusps_(hue));
        cusp_ = Polyline(nodes_[0], std::move(cusps));
    }

    void make_places() {
        std::array<Polyline, 3> place;
        for (std::size_t axis = 0; axis < 3; ++axis)
            place[axis] = place_of(nodes_[axis]);
        cube_.place = make_table([&](double x) -> Vector3 {
            return {place[0](x), place[1](x), place[2](with_toe(lowest_ + whole_ * x))};
        });
    }

    /// Position of a color of the axes between the nodes.
    [[nodiscard]] Vector3 coordinates_of(const Vector3& axes) const {
        const auto [hue, saturation, value] = hsv_of(axes);
        return {hue, saturation / largest_saturation_,
                with_toe(stops_(value) - cusp_(hue) - tilt_ * saturation)};
    }
    [[nodiscard]] Vector3 axes_at(const Vector3& coordinates) const {
        const double hue = coordinates[0];
        const double saturation = coordinates[1] * largest_saturation_;
        const double stops = without_toe(coordinates[2]) + cusp_(hue) + tilt_ * saturation;
        Vector3 axes = rgb_of({hue, saturation, value_(std::clamp(stops, kBlack, last_stop_))});
        for (double& x : axes)
            x /= cube_.gain;
        return axes;
    }

    /// Display RGB at coordinates.
    [[nodiscard]] std::vector<Vector3> shown_at(std::vector<Vector3> coordinates) const {
        for (Vector3& place : coordinates)
            place = axes_at(place);
        return through(shown_, std::move(coordinates));
    }

    /// Nodes along one axis and the error of straight lines between them.
    struct Misses {
        std::vector<double> of_cells;  // sums of squares
        double mean = 0;
    };

    /// @param at      coordinates of colors
    /// @param wanted  their codes
    [[nodiscard]] Misses find_misses(std::size_t axis, const std::vector<Vector3>& at,
                                     const std::vector<Vector3>& wanted,
                                     const ReferenceEngine& node_to_code) const {
        const std::vector<double>& nodes = nodes_[axis];
        const auto last = static_cast<std::ptrdiff_t>(nodes.size()) - 1;
        std::vector<std::size_t> cell;
        std::vector<Vector3> below = at;
        std::vector<Vector3> above = at;
        for (std::size_t i = 0; i < at.size(); ++i) {
            const auto next = std::upper_bound(nodes.begin(), nodes.end(), at[i][axis]);
            const std::ptrdiff_t k = std::clamp<std::ptrdiff_t>(next - nodes.begin(), 1, last);
            cell.push_back(static_cast<std::size_t>(k - 1));
            below[i][axis] = nodes[cell[i]];
            above[i][axis] = nodes[cell[i] + 1];
        }
        std::vector<Vector3> between = shown_at(below);
        const std::vector<Vector3> upper = shown_at(above);
        for (std::size_t i = 0; i < at.size(); ++i) {
            const double t = (at[i][axis] - below[i][axis]) / (above[i][axis] - below[i][axis]);
            const Vector3 from = node_of(between[i]);
            const Vector3 to = node_of(upper[i]);
            for (std::size_t c = 0; c < 3; ++c)
                between[i][c] = from[c] + t * (to[c] - from[c]);
        }
        between = through(node_to_code, std::move(between));
        // Nodes beyond the most colorful color are free.
        const auto is_reached = [&](const Vector3& place) {
            return place[1] * largest_saturation_ <= kBeyondFringe * fringe_(place[0]);
        };
        Misses misses;
        misses.of_cells.resize(nodes.size() - 1);
        for (std::size_t i = 0; i < at.size(); ++i) {
            if (axis == 0 && !(is_reached(below[i]) && is_reached(above[i]))) continue;
            double miss = 0;
            for (std::size_t c = 0; c < 3; ++c)
                miss = std::max(miss, std::fabs(between[i][c] - wanted[i][c]));
            misses.of_cells[cell[i]] += miss * miss;
            misses.mean += miss * miss / static_cast<double>(misses.of_cells.size());
        }
        return misses;
    }

    /// Places nodes where straight lines between them have the largest error. The error of a line
    /// grows with the square of a cell's width. So the sum of squares over all cells is least if
    /// the sum of each cell, divided by the fifth power of its width, is the fifth power of the
    /// density.
    void improve_places() {
        constexpr std::size_t kMostColors = 15000;
        constexpr int kRounds = 4;
        /// Lower limit, relative to the mean, so that no cell becomes wide because it has few
        /// colors. Few colors are as dark as the first cells of the value axis.
        constexpr Vector3 kLeast = {1e-3, 1e-3, 0.2};
        const std::size_t count = std::min(kMostColors, sample_count() / 4);
        std::vector<Vector3> light;
        SampleRandom random(7);
        for (std::size_t i = 0; i < count; ++i)
            light.push_back(draw_color(i, random));
        const std::vector<Vector3> axes = through(to_axes_, std::move(light));
        const ReferenceEngine node_to_code(forward());
        const std::vector<Vector3> wanted =
            through(ReferenceEngine(light_to_code()), through(shown_, axes));
        for (int round = 0; round < kRounds; ++round) {
            std::vector<Vector3> at;
            at.reserve(count);
            for (const Vector3& color : axes) {
                at.push_back(coordinates_of(
                    {cube_.gain * color[0], cube_.gain * color[1], cube_.gain * color[2]}));
            }
            for (std::size_t axis = 0; axis < 3; ++axis) {
                const std::vector<double>& nodes = nodes_[axis];
                const auto [of_cells, mean] = find_misses(axis, at, wanted, node_to_code);
                const std::size_t cells = of_cells.size();
                std::vector<double> middle(cells);
                std::vector<double> density(cells);
                for (std::size_t i = 0; i < cells; ++i) {
                    // A cell has few colors, so use those of its neighbors, too.
                    const double around = 0.5 * of_cells[i] + 0.25 * of_cells[i > 0 ? i - 1 : i] +
                                          0.25 * of_cells[std::min(i + 1, cells - 1)];
                    middle[i] = (nodes[i] + nodes[i + 1]) / 2;
                    density[i] =
                        std::pow(around + kLeast[axis] * mean, 1.0 / 5) / (nodes[i + 1] - nodes[i]);
                }
                density_[axis] = Polyline(std::move(middle), std::move(density));
            }
            place_nodes();
        }
    }

    /// @param axes  with the value in [0, 1]
    [[nodiscard]] Vector3 place_in_cube(const Vector3& axes) const {
        Vector3 x = look_up(cube_.spread, hsv_of(axes));
        x = look_up(cube_.back, affine(cube_.less_sum, x));
        return look_up(cube_.place, affine(cube_.plus_hue, x));
    }

    /// Builds the stages after the nodes.
    void make_behind() {
        const double peak = structure_.peak;
        cube_.light = make_table([&](double x) -> Vector3 {
            return {x, x, peak * std::pow(kLargestCode * x, 1 / kCodePower)};
        });
        cube_.ratios = {{{{kRatioRange, 0, 0}, {0, kRatioRange, 0}, {0, 0, 1}}},
                        {kLowestX, kLowestY, 0}};
        cube_.to_rgb = {{{3, 0, 0}, {-3, 3, -3}, {0, 0, 3}}};
    }

    /// Node value of a display RGB.
    [[nodiscard]] Vector3 node_of(const Vector3& rgb) const {
        const double light = (rgb[0] + rgb[1] + rgb[2]) / 3;
        const double sum = rgb[0] / 3 + light + rgb[2] / 3;
        const bool is_black = !(light > 1e-30);
        const double x = is_black ? kNeutralX : rgb[0] / 3 / sum;
        const double y = is_black ? kNeutralY : light / sum;
        return {(x - kLowestX) / kRatioRange, (y - kLowestY) / kRatioRange,
                std::pow(std::max(light, 0.0) / structure_.peak, kCodePower) / kLargestCode};
    }

    /// Display-linear, 1 at the peak -> codes to compare: a power, or PQ for HDR peaks; straight
    /// near black, and nearly constant where the display clips. With a shorter straight segment,
    /// the few colors with a channel near 0 would dominate the nodes and gain little.
    [[nodiscard]] Expr code_of(const Expr& light) const {
        constexpr double kBeyondWhite = 0.1;
        constexpr double kBelowBlack = 0.15;
        const bool is_hdr = structure_.peak > 1;
        const double straight = is_hdr ? 1e-3 : 2e-4;
        const auto code = [&](const Expr& x) {
            return is_hdr ? pq_encode_nits(kUnitLuminance * structure_.peak * x)
                          : pow(x, kCodePower);
        };
        const Expr of_input = code(Expr::input());
        const double black = evaluate(of_input, straight);
        const double slope = (evaluate(of_input, 1.001 * straight) - black) / (0.001 * straight);
        const Expr inside = code(min(max(light, 0), 1) + straight) - black;
        return inside + min(light, 0) * (kBelowBlack * slope) + max(light - 1, 0) * kBeyondWhite;
    }
    [[nodiscard]] Pipeline light_to_code() const {
        return {MatrixStage{scale(kIdentity3, 1 / structure_.peak)},
                curve_stage(code_of(Expr::input()))};
    }

    /// Nodes -> codes to compare.
    [[nodiscard]] Pipeline forward() const {
        const Expr x = Expr::input(0) * kRatioRange + kLowestX;
        const Expr y = max(Expr::input(1) * kRatioRange + kLowestY, 0.1);
        const Expr light = pow(max(Expr::input(2), 0) * kLargestCode, 1 / kCodePower);
        const Expr red = light * x / y * 3;
        const Expr blue = light * (1 - x - y) / y * 3;
        return {CrossTalkStage{{red, 3 * light - red - blue, blue}},
                curve_stage(code_of(Expr::input()))};
    }

    [[nodiscard]] CubeNodes start() const {
        const std::size_t n = nodes_[0].size();
        CubeNodes nodes(3 * n * n * n);
        in_parallel(n, options_.thread_count, [&](std::size_t h) {
            std::vector<Vector3> coordinates;
            coordinates.reserve(n * n);
            for (std::size_t s = 0; s < n; ++s) {
                // Beyond the most colorful color, use the value there.
                const double saturation = std::min(
                    nodes_[1][s], kBeyondFringe * fringe_(nodes_[0][h]) / largest_saturation_);
                for (std::size_t v = 0; v < n; ++v)
                    coordinates.push_back({nodes_[0][h], saturation, nodes_[2][v]});
            }
            std::size_t at = 3 * h * n * n;
            std::size_t i = 0;
            for (const Vector3& rgb : shown_at(std::move(coordinates))) {
                Vector3 node = node_of(rgb);
                if (i++ % n == 0) node[2] = 0;
                for (const double x : node)
                    nodes[at++] = x;
            }
        });
        return nodes;
    }

    /// Grays of all hues: float rounding decides the hue of a gray, so the nodes of all hues must
    /// agree.
    void fit_grays(CubeNodes& nodes) const {
        const std::size_t n = nodes_[0].size();
        constexpr std::size_t kPerStep = 16;
        in_parallel(n, options_.thread_count, [&](std::size_t h) {
            LineFit line(n, 1e-3);
            const auto code = [&](std::size_t v) -> double& {
                return nodes[3 * (h * n * n + v) + 2];
            };
            for (std::size_t v = 0; v + 1 < n; ++v) {
                for (std::size_t i = 0; i < kPerStep; ++i) {
                    const double t = (static_cast<double>(i) + 0.5) / kPerStep;
                    const double toe = nodes_[2][v] + t * (nodes_[2][v + 1] - nodes_[2][v]);
                    const double missing = node_of(shown_(axes_at({nodes_[0][h], 0, toe})))[2] -
                                           (1 - t) * code(v) - t * code(v + 1);
                    line.add(v, t, missing);
                }
            }
            line.solve([&](std::size_t v, double change) { code(v) += change; });
            for (std::size_t v = 0; v < n; ++v) {
                nodes[3 * (h * n * n + v)] = (kNeutralX - kLowestX) / kRatioRange;
                nodes[3 * (h * n * n + v) + 1] = (kNeutralY - kLowestY) / kRatioRange;
            }
        });
    }

    /// Log-uniform channels, colors of pictures, or grays; in Rec.709, Rec.2020 or the working
    /// primaries.
    [[nodiscard]] Vector3 draw_unlimited(std::size_t i, SampleRandom& random) const {
        const std::size_t kind = i % 20;
        if (kind < 2) {
            return multiply(rgb_to_rgb(kRec709, options_.primaries), draw_picture_color(random));
        }
        const double brightest = random.uniform(0, 10) < 7 ? 6.5 : std::log2(top_);
        Vector3 color{};
        for (double& channel : color)
            channel = std::exp2(random.uniform(kind == 3 ? -20 : -10, kind == 3 ? -5 : brightest));
        if (kind == 2) return {color[0], color[0], color[0]};
        if (random.uniform(0, 10) < 1) color[random.bits() % 3] = 0;
        if (random.uniform(0, 4) < 1) {
            // Moves the color towards gray.
            const double gray = (color[0] + color[1] + color[2]) / 3;
            const double share = random.uniform(0, 1);
            for (double& channel : color)
                channel += share * share * (gray - channel);
        }
        if (kind % 3 == 0) return color;
        return multiply(rgb_to_rgb(kind % 3 == 1 ? kRec709 : kRec2020, options_.primaries), color);
    }

    [[nodiscard]] Vector3 draw_color(std::size_t i, SampleRandom& random) const {
        Vector3 light = draw_unlimited(i, random);
        for (double& x : light)
            x = std::clamp(x, 0.0, top_);
        return light;
    }

    /// Axes of a color, uniform over the cells that colors reach. Colors are rare where nodes are
    /// dense.
    [[nodiscard]] Vector3 draw_axes(SampleRandom& random) const {
        while (true) {
            Vector3 at{};
            for (std::size_t axis = 0; axis < 3; ++axis) {
                const std::vector<double>& nodes = nodes_[axis];
                const double place = random.uniform(0, static_cast<double>(nodes.size() - 1));
                const auto i = static_cast<std::size_t>(place);
                at[axis] = nodes[i] + (place - static_cast<double>(i)) * (nodes[i + 1] - nodes[i]);
            }
            if (at[1] * largest_saturation_ <= fringe_(at[0])) return axes_at(at);
        }
    }

    /// Uses every other sample.
    static bool is_of_cells(std::size_t sample) { return sample % 2 == 0; }

    [[nodiscard]] std::size_t sample_count() const {
        const double n = options_.edge;
        return static_cast<std::size_t>(options_.samples_per_node * n * n * n);
    }

    void fit() {
        const std::size_t count = sample_count();
        constexpr std::size_t kBlock = 4096;
        std::vector<Vector3> places(count);
        std::vector<Vector3> codes(count);
        const ReferenceEngine code(light_to_code());
        const auto draw_block = [&](std::size_t block) {
            const std::size_t begin = block * kBlock;
            const std::size_t size = std::min(kBlock, count - begin);
            SampleRandom random(block);
            std::vector<Vector3> axes(size);
            std::vector<Vector3> light;
            for (std::size_t i = 0; i < size; ++i) {
                if (is_of_cells(begin + i)) {
                    axes[i] = draw_axes(random);
                } else {
                    light.push_back(draw_color((begin + i) / 2, random));
                }
            }
            light = through(to_axes_, std::move(light));
            for (std::size_t i = 0, next = 0; i < size; ++i) {
                if (!is_of_cells(begin + i)) axes[i] = light[next++];
            }
            const std::vector<Vector3> wanted = through(code, through(shown_, axes));
            for (std::size_t i = 0; i < size; ++i) {
                for (double& x : axes[i])
                    x *= cube_.gain;
                places[begin + i] = place_in_cube(axes[i]);
                codes[begin + i] = wanted[i];
            }
        };
        draw_block(0);
        const std::vector<double> nodes = cached_numbers(
            options_.cache_folder, "hue_cube", key_of(places, codes, std::min(kBlock, count)),
            numbers_in(cube_number_count(options_.edge)), [&] {
                in_parallel((count + kBlock - 1) / kBlock, options_.thread_count, draw_block);
                return fit_nodes(places, codes);
            });
        cube_.nodes.reserve(nodes.size());
        for (const double x : nodes)
            cube_.nodes.push_back(static_cast<float>(std::clamp(x, 0.0, 1.0)));
    }

    /// Cache key of the nodes: the first samples identify the stage.
    [[nodiscard]] std::string key_of(const std::vector<Vector3>& places,
                                     const std::vector<Vector3>& codes, std::size_t count) const {
        std::vector<double> numbers = {structure_.peak, top_, cube_.gain, tilt_, toe_};
        for (const std::vector<double>* axis : {&nodes_[0], &nodes_[1], &nodes_[2]})
            numbers.insert(numbers.end(), axis->begin(), axis->end());
        for (std::size_t i = 0; i < count; ++i) {
            numbers.insert(numbers.end(), places[i].begin(), places[i].end());
            numbers.insert(numbers.end(), codes[i].begin(), codes[i].end());
        }
        return fmt::format("hue cube {}, {} nodes a side, {} samples a node, {} rounds: {}",
                           kVersion, options_.edge, options_.samples_per_node, options_.rounds,
                           key_of_numbers(numbers));
    }

    [[nodiscard]] CubeNodes fit_nodes(const std::vector<Vector3>& places,
                                      const std::vector<Vector3>& codes) const {
        const std::size_t n = nodes_[0].size();
        const std::size_t count = places.size();
        // Black and gray of all hues.
        std::vector<std::size_t> held;
        for (std::size_t i = 0; i < n * n; ++i)
            held.push_back(i * n);
        for (std::size_t h = 0; h < n; ++h) {
            for (std::size_t v = 0; v < n; ++v)
                held.push_back(h * n * n + v);
        }
        CubeSolver solver(options_.edge, forward(),
                          {.evenness = 3e-4,
                           .damping = 1e-6,
                           .held = std::move(held),
                           .thread_count = options_.thread_count});
        solver.reserve(count);
        for (std::size_t i = 0; i < count; ++i)
            solver.add(places[i], codes[i], is_of_cells(i) ? kWeightOfCells : 1);
        solver.sort_samples();
        CubeNodes nodes = start();
        fit_grays(nodes);
        solver.solve(nodes, options_.rounds);
        return nodes;
    }

    const HueStructure& structure_;
    double top_;
    HueCubeOptions options_;
    ReferenceEngine to_axes_;
    ReferenceEngine shown_;
    HueCube cube_;
    Polyline stops_;  // of a value
    Polyline value_;  // of stops
    double last_stop_ = 0;
    Polyline fringe_;  // of a hue: the saturation of the most colorful light
    double largest_saturation_ = 0;
    Polyline all_cusps_;  // of a hue: stops, less what the tilt adds
    Polyline cusp_;       // the same at the nodes
    double tilt_ = 0;
    double toe_ = 0;     // relative to the cusp's light
    double lowest_ = 0;  // stops from the cusp
    double whole_ = 0;
    // Functions of hue, share of the largest saturation, and stops from the cusp with the toe:
    std::array<std::vector<double>, 3> fixed_;
    std::array<std::function<double(double)>, 3> density_;
    std::array<std::vector<double>, 3> nodes_;
};

}  // namespace

HueCube fit_hue_cube(const HueStructure& structure, double top, const HueCubeOptions& options) {
    return Maker(structure, top, options).run();
}

std::shared_ptr<const HueCube> hue_cube(const CrossTalkStage& stage, const HueStructure& structure,
                                        double top, const Primaries& primaries,
                                        const std::string& cache_folder) {
    struct HueKey {
        std::array<Expr, 3> f;  // equal expressions are the same node, as long as one lives
        double top;
        Primaries primaries;

        bool operator==(const HueKey& b) const {
            return std::equal(f.begin(), f.end(), b.f.begin(), same) && top == b.top &&
                   primaries == b.primaries;
        }
    };
    static BoundedCache<HueKey, HueCube> cache(64);
    // PQ and HLG are steeper near black than SDR codes: of P3-D65 PQ, 65 nodes leave 5.0e-3 at 99.9
    // % of Rec.709 colors, 81 leave 3.1e-3. The bound for all displays is 4e-3.
    const int edge = structure.peak > 1 ? 81 : 65;
    return cache.get({stage.f, top, primaries}, [&] {
        return fit_hue_cube(structure, top,
                            {.edge = edge, .primaries = primaries, .cache_folder = cache_folder});
    });
}

TONEWRIGHT_NAMESPACE_END
