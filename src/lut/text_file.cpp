// SPDX-License-Identifier: Apache-2.0
#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <set>
#include <sstream>
#include <system_error>

#include "tonewright/lut.h"

namespace tonewright {
namespace fs = std::filesystem;

namespace {

[[noreturn]] void fail(const std::string& path, int error) {
    throw FileError("write: " + path + ": " + std::strerror(error));
}

}  // namespace

void write_text_atomically(const std::string& path, std::string_view contents) {
    const fs::path target(path);
    const fs::path temporary =
        target.parent_path() / fmt::format(".{}.{}.tmp", target.filename().string(), ::getpid());
    const int file = ::open(temporary.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0666);
    if (file < 0) fail(path, errno);
    std::size_t written = 0;
    int error = 0;
    while (written < contents.size() && error == 0) {
        const ssize_t n = ::write(file, contents.data() + written, contents.size() - written);
        if (n > 0) {
            written += static_cast<std::size_t>(n);
        } else if (errno != EINTR) {
            error = errno;
        }
    }
    // Without the sync a power cut after the rename can leave an empty file under the final name.
    if (error == 0 && ::fsync(file) != 0) error = errno;
    if (::close(file) != 0 && error == 0) error = errno;
    if (error == 0 && ::rename(temporary.c_str(), target.c_str()) != 0) error = errno;
    if (error != 0) {
        ::unlink(temporary.c_str());
        fail(path, error);
    }
}

namespace {
void make_folder(const fs::path& folder) {
    std::error_code error;
    fs::create_directories(folder, error);
    if (error) throw FileError("write: " + folder.string() + ": " + error.message());
}
}  // namespace

void require_writable_folder(const std::string& folder) {
    const fs::path root(folder);
    make_folder(root);
    const fs::path probe = root / ".tonewright";
    write_text_atomically(probe.string(), "");
    std::error_code error;
    fs::remove(probe, error);
}

void write_generated_files(const std::string& folder, const std::vector<GeneratedFile>& files,
                           std::string_view last) {
    const fs::path root(folder);
    std::set<std::string> stale;
    if (std::ifstream manifest(root / "MANIFEST.csv"); manifest) {
        std::string line;
        std::getline(manifest, line);  // column names; the first column is the path
        while (std::getline(manifest, line)) {
            stale.insert(fs::path(line.substr(0, line.find(','))).lexically_normal().string());
        }
    }
    const auto write = [&](const GeneratedFile& file) {
        const fs::path path = root / file.path;
        make_folder(path.parent_path());
        write_text_atomically(path.string(), file.contents);
        stale.erase(fs::path(file.path).lexically_normal().string());
    };
    for (const GeneratedFile& file : files) {
        if (file.path != last) write(file);
    }
    for (const GeneratedFile& file : files) {
        if (file.path == last) write(file);
    }
    // A manifest is a text file that anyone can edit: nothing outside the folder is touched, not
    // even through a link in it.
    std::error_code error;
    const fs::path inside = fs::canonical(root, error);
    for (const std::string& path : stale) {
        const fs::path parent = fs::canonical((root / path).parent_path(), error);
        if (error) continue;  // its folder is gone already
        const auto differ =
            std::mismatch(inside.begin(), inside.end(), parent.begin(), parent.end());
        if (differ.first != inside.end()) continue;
        if (fs::is_regular_file(root / path, error)) fs::remove(root / path, error);
    }
}

}  // namespace tonewright
