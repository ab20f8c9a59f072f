// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "tonewright/definition.h"
#include "tonewright/input_encoding.h"
#include "tonewright/view.h"

TONEWRIGHT_NAMESPACE_BEGIN

/// `cube` (Adobe and Resolve), `clf` (Academy S-2014-006), `ctf` (Autodesk's variant of it),
/// `spi1d`, `spi3d` (Sony Imageworks), `csp` (cineSpace: takes scene-linear input, which its prelut
/// encodes), `resolve_cube` (a .cube with a 1D table before the 3D LUT; takes scene-linear input),
/// `3dl` (Autodesk: integers), `lut` (Houdini), `icc` (ICC device link), `hald` (a Hald CLUT
/// picture), `strip` (a picture of n slices of n x n side by side, green down), `strip_up` (the
/// same, green up), `raw` (float32, little-endian, RGB triplets, red fastest).
enum class LutFormat : unsigned char {
    cube,
    clf,
    ctf,
    spi1d,
    spi3d,
    csp,
    resolve_cube,
    threedl,
    houdini,
    icc,
    hald,
    strip,
    strip_up,
    raw,
    ktx2
};
/// @throws Error with the nearest name.
[[nodiscard]] TONEWRIGHT_API LutFormat parse_lut_format(std::string_view text);
[[nodiscard]] TONEWRIGHT_API std::vector<std::string> lut_format_names();
[[nodiscard]] TONEWRIGHT_API std::string name_of(LutFormat format);
/// True for `strip` and `strip_up`.
[[nodiscard]] TONEWRIGHT_API bool is_strip(LutFormat format);
/// True for layouts of pictures, which OpenImageIO writes.
[[nodiscard]] TONEWRIGHT_API bool is_picture_format(LutFormat format);
/// True if the LUT takes scene-linear input, which a 1D table before the 3D LUT encodes.
[[nodiscard]] TONEWRIGHT_API bool has_shaper(LutFormat format);

/// Interpolation of 3D LUTs; 1D tables are linear. Automatic: as the file says (CLF and CTF),
/// otherwise tetrahedral.
enum class LutInterpolation : unsigned char { automatic, tetrahedral, trilinear };

enum class LutDimension : unsigned char { automatic, one, three };

/// A LUT to bake.
struct LutRequest {
    View view;
    InputEncoding encoding;
    LutFormat format = LutFormat::cube;
    LutDimension dimension = LutDimension::automatic;
    /// Entries of a 1D table (2..65536), or grid points a side of a 3D LUT (17..129; `3dl`: 17, 33
    /// or 65; `hald`: a square of 16..144; strips: 2..64; `raw`: 2..129).
    std::optional<int> size;
    /// Bits of a value: 8 or 16 in pictures, 10, 12 or 16 in `3dl`, 16 in `icc`. 32: float.
    std::optional<int> bits;
    /// Version of the ICC specification: 2 (more programs read it) or 4.
    int icc_version = 2;
    /// Decimals of the numbers in a `cube`, [3, 9]; default: all digits of a float. Four decimals
    /// add at most 5e-5, less than the interpolation error of 33 points a side, and halve the file.
    std::optional<int> decimals;
};

/// A baked LUT. 1D: `size` entries of `channels` values. 3D: size^3 RGB triplets, red fastest.
/// Half-domain: 65536 entries in the order of the half floats' bit patterns.
struct Lut {
    int dimension = 3;
    int size = 33;
    int channels = 3;
    bool is_half_domain = false;
    std::vector<float> values;
    /// Decimals of the rounded values. @see LutRequest::decimals
    std::optional<int> decimals = {};
};

/// Difference between a LUT and the double reference on colors as photographs and renders contain
/// them, up to the brightest light of the LUT's input: in code values of a display, light in those
/// of sRGB.
struct PhotographError {
    /// 99.9 % of the pixels have at most this error.
    double p999 = 0;
    double mean = 0;
    /// Share of the pixels whose error is more than a code of 8 bits, [0, 1].
    double share = 0;
    /// Share of the pixels of photographs that are brighter than the input can be or outside its
    /// primaries; they are left out.
    double outside = 0;
    /// The color that contributes most beyond `p999`: "+3.4 stops, saturated blue".
    std::string worst;
};

