// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <OpenImageIO/imagebuf.h>

#include <array>
#include <memory>
#include <string_view>

#include "tonewright/image.h"

namespace tonewright {

/// measure_scene() of a picture that comes in parts, from top to bottom: the same to the last bit.
class SceneMeter {
  public:
    /// Whether pixels without cover are left out. Where that leaves none (a channel that was never
    /// written, or light alone), a second pass ignores cover.
    enum class Cover : unsigned char { counts, ignored };
    static constexpr std::array kTries = {Cover::counts, Cover::ignored};

    /// @param spec    of the picture
    /// @throws Error  unknown space; no color
    SceneMeter(const OIIO::ImageSpec& spec, std::string_view input,
               TonemapOptions::Unpremult unpremult, Cover cover, int nthreads);
    ~SceneMeter();
    SceneMeter(const SceneMeter&) = delete;
    SceneMeter& operator=(const SceneMeter&) = delete;

    /// @throws Error  the pixels cannot be read.
    void add(const OIIO::ImageBuf& picture, const OIIO::ROI& roi);
    /// Some pixels counted.
    [[nodiscard]] bool has_cover() const;
    [[nodiscard]] SceneStatistics statistics() const;

  private:
    struct State;
    std::unique_ptr<State> state_;
};

}  // namespace tonewright
