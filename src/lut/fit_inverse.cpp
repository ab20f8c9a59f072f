// SPDX-License-Identifier: Apache-2.0
#include "lut/fit_inverse.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <thread>

#include "base/random.h"
#include "lut/in_parallel.h"
#include "lut/picture_color.h"
#include "lut/tetrahedron.h"
#include "tonewright/engine.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

/// With half as many, 99.9 % of other colors are off by half as much again.
constexpr std::size_t kSamplesPerNode = 8;
/// One sample in so many is a light of the display, reached or not, and counts little.
constexpr std::size_t kAnyLight = 8;
constexpr double kWeightOfAny = 0.01;
/// Of the squared second differences between nodes, where one sample at a node counts 1.
constexpr double kEvenness = 0.05;
/// Keeps a step finite where neither samples nor evenness decide.
constexpr double kDamping = 1e-6;
/// Another round gains some hundredths.
constexpr int kRounds = 5;
constexpr int kSteps = 20;
constexpr double kConverged = 1e-8;
/// What nodes are moved by to see how the light moves.
constexpr double kNudge = 1e-5;

/// Numbers of three channels, one behind the other for each node.
using Nodes = std::vector<double>;
/// Three planes.
using Colors = std::array<std::vector<double>, 3>;

struct Sample : Tetrahedron {
    float weight_in_sum;                           // square root
    std::array<float, 3> code;                     // wanted
    std::array<float, 3> missing;                  // of the code, now
    std::array<std::array<float, 3>, 3> gradient;  // d code / d what the cube gives
};

class InverseFit {
  public:
    explicit InverseFit(const InverseCubeProblem& problem)
        : problem_(problem),
          n_(static_cast<std::size_t>(problem.edge)),
          node_count_(n_ * n_ * n_),
          threads_(std::max(1U, std::thread::hardware_concurrency())) {
        for (std::size_t mask = 0; mask < 8; ++mask)
            step_[mask] = node_step(mask, n_);
    }

    Nodes run() {
        draw_samples();
        start_from_greys();
        start_from_colors();
        for (int round = 0; round < kRounds; ++round) {
            linearise();
            add_solution();
        }
        return nodes_;
    }

  private:
    static Colors make_colors(std::size_t count) {
        return {std::vector<double>(count), std::vector<double>(count), std::vector<double>(count)};
    }

    /// In place.
    void apply(const ReferenceEngine& engine, Colors& colors) const {
        constexpr std::size_t kBlock = 4096;
        const std::size_t count = colors[0].size();
        in_parallel((count + kBlock - 1) / kBlock, threads_, [&](std::size_t block) {
            const std::size_t begin = block * kBlock;
            const std::array<double*, 3> at = {&colors[0][begin], &colors[1][begin],
                                               &colors[2][begin]};
            engine.run({at[0], at[1], at[2]}, at, std::min(kBlock, count - begin));
        });
    }

    /// As pictures have them, or log-uniform from black to the brightest light; in Rec.709 or the
    /// scene's primaries, greys, and with a channel at 0.
    [[nodiscard]] Vector3 draw_color(std::size_t i, SampleRandom& random,
                                     const Matrix3& from_rec709) const {
        Vector3 color{};
        const std::size_t kind = i % 10;
        if (kind == 0) {
            const double grey = std::exp2(random.uniform(-13, 7));
            return {grey, grey, grey};
        }
        if (kind <= 3) return multiply(from_rec709, draw_picture_color(random));
        const bool is_usual = kind <= 6;
        for (double& channel : color)
            channel = std::exp2(is_usual ? random.uniform(-10, 6.5) : random.uniform(-16, 12));
        if (random.uniform(0, 10) < 1) color[random.bits() % 3] = 0;
        return random.uniform(0, 1) < 0.5 ? color : multiply(from_rec709, color);
    }

    void draw_samples() {
        const std::size_t count = kSamplesPerNode * node_count_;
        const std::size_t reached = count - count / kAnyLight;
        const Matrix3 from_rec709 = rgb_to_rgb(kRec709, problem_.primaries);
        Colors light = make_colors(reached);
        SampleRandom random(1);
        for (std::size_t i = 0; i < reached; ++i) {
            const Vector3 color = draw_color(i, random, from_rec709);
            for (std::size_t c = 0; c < 3; ++c)
                light[c][i] = sanitise(color[c]);
        }
        apply(ReferenceEngine(problem_.before), light);
        const Colors held = light;
        apply(ReferenceEngine(problem_.forward), light);
        Colors place = light;
        apply(ReferenceEngine({curve_stage(problem_.place)}), place);
        Colors code = light;
        apply(ReferenceEngine({curve_stage(problem_.code)}), code);
        const double top = *std::max_element(light[0].begin(), light[0].end());
        const ReferenceEngine place_of({curve_stage(problem_.place)});
        const ReferenceEngine code_of({curve_stage(problem_.code)});
        samples_.reserve(count);
        const auto add = [&](const Vector3& p, const Vector3& wanted, double weight) {
            Sample sample{
                tetrahedron_at(p.data(), n_), static_cast<float>(std::sqrt(weight)), {}, {}, {}};
            for (std::size_t c = 0; c < 3; ++c)
                sample.code[c] = static_cast<float>(wanted[c]);
            samples_.push_back(sample);
        };
        for (std::size_t i = 0; i < reached; ++i) {
            add({place[0][i], place[1][i], place[2][i]}, {code[0][i], code[1][i], code[2][i]}, 1);
            for (std::size_t c = 0; c < 3; ++c)
                samples_.back().missing[c] = static_cast<float>(held[c][i]);
        }
        for (std::size_t i = reached; i < count; ++i) {
            // Nearly even in what is seen.
            Vector3 any{};
            for (double& channel : any) {
                const double share = random.uniform(0, 1);
                channel = top * share * share;
            }
            add(place_of(any), code_of(any), kWeightOfAny);
        }
        std::stable_sort(samples_.begin(), samples_.end(),
                         [](const Sample& a, const Sample& b) { return a.cell < b.cell; });
    }

