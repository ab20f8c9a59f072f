// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "tonewright/ocio.h"

TONEWRIGHT_NAMESPACE_BEGIN

/// An existing config after views were added or removed.
struct ExtendedConfig {
    /// The file to replace: the given name, or the file that this symbolic link leads to.
    std::string path;
    /// Tables, by their paths relative to the config; their names have a hash of their contents.
    std::vector<GeneratedFile> files;
    /// A file for later updates and removals, relative to the config. Write it as PATH.new before
    /// you replace the config, and rename it afterward. After reduce_config(), remove both instead.
    GeneratedFile record;
    /// Tables that are no longer used, by their paths relative to the config. Absolute paths are
    /// those of files that an earlier release wrote beside a symbolic link.
    std::vector<std::string> unused_files;
    /// OpenColorIO looks for tables beside the name that it opens. Make symbolic links with these
    /// names to the folder of the tables, after the unused files are gone.
    std::vector<std::string> missing_links;
    /// Symbolic links to the folder of the tables. Remove them if that folder is gone.
    std::vector<std::string> folder_links;
    /// The config: the old text, byte for byte, with insertions or without them.
    std::string text;
    /// Names of the added items, by kind: "view transform", "look", "view", "color space".
    std::vector<ChangedConfig::Added> added;
    /// One line about the items that `check` cannot run, because the profile of the config is newer
    /// than those that the linked OpenColorIO reads; empty: it can run all.
    std::string unchecked;
    /// @see ConfigPlan::warnings
    std::vector<std::string> warnings;
    /// Reads the written config with its tables. Checks that OpenColorIO accepts it, that all old
    /// spaces and views give the same numbers, and that the new views match the operators.
    /// @throws Error  a check fails
    std::function<std::vector<ExtendedView>(const std::string& path)> check;
};

/// Adds views, looks and output spaces to a user's config, on its displays whose numbers match one
/// of Tonewright's. The rest of the file stays as it is, with comments and order.
/// @param options     @see ConfigChange::options
/// @param is_updated  removes the earlier additions first; if all options are empty, repeats the
///                    earlier ones
/// @throws FileError  the config cannot be read, OpenColorIO refuses it, or it lacks an interchange
///                    role, a space or such a display
/// @throws Error      an option is wrong, or a name is taken
[[nodiscard]] ExtendedConfig extend_config(const std::string& path, const ConfigOptions& options,
                                           bool is_updated = false);

/// Removes everything that extend_config() added.
/// @throws FileError  the config cannot be read, nothing was added to it, or an added text was
///                    edited
[[nodiscard]] ExtendedConfig reduce_config(const std::string& path);

TONEWRIGHT_NAMESPACE_END
