// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <memory>
#include <optional>

#include "tonewright/engine.h"
#include "tonewright/registry.h"
#include "tonewright/view.h"

TONEWRIGHT_NAMESPACE_BEGIN

/// True for exposures that a program takes as a number. Those beyond 16 stops, and exposure 0, have
/// their own programs.
[[nodiscard]] bool is_live_exposure(double stops);

/// @throws Error  a share of the operator outside [0, 1], or of a view that cannot be blended
void check_mix(double share, const View& view);

/// The programs that the pixels of a picture pass.
class PreparedView {
  public:
    /// A program for all live exposures, unless the view's own is fixed, and for all live
    /// statistics. Their values are not set.
    /// @param mix  share of the operator; the rest is a plain clamp of the same view
    PreparedView(View v, const LiveUniforms& statistics, double mix);
    /// The same program with the values of a view that it serves.
    PreparedView(const PreparedView& program, View v);

    /// True if a gray picture stays gray, at all live exposures.
    [[nodiscard]] TONEWRIGHT_API bool keeps_gray() const;

    View view;
    LiveUniforms uniforms;
    SimdEngine engine;
    /// With a local operator: the stages before it. `engine` has those after it.
    std::optional<SimdEngine> to_light;

  private:
    enum class Known : unsigned char { nothing, no, yes };
    std::shared_ptr<std::atomic<Known>> keeps_gray_ =
        std::make_shared<std::atomic<Known>>(Known::nothing);

    [[nodiscard]] UniformValues values() const;
};

TONEWRIGHT_NAMESPACE_END
