// SPDX-License-Identifier: Apache-2.0
#include "tasks/pictures/read_picture.h"

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <cstddef>
#include <utility>

#include "base/input_file.h"
#include "base/strings.h"
#include "image/converted_picture.h"
#include "image/picture_file.h"
#include "image/resize.h"
#include "image/spec_conversion.h"
#include "picture/picture_description.h"
#include "pipeline/exposure.h"
#include "tonewright/engine.h"

TONEWRIGHT_NAMESPACE_BEGIN

OIIO::ImageBuf read_picture(const std::string& path, const ReadOptions& read,
                            std::string_view input) {
    OIIO::ImageBuf stored = read_image(path, read);
    OIIO::ImageBuf picture =
        with_memory_for(path, [&] { return with_associated_alpha(upright(std::move(stored))); });
    about_picture(path, [&] { report_header(picture_spec(picture.spec()), input, read); });
    return picture;
}

OIIO::ImageBuf to_rec709_light(const OIIO::ImageBuf& picture, const SourceColor& source,
                               double reference_white, const std::string& path) {
    if (source.convert) {
        const OIIO::ImageBuf light = converted_picture(picture, source);
        return to_rec709_light(light, source_color(picture_spec(light.spec()), kAutoInput),
                               reference_white, path);
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
        about_picture(path, [&] { return source_color(picture_spec(picture.spec()), kAutoInput); });
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
        info.said = describe_picture(picture_spec(info.spec), input);
    });
    info.said.ignored.insert(info.said.ignored.begin(), warnings.begin(), warnings.end());
    return info;
}

std::string primaries_text(const Primaries& p) {
    for (const InputSpace& space : all_input_spaces()) {
        if (space.primaries == p) return std::string(p.name);
    }
    std::vector<std::string> numbers;
    for (const Chromaticity& c : {p.red, p.green, p.blue})
        numbers.push_back(fmt::format("{:.4f} {:.4f}", c.x, c.y));
    return fmt::format("red {}, green {}, blue {}", numbers[0], numbers[1], numbers[2]);
}

std::string white_text(const Chromaticity& white) {
    constexpr std::array<std::pair<const char*, Chromaticity>, 3> kWhites = {
        {{"D65", kD65}, {"D60 (ACES)", kAP0.whitepoint}, {"E", {1.0 / 3, 1.0 / 3}}}};
    for (const auto& [name, known] : kWhites) {
        constexpr double kSame = 5e-5;
        if (std::fabs(known.x - white.x) < kSame && std::fabs(known.y - white.y) < kSame)
            return name;
    }
    return fmt::format("{:.4f} {:.4f}", white.x, white.y);
}

Json to_json(const std::string& path, const PictureInfo& info) {
    const auto& [spec, said, choices] = info;
    const Primaries& p = said.color.primaries;
    Json primaries = Json::array({p.red.x, p.red.y, p.green.x, p.green.y, p.blue.x, p.blue.y});
    return {{"file", path},
            {"width", spec.width},
            {"height", spec.height},
            {"channels", spec.nchannels},
            {"type", std::string(spec.format.c_str())},
            {"space", said.color.name},
            {"transfer", said.transfer},
            {"primaries", primaries},
            {"white", Json::array({p.whitepoint.x, p.whitepoint.y})},
            {"orientation", said.orientation},
            {"layer", said.layer},
            {"subimage", said.subimage},
            {"units", said.units},
            {"alpha", said.alpha},
            {"rule", said.rule},
            {"ignored", said.ignored},
            {"choices", choices}};
}

TONEWRIGHT_NAMESPACE_END
