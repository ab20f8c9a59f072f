// SPDX-License-Identifier: Apache-2.0
#include "lut/fit.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>

#include "base/random.h"
#include "lut/in_parallel.h"
#include "lut/least_squares.h"
#include "lut/picture_color.h"
#include "lut/tetrahedron.h"
#include "measure/photographs.h"
#include "tonewright/engine.h"
#include "tonewright/lut.h"

// With weights that interpolate linearly inside each of a cell's six tetrahedra, the normal matrix
// of the least squares connects a node with those that it shares an edge with: seven neighbors up
// (the other corners of the cell above it) and seven down. So it has eight numbers per node for any
// number of samples, and a step of conjugate gradients is cheap; about 15 are needed.

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

/// Ends of the toe and of the equal steps of a logarithmic axis.
constexpr double kToe = 0.01;
constexpr double kLights = 64;

/// Training colors: their darkest channel in stops, and the brightest of most.
constexpr double kDarkest = -10;
constexpr double kUsualBrightest = 6.5;

/// One training color in ten is typical of pictures. None is gray, because grays are fitted
/// separately.
constexpr bool is_picture_color(std::size_t i) { return i % 10 == 0; }

/// Weight of the squared distance to the sampled node; one sample at a node has weight 1.
constexpr float kPull = 0.1F;
/// An invisible difference: a quarter of a 10-bit code.
constexpr float kUnseen = 0.25F / 1023;

constexpr int kRounds = 3;
/// With bounds: more rounds change 99.9 % of photographs by less than 2 %.
constexpr int kBoundRounds = 2;
/// Share of the diagonal that a step from nodes within bounds adds (Levenberg and Marquardt), so
/// that few bounds break. With 0.3, 99.9 % of photographs get 4 % worse (AgX, LogC3).
constexpr float kDamping = 1;
constexpr int kSteps = 30;

/// A training color: its position and the wanted code.
struct Sample : Tetrahedron {
    std::array<float, 3> code;
};

class Fit {
  public:
    Fit(const CubeProblem& problem, const CubeFitOptions& options)
        : problem_(problem),
          n_(static_cast<std::size_t>(problem.edge)),
          node_count_(n_ * n_ * n_),
          pad_(n_ * n_ + n_ + 1),
          threads_(options.thread_count),
          options_(options),
          step_(node_steps(n_)) {
        const double wanted = options.samples_per_node * static_cast<double>(node_count_);
        sample_count_ =
            std::min(static_cast<std::size_t>(std::max(wanted, 0.0)), options.largest_sample_count);
    }

    std::vector<double> run() {
        const std::vector<double> start = take_sampled();
        fit_grays();
        samples_ = sorted_by_cell(draw_samples(), node_count_);
        for (std::size_t c = 0; c < 3; ++c)
            nodes_[c] = start_[c];
        solve(kRounds, 0);
        std::vector<double> nodes(start.size());
        for (int round = 0;; ++round) {
            for (std::size_t i = 0; i < nodes.size(); ++i)
                nodes[i] = static_cast<double>(nodes_[i % 3][pad_ + i / 3]);
            for (std::size_t c = 0; c < 3; ++c)
                nodes[c] = start[c];
            if (!options_.constrain) return nodes;
            options_.constrain(nodes);
            if (round == kBoundRounds) return nodes;
            for (std::size_t i = 0; i < nodes.size(); ++i)
                nodes_[i % 3][pad_ + i / 3] = static_cast<float>(nodes[i]);
            solve(1, kDamping);
        }
    }

    /// Visible error of the sampled 3D LUT: the product for colors of pictures and for all others,
    /// so that neither improves at the cost of the other. Fourth powers, because the worst errors
    /// matter.
    double error_of_sampled() {
        take_sampled();
        const std::vector<Sample> samples = draw_samples();
        double of_pictures = 0;
        double of_others = 0;
        for (std::size_t i = 0; i < samples.size(); ++i) {
            double& sum = is_picture_color(i) ? of_pictures : of_others;
            for (std::size_t c = 0; c < 3; ++c) {
                const double seen = static_cast<double>(clip(samples[i].code[c])) -
                                    static_cast<double>(clip(shown(start_[c], samples[i])));
                sum += seen * seen * seen * seen;
            }
        }
        return of_pictures * of_others;
    }

  private:
    /// A number per node, padded with zeros, so that every neighbor can be read.
    using Plane = std::vector<float>;

