// SPDX-License-Identifier: Apache-2.0
#include "picture/exr_core.h"

#include <cstddef>
#include <cstdlib>
#include <new>
#include <string>
#include <utility>

#include "base/strings.h"
#include "tonewright/error.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

// By thread, because several threads use one file.
thread_local std::string last_message;
thread_local bool allocation_failed = false;

}  // namespace

exr_context_initializer_t exr_options() {
    exr_context_initializer_t options = EXR_DEFAULT_CONTEXT_INITIALIZER;
    options.error_handler_fn = [](exr_const_context_t, exr_result_t, const char* message) {
        last_message = message ? message : "";
    };
    options.alloc_fn = [](std::size_t bytes) {
        void* const memory = std::malloc(bytes);
        allocation_failed = allocation_failed || !memory;
        return memory;
    };
    options.free_fn = [](void* memory) { std::free(memory); };
    return options;
}

void check_exr(exr_result_t result) {
    if (result == EXR_ERR_SUCCESS) return;
    const std::string message = std::exchange(last_message, {});
    if (result == EXR_ERR_OUT_OF_MEMORY) {
        if (std::exchange(allocation_failed, false)) throw std::bad_alloc();
        throw FileError("the file is truncated or damaged");
    }
    throw FileError(
        problem_of_library(message.empty() ? exr_get_default_error_message(result) : message));
}

TONEWRIGHT_NAMESPACE_END
