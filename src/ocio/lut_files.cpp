// SPDX-License-Identifier: Apache-2.0
#include "ocio/lut_files.h"

#include <optional>

#include "base/strings.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

/// The table of an operation that has one.
std::optional<ClfTable> table_of(const LoweredOp& op, bool is_exact) {
    if (const auto* lut = std::get_if<Lut1DOp>(&op.op)) {
        return ClfTable{.dimension = 1,
                        .size = lut->size(),
                        .channels = lut->channels,
                        .is_half_domain = lut->is_half_domain,
                        .is_hue_preserving = lut->keeps_hue,
                        .values = lut->values,
                        .numbers = ClfTable::Numbers::compact};
    }
    if (const auto* lut = std::get_if<Lut3DOp>(&op.op)) {
        // 8e-6, a thirtieth of what interpolating between the nodes of a sampled operator costs in
        // the mean. A lattice has nothing else to be wrong in: 5e-8.
        return ClfTable{
            .dimension = 3,
            .size = lut->edge,
            .channels = 3,
            .values = lut->values,
            .numbers = is_exact ? ClfTable::Numbers::decimals_7 : ClfTable::Numbers::codes};
    }
    return std::nullopt;
}

}  // namespace

OCIO::GroupTransformRcPtr LutFiles::to_ocio(const LoweredOps& ops, const std::string& stem,
                                            const std::string& what, bool is_exact) {
    OCIO::GroupTransformRcPtr out = OCIO::GroupTransform::Create();
    int count = 0;
    for (const LoweredOp& op : ops) {
        const auto table = table_of(op, is_exact);
        if (!table) {
            out->appendTransform(tonewright::to_ocio(op));
            continue;
        }
        std::string part = table->dimension == 3 ? "cube" : "curve";
        if (count++) part += std::to_string(count);
        const OCIO::FileTransformRcPtr file = OCIO::FileTransform::Create();
        file->setSrc(file_for(*table, stem + "_" + part, what).c_str());
        file->setInterpolation(table->dimension == 3 ? OCIO::INTERP_TETRAHEDRAL
                                                     : OCIO::INTERP_LINEAR);
        if (op.is_inverse) file->setDirection(OCIO::TRANSFORM_DIR_INVERSE);
        out->appendTransform(file);
    }
    return out;
}

std::string LutFiles::file_for(const ClfTable& table, const std::string& stem,
                               const std::string& what) {
    std::string key(reinterpret_cast<const char*>(table.values.data()),
                    table.values.size() * sizeof(float));
    key += std::to_string(table.size) + (table.is_half_domain ? "half" : "") +
           (table.is_hue_preserving ? "hue" : "");
    const auto [it, is_new] =
        names_.emplace(key, stem + "_" + content_hash(key) + file_extension(table));
    if (is_new) {
        const std::string note =
            table.dimension == 1 ? ": one entry for every half float" : ": behind its shaper";
        files_.push_back(
            {folder_ + "/" + it->second, write_clf(table, what, {"Tonewright, " + what + note})});
    }
    return it->second;
}

TONEWRIGHT_NAMESPACE_END
