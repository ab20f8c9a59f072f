// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "base/strings.h"
#include "tonewright/lut.h"
#include "tonewright/lut_applications.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

/// In the order of LutFormat.
const std::array<std::vector<std::string>, 15>& extensions() {
    static const std::vector<std::string> picture = {".png", ".tif", ".tiff", ".exr"};
    static const std::array<std::vector<std::string>, 15> all = {{{".cube"},
                                                                  {".clf"},
                                                                  {".ctf"},
                                                                  {".spi1d"},
                                                                  {".spi3d"},
                                                                  {".csp"},
                                                                  {".cube"},
                                                                  {".3dl"},
                                                                  {".lut"},
                                                                  {".icc", ".icm"},
                                                                  picture,
                                                                  picture,
                                                                  picture,
                                                                  {".raw"},
                                                                  {".ktx2"}}};
    return all;
}

const std::vector<std::string>& extensions_of(LutFormat format) {
    return extensions()[static_cast<std::size_t>(format)];
}

bool has(const std::vector<std::string>& all, const std::string& one) {
    return std::find(all.begin(), all.end(), one) != all.end();
}

std::vector<std::string> known_extensions() {
    std::vector<std::string> known;
    for (const std::vector<std::string>& some : extensions()) {
        for (const std::string& extension : some) {
            if (!has(known, extension)) known.push_back(extension);
        }
    }
    return known;
}

}  // namespace

LutFormat lut_format_of_file(const std::string& path, std::optional<LutFormat> format,
                             const LutApplication* application) {
    const std::string extension = extension_of(path);
    if (!format && application) {
        format = application->format;
        for (const LutFormat chain : {LutFormat::clf, LutFormat::ctf}) {
            if (reads_chains(*application, chain) && has(extensions_of(chain), extension))
                format = chain;
        }
    }
    if (format) {
        const std::vector<std::string>& own = extensions_of(*format);
        // Readers of LUTs recognize formats by the extension, so the file needs the right one.
        if (has(own, extension)) return *format;
        const std::string reason =
            application && *format == application->format
                ? fmt::format("{} reads {}", application->title, name_of(*format))
                : fmt::format("the format is {}", name_of(*format));
        throw Error(
            {.parameter = "file", .value = path, .expected = join_choices(own) + ": " + reason});
    }
    if (has(extensions_of(LutFormat::hald), extension)) {
        throw Error(
            {.parameter = "file",
             .value = path,
             .expected = "<<format=hald>>, strip or strip_up with a picture, or <<application>>"});
    }
    // If two formats share an extension, the first one is the default.
    for (std::size_t i = 0; i < extensions().size(); ++i) {
        if (has(extensions()[i], extension)) return static_cast<LutFormat>(i);
    }
    const std::vector<std::string> known = known_extensions();
    throw Error({.parameter = "file",
                 .value = path,
                 .expected = "a name that ends in " + join_choices(known),
                 .suggestion = suggested_names(extension, known)});
}

TONEWRIGHT_NAMESPACE_END
