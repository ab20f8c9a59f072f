// SPDX-License-Identifier: Apache-2.0
#include "lut/header.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/format_number.h"
#include "base/little_endian.h"
#include "base/strings.h"
#include "lut/shaper.h"

TONEWRIGHT_NAMESPACE_BEGIN

namespace {

/// Two digits, rounded up: "0.05", "6.2", "41", "260".
std::string two_digits_up(double value) { return rounded(round_up(value, 2), 3); }

/// Hash of the numbers, not of the file.
std::string hash_of(const Lut& lut) { return content_hash(little_endian_bytes(lut.values)); }

}  // namespace

std::string to_string(const PhotographError& error) {
    constexpr double kCodes = 255;
    // Code values without a limit differ by more than all codes of a display.
    const auto codes = [&](double value) {
        if (value > 1) return std::string("more than 255");
        return rounded(std::min(round_up(kCodes * value, 2), kCodes), 3);
    };
    std::string text = error.p999 > 1
                           ? "0.1 % more than 255 codes of 255 off"
                           : fmt::format("99.9 % within {} codes of 255", codes(error.p999));
    text += ", mean " + codes(error.mean);
    const auto percent = [](double share) {
        return 100 * share < 0.01 ? "less than 0.01" : two_digits_up(100 * share);
    };
    text += error.share > 0 ? fmt::format(", {} % of the pixels more than one off, most at {}",
                                          percent(error.share), error.worst)
                            : ", no pixel more than one off";
    if (error.outside > 0)
        text += fmt::format("; {} % are brighter or more saturated than the input holds",
                            percent(error.outside));
    return text;
}

std::string lut_title(const LutRequest& r) {
    return fmt::format("{} ({}), {} to {}", r.view.op.op->title, r.view.op.label, r.encoding.id,
                       r.view.display);
}

std::vector<std::string> operator_lines(const View& view) {
    const Operator& op = *view.op.op;
    std::string first = "Tonewright: " + op.title + ", " + view.op.label;
    if (view.exposure_stops != 0) first += ", exposure " + shortest(view.exposure_stops) + " stops";
    return {first, "Source: " + op.source};
}

std::string output_line(const View& view) {
    // The operator's own code values may equal those of a display.
    const std::string display = view.display == kNativeOutput && !view.op.output_display().empty()
                                    ? view.op.output_display()
                                    : view.display;
    if (display == kNativeOutput) {
        return view.op.output() == OutputKind::code_value
                   ? fmt::format("Output: the operator's own code values, power {}",
                                 view.op.op->code_power)
                   : "Output: the operator's own display-linear values";
    }
    if (display == kLinearOutput) return "Output: display-linear Rec.709, unclamped";
    const Display& shown = find_display(display);
    return "Output: " + shown.title + " code values (" + shown.source + ")";
}

std::string photograph_line(const LutError& e) {
    return fmt::format("On photographs and renders, {} interpolation: {}", e.interpolation,
                       to_string(e.photographs));
}

std::vector<std::string> error_lines(const LutError& e) {
    std::vector<std::string> lines = {fmt::format(
        "Error against the double-precision operator, {} interpolation, inside the "
        "input range: max {}, 99.9 % {}, mean {}",
        e.interpolation, rounded_up(e.max, 3), rounded_up(e.p999, 3), rounded_up(e.mean, 3))};
    if (e.delta_e_max > 0) {
        lines.push_back(fmt::format(
            "Color difference dE_ITP (ITU-R BT.2124), {} interpolation: max {}, 99.9 % {}, mean {}",
            e.interpolation, rounded_up(e.delta_e_max, 3), rounded_up(e.delta_e_p999, 3),
            rounded_up(e.delta_e_mean, 3)));
    }
    return lines;
}

std::vector<std::string> lut_header(const Lut& lut, const LutRequest& r, const LutError& e,
                                    const std::optional<LutError>& other,
                                    const std::optional<LutRinging>& ringing) {
    std::vector<std::string> lines = operator_lines(r.view);
    if (has_shaper(r.format)) {
        lines.push_back(fmt::format(
            "Input: scene-linear {}, {:.6g} to {:.6g} ({:+.2f} stops from 0.18); the 1D LUT before "
            "the 3D LUT encodes it as {}",
            find_input_space(r.view.input).title, r.encoding.scene_lo, r.encoding.scene_hi,
            std::log2(r.encoding.scene_hi / 0.18), r.encoding.title));
    } else if (lut.is_half_domain) {
        lines.push_back("Input: scene-linear " + find_input_space(r.view.input).title +
                        ", every half float (half-domain table)");
    } else {
        lines.push_back(fmt::format("Input: {}, of scene-linear {}", r.encoding.title,
                                    find_input_space(r.view.input).title));
        lines.push_back(fmt::format(
            "Input 0 is scene-linear {:.6g}, 1 is {:.6g} ({:+.2f} stops from 0.18)",
            r.encoding.scene_lo, r.encoding.scene_hi, std::log2(r.encoding.scene_hi / 0.18)));
    }
    if (!lut.is_half_domain) {
        const std::string clipped = to_string(measure_clipping(r, lut));
        lines.push_back(clipped.empty() ? "Clips nothing visible (within one 10-bit code value)"
                                        : "Clips visible values " + clipped);
    }
    lines.push_back(output_line(r.view));
    lines.push_back(photograph_line(e));
    const auto add = [&](const std::vector<std::string>& more) {
        lines.insert(lines.end(), more.begin(), more.end());
    };
    add(error_lines(e));
    if (other) add(error_lines(*other));
    lines.emplace_back(
        lut.dimension == 3
            ? "The maximum is of all colors of the input range; 99.9 % and mean are of the "
              "samples: grays, grids of Rec.709, Rec.2020 and AP1 at five exposures, random colors"
            : "All three are of the samples: grays, grids of Rec.709, Rec.2020 and AP1 at five "
              "exposures, random colors");
    if (ringing) {
        lines.push_back(fmt::format(
            "{}, {} interpolation, along rising exposure of the test chart's lamps and hues: {}; "
            "99.9 % of the errors up to {}",
            rings(*ringing) ? "RINGS" : "Does not ring", e.interpolation, to_string(*ringing),
            rounded_up(ringing->p999, 3)));
    }
    lines.push_back(fmt::format("{}, size {}, numbers {}", lut.dimension == 3 ? "3D LUT" : "1D LUT",
                                lut.size, hash_of(lut)));
    return lines;
}

TONEWRIGHT_NAMESPACE_END