    /// matrix[mask][i]: between node i and the node at that mask of steps above it; matrix[0]: the
    /// diagonal.
    struct NormalEquations {
        std::array<Plane, 8> matrix;
        Plane right;
    };

    [[nodiscard]] Plane make_plane() const { return Plane(node_count_ + 2 * pad_, 0.0F); }
    /// Distance of the nodes of two neighboring grays.
    [[nodiscard]] std::size_t gray_step() const { return step_[7]; }

    std::vector<double> take_sampled() {
        std::vector<double> start = sample_cube(problem_);
        for (std::size_t c = 0; c < 3; ++c) {
            start_[c] = make_plane();
            for (std::size_t i = 0; i < node_count_; ++i)
                start_[c][pad_ + i] = static_cast<float>(start[3 * i + c]);
        }
        return start;
    }

    /// From colors at equal distances.
    void fit_grays() {
        constexpr std::size_t kPerStep = 64;
        const std::size_t count = (n_ - 1) * kPerStep;
        std::vector<double> light(count);
        for (std::size_t k = 0; k < count; ++k) {
            light[k] = evaluate(problem_.axis.light,
                                (static_cast<double>(k) + 0.5) / static_cast<double>(count));
        }
        std::array<std::vector<double>, 3> code = {light, light, light};
        ReferenceEngine(problem_.pipeline)
            .run({light.data(), light.data(), light.data()},
                 {code[0].data(), code[1].data(), code[2].data()}, count);
        for (std::size_t c = 0; c < 3; ++c) {
            for (int round = 0; round < kRounds; ++round)
                fit_grays(code[c], kPerStep, start_[c]);
        }
    }

    /// @param code  of grays, a fixed number in each step of the axis.
    void fit_grays(const std::vector<double>& code, std::size_t per_step, Plane& x) const {
        LineFit line(n_, static_cast<double>(kPull));
        const auto node = [&](std::size_t i) -> float& { return x[pad_ + i * gray_step()]; };
        for (std::size_t k = 0; k < code.size(); ++k) {
            const std::size_t i = k / per_step;
            const double t =
                (static_cast<double>(k % per_step) + 0.5) / static_cast<double>(per_step);
            const double current =
                (1 - t) * static_cast<double>(node(i)) + t * static_cast<double>(node(i + 1));
            const auto w = static_cast<double>(
                importance(static_cast<float>(code[k]), static_cast<float>(current)));
            line.add(i, t, code[k] - current, w);
        }
        line.solve([&](std::size_t i, double change) { node(i) += static_cast<float>(change); });
    }

    [[nodiscard]] std::vector<Sample> draw_samples() const {
        constexpr std::size_t kBlock = 4096;
        std::vector<Sample> drawn(sample_count_);
        const ReferenceEngine engine(problem_.pipeline);
        const ReferenceEngine axis({curve_stage(problem_.axis.place)});
        const Matrix3 from_rec709 = rgb_to_rgb(kRec709, problem_.primaries);
        in_parallel((sample_count_ + kBlock - 1) / kBlock, threads_, [&](std::size_t block) {
            const std::size_t begin = block * kBlock;
            const std::size_t count = std::min(kBlock, sample_count_ - begin);
            std::vector<float> light(3 * count);
            SampleRandom random(block);
            for (std::size_t i = 0; i < count; ++i) {
                const Vector3 color = draw_color(begin + i, random, from_rec709);
                for (std::size_t c = 0; c < 3; ++c) {
                    light[3 * i + c] =
                        static_cast<float>(std::clamp(color[c], 0.0, problem_.axis.top));
                }
            }
            std::vector<double> code(light.size());
            std::vector<double> place(light.size());
            engine.run_rgb(light.data(), code.data(), count);
            axis.run_rgb(light.data(), place.data(), count);
            for (std::size_t i = 0; i < count; ++i)
                drawn[begin + i] = make_sample(&place[3 * i], &code[3 * i]);
        });
        return drawn;
    }

