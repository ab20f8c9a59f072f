// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "engine/tape.h"
#include "tonewright/pipeline.h"

TONEWRIGHT_NAMESPACE_BEGIN

/// Evaluates a program for several colors side by side: all values, and the derivative of each
/// output by each value (reverse accumulation). The bits of a color's results do not depend on the
/// other colors.
class ProbeBlock {
  public:
    static constexpr std::size_t kLanes = 8;
    struct Row {
        std::array<double, kLanes> lane{};
    };
    using OutputRows = std::array<Row, 3>;

    /// @param code       must outlive the block
    /// @param has_poles  see has_pole()
    ProbeBlock(const std::vector<TapeInstruction>& code,
               const std::array<std::uint32_t, 3>& outputs, bool has_poles);

    /// @param from  the member of an instruction that its uniform gets: value, least or most
    /// @return      false: there are no uniforms
    bool set_uniforms(double TapeInstruction::*from);
    /// @param values  by TapeInstruction::source
    void set_uniforms(const std::vector<double>& values);

    /// @param n  number of colors, at most kLanes
    void evaluate(const Vector3* colors, std::size_t n);
    /// Evaluates these instructions alone.
    /// @param steps  ascending, with all values that they read but numbers
    void evaluate(const Vector3* colors, std::size_t n, const std::vector<std::uint32_t>& steps);
    [[nodiscard]] std::size_t size() const noexcept { return size_; }

    /// Computes the adjoints of all values, relative to outputs above 1, at the colors that were
    /// evaluated.
    void differentiate();

    [[nodiscard]] double value(std::size_t i, std::size_t lane) const noexcept {
        return value_[i].lane[lane];
    }
    [[nodiscard]] const Row& values(std::size_t i) const noexcept { return value_[i]; }
    [[nodiscard]] double adjoint(std::size_t output, std::size_t i,
                                 std::size_t lane) const noexcept {
        return adjoint_[i][output].lane[lane];
    }
    /// True if a derivative is infinite there. The adjoint leaves it out.
    [[nodiscard]] bool has_pole(std::size_t output, std::size_t i,
                                std::size_t lane) const noexcept {
        return has_pole_[i][output].lane[lane] != 0;
    }
    /// The largest finite value of each color.
    [[nodiscard]] Row largest_values() const;

    /// Adds to `sums` the squares of the errors that an error of value i causes in the outputs.
    void add_squares(std::size_t i, const Row& error, OutputRows& sums) const;
    /// Overload for an error of `half_ulps` half units in the last place of a float.
    void add_squares(std::size_t i, double half_ulps, OutputRows& sums) const;

    /// Half a unit in the last place of 1 in float, and half the smallest denormal.
    static constexpr double kHalfUlp = 0x1p-24;
    static constexpr double kSmallestStep = 0x1p-150;

  private:
    void run(std::uint32_t i, const Vector3* colors);

    const std::vector<TapeInstruction>& code_;
    std::array<std::uint32_t, 3> outputs_;
    std::vector<std::uint32_t> computed_;  // indices of all values but numbers
    std::size_t size_ = 0;
    std::vector<Row> value_;
    std::vector<OutputRows> adjoint_;
    std::vector<OutputRows> has_pole_;
};

/// Slope of the table at x; 0 beyond its ends.
[[nodiscard]] double table_slope(const Table& table, double x);
/// The rise of the table from the beginning of x's cell to x.
[[nodiscard]] double table_rise(const Table& table, double x);
/// Start of cell i of a table with at least two samples.
[[nodiscard]] double cell_begin(const Table& table, std::size_t i);
[[nodiscard]] double cell_slope(const Table& table, std::size_t i);

TONEWRIGHT_NAMESPACE_END
