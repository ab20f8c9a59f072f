// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdlib.h>  // mkdtemp()

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>

/// A folder for the files of a fuzz target, which lives as long as the program.
class PrivateFolder {
  public:
    PrivateFolder() {
        path_ = (std::filesystem::temp_directory_path() / "tonewright-fuzz-XXXXXX").string();
        if (!::mkdtemp(path_.data())) std::abort();
    }
    ~PrivateFolder() { std::filesystem::remove_all(path_); }
    PrivateFolder(const PrivateFolder&) = delete;
    PrivateFolder& operator=(const PrivateFolder&) = delete;

    [[nodiscard]] const std::string& path() const { return path_; }

    /// @returns  the path of the file
    [[nodiscard]] std::string write(const std::string& name, std::string_view bytes) const {
        const std::filesystem::path file = std::filesystem::path(path_) / name;
        std::filesystem::create_directories(file.parent_path());
        std::ofstream out(file, std::ios::binary);
        out.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
        if (!out.flush()) std::abort();
        return file.string();
    }

  private:
    std::string path_;
};
