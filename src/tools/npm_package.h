// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "tonewright/version.h"

TONEWRIGHT_NAMESPACE_BEGIN

/// Writes the npm package tonewright-shaders, for `npm pack`: ES modules with types, package.json,
/// README.md. Removes files that an earlier run wrote and that are gone.
/// @throws FileError
void write_npm_package(const std::string& folder);

TONEWRIGHT_NAMESPACE_END
