// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tonewright/version.h"

TONEWRIGHT_NAMESPACE_BEGIN

/// The text of run_on_dawn.mjs.
extern const char* const kRunOnDawn;

TONEWRIGHT_NAMESPACE_END
