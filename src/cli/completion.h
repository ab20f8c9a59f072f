// SPDX-License-Identifier: Apache-2.0
//
// Suggestions of a shell for the next word of a command line. The scripts of all shells ask
// `tonewright complete`, so they suggest the same.
#pragma once

#include <functional>
#include <map>
#include <string>
#include <vector>

#include "cli/help_text.h"
#include "tonewright/version.h"

TONEWRIGHT_NAMESPACE_BEGIN

struct Suggestion {
    std::string word;
    /// Description of the word, for shells that show it; may be empty.
    std::string meaning;
};

struct Suggestions {
    std::vector<Suggestion> words;
    /// Names of files or of folders are suggested, too. The shell completes them.
    bool has_files = false;
    bool has_folders = false;
};

/// The value at the cursor, and the words before it.
struct TypedValue {
    std::string text;
    /// Values of the options and arguments before it, by name: `--operator`, `OPERATOR`.
    std::map<std::string, std::vector<std::string>> others = {};
};
/// May give words that do not begin with the typed text; complete() drops them.
using Suggest = std::function<Suggestions(const TypedValue&)>;
/// Suggests these words.
[[nodiscard]] Suggest one_of(std::vector<std::string> words);

struct OptionTable {
    /// All names, the long ones first; `OPERATOR` for an argument.
    std::vector<std::string> names;
    std::string text;
    std::string value;
    bool is_argument = false;
    bool has_value = false;
    bool may_repeat = false;
    /// Separator between several values in one word; 0: one value a word.
    char separator = 0;
    Suggest suggest = {};
};

/// A command: its help, and its options for completion and the manual.
struct CommandTable {
    std::string name;
    HelpPage page;
    std::vector<OptionTable> options;
};

/// Candidates for the last word.
/// @param tables  the program and its commands
/// @param words   without the name of the program; the last one may be empty
[[nodiscard]] Suggestions complete(const std::vector<CommandTable>& tables,
                                   const std::vector<std::string>& words);

/// One word a line, with a tab and its description, then `:files` or `:folders`.
[[nodiscard]] std::string to_text(const Suggestions& suggestions);

TONEWRIGHT_NAMESPACE_END