    /// Every channel as greys have it at its place.
    void start_from_greys() {
        constexpr std::size_t kGreys = 2048;
        Colors held = make_colors(kGreys);
        for (std::size_t i = 0; i < kGreys; ++i) {
            const double grey =
                i == 0 ? 0 : std::exp2(-16 + 32 * static_cast<double>(i) / (kGreys - 1));
            held[0][i] = held[1][i] = held[2][i] = grey;
        }
        apply(ReferenceEngine(problem_.before), held);
        Colors place = held;
        apply(ReferenceEngine(problem_.forward), place);
        apply(ReferenceEngine({curve_stage(problem_.place)}), place);
        std::array<std::vector<double>, 3> axis;
        for (std::size_t c = 0; c < 3; ++c) {
            std::size_t at = 0;
            for (std::size_t i = 0; i < n_; ++i) {
                const double wanted = static_cast<double>(i) / static_cast<double>(n_ - 1);
                while (at + 1 < kGreys && place[c][at] < wanted)
                    ++at;
                axis[c].push_back(held[c][at]);
            }
        }
        nodes_.resize(3 * node_count_);
        for (std::size_t i = 0; i < node_count_; ++i) {
            nodes_[3 * i] = axis[0][i / (n_ * n_)];
            nodes_[3 * i + 1] = axis[1][i / n_ % n_];
            nodes_[3 * i + 2] = axis[2][i % n_];
        }
    }

    /// Where many colors are shown as one, in their midst.
    void start_from_colors() {
        for (Sample& s : samples_) {
            if (s.weight_in_sum < 1) continue;
            const std::array<float, 3> now = shown(nodes_, s);
            for (std::size_t c = 0; c < 3; ++c) {
                s.missing[c] -= now[c];
                s.gradient[c][c] = 1;
            }
        }
        add_solution();
    }

    /// Calls f(node, weight) for the four corners.
    template <class F>
    void at_corners(const Sample& s, const F& f) const {
        const auto [second, third, far] = s.weight;
        f(s.cell, 1 - second - third - far);
        f(s.cell + step_[s.second], second);
        f(s.cell + step_[s.third], third);
        f(s.cell + step_[7], far);
    }

    [[nodiscard]] std::array<float, 3> shown(const Nodes& x, const Sample& s) const {
        std::array<float, 3> sum{};
        at_corners(s, [&](std::size_t node, float weight) {
            for (std::size_t c = 0; c < 3; ++c)
                sum[c] += weight * static_cast<float>(x[3 * node + c]);
        });
        return sum;
    }

    /// What is missing of each code, and how it moves with what the cube gives.
    void linearise() {
        constexpr std::size_t kBlock = 4096;
        const ReferenceEngine forward(problem_.forward);
        const ReferenceEngine encode({curve_stage(problem_.code)});
        in_parallel((samples_.size() + kBlock - 1) / kBlock, threads_, [&](std::size_t block) {
            const std::size_t begin = block * kBlock;
            const std::size_t count = std::min(kBlock, samples_.size() - begin);
            std::array<Colors, 4> code;  // of what the cube gives, and with each channel moved
            for (std::size_t moved = 0; moved < 4; ++moved) {
                Colors& planes = code[moved];
                planes = make_colors(count);
                for (std::size_t i = 0; i < count; ++i) {
                    const std::array<float, 3> v = shown(nodes_, samples_[begin + i]);
                    for (std::size_t c = 0; c < 3; ++c)
                        planes[c][i] = static_cast<double>(v[c]) + (c + 1 == moved ? kNudge : 0);
                }
                const std::array<double*, 3> at = {planes[0].data(), planes[1].data(),
                                                   planes[2].data()};
                forward.run({at[0], at[1], at[2]}, at, count);
                encode.run({at[0], at[1], at[2]}, at, count);
            }
            for (std::size_t i = 0; i < count; ++i) {
                Sample& s = samples_[begin + i];
                const auto weight = static_cast<double>(s.weight_in_sum);
                for (std::size_t c = 0; c < 3; ++c) {
                    const double now = code[0][c][i];
                    s.missing[c] =
                        static_cast<float>(weight * (static_cast<double>(s.code[c]) - now));
                    for (std::size_t k = 0; k < 3; ++k) {
                        s.gradient[c][k] =
                            static_cast<float>(weight * (code[k + 1][c][i] - now) / kNudge);
                    }
                }
            }
        });
    }

