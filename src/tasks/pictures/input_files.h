// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "tonewright/sequence.h"

TONEWRIGHT_NAMESPACE_BEGIN

[[nodiscard]] bool is_folder(const std::string& path);
/// True for an extension (`.png`) that OpenImageIO reads.
[[nodiscard]] bool is_picture_extension(const std::string& extension);

/// The pictures of a folder without its subfolders, sorted by name.
/// @throws FileError  the folder cannot be read, or has no pictures
[[nodiscard]] std::vector<std::string> pictures_of_folder(const std::string& folder);
/// The names in a text file: one a line. Empty lines and those that begin with `#` are left out.
/// @throws FileError  the file cannot be read, or has no names
[[nodiscard]] std::vector<std::string> names_of_list(const std::string& path);

/// The pictures of folders and of lists: `@FILE` stands for the names in that file.
/// @param takes_folders  false: the name of a folder stays as it is
/// @returns  and whether there is a folder or a list
/// @throws FileError  @see pictures_of_folder, names_of_list
[[nodiscard]] std::pair<std::vector<std::string>, bool> expanded_inputs(
    const std::vector<std::string>& names, bool takes_folders);

/// Pictures and their results in a folder, with the names of the pictures.
/// @param format   extension of the results, such as `png`; empty: those of the pictures
/// @throws Error   two results of one name
[[nodiscard]] std::vector<FrameFiles> files_into_folder(const std::vector<std::string>& pictures,
                                                        const std::string& folder,
                                                        const std::string& format);

TONEWRIGHT_NAMESPACE_END
