// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tasks/json.h"
#include "tonewright/pipeline.h"
#include "tonewright/verify.h"

TONEWRIGHT_NAMESPACE_BEGIN

/// The objects that `list OPERATOR --json` and `verify --json` print.
[[nodiscard]] Json to_json(const Operator& op);
[[nodiscard]] Json to_json(const ParityRow& row);

TONEWRIGHT_NAMESPACE_END