    /// out += kEvenness times the second differences' own second differences.
    void add_evenness(const Nodes& x, Nodes& out) const {
        for (const std::size_t mask : {4U, 2U, 1U}) {
            const std::size_t step = step_[mask];
            for (std::size_t i = 0; i < node_count_; ++i) {
                if (i / step % n_ + 2 >= n_) continue;
                for (std::size_t c = 0; c < 3; ++c) {
                    const std::size_t a = 3 * i + c;
                    const std::size_t b = a + 3 * step;
                    const std::size_t d = b + 3 * step;
                    const double bend = kEvenness * (x[a] - 2 * x[b] + x[d]);
                    out[a] += bend;
                    out[b] -= 2 * bend;
                    out[d] += bend;
                }
            }
        }
    }

    /// Black stays.
    static void hold_black(Nodes& x) { std::fill_n(x.begin(), 3, 0.0); }

    /// out = normal matrix of the samples, evenness and damping, times x.
    void multiply_by_matrix(const Nodes& x, Nodes& out) const {
        for (std::size_t i = 0; i < out.size(); ++i)
            out[i] = kDamping * x[i];
        add_evenness(x, out);
        for (const Sample& s : samples_) {
            const std::array<float, 3> v = shown(x, s);
            std::array<float, 3> back{};
            for (std::size_t c = 0; c < 3; ++c) {
                const auto& g = s.gradient[c];
                const float moved = g[0] * v[0] + g[1] * v[1] + g[2] * v[2];
                for (std::size_t k = 0; k < 3; ++k)
                    back[k] += g[k] * moved;
            }
            at_corners(s, [&](std::size_t node, float weight) {
                for (std::size_t c = 0; c < 3; ++c)
                    out[3 * node + c] += static_cast<double>(weight * back[c]);
            });
        }
        hold_black(out);
    }

    /// One step of Gauss and Newton: conjugate gradients, preconditioned with the diagonal.
    void add_solution() {
        Nodes residual(nodes_.size());
        add_evenness(nodes_, residual);
        for (double& r : residual)
            r = -r;
        // A second difference has 1, -2, 1: a node inside is in three along each axis.
        Nodes diagonal(nodes_.size(), 18 * kEvenness + kDamping);
        for (const Sample& s : samples_) {
            std::array<float, 3> pull{};
            std::array<float, 3> square{};
            for (std::size_t c = 0; c < 3; ++c) {
                for (std::size_t k = 0; k < 3; ++k) {
                    pull[k] += s.gradient[c][k] * s.missing[c];
                    square[k] += s.gradient[c][k] * s.gradient[c][k];
                }
            }
            at_corners(s, [&](std::size_t node, float weight) {
                for (std::size_t c = 0; c < 3; ++c) {
                    residual[3 * node + c] += static_cast<double>(weight * pull[c]);
                    diagonal[3 * node + c] += static_cast<double>(weight * weight * square[c]);
                }
            });
        }
        hold_black(residual);
        const auto dot = [](const Nodes& a, const Nodes& b) {
            double sum = 0;
            for (std::size_t i = 0; i < a.size(); ++i)
                sum += a[i] * b[i];
            return sum;
        };
        Nodes conditioned(nodes_.size());
        Nodes direction(nodes_.size());
        Nodes image(nodes_.size());
        double size = 0;
        double enough = 0;
        for (int step = 0; step < kSteps; ++step) {
            for (std::size_t i = 0; i < nodes_.size(); ++i)
                conditioned[i] = residual[i] / diagonal[i];
            const double next = dot(residual, conditioned);
            if (step == 0) enough = kConverged * next;
            if (!(next > enough)) return;
            const double turn = step == 0 ? 0 : next / size;
            size = next;
            for (std::size_t i = 0; i < nodes_.size(); ++i)
                direction[i] = conditioned[i] + turn * direction[i];
            multiply_by_matrix(direction, image);
            const double length = size / dot(direction, image);
            for (std::size_t i = 0; i < nodes_.size(); ++i) {
                nodes_[i] += length * direction[i];
                residual[i] -= length * image[i];
            }
        }
    }

    const InverseCubeProblem& problem_;
    std::size_t n_;
    std::size_t node_count_;
    unsigned threads_;
    std::array<std::size_t, 8> step_{};  // from a node to the one that a mask of steps leads to
    std::vector<Sample> samples_;
    Nodes nodes_;
};

}  // namespace

std::vector<double> fit_inverse_cube(const InverseCubeProblem& problem) {
    return InverseFit(problem).run();
}

TONEWRIGHT_NAMESPACE_END
