// SPDX-License-Identifier: Apache-2.0
#include "cli/lut_input.h"

#include <algorithm>
#include <cmath>

#include "base/format_number.h"
#include "base/strings.h"
#include "tonewright/lut.h"

TONEWRIGHT_NAMESPACE_BEGIN

LutFile open_lut(const std::string& path, const std::string& interpolation,
                 const std::function<Lut(const std::string&)>& read_picture) {
    silence_opencolorio();
    const LutInterpolation between = parse_lut_interpolation(interpolation);
    const std::string extension = extension_of(path);
    constexpr const char* kPictures[] = {".png", ".tif", ".tiff", ".exr", ".tga", ".bmp", ".dpx"};
    if (std::find(std::begin(kPictures), std::end(kPictures), extension) == std::end(kPictures))
        return LutFile(path, between);
    return LutFile(read_picture(path), between);
}

Pipeline before_lut(const char* command, const LutOptions& options, const ViewOptions& view,
                    const SourceColor& input) {
    if (options.encoding.empty()) {
        for (const char* name : {"--input", "--exposure", "--lut-space"}) {
            if (view.given.contains(name)) {
                throw Error(std::string(command) + ": " + name + " is given for " + options.file +
                            "; expected --input-encoding with it, or the LUT takes colors as they "
                            "are");
            }
        }
        return {};
    }
    const InputEncoding encoding = parse_input_encoding(options.encoding);
    if (!(std::fabs(view.exposure) <= 64))
        throw Error("exposure is " + shortest(view.exposure) + "; expected [-64, 64] stops");
    const InputSpace& to =
        find_input_space(options.space.empty() ? encoding.default_input : options.space);
    Pipeline stages = input.decode;
    const Matrix3 matrix = rgb_to_rgb(input.primaries, to.primaries);
    stages.push_back(MatrixStage{scale(matrix, std::exp2(view.exposure))});
    stages.push_back(curve_stage(encoding.encode));
    return stages;
}

TONEWRIGHT_NAMESPACE_END
