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
#include "tonewright/view.h"

/// Tone mapping of OpenImageIO images.
///
/// tonemap() follows the conventions of ImageBufAlgo, errors included; the other functions of this
/// header throw, as the rest of Tonewright does.
TONEWRIGHT_NAMESPACE_BEGIN

/// The input of a picture that says itself what it is. @see TonemapOptions::input
inline constexpr std::string_view kAutoInput = "auto";

/// What a picture is tone mapped with. Names and texts are those of the command line.
struct TonemapOptions {
    /// What to do with color that may be multiplied by alpha. A curve needs the color alone.
    enum class Unpremult : unsigned char {
        /// As the picture says: divide, unless its `oiio:UnassociatedAlpha` is set.
        automatic,
        /// Divide by alpha before, multiply after.
        yes,
        /// Leave color as it is.
        no,
    };
    /// What operators with parameters that a picture has (its largest luminance, ...) take for
    /// those that neither `settings` nor the preset set.
    enum class Statistics : unsigned char {
        /// The picture's own, of measure_scene(): one more pass over it. Other operators pay
        /// nothing.
        from_picture,
        /// The defaults, the same for every picture.
        defaults,
    };

    /// Operator id, optionally `:preset`. Local operators are welcome (local.h).
    std::string op;
    /// Operator parameters, name -> text.
    Settings settings = {};
    /// Look id of the operator, or empty.
    std::string look = {};
    /// Exposure before the operator, in stops, [-64, 64].
    double exposure_stops = 0;
    /// What the source's numbers are: a name that find_source_color() knows, or `auto`: what the
    /// picture says. That is its `oiio:ColorSpace` (sRGB and other code values are decoded first),
    /// where it is another one than the linear Rec.709 that readers presume; else `colorInteropID`;
    /// else ACES2065-1 where `acesImageContainerFlag` is set; else linear light of its
    /// `chromaticities`; else linear Rec.709.
    std::string input = std::string(kAutoInput);
    /// Display (id, title or alias), or `linear`, or `native`.
    std::string display = "srgb";
    /// What an HDR display shows light 1 at, cd/m2, [50, 1000].
    double reference_white = kReferenceWhite;
    Unpremult unpremult = Unpremult::automatic;
    /// Files of 8 bits get noise of half a code value against bands: `oiio:dither`, which OIIO's
    /// writers follow.
    bool dither = false;
    Statistics statistics = Statistics::from_picture;
    /// Operators that `op` may name beside the built-in ones, and what reads LUTs.
    OperatorSet others = {};
};

/// Measures the light of a picture, for the operators whose parameters a picture has.
///
/// Relative luminance (0.2126, 0.7152, 0.0722) and channels of Rec.709 light, each pixel as
/// tonemap() sees it: NaN is 0, limited to +-65504, converted from `input`, negatives 0. Exposure
/// plays no part: it stays the user's correction on top of what the statistics choose.
///
/// Where alpha counts (`unpremult` is not `no`), color is that of tonemap(), and pixels without
/// cover (alpha 0 or not finite) are left out; a picture without any cover is measured as it is.
///
/// @param src       any pixel type, tiled, cached or local.
/// @param input     @see TonemapOptions::input
/// @param roi       default: the data window. Channels of it are not read.
/// @param nthreads  0: OIIO's `threads` attribute. The result does not depend on it, in any bit.
/// @returns         zeros for a picture without light.
/// @throws Error    unknown input; a picture that cannot be read, is deep, or has no color.
[[nodiscard]] TONEWRIGHT_API SceneStatistics
measure_scene(const OIIO::ImageBuf& src, std::string_view input = kAutoInput,
              TonemapOptions::Unpremult unpremult = TonemapOptions::Unpremult::automatic,
              OIIO::ROI roi = {}, int nthreads = 0);

/// A view made ready to run on pictures: compiled once for each kind of source color, at its first
/// picture, and used for every frame of a shot. Safe to use from several threads at once, on
/// different destinations.
///
/// An operator that takes statistics takes those of each picture. Where live_statistics()
/// (engine.h) has them as uniforms, all pictures share one program, and the pixels keep to the
/// operator's bound; else each picture has its own. A shot would flicker: give it the statistics of
/// one frame, with_statistics(measure_scene(frame)).
class TONEWRIGHT_API Tonemapper {
  public:
    /// @throws Error  unknown name or bad value among the options, with the nearest name.
    explicit Tonemapper(const TonemapOptions& options);
    ~Tonemapper();
    Tonemapper(Tonemapper&&) noexcept;
    Tonemapper& operator=(Tonemapper&&) noexcept;

    [[nodiscard]] const TonemapOptions& options() const noexcept;
    /// Some of the operator's parameters are each picture's own.
    [[nodiscard]] bool takes_statistics() const noexcept;
    /// The operator is a local one: a pixel's surroundings count.
    [[nodiscard]] bool needs_whole_picture() const noexcept;
    /// The same for all pictures that have these statistics. Compiles nothing where all statistics
    /// of the operator are live, else once.
    /// @throws Error  statistics that are no values of the operator's parameters
    [[nodiscard]] Tonemapper with_statistics(const SceneStatistics& statistics) const;
    /// The same at another exposure, in stops, [-64, 64]. Takes microseconds, and so does the
    /// first picture: within 16 stops up or down, a view is compiled once for all exposures but 0,
    /// and once without exposure. Beyond, and where an operator takes statistics that are not live
    /// from each picture, it is compiled anew at the first picture. The pixels are those of a
    /// Tonemapper that was made with this exposure.
    /// @throws Error  out of that interval
    [[nodiscard]] Tonemapper with_exposure(double stops) const;

