// SPDX-License-Identifier: Apache-2.0
//
// Facts of a file's header that OpenImageIO's readers drop. Readers put them into the metadata of
// the picture, so that one function (picture_description.h) decides what they mean.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "picture/picture_spec.h"

TONEWRIGHT_NAMESPACE_BEGIN

/// Attributes of facts that OpenImageIO has no name for. Results do not keep them.
namespace file_tag {
inline constexpr const char* kAll = "tonewright:file:*";
/// OpenImageIO's name of the file's format. Present in every spec that complete_header() saw.
inline constexpr const char* kFormat = "tonewright:file:format";
/// Extension of the file's name, in lower case.
inline constexpr const char* kExtension = "tonewright:file:extension";
/// The value of `oiio:ColorSpace` after reading. Another value now: the pixels were converted.
inline constexpr const char* kColorSpace = "tonewright:file:colorspace";
/// PNG: the chunk sRGB, with its rendering intent.
inline constexpr const char* kSrgb = "tonewright:file:srgb";
/// Exponent that decodes the code values (PNG: 1/gAMA).
inline constexpr const char* kGamma = "tonewright:file:gamma";
/// Primaries and white, float[8] as in `chromaticities`, of code values.
inline constexpr const char* kPrimaries = "tonewright:file:primaries";
/// Why the file cannot be decoded; one line.
inline constexpr const char* kImpossible = "tonewright:file:impossible";
/// Tags that are read and not used: lines, each `TAG: what follows`.
inline constexpr const char* kIgnored = "tonewright:file:ignored";
/// The layer and the subimage that were chosen, and the choices.
inline constexpr const char* kLayer = "tonewright:file:layer";
inline constexpr const char* kSubimage = "tonewright:file:subimage";
/// The pixels were decoded to light. The name of the color they had.
inline constexpr const char* kLight = "tonewright:file:light";
/// The color of that light, double[10]: primaries and white, 1 if it is absolute, and the factor on
/// it.
inline constexpr const char* kLightColor = "tonewright:file:light_color";
}  // namespace file_tag

/// ITU-T H.273 code points as OpenImageIO 3.1 names them: int[4], primaries, transfer, matrix,
/// full range.
inline constexpr const char* kCicpTag = "CICP";

/// Adds the facts of the file's header to the spec of a subimage. Damaged headers add nothing: the
/// reader of the pixels reports them.
/// @param format    OpenImageIO's name
/// @param subimage  only parts of OpenEXR and pages of TIFF have headers of their own
TONEWRIGHT_API void complete_header(const std::string& path, std::string_view format, int subimage,
                                    PictureSpec& spec);

/// Adds a line to kIgnored.
TONEWRIGHT_API void add_ignored(PictureSpec& spec, const std::string& line);
/// The lines of kIgnored.
[[nodiscard]] TONEWRIGHT_API std::vector<std::string> ignored_of(const PictureSpec& spec);

TONEWRIGHT_NAMESPACE_END
