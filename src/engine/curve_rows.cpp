// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <bit>
#include <cmath>

#include "engine/curve_fit.h"

TONEWRIGHT_NAMESPACE_BEGIN

std::uint32_t CurveRows::base_of(std::uint32_t bits) const noexcept {
    std::uint32_t last = base;
    for (const Restart& restart : restarts) {
        if (bits >= restart.from) last = restart.base;
    }
    return last;
}

CurveRows::Place CurveRows::find(float x) const noexcept {
    const auto bits = std::bit_cast<std::uint32_t>(std::max(x, std::bit_cast<float>(base)));
    const std::uint32_t start = base_of(bits);
    const std::uint32_t cell = (bits - start) >> shift;
    const auto x0 = std::bit_cast<float>(start + (cell << shift));
    return {numbers.data() + std::size_t{cell} * static_cast<std::size_t>(length), x0,
            scale_of(x0)};
}

float CurveRows::scale_of(float x0) noexcept {
    return std::bit_cast<float>(0x7F000000U - (std::bit_cast<std::uint32_t>(x0) & 0x7F800000U));
}

namespace curves {
namespace {

/// The polynomial of a row at t. In a precise curve without the constant coefficient, which is
/// added in double.
float polynomial(const CurveRows& rows, const float* row, float t, bool is_precise) {
    const int lowest = is_precise ? 1 : 0;
    float y = row[rows.length - 1];
    for (int k = rows.length - 2; k >= lowest; --k)
        y = rows.is_fused ? std::fma(y, t, row[k]) : y * t + row[k];
    return y;
}

/// Fits a curve in rows of one length, with one number of cells an octave.
class RowFit : Fit {
  public:
    RowFit(const CurveFunction& f, double hi, std::span<const double> kinks,
           const CurveTolerance& tolerance, bool is_precise, bool is_fused, int length, int shift)
        : Fit(f, hi, kinks, tolerance, is_precise) {
        rows_.is_fused = is_fused;
        rows_.length = length;
        rows_.shift = shift;
    }

    std::optional<CompiledCurve> fit() {
        // Shifts the cells so that the first kink that needs a restart lies between two cells.
        if (!place_cells(0)) return std::nullopt;
        if (!rows_.restarts.empty() &&
            !place_cells(rows_.restarts.front().from & ((std::uint32_t{1} << rows_.shift) - 1)))
            return std::nullopt;
        return fit_cells();
    }

  private:
    using Row = std::array<float, 8>;

    /// Cells from the float with the bits `from` on, beginning with number `first_cell`.
    struct Grid {
        std::uint32_t from, base, first_cell;
    };

    [[nodiscard]] std::uint32_t first_bits_of(std::uint32_t cell) const {
        auto grid = grids_.rbegin();
        while (grid->first_cell > cell)
            ++grid;
        return grid->base + (cell << rows_.shift);
    }
    [[nodiscard]] float begin_of(std::uint32_t cell) const {
        return std::bit_cast<float>(first_bits_of(cell));
    }
    /// The last float of a cell.
    [[nodiscard]] double end_of(std::uint32_t cell) const {
        std::uint32_t next = first_bits_of(cell) + (std::uint32_t{1} << rows_.shift);
        for (const Grid& grid : grids_) {
            if (grid.first_cell == cell + 1) next = grid.from;
        }
        return std::min(static_cast<double>(std::bit_cast<float>(next - 1)), hi_);
    }

    /// Chooses where cells start. The first cell reaches down to 0 and as far up as one
    /// polynomial fits. Cells begin anew at kinks that no polynomial fits.
    bool place_cells(std::uint32_t part) {
        const std::uint32_t unit = std::uint32_t{1} << rows_.shift;
        const auto cell_at = [&](double x) {
            return (std::bit_cast<std::uint32_t>(to_float(x)) - part) / unit;
        };
        const std::uint32_t top = cell_at(hi_);
        std::uint32_t lowest = cell_at(std::min(std::ldexp(1.0, kLowestExponent), hi_));
        const auto first_fits = [&](std::uint32_t cell) {
            rows_.base = cell * unit + part;
            grids_ = {{rows_.base, rows_.base, 0}};
            return try_row(0, end_of(0), 0);
        };
        if (!first_fits(lowest)) return false;
        std::uint32_t failing = top + 1;
        while (failing - lowest > 1) {
            const std::uint32_t middle = lowest + (failing - lowest) / 2;
            (first_fits(middle) ? lowest : failing) = middle;
        }
        if (top - lowest >= CurveRows::kMaxRows) return false;
        rows_.base = lowest * unit + part;
        grids_ = {{rows_.base, rows_.base, 0}};
        rows_.restarts.clear();
        for (const float kink : kinks_) {
            if (static_cast<double>(kink) <= end_of(0)) continue;
            const auto bits = std::bit_cast<std::uint32_t>(kink);
            const std::uint32_t cell = (bits - grids_.back().base) / unit;
            if (kink == begin_of(cell)) continue;
            if (try_row(static_cast<double>(begin_of(cell)), end_of(cell), cell)) continue;
            const std::uint32_t base = bits - (cell + 1) * unit;
            grids_.push_back({bits, base, cell + 1});
            rows_.restarts.push_back({bits, base});
        }
        count_ = (std::bit_cast<std::uint32_t>(to_float(hi_)) - grids_.back().base) / unit + 1;
        if (count_ > CurveRows::kMaxRows) return false;
        // Tries a cell in each octave or two first, so that a hopeless fit ends soon.
        constexpr std::uint32_t kStride = 13;
        for (std::uint32_t cell = kStride; cell < count_; cell += kStride) {
            if (!try_row(static_cast<double>(begin_of(cell)), end_of(cell), cell)) return false;
        }
        return true;
    }

