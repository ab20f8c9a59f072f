// SPDX-License-Identifier: Apache-2.0
//
// The manual pages, from the text of `--help`. help2man does not make them: it fills the lines of
// examples, which nobody can copy then, and has no exit codes, variables, or page of .tone files.
#pragma once

#include <string>
#include <vector>

#include "cli/completion.h"
#include "tonewright/version.h"

TONEWRIGHT_NAMESPACE_BEGIN

struct ManualSource {
    /// The program and its commands.
    std::vector<CommandTable> tables;
    /// Path of the document that has the reference of .tone files, in Markdown.
    std::string reference;
    /// Date of all pages: `2026-01-31`.
    std::string date;
};

/// Writes man1/tonewright.1, man1/tonewright-COMMAND.1 and man5/tonewright-tone.5 into the folder.
/// @throws Error
void write_manual(const ManualSource& source, const std::string& folder);

TONEWRIGHT_NAMESPACE_END
