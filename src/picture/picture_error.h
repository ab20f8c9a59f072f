// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tonewright/error.h"

TONEWRIGHT_NAMESPACE_BEGIN

/// An error of the picture itself. The code that knows its file adds the name.
class TONEWRIGHT_API PictureError : public FileError {
  public:
    using FileError::FileError;
};

TONEWRIGHT_NAMESPACE_END
