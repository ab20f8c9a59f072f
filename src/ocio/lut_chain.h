// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "tonewright/lut.h"

TONEWRIGHT_NAMESPACE_BEGIN

/// True for a LUT of scene-linear input that is a chain of operations: the format is clf or ctf,
/// and the view mixes channels.
[[nodiscard]] TONEWRIGHT_API bool is_lut_chain(const LutRequest& request);

/// The operations of an OpenColorIO config's view in one file: matrices, half-domain 1D tables, 3D
/// LUTs of what no other operation is, and in a ctf OpenColorIO's fixed functions.
struct LutChain {
    std::string contents;
    /// Error of OpenColorIO's CPU path, on every color of the sample set, in code values.
    LutError error;
    /// "matrix, half LUT, 3D LUT"
    std::string operations;
    /// False if only a ctf holds the operations: a clf has no fixed functions and no hue
    /// adjustment.
    bool fits_clf = true;
};
/// @param request       of is_lut_chain(); the size is that of sampled 3D LUTs (default 65)
/// @param nodes         of sampled 3D LUTs; `automatic`: as in the config
/// @param cache_folder  keeps fitted nodes; empty: nothing is stored
/// @throws Error        the format lacks an operation; a wrong size; decimals, depths or smooth
/// nodes
[[nodiscard]] TONEWRIGHT_API LutChain make_lut_chain(const LutRequest& request, LutNodes nodes,
                                                     const std::string& cache_folder = {});

TONEWRIGHT_NAMESPACE_END
