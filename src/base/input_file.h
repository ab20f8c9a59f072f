// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <functional>
#include <new>
#include <optional>
#include <stdexcept>
#include <string>
#include <system_error>

#include "tonewright/error.h"
#include "tonewright/version.h"

TONEWRIGHT_NAMESPACE_BEGIN

/// Why a path is no file, where something is there that is none: "is a folder", or "is no regular
/// file ..." for a pipe, a device or a socket, which may have no end. Empty for a file, and where
/// nothing is there.
[[nodiscard]] TONEWRIGHT_API std::string why_no_file(const std::string& path);
/// The reason why a file cannot be read: that of why_no_file(), or the system's. Nothing if it can.
[[nodiscard]] TONEWRIGHT_API std::optional<Problem> why_not_readable(const std::string& path);
/// For files that another library opens.
/// @throws FileError  "read: <path>: <reason of why_no_file()>"
TONEWRIGHT_API void require_regular_file(const std::string& path);
/// The whole file, opened so that a pipe cannot block it.
/// @param longest  bytes
/// @param fail     called with the reason where it cannot be read, or is longer; throws. The reason
///                 is a `value` alone: within() adds the file.
[[nodiscard]] TONEWRIGHT_API std::string read_file(
    const std::string& path, std::size_t longest,
    const std::function<void(const Problem& reason)>& fail);

/// The contents of a file of the program's own, such as one of the cache, and marks it as used now.
/// Nothing if there is none, it is longer, or another user may have written it: a link, a file of
/// another user but root, or one that others may write to.
[[nodiscard]] TONEWRIGHT_API std::optional<std::string> read_own_file(const std::string& path,
                                                                      std::size_t longest);

[[nodiscard]] inline Problem no_memory(const char* text = "not enough memory") {
    return {.kind = Problem::Kind::memory, .value = text};
}

/// Runs `step`. Where the memory does not do for it, the message has the file's name.
/// @throws FileError  "<path>: not enough memory", of kind `memory`, and what the step throws
template <class Step>
decltype(auto) with_memory_for(const std::string& path, const Step& step) {
    try {
        return step();
    } catch (const std::bad_alloc&) {
        throw FileError(within(path, no_memory()));
    } catch (const std::length_error&) {  // more than any memory
        throw FileError(within(path, no_memory()));
    } catch (const std::system_error& e) {
        if (e.code() != std::errc::resource_unavailable_try_again) throw;
        throw FileError(within(path, no_memory("not enough memory or threads")));  // for a stack
    }
}

TONEWRIGHT_NAMESPACE_END
