// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <cmath>

#include "engine/error_metric.h"
#include "lut/clf.h"
#include "lut/numbers.h"
#include "tonewright/lut.h"

namespace tonewright {
namespace {

std::string title_of(const LutRequest& r) {
    return fmt::format("{} ({}), {} to {}", r.view.op.op->title, r.view.op.label, r.encoding.id,
                       r.view.display);
}

/// What it is, what goes in, what comes out, how exact it is.
std::vector<std::string> header_lines(const Lut& lut, const LutRequest& r, const LutError& e) {
    const Operator& op = *r.view.op.op;
    std::vector<std::string> lines;
    lines.push_back("Tonewright: " + op.title + ", " + r.view.op.label +
                    (r.view.exposure_stops != 0
                         ? ", exposure " + shortest(r.view.exposure_stops) + " stops"
                         : ""));
    lines.push_back("Source: " + op.source);
    if (lut.is_half_domain) {
        lines.push_back("Input: scene-linear " + find_input_space(r.view.input).title +
                        ", every half float (half-domain table)");
    } else {
        lines.push_back(fmt::format("Input: {}, of scene-linear {}", r.encoding.title,
                                    find_input_space(r.view.input).title));
        lines.push_back(fmt::format(
            "Input 0 is scene-linear {:.6g}, 1 is {:.6g} ({:+.2f} stops from 0.18); beyond, it "
            "clips",
            r.encoding.scene_lo, r.encoding.scene_hi, std::log2(r.encoding.scene_hi / 0.18)));
    }
    if (r.view.display == kNativeOutput) {
        lines.push_back(
            op.output == OutputKind::code_value
                ? fmt::format("Output: the operator's own code values, power {}", op.code_power)
                : "Output: the operator's own display-linear values");
    } else if (r.view.display == kLinearOutput) {
        lines.push_back("Output: display-linear Rec.709, unclamped");
    } else {
        const Display& display = find_display(r.view.display);
        lines.push_back("Output: " + display.title + " code values (" + display.source + ")");
    }
    lines.push_back(
        fmt::format("Error against the double-precision operator, {} interpolation, inside the "
                    "input range: max {}, 99.9 % {}, mean {}",
                    e.interpolation, rounded_up(e.max), rounded_up(e.p999), rounded_up(e.mean)));
    if (e.delta_e_max > 0)
        lines.push_back("Largest colour difference: dE_ITP " + rounded_up(e.delta_e_max));
    return lines;
}

std::string triplets(const Lut& lut) {
    std::string text;
    for (std::size_t i = 0; i < lut.values.size(); ++i) {
        append_number(text, lut.values[i]);
        text += (i + 1) % 3 == 0 ? '\n' : ' ';
    }
    return text;
}

std::string write_cube(const Lut& lut, const LutRequest& r, const LutError& e) {
    std::string text = "TITLE \"" + title_of(r) + "\"\n";
    for (const std::string& line : header_lines(lut, r, e))
        text += "# " + line + "\n";
    if (lut.dimension == 3) {
        text += fmt::format("LUT_3D_SIZE {}\nDOMAIN_MIN 0 0 0\nDOMAIN_MAX 1 1 1\n", lut.size);
        return text + triplets(lut);
    }
    // Only a linear table has another domain: hosts disagree about every other one.
    const std::string lo = shortest(r.encoding.is_linear ? r.encoding.scene_lo : 0);
    const std::string hi = shortest(r.encoding.is_linear ? r.encoding.scene_hi : 1);
    text += fmt::format("LUT_1D_SIZE {0}\nDOMAIN_MIN {1} {1} {1}\nDOMAIN_MAX {2} {2} {2}\n",
                        lut.size, lo, hi);
    for (const float v : lut.values) {
        std::string number;
        append_number(number, v);
        text += number + " " + number + " " + number + "\n";
    }
    return text;
}

std::string write_spi1d(const Lut& lut, const LutRequest& r) {
    // Readers take no comments before the brace.
    std::string text =
        fmt::format("Version 1\nFrom {} {}\nLength {}\nComponents 1\n{{\n",
                    shortest(r.encoding.is_linear ? r.encoding.scene_lo : 0),
                    shortest(r.encoding.is_linear ? r.encoding.scene_hi : 1), lut.size);
    for (const float v : lut.values) {
        text += "    ";
        append_number(text, v);
        text += "\n";
    }
    return text + "}\n";
}

std::string write_spi3d(const Lut& lut) {
    const auto n = static_cast<std::size_t>(lut.size);
    std::string text = fmt::format("SPILUT 1.0\n3 3\n{0} {0} {0}\n", n);
    for (std::size_t r = 0; r < n; ++r) {
        for (std::size_t g = 0; g < n; ++g) {
            for (std::size_t b = 0; b < n; ++b) {
                text += fmt::format("{} {} {}", r, g, b);
                for (std::size_t c = 0; c < 3; ++c) {
                    text += ' ';
                    append_number(text, lut.values[3 * ((b * n + g) * n + r) + c]);
                }
                text += '\n';
            }
        }
    }
    return text;
}

std::string write_clf_file(const Lut& lut, const LutRequest& r, const LutError& e) {
    const auto n = static_cast<std::size_t>(lut.size);
    std::vector<float> blue_fastest;
    if (lut.dimension == 3) {
        blue_fastest.reserve(lut.values.size());
        for (std::size_t red = 0; red < n; ++red) {
            for (std::size_t g = 0; g < n; ++g) {
                for (std::size_t b = 0; b < n; ++b) {
                    for (std::size_t c = 0; c < 3; ++c) {
                        blue_fastest.push_back(lut.values[3 * ((b * n + g) * n + red) + c]);
                    }
                }
            }
        }
    }
    ClfTable table;
    table.dimension = lut.dimension;
    table.size = lut.size;
    table.channels = lut.channels;
    table.is_half_domain = lut.is_half_domain;
    table.values = lut.dimension == 3 ? &blue_fastest : &lut.values;
    return write_clf(table, title_of(r), header_lines(lut, r, e));
}

}  // namespace

std::string write_lut(const Lut& lut, const LutRequest& request, const LutError& error) {
    switch (request.format) {
        case LutFormat::cube:
            return write_cube(lut, request, error);
        case LutFormat::clf:
            return write_clf_file(lut, request, error);
        case LutFormat::spi1d:
            return write_spi1d(lut, request);
        case LutFormat::spi3d:
            return write_spi3d(lut);
    }
    return {};
}

}  // namespace tonewright
