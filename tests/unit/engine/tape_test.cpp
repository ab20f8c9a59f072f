// SPDX-License-Identifier: Apache-2.0
#include "engine/tape.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <set>

#include "base/random.h"
#include "tonewright/engine.h"
#include "tonewright/registry.h"
#include "unit/engine/views.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

int operand_count(const TapeInstruction& step) {
    switch (step.op) {
        case ExprOp::constant:
        case ExprOp::input:
            return 0;
        case ExprOp::negate:
        case ExprOp::absolute:
        case ExprOp::square_root:
        case ExprOp::exp2:
        case ExprOp::log2:
        case ExprOp::sine:
        case ExprOp::cosine:
        case ExprOp::floor:
        case ExprOp::lookup:
            return 1;
        case ExprOp::select:
            return 3;
        default:
            return 2;
    }
}

TEST(Tape, HasEveryNodeOnceAndOperandsFirst) {
    for (const OperatorVariant& variant : all_variants()) {
        for (const Pipeline& view : all_views(variant)) {
            const std::array<Expr, 3> f = compose(view);
            const Tape tape(f);
            std::set<const ExprNode*> nodes;
            for (std::uint32_t i = 0; i < tape.code().size(); ++i) {
                const TapeInstruction& step = tape.code()[i];
                EXPECT_TRUE(nodes.insert(step.node).second) << "twice";
                const std::array<std::uint32_t, 3> operands = {step.a, step.b, step.c};
                for (int k = 0; k < operand_count(step); ++k)
                    EXPECT_LT(operands[static_cast<std::size_t>(k)], i);
            }
            EXPECT_EQ(tape.code().size(), node_count(f));
            for (std::size_t c = 0; c < 3; ++c)
                EXPECT_EQ(tape.code()[tape.outputs()[c]].node, f[c].node());
        }
    }
}

/// Straight-line code to give registers to.
struct Program {
    std::vector<std::array<std::int64_t, 4>> operands;
    std::vector<bool> needs_register;
    std::vector<std::uint32_t> pinned;
};

Program random_program(SampleRandom& random, std::size_t size) {
    Program p;
    for (std::size_t i = 0; i < size; ++i) {
        std::array<std::int64_t, 4> operands = {-1, -1, -1, -1};
        const std::size_t count = i == 0 ? 0 : random.bits() % 5;
        for (std::size_t k = 0; k < count; ++k) {
            // Mostly near ones, as in real code; the same one twice at times.
            const std::size_t reach = random.bits() % 8 == 0 ? i : std::min<std::size_t>(i, 6);
            operands[k] = static_cast<std::int64_t>(i - 1 - random.bits() % reach);
        }
        p.operands.push_back(operands);
        p.needs_register.push_back(random.bits() % 5 != 0);  // the others are constants
    }
    for (int k = 0; k < 3; ++k) {
        const auto value = static_cast<std::uint32_t>(random.bits() % size);
        if (p.needs_register[value]) p.pinned.push_back(value);
    }
    return p;
}

/// Executes the allocation: each register holds the number of the value last written to it.
/// Returns how many values are live at once at most, an instruction's dying operands not counted.
std::size_t simulate(const Program& p, const RegisterAllocation& a) {
    const std::size_t n = p.operands.size();
    std::vector<std::size_t> last_use(n);
    for (std::size_t i = 0; i < n; ++i) {
        last_use[i] = i;
        for (const std::int64_t v : p.operands[i]) {
            if (v >= 0) last_use[static_cast<std::size_t>(v)] = i;
        }
    }
    for (const std::uint32_t v : p.pinned)
        last_use[v] = n;

    constexpr std::size_t kEmpty = static_cast<std::size_t>(-1);
    std::vector<std::size_t> holds(a.register_count, kEmpty);
    std::size_t most = 0;
    for (std::size_t i = 0; i < n; ++i) {
        for (const std::int64_t operand : p.operands[i]) {
            if (operand < 0) continue;
            const auto v = static_cast<std::size_t>(operand);
            if (!p.needs_register[v]) continue;
            EXPECT_EQ(holds[a.register_of[v]], v) << "value " << v << " is gone before its use";
        }
        if (p.needs_register[i]) {
            EXPECT_LT(a.register_of[i], a.register_count);
            if (a.register_of[i] < a.register_count) holds[a.register_of[i]] = i;
        }
        std::size_t live = 0;
        for (std::size_t v = 0; v <= i; ++v) {
            if (p.needs_register[v] && (last_use[v] > i || v == i)) ++live;
        }
        most = std::max(most, live);
    }
    for (const std::uint32_t v : p.pinned)
        EXPECT_EQ(holds[a.register_of[v]], v) << "output " << v << " is gone at the end";
    return most;
}

TEST(Registers, OverlappingLifetimesNeverShare) {
    SampleRandom random(11);
    for (int round = 0; round < 300; ++round) {
        const Program p = random_program(random, 2 + random.bits() % 80);
        const RegisterAllocation a = allocate_registers(p.operands, p.needs_register, p.pinned);
        const std::size_t most = simulate(p, a);
        // In straight-line code first-come allocation needs no more than are live at once.
        EXPECT_EQ(a.register_count, most) << "round " << round;
        if (::testing::Test::HasFailure()) return;
    }
}

TEST(Registers, TapesOfOperatorsFit) {
    for (const OperatorVariant& variant : all_variants()) {
        for (const Pipeline& view : all_views(variant)) {
            const Tape tape(compose(view));
            Program p;
            for (const TapeInstruction& step : tape.code()) {
                std::array<std::int64_t, 4> operands = {-1, -1, -1, -1};
                const std::array<std::uint32_t, 3> abc = {step.a, step.b, step.c};
                for (std::size_t k = 0; k < static_cast<std::size_t>(operand_count(step)); ++k)
                    operands[k] = abc[k];
                p.operands.push_back(operands);
                p.needs_register.push_back(step.op != ExprOp::constant);
            }
            p.pinned.assign(tape.outputs().begin(), tape.outputs().end());
            const RegisterAllocation a = allocate_registers(p.operands, p.needs_register, p.pinned);
            EXPECT_EQ(a.register_count, simulate(p, a)) << variant.name << " " << variant.look;
        }
    }
}

TEST(Registers, SmallCases) {
    // Three inputs, one sum of two of them, all three values pinned at once.
    const Program p = {
        {{-1, -1, -1, -1}, {-1, -1, -1, -1}, {0, 1, -1, -1}}, {true, true, true}, {0, 1, 2}};
    EXPECT_EQ(allocate_registers(p.operands, p.needs_register, p.pinned).register_count, 3U);
    // The result takes the place of an operand that dies; an operand read twice dies once.
    const RegisterAllocation square = allocate_registers(
        {{-1, -1, -1, -1}, {0, 0, -1, -1}, {1, 1, -1, -1}}, {true, true, true}, {2});
    EXPECT_EQ(square.register_count, 1U);
    // Constants take none.
    EXPECT_EQ(allocate_registers({{-1, -1, -1, -1}}, {false}, {}).register_count, 0U);
}

}  // namespace
TONEWRIGHT_NAMESPACE_END
