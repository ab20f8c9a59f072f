// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

namespace tonewright {

/// One table as a Common LUT Format file (Academy S-2014-006, version 3), 32-bit float in and out.
struct ClfTable {
    int dimension = 1;  // 1 or 3
    int size = 0;       // entries, or grid points a side
    int channels = 1;   // 1D: 1 or 3
    bool is_half_domain = false;
    /// 1D: entry by entry. 3D: RGB triplets, BLUE fastest, as CLF has them.
    const std::vector<float>* values = nullptr;
    /// Decimals of a 3D table whose interpolation error dwarfs them; 0 = 9 significant digits.
    int decimals = 0;
};

[[nodiscard]] std::string write_clf(const ClfTable& table, const std::string& name,
                                    const std::vector<std::string>& description);

}  // namespace tonewright
