// SPDX-License-Identifier: Apache-2.0
#pragma once

// CMake reads the version of the project from these three lines.
#define TONEWRIGHT_VERSION_MAJOR 0
#define TONEWRIGHT_VERSION_MINOR 1
#define TONEWRIGHT_VERSION_PATCH 0

#define TONEWRIGHT_STRINGIZE_(x) #x
#define TONEWRIGHT_STRINGIZE(x) TONEWRIGHT_STRINGIZE_(x)
/// "0.1.0"
#define TONEWRIGHT_VERSION                                                       \
    TONEWRIGHT_STRINGIZE(TONEWRIGHT_VERSION_MAJOR)                               \
    "." TONEWRIGHT_STRINGIZE(TONEWRIGHT_VERSION_MINOR) "." TONEWRIGHT_STRINGIZE( \
        TONEWRIGHT_VERSION_PATCH)

/// The inline namespace has the major version, so that a process can load two versions.
#define TONEWRIGHT_NAMESPACE_BEGIN \
    namespace tonewright {         \
    inline namespace v0 {
#define TONEWRIGHT_NAMESPACE_END \
    }                            \
    }

/// Marks a class or function that the shared libraries export; all other symbols are hidden.
#if defined(__GNUC__) && !defined(_WIN32)
#define TONEWRIGHT_API __attribute__((visibility("default")))
#else
#define TONEWRIGHT_API
#endif
