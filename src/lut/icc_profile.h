// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "tonewright/version.h"

/// The bytes of an ICC profile, before another library parses them: ICC.1:2022, 7 and 10.
TONEWRIGHT_NAMESPACE_BEGIN

/// Called with the reason why a profile cannot be used; throws.
using RefuseIcc = std::function<void(const std::string& reason)>;

/// Places in the header, ICC.1:2022, 7.2.
inline constexpr std::size_t kIccClass = 12;
inline constexpr std::size_t kIccSpace = 16;
inline constexpr std::size_t kIccConnectionSpace = 20;
inline constexpr std::size_t kIccCreated = 24;
inline constexpr std::size_t kIccHeader = 128;

/// @pre the bytes are there, and count is at most 4
[[nodiscard]] std::uint32_t big_endian(std::string_view bytes, std::size_t at, std::size_t count);

/// Tags by name, inside the profile.
class IccTags {
  public:
    /// Checks the header and the table of tags, but no tag.
    IccTags(std::string_view bytes, const RefuseIcc& refuse);

    /// The first tag of that name with its type; null data: none.
    [[nodiscard]] std::string_view find(std::string_view name) const;
    [[nodiscard]] std::size_t count(std::string_view name) const;

  private:
    std::string_view bytes_;
    const RefuseIcc& refuse_;
    std::vector<std::size_t> entries_;  // places of the table's entries
};

/// Checks that the nodes of a table (`mft1`, `mft2`, `mAB `) are in its tag, because LittleCMS
/// allocates them before it knows.
/// @param name  of the tag, for messages
/// @returns     nodes a side, one number for each channel in
std::vector<std::size_t> check_icc_table(std::string_view name, std::string_view tag,
                                         std::size_t channels_in, const RefuseIcc& refuse);
/// The same for the tables of a `mpet` tag, ICC.1:2022, 10.16.
void check_icc_elements(std::string_view name, std::string_view tag, const RefuseIcc& refuse);

TONEWRIGHT_NAMESPACE_END
