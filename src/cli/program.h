// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <CLI/CLI.hpp>
#include <vector>

#include "tonewright/version.h"

TONEWRIGHT_NAMESPACE_BEGIN

using AddCommand = void (*)(CLI::App& program, int& exit_code);

/// The command line with these subcommands. @return the exit code
int run_program(int argc, char** argv, const std::vector<AddCommand>& commands);

TONEWRIGHT_NAMESPACE_END
