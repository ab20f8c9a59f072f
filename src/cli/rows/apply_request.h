// SPDX-License-Identifier: Apache-2.0
//
// `apply`: its options as requests, and its words. Both modules of picture commands use them.
#pragma once

#include <optional>
#include <string>

#include "cli/messages.h"
#include "cli/picture_options.h"
#include "picture/picture_spec.h"
#include "tonewright/picture_options.h"
#include "tonewright/tonemap_options.h"

TONEWRIGHT_NAMESPACE_BEGIN

/// The options of the library, without callbacks.
[[nodiscard]] ReadOptions read_options_of(const PictureChoice& choice);
[[nodiscard]] TonemapOptions::Unpremult alpha_of(const PictureInput& input);

[[nodiscard]] WriteOptions write_options_of(const ApplyOptions& options);
/// All but the operator.
[[nodiscard]] TonemapOptions tonemap_options_of(const ApplyOptions& options,
                                                const WriteOptions& write);

/// True if the output has the pixel type of the input, because no option states one.
[[nodiscard]] bool keeps_type(const std::string& out, const ApplyOptions& options);
void tell_default_operator(const ApplyOptions& options);

/// A picture that was tone mapped.
struct AppliedPicture {
    const std::string& in;
    const std::string& out;
    PictureSpec source;
    std::optional<double> exposure_stops = {};  // instead of the options'
    std::string resized = {};                   // ", resized to 960 x 540"; empty: it is not
    int threads = 1;
};
/// "render.exr (640 x 360 half, lin_rec709) -> out.png: AgX (agx_blender), exposure +1, sRGB,
/// 0.12 s"
void print_result(const AppliedPicture& done, const TonemapOptions& options,
                  const ApplyOptions& given, const ResultLine& line);

TONEWRIGHT_NAMESPACE_END
