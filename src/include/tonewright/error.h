// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdexcept>

#include "tonewright/version.h"

TONEWRIGHT_NAMESPACE_BEGIN

/// An error of the caller, in one line:
/// `<operation>: <parameter> is <value>; expected <interval or choices>[; did you mean
/// <nearest>?]`.
///
/// The core throws it. Image functions put it on the destination image. The command prints it and
/// exits with 2 (usage).
class TONEWRIGHT_API Error : public std::runtime_error {
  public:
    using std::runtime_error::runtime_error;
};

/// A file could not be read or written. The command exits with 3.
class TONEWRIGHT_API FileError : public Error {
  public:
    using Error::Error;
};

TONEWRIGHT_NAMESPACE_END
