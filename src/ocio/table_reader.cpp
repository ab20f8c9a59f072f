// SPDX-License-Identifier: Apache-2.0
//
// OpenColorIO's transforms of a LUT file as stages.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <utility>
#include <vector>

#include "base/strings.h"
#include "lut/half_domain.h"
#include "lut/lut_text.h"
#include "lut/table_file.h"
#include "ocio/lut_transforms.h"
#include "tonewright/lut.h"
#include "tonewright/lut_file.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

class Converter {
  public:
    explicit Converter(std::string path) : path_(std::move(path)) {}

    TableFile convert(const OCIO::ConstGroupTransformRcPtr& group) {
        for (int i = 0; i < group->getNumTransforms(); ++i)
            add(group->getTransform(i));
        return std::move(table_);
    }

  private:
    [[noreturn]] void refuse(const std::string& reason) const {
        throw FileError("read: " + path_ + ": " + reason);
    }

    void add(const OCIO::ConstTransformRcPtr& transform) {
        if (const auto lut = OCIO_DYNAMIC_POINTER_CAST<const OCIO::Lut3DTransform>(transform))
            return add(*lut);
        if (const auto lut = OCIO_DYNAMIC_POINTER_CAST<const OCIO::Lut1DTransform>(transform))
            return add(*lut);
        if (const auto matrix = OCIO_DYNAMIC_POINTER_CAST<const OCIO::MatrixTransform>(transform))
            return add(*matrix);
        if (const auto range = OCIO_DYNAMIC_POINTER_CAST<const OCIO::RangeTransform>(transform))
            return add(*range);
        if (const auto log = OCIO_DYNAMIC_POINTER_CAST<const OCIO::LogTransform>(transform)) {
            const double base = log->getBase();
            return add_log(*log, base, {1, 1, 1}, {0, 0, 0}, {1, 1, 1}, {0, 0, 0});
        }
        if (const auto log = OCIO_DYNAMIC_POINTER_CAST<const OCIO::LogAffineTransform>(transform)) {
            Numbers log_slope{};
            Numbers log_offset{};
            Numbers lin_slope{};
            Numbers lin_offset{};
            log->getLogSideSlopeValue(log_slope.v);
            log->getLogSideOffsetValue(log_offset.v);
            log->getLinSideSlopeValue(lin_slope.v);
            log->getLinSideOffsetValue(lin_offset.v);
            return add_log(*log, log->getBase(), log_slope.array(), log_offset.array(),
                           lin_slope.array(), lin_offset.array());
        }
        if (const auto cdl = OCIO_DYNAMIC_POINTER_CAST<const OCIO::CDLTransform>(transform))
            return add(*cdl);
        refuse(fmt::format(
            "has a transform of type {}, which no operator can have; expected tables, matrices, "
            "ranges, logarithms or a CDL",
            static_cast<int>(transform->getTransformType())));
    }

    /// Three numbers as OpenColorIO parses them.
    struct Numbers {
        double v[3];
        [[nodiscard]] Vector3 array() const { return {v[0], v[1], v[2]}; }
    };

    template <class Transform>
    void require_forward(const Transform& transform, const char* what) const {
        if (transform.getDirection() != OCIO::TRANSFORM_DIR_FORWARD)
            refuse(fmt::format("has an inverse {}; expected none in an operator", what));
    }

    void add(const OCIO::Lut3DTransform& lut) {
        require_forward(lut, "3D LUT");
        const auto n = lut.getGridSize();
        std::vector<float> nodes(3 * n * n * n);
        float* node = nodes.data();
        for (unsigned long b = 0; b < n; ++b) {
            for (unsigned long g = 0; g < n; ++g) {
                for (unsigned long r = 0; r < n; ++r, node += 3)
                    lut.getValue(r, g, b, node[0], node[1], node[2]);
            }
        }
        require_finite(nodes);
        try {
            table_.stages.emplace_back(grid_of(static_cast<int>(n), nodes));
        } catch (const Error& e) {
            refuse(e.what());
        }
        if (lut.getInterpolation() == OCIO::INTERP_LINEAR) {
            table_.note =
                "the file asks for trilinear interpolation, and the operator's is tetrahedral";
        }
    }

    void add(const OCIO::Lut1DTransform& lut) {
        require_forward(lut, "1D table");
        const auto n = lut.getLength();
        std::vector<float> rows(3 * n);
        for (unsigned long i = 0; i < n; ++i)
            lut.getValue(i, rows[3 * i], rows[3 * i + 1], rows[3 * i + 2]);
        const bool is_half = lut.getInputHalfDomain();
        if (is_half && n != kHalfCount)
            refuse(fmt::format("half-domain table has {} entries; expected {}", n, kHalfCount));
        if (!is_half) require_finite(rows);
        CurveStage stage = is_half ? half_tables_of(rows) : tables_of(rows);
        if (is_half) require_finite(stage);
        if (lut.getHueAdjust() == OCIO::HUE_NONE) {
            table_.stages.emplace_back(std::move(stage));
        } else if (stage.is_uniform()) {
            table_.stages.emplace_back(HuePreservingStage{stage.f[0]});
        } else {
            refuse("keeps hues and has a table for each channel; expected one table");
        }
    }

    void require_finite(const std::vector<float>& values) const {
        const auto found = std::find_if_not(values.begin(), values.end(),
                                            [](float v) { return std::isfinite(v); });
        if (found == values.end()) return;
        refuse(fmt::format("number {} is {}; expected finite numbers", found - values.begin() + 1,
                           *found));
    }
    void require_finite(const CurveStage& stage) const {
        for (const Expr& f : stage.f) {
            for (const double v : f.table()->samples) {
                if (!std::isfinite(v))
                    refuse("a number of the half-domain table is not finite; expected finite ones");
            }
        }
    }

