// SPDX-License-Identifier: Apache-2.0
#include "tasks/pictures/read_picture.h"

#include <fmt/format.h>

#include <cstddef>
#include <utility>

#include "base/input_file.h"
#include "base/strings.h"
#include "image/picture_file.h"
#include "image/resize.h"
#include "image/source_picture.h"
#include "pipeline/exposure.h"
#include "tonewright/engine.h"

TONEWRIGHT_NAMESPACE_BEGIN

OIIO::ImageBuf read_picture(const std::string& path, const ReadOptions& read,
                            std::string_view input) {
    OIIO::ImageBuf stored = read_image(path, read);
    OIIO::ImageBuf picture =
        with_memory_for(path, [&] { return with_associated_alpha(upright(std::move(stored))); });
    about_picture(path, [&] { report_header(picture.spec(), input, read); });
    return picture;
}

OIIO::ImageBuf to_rec709_light(const OIIO::ImageBuf& picture, const SourceColor& source,
                               double reference_white, const std::string& path) {
    if (source.convert) {
        const OIIO::ImageBuf light = converted_picture(picture, source);
        return to_rec709_light(light, source_color(light.spec(), kAutoInput), reference_white,
                               path);
    }
    Pipeline stages = exposed_stages(source.decode, scene_scale(source, reference_white));
    stages.emplace_back(MatrixStage{rgb_to_rgb(source.primaries, kRec709)});
    const SimdEngine engine(stages);
    OIIO::ImageBuf scene;
    const auto run = [&](const float* in, float* out, std::size_t n) {
        engine.run_rgb(in, out, n);
    };
    if (!map_colors(scene, picture, run))
        throw FileError(path + ": " + first_line(scene.geterror()));
    return scene;
}

std::vector<float> light_pixels(const OIIO::ImageBuf& picture, const std::string& path) {
    if (picture.nchannels() < 3) {
        throw FileError(
            fmt::format("{}: it has {} channels; expected 3", path, picture.nchannels()));
    }
    const SourceColor source =
        about_picture(path, [&] { return source_color(picture.spec(), kAutoInput); });
    const OIIO::ImageBuf image = to_rec709_light(picture, source, kUnitLuminance, path);
    const int channels = image.nchannels();
    const auto& spec = image.spec();
    const auto step = static_cast<int>(spec.image_pixels() / 1000000 + 1);
    std::vector<float> pixel(static_cast<std::size_t>(channels));
    std::vector<float> rgb;
    int index = 0;
    for (int y = spec.y; y < spec.y + spec.height; ++y) {
        for (int x = spec.x; x < spec.x + spec.width; ++x) {
            if (index++ % step) continue;
            image.getpixel(x, y, pixel.data(), channels);
            rgb.insert(rgb.end(), pixel.begin(), pixel.begin() + 3);
        }
    }
    return rgb;
}

PictureInfo read_picture_info(const std::string& path, ReadOptions read, const std::string& input) {
    PictureInfo info;
    std::vector<std::string> warnings;
    read.warn = [&](const std::string& text) { warnings.push_back(text); };
    read.note = [&](const std::string& text) { info.choices.push_back(text); };
    about_picture(path, [&] {
        info.spec = PictureReader(path, 1, read).spec();
        info.said = describe_picture(info.spec, input);
    });
    info.said.ignored.insert(info.said.ignored.begin(), warnings.begin(), warnings.end());
    return info;
}

TONEWRIGHT_NAMESPACE_END
