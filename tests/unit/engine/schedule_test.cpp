// SPDX-License-Identifier: Apache-2.0
#include "engine/schedule.h"

#include <gtest/gtest.h>

#include <cstdint>
#include <vector>

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

using simd::VectorCode;
using simd::VectorInstruction;
using simd::VectorOp;
using simd::VectorOperand;

/// Code that is written instruction by instruction.
class Written {
  public:
    VectorOperand make(VectorInstruction step) {
        step.result = code.value_count++;
        code.instructions.push_back(step);
        return {step.result};
    }
    VectorOperand load(std::uint8_t number) {
        return make({.op = VectorOp::load_pixels, .immediate = number});
    }
    /// A chain of as many steps.
    VectorOperand chain(VectorOperand x, int steps) {
        for (int i = 0; i < steps; ++i)
            x = make({.op = VectorOp::divide, .in = {x, x}});
        return x;
    }
    void write(VectorOp op, std::uint8_t number, VectorOperand x) {
        code.instructions.push_back({.op = op, .immediate = number, .in = {x}});
    }

    VectorCode code;
};

void expect_same_instructions(const VectorCode& given, const VectorCode& got) {
    ASSERT_EQ(got.instructions.size(), given.instructions.size());
    EXPECT_EQ(got.value_count, given.value_count);
    std::vector<bool> is_made(static_cast<std::size_t>(given.value_count));
    for (const VectorInstruction& step : got.instructions) {
        for (const VectorOperand& operand : step.in) {
            if (!operand.is_value()) continue;
            EXPECT_TRUE(is_made[static_cast<std::size_t>(operand.value)]) << operand.value;
        }
        if (step.result == VectorOperand::kNone) continue;
        EXPECT_FALSE(is_made[static_cast<std::size_t>(step.result)]) << step.result;
        is_made[static_cast<std::size_t>(step.result)] = true;
    }
}

TEST(Schedule, BeginsWithTheLongestChain) {
    Written w;
    const VectorOperand a = w.load(0);
    const VectorOperand b = w.load(1);
    const VectorOperand near = w.chain(a, 2);
    const VectorOperand far = w.chain(b, 5);
    w.write(VectorOp::store_pixels, 0, near);
    w.write(VectorOp::store_pixels, 1, far);
    const VectorCode got = scheduled(w.code);
    expect_same_instructions(w.code, got);
    EXPECT_EQ(got.instructions[0].immediate, 1);  // b
    std::vector<std::int32_t> read;
    for (const VectorInstruction& step : got.instructions) {
        if (step.op == VectorOp::divide) read.push_back(step.in[0].value);
    }
    // The short chain fills the time that the long one waits.
    EXPECT_EQ(read[0], b.value);
    EXPECT_EQ(read[1], a.value);
}

/// A picture may be written where it is read. Stores would be welcome early: they end values, and
/// there are more than registers.
TEST(Schedule, ReadsAllPixelsBeforeItWritesAny) {
    constexpr std::uint8_t kVectors = 20;
    Written w;
    std::vector<VectorOperand> pixels;
    for (std::uint8_t i = 0; i < kVectors; ++i)
        pixels.push_back(w.load(i));
    for (std::uint8_t i = 0; i < kVectors; ++i)
        w.write(VectorOp::store_pixels, i, pixels[i]);
    const VectorCode got = scheduled(w.code);
    expect_same_instructions(w.code, got);
    for (std::size_t i = 0; i < got.instructions.size(); ++i) {
        EXPECT_EQ(got.instructions[i].op,
                  i < kVectors ? VectorOp::load_pixels : VectorOp::store_pixels)
            << i;
    }
}

TEST(Schedule, KeepsAnIndexUntilItsRowsAreRead) {
    Written w;
    const VectorOperand a = w.load(0);
    const VectorOperand late = w.chain(a, 3);
    w.write(VectorOp::spill_index, 0, late);
    const VectorOperand row = w.make({.op = VectorOp::rows, .immediate = 0});
    const VectorOperand b = w.load(1);  // its chain is the longest, and its index ready at once
    w.write(VectorOp::spill_index, 0, b);
    const VectorOperand other = w.make({.op = VectorOp::rows, .immediate = 4});
    const VectorOperand far = w.chain(other, 9);
    w.write(VectorOp::store_pixels, 0, row);
    w.write(VectorOp::store_pixels, 1, far);
    const VectorCode got = scheduled(w.code);
    expect_same_instructions(w.code, got);
    std::vector<std::int32_t> order;  // values of indices and rows
    for (const VectorInstruction& step : got.instructions) {
        if (step.op == VectorOp::spill_index) order.push_back(step.in[0].value);
        if (step.op == VectorOp::rows) order.push_back(step.result);
    }
    EXPECT_EQ(order, (std::vector{late.value, row.value, b.value, other.value}));
}

}  // namespace
TONEWRIGHT_NAMESPACE_END
