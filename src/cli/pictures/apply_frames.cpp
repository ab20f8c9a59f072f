// SPDX-License-Identifier: Apache-2.0
#include "cli/pictures/apply_frames.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <functional>
#include <map>
#include <optional>
#include <set>
#include <unordered_set>
#include <utility>
#include <vector>

#include "base/atomic_file.h"
#include "base/input_file.h"
#include "base/strings.h"
#include "cli/json.h"
#include "cli/messages.h"
#include "cli/pictures/contained.h"
#include "cli/pictures/frames.h"
#include "cli/pictures/picture_input.h"
#include "cli/pictures/progress_bar.h"
#include "image/picture_file.h"
#include "image/tonemap_file.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

namespace fs = std::filesystem;

enum class Missing { error, skip, hold };

Missing parse_missing(const std::string& text) {
    return static_cast<Missing>(find_choice("missing", text, {"error", "skip", "hold"}));
}

/// The files of a shot, some of whose frames may be missing.
class Shot {
  public:
    explicit Shot(const std::string& pattern) : pattern_(pattern) {}

    [[nodiscard]] std::string name(int frame) const { return frame_name("in", pattern_, frame); }
    [[nodiscard]] bool has(int frame) {
        const auto known = known_.find(frame);
        if (known != known_.end()) return known->second;
        std::error_code error;
        // A file without access is not a missing frame: reading it reports the reason.
        const fs::file_type type = fs::status(name(frame), error).type();
        return known_[frame] = type != fs::file_type::not_found;
    }
    /// The frame that replaces a missing one. It depends on the files only, not on --frames, so
    /// every part of a shot gets the same frames.
    [[nodiscard]] std::optional<int> held(int frame) {
        // Frames mostly come in order: no gap is searched twice.
        int first = frame - kMostHeld;
        std::optional<int> found;
        if (searched_ && *searched_ < frame && *searched_ >= first) {
            first = *searched_;
            if (found_ && *found_ >= frame - kMostHeld) found = found_;
        }
        for (int earlier = frame - 1; earlier >= first; --earlier) {
            if (!has(earlier)) continue;
            found = earlier;
            break;
        }
        searched_ = frame;
        found_ = found;
        return found;
    }

    static constexpr int kMostHeld = 1000;

  private:
    std::string pattern_;
    std::map<int, bool> known_;
    std::optional<int> searched_, found_;  // the last held frame that was asked for, and the answer
};

struct Plan {
    std::vector<int> numbers;
    std::vector<FrameFiles> frames;  // as many
    std::size_t missing_count = 0;   // skipped
    std::size_t held_count = 0;
};

/// Every missing frame that an earlier one replaces, and that one.
std::map<int, int> held_frames(Shot& shot, std::vector<int> numbers) {
    std::sort(numbers.begin(), numbers.end());
    std::map<int, int> held;
    for (const int number : numbers) {
        if (shot.has(number)) continue;
        if (const std::optional<int> earlier = shot.held(number)) held[number] = *earlier;
    }
    return held;
}

/// The reason why a missing frame cannot be read; nothing if a reader understands its name, as that
/// of a picture that is computed.
std::optional<Problem> why_missing(const std::string& name) {
    const QuietStderr quiet;
    try {
        (void)open_picture(name);
        return {};
    } catch (const FileError&) {
        return why_not_readable(name);
    }
}

/// Refuses outputs that would be read as inputs after they were written.
void check_inputs_stay(const Plan& plan, const std::string& out, const FrameOptions& options) {
    const auto absolute = [](const std::string& name) {
        return fs::absolute(name).lexically_normal().string();
    };
    std::set<std::string> ins;
    for (const FrameFiles& frame : plan.frames)
        ins.insert(absolute(frame.in));
    for (const FrameFiles& frame : plan.frames) {
        if (!ins.contains(absolute(frame.out))) continue;
        throw Error(fmt::format(
            "apply: output is {}, which is also an input frame; expected other files with {}", out,
            options.skip_existing ? "--skip-existing" : "--missing hold"));
    }
}

