// SPDX-License-Identifier: Apache-2.0
#include "lut/clf.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "base/format_number.h"
#include "base/strings.h"
#include "tonewright/pipeline.h"

TONEWRIGHT_NAMESPACE_BEGIN

namespace {
bool is_ctf(const ClfTable& table) { return table.is_ctf || table.is_hue_preserving; }
}  // namespace

const char* file_extension(const ClfTable& table) { return is_ctf(table) ? ".ctf" : ".clf"; }

double precision_of(double value) {
    const double size = std::fabs(value);
    if (size > kHalfMax) return 5e-4 * size;
    if (size >= 0.1) return 7.5e-9 * std::max(1.0, size);
    constexpr double kNothing = 5e-15;  // less than what doubles near 1 have for rounding
    const double sixth_digit = std::pow(10.0, std::floor(std::log10(size + 1e-300)) - 5);
    return std::clamp(sixth_digit / 2, kNothing, 5e-9);
}

namespace {

/// Appends an entry of a compact table, times a power of two.
void append_entry(std::string& text, const ClfTable& table, std::size_t i, double gain) {
    const auto value = static_cast<double>(table.values[i]);
    const signed char slack = table.slack.empty() ? static_cast<signed char>(0) : table.slack[i];
    constexpr double kLargestShort = 1e37;  // twice as much may be no float
    constexpr double kNothing = 1e-14;      // the rounding of doubles near 1
    if (slack != 0 && std::fabs(value) < kNothing) {
        text += '0';
    } else if (slack != 0 && std::fabs(value) < kLargestShort) {
        append_one_digit(text, value * gain, slack > 0);
    } else {
        append_near(text, value * gain,
                    std::max(precision_of(value), table.least_precision) * gain);
    }
}

/// The power of two with the shortest numbers for a channel. Limited to the range of half floats,
/// because OpenColorIO inverts a table with a half-float table.
double shortest_gain(const ClfTable& table, std::size_t channel) {
    const auto stride = static_cast<std::size_t>(table.channels);
    double largest = 0;
    for (std::size_t i = channel; i < table.values.size(); i += stride)
        largest = std::max(largest, std::fabs(static_cast<double>(table.values[i])));
    double best = 1;
    std::size_t least = 0;
    for (double gain = 1; gain <= 32768 && (gain == 1 || gain * largest <= 32768); gain *= 2) {
        std::string text;
        constexpr std::size_t kOneOf = 29;
        for (std::size_t i = channel; i < table.values.size(); i += kOneOf * stride)
            append_entry(text, table, i, gain);
        if (least == 0 || text.size() < least) {
            least = text.size();
            best = gain;
        }
    }
    return best;
}

}  // namespace

std::string write_clf(const ClfTable& table, const std::string& name,
                      const std::vector<std::string>& description) {
    // `id` must be unique to the contents; so use the hash of the numbers.
    std::string numbers;
    const std::span<const float> v = table.values;
    const auto per_line = static_cast<std::size_t>(table.dimension == 3 ? 3 : table.channels);
    std::vector<double> gains(per_line, 1);
    if (table.numbers == ClfTable::Numbers::compact) {
        for (std::size_t c = 0; c < per_line; ++c)
            gains[c] = shortest_gain(table, c);
    }
    if (table.numbers == ClfTable::Numbers::multiples) gains.assign(per_line, 1 / table.unit);
    for (std::size_t i = 0; i < v.size(); ++i) {
        const std::size_t begin = numbers.size();
        switch (table.numbers) {
            case ClfTable::Numbers::exact:
                append_number(numbers, v[i]);
                break;
            case ClfTable::Numbers::compact:
                append_entry(numbers, table, i, gains[i % per_line]);
                break;
            case ClfTable::Numbers::codes:
                append_decimals(numbers, v[i] * 65535, 0);
                break;
            case ClfTable::Numbers::decimals_7:
                append_decimals(numbers, v[i], 7);
                drop_zero_before_point(numbers, begin);
                break;
            case ClfTable::Numbers::multiples:
                append_near(numbers, static_cast<double>(v[i]) / table.unit, 0.5);
                break;
        }
        numbers += (i + 1) % per_line == 0 ? '\n' : ' ';
    }
    const char* depth = table.numbers == ClfTable::Numbers::codes ? "16i" : "32f";
    std::string text = "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n";
    // A file states the version of only one format.
    text +=
        fmt::format("<ProcessList id=\"tonewright-{}\" name=\"{}\" {}>\n", content_hash(numbers),
                    xml_escape(name), is_ctf(table) ? "version=\"1.4\"" : "compCLFversion=\"3\"");
    for (const std::string& line : description) {
        text += "    <Description>" + xml_escape(line) + "</Description>\n";
    }
    for (const auto& [name_of_element, value] :
         {std::pair("InputDescriptor", &table.input_descriptor),
          std::pair("OutputDescriptor", &table.output_descriptor)}) {
        if (!value->empty())
            text += fmt::format("    <{0}>{1}</{0}>\n", name_of_element, xml_escape(*value));
    }
    if (table.dimension == 1) {
        text += fmt::format(
            "    <LUT1D inBitDepth=\"32f\" outBitDepth=\"{}\"{}{} interpolation=\"linear\">\n"
            "        <Array dim=\"{} {}\">\n",
            depth, table.is_half_domain ? " halfDomain=\"true\"" : "",
            table.is_hue_preserving ? " hueAdjust=\"dw3\"" : "", table.size, table.channels);
    } else {
        text += fmt::format(
            "    <LUT3D inBitDepth=\"32f\" outBitDepth=\"{1}\" interpolation=\"tetrahedral\">\n"
            "        <Array dim=\"{0} {0} {0} 3\">\n",
            table.size, depth);
    }
    text += numbers;
    text += fmt::format("        </Array>\n    </LUT{}D>\n", table.dimension);
    if (std::any_of(gains.begin(), gains.end(), [](double gain) { return gain != 1; })) {
        const auto back = [&](std::size_t c) { return shortest(1 / gains[per_line == 1 ? 0 : c]); };
        text += fmt::format(
            "    <Matrix inBitDepth=\"32f\" outBitDepth=\"32f\">\n"
            "        <Array dim=\"3 3\">\n{} 0 0\n0 {} 0\n0 0 {}\n        </Array>\n    "
            "</Matrix>\n",
            back(0), back(1), back(2));
    }
    return text + "</ProcessList>\n";
}

TONEWRIGHT_NAMESPACE_END
