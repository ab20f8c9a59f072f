// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "tonewright/lut.h"

TONEWRIGHT_NAMESPACE_BEGIN

/// "AgX (agx_blender), davinci to rec1886".
[[nodiscard]] TONEWRIGHT_API std::string lut_title(const LutRequest& request);

/// The first lines of a LUT's header: the operator and its source.
[[nodiscard]] TONEWRIGHT_API std::vector<std::string> operator_lines(const View& view);
/// "Output: sRGB code values (IEC 61966-2-1)".
[[nodiscard]] TONEWRIGHT_API std::string output_line(const View& view);
/// On photographs.
[[nodiscard]] TONEWRIGHT_API std::string photograph_line(const LutError& error);
/// On every color of the input.
[[nodiscard]] TONEWRIGHT_API std::vector<std::string> error_lines(const LutError& error);

/// Operator, input, output and errors of a LUT.
[[nodiscard]] std::vector<std::string> lut_header(const Lut& lut, const LutRequest& request,
                                                  const LutError& error,
                                                  const std::optional<LutError>& other,
                                                  const std::optional<LutRinging>& ringing);

TONEWRIGHT_NAMESPACE_END
