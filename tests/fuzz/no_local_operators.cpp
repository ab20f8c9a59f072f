// SPDX-License-Identifier: Apache-2.0
//
// Names in place of the local operators, whose pictures need the whole engine.
#include "local/operators.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

Operator named(const char* id) {
    Operator op;
    op.id = id;
    op.build = [](const Params&) { return Pipeline(); };
    return op;
}

}  // namespace

Operator define_exposure_fusion() { return named("exposure_fusion"); }
Operator define_local_laplacian() { return named("local_laplacian"); }
Operator define_reinhard_local() { return named("reinhard_local"); }

TONEWRIGHT_NAMESPACE_END
