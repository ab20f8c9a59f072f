// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <functional>

#include "tonewright/version.h"

TONEWRIGHT_NAMESPACE_BEGIN

/// Runs f(0) ... f(count - 1), each once, on threads that take the next one when they are free.
/// What one throws is thrown when all threads have ended.
/// @param thread_count  0: as many as there are cores that no other call of it uses, so that a call
///                      inside of another takes what that one has left idle
TONEWRIGHT_API void in_parallel(std::size_t count, unsigned thread_count,
                                const std::function<void(std::size_t)>& f);

TONEWRIGHT_NAMESPACE_END
