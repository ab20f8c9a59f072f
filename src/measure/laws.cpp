// SPDX-License-Identifier: Apache-2.0
#include "measure/laws.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "base/format_number.h"
#include "base/random.h"
#include "base/strings.h"
#include "measure/chart_colors.h"
#include "pipeline/invert.h"
#include "tonewright/engine.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

using Kind = DocumentedDifference::Kind;
using Verdict = LawResult::Verdict;
using Planes = std::array<std::vector<double>, 3>;

constexpr double kMidGray = 0.18;

/// One step of an 8-bit picture, for the mean of the channels. If a gamut's limit lowers one
/// channel of a saturated color while the others rise, the loss is smaller.
constexpr double kStep = 1.0 / 255;
/// Half a code of 10 bits.
constexpr double kHalfCode = 0.5 / 1023;

/// Colors along a line.
struct Sweep {
    std::string name;  // the name of its color: "grays", "red"
    Vector3 color{};   // times x
    std::vector<double> x;
    Vector3 from{};  // added
};

/// Red, its neighbors on the hexcone, and orange.
std::vector<Sweep> color_sweeps(const std::vector<double>& exposures) {
    return {{"red", {1, 0, 0}, exposures},         {"yellow", {1, 1, 0}, exposures},
            {"green", {0, 1, 0}, exposures},       {"cyan", {0, 1, 1}, exposures},
            {"blue", {0, 0, 1}, exposures},        {"magenta", {1, 0, 1}, exposures},
            {"orange", {1, 0.25, 0.02}, exposures}};
}

/// The edges of the hexcone between saturated colors, and from gray to each.
std::vector<Sweep> hue_sweeps() {
    std::vector<double> steps;
    for (int i = 0; i <= 96; ++i)
        steps.push_back(i / 96.0);
    constexpr double kLevel = 0.5;
    const std::vector<Sweep> colors = color_sweeps({});
    const auto between = [&](const std::string& name, const Vector3& a, const Vector3& b) {
        Sweep sweep{"colors between " + name, {}, steps};
        for (std::size_t c = 0; c < 3; ++c) {
            sweep.from[c] = kLevel * a[c];
            sweep.color[c] = kLevel * (b[c] - a[c]);
        }
        return sweep;
    };
    constexpr std::size_t kCorners = 6;
    std::vector<Sweep> sweeps;
    for (std::size_t i = 0; i < kCorners; ++i) {
        const Sweep& next = colors[(i + 1) % kCorners];
        sweeps.push_back(
            between(colors[i].name + " and " + next.name, colors[i].color, next.color));
        sweeps.push_back(between("gray and " + colors[i].name, {1, 1, 1}, colors[i].color));
    }
    return sweeps;
}

Planes run(const ReferenceEngine& engine, Planes planes) {
    const std::array<double*, 3> p = {planes[0].data(), planes[1].data(), planes[2].data()};
    engine.run({p[0], p[1], p[2]}, p, planes[0].size());
    return planes;
}

Planes run(const ReferenceEngine& engine, const Vector3& color, const std::vector<double>& x,
           const Vector3& from = {}) {
    Planes planes;
    for (std::size_t c = 0; c < 3; ++c) {
        for (const double v : x)
            planes[c].push_back(from[c] + color[c] * v);
    }
    return run(engine, std::move(planes));
}

constexpr Vector3 kGray = {1, 1, 1};

/// "x = 4.02, 4.48 stops above mid gray"
std::string place(double x) {
    std::string text = "x = " + rounded(x, 3);
    if (!(x > 0)) return text;
    const double stops = std::log2(x / kMidGray);
    if (std::fabs(stops) < 0.005) return text + ", mid gray";
    return text + fmt::format(", {:.3g} stops {} mid gray", std::fabs(stops),
                              stops < 0 ? "below" : "above");
}

std::vector<double> ramp_to_brightest() {
    std::vector<double> ramp = gray_ramp();
    std::erase_if(ramp, [](double x) { return x > kHalfMax; });
    ramp.push_back(kHalfMax);
    return ramp;
}

std::vector<double> ramp_from_black() {
    std::vector<double> ramp = ramp_to_brightest();
    ramp.insert(ramp.begin(), 0.0);
    return ramp;
}

