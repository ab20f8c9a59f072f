// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "tonewright/color.h"

TONEWRIGHT_NAMESPACE_BEGIN

/// Decoding of a display's code values.
struct IccCurve {
    /// A power, or the curve of IEC 61966-2-1, for which `power` is also its exponent.
    double exponent = 1;
    bool is_srgb = false;
};

/// True when this build has Little CMS. Without it the functions of this header throw Error.
[[nodiscard]] TONEWRIGHT_API bool has_icc();

/// An ICC display profile of version 4 (ICC.1:2010-12): primaries and white, adapted to D50 with
/// Bradford's matrix, and one parametric curve. The same bytes on every run.
/// @param is_gray      for pictures with one channel: only the curve
/// @param description  one line that programs show
[[nodiscard]] TONEWRIGHT_API std::string write_display_icc(const Primaries& primaries,
                                                           const IccCurve& curve,
                                                           const std::string& description,
                                                           bool is_gray);

/// A 3D LUT as an ICC device link, RGB to RGB, 16 bits: the contents of the file, the same on every
/// run.
/// @param nodes        RGB triplets of numbers in [0, 1], blue fastest
/// @param description  one line that programs show
/// @param text         further text
[[nodiscard]] TONEWRIGHT_API std::string write_icc(const std::vector<float>& nodes, int size,
                                                   int version, const std::string& description,
                                                   const std::vector<std::string>& text);

/// An ICC device link as LittleCMS runs it: tetrahedral, in 16 bits.
class TONEWRIGHT_API DeviceLink {
  public:
    /// @param path  for errors
    /// @throws FileError  if it is no device link from RGB to RGB, or damaged.
    DeviceLink(const std::string& path, std::string_view bytes);
    ~DeviceLink();
    DeviceLink(DeviceLink&&) noexcept;
    DeviceLink& operator=(DeviceLink&&) noexcept;

    /// Interleaved RGB; safe to use from several threads at once.
    void run_rgb(const float* in, float* out, std::size_t count) const;
    /// Nodes a side of its table; 0 if the sides differ.
    [[nodiscard]] int edge() const noexcept { return edge_; }

  private:
    int edge_ = 0;
    struct Profile;
    std::unique_ptr<const Profile> profile_;
};

TONEWRIGHT_NAMESPACE_END
