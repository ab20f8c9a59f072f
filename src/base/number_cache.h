// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "tonewright/version.h"

TONEWRIGHT_NAMESPACE_BEGIN

/// The folder of numbers that take seconds to compute: `tonewright` in $XDG_CACHE_HOME, else in
/// ~/.cache. Empty if neither is an absolute path: nothing is stored. Users may delete the folder
/// at any time.
[[nodiscard]] TONEWRIGHT_API std::string cache_folder();

/// The numbers that `make` computes, from the cache folder if it has them.
///
/// A file has the key, the numbers and a checksum; a file that is damaged or has another key is
/// ignored and replaced. If all files exceed 256 MiB together, the oldest are removed. A folder
/// without write permission is not an error.
/// @param name  first part of the file name, before the key's hash: "hue_cube"
/// @param key   everything that the numbers depend on, also the version of the algorithm
[[nodiscard]] TONEWRIGHT_API std::vector<double> cached_numbers(
    const std::string& name, const std::string& key,
    const std::function<std::vector<double>()>& make);

/// The numbers' bytes as text, for keys.
[[nodiscard]] TONEWRIGHT_API std::string key_of_numbers(const std::vector<double>& numbers);

TONEWRIGHT_NAMESPACE_END