/// The operator as native, as display-linear and as sRGB code values.
class Subject {
  public:
    explicit Subject(const ResolvedOperator& op)
        : op_(op),
          native_(build_view(view(kNativeOutput))),
          light_(build_view(view(kLinearOutput))),
          srgb_(build_view(view("srgb"))) {}

    [[nodiscard]] View view(std::string_view display) const {
        return make_view(op_, "lin_rec709", 0, display);
    }
    [[nodiscard]] const ResolvedOperator& op() const { return op_; }
    [[nodiscard]] const ReferenceEngine& native() const { return native_; }
    [[nodiscard]] const ReferenceEngine& light() const { return light_; }
    [[nodiscard]] const ReferenceEngine& srgb() const { return srgb_; }

  private:
    const ResolvedOperator& op_;
    ReferenceEngine native_, light_, srgb_;
};

// ---------------------------------------------------------------------------------------------
// Jumps

struct Jump {
    double x;
    double from, to;
};

/// The largest jump along a sweep: a difference between neighbors that does not get smaller when
/// their distance is halved, down to neighboring doubles.
std::optional<Jump> find_jump(const ReferenceEngine& engine, const Sweep& sweep) {
    struct Interval {
        double a, b;
        Vector3 at_a, at_b;
        std::size_t channel;  // with the largest difference
        [[nodiscard]] double difference() const { return std::fabs(at_b[channel] - at_a[channel]); }
        /// Smaller jumps are the formula's own rounding, or invisible.
        [[nodiscard]] bool is_step() const {
            return difference() >
                   kNoise * std::max({1.0, std::fabs(at_a[channel]), std::fabs(at_b[channel])});
        }
    };
    const auto make = [](double a, double b, const Vector3& at_a, const Vector3& at_b) {
        Interval i{a, b, at_a, at_b, 0};
        for (std::size_t c = 1; c < 3; ++c) {
            if (std::fabs(at_b[c] - at_a[c]) > i.difference()) i.channel = c;
        }
        return i;
    };
    const auto color = [](const Planes& p, std::size_t i) {
        return Vector3{p[0][i], p[1][i], p[2][i]};
    };
    std::vector<Interval> open;
    const Planes values = run(engine, sweep.color, sweep.x, sweep.from);
    for (std::size_t i = 1; i < sweep.x.size(); ++i)
        open.push_back(make(sweep.x[i - 1], sweep.x[i], color(values, i - 1), color(values, i)));
    std::optional<Jump> largest;
    while (true) {
        std::erase_if(open, [](const Interval& i) { return !i.is_step(); });
        std::vector<double> middle;
        std::vector<Interval> halved;
        for (const Interval& i : open) {
            const double m = i.a + (i.b - i.a) / 2;
            // A curve may be infinitely steep at black: 1e-300^0.02 is 1e-6.
            if (m > i.a && m < i.b && i.b > 1e-300) {
                middle.push_back(m);
                halved.push_back(i);
            } else if (!largest || i.difference() > std::fabs(largest->to - largest->from)) {
                largest = {i.b, i.at_a[i.channel], i.at_b[i.channel]};
            }
        }
        if (middle.empty()) return largest;
        const Planes at = run(engine, sweep.color, middle, sweep.from);
        open.clear();
        for (std::size_t k = 0; k < middle.size(); ++k) {
            const Vector3 m = color(at, k);
            const Interval left = make(halved[k].a, middle[k], halved[k].at_a, m);
            const Interval right = make(middle[k], halved[k].b, m, halved[k].at_b);
            open.push_back(left.difference() > right.difference() ? left : right);
        }
    }
}

// ---------------------------------------------------------------------------------------------

