// SPDX-License-Identifier: Apache-2.0
#include <array>
#include <charconv>
#include <cmath>

#include "base/format_number.h"
#include "base/strings.h"
#include "tonewright/input_encoding.h"
#include "tonewright/view.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

/// An encoding without parameters, and its primaries.
struct FixedEncoding {
    const char* id;
    const char* title;
    Expr (*encode)(const Expr&);
    Expr (*decode)(const Expr&);
    const char* input;
    int grid_size = 0;
};

// Blender 5.2, config.ocio, AgX: log2 of light over 0.18, in E-Gamut, then 57 nodes a side.
constexpr double kAgxDarkest = -10;
constexpr double kAgxStops = 25;
constexpr int kAgxGrid = 57;
const double kAgxLowest = std::log2(0.18) + kAgxDarkest;

Expr agx_log_encode(const Expr& x) {
    return (log2(max(x, std::exp2(kAgxLowest))) - kAgxLowest) / kAgxStops;
}
Expr agx_log_decode(const Expr& code) { return exp2(code * kAgxStops + kAgxLowest); }

Expr reinhard_encode(const Expr& x) { return max(x, 0) / (max(x, 0) + 1); }
/// Code 1 is the largest value.
Expr reinhard_decode(const Expr& code) { return code / max(1 - code, 1 / kHalfMax); }

constexpr std::array<FixedEncoding, 10> kFixedEncodings = {{
    {"acescct", "ACEScct (Academy S-2016-001: AP1 primaries, log with a linear toe)",
     acescct_encode, acescct_decode, "lin_ap1"},
    {"logc3", "ARRI LogC3 (EI 800)", arri_logc3_encode, arri_logc3_decode, "lin_awg3"},
    {"logc4", "ARRI LogC4", arri_logc4_encode, arri_logc4_decode, "lin_awg4"},
    {"slog3", "Sony S-Log3", sony_slog3_encode, sony_slog3_decode, "lin_sgamut3"},
    {"davinci", "DaVinci Intermediate", davinci_intermediate_encode, davinci_intermediate_decode,
     "lin_davinci_wg"},
    {"unity_logc", "Unity LogC (ALEXA's of EI 1000)", unity_logc_encode, unity_logc_decode,
     "lin_rec709"},
    {"unreal_log", "Unreal Engine's log (14 stops, 0.18 at 444/1023)", unreal_log_encode,
     unreal_log_decode, "lin_rec709"},
    {"srgb", "sRGB (IEC 61966-2-1): a display's own range, nothing above white", srgb_encode,
     srgb_decode, "lin_rec709"},
    {"reinhard", "x/(x + 1) of scene-linear x (Tony McMapface)", reinhard_encode, reinhard_decode,
     "lin_rec709"},
    {"agx_log", "log2(x / 0.18) from -10 to 15 stops, the grid of Blender's AgX", agx_log_encode,
     agx_log_decode, "lin_egamut", kAgxGrid},
}};

constexpr std::array kEncodingsWithNumbers = {"pq", "hlg", "log2", "linear"};

bool parse_number(std::string_view s, double& value) {
    const auto r = std::from_chars(s.data(), s.data() + s.size(), value);
    return r.ec == std::errc() && r.ptr == s.data() + s.size() && std::isfinite(value);
}

constexpr double kPqPeak = 10000;  // SMPTE ST 2084
constexpr double kHlgPeak = 1000;  // ITU-R BT.2100-2, the display with a system gamma of 1.2

[[noreturn]] void refuse(std::string_view text, const std::string& expected,
                         const std::string& suggestion = {}) {
    throw Error({.parameter = "input_encoding",
                 .value = std::string(text),
                 .expected = expected,
                 .suggestion = suggestion});
}

/// "name", or "name:WHITE".
double parse_white(std::string_view text, std::string_view name, double peak) {
    const std::size_t colon = text.find(':');
    if (colon == std::string_view::npos) return kUnitLuminance;
    double white = 0;
    if (!parse_number(text.substr(colon + 1), white) || !(white > 0) || white > peak) {
        refuse(text, std::string(name) + ":WHITE, the cd/m2 of scene-linear 1.0 in (0, " +
                         shortest(peak) + "]");
    }
    return white;
}

struct Range {
    double lo;
    double hi;
};