    /// Typical colors of pictures, or others: half inside Rec.709 and half inside the given
    /// primaries, channels log-uniform, a tenth with a channel at 0.
    [[nodiscard]] Vector3 draw_color(std::size_t i, SampleRandom& random,
                                     const Matrix3& from_rec709) const {
        Vector3 color{};
        if (options_.photograph_share > 0 && random.uniform(0, 1) < options_.photograph_share)
            return multiply(from_rec709, draw_photograph_color(random));
        if (is_picture_color(i)) return multiply(from_rec709, draw_picture_color(random));
        double brightest = std::log2(problem_.axis.top);
        if (random.uniform(0, 10) < 7) brightest = std::min(brightest, kUsualBrightest);
        // Additive recurrence of the powers of the root of x^4 = x + 1 (M. Roberts 2018): fills
        // space more evenly than random numbers.
        constexpr double kRoot = 1.22074408460575947536;
        double part = 1;
        for (double& channel : color) {
            part /= kRoot;
            const double u = 0.5 + part * static_cast<double>(i + 1);
            channel = std::exp2(kDarkest + (brightest - kDarkest) * (u - std::floor(u)));
        }
        if (random.uniform(0, 10) < 1) color[random.bits() % 3] = 0;
        return random.uniform(0, 1) < 0.5 ? color : multiply(from_rec709, color);
    }

    [[nodiscard]] Sample make_sample(const double* place, const double* code) const {
        Sample sample{tetrahedron_at(place, n_), {}};
        for (std::size_t c = 0; c < 3; ++c)
            sample.code[c] = static_cast<float>(code[c]);
        return sample;
    }

    [[nodiscard]] float clip(float code) const {
        return std::clamp(code, static_cast<float>(problem_.lo), static_cast<float>(problem_.hi));
    }

    /// Weight of a difference: smaller or 0 where the display clips. It has no step at the clip;
    /// otherwise the nodes would depend on the last digit of a code exactly there.
    [[nodiscard]] float importance(float wanted, float shown) const {
        const float seen = std::fabs(clip(wanted) - clip(shown));
        const float share = (seen + kUnseen) / (std::fabs(wanted - shown) + kUnseen);
        return share * share;
    }

    /// Interpolates the nodes x at a sample.
    [[nodiscard]] float shown(const Plane& x, const Sample& sample) const {
        float sum = 0;
        for (const Corner& corner : corners_of(sample, step_))
            sum += corner.weight * x[pad_ + corner.node];
        return sum;
    }

    /// Equations for the correction of the nodes of channel c.
    void add_up(std::size_t c, float damping, NormalEquations& equations) const {
        auto& [matrix, right] = equations;
        for (Plane& plane : matrix)
            std::fill(plane.begin(), plane.end(), 0.0F);
        std::fill(right.begin(), right.end(), 0.0F);
        const Plane& x = nodes_[c];
        for (const Sample& sample : samples_) {
            const float current = shown(x, sample);
            const float missing = sample.code[c] - current;
            const float w = importance(sample.code[c], current);
            const std::array<Corner, 4> corners = corners_of(sample, step_);
            for (auto corner = corners.begin(); corner != corners.end(); ++corner) {
                const std::size_t node = pad_ + corner->node;
                const float share = w * corner->weight;
                right[node] += share * missing;
                for (auto other = corner; other != corners.end(); ++other)
                    matrix[other->mask ^ corner->mask][node] += share * other->weight;
            }
        }
        for (std::size_t i = pad_; i < pad_ + node_count_; ++i) {
            matrix[0][i] += damping * matrix[0][i] + kPull;
            right[i] += kPull * (start_[c][i] - x[i]);
        }
        for (std::size_t i = 0; i < n_; ++i)
            hold(pad_ + i * gray_step(), equations);
    }

    /// Fixes the node.
    void hold(std::size_t node, NormalEquations& equations) const {
        auto& [matrix, right] = equations;
        matrix[0][node] = 1;
        right[node] = 0;
        for (std::size_t mask = 1; mask < 8; ++mask) {
            matrix[mask][node] = 0;
            matrix[mask][node - step_[mask]] = 0;
        }
    }

    /// y = matrix x
    void multiply_by(const std::array<Plane, 8>& matrix, const Plane& x, Plane& y) const {
        for (std::size_t i = pad_; i < pad_ + node_count_; ++i)
            y[i] = matrix[0][i] * x[i];
        for (std::size_t mask = 1; mask < 8; ++mask) {
            const std::size_t step = step_[mask];
            const float* a = matrix[mask].data();
            const float* in = x.data();
            float* out = y.data();
            for (std::size_t i = pad_; i < pad_ + node_count_; ++i)
                out[i] += a[i] * in[i + step] + a[i - step] * in[i - step];
        }
    }

    void solve(int rounds, float damping) {
        in_parallel(3, threads_, [&](std::size_t c) {
            NormalEquations equations;
            for (Plane& plane : equations.matrix)
                plane = make_plane();
            equations.right = make_plane();
            for (int round = 0; round < rounds; ++round) {
                add_up(c, damping, equations);
                add_solution(equations, nodes_[c]);
            }
        });
    }

