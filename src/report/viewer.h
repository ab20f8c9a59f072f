// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tonewright/version.h"

TONEWRIGHT_NAMESPACE_BEGIN

/// viewer.html, with the place where the data goes.
extern const char* const kReportViewer;

TONEWRIGHT_NAMESPACE_END
