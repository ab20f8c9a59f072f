// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <OpenImageIO/imagebuf.h>
#include <OpenImageIO/imageio.h>

#include <array>
#include <cstddef>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "tonewright/error.h"
#include "tonewright/image_io.h"
#include "tonewright/registry.h"
#include "tonewright/tonemap_options.h"
#include "tonewright/view.h"

/// Tone mapping of OpenImageIO images.
///
/// tonemap() and map_colors() follow the conventions of ImageBufAlgo, also for errors. The other
/// functions of this header throw, as the rest of Tonewright does.
TONEWRIGHT_NAMESPACE_BEGIN

/// Measures the statistics of a picture, for operators whose parameters come from it.
///
/// Relative luminance (0.2126, 0.7152, 0.0722) and channels of Rec.709 light, for each pixel as in
/// tonemap(), before exposure and without its limit: NaN becomes 0, infinities become +-65504,
/// channels are converted from `input`, negatives become 0.
///
/// If alpha counts (`unpremult` is not `no`), color is un-premultiplied as in tonemap() at exposure
/// 0, and pixels whose alpha is 0 or not finite are left out. If all are, the picture is measured
/// as it is.
///
/// @param src       any pixel type, tiled, cached or local
/// @param input     @see TonemapOptions::input
/// @param roi       default: the data window. Its channels are ignored.
/// @param nthreads  0: OIIO's `threads` attribute. Threads change no bit of the result.
/// @returns         zeros for a black picture
/// @throws Error    unknown input; a picture that cannot be read, is deep, or has no color
[[nodiscard]] TONEWRIGHT_API SceneStatistics
measure_scene(const OIIO::ImageBuf& src, std::string_view input = kAutoInput,
              TonemapOptions::Unpremult unpremult = TonemapOptions::Unpremult::automatic,
              OIIO::ROI roi = {}, int nthreads = 0);
/// The same, of a picture as tonemap() reads it with these options: color, alpha, units and white.
[[nodiscard]] TONEWRIGHT_API SceneStatistics measure_scene(const OIIO::ImageBuf& src,
                                                           const TonemapOptions& options,
                                                           OIIO::ROI roi = {}, int nthreads = 0);

class RowTonemapper;  // of Tonewright's own files

/// A view that is ready to run on pictures. It is compiled once for each source color, at the first
/// picture, and serves every frame of a shot. Safe to use from several threads at once, on
/// different destinations.
///
/// An operator that takes statistics takes those of each picture. They are uniforms
/// (live_statistics() in engine.h), so all pictures share one program, and errors stay within the
/// operator's bound; where they are not, each picture has a program of its own. A shot would
/// flicker: give it the statistics of one frame, with_statistics(measure_scene(frame)).
class TONEWRIGHT_API Tonemapper {
  public:
    /// @throws Error  unknown name or bad value among the options, with the nearest name; no
    /// operator
    explicit Tonemapper(const TonemapOptions& options);
    ~Tonemapper();
    Tonemapper(Tonemapper&&) noexcept;
    Tonemapper& operator=(Tonemapper&&) noexcept;

    [[nodiscard]] const TonemapOptions& options() const noexcept;
    /// True if some of the operator's parameters come from each picture.
    [[nodiscard]] bool takes_statistics() const noexcept;
    /// True for a local operator, which maps a pixel by its surroundings.
    [[nodiscard]] bool needs_whole_picture() const noexcept;
    /// The same with fixed statistics for all pictures. Compiles nothing if all statistics of the
    /// operator are live, as those of built-in operators are, otherwise once.
    /// @throws Error  statistics that are outside the intervals of the operator's parameters
    [[nodiscard]] Tonemapper with_statistics(const SceneStatistics& statistics) const;
    /// The same at another exposure, in stops, [-64, 64]. Takes microseconds, also for the first
    /// picture: within 16 stops, a view is compiled once for exposure 0 and once for all others.
    /// Beyond 16 stops, the first picture compiles it again. The pixels are those of a Tonemapper
    /// that was made with this exposure.
    /// @throws Error  an exposure outside that interval
    [[nodiscard]] Tonemapper with_exposure(double stops) const;

    /// Same contract as tonemap(dst, src, ...).
    bool operator()(OIIO::ImageBuf& dst, const OIIO::ImageBuf& src, OIIO::ROI roi = {},
                    int nthreads = 0, OIIO::ProgressCallback progress = nullptr,
                    void* progress_data = nullptr) const noexcept;
    /// The same, with exceptions instead of messages.
    /// @throws Error  of kind `canceled` where `progress` stops it
    void run(OIIO::ImageBuf& dst, const OIIO::ImageBuf& src, OIIO::ROI roi = {}, int nthreads = 0,
             OIIO::ProgressCallback progress = nullptr, void* progress_data = nullptr) const;

  private:
    struct State;
    friend const RowTonemapper& rows_of(const Tonemapper& tonemapper);
    explicit Tonemapper(std::unique_ptr<const State> state);
    std::unique_ptr<const State> state_;
};

