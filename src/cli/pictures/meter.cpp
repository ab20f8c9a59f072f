// SPDX-License-Identifier: Apache-2.0
#include "tonewright/meter.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <optional>

#include "base/format_number.h"
#include "base/strings.h"
#include "cli/messages.h"
#include "cli/pictures/commands.h"
#include "cli/pictures/requests.h"
#include "cli/progress.h"
#include "cli/rows/apply_request.h"
#include "cli/rows/picture_messages.h"
#include "image/picture_file.h"
#include "image/spec_conversion.h"
#include "plot/terminal_plot.h"
#include "tasks/json.h"
#include "tasks/pictures/frames.h"
#include "tasks/pictures/meter_cache.h"
#include "tasks/pictures/metering.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

Suggestion suggestion(const Metering& metering, ExposureRule rule, ExposureRule::Method method,
                      double delta) {
    rule.method = method;
    return suggest_exposure(metering, rule, delta);
}

// ---------------------------------------------------------------------------------------------
// For people

/// Bins side by side as bars, log2 of luminance from left to right.
void draw_histogram(const Metering& metering, double metered) {
    constexpr std::size_t kColumns = 76;
    constexpr std::size_t kRows = 8;
    const std::vector<std::uint64_t>& bins = metering.histogram;
    std::array<double, kColumns> columns{};
    const double per_bin = static_cast<double>(kColumns) / static_cast<double>(bins.size() - 1);
    for (std::size_t i = 1; i < bins.size(); ++i) {
        // A bin may be wider or narrower than a column.
        const double begin = static_cast<double>(i - 1) * per_bin;
        const double end = begin + per_bin;
        for (auto c = static_cast<std::size_t>(begin); c < kColumns && static_cast<double>(c) < end;
             ++c) {
            const double overlap =
                std::min(end, static_cast<double>(c + 1)) - std::max(begin, static_cast<double>(c));
            columns[c] += static_cast<double>(bins[i]) * std::max(overlap, 0.0) / per_bin;
        }
    }
    const double most = *std::max_element(columns.begin(), columns.end());
    if (most == 0) return;
    const bool has_blocks = terminal_text() == TerminalText::utf8;
    static constexpr std::array kBlocks = {" ", "▁", "▂", "▃", "▄", "▅", "▆", "▇", "█"};
    fmt::print("\n");
    for (std::size_t row = 0; row < kRows; ++row) {
        std::string line = "  ";
        for (const double column : columns) {
            const double height =
                column / most * static_cast<double>(kRows) - static_cast<double>(kRows - 1 - row);
            // A bin with pixels is always visible.
            const double least = column > 0 && row == kRows - 1 ? 1 : 0;
            const double eighths = std::clamp(std::max(std::round(height * 8), least), 0.0, 8.0);
            line += has_blocks      ? kBlocks[static_cast<std::size_t>(eighths)]
                    : eighths > 3.5 ? "#"
                    : eighths > 0   ? "."
                                    : " ";
        }
        line.erase(line.find_last_not_of(' ') + 1);
        fmt::print("{}\n", line);
    }
    const double range = metering.histogram_max - metering.histogram_min;
    const auto column_of = [&](double log2_luminance) {
        return 2 + static_cast<std::ptrdiff_t>(
                       std::floor((log2_luminance - metering.histogram_min) / range * kColumns));
    };
    std::string ticks(kColumns + 4, ' ');
    std::string labels(kColumns + 4, ' ');
    const int step = std::max(1, static_cast<int>(std::ceil(range / 12)));
    const int first = static_cast<int>(std::ceil(metering.histogram_min / step)) * step;
    for (int stop = first; stop <= metering.histogram_max; stop += step) {
        const std::string label = stop == 0 ? "0" : fmt::format("{:+}", stop);
        const auto at =
            std::min<std::size_t>(static_cast<std::size_t>(column_of(stop)), kColumns + 1);
        ticks[at] = '|';
        const std::size_t from = std::min(at - 1, kColumns + 4 - label.size());
        labels.replace(from, label.size(), label);
    }
    const auto mark = column_of(std::log2(metered));
    if (mark >= 2 && mark < static_cast<std::ptrdiff_t>(kColumns) + 2)
        ticks[static_cast<std::size_t>(mark)] = '^';
    for (std::string* line : {&ticks, &labels}) {
        line->erase(line->find_last_not_of(' ') + 1);
        fmt::print("{}\n", *line);
    }
    fmt::print("  log2 of luminance, 0 = diffuse white, -2.47 = mid gray; ^ metered\n");
    fmt::print("  range {:.4g} to {:.4g}; {:.3g} % of the picture outside\n",
               metering.histogram_min, metering.histogram_max, 100 * metering.share_outside());
}

