// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <exception>
#include <new>
#include <string_view>

#include "base/strings.h"

TONEWRIGHT_NAMESPACE_BEGIN

/// Sets the message of the current exception as the error of an OpenImageIO picture or reader;
/// functions of callers may throw anything. Without memory for a message, the error is empty.
/// @returns  false
template <class Reporter>
bool report_thrown(const Reporter& to, std::string_view prefix) noexcept {
    try {
        try {
            throw;
        } catch (const std::bad_alloc&) {
            to.errorfmt("{}not enough memory", prefix);
        } catch (const std::exception& e) {
            to.errorfmt("{}{}", prefix, one_line(e.what()));
        } catch (...) {
            to.errorfmt("{}unknown error", prefix);
        }
    } catch (const std::exception&) {
        return false;
    }
    return false;
}

TONEWRIGHT_NAMESPACE_END