/// "99.9 % within 6.2 codes of 255, mean 0.43, 10 % of the pixels more than one off, most at +0.7
/// stops, saturated red".
[[nodiscard]] TONEWRIGHT_API std::string to_string(const PhotographError& error);

/// Difference between a LUT, interpolated as its readers do, and the double reference: in code
/// values for a display, in the operator's numbers for `linear` and `native`.
struct LutError {
    /// Over all colors of the input range: for a 3D LUT, a search starts at the worst samples. The
    /// other figures are those of the samples.
    double max = 0;
    double p999 = 0;
    double mean = 0;
    /// dE_ITP (ITU-R BT.2124), 0 without a display.
    double delta_e_max = 0;
    double delta_e_p999 = 0;
    double delta_e_mean = 0;
    std::string interpolation;
    PhotographError photographs = {};
};

/// A LUT whose nodes are samples of the view.
/// @throws Error  a 3D LUT of linear input (it would clip and band); a 1D table of a view that
///                mixes channels; a size out of range; a format without that dimension
[[nodiscard]] TONEWRIGHT_API Lut sample_lut(const LutRequest& request);

/// A 3D LUT whose nodes are fitted for the least error between them. It is not always nearer to the
/// view than a sampled one: measure both.
/// @param sampled           the result of sample_lut()
/// @param photograph_share  share of the colors that come from photographs, [0, 1]
/// @param constrain         changes nodes as little as possible so that they meet bounds; called
///                          between steps of the fit and at its end
/// @throws Error            for a 1D table
[[nodiscard]] TONEWRIGHT_API Lut fit_lut(const LutRequest& request, const Lut& sampled,
                                         double photograph_share = 0,
                                         const std::function<void(Lut&)>& constrain = {});

/// Output of the LUT for its input `rgb` in [0, 1] (for a half-domain table: scene-linear).
[[nodiscard]] TONEWRIGHT_API Vector3
interpolate(const Lut& lut, const Vector3& rgb,
            LutInterpolation interpolation = LutInterpolation::automatic);

/// Measures on the standard sample set inside the encoding's range, and on random inputs of the
/// LUT. A shaper is resampled as its readers do.
[[nodiscard]] TONEWRIGHT_API LutError
measure_lut(const Lut& lut, const LutRequest& request,
            LutInterpolation interpolation = LutInterpolation::automatic);

/// Behavior of a 3D LUT along rays of rising exposure: the lamps and hues of the test chart (pure
/// and half-saturated hues, the primaries and secondaries of Rec.709, P3 and Rec.2020), from -12 to
/// +12 stops, inside the encoding's range.
///
/// A 3D LUT rings where a clip or a kink of the operator cuts through grid cells: between the
/// nodes, a channel rises and falls although the operator's does not. A lamp then gets rings.
struct LutRinging {
    /// The largest fall of a channel on a ray, minus the operator's own fall between the same
    /// exposures. In code values; for `linear`, those of sRGB.
    double fall = 0;
    /// 99.9th percentile of the errors along the rays, in the same unit.
    double p999 = 0;
    /// The end of the largest fall.
    std::string color;    // "blue of Rec.2020"
    std::string channel;  // "red"
    double stops = 0;     // from 0.18
};
/// Two 8-bit codes: a LUT with a larger fall rings.
inline constexpr double kLargestFall = 2.0 / 255;
/// A LUT with a larger `p999` does not follow the operator in saturated light.
inline constexpr double kLargestRayError = 0.02;
/// A 1D table never rings.
[[nodiscard]] TONEWRIGHT_API LutRinging
measure_ringing(const Lut& lut, const LutRequest& request,
                LutInterpolation interpolation = LutInterpolation::automatic);
[[nodiscard]] TONEWRIGHT_API bool rings(const LutRinging& ringing);
/// True if the LUT does not ring, and its errors along the rays are within kLargestRayError.
[[nodiscard]] TONEWRIGHT_API bool follows_operator(const LutRinging& ringing);
/// "red falls by 0.19 at +9.4 stops of blue of Rec.2020".
[[nodiscard]] TONEWRIGHT_API std::string to_string(const LutRinging& ringing);