Plan plan_frames(const std::string& in, const std::string& out, const FrameOptions& options) {
    const Missing missing = parse_missing(options.missing);
    const std::vector<int> numbers = parse_frames(options.frames);
    std::set<int> known;
    for (const int number : numbers) {
        if (!known.insert(number).second)
            throw Error(fmt::format("apply: --frames names frame {} twice; expected once", number));
    }
    Shot shot(in);
    std::map<int, int> held;
    if (missing == Missing::hold) held = held_frames(shot, numbers);
    std::optional<std::optional<Problem>> reason;  // of every missing frame
    Plan plan;
    for (const int number : numbers) {
        FrameFiles frame = {shot.name(number), frame_name("out", out, number)};
        const auto earlier = held.find(number);
        if (earlier != held.end()) {
            frame.in = shot.name(earlier->second);
            ++plan.held_count;
        } else if (!shot.has(number)) {
            if (missing == Missing::skip) {
                ++plan.missing_count;
                continue;
            }
            // A million of them must not take a million attempts to open a picture.
            if (!reason) reason = why_missing(frame.in);
            if (*reason) frame.problem = within(frame.in + ": cannot read", **reason);
        }
        plan.numbers.push_back(number);
        plan.frames.push_back(std::move(frame));
    }
    if (missing == Missing::hold || options.skip_existing) check_inputs_stay(plan, out, options);
    return plan;
}

/// Prints lines for failures.
/// @returns  their number
std::size_t print_failures(const std::vector<FrameFiles>& files) {
    constexpr std::size_t kMostLines = 50;
    std::size_t failed = 0;
    // Warnings that --strict makes errors are the same for all. A million errors are known by their
    // hash.
    std::unordered_set<std::size_t> errors;
    for (const FrameFiles& file : files) {
        if (!file.problem) continue;
        ++failed;
        const std::string text = render(*file.problem, command_style());
        if (errors.insert(std::hash<std::string>()(text)).second && errors.size() <= kMostLines)
            print_message("apply: " + text);
    }
    if (errors.size() > kMostLines)
        print_message(fmt::format("apply: and {} more", errors.size() - kMostLines));
    return failed;
}

/// One line for all, on a terminal or if not all were simply written.
void print_summary(const std::string& text, bool is_all_written) {
    if (says_what_was_done() || (!is_all_written && !message_options().is_quiet))
        print_message("apply: " + text);
}

/// Lines for failures, and one for all.
void print_summary(const Plan& plan) {
    std::vector<int> failed;
    std::size_t skipped = 0;
    for (std::size_t i = 0; i < plan.frames.size(); ++i) {
        const FrameFiles& frame = plan.frames[i];
        skipped += frame.is_skipped ? 1 : 0;
        if (frame.problem) failed.push_back(plan.numbers[i]);
    }
    print_failures(plan.frames);
    const std::size_t count = plan.frames.size() + plan.missing_count;
    const std::size_t written = plan.frames.size() - skipped - failed.size();
    std::string text = fmt::format("{} frame{}: {} written", count, count == 1 ? "" : "s", written);
    if (skipped > 0) text += fmt::format(", {} skipped", skipped);
    if (plan.missing_count > 0) text += fmt::format(", {} missing", plan.missing_count);
    if (plan.held_count > 0) text += fmt::format(", {} held for missing ones", plan.held_count);
    if (!failed.empty())
        text += fmt::format(", {} failed: {}", failed.size(), format_frames(failed));
    print_summary(text, written == count && plan.held_count == 0);
}

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
                if (call) call(text);  // throws with --strict
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

void run(const Tonemapper& tonemapper, std::vector<FrameFiles>& files, SequenceOptions options,
         const PictureInput& picture, const char* what) {
    const QuietStderr quiet;
    ProgressBar bar(quiet.before(), files.size(), what);
    options.done = [&](const FrameFiles& frame) { bar.add(!frame.is_skipped); };
    if (picture.timeout > 0) {
        tonemap_contained(tonemapper, files, options, picture);
        return;
    }
    // Missing frames have their error already.
    std::vector<FrameFiles> open;
    std::vector<std::size_t> places;
    for (std::size_t i = 0; i < files.size(); ++i) {
        if (files[i].problem) continue;
        places.push_back(i);
        open.push_back(std::move(files[i]));
    }
    tonemap_files(tonemapper, open, options);
    for (std::size_t i = 0; i < places.size(); ++i)
        files[places[i]] = std::move(open[i]);
}

int exit_code_of(const std::vector<FrameFiles>& files) {
    const bool any_failed = std::any_of(files.begin(), files.end(),
                                        [](const FrameFiles& f) { return f.problem.has_value(); });
    return any_failed ? kCheckFailed : kOk;
}

}  // namespace

ReadOptions read_options_of(const ApplyOptions& options) {
    ReadOptions read = read_options_of(options.picture);
    read.resize = options.resize;
    return read;
}

