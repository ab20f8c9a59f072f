// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <functional>
#include <limits>
#include <string>
#include <vector>

#include "tonewright/version.h"

TONEWRIGHT_NAMESPACE_BEGIN

/// A caller's check of numbers from the cache: false if they would harm it.
using NumberCheck = std::function<bool(const std::vector<double>& numbers)>;
/// Exactly so many numbers, each in [least, most]. NaN never is; an infinity is where it is a
/// limit.
[[nodiscard]] TONEWRIGHT_API NumberCheck
numbers_in(std::size_t count, double least = std::numeric_limits<double>::lowest(),
           double most = std::numeric_limits<double>::max());

/// The numbers that `make` computes, from the cache folder if it has them. Users may delete the
/// folder at any time.
///
/// A file has the key, the numbers and a checksum; a file that is damaged, has another key or fails
/// the check is ignored and replaced. So are a link, and a file that another user but root may have
/// written: key and checksum prove nothing about who wrote it. If all files exceed 256 MiB
/// together, the oldest are removed. A folder without write permission is not an error.
/// @param folder     is made on demand; empty: nothing is read or stored
/// @param name       first part of the file name, before the key's hash: "hue_cube"
/// @param key        everything that the numbers depend on, also the version of the algorithm
/// @param is_usable  asked about numbers of a file
[[nodiscard]] TONEWRIGHT_API std::vector<double> cached_numbers(
    const std::string& folder, const std::string& name, const std::string& key,
    const NumberCheck& is_usable, const std::function<std::vector<double>()>& make);

/// The numbers' bytes as text, for keys.
[[nodiscard]] TONEWRIGHT_API std::string key_of_numbers(const std::vector<double>& numbers);

TONEWRIGHT_NAMESPACE_END
