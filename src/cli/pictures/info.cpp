// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <array>
#include <string_view>
#include <vector>

#include "base/strings.h"
#include "cli/messages.h"
#include "cli/pictures/commands.h"
#include "cli/pictures/requests.h"
#include "cli/rows/apply_request.h"
#include "cli/rows/picture_messages.h"
#include "tasks/pictures/read_picture.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

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
    line("primaries", primaries_text(said.color.primaries));
    line("white", white_text(said.color.primaries.whitepoint));
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
        if (options.json) {
            fmt::print("{}\n", to_json(path, info).dump());
        } else {
            print_text(path, info);
        }
    }
}

TONEWRIGHT_NAMESPACE_END
