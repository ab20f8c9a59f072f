// SPDX-License-Identifier: Apache-2.0
#include "cli/pictures/picture_input.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <charconv>
#include <cstdio>
#include <filesystem>
#include <system_error>

#include "base/strings.h"
#include "cli/messages.h"
#include "cli/pictures/commands.h"
#include "image/picture_file.h"
#include "image/resize.h"
#include "image/tonemap_file.h"
#include "pipeline/exposure.h"
#include "tonewright/engine.h"
#include "tonewright/image_io.h"

TONEWRIGHT_NAMESPACE_BEGIN

QuietStderr::QuietStderr() : saved_(::dup(STDERR_FILENO)) {
    std::fflush(stderr);
    const int nowhere = ::open("/dev/null", O_WRONLY | O_CLOEXEC);
    if (saved_ >= 0 && nowhere >= 0) ::dup2(nowhere, STDERR_FILENO);
    if (nowhere >= 0) ::close(nowhere);
}

QuietStderr::~QuietStderr() {
    std::fflush(stderr);
    if (saved_ < 0) return;
    ::dup2(saved_, STDERR_FILENO);
    ::close(saved_);
}

bool is_same_file(const std::string& a, const std::string& b) {
    std::error_code error;
    return std::filesystem::equivalent(a, b, error) && !error;
}

namespace {

bool is_of_number(char c) { return (c >= '0' && c <= '9') || c == '.'; }

std::string without_numbers(std::string text) {
    std::erase_if(text, is_of_number);
    return text;
}

std::vector<double> numbers_of(const std::string& text) {
    std::vector<double> numbers;
    for (std::size_t i = 0; i < text.size(); ++i) {
        if (!is_of_number(text[i])) continue;
        double number = 0;
        const char* const begin = text.data() + i;
        const char* const end =
            std::from_chars(begin, text.data() + text.size(), number, std::chars_format::fixed).ptr;
        numbers.push_back(number);
        if (end > begin) i += static_cast<std::size_t>(end - begin) - 1;
    }
    return numbers;
}

}  // namespace

void Warnings::add(const std::string& text) {
    const std::string named = name_.empty() ? text : fmt::format("{}: {}", name_, text);
    if (message_options().is_strict) warn(named);  // throws
    // The figures of a shot differ from frame to frame, and one line for all of them is enough: the
    // one of the worst frame, in whatever order the frames end.
    const auto known = std::find_if(texts_.begin(), texts_.end(), [&](const std::string& other) {
        return name_.empty() ? other == named : without_numbers(other) == without_numbers(named);
    });
    if (known == texts_.end())
        texts_.push_back(named);
    else if (numbers_of(*known) < numbers_of(named))
        *known = named;
}

void Warnings::print() {
    for (const std::string& text : texts_)
        warn(text);
    texts_.clear();
}

void Notes::add(const std::string& text) {
    const std::string named = name_.empty() ? text : fmt::format("{}: {}", name_, text);
    if (std::find(texts_.begin(), texts_.end(), named) == texts_.end()) texts_.push_back(named);
}

void Notes::print() {
    for (const std::string& text : texts_) {
        if (!message_options().is_quiet) print_message(text);
    }
    texts_.clear();
}

ReadOptions read_options_of(const PictureChoice& choice) {
    ReadOptions options;
    if (choice.subimage.starts_with('-')) {
        throw Error("--subimage is " + printable(choice.subimage) +
                    "; expected a number from 0, or a name");
    }
    options.subimage = choice.subimage;
    options.layer = choice.layer;
    options.max_pixels = choice.max_pixels.value_or(kMaxPixels);
    return options;
}

void check_resize(const char* command, const std::string& resize, const PictureChoice& choice) {
    ResizeSize size;
    try {
        size = parse_resize(resize);
    } catch (const Error& e) {
        throw Error(fmt::format("{}: --{}", command, e.what()));
    }
    const double most = choice.max_pixels.value_or(kMaxPixels);
    if (static_cast<double>(size.width) * std::max(size.height, 1) > most) {
        throw Error(fmt::format("{}: --resize is {}; expected at most {:.0f} pixels (--max-pixels)",
                                command, resize, most));
    }
}

bool FinishedPictures::take(const std::string& text) {
    const std::size_t at = text.find(kFinishedPicture);
    if (at == std::string::npos) return false;
    constexpr std::string_view kColon = ": ";
    const std::string picture =
        at >= kColon.size() ? text.substr(0, at - kColon.size()) : std::string();
    const std::string reason = text.substr(at);
    if (message_options().is_strict)
        warn(fmt::format("{}: {}", picture.empty() ? name_ : picture, reason));  // throws
    pictures_[reason].insert(picture.empty() ? name_ : picture);
    return true;
}

void FinishedPictures::print() {
    for (const auto& [reason, pictures] : pictures_) {
        if (message_options().is_quiet) continue;
        std::string names = *pictures.begin();
        if (pictures.size() > 1) names += fmt::format(" and {} more", pictures.size() - 1);
        warn(fmt::format("{}: {}", names, reason));
    }
    pictures_.clear();
}

ReadOptions ReadMessages::hearing(ReadOptions options) {
    options.warn = [this](const std::string& text) {
        if (!finished_.take(text)) warnings_.add(text);
    };
    options.note = [this](const std::string& text) { notes_.add(text); };
    return options;
}

void ReadMessages::print() {
    notes_.print();
    finished_.print();
    warnings_.print();
}

TonemapOptions::Unpremult alpha_of(const PictureInput& input) {
    if (input.unpremult) return TonemapOptions::Unpremult::yes;
    if (input.no_unpremult) return TonemapOptions::Unpremult::no;
    return TonemapOptions::Unpremult::automatic;
}

void use_threads(const PictureInput& input) {
    if (input.timeout > 0) return;
    OIIO::attribute("threads", input.threads);
    // OpenEXR has threads of its own; there, 0 is all cores and less is none.
    OIIO::attribute("exr_threads", input.threads == 1 ? -1 : input.threads);
}

OIIO::ImageBuf read_picture(const std::string& path, const PictureChoice& choice,
                            std::string_view input) {
    ReadMessages messages(path);
    const ReadOptions options = messages.hearing(read_options_of(choice));
    OIIO::ImageBuf picture = [&] {
        const QuietStderr quiet;
        OIIO::ImageBuf stored = read_image(path, options);
        return with_memory_for(path,
                               [&] { return with_associated_alpha(upright(std::move(stored))); });
    }();
    about_picture(path, [&] { report_header(picture.spec(), input, options); });
    messages.print();
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

std::vector<float> read_picture_pixels(const std::string& path) {
    const OIIO::ImageBuf stored = read_picture(path);
    if (stored.nchannels() < 3) {
        throw FileError(fmt::format("verify: picture {} has {} channels; expected 3", path,
                                    stored.nchannels()));
    }
    const SourceColor source =
        about_picture(path, [&] { return source_color(stored.spec(), kAutoInput); });
    const OIIO::ImageBuf image = to_rec709_light(stored, source, kUnitLuminance, path);
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

TONEWRIGHT_NAMESPACE_END
