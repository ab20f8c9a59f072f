// SPDX-License-Identifier: Apache-2.0
#include "tasks/pictures/meter_cache.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <system_error>
#include <utility>

#include "base/atomic_file.h"
#include "base/format_number.h"
#include "base/input_file.h"
#include "base/strings.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

namespace fs = std::filesystem;

constexpr const char* kFormat = "tonewright_meter_cache";
constexpr int kVersion = 2;

/// A path in the form of the cache's JSON.
std::string absolute(const std::string& path) {
    std::error_code error;
    const fs::path full = fs::absolute(path, error);
    return utf8_text((error ? fs::path(path) : full).lexically_normal().string());
}

/// False for figures that metering never gives, which somebody else wrote: the picture is metered
/// again.
bool is_possible(const Metering& m, const MeterOptions& options) {
    std::vector<double> luminances = {m.log_average,
                                      m.geometric_mean,
                                      m.mean,
                                      m.minimum,
                                      m.maximum,
                                      m.histogram_average,
                                      m.scene.log_average,
                                      m.scene.mean_luminance,
                                      m.scene.minimum_luminance,
                                      m.scene.maximum_luminance};
    luminances.insert(luminances.end(), m.percentiles.begin(), m.percentiles.end());
    const bool are_luminances = std::all_of(luminances.begin(), luminances.end(),
                                            [](double x) { return std::isfinite(x) && x >= 0; });
    const auto are_finite = [](const auto& numbers) {
        return std::all_of(numbers.begin(), numbers.end(),
                           [](double x) { return std::isfinite(x); });
    };
    return are_luminances && are_finite(m.scene.mean_rgb) && are_finite(m.scene.maximum_rgb) &&
           m.histogram.size() >= static_cast<std::size_t>(options.bins);
}

}  // namespace

Metering metering_from(const Json& j) {
    Metering m;
    const Json& pixels = j.at("pixels");
    pixels.at("counted").get_to(m.counted);
    pixels.at("black").get_to(m.black);
    pixels.at("nan").get_to(m.nan);
    pixels.at("infinite").get_to(m.infinite);
    pixels.at("uncovered").get_to(m.uncovered);
    const Json& luminance = j.at("luminance");
    luminance.at("log_average").get_to(m.log_average);
    luminance.at("geometric_mean").get_to(m.geometric_mean);
    luminance.at("mean").get_to(m.mean);
    luminance.at("minimum").get_to(m.minimum);
    luminance.at("maximum").get_to(m.maximum);
    luminance.at("histogram_average").get_to(m.histogram_average);
    const Json& percentiles = luminance.at("percentiles");
    if (!percentiles.members().empty()) {
        for (const double percent : Metering::kPercents)
            percentiles.at(shortest(percent)).get_to(m.percentiles.emplace_back());
    }
    j.at("histogram").get_to(m.histogram);
    const Json& range = j.at("histogram_range");
    range.at("low").get_to(m.histogram_min);
    range.at("high").get_to(m.histogram_max);
    range.at("below").get_to(m.below_histogram);
    range.at("above").get_to(m.above_histogram);
    const Json& scene = j.at("statistics");
    scene.at("log_average").get_to(m.scene.log_average);
    scene.at("mean_luminance").get_to(m.scene.mean_luminance);
    scene.at("minimum_luminance").get_to(m.scene.minimum_luminance);
    scene.at("maximum_luminance").get_to(m.scene.maximum_luminance);
    scene.at("mean_rgb").get_to(m.scene.mean_rgb);
    scene.at("maximum_rgb").get_to(m.scene.maximum_rgb);
    scene.at("count").get_to(m.scene_count);
    scene.at("lit_count").get_to(m.scene_lit_count);
    return m;
}

FileStamp stamp_of(const std::string& path) {
    std::error_code error;
    FileStamp stamp;
    const auto bytes = fs::file_size(path, error);
    if (error) return {};
    stamp.bytes = bytes;
    const auto time = fs::last_write_time(path, error);
    if (error) return {};
    stamp.modified =
        std::chrono::duration_cast<std::chrono::nanoseconds>(time.time_since_epoch()).count();
    return stamp;
}

