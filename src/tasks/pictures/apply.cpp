// SPDX-License-Identifier: Apache-2.0
#include "tasks/pictures/apply.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstddef>
#include <functional>
#include <utility>
#include <variant>

#include "base/atomic_file.h"
#include "base/problem.h"
#include "base/strings.h"
#include "image/converted_picture.h"
#include "image/picture_file.h"
#include "image/resize.h"
#include "image/spec_conversion.h"
#include "image/tonemap_file.h"
#include "picture/color_tags.h"
#include "picture/picture_description.h"
#include "picture/source_pixels.h"
#include "tasks/json.h"
#include "tasks/pictures/compare.h"
#include "tasks/pictures/contained.h"
#include "tonewright/engine.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

/// Messages of the process of a picture, which the program then repeats.
struct KeptMessages {
    std::vector<std::string> writing;
    std::vector<std::string> reading;
    std::vector<std::string> notes;

    /// Replaces the callbacks.
    void keep(WriteOptions& write, ReadOptions& read) {
        const auto keeping = [](std::vector<std::string>& to,
                                const std::function<void(const std::string&)>& call) {
            return [&to, call](const std::string& text) {
                if (call) call(text);  // may throw
                to.push_back(one_line(text));
            };
        };
        write.warn = keeping(writing, write.warn);
        read.warn = keeping(reading, read.warn);
        read.note = keeping(notes, read.note);
    }
    [[nodiscard]] Json json() const {
        return {{"writing", writing}, {"reading", reading}, {"notes", notes}};
    }
    static void repeat(const Json& kept, const WriteOptions& write, const ReadOptions& read) {
        for (const auto& [name, call] :
             {std::pair("writing", &write.warn), std::pair("reading", &read.warn),
              std::pair("notes", &read.note)}) {
            for (const Json& text : std::get<Json::Array>(kept.at(name).value())) {
                if (*call) (*call)(std::get<std::string>(text.value()));
            }
        }
    }
};

/// tonemap_files(), each file in its own process.
void tonemap_contained(const Tonemapper& tonemapper, std::vector<FrameFiles>& files,
                       const SequenceOptions& options, double timeout) {
    std::vector<std::string> names;
    names.reserve(files.size());
    for (const FrameFiles& file : files)
        names.push_back(file.in);
    const auto threads = static_cast<std::size_t>(thread_count(options.nthreads));
    const std::size_t wanted = options.jobs > 0 ? static_cast<std::size_t>(options.jobs) : threads;
    const std::size_t jobs = std::clamp<std::size_t>(files.size(), 1, wanted);
    const auto threads_each = static_cast<int>(std::max<std::size_t>(threads / jobs, 1));
    const auto work = [&](std::size_t i) {
        set_picture_threads(threads_each);
        SequenceOptions one = options;
        one.jobs = 1;
        one.nthreads = threads_each;
        one.done = {};
        one.write.progress = {};  // the program counts files
        KeptMessages messages;
        messages.keep(one.write, one.read);
        std::vector<FrameFiles> files_of_one = {files[i]};
        tonemap_files(tonemapper, files_of_one, one);
        const FrameFiles& file = files_of_one.front();
        if (file.problem) throw_problem(*file.problem);
        return Json{{"is_skipped", file.is_skipped}, {"messages", messages.json()}}.dump();
    };
    run_contained(names, jobs, timeout, work, [&](std::size_t i, const ContainedResult& result) {
        FrameFiles& file = files[i];
        file.problem = result.problem;
        if (result.problem) {
            remove_leftovers({file.out});
        } else {
            const Json told = Json::parse(result.value);
            file.is_skipped = std::get<bool>(told.at("is_skipped").value());
            KeptMessages::repeat(told.at("messages"), options.write, options.read);
        }
        if (options.done) options.done(file);
    });
}

OIIO::ImageBuf resized(const OIIO::ImageBuf& picture, const std::string& path,
                       const TonemapOptions& light, const ReadOptions& read, int nthreads) {
    return about_picture(path, [&] {
        return resized_picture(picture, read.resize, light, read.max_pixels, nthreads);
    });
}

}  // namespace

void tonemap_pictures(const Tonemapper& tonemapper, std::vector<FrameFiles>& files,
                      const SequenceOptions& options, double timeout) {
    std::vector<FrameFiles> open;
    std::vector<std::size_t> places;
    for (std::size_t i = 0; i < files.size(); ++i) {
        if (files[i].problem) continue;
        places.push_back(i);
        open.push_back(std::move(files[i]));
    }
    if (timeout > 0) {
        tonemap_contained(tonemapper, open, options, timeout);
    } else {
        tonemap_files(tonemapper, open, options);
    }
    for (std::size_t i = 0; i < places.size(); ++i)
        files[places[i]] = std::move(open[i]);
}

void write_with_legend(const Tonemapper& tonemapper, OIIO::ImageBuf picture, const FrameFiles& file,
                       const WriteOptions& write, const ReadOptions& read, int nthreads) {
    const OIIO::TypeDesc type = picture.spec().format;
    if (!read.resize.empty())
        picture = resized(picture, file.in, tonemapper.options(), read, nthreads);
    OIIO::ImageBuf shown;
    if (!tonemapper(shown, picture, {}, nthreads))
        throw FileError(file.in + ": " + first_line(shown.geterror()));
    write_result_atomically(with_legend(with_associated_alpha(shown)), file.out, write, type);
}

LutSource lut_source(OIIO::ImageBuf picture, const std::string& path, const TonemapOptions& light,
                     const ReadOptions& read, int nthreads) {
    SourceColor color = about_picture(path, [&] {
        (void)channel_layout(picture_spec(picture.spec()));
        return source_color(picture_spec(picture.spec()), light.input);
    });
    std::string name = color.name;
    const OIIO::TypeDesc type = picture.spec().format;
    if (!read.resize.empty()) {
        picture = resized(picture, path, light, read, nthreads);
        color = source_color(picture_spec(picture.spec()), light.input);
    } else if (color.convert) {
        picture = converted_picture(picture, color);
        color = source_color(picture_spec(picture.spec()), kAutoInput);
        name = color.name;
    }
    return {std::move(picture), type, std::move(color), std::move(name)};
}

void write_through_lut(const LutSource& source, const FrameFiles& file,
                       const LutPictureRequest& request) {
    const SimdEngine encode(request.before);
    OIIO::ImageBuf result;
    const auto map = [&](const float* in, float* out, std::size_t count) {
        if (request.before.empty()) {
            request.lut.run_rgb(in, out, count);
            return;
        }
        std::vector<float> code(3 * count);
        encode.run_rgb(in, code.data(), count);
        request.lut.run_rgb(code.data(), out, count);
    };
    if (!map_colors(result, source.picture, map, request.unpremult, {}, request.nthreads))
        throw FileError(file.in + ": " + first_line(result.geterror()));
    if (request.display) {
        change_spec(result.specmod(),
                    [&](PictureSpec& spec) { tag_as_shown_on(*request.display, spec); });
    }
    if (request.write.write_provenance) {
        const std::string size = request.resize.empty() ? "" : ", resize " + request.resize;
        result.specmod().attribute(
            "Software",
            fmt::format("Tonewright {}: LUT {}{}", TONEWRIGHT_VERSION, request.lut_name, size));
    }
    write_result_atomically(result, file.out, request.write, source.type);
}

TONEWRIGHT_NAMESPACE_END
