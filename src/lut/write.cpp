// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

#include "base/format_number.h"
#include "base/ktx2.h"
#include "base/little_endian.h"
#include "base/strings.h"
#include "lut/clf.h"
#include "lut/header.h"
#include "lut/icc.h"
#include "lut/shaper.h"
#include "tonewright/lut.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

using Lines = std::vector<std::string>;

void append_value(std::string& text, const Lut& lut, float value) {
    if (lut.decimals) {
        append_decimals(text, value, *lut.decimals);
    } else {
        append_number(text, value);
    }
}

std::string triplets(const Lut& lut) {
    std::string text;
    for (std::size_t i = 0; i < lut.values.size(); ++i) {
        append_value(text, lut, lut.values[i]);
        text += (i + 1) % 3 == 0 ? '\n' : ' ';
    }
    return text;
}

std::string write_cube(const Lut& lut, const LutRequest& r, const Lines& header) {
    std::string text = "TITLE \"" + lut_title(r) + "\"\n";
    for (const std::string& line : header)
        text += "# " + line + "\n";
    if (lut.dimension == 3) {
        text += fmt::format("LUT_3D_SIZE {}\nDOMAIN_MIN 0 0 0\nDOMAIN_MAX 1 1 1\n", lut.size);
        return text + triplets(lut);
    }
    // Only a linear table has another domain, because applications disagree about all others.
    const std::string lo = shortest(r.encoding.is_linear ? r.encoding.scene_lo : 0);
    const std::string hi = shortest(r.encoding.is_linear ? r.encoding.scene_hi : 1);
    text += fmt::format("LUT_1D_SIZE {0}\nDOMAIN_MIN {1} {1} {1}\nDOMAIN_MAX {2} {2} {2}\n",
                        lut.size, lo, hi);
    for (const float v : lut.values) {
        std::string number;
        append_value(number, lut, v);
        text += fmt::format("{0} {0} {0}\n", number);
    }
    return text;
}

