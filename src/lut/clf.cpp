// SPDX-License-Identifier: Apache-2.0
#include "lut/clf.h"

#include <fmt/format.h>

#include "base/format_number.h"
#include "base/strings.h"

TONEWRIGHT_NAMESPACE_BEGIN

namespace {
bool is_ctf(const ClfTable& table) { return table.is_ctf || table.is_hue_preserving; }
}  // namespace

const char* file_extension(const ClfTable& table) { return is_ctf(table) ? ".ctf" : ".clf"; }

std::string write_clf(const ClfTable& table, const std::string& name,
                      const std::vector<std::string>& description) {
    // `id` must be unique to the contents; the hash of the numbers is.
    std::string numbers;
    const std::span<const float> v = table.values;
    const auto per_line = static_cast<std::size_t>(table.dimension == 3 ? 3 : table.channels);
    for (std::size_t i = 0; i < v.size(); ++i) {
        const std::size_t begin = numbers.size();
        switch (table.numbers) {
            case ClfTable::Numbers::exact:
                append_number(numbers, v[i]);
                break;
            case ClfTable::Numbers::compact:
                append_compact(numbers, v[i]);
                break;
            case ClfTable::Numbers::codes:
                append_decimals(numbers, v[i] * 65535, 0);
                break;
            case ClfTable::Numbers::decimals_7:
                append_decimals(numbers, v[i], 7);
                break;
        }
        if (table.numbers != ClfTable::Numbers::exact) drop_zero_before_point(numbers, begin);
        numbers += (i + 1) % per_line == 0 ? '\n' : ' ';
    }
    const char* depth = table.numbers == ClfTable::Numbers::codes ? "16i" : "32f";
    std::string text = "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n";
    // A file has the version of one format only.
    text +=
        fmt::format("<ProcessList id=\"tonewright-{}\" name=\"{}\" {}>\n", content_hash(numbers),
                    xml_escape(name), is_ctf(table) ? "version=\"1.4\"" : "compCLFversion=\"3\"");
    for (const std::string& line : description) {
        text += "    <Description>" + xml_escape(line) + "</Description>\n";
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
    text += fmt::format("        </Array>\n    </LUT{}D>\n</ProcessList>\n", table.dimension);
    return text;
}

TONEWRIGHT_NAMESPACE_END
