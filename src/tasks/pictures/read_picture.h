// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <OpenImageIO/imagebuf.h>

#include <string>
#include <string_view>
#include <vector>

#include "picture/picture_description.h"
#include "tasks/json.h"
#include "tonewright/image_io.h"
#include "tonewright/tonemap.h"

TONEWRIGHT_NAMESPACE_BEGIN

/// read_image() with associated alpha, upright. The callbacks of `read` also hear what the header
/// says.
/// @param input  color of the picture. @see TonemapOptions::input
/// @throws FileError  @see read_image
[[nodiscard]] OIIO::ImageBuf read_picture(const std::string& path, const ReadOptions& read,
                                          std::string_view input = kAutoInput);

/// Scene-linear Rec.709 light of a picture with the color `source`.
/// @param reference_white  of absolute sources, cd/m2
/// @throws FileError  a picture that cannot be read
[[nodiscard]] OIIO::ImageBuf to_rec709_light(const OIIO::ImageBuf& picture,
                                             const SourceColor& source, double reference_white,
                                             const std::string& path);

/// Scene-linear Rec.709 of a picture: every pixel up to a million, then every n-th.
/// @throws FileError  a picture with less than three channels
[[nodiscard]] std::vector<float> light_pixels(const OIIO::ImageBuf& picture,
                                              const std::string& path);

/// The header of a picture.
struct PictureInfo {
    OIIO::ImageSpec spec;
    PictureDescription said;  // with the warnings of the reader among `ignored`
    /// Lines about the layer and the subimage.
    std::vector<std::string> choices;
};
/// The texts may refer to parameters. @see render
/// @throws FileError  @see read_image
[[nodiscard]] PictureInfo read_picture_info(const std::string& path, ReadOptions read,
                                            const std::string& input);
/// "Rec.709", or the coordinates.
[[nodiscard]] std::string primaries_text(const Primaries& p);
/// "D65", or the coordinates.
[[nodiscard]] std::string white_text(const Chromaticity& white);
/// @param path  of the picture
[[nodiscard]] Json to_json(const std::string& path, const PictureInfo& info);

TONEWRIGHT_NAMESPACE_END