    /// Same contract as tonemap(dst, src, ...).
    bool operator()(OIIO::ImageBuf& dst, const OIIO::ImageBuf& src, OIIO::ROI roi = {},
                    int nthreads = 0, OIIO::ProgressCallback progress = nullptr,
                    void* progress_data = nullptr) const noexcept;

  private:
    struct State;
    explicit Tonemapper(std::unique_ptr<const State> state);
    std::unique_ptr<const State> state_;
};

/// Tone maps `src` into `dst`, with the calling convention of ImageBufAlgo.
///
/// 1. Channels go by position, not by name. The first three are color, of `options.input`;
/// `spec().alpha_channel` is alpha; all others are copied, bit for bit where
///    the two pixel types are the same. (A picture that has red elsewhere: `oiiotool --ch
///    R,G,B,A`.)
/// 2. One channel is gray, R = G = B; so is the first of two when the second is alpha. A gray
/// picture
///    stays gray where the view shows grays as grays, else it becomes R, G, B (, A).
/// 3. Associated color is divided by alpha first and multiplied by it last (`options.unpremult`).
///    Where alpha is 0, or not finite, color is taken as it is: light without cover, such as a
///    flame, stays.
/// 4. NaN is 0 and every channel is limited to +-65504 before the view; the result is finite.
/// 5. Statistics are those of the whole source, whatever the region: parts that are rendered one by
///    one fit together. (Not in place: there the source changes under them, and so does what it
///    says of its color. Measure first, and name the input.)
/// 6. `dst` says what it holds: `oiio:ColorSpace` as OIIO names it ("sRGB", "Gamma2.4" for
/// Rec.1886,
///    "Linear"), else the display's title; no claim for `native`, unless the operator's output is
///    plainly linear or a power of Rec.709. Profiles, gammas and primaries that contradict it go;
///    `chromaticities` is set where the result is not Rec.709.
///
/// 7. A local operator (local.h) looks at the whole data window, whatever the region: regions fit
///    together. It holds three floats a pixel and some more in memory. Volumes are refused.
///
/// @param dst       uninitialized: becomes a float image of the ROI's size with the source's
/// metadata.
///                  Initialized: keeps its size and pixel type (integers are rounded and clamped as
///                  OIIO does), and only the pixels and channels of the ROI are written; a gray
///                  source fills the first three channels of a destination that has them. May be
///                  `src`.
/// @param src       any pixel type, tiled, cached or local. Outside its data window it is black.
/// Deep
///                  images are refused.
/// @param roi       default: all. `[chbegin, chend)` counts the source's channels and must contain
///                  its color.
/// @param nthreads  0: OIIO's `threads` attribute. The result does not depend on it.
/// @param progress  called with `progress_data` and the part that is done, (0, 1], about a hundred
///                  times, from one thread at a time, which may be one of OIIO's. What it returns
///                  true for is to stop: an error, "cancelled", with some of the pixels written.
/// @returns         false when something is wrong; then `dst` has the error, in one line, and its
///                  pixels are as they were unless reading `src` failed half way. Never throws.
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
/// pixel types, regions and threads as in tonemap(). A gray picture becomes one in color. `dst`
/// makes no claim about its colors.
///
/// @param map  interleaved RGB, `count` colors from `in` to `out`, which are not the same memory;
///             called from several threads at once. What it throws is the error of `dst`.
/// @returns    false when something is wrong; then `dst` has the error.
TONEWRIGHT_API bool map_colors(
    OIIO::ImageBuf& dst, const OIIO::ImageBuf& src,
    const std::function<void(const float* in, float* out, std::size_t count)>& map,
    TonemapOptions::Unpremult unpremult = TonemapOptions::Unpremult::automatic, OIIO::ROI roi = {},
    int nthreads = 0) noexcept;

/// Tone maps a file into a file: read_image(), tonemap() and write_image_atomically() at once, with
/// the same result to the last byte, in the memory of some rows. One subimage of it (a part of an
/// OpenEXR file, a page): parts are seldom all of them color. A picture without a date gets that
/// of the environment variable SOURCE_DATE_EPOCH, else its file's (UTC), or some formats would put
/// in the time: made again, the result is the same.
///
/// Rows are read, tone mapped and written at the same time. An operator that takes statistics reads
/// the file twice. Volumes, and the pictures of local operators, are held in memory as a whole.
/// `out` may be `in`.
///
/// @param type      @see write_image_atomically
/// @param nthreads  0: OIIO's `threads` attribute. 1: one step after the other in the calling
///                  thread (OpenEXR has threads of its own: OIIO's `exr_threads` attribute).
/// @throws FileError  @see read_image, write_image_atomically; a picture that cannot be tone mapped
TONEWRIGHT_API void tonemap_file(const Tonemapper& tonemapper, const std::string& in,
                                 const std::string& out,
                                 const OIIO::TypeDesc& type = OIIO::TypeUnknown, int nthreads = 0,
                                 int subimage = 0);
TONEWRIGHT_API void tonemap_file(const Tonemapper& tonemapper, const std::string& in,
                                 const std::string& out, const WriteOptions& options,
                                 int nthreads = 0, int subimage = 0,
                                 double max_pixels = kMaxPixels);

TONEWRIGHT_NAMESPACE_END
