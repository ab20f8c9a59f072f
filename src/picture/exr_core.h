// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <OpenEXR/openexr.h>

#include <memory>
#include <type_traits>

#include "tonewright/version.h"

/// OpenEXR's core library: its errors as exceptions.
TONEWRIGHT_NAMESPACE_BEGIN

/// An open file.
struct ExrFileCloser {
    void operator()(exr_context_t file) const { exr_finish(&file); }
};
using ExrFile = std::unique_ptr<std::remove_pointer_t<exr_context_t>, ExrFileCloser>;

/// Options for opening a file: nothing is printed, and check_exr() learns the reasons of errors.
[[nodiscard]] exr_context_initializer_t exr_options();

/// @throws FileError  with the library's message, unless the result is a success
/// @throws std::bad_alloc  if memory could not be allocated; the library says so of damaged blocks,
///                         too, which become a FileError
void check_exr(exr_result_t result);

TONEWRIGHT_NAMESPACE_END
