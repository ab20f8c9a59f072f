// SPDX-License-Identifier: Apache-2.0
//
// libFuzzer: short texts of users and the files of caches take any bytes. The first byte chooses
// the reader.
#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <string>
#include <vector>

#include "base/number_cache.h"
#include "base/strings.h"
#include "cli/color_line.h"
#include "fuzz/private_folder.h"
#include "image/tonemap_arguments.h"
#include "plugin/request.h"
#include "tasks/pictures/frames.h"
#include "tasks/pictures/meter_cache.h"
#include "tonewright/registry.h"

namespace {

using namespace tonewright;  // NOLINT(google-build-using-namespace): this is its program

/// The text of an operator is read again as the same operator. Behind a line end stands a setting
/// of `--set`.
void read_operator(const std::string& text) {
    const std::size_t end = std::min(text.find('\n'), text.size());
    const std::string name = text.substr(0, end);
    if (names_a_file(name)) return;
    Settings settings;
    const std::string setting = end < text.size() ? text.substr(end + 1) : "";
    if (const std::size_t equals = setting.find('='); equals != std::string::npos)
        settings[setting.substr(0, equals)] = setting.substr(equals + 1);
    const ResolvedOperator op = resolve_picture_operator(name, settings);
    const std::string again = operator_text(op);
    const ResolvedOperator same = resolve_picture_operator(again);
    if (!(same.params == op.params) || operator_text(same) != again) std::abort();
}

void read_frames(const std::string& text) {
    const std::vector<int> frames = parse_frames(text);
    if (frames.empty() || frames.size() > 1'000'000) std::abort();
    if (frames.size() > 1000) return;
    std::vector<int> sorted = frames;
    std::sort(sorted.begin(), sorted.end());
    sorted.erase(std::unique(sorted.begin(), sorted.end()), sorted.end());
    if (parse_frames(format_frames(frames)) != sorted) std::abort();
}

void read_pattern(const std::string& text) {
    const bool is_pattern = is_frame_pattern(text);
    bool has_name = true;
    try {
        for (const int frame : {0, -7, 1234567}) {
            if (frame_name("input", text, frame).empty()) std::abort();
        }
    } catch (const Error&) {
        has_name = false;
    }
    if (has_name != is_pattern) std::abort();
}

void read_lines(const std::string& text) {
    std::size_t number = 0;
    for (std::size_t at = 0; at < text.size();) {
        const std::size_t end = std::min(text.find('\n', at), text.size());
        (void)parse_color_line(std::string_view(text).substr(at, end - at), ++number);
        at = end + 1;
    }
}

/// A cache that is read can be written and read again.
void read_meter_cache(const std::string& text) {
    static const PrivateFolder folder;
    const std::string path = folder.write("cache.json", text);
    MeterCache cache(path, {});
    Metering metering;
    metering.histogram.resize(static_cast<std::size_t>(MeterOptions{}.bins));
    cache.add("x.exr", {1, 2}, metering);
    cache.save();
    if (!MeterCache(path, {}).find("x.exr", {1, 2})) std::abort();
}

/// A damaged file gives no other numbers than those that it had.
void read_number_cache(const std::string& text) {
    static const PrivateFolder folder;
    const std::string key = text.substr(0, std::min<std::size_t>(text.find('\n'), 40));
    const std::string cache = folder.path() + "/tonewright";
    (void)folder.write("tonewright/x_" + content_hash(key) + ".numbers", text);
    const std::vector<double> made = {0.5, 2};
    const NumberCheck is_usable = numbers_in(2, 0, 2);
    (void)cached_numbers(cache, "x", key, is_usable, [&] { return made; });
    const std::vector<double> numbers =
        cached_numbers(cache, "x", key, is_usable, [&] { return made; });
    if (!is_usable(numbers) || numbers != cached_numbers(cache, "x", key, is_usable,
                                                         [] { return std::vector<double>{3}; }))
        std::abort();
    std::filesystem::remove_all(cache);
}

void set_arguments(const Request& request) {
    TonemapArguments arguments;
    for (const auto& [name, value] : request.arguments)
        set_tonemap_argument(arguments, name, value);
}

void read_request_name(const std::string& text) { set_arguments(parse_request(text)); }

void read_request_file(const std::string& text) {
    static const PrivateFolder folder;
    const Request request = parse_request(folder.write("x.tonewright", text) + "?exposure=1");
    if (request.arguments.at("exposure") != "1") std::abort();
    set_arguments(request);
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    constexpr std::array kReaders = {read_operator,     read_frames,      read_pattern,
                                     read_lines,        read_meter_cache, read_number_cache,
                                     read_request_name, read_request_file};
    if (size == 0) return 0;
    try {
        kReaders.at(data[0] % kReaders.size())({reinterpret_cast<const char*>(data) + 1, size - 1});
    } catch (const Error&) {
    }
    return 0;
}
