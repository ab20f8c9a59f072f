// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tonewright/local.h"

/// Each file of this folder defines one operator and its implementation for pictures.
TONEWRIGHT_NAMESPACE_BEGIN

[[nodiscard]] Operator define_exposure_fusion();
[[nodiscard]] Operator define_local_laplacian();
[[nodiscard]] Operator define_reinhard_local();

/// Negatives of all local operators: their planes are in Rec.709.
inline constexpr const char* kLocalNegatives =
    "clamped at 0 in Rec.709, before the operator, which limits colors outside Rec.709 to it";

/// @throws Error  the value of the parameter is no whole number
void check_whole_number(const Params& params, const char* name);
/// The value. @throws Error  as check_whole_number()
[[nodiscard]] int whole_number(const Params& params, const char* name);

TONEWRIGHT_NAMESPACE_END