Differences measured(const Subject& subject) {
    Differences found;
    const std::vector<double> ramp = ramp_to_brightest();

    double black = 0;
    for (const double x : subject.native()({0, 0, 0})) {
        if (std::fabs(x) > kNoise && std::fabs(x) > std::fabs(black)) black = x;
    }
    if (black != 0) found[Kind::black] = black;

    const Planes own = run(subject.native(), kGray, ramp);
    const Planes linear = run(subject.light(), kGray, ramp);
    const Planes shown = run(subject.srgb(), kGray, ramp);
    double largest = 0;
    double largest_two_stops_down = 0;
    double tint = 0;
    for (std::size_t i = 0; i < ramp.size(); ++i) {
        bool is_black = true;
        for (std::size_t c = 0; c < 3; ++c) {
            is_black = is_black && shown[c][i] == 0;
            largest = std::max(largest, linear[c][i]);
            if (ramp[i] <= kHalfMax / 4)
                largest_two_stops_down = std::max(largest_two_stops_down, linear[c][i]);
            if (i > 0 && own[c][i] < own[c][i - 1] - kNoise) found[Kind::not_monotone] = ramp[i];
        }
        if (is_black && ramp[i] >= 1e-3) found[Kind::crushes_black] = ramp[i];
        const auto [lo, hi] = std::minmax({shown[0][i], shown[1][i], shown[2][i]});
        tint = std::max(tint, hi - lo);
    }
    if (largest > 1 + kNoise) {
        if (largest > 1.2 * largest_two_stops_down) largest = kInfinity;
        found[Kind::exceeds_white] = largest;
    }
    if (tint > kHalfCode) found[Kind::tints_gray] = tint;
    const std::size_t last = ramp.size() - 1;
    const double white = std::min({shown[0][last], shown[1][last], shown[2][last]});
    if (white < 1 - kHalfCode) {
        found[Kind::never_reaches_white] =
            std::min({linear[0][last], linear[1][last], linear[2][last]});
    }
    if (const auto jump = find_jump(subject.native(), {"grays", kGray, ramp_from_black()}))
        found[Kind::jumps] = std::fabs(jump->to - jump->from);
    return found;
}

// ---------------------------------------------------------------------------------------------
// One law each

class Checker {
  public:
    explicit Checker(const ResolvedOperator& op)
        : subject_(op),
          measured_(measured(subject_)),
          declared_(declared_differences(op)),
          has_defaults_(op.params == resolve(*op.op, op.preset, {}, op.params.look()).params) {}

    std::vector<LawResult> run_all() {
        return {finite(), monotone(), bounded(), white(), black(), gray(), continuous(), inverse()};
    }

  private:
    /// The verdict from the measured and the declared difference of one kind. Empty: neither
    /// exists.
    /// @param words  description of the break, if nothing is declared
    [[nodiscard]] std::optional<LawResult> compared(const std::string& law, Kind kind,
                                                    const std::string& words,
                                                    std::optional<double> x = {}) const {
        const auto found = measured_.find(kind);
        const auto declared = declared_.find(kind);
        if (found == measured_.end() && (declared == declared_.end() || !has_defaults_))
            return std::nullopt;
        const std::string key =
            "kind = \"" + difference_names().at(static_cast<std::size_t>(kind)) + "\"";
        if (found == measured_.end()) {
            return LawResult{law,
                             Verdict::breaks,
                             "holds, but the definition declares \"" +
                                 to_string(DocumentedDifference{kind, declared->second, ""}) +
                                 "\"; remove the deviation with " + key,
                             {}};
        }
        const std::string text = to_string(DocumentedDifference{kind, found->second, ""});
        if (declared == declared_.end()) return LawResult{law, Verdict::breaks, words, x};
        // Declared with two digits: 5 % covers their rounding.
        const bool agrees =
            !has_defaults_ || declared->second == found->second ||
            std::fabs(declared->second - found->second) <= 0.05 * std::fabs(found->second);
        if (agrees) return LawResult{law, Verdict::as_declared, text, {}};
        return LawResult{
            law, Verdict::breaks,
            text + ", but the definition declares " + rounded(declared->second, 3) + " with " + key,
            x};
    }

    LawResult finite() const {
        SampleRandom random(41);
        Planes in;
        constexpr int kColors = 2000;
        for (int i = 0; i < kColors; ++i) {
            for (auto& plane : in) {
                const double x = std::exp2(random.uniform(-20, 16));
                plane.push_back(random.bits() % 3 == 0 ? -x : x);
            }
        }
        for (const double x : ramp_to_brightest()) {
            for (auto& plane : in)
                plane.push_back(x);
        }
        const Planes out = run(subject_.native(), in);
        for (std::size_t i = 0; i < in[0].size(); ++i) {
            if (std::isfinite(out[0][i] + out[1][i] + out[2][i])) continue;
            return {"finite", Verdict::breaks,
                    "gives no finite number for the color " + rounded(in[0][i], 3) + " " +
                        rounded(in[1][i], 3) + " " + rounded(in[2][i], 3),
                    in[0][i]};
        }
        return {"finite", Verdict::holds, "", {}};
    }

