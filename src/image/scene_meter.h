// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <OpenImageIO/imagebuf.h>

#include <array>
#include <functional>
#include <memory>

#include "image/picture_file.h"
#include "tonewright/meter.h"

TONEWRIGHT_NAMESPACE_BEGIN

/// meter() and measure_scene() of a picture that comes in parts, from top to bottom: the same to
/// the last bit.
class TONEWRIGHT_API SceneMeter {
  public:
    /// Whether pixels without cover are left out. Where that leaves none (a channel that was never
    /// written, or light alone), a second pass ignores cover.
    enum class Cover : unsigned char { counts, ignored };
    static constexpr std::array kTries = {Cover::counts, Cover::ignored};
    /// Statistics alone cost less.
    enum class Figures : unsigned char { statistics, all };

    /// @param spec    of the picture
    /// @throws Error  unknown space; no color
    SceneMeter(const OIIO::ImageSpec& spec, const MeterOptions& options, Cover cover,
               Figures figures, int nthreads);
    ~SceneMeter();
    SceneMeter(SceneMeter&&) noexcept;
    SceneMeter& operator=(SceneMeter&&) noexcept;

    /// @throws Error  the pixels cannot be read.
    void add(const OIIO::ImageBuf& picture, const OIIO::ROI& roi);
    /// Some pixels have cover.
    [[nodiscard]] bool has_cover() const;
    [[nodiscard]] SceneStatistics statistics() const;
    [[nodiscard]] Metering metering() const;

  private:
    struct State;
    std::unique_ptr<State> state_;
};

/// Hands all parts of a picture to a meter. Called again where cover has to be ignored.
using PicturePass = std::function<void(SceneMeter&)>;
[[nodiscard]] TONEWRIGHT_API SceneMeter measure_picture(const OIIO::ImageSpec& spec,
                                                        const MeterOptions& options,
                                                        SceneMeter::Figures figures, int nthreads,
                                                        const PicturePass& pass);

/// Of a file, or of the rows of a region of it.
/// @throws Error  without the file's name, but for FileError
[[nodiscard]] TONEWRIGHT_API SceneMeter measure_file(const std::string& path,
                                                     const MeterOptions& options,
                                                     SceneMeter::Figures figures, int nthreads,
                                                     std::size_t batch_bytes = kBatchBytes);

TONEWRIGHT_NAMESPACE_END
