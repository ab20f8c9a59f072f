// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <OpenImageIO/imagebuf.h>
#include <gtest/gtest.h>

#include <string>

#include "tonewright/engine.h"
#include "tonewright/registry.h"
#include "tonewright/tonemap.h"
#include "tonewright/view.h"

/// Tone mapped pictures for tests.
TONEWRIGHT_NAMESPACE_BEGIN

/// The SIMD engine's bound against the reference in encoded values is 1e-6 (engine.h); one more for
/// float operands on the way (division by alpha).
inline constexpr double kTolerance = 2e-6;

inline TonemapOptions hable() { return {.op = resolve_picture_operator("hable")}; }

inline ReferenceEngine reference(const TonemapOptions& o) {
    // The pictures here say nothing of their color.
    const std::string input = o.input == kAutoInput ? "lin_rec709" : o.input;
    return ReferenceEngine(build_view(make_view(o.op, input, o.exposure_stops, o.display)));
}

inline void expect_error(OIIO::ImageBuf& dst, bool ok, const std::string& part) {
    EXPECT_FALSE(ok);
    ASSERT_TRUE(dst.has_error());
    const std::string message = dst.geterror();
    EXPECT_NE(message.find(part), std::string::npos) << message;
    EXPECT_TRUE(message.starts_with("tonemap: ")) << message;
    EXPECT_EQ(message.find('\n'), std::string::npos) << message;
}

TONEWRIGHT_NAMESPACE_END