void tonemap_contained(const Tonemapper& tonemapper, std::vector<FrameFiles>& files,
                       const SequenceOptions& options, const PictureInput& picture) {
    std::vector<FrameFiles*> open;
    std::vector<std::string> names;
    for (FrameFiles& file : files) {
        if (file.problem) continue;
        open.push_back(&file);
        names.push_back(file.in);
    }
    const auto threads = static_cast<std::size_t>(thread_count(picture.threads));
    const std::size_t wanted = options.jobs > 0 ? static_cast<std::size_t>(options.jobs) : threads;
    const std::size_t jobs = std::clamp<std::size_t>(open.size(), 1, wanted);
    const auto threads_each = static_cast<int>(std::max<std::size_t>(threads / jobs, 1));
    const auto work = [&](std::size_t i) {
        PictureInput threads_of_one;
        threads_of_one.threads = threads_each;
        use_threads(threads_of_one);
        SequenceOptions one = options;
        one.jobs = 1;
        one.nthreads = threads_each;
        one.done = {};
        KeptMessages messages;
        messages.keep(one.write, one.read);
        std::vector<FrameFiles> files_of_one = {*open[i]};
        tonemap_files(tonemapper, files_of_one, one);
        const FrameFiles& file = files_of_one.front();
        if (file.problem) throw_problem(*file.problem);
        return Json{{"is_skipped", file.is_skipped}, {"messages", messages.json()}}.dump();
    };
    run_contained(names, jobs, picture.timeout, work,
                  [&](std::size_t i, const ContainedResult& result) {
                      FrameFiles& file = *open[i];
                      file.problem = result.problem;
                      if (!result.problem) {
                          const Json told = Json::parse(result.value);
                          file.is_skipped = std::get<bool>(told.at("is_skipped").value());
                          KeptMessages::repeat(told.at("messages"), options.write, options.read);
                      } else {
                          remove_leftovers({file.out});
                      }
                      if (options.done) options.done(file);
                  });
}

void tonemap_contained(const Tonemapper& tonemapper, const FrameFiles& file,
                       const WriteOptions& write, const ReadOptions& read,
                       const PictureInput& picture) {
    const auto work = [&](std::size_t) {
        PictureInput threads;
        threads.threads = picture.threads;
        use_threads(threads);
        KeptMessages messages;
        WriteOptions own_write = write;
        ReadOptions own_read = read;
        messages.keep(own_write, own_read);
        tonemap_file(tonemapper, file.in, file.out, own_write, own_read, picture.threads);
        return messages.json().dump();
    };
    run_contained({file.in}, 1, picture.timeout, work,
                  [&](std::size_t, const ContainedResult& result) {
                      if (result.problem) remove_leftovers({file.out});
                      result.require();
                      KeptMessages::repeat(Json::parse(result.value), write, read);
                  });
}

int apply_to_frames(
    const Tonemapper& tonemapper, const ApplyOptions& options, WriteOptions write,
    const std::function<void(std::vector<FrameFiles>&, const std::vector<int>&)>& prepare) {
    Plan plan = plan_frames(options.in, options.out, options.frames);
    check_overwriting(plan.frames, options.is_in_place);
    Warnings warnings(options.out);
    write.warn = warnings.hearer();
    prepare(plan.frames, plan.numbers);
    ReadMessages messages(options.in);
    SequenceOptions sequence;
    sequence.write = write;
    sequence.read = messages.hearing(read_options_of(options));
    sequence.skip_existing = options.frames.skip_existing;
    sequence.jobs = options.frames.jobs;
    sequence.nthreads = options.picture.threads;
    run(tonemapper, plan.frames, sequence, options.picture, "frames");
    messages.print();
    warnings.print();
    print_summary(plan);
    return exit_code_of(plan.frames);
}

int apply_to_files(const Tonemapper& tonemapper, const ApplyOptions& options,
                   std::vector<FrameFiles>& files, WriteOptions write) {
    Warnings warnings({});
    ReadMessages messages({});
    write.warn = warnings.hearer();
    SequenceOptions sequence;
    sequence.write = write;
    sequence.read = messages.hearing(read_options_of(options));
    sequence.names_pictures = true;
    sequence.nthreads = options.picture.threads;
    run(tonemapper, files, sequence, options.picture, "pictures");
    messages.print();
    warnings.print();
    const std::size_t failed = print_failures(files);
    const std::size_t written = files.size() - failed;
    std::string text = fmt::format("{} picture{}: {} written", files.size(),
                                   files.size() == 1 ? "" : "s", written);
    if (failed > 0) text += fmt::format(", {} failed", failed);
    print_summary(text, failed == 0);
    return exit_code_of(files);
}

TONEWRIGHT_NAMESPACE_END
