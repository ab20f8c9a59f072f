// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <map>
#include <string>

#include "cli/json.h"
#include "tonewright/meter.h"

TONEWRIGHT_NAMESPACE_BEGIN

/// What tells whether a file has changed.
struct FileStamp {
    std::uint64_t bytes = 0;
    std::int64_t modified = 0;  // nanoseconds of its file system's clock
    friend bool operator==(const FileStamp&, const FileStamp&) = default;
};
/// Zeros of a file that is not there.
[[nodiscard]] FileStamp stamp_of(const std::string& path);

[[nodiscard]] Json to_json(const MeterOptions& options);
[[nodiscard]] Json to_json(const Metering& metering);
/// @throws JsonError
[[nodiscard]] Metering metering_from(const Json& j);

/// What was metered, kept in a file.
class MeterCache {
  public:
    /// @param path  empty: nothing is known and nothing is kept. A file that is not there: is made.
    /// @throws FileError  it cannot be read, or is something else.
    MeterCache(std::string path, const MeterOptions& options);

    /// Null where the file is not known, or has changed, or was metered in another way.
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