    void add(const OCIO::MatrixTransform& matrix) {
        std::array<double, 16> m44{};
        std::array<double, 4> offset{};
        matrix.getMatrix(m44.data());
        matrix.getOffset(offset.data());
        Matrix3 m{};
        for (std::size_t i = 0; i < 9; ++i)
            m.at(i / 3).at(i % 3) = m44.at(4 * (i / 3) + i % 3);
        const bool is_inverse = matrix.getDirection() == OCIO::TRANSFORM_DIR_INVERSE;
        const double sign = is_inverse ? -1 : 1;
        const Expr x = Expr::input();
        const CurveStage shift = {
            {x + sign * offset[0], x + sign * offset[1], x + sign * offset[2]}, std::nullopt};
        if (is_inverse && !is_identity(shift)) table_.stages.emplace_back(shift);
        const MatrixStage stage{is_inverse ? inverse(m) : m};
        if (!is_identity(stage)) table_.stages.emplace_back(stage);
        if (!is_inverse && !is_identity(shift)) table_.stages.emplace_back(shift);
    }

    void add(const OCIO::RangeTransform& range) {
        require_forward(range, "range");
        const Expr x = Expr::input();
        double slope = 1;
        double offset = 0;
        if (range.hasMinInValue() && range.hasMaxInValue()) {
            slope = (range.getMaxOutValue() - range.getMinOutValue()) /
                    (range.getMaxInValue() - range.getMinInValue());
            offset = range.getMinOutValue() - slope * range.getMinInValue();
        } else if (range.hasMinInValue()) {
            offset = range.getMinOutValue() - range.getMinInValue();
        } else if (range.hasMaxInValue()) {
            offset = range.getMaxOutValue() - range.getMaxInValue();
        }
        const CurveStage stage = curve_stage(x * slope + offset);
        if (!is_identity(stage)) table_.stages.emplace_back(stage);
        if (range.getStyle() == OCIO::RANGE_NO_CLAMP) return;
        table_.stages.emplace_back(
            ClampStage{range.hasMinOutValue() ? range.getMinOutValue() : -kInfinity,
                       range.hasMaxOutValue() ? range.getMaxOutValue() : kInfinity});
    }

    template <class Transform>
    void add_log(const Transform& log, double base, const Vector3& log_slope,
                 const Vector3& log_offset, const Vector3& lin_slope, const Vector3& lin_offset) {
        const bool is_inverse = log.getDirection() == OCIO::TRANSFORM_DIR_INVERSE;
        const Expr x = Expr::input();
        // Lower limit of OpenColorIO's logarithm.
        constexpr auto kLeast = static_cast<double>(std::numeric_limits<float>::min());
        std::array<Expr, 3> f = {x, x, x};
        for (std::size_t c = 0; c < 3; ++c) {
            if (is_inverse) {
                const Expr power = (x - log_offset[c]) * (std::log2(base) / log_slope[c]);
                f[c] = (exp2(power) - lin_offset[c]) / lin_slope[c];
            } else {
                f[c] = log2(max(x * lin_slope[c] + lin_offset[c], kLeast)) *
                           (log_slope[c] / std::log2(base)) +
                       log_offset[c];
            }
        }
        table_.stages.emplace_back(CurveStage{f, std::nullopt});
    }

    void add(const OCIO::CDLTransform& cdl) {
        require_forward(cdl, "CDL");
        Numbers slope{};
        Numbers offset{};
        Numbers power{};
        cdl.getSlope(slope.v);
        cdl.getOffset(offset.v);
        cdl.getPower(power.v);
        const bool has_clamp = cdl.getStyle() == OCIO::CDL_ASC;
        const Expr x = Expr::input();
        std::array<Expr, 3> f = {x, x, x};
        for (std::size_t c = 0; c < 3; ++c) {
            const Expr y = x * slope.v[c] + offset.v[c];
            // Without a clamp, powers of negatives are undefined.
            f[c] = has_clamp ? pow(clamp(y, 0, 1), power.v[c])
                             : select(less(y, 0), y, pow(max(y, 0), power.v[c]));
        }
        table_.stages.emplace_back(CurveStage{f, std::nullopt});
        const double saturation = cdl.getSat();
        if (saturation != 1) {
            Matrix3 m{};
            for (std::size_t i = 0; i < 3; ++i) {
                for (std::size_t k = 0; k < 3; ++k)
                    m[i][k] = (1 - saturation) * kRec709Weights[k] + (i == k ? saturation : 0);
            }
            table_.stages.emplace_back(MatrixStage{m});
        }
        if (has_clamp) table_.stages.emplace_back(ClampStage{0, 1});
    }

    std::string path_;
    TableFile table_;
};

}  // namespace

TableReader ocio_table_reader(TableReader next) {
    return [next = std::move(next)](const std::string& path) {
        const std::vector<std::string>& known = lut_text_extensions();
        const bool is_known =
            std::find(known.begin(), known.end(), extension_of(path)) != known.end();
        if (!is_known && next) return next(path);
        std::string contents;
        std::string note;
        TableFile table = Converter(path).convert(lut_transforms(path, contents, note));
        if (table.note.empty()) table.note = note;
        describe_table(table, path, contents);
        return table;
    };
}

TONEWRIGHT_NAMESPACE_END
