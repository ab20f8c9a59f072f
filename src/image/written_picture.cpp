// SPDX-License-Identifier: Apache-2.0
#include "image/written_picture.h"

#include <OpenImageIO/imagebuf.h>
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <fstream>
#include <numeric>
#include <string_view>

#include "image/picture_file.h"
#include "picture/format_limits.h"
#include "picture/read_back.h"
#include "tonewright/error.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

using OIIO::ImageBuf;
using OIIO::ImageSpec;

/// Only heif files need this check, because the name does not state the codec. ISO/IEC 14496-12,
/// 4.3: the brand of a file is in its box `ftyp`.
std::string brand_of(const std::string& path) {
    std::ifstream file(path, std::ios::binary);
    std::array<char, 12> start{};
    file.read(start.data(), start.size());
    return {start.data() + 8, 4};
}

/// A reason of a temporary file, whose name says nothing to a user.
std::string without_name(const std::string& text, const std::string& name) {
    const std::string begin = name + ": ";
    return text.starts_with(begin) ? text.substr(begin.size()) : text;
}

std::string fault_of_size(const WrittenFile& written, const ImageSpec& is) {
    const PictureSpec& requested = written.spec;
    if (is.width != requested.width || is.height != requested.height) {
        return reads_back_with("size", fmt::format("{} x {}", is.width, is.height),
                               fmt::format("{} x {}", requested.width, requested.height));
    }
    // The reader of GIF adds alpha, and that of FITS has only signed integers.
    const bool adds_alpha = written.format == "gif" && is.nchannels == requested.nchannels + 1;
    const bool drops_alpha = written.format == "webp" && is.nchannels == requested.nchannels - 1;
    if (is.nchannels != requested.nchannels && !adds_alpha && !drops_alpha)
        return reads_back_with("channels", is.nchannels, requested.nchannels);
    if (is.format != requested.format && written.format != "fits")
        return reads_back_with("type", is.format.c_str(), name_of(requested.format));
    if (format_limits(written.format).windows != FileWindows::none &&
        (is.x != requested.x || is.y != requested.y || is.full_width != requested.full_width ||
         is.full_height != requested.full_height)) {
        return reads_back_with(
            "window",
            fmt::format("{}+{}+{} of {} x {}", is.width, is.x, is.y, is.full_width, is.full_height),
            fmt::format("{}+{}+{} of {} x {}", requested.width, requested.x, requested.y,
                        requested.full_width, requested.full_height));
    }
    return "";
}

/// The file keeps every code value.
bool is_lossless(const WrittenFile& written) {
    const std::string compression = written.spec.get_string_attribute("compression");
    constexpr std::array<std::string_view, 7> kLossless = {"none", "rle", "zip",     "zips",
                                                           "piz",  "lzw", "packbits"};
    const bool is_lossless_exr =
        compression.empty() ||
        std::find(kLossless.begin(), kLossless.end(), compression) != kLossless.end();
    constexpr std::array<std::string_view, 9> kExact = {"png", "targa", "bmp", "sgi", "dpx",
                                                        "pnm", "rla",   "ico", "iff"};
    return std::find(kExact.begin(), kExact.end(), written.format) != kExact.end() ||
           (is_lossless_exr && (written.format == "openexr" || written.format == "tiff"));
}

