// SPDX-License-Identifier: Apache-2.0
#include "cli/pictures/standard_streams.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <string_view>
#include <system_error>

#include "base/strings.h"
#include "tonewright/image_io.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

/// Formats that programs pass to each other.
std::string extension_of_contents(std::string_view bytes) {
    using namespace std::string_view_literals;
    if (bytes.starts_with("\x89PNG"sv)) return ".png";
    if (bytes.starts_with("\x76\x2F\x31\x01"sv)) return ".exr";
    if (bytes.starts_with("\xFF\xD8\xFF"sv)) return ".jpg";
    if (bytes.starts_with("#?"sv)) return ".hdr";
    if (bytes.starts_with("PF"sv) || bytes.starts_with("Pf"sv)) return ".pfm";
    if (bytes.size() > 1 && bytes[0] == 'P' && bytes[1] >= '1' && bytes[1] <= '6') return ".ppm";
    return {};
}

}  // namespace

StandardStreams::StandardStreams(ApplyOptions& options) {
    constexpr const char* kDash = "-";
    std::vector<std::string>& pictures = options.pictures;
    const bool has_output = options.given.contains("--output");
    std::string& output = has_output || pictures.size() < 2 ? options.output : pictures.back();
    const bool reads = std::count(pictures.begin(), pictures.end(), kDash) >
                       (&output == &options.output || output != kDash ? 0 : 1);
    const bool writes = output == kDash;
    if (!reads && !writes) return;
    if (options.given.contains("--frames") || pictures.size() > (has_output ? 1U : 2U))
        throw Error("apply: - is one of several pictures; expected one picture from or to it");
    if (writes) {
        if (options.format.empty()) {
            throw Error(
                "apply: --format is missing; expected png, exr, ppm, jpg or another extension with "
                "- as the output");
        }
        if (::isatty(STDOUT_FILENO) != 0)
            throw Error("apply: OUT is -, a terminal; expected a pipe or a file");
    }
    make_folder();
    if (writes) {
        out_ = folder_ + "/out." + options.format;
        output = out_;
        options.format.clear();
    }
    if (!reads) return;
    try {
        read_input(options);
    } catch (...) {
        remove_folder();  // there is no object yet that could
        throw;
    }
}

StandardStreams::~StandardStreams() { remove_folder(); }

void StandardStreams::remove_folder() noexcept {
    std::error_code ignored;
    if (!folder_.empty()) std::filesystem::remove_all(folder_, ignored);
}

void StandardStreams::make_folder() {
    std::error_code error;
    std::string name = std::filesystem::temp_directory_path(error).string() + "/tonewright-XXXXXX";
    if (error || !::mkdtemp(name.data())) {
        throw FileError(fmt::format("apply: {}: cannot make a folder: {}", name,
                                    std::system_category().message(errno)));
    }
    folder_ = name;
}

void StandardStreams::read_input(ApplyOptions& options) {
    // No pixel of these formats takes more than 16 bytes of color and alpha, and headers are small.
    constexpr double kBytesPerPixel = 16;
    constexpr double kHeader = 16 << 20;
    const double most = options.picture.max_pixels.value_or(kMaxPixels) * kBytesPerPixel + kHeader;
    std::array<char, 1 << 16> buffer{};
    std::FILE* file = nullptr;
    double total = 0;
    while (const std::size_t count = std::fread(buffer.data(), 1, buffer.size(), stdin)) {
        if (!file) {
            const std::string extension = extension_of_contents({buffer.data(), count});
            if (extension.empty()) {
                throw FileError(
                    "apply: -: the format is unknown; expected PNG, EXR, JPEG, HDR, PFM or PNM");
            }
            in_ = folder_ + "/in" + extension;
            file = std::fopen(in_.c_str(), "wb");
        }
        total += static_cast<double>(count);
        const bool is_written = file && std::fwrite(buffer.data(), 1, count, file) == count;
        if (!is_written || total > most) {
            const int reason = errno;
            if (file) std::fclose(file);
            if (total > most) throw FileError("apply: -: it is longer than --max-pixels allows");
            throw FileError(fmt::format("apply: {}: cannot write: {}", in_,
                                        std::system_category().message(reason)));
        }
    }
    if (!file) throw FileError("apply: -: standard input is empty");
    if (std::fclose(file) != 0) throw FileError("apply: " + in_ + ": cannot write");
    // Results take the date of their source, and a stream has none.
    const std::array<timespec, 2> no_date{};
    ::utimensat(AT_FDCWD, in_.c_str(), no_date.data(), 0);
    std::replace(options.pictures.begin(), options.pictures.end(), std::string("-"), in_);
}

void StandardStreams::finish() const {
    if (out_.empty()) return;
    std::FILE* const file = std::fopen(out_.c_str(), "rb");
    if (!file) throw FileError("apply: -: there is no output");
    std::array<char, 1 << 16> buffer{};
    bool is_written = true;
    while (const std::size_t count = std::fread(buffer.data(), 1, buffer.size(), file)) {
        is_written = std::fwrite(buffer.data(), 1, count, stdout) == count;
        if (!is_written) break;
    }
    std::fclose(file);
    if (!is_written || std::fflush(stdout) != 0) {
        throw FileError(
            fmt::format("apply: -: cannot write: {}", std::system_category().message(errno)));
    }
}

std::string StandardStreams::with_dashes(std::string text) const {
    for (const std::string& name : {in_, out_}) {
        if (name.empty()) continue;
        for (std::size_t at = text.find(name); at != std::string::npos; at = text.find(name, at))
            text.replace(at, name.size(), "-");
    }
    return text;
}

TONEWRIGHT_NAMESPACE_END
