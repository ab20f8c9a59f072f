// SPDX-License-Identifier: Apache-2.0
#include "lut/fit_inverse.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "base/random.h"
#include "lut/cube_solver.h"
#include "lut/in_parallel.h"
#include "lut/picture_color.h"
#include "tonewright/engine.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

/// Half as many make the 99.9 % error of other colors 1.5 times as large.
constexpr std::size_t kSamplesPerNode = 8;
/// One sample in this many is any display color, reachable or not, with a small weight.
constexpr std::size_t kAnyLight = 8;
constexpr double kWeightOfAny = 0.01;
/// Weight of the squared second differences between nodes; one sample at a node has weight 1.
constexpr double kEvenness = 0.05;
/// Another round improves the error by a few percent.
constexpr int kRounds = 5;

/// Three planes.
using Colors = std::array<std::vector<double>, 3>;

class InverseFit {
  public:
    explicit InverseFit(const InverseCubeProblem& problem)
        : problem_(problem),
          n_(static_cast<std::size_t>(problem.edge)),
          node_count_(n_ * n_ * n_),
          solver_(problem.edge, code_behind(problem), {.evenness = kEvenness, .held = {0}}) {}

    CubeNodes run() {
        draw_samples();
        start_from_grays();
        start_from_colors();
        solver_.solve(nodes_, kRounds);
        return std::move(nodes_);
    }

  private:
    /// Value of the nodes -> code.
    static Pipeline code_behind(const InverseCubeProblem& problem) {
        Pipeline stages = problem.forward;
        stages.push_back(curve_stage(problem.code));
        return stages;
    }

    static Colors make_colors(std::size_t count) {
        return {std::vector<double>(count), std::vector<double>(count), std::vector<double>(count)};
    }

    /// In place.
    static void apply(const ReferenceEngine& engine, Colors& colors) {
        constexpr std::size_t kBlock = 4096;
        const std::size_t count = colors[0].size();
        in_parallel((count + kBlock - 1) / kBlock, 0, [&](std::size_t block) {
            const std::size_t begin = block * kBlock;
            const std::array<double*, 3> at = {&colors[0][begin], &colors[1][begin],
                                               &colors[2][begin]};
            engine.run({at[0], at[1], at[2]}, at, std::min(kBlock, count - begin));
        });
    }

    /// Typical colors of pictures, or log-uniform from black to the brightest value; in Rec.709 or
    /// the scene's primaries; also grays, and colors with a channel at 0.
    [[nodiscard]] Vector3 draw_color(std::size_t i, SampleRandom& random,
                                     const Matrix3& from_rec709) const {
        Vector3 color{};
        const std::size_t kind = i % 10;
        if (kind == 0) {
            const double gray = std::exp2(random.uniform(-13, 7));
            return {gray, gray, gray};
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
                light[c][i] = sanitize(color[c]);
        }
        apply(ReferenceEngine(problem_.before), light);
        const Colors held = light;
        apply(ReferenceEngine(problem_.forward), light);
        const double top = *std::max_element(light[0].begin(), light[0].end());
        for (std::size_t i = reached; i < count; ++i) {
            // Nearly uniform in visible steps.
            for (std::vector<double>& channel : light) {
                const double share = random.uniform(0, 1);
                channel.push_back(top * share * share);
            }
        }
        Colors place = light;
        apply(ReferenceEngine({curve_stage(problem_.place)}), place);
        Colors code = light;
        apply(ReferenceEngine({curve_stage(problem_.code)}), code);
        solver_.reserve(count);
        for (std::size_t i = 0; i < count; ++i) {
            solver_.add({place[0][i], place[1][i], place[2][i]},
                        {code[0][i], code[1][i], code[2][i]}, i < reached ? 1 : kWeightOfAny);
            if (i >= reached) continue;
            for (std::size_t c = 0; c < 3; ++c)
                solver_.samples().back().missing[c] = static_cast<float>(held[c][i]);
        }
        solver_.sort_samples();
    }

    /// Sets every channel to the gray solution at its position.
    void start_from_grays() {
        constexpr std::size_t kGrays = 2048;
        Colors held = make_colors(kGrays);
        for (std::size_t i = 0; i < kGrays; ++i) {
            const double gray =
                i == 0 ? 0 : std::exp2(-16 + 32 * static_cast<double>(i) / (kGrays - 1));
            held[0][i] = held[1][i] = held[2][i] = gray;
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
                while (at + 1 < kGrays && place[c][at] < wanted)
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

    /// If many colors map to one, uses their middle.
    void start_from_colors() {
        for (CubeSample& s : solver_.samples()) {
            if (s.root_weight < 1) continue;
            const std::array<float, 3> now = solver_.shown(nodes_, s);
            for (std::size_t c = 0; c < 3; ++c) {
                s.missing[c] -= now[c];
                s.gradient[c][c] = 1;
            }
        }
        solver_.improve(nodes_);
    }

    const InverseCubeProblem& problem_;
    std::size_t n_;
    std::size_t node_count_;
    CubeSolver solver_;
    CubeNodes nodes_;
};

}  // namespace

std::vector<double> fit_inverse_cube(const InverseCubeProblem& problem) {
    return InverseFit(problem).run();
}

TONEWRIGHT_NAMESPACE_END
