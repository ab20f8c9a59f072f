// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>

#include "picture/picture_spec.h"
#include "tonewright/tonemap_options.h"

TONEWRIGHT_NAMESPACE_BEGIN

/// Provenance of the result, without date and machine: the same run writes the same bytes.
/// @param resize  @see ReadOptions::resize
TONEWRIGHT_API void add_provenance(PictureSpec& picture, const TonemapOptions& options,
                                   const std::string& resize);

/// A picture without a date gets that of SOURCE_DATE_EPOCH, or its file's: writers of EXR, TIFF and
/// DPX would record the current time, and a second run would give other bytes.
/// @param path  of the source
TONEWRIGHT_API void give_date(PictureSpec& picture, const std::string& path);

/// First words of the warning about a picture that is made for a display already. @see
/// finished_warning
inline constexpr std::string_view kFinishedPicture = "finished for a display (";

/// The warning that a picture is tone mapped a second time: its header or its format says that it
/// holds code values of an SDR display, and the operator expects light of a scene. Empty for HDR
/// pictures, camera logs, film, textures and light, if the user names the input, and for operators
/// that show a picture as it is (`clamp`), false colors and LUTs.
[[nodiscard]] TONEWRIGHT_API std::string finished_warning(const PictureSpec& spec,
                                                          const TonemapOptions& options);

TONEWRIGHT_NAMESPACE_END