    /// The preconditioner is the diagonal.
    void add_solution(NormalEquations& equations, Plane& x) const {
        const Plane& diagonal = equations.matrix[0];
        Plane& residual = equations.right;
        Plane direction = make_plane();
        Plane image = make_plane();
        const auto dot = [&](const Plane& a, const auto& b) {
            double sum = 0;
            for (std::size_t i = pad_; i < pad_ + node_count_; ++i)
                sum += static_cast<double>(a[i]) * static_cast<double>(b(i));
            return sum;
        };
        const auto conditioned = [&](std::size_t i) { return residual[i] / diagonal[i]; };
        const auto turn = [&](float share) {
            for (std::size_t i = pad_; i < pad_ + node_count_; ++i)
                direction[i] = conditioned(i) + share * direction[i];
            multiply_by(equations.matrix, direction, image);
            return dot(direction, [&](std::size_t i) { return image[i]; });
        };
        conjugate_gradients(
            kSteps, [&] { return dot(residual, conditioned); }, turn,
            [&](float length) {
                for (std::size_t i = pad_; i < pad_ + node_count_; ++i) {
                    x[i] += length * direction[i];
                    residual[i] -= length * image[i];
                }
            });
    }

    const CubeProblem& problem_;
    std::size_t n_;
    std::size_t node_count_;
    std::size_t pad_;
    unsigned threads_;
    const CubeFitOptions& options_;
    std::size_t sample_count_ = 0;
    NodeSteps step_;
    std::array<Plane, 3> start_;
    std::array<Plane, 3> nodes_;
    std::vector<Sample> samples_;
};

}  // namespace

CubeAxis make_log_axis(double top, int edge, double share_of_lights) {
    const Expr x = Expr::input();
    const double lowest = std::log2(kToe);
    const double all = std::log2(top + kToe) - lowest;
    const double below = std::log2(kLights + kToe) - lowest;
    const double steps = edge - 1;
    const double above = std::round(share_of_lights * steps);
    const double longer = (all - below) / above * (steps - above) / below;
    const Expr stops = log2(x + kToe) - lowest;
    if (!(above > 0 && longer > 1)) return {stops / all, exp2(x * all + lowest) - kToe, top};
    const double length = below + (all - below) / longer;
    const Expr place = x * length;
    return {(min(stops, below) + max(stops - below, 0) / longer) / length,
            exp2(min(place, below) + max(place - below, 0) * longer + lowest) - kToe, top};
}

double choose_share_of_lights(const CubeProblem& problem, double top) {
    // A smaller 3D LUT is enough to choose.
    CubeProblem smaller = problem;
    smaller.edge = std::min(problem.edge, 33);
    double least = kInfinity;
    double best = 0;
    for (const double share : {0.0, 0.25, 0.1875, 0.125, 0.078125, 0.046875}) {
        smaller.axis = make_log_axis(top, smaller.edge, share);
        const double error = Fit(smaller, {.samples_per_node = 1}).error_of_sampled();
        if (error < least) best = share;
        least = std::min(error, least);
    }
    return best;
}

std::vector<double> sample_cube(const CubeProblem& problem) {
    const auto n = static_cast<std::size_t>(problem.edge);
    std::vector<double> axis(n);
    for (std::size_t i = 0; i < n; ++i) {
        axis[i] = std::clamp(
            evaluate(problem.axis.light, static_cast<double>(i) / static_cast<double>(n - 1)), 0.0,
            problem.axis.top);
    }
    const std::size_t count = n * n * n;
    std::array<std::vector<double>, 3> plane;
    for (auto& p : plane)
        p.resize(count);
    for (std::size_t i = 0; i < count; ++i) {
        plane[0][i] = axis[i / (n * n)];
        plane[1][i] = axis[i / n % n];
        plane[2][i] = axis[i % n];
    }
    const std::array<double*, 3> out = {plane[0].data(), plane[1].data(), plane[2].data()};
    ReferenceEngine(problem.pipeline).run({out[0], out[1], out[2]}, out, count);
    std::vector<double> nodes(3 * count);
    for (std::size_t i = 0; i < nodes.size(); ++i)
        nodes[i] = plane[i % 3][i / 3];
    return nodes;
}

std::vector<double> fit_cube(const CubeProblem& problem, const CubeFitOptions& options) {
    return Fit(problem, options).run();
}

TONEWRIGHT_NAMESPACE_END
