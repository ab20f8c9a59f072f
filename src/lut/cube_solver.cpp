// SPDX-License-Identifier: Apache-2.0
#include "lut/cube_solver.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include "lut/in_parallel.h"
#include "lut/least_squares.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

constexpr int kSteps = 20;
/// Largest derivative of a code by the color of the 3D LUT. Perceptual codes are infinitely steep
/// near black, and steps with larger derivatives would not converge.
constexpr double kSteepest = 512;
/// Indices of the diagonal of a block.
constexpr std::array<std::size_t, 3> kDiagonal = {0, 3, 5};
/// Nodes per task of a thread. Sums are added block by block, so they do not depend on the threads.
constexpr std::size_t kNodesPerBlock = 8192;

}  // namespace

CubeSolver::CubeSolver(int edge, const Pipeline& forward, CubeSolverOptions options)
    : n_(static_cast<std::size_t>(edge)),
      node_count_(n_ * n_ * n_),
      pad_(n_ * n_ + n_ + 1),
      code_(forward),
      options_(std::move(options)),
      step_(node_steps(n_)) {
    // Second differences read two nodes beyond the edge.
    pad_ = std::max(pad_, 2 * n_ * n_);
}

void CubeSolver::add(const Vector3& place, const Vector3& code, double weight) {
    CubeSample sample{
        tetrahedron_at(place.data(), n_), static_cast<float>(std::sqrt(weight)), {}, {}, {}};
    for (std::size_t c = 0; c < 3; ++c)
        sample.code[c] = static_cast<float>(code[c]);
    samples_.push_back(sample);
}

std::array<float, 3> CubeSolver::shown(const CubeNodes& nodes, const CubeSample& s) const {
    std::array<float, 3> sum{};
    for (const Corner& corner : corners_of(s, step_)) {
        for (std::size_t c = 0; c < 3; ++c)
            sum[c] += corner.weight * static_cast<float>(nodes[3 * corner.node + c]);
    }
    return sum;
}

void CubeSolver::linearize(const CubeNodes& nodes) {
    using Planes = std::array<std::vector<double>, 3>;
    constexpr std::size_t kBlock = 4096;
    in_parallel(
        (samples_.size() + kBlock - 1) / kBlock, options_.thread_count, [&](std::size_t block) {
            const std::size_t begin = block * kBlock;
            const std::size_t count = std::min(kBlock, samples_.size() - begin);
            Planes now;
            std::array<Planes, 3> slope;
            std::array<std::array<double*, 3>, 3> to_slope{};
            for (std::size_t c = 0; c < 3; ++c) {
                now[c].resize(count);
                for (std::size_t k = 0; k < 3; ++k) {
                    slope[c][k].resize(count);
                    to_slope[c][k] = slope[c][k].data();
                }
            }
            for (std::size_t i = 0; i < count; ++i) {
                const std::array<float, 3> v = shown(nodes, samples_[begin + i]);
                for (std::size_t c = 0; c < 3; ++c)
                    now[c][i] = static_cast<double>(v[c]);
            }
            const std::array<double*, 3> at = {now[0].data(), now[1].data(), now[2].data()};
            code_.run({at[0], at[1], at[2]}, at, to_slope, count);
            for (std::size_t i = 0; i < count; ++i) {
                CubeSample& s = samples_[begin + i];
                const auto weight = static_cast<double>(s.root_weight);
                for (std::size_t c = 0; c < 3; ++c) {
                    s.missing[c] =
                        static_cast<float>(weight * (static_cast<double>(s.code[c]) - now[c][i]));
                    for (std::size_t k = 0; k < 3; ++k) {
                        s.gradient[c][k] = static_cast<float>(
                            weight * std::clamp(slope[c][k][i], -kSteepest, kSteepest));
                    }
                }
            }
        });
}

void CubeSolver::solve(CubeNodes& nodes, int rounds) {
    for (int round = 0; round < rounds; ++round) {
        linearize(nodes);
        improve(nodes);
    }
}

