// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "tonewright/version.h"

TONEWRIGHT_NAMESPACE_BEGIN

/// A cube as an ICC device link, RGB to RGB, 16 bits: the contents of the file, the same on every
/// run.
/// @param nodes        RGB triplets of numbers in [0, 1], blue fastest
/// @param description  one line that programs show
/// @param text         what else there is to say
[[nodiscard]] TONEWRIGHT_API std::string write_icc(const std::vector<float>& nodes, int size,
                                                   int version, const std::string& description,
                                                   const std::vector<std::string>& text);

/// An ICC device link as LittleCMS runs it: tetrahedral, in 16 bits.
class TONEWRIGHT_API DeviceLink {
  public:
    /// @param path  for errors
    /// @throws FileError  when it is none, of something else than RGB to RGB, or damaged.
    DeviceLink(const std::string& path, std::string_view bytes);
    ~DeviceLink();
    DeviceLink(DeviceLink&&) noexcept;
    DeviceLink& operator=(DeviceLink&&) noexcept;

    /// Interleaved RGB; safe to use from several threads at once.
    void run_rgb(const float* in, float* out, std::size_t count) const;

  private:
    struct Profile;
    std::unique_ptr<const Profile> profile_;
};

TONEWRIGHT_NAMESPACE_END
