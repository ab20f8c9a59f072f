// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "cli/picture_options.h"
#include "tonewright/sequence.h"
#include "tonewright/tonemap.h"

TONEWRIGHT_NAMESPACE_BEGIN

/// Every frame, whatever becomes of the others: how far it is on a terminal, and at the end what
/// became of them, on standard error.
/// @param in, out   names with places for the number. @see frame_name
/// @param prepare   called with the frames and their numbers before any is made
/// @returns         the exit code
/// @throws Error    what is wrong with the whole of it
int apply_to_frames(
    const Tonemapper& tonemapper, const std::string& in, const std::string& out,
    const FrameOptions& options, const OIIO::TypeDesc& type, int threads,
    const std::function<void(std::vector<FrameFiles>&, const std::vector<int>&)>& prepare);

TONEWRIGHT_NAMESPACE_END