/// Calls f(block, begin, end) for places in padded vectors.
template <class F>
void CubeSolver::over_nodes(const F& f) const {
    in_parallel((node_count_ + kNodesPerBlock - 1) / kNodesPerBlock, options_.thread_count,
                [&](std::size_t block) {
                    const std::size_t begin = block * kNodesPerBlock;
                    f(block, pad_ + begin, pad_ + std::min(begin + kNodesPerBlock, node_count_));
                });
}

void CubeSolver::add_sample(const CubeSample& s, Matrix& m) const {
    Block square{};
    std::array<float, 3> pull{};
    for (std::size_t c = 0; c < 3; ++c) {
        const auto& g = s.gradient[c];
        for (std::size_t a = 0; a < 3; ++a) {
            pull[a] += g[a] * s.missing[c];
            for (std::size_t b = a; b < 3; ++b)
                square[a + b + (a > 0 && b > 0 ? 1 : 0)] += g[a] * g[b];
        }
    }
    const std::array<Corner, 4> corners = corners_of(s, step_);
    for (auto corner = corners.begin(); corner != corners.end(); ++corner) {
        const std::size_t node = pad_ + corner->node;
        for (std::size_t c = 0; c < 3; ++c)
            m.right[node][c] += corner->weight * pull[c];
        for (auto other = corner; other != corners.end(); ++other) {
            Block& block = m.blocks[other->mask ^ corner->mask][node];
            const float product = corner->weight * other->weight;
            for (std::size_t k = 0; k < 6; ++k)
                block[k] += product * square[k];
        }
    }
}

CubeSolver::Matrix CubeSolver::add_up() const {
    Matrix m;
    for (auto& blocks : m.blocks)
        blocks.resize(node_count_ + 2 * pad_);
    m.right = make_vector();
    // Threads process every other slab of layers at a time, because a sample reaches into the next
    // layer.
    constexpr std::size_t kLayers = 4;
    const std::size_t slabs = (n_ + kLayers - 1) / kLayers;
    const auto first_of = [&](std::size_t slab) {
        const std::size_t cell = std::min(slab * kLayers, n_) * n_ * n_;
        return std::partition_point(samples_.begin(), samples_.end(),
                                    [&](const CubeSample& s) { return s.cell < cell; });
    };
    for (const std::size_t parity : {0U, 1U}) {
        in_parallel((slabs - parity + 1) / 2, options_.thread_count, [&](std::size_t i) {
            const std::size_t slab = 2 * i + parity;
            const auto end = first_of(slab + 1);
            for (auto s = first_of(slab); s != end; ++s)
                add_sample(*s, m);
        });
    }
    return m;
}

/// out += sign evenness times the second differences' own second differences.
void CubeSolver::add_evenness(const Vector& x, Vector& out, double sign) const {
    const auto factor = static_cast<float>(sign * options_.evenness);
    over_nodes([&](std::size_t, std::size_t begin, std::size_t end) {
        for (const std::size_t mask : {4U, 2U, 1U}) {
            const std::size_t step = step_[mask];
            const auto bend = [&](std::size_t middle, std::size_t at, std::size_t c) {
                if (middle == 0 || middle + 1 >= n_) return 0.0F;
                return x[at - step][c] - 2 * x[at][c] + x[at + step][c];
            };
            // Runs of nodes with the same position on the axis.
            for (std::size_t i = begin; i < end;) {
                const std::size_t place = (i - pad_) / step % n_;
                const std::size_t next = std::min(end, i + step - (i - pad_) % step);
                const bool is_inside = place >= 2 && place + 2 < n_;
                for (; i < next; ++i) {
                    for (std::size_t c = 0; c < 3; ++c) {
                        float sum = 0;
                        if (is_inside) {
                            sum = x[i - 2 * step][c] + x[i + 2 * step][c] + 6 * x[i][c] -
                                  4 * (x[i - step][c] + x[i + step][c]);
                        } else {
                            sum = bend(place + 1, i + step, c) - 2 * bend(place, i, c);
                            if (place > 0) sum += bend(place - 1, i - step, c);
                        }
                        out[i][c] += factor * sum;
                    }
                }
            }
        }
    });
}

void CubeSolver::hold(Vector& x) const {
    for (const std::size_t node : options_.held)
        x[pad_ + node] = {};
}

