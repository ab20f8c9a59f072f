// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "tonewright/version.h"

TONEWRIGHT_NAMESPACE_BEGIN

/// Where numbers that take seconds to compute are kept between runs: `tonewright` in
/// $XDG_CACHE_HOME, else in ~/.cache. Empty where neither is an absolute path: nothing is kept.
/// Users may delete the folder at any time.
[[nodiscard]] TONEWRIGHT_API std::string cache_folder();

/// The numbers that `make` computes, from the cache folder if they are there.
///
/// A file holds the key, the numbers and a check sum; a file that is damaged or of another key is
/// ignored and replaced. The oldest files go when all are larger than 256 MiB together. A folder
/// that cannot be written is no error.
/// @param name  of the file, with the key's hash behind it: "hue_cube"
/// @param key   all that the numbers depend on, the version of the algorithm included
[[nodiscard]] TONEWRIGHT_API std::vector<double> cached_numbers(
    const std::string& name, const std::string& key,
    const std::function<std::vector<double>()>& make);

/// The numbers' bytes as text, for keys.
[[nodiscard]] TONEWRIGHT_API std::string key_of_numbers(const std::vector<double>& numbers);

TONEWRIGHT_NAMESPACE_END
