// SPDX-License-Identifier: Apache-2.0
#include "tonewright/sequence.h"

#include <sys/stat.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <exception>
#include <fstream>
#include <mutex>
#include <optional>
#include <string_view>
#include <system_error>
#include <thread>

#include "base/atomic_file.h"
#include "base/problem.h"
#include "image/picture_file.h"
#include "image/tonemap_file.h"
#include "tonewright/tonemap.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

bool is_newer(const std::string& path, const std::string& than) {
    struct stat file {};
    struct stat other {};
    if (::stat(path.c_str(), &file) != 0 || ::stat(than.c_str(), &other) != 0) return false;
    const timespec& a = file.st_mtim;
    const timespec& b = other.st_mtim;
    return a.tv_sec != b.tv_sec ? a.tv_sec > b.tv_sec : a.tv_nsec > b.tv_nsec;
}

/// The last bytes of formats whose readers accept a file without its end: the chunk IEND with its
/// check sum (PNG, ISO/IEC 15948, 11.2.5), the markers EOI (JPEG, ISO/IEC 10918-1, B.1.1.3) and EOC
/// (JPEG 2000, ISO/IEC 15444-1, A.4.4), and the trailer of GIF89a.
bool has_its_end(const std::string& path) {
    struct Format {
        std::string_view begin, end;
    };
    using namespace std::string_view_literals;
    static constexpr std::array<Format, 5> kFormats = {
        {{"\x89PNG\r\n\x1A\n"sv, "\0\0\0\0IEND\xAE\x42\x60\x82"sv},
         {"\xFF\xD8\xFF"sv, "\xFF\xD9"sv},
         {"\xFF\x4F\xFF\x51"sv, "\xFF\xD9"sv},
         {"\0\0\0\x0CjP  "sv, "\xFF\xD9"sv},
         {"GIF8"sv, ";"sv}}};
    std::ifstream file(path, std::ios::binary);
    std::array<char, 12> begin{}, end{};
    file.read(begin.data(), begin.size());
    if (!file) return true;  // its reader knows
    file.seekg(-static_cast<std::streamoff>(end.size()), std::ios::end);
    file.read(end.data(), end.size());
    const std::string_view first(begin.data(), begin.size()), last(end.data(), end.size());
    return std::none_of(kFormats.begin(), kFormats.end(), [&](const Format& format) {
        return first.starts_with(format.begin) && !last.ends_with(format.end);
    });
}

/// @param tonemapper  one that takes no statistics
bool is_done(const Tonemapper& tonemapper, const FrameFiles& frame,
             const SequenceOptions& options) {
    if (!is_newer(frame.out, frame.in)) return false;
    try {
        ReadOptions read = options.read;
        read.warn = read.note = nullptr;
        const PictureReader source(frame.in, 0, read);
        PictureReader result(frame.out, 0, {.max_pixels = kUnlimited});
        const OIIO::ImageSpec is = result.spec();
        PictureWriter writer(frame.out, options.write);
        writer.keep_type(source.spec().format);
        const OIIO::ImageSpec should = writer.file_spec(result_spec(tonemapper, source.spec()));
        if (is.width != should.width || is.height != should.height || is.depth != should.depth ||
            is.nchannels != should.nchannels ||
            (should.format != OIIO::TypeUnknown && is.format != should.format)) {
            return false;
        }
        check_is_complete(result);
        return has_its_end(frame.out);
    } catch (const std::exception&) {
        return false;  // the frame itself reports every error
    }
}

}  // namespace

void tonemap_files(const Tonemapper& tonemapper, std::vector<FrameFiles>& frames,
                   const SequenceOptions& options) {
    const auto threads = static_cast<std::size_t>(thread_count(options.nthreads));
    const std::size_t jobs = std::min(
        options.jobs > 0 ? static_cast<std::size_t>(options.jobs) : threads, frames.size());
    if (jobs == 0) return;
    std::vector<std::string> outs;
    outs.reserve(frames.size());
    for (const FrameFiles& frame : frames)
        outs.push_back(frame.out);
    remove_leftovers(outs);

    std::optional<Tonemapper> without_statistics;
    if (options.skip_existing && tonemapper.takes_statistics())
        without_statistics = tonemapper.with_statistics({});
    const Tonemapper& any = without_statistics ? *without_statistics : tonemapper;
    std::atomic<std::size_t> next = 0;
    std::mutex mutex;
    std::mutex warn_mutex;
    using Callback = std::function<void(const std::string&)>;
    const auto guarded = [&](const Callback& call, const std::string& name) -> Callback {
        if (!call) return {};
        return [&warn_mutex, &call, name](const std::string& text) {
            const std::lock_guard lock(warn_mutex);
            call(name.empty() ? text : name + ": " + text);
        };
    };
    const auto work = [&](std::size_t job) {
        const auto nthreads =
            static_cast<int>(std::max<std::size_t>((threads + jobs - 1 - job) / jobs, 1));
        for (std::size_t i = next++; i < frames.size(); i = next++) {
            FrameFiles& frame = frames[i];
            try {
                frame.is_skipped = options.skip_existing && is_done(any, frame, options);
                if (!frame.is_skipped) {
                    const bool is_named = options.names_pictures;
                    const std::string in = is_named ? frame.in : std::string();
                    WriteOptions write = options.write;
                    write.warn = guarded(options.write.warn, is_named ? frame.out : in);
                    ReadOptions read = options.read;
                    read.warn = guarded(options.read.warn, in);
                    read.note = guarded(options.read.note, in);
                    std::optional<Tonemapper> own;
                    if (frame.exposure_stops) own = tonemapper.with_exposure(*frame.exposure_stops);
                    tonemap_file(own ? *own : tonemapper, frame.in, frame.out, write, read,
                                 nthreads);
                }
            } catch (const std::exception& e) {
                frame.problem = problem_of(e);
            }
            const std::lock_guard lock(mutex);
            if (options.done) options.done(frame);
        }
    };
    std::vector<std::jthread> others;  // which join when they are destroyed
    try {
        for (std::size_t job = 1; job < jobs; ++job)
            others.emplace_back(work, job);
    } catch (const std::system_error&) {
        // If no more threads can be started, the existing ones do the work.
    }
    work(0);
}

TONEWRIGHT_NAMESPACE_END
