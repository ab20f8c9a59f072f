// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <functional>

#include "tonewright/version.h"

TONEWRIGHT_NAMESPACE_BEGIN

/// Runs f(0) ... f(count - 1) once each, on threads that take the next index when they are free.
/// Rethrows an exception after all threads have ended.
/// @param thread_count  0: as many cores as no other call uses, so that a nested call uses the
///                      cores that the outer one leaves idle
TONEWRIGHT_API void in_parallel(std::size_t count, unsigned thread_count,
                                const std::function<void(std::size_t)>& f);

TONEWRIGHT_NAMESPACE_END
