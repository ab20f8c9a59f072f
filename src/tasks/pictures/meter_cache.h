// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <map>
#include <string>

#include "tasks/json.h"
#include "tonewright/meter.h"

TONEWRIGHT_NAMESPACE_BEGIN

/// Shows whether a file has changed.
struct FileStamp {
    std::uint64_t bytes = 0;
    std::int64_t modified = 0;  // nanoseconds of its file system's clock
    friend bool operator==(const FileStamp&, const FileStamp&) = default;
};
/// Zeros for a file that does not exist.
[[nodiscard]] FileStamp stamp_of(const std::string& path);

[[nodiscard]] Json to_json(const MeterOptions& options);
[[nodiscard]] Json to_json(const Metering& metering);
/// @throws JsonError
[[nodiscard]] Metering metering_from(const Json& j);

/// Metered figures, stored in a file.
class MeterCache {
  public:
    /// @param path  empty: no cache. A file that does not exist is made.
    /// @throws FileError  it cannot be read, or is not a cache
    MeterCache(std::string path, const MeterOptions& options);

    /// Null if the file is unknown, has changed, or was metered with other options.
    [[nodiscard]] const Metering* find(const std::string& picture, const FileStamp& stamp) const;
    void add(const std::string& picture, const FileStamp& stamp, const Metering& metering);
    /// Writes it, if something was added.
    /// @throws FileError
    void save() const;

  private:
    struct Entry {
        FileStamp stamp;
        Metering metering;
    };
    std::string path_;
    std::string options_;                   // as JSON
    std::map<std::string, Entry> entries_;  // by absolute name
    std::map<std::string, Entry> added_;
};

TONEWRIGHT_NAMESPACE_END