    LawResult monotone() const {
        const std::vector<double> ramp = ramp_to_brightest();
        std::optional<Fall> fall;
        for (std::size_t c = 0; c < 3; ++c) {
            const auto channel = [&](const std::vector<double>& x) {
                return run(subject_.native(), kGray, x)[c];
            };
            const std::optional<Fall> found = find_fall(channel, ramp, kNoise);
            if (found && (!fall || found->x_from < fall->x_from)) fall = found;
        }
        const std::string name = "monotone";
        const std::string words = fall ? falls("grays", *fall) : "";
        if (auto result = compared(name, Kind::not_monotone, words,
                                   fall ? std::optional(fall->x_from) : std::nullopt)) {
            return *result;
        }
        if (auto flat = flat_part()) {
            return {name, Verdict::breaks,
                    "grays from x = " + rounded(flat->first, 3) + " to " +
                        rounded(flat->second, 3) + " do not get brighter",
                    flat->first};
        }
        for (const Sweep& sweep : color_sweeps(ramp)) {
            const auto mean = [&](const std::vector<double>& x) {
                const Planes shown = run(subject_.srgb(), sweep.color, x);
                std::vector<double> values;
                for (std::size_t i = 0; i < x.size(); ++i)
                    values.push_back((shown[0][i] + shown[1][i] + shown[2][i]) / 3);
                return values;
            };
            if (const std::optional<Fall> found = find_fall(mean, ramp, kStep)) {
                return {name, Verdict::breaks,
                        "the mean sRGB code value of " + falls(sweep.name, *found), found->x_from};
            }
        }
        return {name, Verdict::holds, "", {}};
    }

    static std::string falls(const std::string& what, const Fall& fall) {
        const auto stops = [](double x) { return fmt::format("{:+.3g}", std::log2(x / kMidGray)); };
        const std::string from = stops(fall.x_from);
        const std::string to = stops(fall.x_to);
        return what + (what == "grays" ? " fall " : " falls ") + to_string(fall) + " (" + from +
               (from == to ? "" : " to " + to) + " stops from mid gray)";
    }

    /// Between -6 and +3 stops, every operator must rise above the end of its black.
    std::optional<std::pair<double, double>> flat_part() const {
        const auto crushed = measured_.find(Kind::crushes_black);
        std::vector<double> x;
        for (int stops = -6; stops <= 3; ++stops) {
            const double gray = kMidGray * std::exp2(stops);
            if (crushed == measured_.end() || gray > 1.05 * crushed->second) x.push_back(gray);
        }
        const Planes out = run(subject_.srgb(), kGray, x);
        for (std::size_t i = 0; i + 1 < x.size(); ++i) {
            // A look may lower one channel of a gray while the gray as a whole gets brighter.
            const auto code = [&](std::size_t k) { return out[0][k] + out[1][k] + out[2][k]; };
            // A clamped operator has reached white.
            if (code(i) < 3 - kNoise && code(i) >= code(i + 1)) return std::pair{x[i], x[i + 1]};
        }
        return std::nullopt;
    }

    LawResult bounded() const {
        const std::vector<double> ramp = ramp_to_brightest();
        const Planes out = run(subject_.light(), kGray, ramp);
        const double peak = std::max(1.0, subject_.op().peak());
        double largest = 0;
        std::optional<double> x;
        for (std::size_t i = 0; i < ramp.size(); ++i) {
            const double most = std::max({out[0][i], out[1][i], out[2][i]});
            largest = std::max(largest, most);
            if (!x && most > peak + kNoise) x = ramp[i];
        }
        const std::string of_peak =
            peak > 1 ? "the declared peak, " + rounded(peak, 3) : "white, the output peak";
        if (!x) {
            const bool has_peak = largest > 1 + kNoise;
            return {"bounded",
                    has_peak ? Verdict::as_declared : Verdict::holds,
                    "grays end at " + rounded(largest, 3) +
                        (has_peak ? " of the declared peak, " + rounded(peak, 3) : ""),
                    {}};
        }
        const std::string words = "grays exceed " + of_peak + ", from " + place(*x) +
                                  ", and go up to " + rounded(largest, 3) +
                                  "; clamp the output, or declare output.peak";
        return compared("bounded", Kind::exceeds_white, words, x)
            .value_or(LawResult{"bounded", Verdict::breaks, words, x});
    }

