// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <OpenImageIO/imagebuf.h>

#include <optional>
#include <string>
#include <vector>

#include "tonewright/image_io.h"
#include "tonewright/lut_file.h"
#include "tonewright/pipeline.h"
#include "tonewright/sequence.h"
#include "tonewright/tonemap.h"

TONEWRIGHT_NAMESPACE_BEGIN

/// tonemap_files() for the files that have no problem yet.
///
/// With a timeout, each file has its own process. Incomplete output of a killed process is removed,
/// and `options.read.header` is not called. @see run_contained
/// @param timeout  seconds for each file; 0: no limit, and no processes
void tonemap_pictures(const Tonemapper& tonemapper, std::vector<FrameFiles>& files,
                      const SequenceOptions& options, double timeout);

/// Writes a picture in false color with its legend below it, in sRGB.
/// @param picture  in the size of the file, with associated alpha, upright
/// @param read     its `resize` is the size of the result
/// @throws Error  wider than 16384 pixels, or narrower than 16
void write_with_legend(const Tonemapper& tonemapper, OIIO::ImageBuf picture, const FrameFiles& file,
                       const WriteOptions& write, const ReadOptions& read, int nthreads);

/// A picture before a LUT.
struct LutSource {
    OIIO::ImageBuf picture;
    OIIO::TypeDesc type;  // of its file
    SourceColor color;
    std::string name;  // of the color of the file
};
/// Resizes and converts a picture where its color needs it.
/// @param picture  with associated alpha, upright
/// @param path     for messages
/// @param light    input, exposure, units and alpha of the picture; no operator
/// @throws FileError  a picture that has no such color
[[nodiscard]] LutSource lut_source(OIIO::ImageBuf picture, const std::string& path,
                                   const TonemapOptions& light, const ReadOptions& read,
                                   int nthreads);

/// A LUT instead of an operator.
struct LutPictureRequest {
    const LutFile& lut;
    std::string lut_name;
    /// Stages before the LUT.
    Pipeline before;
    /// Display of the LUT's code values, if it is known.
    std::optional<std::string> display;
    TonemapOptions::Unpremult unpremult;
    std::string resize;
    WriteOptions write;
    int nthreads = 0;
};
/// @throws FileError  a picture that cannot be written
void write_through_lut(const LutSource& source, const FrameFiles& file,
                       const LutPictureRequest& request);

TONEWRIGHT_NAMESPACE_END
