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
    /// Leaves out pixels whose alpha is 0 or not finite. If no pixel is left (a channel that was
    /// never written, or emission only), a second pass ignores alpha.
    enum class Cover : unsigned char { counts, ignored };
    static constexpr std::array kTries = {Cover::counts, Cover::ignored};
    /// Statistics only, which is faster.
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
    /// True if some pixels have an alpha that is finite and not 0.
    [[nodiscard]] bool has_cover() const;
    [[nodiscard]] SceneStatistics statistics() const;
    [[nodiscard]] Metering metering() const;

  private:
    struct State;
    std::unique_ptr<State> state_;
};

/// Passes all parts of a picture to a meter. Called again if alpha must be ignored.
using PicturePass = std::function<void(SceneMeter&)>;
[[nodiscard]] TONEWRIGHT_API SceneMeter measure_picture(const OIIO::ImageSpec& spec,
                                                        const MeterOptions& options,
                                                        SceneMeter::Figures figures, int nthreads,
                                                        const PicturePass& pass);

/// Options that read a picture as tonemap() with these options does: color, alpha, units and white.
[[nodiscard]] TONEWRIGHT_API MeterOptions meter_options(const TonemapOptions& options);

/// Meters a file, or the rows of a region of it.
/// @throws Error  without the file's name, unless it is a FileError
[[nodiscard]] TONEWRIGHT_API SceneMeter measure_file(const std::string& path,
                                                     const MeterOptions& options,
                                                     SceneMeter::Figures figures, int nthreads,
                                                     std::size_t batch_bytes = kBatchBytes);

TONEWRIGHT_NAMESPACE_END
