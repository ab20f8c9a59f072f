// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "tonewright/error.h"

TONEWRIGHT_NAMESPACE_BEGIN

/// The text of the Error that `f` throws.
template <class F>
std::string error_of(const F& f) {
    try {
        f();
    } catch (const Error& e) {
        return e.what();
    }
    return "no error";
}

TONEWRIGHT_NAMESPACE_END
