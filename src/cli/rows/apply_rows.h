// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "cli/picture_options.h"

TONEWRIGHT_NAMESPACE_BEGIN

/// `apply` of one OpenEXR picture to OpenEXR, PNG or JPEG, without OpenImageIO.
/// @returns  false: the picture commands must do it. Nothing was written or printed.
[[nodiscard]] bool apply_rows(const ApplyOptions& options);

TONEWRIGHT_NAMESPACE_END
