// SPDX-License-Identifier: Apache-2.0
#include "tonewright/lut_match.h"

#include <algorithm>
#include <cmath>
#include <set>

#include "base/random.h"
#include "measure/error_metric.h"
#include "tonewright/engine.h"
#include "tonewright/lut.h"
#include "tonewright/ocio.h"
#include "tonewright/registry.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

constexpr const char* kSceneLinear = "scene-linear";

/// What LUTs are made for; log2 as here, as in Blender's AgX and Filmic, and as T. Sobotka's AgX.
constexpr const char* kEncodings[] = {"acescct",
                                      "logc3",
                                      "logc4",
                                      "slog3",
                                      "davinci",
                                      "unity_logc",
                                      "unreal_log",
                                      "srgb",
                                      "pq:100",
                                      "pq:203",
                                      "log2:-10:6.5",
                                      "log2:-10:15",
                                      "log2:-12.47393:4.026069"};
constexpr const char* kDisplays[] = {"srgb", "rec1886", "g22", "display_p3", "rec2020", "linear"};

struct Candidate {
    LutMatch match;
    ResolvedOperator op;
    Pipeline stages;  // what goes in -> what comes out
};

/// What goes in: codes, or light for a table with a shaper.
std::vector<float> samples_of(bool is_linear, std::size_t count) {
    SampleRandom random(23);
    std::vector<float> in;
    for (std::size_t i = 0; i < count; ++i) {
        // Every fourth is a grey.
        const double grey = random.uniform(0, 1);
        for (int c = 0; c < 3; ++c) {
            const double code = i % 4 == 0 ? grey : random.uniform(0, 1);
            in.push_back(static_cast<float>(is_linear ? 0.18 * std::exp2(14 * code - 8) : code));
        }
    }
    return in;
}

void measure(Candidate& candidate, const LutFile& table, std::size_t count) {
    const std::vector<float> in = samples_of(candidate.match.encoding == kSceneLinear, count);
    std::vector<float> shown(in.size());
    table.run_rgb(in.data(), shown.data(), count);
    std::vector<double> truth(in.size());
    ReferenceEngine(candidate.stages).run_rgb(in.data(), truth.data(), count);
    std::vector<double> errors;
    for (std::size_t i = 0; i < count; ++i)
        errors.push_back(channel_error(&truth[3 * i], &shown[3 * i]));
    const ErrorStats stats = summarise(errors);
    candidate.match.max = stats.max;
    candidate.match.p999 = stats.p999;
    candidate.match.mean = stats.mean;
}

void add_candidates(const ResolvedOperator& op, std::vector<Candidate>& all) {
    const auto add = [&](const std::string& encoding, const Pipeline& decode,
                         const std::string& input) {
        for (const char* display : kDisplays) {
            const View view = make_view(op, input, 0, display);
            Pipeline stages = decode;
            const Pipeline shown = build_view(view);
            stages.insert(stages.end(), shown.begin(), shown.end());
            all.push_back({{op.label, encoding, input, display}, op, stages});
        }
    };
    add(kSceneLinear, {}, "lin_rec709");
    add(kSceneLinear, {}, "lin_ap1");
    for (const char* text : kEncodings) {
        const InputEncoding encoding = parse_input_encoding(text);
        for (const std::string& input : std::set<std::string>{encoding.default_input, "lin_rec709"})
            add(encoding.id, {curve_stage(encoding.decode)}, input);
    }
}

}  // namespace

std::vector<LutMatch> match_lut(const LutFile& table, const std::vector<std::string>& operators,
                                std::size_t count) {
    std::vector<ResolvedOperator> chosen;
    for (const std::string& text : operators)
        chosen.push_back(parse_operator(text));
    if (operators.empty()) {
        for (const Operator& op : all_operators()) {
            if (!op.is_diagnostic) chosen.push_back(resolve_operator(op.id));
        }
    }
    // Few colors tell which ones are worth more.
    const auto by_mean = [](const Candidate& a, const Candidate& b) {
        return a.match.mean < b.match.mean;
    };
    constexpr std::size_t kFew = 64;
    constexpr std::size_t kMany = 20000;
    std::vector<Candidate> nearest;
    for (const ResolvedOperator& op : chosen) {
        std::vector<Candidate> all;
        add_candidates(op, all);
        for (Candidate& candidate : all) {
            measure(candidate, table, kFew);
            nearest.push_back(candidate);
        }
        const std::size_t kept = std::min(nearest.size(), 2 * count);
        std::partial_sort(nearest.begin(), nearest.begin() + static_cast<std::ptrdiff_t>(kept),
                          nearest.end(), by_mean);
        nearest.resize(kept);
    }
    for (Candidate& candidate : nearest)
        measure(candidate, table, kMany);
    std::sort(nearest.begin(), nearest.end(), by_mean);
    std::vector<LutMatch> matches;
    for (std::size_t i = 0; i < std::min(count, nearest.size()); ++i)
        matches.push_back(nearest[i].match);
    return matches;
}

TONEWRIGHT_NAMESPACE_END