    std::optional<CompiledCurve> fit_cells() {
        for (std::uint32_t cell = 0; cell < count_; ++cell) {
            const double begin = cell == 0 ? 0 : static_cast<double>(begin_of(cell));
            if (!try_row(begin, end_of(cell), cell)) return std::nullopt;
            rows_.numbers.insert(rows_.numbers.end(), tried_.begin(),
                                 tried_.begin() + rows_.length);
        }
        CompiledCurve result = curve_without_polynomials();
        result.rows = std::move(rows_);
        return result;
    }

    /// Fits a polynomial over [begin, end] into tried_. Returns true if it is within the tolerance.
    bool try_row(double begin, double end, std::uint32_t cell) {
        const auto x0 = static_cast<double>(begin_of(cell));
        const auto scale = static_cast<double>(CurveRows::scale_of(begin_of(cell)));
        const double middle = (0.5 * (begin + end) - x0) * scale;
        const double half = std::max(0.5 * (end - begin) * scale, 1e-6);
        const int degree = rows_.length - (is_precise_ ? 2 : 1);
        const Coefficients c = interpolate(
            f_, [&](double u) { return std::clamp(x0 + (middle + u * half) / scale, begin, end); },
            degree);
        // Powers of u = (t - middle) / half as powers of t, by Horner's rule.
        Coefficients in_t{c[static_cast<std::size_t>(degree)]};
        std::size_t powers = 1;
        for (auto k = static_cast<std::size_t>(degree); k-- > 0;) {
            ++powers;
            for (std::size_t j = powers; j-- > 0;)
                in_t[j] = ((j > 0 ? in_t[j - 1] : 0) - in_t[j] * middle) / half;
            in_t[0] += c[k];
        }
        tried_ = {};
        std::size_t next = 0;
        for (std::size_t power = 0; power < powers; ++power) {
            const double k = in_t[power];
            if (!(std::fabs(k) < static_cast<double>(kMostFloat))) return false;
            tried_[next++] = to_float(k);
            if (is_precise_ && next == 1)
                tried_[next++] = to_float(k - static_cast<double>(to_float(k)));
        }
        return keeps(begin, end, 3 * rows_.length, [&](double x) {
            const float x_float = to_float(x);
            float distance = x_float - begin_of(cell);
            if (is_precise_) distance += to_float(x - static_cast<double>(x_float));
            const float y = polynomial(rows_, tried_.data(),
                                       distance * CurveRows::scale_of(begin_of(cell)), is_precise_);
            return static_cast<double>(y) + (is_precise_ ? static_cast<double>(tried_[0]) : 0);
        });
    }

    CurveRows rows_;
    std::vector<Grid> grids_;  // the first one, then one for each restart
    std::uint32_t count_ = 0;  // number of cells
    Row tried_{};
};

}  // namespace

/// Tries short rows before long ones, and few before many, because they share the first-level cache
/// with pixels.
std::optional<CompiledCurve> fit_rows(const CurveFunction& f, double hi,
                                      std::span<const double> kinks,
                                      const CurveTolerance& tolerance, bool is_precise,
                                      bool is_fused) {
    for (const int length : {4, 8}) {
        if (length == 4 && is_precise) continue;
        for (int shift = 21; shift >= 16; --shift) {
            RowFit rows(f, hi, kinks, tolerance, is_precise, is_fused, length, shift);
            if (auto curve = rows.fit()) return curve;
        }
    }
    return std::nullopt;
}

double value_by_rows(const CompiledCurve& curve, double x) noexcept {
    const float x_float = to_float(x);
    const CurveRows::Place place = curve.rows->find(x_float);
    float distance = x_float - place.x0;
    if (curve.is_precise) distance += to_float(x - static_cast<double>(x_float));
    const float y = polynomial(*curve.rows, place.row, distance * place.scale, curve.is_precise);
    return static_cast<double>(y) + (curve.is_precise ? static_cast<double>(place.row[0]) : 0);
}

double slope_by_rows(const CompiledCurve& curve, double x) noexcept {
    const CurveRows::Place place = curve.rows->find(to_float(x));
    const auto per_x = static_cast<double>(place.scale);
    const double t = (x - static_cast<double>(place.x0)) * per_x;
    const int first = curve.is_precise ? 1 : 0;  // number k > first belongs to power k - first
    double y = 0;
    for (int k = curve.rows->length - 1; k > first; --k)
        y = y * t + (k - first) * static_cast<double>(place.row[k]);
    return y * per_x;
}

}  // namespace curves
TONEWRIGHT_NAMESPACE_END