void print_picture(const MeteredFrame& metered, const MeterCommandOptions& options,
                   const ExposureRule& rule) {
    const Metering& m = metered.picture.metering;
    fmt::print("{}\n\n", one_line(metered.picture.path));
    fmt::print("  pixels      {} counted, {} of them black", m.counted, m.black);
    for (const auto& [count, what] : {std::pair(m.nan, "NaN"), std::pair(m.infinite, "infinite"),
                                      std::pair(m.uncovered, "without cover")}) {
        if (count > 0) fmt::print("; {} {} left out", count, what);
    }
    fmt::print("\n\n  {:<14}{:>12}{:>9}{:>11}\n", "", "luminance", "EV100", "exposure");
    double chosen = 0;
    for (const MeterMethodNames& method : kMeterMethods) {
        const Suggestion s = suggestion(m, rule, method.method, options.metering.delta);
        const bool is_chosen = method.method == rule.method;
        if (is_chosen) chosen = s.luminance;
        fmt::print("  {:<14}{:>12.5g}{:>9.2f}{:>+11.2f}{}\n", method.title, s.luminance, s.ev100,
                   s.stops, is_chosen ? "  <" : "");
    }
    if (m.counted > m.black) {
        fmt::print("  {:<14}{:>12.5g}\n  {:<14}{:>12.5g}\n", "no delta", m.geometric_mean,
                   "minimum", m.minimum);
    }
    if (!m.percentiles.empty()) {
        fmt::print("\n  {:<12}", "percentile");
        for (const double percent : Metering::kPercents)
            fmt::print("{:>9}", shortest(percent) + " %");
        fmt::print("\n  {:<12}", "luminance");
        for (const double luminance : m.percentiles)
            fmt::print("{:>9.3g}", luminance);
        fmt::print("\n");
    }
    draw_histogram(m, chosen);
    if (metered.adapted) fmt::print("\n  adapted exposure {:+.2f}\n", *metered.adapted);
}

void print_table(const std::vector<MeteredFrame>& all, const MeterCommandOptions& options,
                 const ExposureRule& rule) {
    std::size_t width = 7;
    for (const MeteredFrame& metered : all) {
        width = std::max(width, metered.number ? std::to_string(*metered.number).size()
                                               : metered.picture.path.size());
    }
    width = std::min<std::size_t>(width, 28);
    const bool adapts = options.shot.adapt;
    fmt::print("{:<{}}{:>12}{:>12}{:>10}{:>10}{:>8}{:>10}{}\n",
               all.front().number ? "frame" : "picture", width, "log average", "histogram", "mean",
               "max", "EV100", "exposure", adapts ? "   adapted" : "");
    for (const MeteredFrame& metered : all) {
        if (metered.picture.problem) continue;
        const Metering& m = metered.picture.metering;
        std::string name = metered.number ? std::to_string(*metered.number) : metered.picture.path;
        if (name.size() > width) name = "..." + name.substr(name.size() - width + 3);
        const Suggestion s = suggestion(m, rule, rule.method, options.metering.delta);
        fmt::print("{:<{}}{:>12.4g}{:>12.4g}{:>10.4g}{:>10.4g}{:>8.2f}{:>+10.3f}", name, width,
                   m.log_average, m.histogram_average, m.mean, m.maximum, s.ev100, s.stops);
        if (metered.adapted) fmt::print("{:>+10.3f}", *metered.adapted);
        fmt::print("\n");
    }
}

// ---------------------------------------------------------------------------------------------

std::vector<MeteredFrame> meter_all(const MeterCommandOptions& options, const MeterRequest& request,
                                    const ExposureRule& rule) {
    const QuietStderr quiet;
    Progress progress("meter", {.unit = options.frames.empty() ? "pictures" : "frames",
                                .terminal = quiet.before()});
    const Listener listener = {.progress = progress.listener().progress};
    if (options.frames.empty()) {
        std::vector<MeteredFrame> all;
        for (MeteredPicture& picture : meter_pictures(options.in, request, listener))
            all.push_back({std::move(picture)});
        return all;
    }
    if (options.in.size() != 1) {
        throw Error(
            fmt::format("meter: --frames is {} with {} pictures; expected one name with a "
                        "placeholder for the frame number",
                        options.frames, options.in.size()));
    }
    const Adaptation adaptation = adaptation_of(options.shot);
    const MeteredShot shot =
        meter_shot(options.in.front(), parse_frames(options.frames), request, listener);
    return frames_of(shot, rule, options.metering.delta,
                     options.shot.adapt ? &adaptation : nullptr);
}

/// Prints messages about the header of a single picture. Frames of a shot have the same ones, and
/// are many.
void tell_header(const std::string& path, const MeterCommandOptions& options) {
    PictureMessages messages(path);
    ReadOptions read = read_options_of(options.picture);
    messages.attach_to(read);
    {
        const QuietStderr quiet;
        const PictureReader reader(path, 1, read);
        report_header(picture_spec(reader.spec()), options.light.input, read);
    }
    messages.print();
}

}  // namespace

int run_meter(const MeterCommandOptions& options) {
    int exit_code = kOk;
    use_threads(options.picture);
    const ExposureRule rule = rule_of(options.metering);
    const MeterRequest request = {
        .options = meter_options_of(options.metering, options.light, options.picture),
        .cache = options.shot.cache,
        .work = {options.picture.threads, options.picture.timeout}};
    const std::vector<MeteredFrame> all = meter_all(options, request, rule);
    if (options.json) {
        Json pictures = Json::array();
        for (const MeteredFrame& metered : all)
            pictures.push_back(to_json(metered, rule, options.metering.delta, command_style()));
        fmt::print("{}\n",
                   Json{{"options", to_json(request.options)}, {"pictures", pictures}}.dump(2));
    } else if (all.size() > 1) {
        print_table(all, options, rule);
    } else if (!all.front().picture.problem) {
        print_picture(all.front(), options, rule);
    }
    if (all.size() == 1 && !all.front().picture.problem)
        tell_header(all.front().picture.path, options);
    for (const MeteredFrame& metered : all) {
        const MeteredPicture& picture = metered.picture;
        if (const std::string text = histogram_warning(picture); !text.empty()) warn(text);
        if (!picture.problem) continue;
        const bool is_usage = picture.problem->kind == Problem::Kind::usage;
        exit_code = std::max<int>(exit_code, is_usage ? kUsage : kFile);
        print_message("meter: " + unrendered(*picture.problem));
    }
    return exit_code;
}

TONEWRIGHT_NAMESPACE_END