/// "name", or "name:LO:HI".
Range parse_range(std::string_view text, std::string_view name, Range fallback) {
    const std::size_t begin = text.find(':');
    if (begin == std::string_view::npos) return fallback;
    const std::string_view rest = text.substr(begin + 1);
    const std::size_t colon = rest.find(':');
    Range range{};
    if (colon == std::string_view::npos || !parse_number(rest.substr(0, colon), range.lo) ||
        !parse_number(rest.substr(colon + 1), range.hi) || !(range.lo < range.hi)) {
        refuse(text, std::string(name) + ":LO:HI with numbers LO < HI");
    }
    return range;
}

}  // namespace

std::vector<std::string> input_encoding_names() {
    std::vector<std::string> names;
    names.reserve(std::size(kFixedEncodings) + std::size(kEncodingsWithNumbers));
    for (const FixedEncoding& fixed : kFixedEncodings)
        names.emplace_back(fixed.id);
    for (const char* name : kEncodingsWithNumbers)
        names.emplace_back(name);
    return names;
}

InputEncoding parse_input_encoding(std::string_view text) {
    const Expr x = Expr::input();
    const std::string name = folded_name(text.substr(0, text.find(':')));
    InputEncoding e;
    for (const FixedEncoding& fixed : kFixedEncodings) {
        if (!is_same_name(text, fixed.id)) continue;
        e.id = fixed.id;
        e.title = fixed.title;
        e.encode = fixed.encode(x);
        e.decode = fixed.decode(x);
        e.default_input = fixed.input;
        e.grid_size = fixed.grid_size;
        e.scene_lo = evaluate(e.decode, 0.0);
        e.scene_hi = evaluate(e.decode, 1.0);
        return e;
    }
    if (name == "pq") {
        const double white = parse_white(text, name, kPqPeak);
        e.id = "pq:" + shortest(white);
        e.title = "PQ (SMPTE ST 2084), scene-linear 1 at " + shortest(white) + " cd/m2";
        e.encode = pq_encode_nits(x * white);
        e.decode = pq_decode_nits(x) / white;
        e.default_input = "lin_rec2020";
        e.scene_lo = 0;
        e.scene_hi = kPqPeak / white;
        return e;
    }
    if (name == "hlg") {
        const double white = parse_white(text, name, kHlgPeak);
        // Gray, for which the OOTF of the display is a power of this channel.
        const double gray = evaluate(hlg_inverse_ootf_luminance(x), white / kHlgPeak);
        e.id = "hlg:" + shortest(white);
        e.title = "HLG (ITU-R BT.2100) scene light, scene-linear 1 at " + shortest(white) +
                  " cd/m2 on a display of " + shortest(kHlgPeak);
        e.encode = hlg_oetf(x * gray);
        e.decode = hlg_inverse_oetf(x) / gray;
        e.default_input = "lin_rec2020";
        e.scene_lo = 0;
        e.scene_hi = 1 / gray;
        return e;
    }
    if (name == "log2") {
        const Range stops = parse_range(text, name, {-10, 6.5});
        if (stops.lo < -64 || stops.hi > 64) {
            refuse(text, "[-64, 64] stops");
        }
        const double lowest = std::log2(0.18) + stops.lo;
        const double span = stops.hi - stops.lo;
        e.id = "log2:" + shortest(stops.lo) + ":" + shortest(stops.hi);
        e.scene_lo = std::exp2(lowest);
        e.scene_hi = std::exp2(lowest + span);
        e.encode = (log2(max(x, e.scene_lo)) - lowest) / span;
        e.decode = exp2(x * span + lowest);
        e.title =
            "log2(x / 0.18) from " + shortest(stops.lo) + " to " + shortest(stops.hi) + " stops";
        return e;
    }
    if (name == "linear") {
        const Range range = parse_range(text, name, {0, 1});
        e.id = "linear:" + shortest(range.lo) + ":" + shortest(range.hi);
        e.scene_lo = range.lo;
        e.scene_hi = range.hi;
        e.encode = (x - range.lo) / (range.hi - range.lo);
        e.decode = x * (range.hi - range.lo) + range.lo;
        e.title = "scene-linear from " + shortest(range.lo) + " to " + shortest(range.hi);
        e.is_linear = true;
        return e;
    }
    std::vector<NamedChoice> choices;
    choices.reserve(std::size(kFixedEncodings) + std::size(kEncodingsWithNumbers));
    for (const FixedEncoding& fixed : kFixedEncodings)
        choices.push_back({fixed.id, {fixed.title}});
    for (const char* other : kEncodingsWithNumbers)
        choices.push_back({other});
    refuse(text, join_choices(input_encoding_names()), suggested_names(name, choices));
}

TONEWRIGHT_NAMESPACE_END
