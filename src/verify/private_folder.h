// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdlib>
#include <filesystem>
#include <string>
#include <system_error>

#include "tonewright/error.h"

TONEWRIGHT_NAMESPACE_BEGIN

/// A folder that only this user can read. The destructor removes it.
class PrivateFolder {
  public:
    PrivateFolder() : path_((std::filesystem::temp_directory_path() / "tonewright-XXXXXX")) {
        if (!::mkdtemp(path_.data())) throw FileError("write: " + path_ + ": cannot make a folder");
    }
    ~PrivateFolder() {
        std::error_code ignored;
        std::filesystem::remove_all(path_, ignored);
    }
    PrivateFolder(const PrivateFolder&) = delete;
    PrivateFolder& operator=(const PrivateFolder&) = delete;

    [[nodiscard]] const std::string& path() const { return path_; }
    [[nodiscard]] std::string file(const std::string& name) const { return path_ + "/" + name; }

  private:
    std::string path_;
};

TONEWRIGHT_NAMESPACE_END