    LawResult white() const {
        const auto found = measured_.find(Kind::never_reaches_white);
        const std::string words = found == measured_.end()
                                      ? ""
                                      : "the brightest gray, x = 65504, is shown as " +
                                            rounded(found->second, 3) +
                                            " of display white; expected 1";
        return compared("white", Kind::never_reaches_white, words, kHalfMax)
            .value_or(LawResult{"white", Verdict::holds, "", {}});
    }

    LawResult black() const {
        const auto value = measured_.find(Kind::black);
        const auto crushed = measured_.find(Kind::crushes_black);
        const std::string lifted =
            value == measured_.end()
                ? ""
                : "black becomes " + rounded(value->second, 3) + "; expected 0";
        const std::string shown =
            crushed == measured_.end()
                ? ""
                : "grays up to " + place(crushed->second) + ", are shown as black";
        const auto first = compared("black", Kind::black, lifted, 0);
        const auto second =
            compared("black", Kind::crushes_black, shown,
                     crushed == measured_.end() ? std::nullopt : std::optional(crushed->second));
        if (!first || (second && second->verdict == Verdict::breaks))
            return second.value_or(LawResult{"black", Verdict::holds, "", {}});
        LawResult result = *first;
        if (second && result.verdict != Verdict::breaks) result.text += "; " + second->text;
        return result;
    }

    LawResult gray() const {
        const std::vector<double> ramp = ramp_to_brightest();
        const Planes out = run(subject_.srgb(), kGray, ramp);
        std::string words;
        std::optional<double> x;
        for (std::size_t i = 0; i < ramp.size() && !x; ++i) {
            const auto [lo, hi] = std::minmax({out[0][i], out[1][i], out[2][i]});
            if (!(hi - lo > kHalfCode)) continue;
            x = ramp[i];
            const auto found = measured_.find(Kind::tints_gray);
            words = "grays get a tint from " + place(*x) +
                    ": their sRGB code values differ by up to " +
                    rounded(found == measured_.end() ? hi - lo : found->second, 2);
        }
        return compared("gray", Kind::tints_gray, words, x)
            .value_or(LawResult{"gray", Verdict::holds, "", {}});
    }

    LawResult continuous() const {
        const std::string name = "continuous";
        const std::vector<double> x = ramp_from_black();
        std::vector<Sweep> sweeps = color_sweeps(x);
        sweeps.insert(sweeps.begin(), {"grays", kGray, x});
        const std::size_t exposures = sweeps.size();
        for (Sweep& sweep : hue_sweeps())
            sweeps.push_back(std::move(sweep));
        for (std::size_t i = 0; i < sweeps.size(); ++i) {
            const Sweep& sweep = sweeps[i];
            const std::optional<Jump> jump = find_jump(subject_.native(), sweep);
            if (!jump) continue;
            std::string at = i < exposures ? place(jump->x) : "the color";
            for (std::size_t c = 0; i >= exposures && c < 3; ++c)
                at += " " + rounded(sweep.from[c] + sweep.color[c] * jump->x, 3);
            const bool is_one = i > 0 && i < exposures;
            const std::string words = sweep.name + (is_one ? " jumps" : " jump") + " from " +
                                      rounded(jump->from, 4) + " to " + rounded(jump->to, 4) +
                                      " at " + at;
            const auto x_of_jump = i < exposures ? std::optional(jump->x) : std::nullopt;
            return compared(name, Kind::jumps, words, x_of_jump)
                .value_or(LawResult{name, Verdict::breaks, words, x_of_jump});
        }
        return compared(name, Kind::jumps, "").value_or(LawResult{name, Verdict::holds, "", {}});
    }