std::string write_spi1d(const Lut& lut, const LutRequest& r) {
    // Readers accept no comments before the brace.
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

/// The nodes of a 3D LUT in the order of CLF and 3dl.
std::vector<float> blue_fastest(const Lut& lut) {
    const auto n = static_cast<std::size_t>(lut.size);
    std::vector<float> values;
    values.reserve(lut.values.size());
    for (std::size_t r = 0; r < n; ++r) {
        for (std::size_t g = 0; g < n; ++g) {
            for (std::size_t b = 0; b < n; ++b) {
                const float* node = &lut.values[3 * ((b * n + g) * n + r)];
                values.insert(values.end(), node, node + 3);
            }
        }
    }
    return values;
}

/// cineSpace: a prelut from scene-linear to the encoding, then the 3D LUT. Readers resample preluts
/// of few points at equal scene-linear distances, so this one has 4096 points at equal distances in
/// the code.
std::string write_csp(const Lut& lut, const LutRequest& r, const Lines& header) {
    std::string text = "CSPLUTV100\n3D\n\nBEGIN METADATA\n" + lut_title(r) + "\n";
    for (const std::string& line : header)
        text += line + "\n";
    text += "END METADATA\n\n";
    constexpr int kPoints = 4096;
    std::string from;
    std::string to;
    for (int i = 0; i < kPoints; ++i) {
        const double code = i / (kPoints - 1.0);
        append_number(from, static_cast<float>(evaluate(r.encoding.decode, code)));
        append_number(to, static_cast<float>(code));
        from += i + 1 < kPoints ? ' ' : '\n';
        to += i + 1 < kPoints ? ' ' : '\n';
    }
    for (int c = 0; c < 3; ++c)
        text += fmt::format("{}\n{}{}", kPoints, from, to);
    text += fmt::format("\n{0} {0} {0}\n", lut.size);
    return text + triplets(lut);
}

/// DaVinci Resolve: equal scene-linear steps, encoded, then the 3D LUT.
/// OpenColorIO reads it, but only without a TITLE.
std::string write_resolve_cube(const Lut& lut, const LutRequest& r, const Lines& header) {
    std::string text;
    for (const std::string& line : header)
        text += "# " + line + "\n";
    const double lo = r.encoding.scene_lo;
    const double hi = r.encoding.scene_hi;
    text += fmt::format(
        "LUT_1D_SIZE {}\nLUT_1D_INPUT_RANGE {:.9f} {:.9f}\nLUT_3D_SIZE {}\nLUT_3D_INPUT_RANGE 0 "
        "1\n",
        kShaperSteps, lo, hi, lut.size);
    for (const float code : shaper_table(r.encoding)) {
        std::string number;
        append_number(number, code);
        text += fmt::format("{0} {0} {0}\n", number);
    }
    return text + triplets(lut);
}

/// Houdini, version 2: a 3D LUT, red fastest.
std::string write_houdini(const Lut& lut) {
    return fmt::format(
               "Version\t\t2\nFormat\t\tany\nType\t\t3D\nFrom\t\t0 1\nTo\t\t0 1\n"
               "Black\t\t0\nWhite\t\t1\nLength\t\t{}\nLUT:\n {{\n",
               lut.size) +
           triplets(lut) + " }\n";
}

/// Autodesk Flame and Lustre: 10-bit input, blue fastest.
std::string write_3dl(const Lut& lut, const LutRequest& r) {
    const auto n = static_cast<std::size_t>(lut.size);
    const int bits = r.bits.value_or(12);
    const double largest = std::exp2(bits) - 1;
    const int mesh = static_cast<int>(std::lround(std::log2(n - 1)));
    std::string text = fmt::format("3DMESH\nMesh {} {}\n", mesh, bits);
    for (std::size_t i = 0; i < n; ++i)
        text +=
            fmt::format("{}{}", i ? " " : "",
                        std::lround(1023.0 * static_cast<double>(i) / static_cast<double>(n - 1)));
    text += '\n';
    const std::vector<float> nodes = blue_fastest(lut);
    for (std::size_t i = 0; i < nodes.size(); ++i) {
        const double v = std::clamp(static_cast<double>(nodes[i]), 0.0, 1.0);
        text += fmt::format("{}{}", std::lround(v * largest), (i + 1) % 3 == 0 ? '\n' : ' ');
    }
    return text + "\nLUT8\ngamma 1.0\n";
}

/// RGBA in 32-bit floats, red along x.
std::string write_ktx2(const Lut& lut, const Lines& header) {
    std::vector<float> rgba;
    rgba.reserve(lut.values.size() / 3 * 4);
    for (std::size_t i = 0; i < lut.values.size(); ++i) {
        rgba.push_back(lut.values[i]);
        if (i % 3 == 2) rgba.push_back(1);
    }
    return ktx2_file(rgba, {lut.size, lut.size, lut.size}, Ktx2Texel::single,
                     fmt::format("{}", fmt::join(header, "\n")));
}

std::string write_raw(const Lut& lut) { return little_endian_bytes(lut.values); }

/// Text after the word in the first line that begins with it.
std::string described(const Lines& header, std::string_view word) {
    for (const std::string& line : header) {
        if (line.starts_with(word)) return line.substr(word.size());
    }
    return {};
}

std::string write_clf_file(const Lut& lut, const LutRequest& r, const Lines& header) {
    const std::vector<float> nodes = lut.dimension == 3 ? blue_fastest(lut) : lut.values;
    ClfTable table;
    table.dimension = lut.dimension;
    table.size = lut.size;
    table.channels = lut.channels;
    table.is_half_domain = lut.is_half_domain;
    table.values = nodes;
    table.is_ctf = r.format == LutFormat::ctf;
    table.input_descriptor = described(header, "Input: ");
    table.output_descriptor = described(header, "Output: ");
    return write_clf(table, lut_title(r), header);
}

}  // namespace

std::string write_lut(const Lut& lut, const LutRequest& request, const LutError& error,
                      const std::optional<LutError>& other_error,
                      const std::optional<LutRinging>& ringing) {
    const auto header = [&] { return lut_header(lut, request, error, other_error, ringing); };
    switch (request.format) {
        case LutFormat::cube:
            return write_cube(lut, request, header());
        case LutFormat::clf:
        case LutFormat::ctf:
            return write_clf_file(lut, request, header());
        case LutFormat::spi1d:
            return write_spi1d(lut, request);
        case LutFormat::spi3d:
            return write_spi3d(lut);
        case LutFormat::csp:
            return write_csp(lut, request, header());
        case LutFormat::resolve_cube:
            return write_resolve_cube(lut, request, header());
        case LutFormat::threedl:
            return write_3dl(lut, request);
        case LutFormat::houdini:
            return write_houdini(lut);
        case LutFormat::icc:
            return write_icc(blue_fastest(lut), lut.size, request.icc_version, lut_title(request),
                             header());
        case LutFormat::raw:
            return write_raw(lut);
        case LutFormat::ktx2:
            return write_ktx2(lut, header());
        case LutFormat::hald:
        case LutFormat::strip:
        case LutFormat::strip_up:
            break;
    }
    return {};
}

std::string write_lut(const BakedLut& baked, const LutRequest& request) {
    std::optional<LutRinging> ringing;
    if (baked.lut.dimension == 3) ringing = baked.ringing;
    return write_lut(baked.lut, request, baked.error, baked.other_error, ringing);
}

TONEWRIGHT_NAMESPACE_END