/// Tone maps `src` into `dst`, with the calling convention of ImageBufAlgo.
///
/// 1. Channels are identified by position, not by name. The first three are color in
///    `options.input`, `spec().alpha_channel` is alpha, and all others are copied, bit for bit if
///    both pixel types are the same. (`oiiotool --ch R,G,B,A` reorders the channels of other
///    pictures.)
/// 2. One channel is gray, R = G = B; so is the first of two if the second is alpha. A gray picture
///    stays gray if the view keeps gray neutral; otherwise it becomes R, G, B (, A).
/// 3. Associated color is un-premultiplied first and premultiplied last (`options.unpremult`).
///    Color of pixels whose alpha is 0 or not finite is taken as it is, because it represents
///    emission. The same holds for light far above what alpha carries, such as flames and glass:
///    divided, it would become white, and then nearly black. Let m be the largest channel,
///    A = alpha, and L = 16 2^-exposure the most light of a surface. Where m <= L A, or A >= 1, the
///    divisor is A. Elsewhere it is A + (1 - A) (1 - L A / m), which is continuous in color and
///    alpha, and approaches 1 as alpha approaches 0.
/// 4. NaN becomes 0, and every channel is limited to +-65504 after the exposure. The result is
///    finite.
/// 5. Statistics are those of the whole source, for every region, so regions that are rendered one
///    by one match. (This does not hold in place, because the source and its metadata change.
///    Measure first, and name the input.)
/// 6. The metadata of `dst` states its color: `oiio:ColorSpace` by OIIO's names ("sRGB", "Gamma2.4"
///    for Rec.1886, "Linear"), or else the display's title. `native` has none, unless the
///    operator's output is linear or a power of Rec.709. Contradicting profiles, gammas, primaries
///    and gain maps are removed. `chromaticities` is set if the result is not Rec.709.
///    `colorInteropID` is set where the Color Interop Forum has an identifier, otherwise
///    `tonewright:display`: a name that `input` accepts.
/// 7. A local operator (local.h) reads the whole data window for every region, so regions match. It
///    needs somewhat more than three floats a pixel of memory. Volumes are refused.
///
/// @param dst       Uninitialized: becomes a float image of the ROI's size with the source's
///                  metadata. Initialized: keeps its size and pixel type (OIIO's rounding and
///                  clamping of integers), and only the pixels and channels of the ROI are written.
///                  A gray source fills the first three channels of a destination that has them.
///                  May be `src`.
/// @param src       any pixel type, tiled, cached or local. Outside its data window it is black.
///                  Deep images are refused.
/// @param roi       default: all. `[chbegin, chend)` counts the source's channels and must contain
///                  its color.
/// @param nthreads  0: OIIO's `threads` attribute. The result does not depend on it.
/// @param progress  called with `progress_data` and the fraction done, (0, 1], about 100 times,
///                  from one thread at a time, which may be one of OIIO's. If it returns true, the
///                  work stops: the error is "canceled", and some of the pixels are written.
/// @returns         false on failure. Then `dst` has the error, in one line, and its pixels are
///                  unchanged unless reading `src` failed half way. Never throws.
TONEWRIGHT_API bool tonemap(OIIO::ImageBuf& dst, const OIIO::ImageBuf& src,
                            const TonemapOptions& options, OIIO::ROI roi = {}, int nthreads = 0,
                            OIIO::ProgressCallback progress = nullptr,
                            void* progress_data = nullptr) noexcept;
/// Returns the result as a new float image; on failure one with has_error().
[[nodiscard]] TONEWRIGHT_API OIIO::ImageBuf tonemap(const OIIO::ImageBuf& src,
                                                    const TonemapOptions& options,
                                                    OIIO::ROI roi = {}, int nthreads = 0,
                                                    OIIO::ProgressCallback progress = nullptr,
                                                    void* progress_data = nullptr) noexcept;

/// Runs the colors of a picture through a function, such as a LUT of lut_file.h: channels, alpha,
/// pixel types, regions and threads as in tonemap(). A gray picture becomes one in color. The
/// metadata of `dst` states no color.
///
/// @param map  maps `count` colors from `in` to `out`, interleaved RGB in different memory. Called
///             from several threads at once. Its exceptions become the error of `dst`.
/// @returns    false on failure; then `dst` has the error.
TONEWRIGHT_API bool map_colors(
    OIIO::ImageBuf& dst, const OIIO::ImageBuf& src,
    const std::function<void(const float* in, float* out, std::size_t count)>& map,
    TonemapOptions::Unpremult unpremult = TonemapOptions::Unpremult::automatic, OIIO::ROI roi = {},
    int nthreads = 0) noexcept;

/// Tone maps a file to a file. The result equals that of read_image(), tonemap() and
/// write_image_atomically() to the last byte (to OpenEXR, with the pixel type of the source:
/// WriteOptions::type), but needs memory for some rows only. A picture that lies on its side
/// (`Orientation`) is turned if the format of `out` has no such tag (all but JPEG and TIFF), which
/// needs memory for all of it. A picture without a date gets that of the environment variable
/// SOURCE_DATE_EPOCH, else its file's (UTC). Some formats would record the current time, and a
/// second run would give other bytes.
///
/// Rows are read, tone mapped and written at the same time. An operator that takes statistics reads
/// the file twice. Volumes and the pictures of local operators are read into memory. `out` may be
/// `in`.
///
/// @param type      @see WriteOptions::type
/// @param nthreads  0: OIIO's `threads` attribute. 1: one step after the other in the calling
///                  thread (OpenEXR has threads of its own: OIIO's `exr_threads` attribute).
/// @throws FileError  @see read_image, write_image_atomically; a picture that cannot be tone mapped
TONEWRIGHT_API void tonemap_file(const Tonemapper& tonemapper, const std::string& in,
                                 const std::string& out,
                                 const OIIO::TypeDesc& type = OIIO::TypeUnknown, int nthreads = 0);
TONEWRIGHT_API void tonemap_file(const Tonemapper& tonemapper, const std::string& in,
                                 const std::string& out, const WriteOptions& write,
                                 const ReadOptions& read = {}, int nthreads = 0);

TONEWRIGHT_NAMESPACE_END