/// @returns  the difference from what was to be written; empty if there is none
std::string fault_of_pixels(const WrittenFile& written, const ImageBuf& is) {
    const PictureSpec& requested = written.spec;
    const std::vector<float>& kept = *written.pixels;
    const bool is_exact = is_lossless(written);
    const OIIO::TypeDesc type = requested.format;
    const bool is_integer = !type.is_floating_point();
    // One code value: half for rounding, half for dither.
    const int bits = written.bits > 0 ? written.bits : static_cast<int>(8 * type.size());
    const double step = 1.001 / (std::exp2(bits) - 1);
    const int channels = std::min(is.nchannels(), requested.nchannels);
    double worst = 0;
    // Compression changes pixels, but hardly the sums of blocks.
    constexpr int kBlock = 8;
    const int columns = (requested.width + kBlock - 1) / kBlock;
    const int block_rows = (requested.height + kBlock - 1) / kBlock;
    std::vector<double> sums(static_cast<std::size_t>(columns) *
                             static_cast<std::size_t>(block_rows) *
                             static_cast<std::size_t>(channels));
    for (ImageBuf::ConstIterator<float> p(is); !p.done(); ++p) {
        const std::size_t at = (static_cast<std::size_t>(p.y() - requested.y) *
                                    static_cast<std::size_t>(requested.width) +
                                static_cast<std::size_t>(p.x() - requested.x)) *
                               static_cast<std::size_t>(requested.nchannels);
        for (int c = 0; c < channels; ++c) {
            auto should = static_cast<double>(kept[at + static_cast<std::size_t>(c)]);
            if (is_integer || !is_exact) should = std::clamp(should, 0.0, 1.0);
            const double found = is_exact ? static_cast<double>(p[c])
                                          : std::clamp(static_cast<double>(p[c]), 0.0, 1.0);
            const double allowed = is_integer                     ? step
                                   : type == OIIO::TypeDesc::HALF ? std::fabs(should) / 1024 + 1e-7
                                                                  : std::fabs(should) * 1e-6;
            const double difference = std::fabs(found - should);
            worst = std::max(worst, difference > allowed || std::isnan(difference)
                                        ? std::max(difference, 1e-9)
                                        : 0);
            const int block =
                (p.y() - requested.y) / kBlock * columns + (p.x() - requested.x) / kBlock;
            sums[static_cast<std::size_t>(block) * static_cast<std::size_t>(channels) +
                 static_cast<std::size_t>(c)] += found - should;
        }
    }
    // The most that compression of the lowest quality loses. Channels in another order, rows at
    // another place and black pictures lose more.
    constexpr double kLossyMean = 0.1;
    const double sum = std::accumulate(sums.begin(), sums.end(), 0.0,
                                       [](double all, double x) { return all + std::fabs(x); });
    const double mean = sum / (static_cast<double>(kept.size()) + 1e-9);
    if (is_exact && worst > 0)
        return fmt::format("what was written reads back with pixels that differ by {:.3g}", worst);
    // GIF has 256 colors, and alpha of one bit.
    if (!is_exact && written.format != "gif" && !(mean <= kLossyMean)) {
        return fmt::format(
            "what was written reads back with pixels that differ by {:.3g} on average", mean);
    }
    return "";
}

std::string fault_of_file(const WrittenFile& written) {
    PictureReader reader(written.path, 0, ReadOptions{.max_pixels = kUnlimited});
    if (std::string fault = fault_of_size(written, reader.spec()); !fault.empty()) return fault;
    if (written.pixels) return fault_of_pixels(written, reader.read_all().copy(OIIO::TypeFloat));
    if (!written.is_opened_by_name) return "";
    try {
        check_is_complete(reader);  // there is no other proof
        return "";
    } catch (const FileError&) {
        return "what was written cannot be read back (disk full?)";
    }
}

}  // namespace

std::string fault_of(const WrittenFile& written) {
    if (written.codec == "avif" && !brand_of(written.path).starts_with("avi")) {
        return "this OpenImageIO writes HEVC under the name of AVIF, not AV1; write a PNG file, "
               "and "
               "use avifenc";
    }
    if (written.format == "null" || written.format == "term") return "";
    try {
        return fault_of_file(written);
    } catch (const FileError& e) {
        // Writers without our own file do not report a full disk.
        return fmt::format("what was written cannot be read back{}: {}",
                           written.is_opened_by_name ? " (disk full?)" : "",
                           without_name(e.what(), written.path));
    }
}

TONEWRIGHT_NAMESPACE_END
