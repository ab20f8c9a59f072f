// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <CLI/CLI.hpp>
#include <string>

#include "cli/command.h"
#include "tonewright/lut_file.h"

TONEWRIGHT_NAMESPACE_BEGIN

/// A LUT instead of an operator.
struct LutOptions {
    std::string file;
    std::string interpolation = "auto";
    std::string encoding;
    std::string space;
};

/// --lut, --interpolation, --input-encoding, --lut-space, for a command that has an operator and
/// add_view_options().
/// @param op      the option of the operator
/// @param others  options that say something of operators only
void add_lut_options(CLI::App& command, LutOptions& options, CLI::Option* op,
                     const std::vector<std::string>& others);

/// @throws Error      for trilinear where there is no such
/// @throws FileError  for a file that is missing or malformed
[[nodiscard]] LutFile open_lut(const std::string& path, const std::string& interpolation = "auto");

/// What stands before the LUT: light of `input`, with --exposure, as --input-encoding in the
/// primaries of --lut-space. Empty without --input-encoding: colors go in as they are.
/// @throws Error  unknown names; --input, --exposure or --lut-space without --input-encoding.
[[nodiscard]] Pipeline before_lut(const CLI::App& command, const LutOptions& options,
                                  const ViewOptions& view, const SourceColor& input);

TONEWRIGHT_NAMESPACE_END
