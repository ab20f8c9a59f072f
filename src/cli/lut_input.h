// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "cli/command.h"
#include "tonewright/lut_file.h"

TONEWRIGHT_NAMESPACE_BEGIN

/// A LUT instead of an operator.
struct LutOptions {
    std::string file;
    std::string interpolation = "auto";
    std::string encoding;
    std::string space;
    /// The part of the file that may state its input, once it was read. (OpenColorIO opens the file
    /// again, for the table.)
    mutable std::optional<std::string> text = {};
};

/// @param read_picture  reads a LUT that is a picture
/// @throws Error      trilinear interpolation for a LUT without it
/// @throws FileError  a file that is missing or malformed
[[nodiscard]] LutFile open_lut(const std::string& path, const std::string& interpolation,
                               const std::function<Lut(const std::string&)>& read_picture);

/// The display of the output's code values, or `linear`, if the file states it.
[[nodiscard]] std::optional<std::string> stated_display(const LutOptions& options);

/// Without --input-encoding: prints the input that the file states, in one line on stderr, or warns
/// that colors are passed unchanged. With it: warns if the file states another.
[[nodiscard]] LutOptions with_stated_input(const LutOptions& options, const std::string& input);

/// The stages before the LUT: light of `input` with --exposure, encoded by --input-encoding in the
/// primaries of --lut-space. Empty without --input-encoding, and for `none`: colors are passed
/// unchanged.
/// @param command  its name, for the message
/// @throws Error  unknown names; --input, --exposure or --lut-space without --input-encoding
[[nodiscard]] Pipeline before_lut(const char* command, const LutOptions& options,
                                  const ViewOptions& view, const SourceColor& input);

/// A command either has the option --lut or takes a LUT only as the operator.
enum class LutOption : bool { no, yes };

/// --input-encoding and --lut-space as settings of an operator that is a LUT.
/// @param lut_option  for the message
/// @throws Error  they are given for another operator
void take_lut_options(const char* command, const LutOptions& options, ViewOptions& view,
                      LutOption lut_option);

/// Throws the errors of before_lut() before pictures are read.
void check_lut_options(const char* command, const LutOptions& options, const ViewOptions& view,
                       const SourceColor& input);

TONEWRIGHT_NAMESPACE_END
