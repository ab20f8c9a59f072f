// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <OpenImageIO/typedesc.h>

#include <array>
#include <cstddef>
#include <functional>
#include <string>
#include <string_view>

#include "tonewright/error.h"

OIIO_NAMESPACE_BEGIN
class ImageSpec;
OIIO_NAMESPACE_END

/// Options of reading and writing pictures (image_io.h). No library of OpenImageIO is needed for
/// them.
TONEWRIGHT_NAMESPACE_BEGIN

/// Default limit of the pixels (width x height x depth) that a picture may declare: 12 GB as three
/// floats each. A file of a kilobyte can declare more than fits into memory.
inline constexpr double kMaxPixels = 1e9;

/// Which picture of a file is read, and how much of it.
struct ReadOptions {
    /// Subimage (a part of an OpenEXR file, a page, a frame): its number, counted from 0, or its
    /// name. Empty: of OpenEXR files the first part with a picture in color, else the first.
    std::string subimage = {};
    /// Layer of an OpenEXR file, whose channels alone are read then: its name, or the last parts of
    /// it ("Combined" of "ViewLayer.Combined"), in any case. Empty: R, G, B; else a layer with a
    /// usual name of a picture (Combined, beauty, rgba, ...); else the first one in color that is
    /// no data (ambient occlusion, depth, normals, cryptomattes, ...). Other channels follow.
    std::string layer = {};
    /// Size of the picture: `1920x1080`, `1920` (the width; the height follows from the picture's
    /// shape) or `50%`. Empty: as in the file. It is the size of the display window; the data
    /// window changes with it. The picture becomes scene-linear light in floats, with associated
    /// alpha. The filter is Lanczos (`lanczos3` of ImageBufAlgo::resize()); light above 1 takes a
    /// filter without negative lobes (`triangle`), so that lamps have no rings. Channels beyond
    /// color and alpha take the nearest pixel. The whole picture is in memory.
    std::string resize = {};
    /// Limit of the pixels that the file may declare.
    double max_pixels = kMaxPixels;
    /// Receives warnings about the file, one line each, without its name: tags that are not used.
    /// @see render
    std::function<void(const std::string&)> warn = {};
    /// Receives the choice of layer and subimage where there was one, one line without the name.
    /// @see render
    std::function<void(const std::string&)> note = {};
    /// Receives the header of the picture that is tone mapped, before anything is converted.
    std::function<void(const OIIO::ImageSpec&)> header = {};
};

/// Options for writing a picture file.
struct WriteOptions {
    /// Pixel type of the file; UNKNOWN: the buffer's, or OIIO's replacement for this format (8 bits
    /// for a float picture as PNG or JPEG, but 16 for PNG in PQ or HLG). OpenEXR files that
    /// tonemap_file() writes are half if the source is half or has 8 bits, else float. The source's
    /// type is the widest of its channels, as of half colors and a float Z.
    OIIO::TypeDesc type = OIIO::TypeUnknown;
    /// Bits of each channel of a DPX file, 10 or 12, with `type` UINT16. 0: all bits of the type.
    int bits = 0;
    /// Treatment of the alpha channel.
    enum class Alpha : unsigned char {
        keep,
        /// Leaves it out.
        ignore,
        /// Writes 1 everywhere.
        opaque,
        /// Composites over `background`, and leaves alpha out.
        over,
    };
    Alpha alpha = Alpha::keep;
    /// With Alpha::over: R, G, B in the output's code values, as in ImageMagick's `-background`
    /// and oiiotool's `--over`. The result is color + (1 - alpha) background in code values,
    /// because browsers and editors show a picture with alpha that way.
    std::array<float, 3> background = {};
    /// A method of the format, with `:quality` if it has one, like oiiotool's `--compression`.
    /// Empty: the source's if the format has it, else the format's default.
    std::string compression = {};
    /// Quality, [1, 100], like oiiotool's `--quality`. 0: the format's default.
    int quality = 0;
    /// Resolution of a JPEG file's chroma by oiiotool's names of `jpeg:subsampling`: 4:4:4, 4:2:2,
    /// 4:2:0 or 4:1:1. Empty: 4:4:4 from quality 90 on, below that 4:2:0.
    std::string subsampling = {};
    /// Reads all pixels of the written file, and compares them with those that were to be written,
    /// before the file gets its final name. Needs memory for a copy of the picture.
    bool verifies = false;
    /// A picture in a format without a data window is padded with black to the display window, up
    /// to this many pixels, or four times those of the data window.
    double max_pixels = 1e8;
    /// tonemap_file() records the provenance: `Software` has version, operator, parameters,
    /// exposure and display. OpenEXR and PNG files also get the attributes `tonewright:operator`,
    /// `tonewright:exposure`, `tonewright:resize` and `tonewright:display`.
    bool write_provenance = false;
    /// Receives warnings about the file, in one line without its name, before the file gets its
    /// final name. An exception stops the writing. @see render
    std::function<void(const std::string&)> warn = {};
    /// Receives the number of written rows and of all rows, after some of them, from one thread.
    std::function<void(std::size_t done, std::size_t total)> progress = {};
};

/// Sets `alpha` and `background` from `keep`, `ignore`, `opaque`, or `over:R,G,B` with numbers in
/// [0, 1].
/// @throws Error  for any other text, with the nearest name
TONEWRIGHT_API void set_alpha(WriteOptions& options, std::string_view text);

/// `uint8`, `uint16`, `half` or `float`, as in oiiotool's `-d`.
/// @throws Error  for any other text, with the nearest name
[[nodiscard]] TONEWRIGHT_API OIIO::TypeDesc parse_pixel_type(std::string_view text);

/// Sets `type` and `bits` from the same names, or `uint10` and `uint12` (for DPX).
/// @throws Error  for any other text, with the nearest name
TONEWRIGHT_API void set_pixel_type(WriteOptions& options, std::string_view text);

TONEWRIGHT_NAMESPACE_END
