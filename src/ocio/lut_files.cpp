// SPDX-License-Identifier: Apache-2.0
#include "ocio/lut_files.h"
#include "base/strings.h"

#include <array>

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

std::vector<float> values_of(const OCIO::Lut1DTransform& lut, ClfTable& table) {
    const unsigned long n = lut.getLength();
    std::array<std::vector<float>, 3> channel;
    for (unsigned long i = 0; i < n; ++i) {
        float r = 0;
        float g = 0;
        float b = 0;
        lut.getValue(i, r, g, b);
        channel[0].push_back(r);
        channel[1].push_back(g);
        channel[2].push_back(b);
    }
    std::vector<float> values;
    const bool one = channel[0] == channel[1] && channel[1] == channel[2];
    for (unsigned long i = 0; i < n; ++i) {
        for (std::size_t c = 0; c < (one ? 1U : 3U); ++c)
            values.push_back(channel[c][i]);
    }
    table.size = static_cast<int>(n);
    table.channels = one ? 1 : 3;
    table.is_half_domain = lut.getInputHalfDomain();
    table.is_hue_preserving = lut.getHueAdjust() == OCIO::HUE_DW3;
    return values;
}

std::vector<float> values_of(const OCIO::Lut3DTransform& cube, ClfTable& table) {
    const unsigned long n = cube.getGridSize();
    std::vector<float> values;
    values.reserve(3 * n * n * n);
    for (unsigned long r = 0; r < n; ++r) {
        for (unsigned long g = 0; g < n; ++g) {
            for (unsigned long b = 0; b < n; ++b) {
                std::array<float, 3> v{};
                cube.getValue(r, g, b, v[0], v[1], v[2]);
                values.insert(values.end(), v.begin(), v.end());
            }
        }
    }
    table.dimension = 3;
    table.size = static_cast<int>(n);
    table.channels = 3;
    return values;
}

}  // namespace

OCIO::GroupTransformRcPtr LutFiles::externalise(const OCIO::GroupTransformRcPtr& group,
                                                const std::string& stem, const std::string& what,
                                                bool is_exact) {
    OCIO::GroupTransformRcPtr out = OCIO::GroupTransform::Create();
    int count = 0;
    for (int i = 0; i < group->getNumTransforms(); ++i) {
        const OCIO::TransformRcPtr t = group->getTransform(i);
        ClfTable table;
        table.numbers = ClfTable::Numbers::compact;
        std::vector<float> values;
        std::string part;
        if (const auto lut = OCIO_DYNAMIC_POINTER_CAST<OCIO::Lut1DTransform>(t)) {
            values = values_of(*lut, table);
            part = "curve";
        } else if (const auto cube = OCIO_DYNAMIC_POINTER_CAST<OCIO::Lut3DTransform>(t)) {
            values = values_of(*cube, table);
            // 8e-6, a thirtieth of what interpolating between the nodes of a sampled operator
            // costs in the mean. A lattice has nothing else to be wrong in: 5e-8.
            table.numbers = is_exact ? ClfTable::Numbers::decimals_7 : ClfTable::Numbers::codes;
            part = "cube";
        } else {
            out->appendTransform(t);
            continue;
        }
        table.values = &values;
        part += count++ ? std::to_string(count) : "";
        OCIO::FileTransformRcPtr file = OCIO::FileTransform::Create();
        file->setSrc(file_for(table, stem + "_" + part, what).c_str());
        file->setInterpolation(table.dimension == 3 ? OCIO::INTERP_TETRAHEDRAL
                                                    : OCIO::INTERP_LINEAR);
        file->setDirection(t->getDirection());
        out->appendTransform(file);
    }
    return out;
}

std::string LutFiles::file_for(const ClfTable& table, const std::string& stem,
                               const std::string& what) {
    std::string key(reinterpret_cast<const char*>(table.values->data()),
                    table.values->size() * sizeof(float));
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