    /// Compares the displayed color with the color that its inverse shows. If the operator shows
    /// many colors as one, any of them will do. A saturated color that a clamp limits is skipped,
    /// because a matrix after the clamp has changed it.
    LawResult inverse() const {
        const std::string name = "inverse";
        std::optional<ReferenceEngine> back;
        try {
            back.emplace(build_inverse_view(subject_.view(kNativeOutput)));
        } catch (const Error& e) {
            const std::string message = e.what();
            const std::string before = subject_.op().op->name() + " has no inverse: ";
            const bool has_name = message.compare(0, before.size(), before) == 0;
            return {
                name, Verdict::does_not_apply, message.substr(has_name ? before.size() : 0), {}};
        }
        std::vector<Sweep> sweeps = color_sweeps(ramp_to_brightest());
        sweeps.insert(sweeps.begin(), {"grays", kGray, ramp_to_brightest()});
        Pipeline stages = build_view(subject_.view(kNativeOutput));
        std::erase_if(stages, [](const Stage& s) { return std::holds_alternative<ClampStage>(s); });
        const ReferenceEngine unlimited(stages);
        double worst = 0;
        for (const Sweep& sweep : sweeps) {
            const Planes shown = run(subject_.native(), sweep.color, sweep.x);
            const Planes free = run(unlimited, sweep.color, sweep.x);
            const Planes scene = run(*back, shown);
            const Planes again = run(subject_.native(), scene);
            const auto is_limited = [&](std::size_t i) {
                for (std::size_t c = 0; c < 3; ++c) {
                    // Engines limit their input.
                    if (std::fabs(shown[c][i]) > kHalfMax) return true;
                    const double size = std::max(1.0, std::fabs(shown[c][i]));
                    const bool is_same = std::fabs(free[c][i] - shown[c][i]) <= 1e-12 * size;
                    if (sweep.color != kGray && !is_same) return true;
                }
                return false;
            };
            for (std::size_t i = 0; i < sweep.x.size(); ++i) {
                if (is_limited(i)) continue;
                for (std::size_t c = 0; c < 3; ++c) {
                    const double size = std::max(1.0, std::fabs(shown[c][i]));
                    const double error = std::fabs(again[c][i] - shown[c][i]) / size;
                    worst = std::max(worst, error);
                    if (error <= kHalfCode) continue;
                    return {name, Verdict::breaks,
                            fmt::format("the inverse of {} at {} is {}, which is shown as {}, "
                                        "not as {}",
                                        sweep.name, place(sweep.x[i]), rounded(scene[c][i], 4),
                                        rounded(again[c][i], 4), rounded(shown[c][i], 4)),
                            sweep.x[i]};
                }
            }
        }
        return {name, Verdict::holds, "round trip within " + rounded(worst, 1), {}};
    }

    Subject subject_;
    Differences measured_;
    Differences declared_;
    bool has_defaults_;  // declared differences hold for the defaults
};

}  // namespace

std::vector<double> gray_ramp() {
    std::vector<double> values;
    for (int i = -16 * 64; i <= 16 * 64; ++i)
        values.push_back(kMidGray * std::exp2(i / 64.0));
    return values;
}

Differences measured_differences(const ResolvedOperator& op) { return measured(Subject(op)); }

Differences declared_differences(const ResolvedOperator& op) {
    const std::string preset = op.preset ? op.preset->id : "";
    const std::string& look = op.params.look();
    const auto is_special = [&](const DocumentedDifference& d) {
        return !d.when.empty() && (d.when == preset || d.when == look);
    };
    Differences declared;
    for (const bool special : {false, true}) {
        for (const DocumentedDifference& d : op.op->differences) {
            if (special ? is_special(d) : d.when.empty()) declared[d.kind] = d.value;
        }
    }
    for (const Kind kind : {Kind::black, Kind::not_monotone})
        if (declared.contains(kind) && declared[kind] == 0) declared.erase(kind);
    return declared;
}

std::string to_string(LawResult::Verdict verdict) {
    switch (verdict) {
        case Verdict::holds:
            return "holds";
        case Verdict::as_declared:
            return "as declared";
        case Verdict::breaks:
            return "breaks";
        case Verdict::does_not_apply:
            break;
    }
    return "does not apply";
}

std::vector<LawResult> check_laws(const ResolvedOperator& op) { return Checker(op).run_all(); }

TONEWRIGHT_NAMESPACE_END