Json to_json(const MeterOptions& options) {
    using Unpremult = TonemapOptions::Unpremult;
    Json region = nullptr;
    Json size = nullptr;
    if (!options.read.resize.empty()) size = options.read.resize;
    if (const OIIO::ROI& r = options.region; r.defined())
        region = Json::array({r.xbegin, r.ybegin, r.width(), r.height()});
    return {{"input", options.input},
            {"input_units", options.input_units == InputUnits::luminance ? "cd/m2" : "relative"},
            {"reference_white", options.reference_white},
            {"subimage", options.read.subimage},
            {"layer", options.read.layer},
            {"resize", size},
            {"unpremult", options.unpremult == Unpremult::automatic
                              ? Json("as the picture says")
                              : Json(options.unpremult == Unpremult::yes)},
            {"region", region},
            {"delta", options.delta},
            {"histogram_range", Json::array({options.histogram_min, options.histogram_max})},
            {"histogram_grows", options.grows_histogram},
            {"bins", options.bins},
            {"percentiles", Json::array({options.low_percentile, options.high_percentile})},
            {"exact", options.exact}};
}

Json to_json(const Metering& m) {
    Json percentiles = Json::object();
    for (std::size_t i = 0; i < m.percentiles.size(); ++i)
        percentiles.add(shortest(Metering::kPercents[i]), m.percentiles[i]);
    return {{"pixels",
             {{"counted", m.counted},
              {"black", m.black},
              {"nan", m.nan},
              {"infinite", m.infinite},
              {"uncovered", m.uncovered}}},
            {"luminance",
             {{"log_average", m.log_average},
              {"geometric_mean", m.geometric_mean},
              {"mean", m.mean},
              {"minimum", m.minimum},
              {"maximum", m.maximum},
              {"histogram_average", m.histogram_average},
              {"percentiles", percentiles}}},
            {"histogram", m.histogram},
            {"histogram_range",
             {{"low", m.histogram_min},
              {"high", m.histogram_max},
              {"below", m.below_histogram},
              {"above", m.above_histogram},
              {"outside", m.share_outside()}}},
            {"statistics",
             {{"log_average", m.scene.log_average},
              {"mean_luminance", m.scene.mean_luminance},
              {"minimum_luminance", m.scene.minimum_luminance},
              {"maximum_luminance", m.scene.maximum_luminance},
              {"mean_rgb", m.scene.mean_rgb},
              {"maximum_rgb", m.scene.maximum_rgb},
              {"count", m.scene_count},
              {"lit_count", m.scene_lit_count}}}};
}

MeterCache::MeterCache(std::string path, const MeterOptions& options)
    : path_(std::move(path)), options_(to_json(options).dump()) {
    std::error_code error;
    if (path_.empty() || (!fs::exists(path_, error) && !error)) return;
    const auto fail = [&](const std::string& reason) {
        throw FileError(fmt::format("meter cache: {}: {}", path_, reason));
    };
    constexpr std::size_t kMostBytes = std::size_t{1} << 30;
    const std::string text = read_file(path_, kMostBytes, [&](const Problem& why) {
        throw FileError(within("meter cache: " + path_, why));
    });
    try {
        const Json all = Json::parse(text);
        std::int64_t version = 0;
        all.at(kFormat).get_to(version);
        if (version != kVersion || all.at("options").dump() != options_) return;
        for (const auto& [picture, entry] : all.at("pictures").members()) {
            Entry known;
            entry.at("bytes").get_to(known.stamp.bytes);
            entry.at("modified").get_to(known.stamp.modified);
            known.metering = metering_from(entry.at("metering"));
            if (is_possible(known.metering, options)) entries_[picture] = std::move(known);
        }
    } catch (const JsonError&) {
        fail("is not a meter cache; expected a file that <<meter_cache>> wrote, or a new name");
    }
}

const Metering* MeterCache::find(const std::string& picture, const FileStamp& stamp) const {
    const auto found = entries_.find(absolute(picture));
    if (found == entries_.end() || found->second.stamp != stamp) return nullptr;
    return &found->second.metering;
}

void MeterCache::add(const std::string& picture, const FileStamp& stamp, const Metering& metering) {
    if (!path_.empty()) added_[absolute(picture)] = {stamp, metering};
}

void MeterCache::save() const {
    if (added_.empty()) return;
    std::map<std::string, Entry> all = added_;
    all.insert(entries_.begin(), entries_.end());
    Json pictures = Json::object();
    for (const auto& [picture, entry] : all) {
        pictures.add(picture, {{"bytes", entry.stamp.bytes},
                               {"modified", entry.stamp.modified},
                               {"metering", to_json(entry.metering)}});
    }
    const Json file = {
        {kFormat, kVersion}, {"options", Json::parse(options_)}, {"pictures", pictures}};
    write_text_atomically(path_, file.dump() + "\n");
}

TONEWRIGHT_NAMESPACE_END
