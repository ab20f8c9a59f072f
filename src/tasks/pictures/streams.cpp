// SPDX-License-Identifier: Apache-2.0
#include "tasks/pictures/streams.h"

#include <fcntl.h>
#include <sys/stat.h>

#include <array>
#include <cerrno>
#include <string_view>
#include <system_error>

#include "tonewright/error.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

/// The front end adds its task to a problem that is a value alone.
FileError error_of(const std::string& text) {
    return FileError(Problem{.kind = Problem::Kind::file, .value = text});
}

std::string reason_of(int error_number) { return std::system_category().message(error_number); }

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

std::string save_stream(std::FILE* stream, const std::string& base, double max_pixels) {
    // No pixel of these formats takes more than 16 bytes of color and alpha, and headers are small.
    constexpr double kBytesPerPixel = 16;
    constexpr double kHeader = 16 << 20;
    const double most = max_pixels * kBytesPerPixel + kHeader;
    std::array<char, 1 << 16> buffer{};
    std::string path;
    std::FILE* file = nullptr;
    double total = 0;
    while (const std::size_t count = std::fread(buffer.data(), 1, buffer.size(), stream)) {
        if (!file) {
            const std::string extension = extension_of_contents({buffer.data(), count});
            if (extension.empty()) {
                throw error_of(
                    "-: the format is unknown; expected PNG, EXR, JPEG, HDR, PFM or PNM");
            }
            path = base + extension;
            file = std::fopen(path.c_str(), "wb");
        }
        total += static_cast<double>(count);
        const bool is_written = file && std::fwrite(buffer.data(), 1, count, file) == count;
        if (!is_written || total > most) {
            const int reason = errno;
            if (file) std::fclose(file);
            if (total > most) throw error_of("-: it is longer than <<max_pixels>> allows");
            throw error_of(path + ": cannot write: " + reason_of(reason));
        }
    }
    if (!file) throw error_of("-: standard input is empty");
    if (std::fclose(file) != 0) throw error_of(path + ": cannot write");
    // Results take the date of their source, and a stream has none.
    const std::array<timespec, 2> no_date{};
    ::utimensat(AT_FDCWD, path.c_str(), no_date.data(), 0);
    return path;
}

void copy_to_stream(const std::string& path, std::FILE* stream) {
    std::FILE* const file = std::fopen(path.c_str(), "rb");
    if (!file) throw error_of("-: there is no output");
    std::array<char, 1 << 16> buffer{};
    bool is_written = true;
    while (const std::size_t count = std::fread(buffer.data(), 1, buffer.size(), file)) {
        is_written = std::fwrite(buffer.data(), 1, count, stream) == count;
        if (!is_written) break;
    }
    std::fclose(file);
    if (!is_written || std::fflush(stream) != 0)
        throw error_of("-: cannot write: " + reason_of(errno));
}

TONEWRIGHT_NAMESPACE_END
