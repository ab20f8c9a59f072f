// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <exception>
#include <new>
#include <string_view>

#include "base/strings.h"
#include "tonewright/error.h"

TONEWRIGHT_NAMESPACE_BEGIN

/// Sets the message of the current exception as the error of an OpenImageIO picture or reader;
/// functions of callers may throw anything. Without memory for a message, the error is empty.
/// @param is_internal  the message becomes part of an Error again: it keeps its references
/// @returns  false
template <class Reporter>
bool report_thrown(const Reporter& to, std::string_view prefix, bool is_internal = false) noexcept {
    try {
        try {
            throw;
        } catch (const std::bad_alloc&) {
            to.errorfmt("{}not enough memory", prefix);
        } catch (const Error& e) {
            to.errorfmt("{}{}", prefix, one_line(is_internal ? e.text() : e.what()));
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
