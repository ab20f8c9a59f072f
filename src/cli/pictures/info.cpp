// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <array>
#include <cmath>
#include <string_view>
#include <utility>
#include <vector>

#include "base/format_number.h"
#include "base/strings.h"
#include "cli/messages.h"
#include "cli/pictures/commands.h"
#include "cli/pictures/picture_messages.h"
#include "cli/pictures/requests.h"
#include "tasks/json.h"
#include "tasks/pictures/read_picture.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

/// "Rec.709", or the coordinates.
std::string text_of(const Primaries& p) {
    for (const InputSpace& space : all_input_spaces()) {
        if (space.primaries == p) return std::string(p.name);
    }
    std::vector<std::string> numbers;
    for (const Chromaticity& c : {p.red, p.green, p.blue})
        numbers.push_back(fmt::format("{:.4f} {:.4f}", c.x, c.y));
    return fmt::format("red {}, green {}, blue {}", numbers[0], numbers[1], numbers[2]);
}

/// "D65", or the coordinates.
std::string text_of_white(const Chromaticity& white) {
    constexpr std::array<std::pair<const char*, Chromaticity>, 3> kWhites = {
        {{"D65", kD65}, {"D60 (ACES)", kAP0.whitepoint}, {"E", {1.0 / 3, 1.0 / 3}}}};
    for (const auto& [name, known] : kWhites) {
        constexpr double kSame = 5e-5;
        if (std::fabs(known.x - white.x) < kSame && std::fabs(known.y - white.y) < kSame)
            return name;
    }
    return fmt::format("{:.4f} {:.4f}", white.x, white.y);
}

void print_json(const std::string& path, const PictureInfo& info) {
    const auto& [spec, said, choices] = info;
    const Primaries& p = said.color.primaries;
    Json primaries = Json::array({p.red.x, p.red.y, p.green.x, p.green.y, p.blue.x, p.blue.y});
    fmt::print("{}\n", Json{{"file", path},
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
                            {"choices", choices}}
                           .dump());
}

void print_text(const std::string& path, const PictureInfo& info) {
    const auto& [spec, said, choices] = info;
    constexpr std::array kTurned = {"upright",
                                    "mirrored",
                                    "turned by 180 degrees",
                                    "upside down, mirrored",
                                    "mirrored along the diagonal",
                                    "turned by 90 degrees clockwise to be upright",
                                    "mirrored along the other diagonal",
                                    "turned by 90 degrees counterclockwise to be upright"};
    fmt::print("{}: {} x {}, {} channel{}, {}\n", path, spec.width, spec.height, spec.nchannels,
               spec.nchannels == 1 ? "" : "s", spec.format.c_str());
    const auto line = [](std::string_view name, const std::string& value) {
        fmt::print("  {:<12} {}\n", name, value);
    };
    line("space", fmt::format("{} (by {})", said.color.name, said.rule));
    line("transfer", said.transfer);
    line("primaries", text_of(said.color.primaries));
    line("white", text_of_white(said.color.primaries.whitepoint));
    line("units", said.units == "cd/m2" ? "cd/m2; 100 cd/m2 is 1.0" : said.units);
    line("alpha", said.alpha);
    line("orientation", fmt::format("{} ({})", said.orientation,
                                    kTurned[static_cast<std::size_t>(said.orientation - 1)]));
    line("layer", said.layer.empty() ? std::string("-") : printable(said.layer));
    line("subimage", said.subimage);
    for (const std::string& choice : choices)
        line("choice", choice);
    for (const std::string& ignored : said.ignored)
        line("not used", ignored);
}

}  // namespace

void run_info(const InfoOptions& options) {
    for (const std::string& path : options.pictures) {
        PictureInfo info = [&] {
            const QuietStderr quiet;
            return read_picture_info(path, read_options_of(options.choice), options.input);
        }();
        for (std::vector<std::string>* texts : {&info.said.ignored, &info.choices}) {
            for (std::string& text : *texts)
                text = render(text, command_style());
        }
        info.said.rule = render(info.said.rule, command_style());
        options.json ? print_json(path, info) : print_text(path, info);
    }
}

TONEWRIGHT_NAMESPACE_END