/// Stops beyond the end of an encoding where the operator still changes: by more than one 10-bit
/// code (with `linear` and `native`: 1/1023) from its value at the end. Measured on grays, and
/// above the range also on the six saturated colors of Rec.709.
struct ClippedStops {
    /// Stops from 0.18: the end of the encoding, and the last visible change.
    double end = 0;
    double last = 0;
    /// The largest difference.
    double error = 0;
};
struct LutClipping {
    std::optional<ClippedStops> below;
    std::optional<ClippedStops> above;
};
/// A half-domain table never clips.
[[nodiscard]] TONEWRIGHT_API LutClipping measure_clipping(const LutRequest& request,
                                                          const Lut& lut);
/// "above +6.50 stops from 0.18, up to +9.25, by up to 3.1e-02; below -10.00 stops, down to black,
/// by up to 1.8e-03"; empty if nothing is clipped.
[[nodiscard]] TONEWRIGHT_API std::string to_string(const LutClipping& clipping);

/// Values of the nodes of a 3D LUT.
enum class LutNodes : unsigned char {
    /// The nearest to the operator on photographs of those that do not ring: fitted to the colors
    /// of photographs, or sampled. Rings are taken out where photographs have no colors.
    automatic,
    sampled,
    fitted,
    /// Sampled or fitted, and changed as little as needed to follow the operator along the rays of
    /// LutRinging, also where photographs get worse.
    smooth
};

struct BakedLut {
    Lut lut;
    LutError error;
    /// Error of a 3D LUT with the other interpolation.
    std::optional<LutError> other_error;
    bool is_fitted = false;
    /// With the interpolation of `error`.
    LutRinging ringing = {};
};

/// A LUT, rounded as its format requires, and its error.
/// @param interpolation  that of its reader
/// @param max_error  instead of a size: the smallest of 17, 25, 33, 49, 65, 97 and 129 points a
///                   side (those that the format allows) with at most this PhotographError::p999
/// @param largest_size  of those sizes
/// @throws Error  as sample_lut(); both a size and a max_error; no size meets max_error
[[nodiscard]] TONEWRIGHT_API BakedLut
bake_lut(const LutRequest& request, LutNodes nodes = LutNodes::automatic,
         LutInterpolation interpolation = LutInterpolation::automatic,
         std::optional<double> max_error = std::nullopt, int largest_size = 129);

/// Rounds the values as the format requires: to integers of LutRequest::bits, or to
/// LutRequest::decimals.
TONEWRIGHT_API void quantize(Lut& lut, const LutRequest& request);

/// The contents of the file; not for pictures. A header states the operator, the input, clipping,
/// the output, the measured errors, ringing, and a hash of the numbers. The numbers follow with 9
/// significant digits (enough for every float), without exponents.
/// @param other_error  of a 3D LUT: with the other interpolation
[[nodiscard]] TONEWRIGHT_API std::string write_lut(
    const Lut& lut, const LutRequest& request, const LutError& error,
    const std::optional<LutError>& other_error = std::nullopt,
    const std::optional<LutRinging>& ringing = std::nullopt);
[[nodiscard]] TONEWRIGHT_API std::string write_lut(const BakedLut& baked,
                                                   const LutRequest& request);

/// True if the extension is that of a picture.
[[nodiscard]] TONEWRIGHT_API bool is_lut_picture(const std::string& path);

/// The LUT as stages, interpolated as its readers do.
/// @param path  of its file, for errors
/// @throws FileError  a 3D LUT of more than 129 nodes a side
[[nodiscard]] TONEWRIGHT_API TableFile table_file_of(const Lut& lut, const std::string& path);

/// Reads LUTs for load_operator(): .cube, .raw, .dds and ICC device links, and the files that
/// `next` reads. It caches the last four files, and reads a changed file again.
[[nodiscard]] TONEWRIGHT_API TableReader table_reader(TableReader next = {});

TONEWRIGHT_NAMESPACE_END
