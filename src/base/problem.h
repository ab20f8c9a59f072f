// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <exception>

#include "tonewright/error.h"

TONEWRIGHT_NAMESPACE_BEGIN

/// The problem of an exception: of kind `memory` for std::bad_alloc, of kind `internal` for other
/// exceptions that are no Error.
[[nodiscard]] TONEWRIGHT_API Problem problem_of(const std::exception& error);

/// Throws a problem that was kept.
/// @throws FileError  where a file or the memory is the reason; else Error
[[noreturn]] TONEWRIGHT_API void throw_problem(const Problem& problem);

TONEWRIGHT_NAMESPACE_END
