// SPDX-License-Identifier: Apache-2.0
#include "engine/schedule.h"

#include <algorithm>
#include <array>
#include <tuple>

TONEWRIGHT_NAMESPACE_BEGIN
namespace simd {
namespace {

/// Limit of the values of a block that wait to be read. With AVX2, two blocks share 16 registers;
/// other values lie on the stack, and instructions read them there. With 9, ACES 2.0 is 5 % slower
/// (Zen 4), with 14, AgX of Blender. AVX-512 has 32 registers, but is no faster with 16.
constexpr int kMostAlive = 12;

/// Approximate number of cycles that the processor waits for a result (Zen 4). Loads count as one,
/// because they come early anyway: with 6, ACES 2.0 is 3 % slower. Rows wait for the store of their
/// index.
int latency(const VectorInstruction& step) {
    switch (step.op) {
        case VectorOp::add:
        case VectorOp::subtract:
        case VectorOp::multiply:
        case VectorOp::round:
        case VectorOp::floor:
        case VectorOp::to_index:
        case VectorOp::to_float:
            return 3;
        case VectorOp::multiply_add:
        case VectorOp::multiply_subtract:
        case VectorOp::subtract_product:
        case VectorOp::promote_low:
            return 4;
        case VectorOp::promote_high:
        case VectorOp::demote:
        case VectorOp::rows:
            return 8;
        case VectorOp::divide:
            return step.wide ? 13 : 11;
        case VectorOp::square_root:
            return step.wide ? 20 : 14;
        case VectorOp::gather:
        case VectorOp::spill_index:
            return 20;
        default:
            return 1;
    }
}

bool writes_pixels(VectorOp op) {
    return op == VectorOp::store_pixels || op == VectorOp::store_colors ||
           op == VectorOp::store_thirds;
}

class Scheduler {
  public:
    explicit Scheduler(const VectorCode& code)
        : code_(code),
          nodes_(code.instructions.size()),
          reads_left_(static_cast<std::size_t>(code.value_count)) {
        std::vector<std::size_t> made_by(reads_left_.size());
        std::vector<std::size_t> pixels_read;
        std::size_t rows_before = kNobody;
        std::array<std::size_t, 4> spill{};  // by index slot
        std::array<std::vector<std::size_t>, 4> rows_of_spill;
        for (std::size_t i = 0; i < nodes_.size(); ++i) {
            const VectorInstruction& step = code.instructions[i];
            for (const VectorOperand& operand : step.in)
                add_read(i, operand.value);
            add_read(i, step.mask);
            for (const auto& [value, times] : nodes_[i].reads) {
                keep_order(made_by[value], i);
                reads_left_[value] += times;
            }
            if (step.result != VectorOperand::kNone)
                made_by[static_cast<std::size_t>(step.result)] = i;
            // An index slot is reused only after all of its rows are read. Rows of one index stay
            // together, because they share loads of it.
            const std::size_t number = step.immediate % 4;
            if (step.op == VectorOp::spill_index) {
                for (const std::size_t row : rows_of_spill[number])
                    keep_order(row, i);
                rows_of_spill[number].clear();
                spill[number] = i;
            } else if (step.op == VectorOp::rows) {
                keep_order(spill[number], i);
                keep_order(rows_before, i);
                rows_of_spill[number].push_back(i);
                rows_before = i;
            }
            // The output may overwrite the input, so all pixels of a block are read before one is
            // written.
            if (step.op == VectorOp::load_pixels || step.op == VectorOp::load_thirds)
                pixels_read.push_back(i);
            if (writes_pixels(step.op)) {
                for (const std::size_t read : pixels_read)
                    keep_order(read, i);
            }
        }
        for (std::size_t i = nodes_.size(); i-- > 0;) {
            for (const std::size_t next : nodes_[i].next)
                nodes_[i].height = std::max(nodes_[i].height, nodes_[next].height);
            nodes_[i].height += latency(code.instructions[i]);
        }
    }

    VectorCode run() {
        VectorCode result;
        result.value_count = code_.value_count;
        std::vector<std::size_t> open;
        for (std::size_t i = 0; i < nodes_.size(); ++i) {
            if (nodes_[i].waits_for == 0) open.push_back(i);
        }
        int alive = 0;
        // In each cycle, one instruction of each block begins.
        for (int now = 0; !open.empty(); ++now) {
            const auto rank = [&](std::size_t i) {
                const Node& node = nodes_[i];
                return std::tuple(alive >= kMostAlive ? growth(i) : 0, std::max(node.ready, now),
                                  -node.height, i);
            };
            const auto best =
                std::min_element(open.begin(), open.end(),
                                 [&](std::size_t a, std::size_t b) { return rank(a) < rank(b); });
            const std::size_t i = *best;
            open.erase(best);
            const VectorInstruction& step = code_.instructions[i];
            result.instructions.push_back(step);
            now = std::max(now, nodes_[i].ready);
            alive += growth(i);
            for (const auto& [value, times] : nodes_[i].reads)
                reads_left_[value] -= times;
            for (const std::size_t next : nodes_[i].next) {
                nodes_[next].ready = std::max(nodes_[next].ready, now + latency(step));
                if (--nodes_[next].waits_for == 0) open.push_back(next);
            }
        }
        return result;
    }

  private:
    static constexpr std::size_t kNobody = ~std::size_t{0};

    struct Read {
        std::size_t value;
        int times;
    };
    struct Node {
        std::vector<Read> reads;
        std::vector<std::size_t> next;  // nodes that wait for this one
        int waits_for = 0;              // number of nodes that this one waits for
        int height = 0;  // cycles from its start to the end of the longest chain that waits
        int ready = 0;   // cycle in which it can begin
    };

    void add_read(std::size_t i, std::int32_t value) {
        if (value == VectorOperand::kNone) return;
        const auto v = static_cast<std::size_t>(value);
        for (Read& read : nodes_[i].reads) {
            if (read.value == v) return (void)++read.times;
        }
        nodes_[i].reads.push_back({v, 1});
    }
    void keep_order(std::size_t first, std::size_t second) {
        if (first == kNobody) return;
        nodes_[first].next.push_back(second);
        ++nodes_[second].waits_for;
    }
    /// Change of the number of live values by instruction i.
    [[nodiscard]] int growth(std::size_t i) const {
        const std::int32_t made = code_.instructions[i].result;
        int change =
            made != VectorOperand::kNone && reads_left_[static_cast<std::size_t>(made)] > 0 ? 1 : 0;
        for (const auto& [value, times] : nodes_[i].reads)
            change -= reads_left_[value] == times ? 1 : 0;
        return change;
    }

    const VectorCode& code_;
    std::vector<Node> nodes_;
    std::vector<int> reads_left_;  // for each value
};

}  // namespace

VectorCode scheduled(const VectorCode& code) { return Scheduler(code).run(); }

}  // namespace simd
TONEWRIGHT_NAMESPACE_END
