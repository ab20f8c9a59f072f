// SPDX-License-Identifier: Apache-2.0
#include "tonewright/lut_match.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <set>
#include <utility>

#include "base/random.h"
#include "lut/in_parallel.h"
#include "measure/error_metric.h"
#include "tonewright/engine.h"
#include "tonewright/lut.h"
#include "tonewright/ocio.h"
#include "tonewright/registry.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

constexpr const char* kSceneLinear = "scene-linear";

/// Scene-linear, clipped at 1: ociobakelut writes a view of one curve for each channel as such a 1D
/// table.
constexpr const char* kClippedLinear = "linear:0:1";
/// Encodings of common LUTs; log2 as here, in Blender's AgX and Filmic, and in T. Sobotka's AgX.
constexpr const char* kEncodings[] = {"acescct",     "logc3",
                                      "logc4",       "slog3",
                                      "davinci",     "unity_logc",
                                      "unreal_log",  "agx_log",
                                      "srgb",        "pq:100",
                                      "pq:203",      "log2:-10:6.5",
                                      "log2:-10:15", "log2:-12.47393:4.026069",
                                      kClippedLinear};
constexpr const char* kDisplays[] = {"srgb", "rec1886", "g22", "display_p3", "rec2020", "linear"};

struct Candidate {
    LutMatch match;
    const ResolvedOperator* op;
};

/// Three planes.
using Planes = std::array<std::vector<double>, 3>;

/// Input of the LUT -> light.
Pipeline decode_of(const std::string& encoding) {
    if (encoding == kSceneLinear) return {};
    return {curve_stage(parse_input_encoding(encoding).decode)};
}

/// Inputs of the LUT: codes, or light for a LUT with a shaper.
std::vector<float> samples_of(bool is_linear, std::size_t count) {
    SampleRandom random(23);
    std::vector<float> in;
    for (std::size_t i = 0; i < count; ++i) {
        // Every fourth color is gray.
        const double gray = random.uniform(0, 1);
        for (int c = 0; c < 3; ++c) {
            const double code = i % 4 == 0 ? gray : random.uniform(0, 1);
            in.push_back(static_cast<float>(is_linear ? 0.18 * std::exp2(14 * code - 8) : code));
        }
    }
    return in;
}

/// Colors, and a LUT's output for them.
struct Shown {
    std::vector<float> in;
    std::vector<float> out;

    Shown(const LutFile& table, bool is_linear, std::size_t count)
        : in(samples_of(is_linear, count)), out(in.size()) {
        table.run_rgb(in.data(), out.data(), count);
    }
};

/// A pipeline's results for the inputs.
Planes planes_of(const Pipeline& stages, const std::vector<float>& in) {
    Planes planes;
    for (std::size_t i = 0; i < in.size(); ++i)
        planes[i % 3].push_back(static_cast<double>(in[i]));
    const std::array<double*, 3> at = {planes[0].data(), planes[1].data(), planes[2].data()};
    ReferenceEngine(stages).run({at[0], at[1], at[2]}, at, planes[0].size());
    return planes;
}

void set_errors(LutMatch& match, const Planes& truth, const std::vector<float>& shown) {
    std::vector<double> errors;
    for (std::size_t i = 0; i < truth[0].size(); ++i) {
        const Vector3 expected = {truth[0][i], truth[1][i], truth[2][i]};
        errors.push_back(channel_error(expected.data(), &shown[3 * i]));
    }
    const ErrorStats stats = summarise(errors);
    match.max = stats.max;
    match.p999 = stats.p999;
    match.mean = stats.mean;
}

/// An encoding of the input, and a few colors in it.
struct Input {
    std::string encoding;
    std::vector<std::string> spaces;
    Planes light;
    const Shown* shown;
};

/// Matches of an operator with all inputs and displays.
std::vector<Candidate> candidates_of(const ResolvedOperator& op, const std::vector<Input>& inputs) {
    std::vector<Candidate> all;
    // A display's view of a space is the same for all encodings.
    std::map<std::pair<std::string, const char*>, ReferenceEngine> views;
    for (const Input& input : inputs) {
        for (const std::string& space : input.spaces) {
            for (const char* display : kDisplays) {
                auto view = views.find({space, display});
                if (view == views.end()) {
                    ReferenceEngine engine(build_view(make_view(op, space, 0, display)));
                    view = views.emplace(std::pair(space, display), std::move(engine)).first;
                }
                Planes truth = input.light;
                const std::array<double*, 3> at = {truth[0].data(), truth[1].data(),
                                                   truth[2].data()};
                view->second.run({at[0], at[1], at[2]}, at, truth[0].size());
                all.push_back({{op.label, input.encoding, space, display}, &op});
                all.back().match.definition = op.op;
                set_errors(all.back().match, truth, input.shown->out);
            }
        }
    }
    return all;
}

