// SPDX-License-Identifier: Apache-2.0
#include "cli/lut_input.h"

#include <algorithm>
#include <cmath>

#include "base/format_number.h"
#include "base/strings.h"
#include "cli/picture_output.h"
#include "tonewright/lut.h"

TONEWRIGHT_NAMESPACE_BEGIN

void add_lut_options(CLI::App& command, LutOptions& options, CLI::Option* op,
                     const std::vector<std::string>& others) {
    CLI::Option* lut = command.add_option("--lut", options.file,
                                          "instead of an operator a LUT, anybody's: through "
                                          "OpenColorIO .cube, .clf, .ctf, .csp, .3dl, "
                                          ".spi1d, .spi3d, .lut, .itx, .spimtx and .cc, ICC device "
                                          "links (.icc), raw floats (.raw), Hald "
                                          "CLUTs and strips (pictures)");
    lut->excludes(op);
    for (const std::string& other : others)
        lut->excludes(command.get_option(other));
    command
        .add_option(
            "--interpolation", options.interpolation,
            "between the nodes of a cube: tetrahedral, trilinear, or auto: what the file says, "
            "else tetrahedral")
        ->capture_default_str()
        ->needs(lut);
    command
        .add_option("--input-encoding", options.encoding,
                    "what the LUT expects (see `tonewright bake --help`): the light is encoded so; "
                    "without it colors go in as they are")
        ->needs(lut);
    command
        .add_option("--lut-space", options.space,
                    "scene-linear space that the LUT's input is of; default: its encoding's own")
        ->needs(lut);
}

LutFile open_lut(const std::string& path, const std::string& interpolation) {
    silence_opencolorio();
    const LutInterpolation between = parse_lut_interpolation(interpolation);
    const std::string extension = extension_of(path);
    constexpr const char* kPictures[] = {".png", ".tif", ".tiff", ".exr", ".tga", ".bmp", ".dpx"};
    if (std::find(std::begin(kPictures), std::end(kPictures), extension) == std::end(kPictures))
        return LutFile(path, between);
    return LutFile(load_lut_picture(path), between);
}

Pipeline before_lut(const CLI::App& command, const LutOptions& options, const ViewOptions& view,
                    const SourceColor& input) {
    if (options.encoding.empty()) {
        for (const char* name : {"--input", "--exposure", "--lut-space"}) {
            if (command.count(name) > 0) {
                throw Error(command.get_name() + ": " + name + " is given for " + options.file +
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
