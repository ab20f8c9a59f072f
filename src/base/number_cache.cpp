// SPDX-License-Identifier: Apache-2.0
#include "base/number_cache.h"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <optional>
#include <string_view>
#include <utility>

#include "base/atomic_file.h"
#include "base/input_file.h"
#include "base/strings.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

namespace fs = std::filesystem;

constexpr std::uintmax_t kLargestFolder = std::uintmax_t{256} << 20;
constexpr std::string_view kEnding = ".numbers";
/// Version of the file's format. Its numbers have this processor's byte order, and machines may
/// share the folder.
constexpr std::string_view kBeginning = std::endian::native == std::endian::little
                                            ? "tonewright numbers 1\n"
                                            : "tonewright numbers 1 big-endian\n";

/// FNV-1a of 64 bits.
std::uint64_t check_sum(std::string_view bytes) {
    std::uint64_t sum = 0xCBF29CE484222325ULL;
    for (const char c : bytes)
        sum = (sum ^ static_cast<unsigned char>(c)) * 0x100000001B3ULL;
    return sum;
}

std::string bytes_of(const std::vector<double>& numbers) {
    return {reinterpret_cast<const char*>(numbers.data()), numbers.size() * sizeof(double)};
}

/// Beginning, key, a line with the count and the check sum of the numbers, numbers.
std::string header_of(const std::string& key, std::size_t count, std::uint64_t sum) {
    return fmt::format("{}{}\n{} {:016x}\n", kBeginning, key, count, sum);
}

std::optional<std::vector<double>> read(const fs::path& path, const std::string& key) {
    const std::optional<std::string> contents = read_own_file(path.string(), kLargestFolder);
    if (!contents) return std::nullopt;
    const std::string& text = *contents;
    const std::string beginning = fmt::format("{}{}\n", kBeginning, key);
    if (!text.starts_with(beginning)) return std::nullopt;
    const std::size_t end = text.find('\n', beginning.size());
    if (end == std::string::npos) return std::nullopt;
    const std::string_view bytes = std::string_view(text).substr(end + 1);
    const std::size_t count = bytes.size() / sizeof(double);
    if (std::string_view(text).substr(0, end + 1) != header_of(key, count, check_sum(bytes)) ||
        bytes.size() % sizeof(double) != 0)
        return std::nullopt;
    std::vector<double> numbers(count);
    // data() of no numbers may be null, which memcpy must not get: Clang then compiles a crash.
    if (!bytes.empty()) std::memcpy(numbers.data(), bytes.data(), bytes.size());
    return numbers;
}

void drop_oldest(const fs::path& folder) {
    struct File {
        fs::file_time_type time;
        fs::path path;
        std::uintmax_t size;
    };
    std::error_code error;
    std::vector<File> files;
    std::uintmax_t whole = 0;
    for (fs::directory_iterator it(folder, error), end; !error && it != end; it.increment(error)) {
        std::error_code of_file;
        if (it->path().extension() != kEnding || !fs::is_regular_file(it->symlink_status(of_file)))
            continue;
        const File file = {it->last_write_time(of_file), it->path(), it->file_size(of_file)};
        if (of_file) continue;
        whole += file.size;
        files.push_back(file);
    }
    std::sort(files.begin(), files.end(),
              [](const File& a, const File& b) { return a.time < b.time; });
    for (const File& file : files) {
        if (whole <= kLargestFolder) return;
        if (fs::remove(file.path, error)) whole -= file.size;
    }
}

/// The XDG Base Directory Specification asks for permission 0700.
///
/// A folder that exists is used as it is: it may be a link to another disk, and a site may share
/// it. What others can do there is harmless. They cannot make a file that is believed, because a
/// file must belong to this user or root, and be closed to other writers. They cannot lead a write
/// elsewhere, because it replaces a name in this folder and follows no link. They can delete files,
/// which costs the time to compute them.
bool make_private_folder(const fs::path& folder) {
    std::error_code error;
    if (fs::is_directory(folder, error)) return true;
    fs::create_directories(folder, error);
    if (error) return false;
    fs::permissions(folder, fs::perms::owner_all, error);
    return true;
}

void write(const fs::path& path, const std::string& key, const std::vector<double>& numbers) {
    if (!make_private_folder(path.parent_path())) return;
    const std::string bytes = bytes_of(numbers);
    try {
        write_text_atomically(path.string(),
                              header_of(key, numbers.size(), check_sum(bytes)) + bytes,
                              AtomicFile::Kind::of_program);
    } catch (const std::exception&) {
        return;  // the numbers are known anyway
    }
    drop_oldest(path.parent_path());
}

}  // namespace

NumberCheck numbers_in(std::size_t count, double least, double most) {
    return [=](const std::vector<double>& numbers) {
        return numbers.size() == count &&
               std::all_of(numbers.begin(), numbers.end(),
                           [&](double x) { return x >= least && x <= most; });
    };
}

std::vector<double> cached_numbers(const std::string& folder, const std::string& name,
                                   const std::string& key, const NumberCheck& is_usable,
                                   const std::function<std::vector<double>()>& make) {
    if (folder.empty()) return make();
    const fs::path path =
        fs::path(folder) / fmt::format("{}_{}{}", name, content_hash(key), kEnding);
    if (auto known = read(path, key); known && is_usable(*known)) return *std::move(known);
    std::vector<double> numbers = make();
    write(path, key, numbers);
    return numbers;
}

std::string key_of_numbers(const std::vector<double>& numbers) {
    return fmt::format("{} {:016x} {}", numbers.size(), check_sum(bytes_of(numbers)),
                       content_hash(bytes_of(numbers)));
}

TONEWRIGHT_NAMESPACE_END