/// All operators, the known defects, and the intended operators.
std::vector<ResolvedOperator> all_and_defects() {
    std::vector<ResolvedOperator> all;
    std::set<std::string> labels;
    const auto add = [&](ResolvedOperator op) {
        if (labels.insert(op.label).second) all.push_back(std::move(op));
    };
    for (const Operator& op : all_operators()) {
        if (!op.is_diagnostic) add(resolve_operator(op.id));
    }
    for (const Operator& defect : known_defects()) {
        add(resolve_operator(defect.meant));
        add(resolve(defect, nullptr, {}, ""));
    }
    return all;
}

/// The sort key of candidates. If a LUT does not reach the colors where a defect and the intended
/// operator differ, it counts as the operator's, and rounding must not decide against that.
double rank(const LutMatch& match) {
    constexpr double kMargin = 1.5;
    // A table of all scene-linear colors is right up to 1, too.
    constexpr double kMarginOfClipped = 10;
    return match.mean * (match.definition->is_defect() ? kMargin : 1) *
           (match.encoding == kClippedLinear ? kMarginOfClipped : 1);
}

/// With all colors.
void measure(Candidate& candidate, const Shown& shown) {
    LutMatch& match = candidate.match;
    Pipeline stages = decode_of(match.encoding);
    const Pipeline view = build_view(make_view(*candidate.op, match.input, 0, match.display));
    stages.insert(stages.end(), view.begin(), view.end());
    set_errors(match, planes_of(stages, shown.in), shown.out);
}

}  // namespace

std::vector<LutMatch> match_lut(const LutFile& table,
                                const std::vector<ResolvedOperator>& operators, std::size_t count) {
    const std::vector<ResolvedOperator> chosen = operators.empty() ? all_and_defects() : operators;
    // A few colors select the candidates for the full comparison.
    const auto by_mean = [](const Candidate& a, const Candidate& b) {
        return rank(a.match) < rank(b.match);
    };
    constexpr std::size_t kFew = 64;
    constexpr std::size_t kMany = 20000;
    const std::array<Shown, 2> few = {Shown(table, false, kFew), Shown(table, true, kFew)};
    std::vector<Input> inputs = {{kSceneLinear, {"lin_rec709"}, {}, &few[1]},
                                 {kSceneLinear, {"lin_ap1"}, {}, &few[1]}};
    for (const char* text : kEncodings) {
        const InputEncoding encoding = parse_input_encoding(text);
        const std::set<std::string> spaces = {encoding.default_input, "lin_rec709"};
        inputs.push_back({encoding.id, {spaces.begin(), spaces.end()}, {}, few.data()});
    }
    for (Input& input : inputs)
        input.light = planes_of(decode_of(input.encoding), input.shown->in);
    std::vector<std::vector<Candidate>> by_operator(chosen.size());
    in_parallel(chosen.size(), 0,
                [&](std::size_t i) { by_operator[i] = candidates_of(chosen[i], inputs); });
    std::vector<Candidate> nearest;
    for (const std::vector<Candidate>& all : by_operator) {
        nearest.insert(nearest.end(), all.begin(), all.end());
        const std::size_t kept = std::min(nearest.size(), 2 * count);
        std::partial_sort(nearest.begin(), nearest.begin() + static_cast<std::ptrdiff_t>(kept),
                          nearest.end(), by_mean);
        nearest.resize(kept);
    }
    const std::array<Shown, 2> many = {Shown(table, false, kMany), Shown(table, true, kMany)};
    in_parallel(nearest.size(), 0, [&](std::size_t i) {
        measure(nearest[i], many[nearest[i].match.encoding == kSceneLinear ? 1 : 0]);
    });
    std::sort(nearest.begin(), nearest.end(), by_mean);
    std::vector<LutMatch> matches;
    for (std::size_t i = 0; i < std::min(count, nearest.size()); ++i)
        matches.push_back(nearest[i].match);
    return matches;
}

TONEWRIGHT_NAMESPACE_END
