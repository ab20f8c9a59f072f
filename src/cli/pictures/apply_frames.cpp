// SPDX-License-Identifier: Apache-2.0
#include "cli/pictures/apply_frames.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <map>
#include <optional>
#include <set>
#include <vector>

#include "base/strings.h"
#include "cli/pictures/frames.h"
#include "cli/pictures/picture_input.h"
#include "cli/pictures/progress_bar.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

namespace fs = std::filesystem;

enum class Missing { error, skip, hold };

Missing parse_missing(const std::string& text) {
    if (text == "error") return Missing::error;
    if (text == "skip") return Missing::skip;
    if (text == "hold") return Missing::hold;
    const std::vector<std::string> names = {"error", "skip", "hold"};
    throw Error("apply: missing is " + text + "; expected " + join_choices(names) +
                did_you_mean(text, names));
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
        // What cannot be looked at is no missing frame: reading it tells why.
        const fs::file_type type = fs::status(name(frame), error).type();
        return known_[frame] = type != fs::file_type::not_found;
    }
    /// The frame that stands for a missing one. It depends on the files alone, not on which frames
    /// are asked for: every part of a shot gets the same.
    [[nodiscard]] std::optional<int> held(int frame) {
        for (int earlier = frame - 1; earlier >= frame - kMostHeld; --earlier) {
            if (has(earlier)) return earlier;
        }
        return {};
    }

    static constexpr int kMostHeld = 1000;

  private:
    std::string pattern_;
    std::map<int, bool> known_;
};

struct Plan {
    std::vector<int> numbers;
    std::vector<FrameFiles> frames;  // as many
    std::size_t missing_count = 0;   // skipped
    std::size_t held_count = 0;
};

Plan plan_frames(const std::string& in, const std::string& out, const FrameOptions& options) {
    const Missing missing = parse_missing(options.missing);
    Shot shot(in);
    Plan plan;
    std::set<std::string> ins, outs;
    for (const int number : parse_frames(options.frames)) {
        FrameFiles frame = {shot.name(number), frame_name("out", out, number)};
        if (!outs.insert(fs::absolute(frame.out).lexically_normal()).second)
            throw Error(fmt::format("apply: --frames names frame {} twice; expected once", number));
        if (missing != Missing::error && !shot.has(number)) {
            if (missing == Missing::skip) {
                ++plan.missing_count;
                continue;
            }
            if (const std::optional<int> held = shot.held(number)) {
                frame.in = shot.name(*held);
                ++plan.held_count;
            }
        }
        ins.insert(fs::absolute(frame.in).lexically_normal());
        plan.numbers.push_back(number);
        plan.frames.push_back(std::move(frame));
    }
    if (missing == Missing::hold || options.skip_existing) {
        for (const std::string& name : outs) {
            if (!ins.contains(name)) continue;
            throw Error(fmt::format(
                "apply: out is {}, a frame that is read, too; expected other files with {}", out,
                options.skip_existing ? "--skip-existing" : "--missing hold"));
        }
    }
    return plan;
}

/// Lines for what failed, and one for all.
void print_summary(const Plan& plan, bool is_terminal) {
    constexpr std::size_t kMostLines = 50;
    std::vector<int> failed;
    std::size_t skipped = 0;
    for (std::size_t i = 0; i < plan.frames.size(); ++i) {
        const FrameFiles& frame = plan.frames[i];
        skipped += frame.is_skipped ? 1 : 0;
        if (frame.error.empty()) continue;
        failed.push_back(plan.numbers[i]);
        if (failed.size() <= kMostLines) fmt::print(stderr, "tonewright: apply: {}\n", frame.error);
    }
    if (failed.size() > kMostLines) {
        fmt::print(stderr, "tonewright: apply: and {} more\n", failed.size() - kMostLines);
    }
    const std::size_t count = plan.frames.size() + plan.missing_count;
    const std::size_t written = plan.frames.size() - skipped - failed.size();
    if (written == count && plan.held_count == 0 && !is_terminal) return;
    std::string text = fmt::format("{} frame{}: {} written", count, count == 1 ? "" : "s", written);
    if (skipped > 0) text += fmt::format(", {} skipped", skipped);
    if (plan.missing_count > 0) text += fmt::format(", {} missing", plan.missing_count);
    if (plan.held_count > 0) text += fmt::format(", {} held for missing ones", plan.held_count);
    if (!failed.empty())
        text += fmt::format(", {} failed: {}", failed.size(), format_frames(failed));
    fmt::print(stderr, "tonewright: apply: {}\n", text);
}

}  // namespace

int apply_to_frames(
    const Tonemapper& tonemapper, const std::string& in, const std::string& out,
    const FrameOptions& options, const OIIO::TypeDesc& type, int threads,
    const std::function<void(std::vector<FrameFiles>&, const std::vector<int>&)>& prepare) {
    Plan plan = plan_frames(in, out, options);
    prepare(plan.frames, plan.numbers);
    {
        const QuietStderr quiet;
        ProgressBar bar(quiet.before(), plan.frames.size());
        SequenceOptions sequence;
        sequence.type = type;
        sequence.skip_existing = options.skip_existing;
        sequence.jobs = options.jobs;
        sequence.nthreads = threads;
        sequence.done = [&](const FrameFiles& frame) { bar.add(!frame.is_skipped); };
        tonemap_files(tonemapper, plan.frames, sequence);
    }
    print_summary(plan, ::isatty(STDERR_FILENO) != 0);
    const bool any_failed = std::any_of(plan.frames.begin(), plan.frames.end(),
                                        [](const FrameFiles& f) { return !f.error.empty(); });
    return any_failed ? kCheckFailed : kOk;
}

TONEWRIGHT_NAMESPACE_END