void CubeSolver::multiply_by(const Matrix& m, const Vector& x, Vector& out) const {
    const auto damping = static_cast<float>(options_.damping);
    over_nodes([&](std::size_t, std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) {
            std::array<float, 3> sum = {damping * x[i][0], damping * x[i][1], damping * x[i][2]};
            const auto add = [&](const Block& b, const std::array<float, 3>& v) {
                sum[0] += b[0] * v[0] + b[1] * v[1] + b[2] * v[2];
                sum[1] += b[1] * v[0] + b[3] * v[1] + b[4] * v[2];
                sum[2] += b[2] * v[0] + b[4] * v[1] + b[5] * v[2];
            };
            add(m.blocks[0][i], x[i]);
            for (std::size_t mask = 1; mask < 8; ++mask) {
                // Blocks are symmetric, so the transpose is equal.
                add(m.blocks[mask][i], x[i + step_[mask]]);
                add(m.blocks[mask][i - step_[mask]], x[i - step_[mask]]);
            }
            out[i] = sum;
        }
    });
    add_evenness(x, out, 1);
    hold(out);
}

void CubeSolver::improve(CubeNodes& nodes) const {
    Matrix m = add_up();
    Vector& residual = m.right;
    Vector x = make_vector();
    for (std::size_t i = 0; i < node_count_; ++i) {
        for (std::size_t c = 0; c < 3; ++c)
            x[pad_ + i][c] = static_cast<float>(nodes[3 * i + c]);
    }
    add_evenness(x, residual, -1);
    hold(residual);
    // A second difference has 1, -2, 1: a node inside is in three along each axis.
    const auto least = static_cast<float>(18 * options_.evenness + options_.damping);
    Vector scale = make_vector();
    for (std::size_t i = pad_; i < pad_ + node_count_; ++i) {
        for (std::size_t c = 0; c < 3; ++c)
            scale[i][c] = 1 / (m.blocks[0][i][kDiagonal[c]] + least);
    }
    const std::size_t blocks = (node_count_ + kNodesPerBlock - 1) / kNodesPerBlock;
    const auto sum_over = [&](const auto& term) {
        std::vector<double> sums(blocks);
        over_nodes([&](std::size_t block, std::size_t begin, std::size_t end) {
            for (std::size_t i = begin; i < end; ++i) {
                for (std::size_t c = 0; c < 3; ++c)
                    sums[block] += term(i, c);
            }
        });
        return std::accumulate(sums.begin(), sums.end(), 0.0);
    };
    const auto weighed_residual = [&] {
        return sum_over([&](std::size_t i, std::size_t c) {
            const auto r = static_cast<double>(residual[i][c]);
            return r * r * static_cast<double>(scale[i][c]);
        });
    };
    Vector direction = make_vector();
    Vector image = make_vector();
    Vector change = make_vector();
    const auto turn = [&](float share) {
        over_nodes([&](std::size_t, std::size_t begin, std::size_t end) {
            for (std::size_t i = begin; i < end; ++i) {
                for (std::size_t c = 0; c < 3; ++c)
                    direction[i][c] = scale[i][c] * residual[i][c] + share * direction[i][c];
            }
        });
        multiply_by(m, direction, image);
        return sum_over([&](std::size_t i, std::size_t c) {
            return static_cast<double>(direction[i][c]) * static_cast<double>(image[i][c]);
        });
    };
    conjugate_gradients(kSteps, weighed_residual, turn, [&](float length) {
        over_nodes([&](std::size_t, std::size_t begin, std::size_t end) {
            for (std::size_t i = begin; i < end; ++i) {
                for (std::size_t c = 0; c < 3; ++c) {
                    change[i][c] += length * direction[i][c];
                    residual[i][c] -= length * image[i][c];
                }
            }
        });
    });
    for (std::size_t i = 0; i < node_count_; ++i) {
        for (std::size_t c = 0; c < 3; ++c)
            nodes[3 * i + c] += static_cast<double>(change[pad_ + i][c]);
    }
}

TONEWRIGHT_NAMESPACE_END
