// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "tonewright/definition.h"
#include "tonewright/input_encoding.h"
#include "tonewright/view.h"

TONEWRIGHT_NAMESPACE_BEGIN

/// `cube` (Adobe and Resolve), `clf` (Academy S-2014-006), `ctf` (Autodesk's form of it), `spi1d`,
/// `spi3d` (Sony Imageworks), `csp` (cineSpace: scene-linear in, its prelut encodes),
/// `resolve_cube` (a .cube with a 1D table before the 3D one: scene-linear in), `3dl` (Autodesk:
/// integers), `lut` (Houdini), `icc` (ICC device link), `hald` (a Hald CLUT picture), `strip` (a
/// picture of n slices of n x n side by side, green down), `strip_up` (the same, green up), `raw`
/// (float32, little-endian, RGB triplets, red fastest).
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
    raw
};
/// @throws Error with the nearest name.
[[nodiscard]] TONEWRIGHT_API LutFormat parse_lut_format(std::string_view text);
[[nodiscard]] TONEWRIGHT_API std::vector<std::string> lut_format_names();
[[nodiscard]] TONEWRIGHT_API std::string name_of(LutFormat format);
/// A picture's layout, not a file of its own kind: OpenImageIO writes it.
[[nodiscard]] TONEWRIGHT_API bool is_strip(LutFormat format);
[[nodiscard]] TONEWRIGHT_API bool is_picture_format(LutFormat format);
/// Scene-linear goes in, and a 1D table before the cube encodes it.
[[nodiscard]] TONEWRIGHT_API bool has_shaper(LutFormat format);

enum class LutDimension : unsigned char { automatic, one, three };

/// What to bake.
struct LutRequest {
    View view;
    InputEncoding encoding;
    LutFormat format = LutFormat::cube;
    LutDimension dimension = LutDimension::automatic;
    /// Entries of a 1D table (2..65536), or grid points a side of a cube (17..129; `3dl`: 17, 33 or
    /// 65; `hald`: a square of 16..144; strips: 2..64; `raw`: 2..129).
    std::optional<int> size;
    /// Of integers: 8 or 16 in pictures, 10, 12 or 16 in `3dl`, 16 in `icc`. 32: float.
    std::optional<int> bits;
    /// Of the ICC's specification: 2 (more programs read it) or 4.
    int icc_version = 2;
    /// Of the numbers in a `cube`, [3, 9]; where none is given, as many as a float has. Four round
    /// by 5e-5 at most, less than cubes of 33 points are off between their nodes, in half the
    /// space.
    std::optional<int> decimals;
};

/// A baked table. 1D: `size` entries of `channels` values. 3D: size^3 RGB triplets, red fastest.
/// Half-domain: 65536 entries in the order of the half floats' bit patterns.
struct Lut {
    int dimension = 3;
    int size = 33;
    int channels = 3;
    bool is_half_domain = false;
    std::vector<float> values;
    /// That the values were rounded to. @see LutRequest::decimals
    std::optional<int> decimals = {};
};

/// Distance of a table, interpolated as its readers do, from the double reference; display code
/// values for a display, the operator's numbers for `linear` and `native`.
struct LutError {
    /// Of all colors of the input range: of a cube, a search finds the largest from the worst
    /// samples on. The other figures are those of the samples.
    double max = 0;
    double p999 = 0;
    double mean = 0;
    /// dE_ITP (ITU-R BT.2124), 0 where there is no display.
    double delta_e_max = 0;
    double delta_e_p999 = 0;
    double delta_e_mean = 0;
    std::string interpolation;
};

/// @throws Error  a 3D table of linear input (it would clip at its end and band below); a 1D table
///                of a view that mixes channels; a size out of range; a format without that
///                dimension.
[[nodiscard]] TONEWRIGHT_API Lut sample_lut(const LutRequest& request);

/// A cube as sample_lut() makes it, with nodes that are chosen for the least error between them,
/// for colors of pictures and beyond. It can be nearer or not: measure both.
/// @param sampled  its sampled form
/// @throws Error  for a 1D table.
[[nodiscard]] TONEWRIGHT_API Lut fit_lut(const LutRequest& request, const Lut& sampled);

/// Table output for scene-linear input that the encoding holds; `rgb` is table input in [0, 1] (for
/// a half-domain table: scene-linear). Linear in 1D; in 3D tetrahedral, or trilinear when asked.
[[nodiscard]] TONEWRIGHT_API Vector3 interpolate(const Lut& lut, const Vector3& rgb,
                                                 bool trilinear = false);

/// Measured on the standard sample set, as far as it lies inside the encoding's range, and on
/// random table inputs; behind a shaper as its readers resample it.
[[nodiscard]] TONEWRIGHT_API LutError measure_lut(const Lut& lut, const LutRequest& request,
                                                  bool trilinear = false);

/// How a cube behaves along rays of rising exposure: the lamps and hues of the test chart (pure and
/// half saturated hues, the primaries and secondaries of Rec.709, P3 and Rec.2020), from -12 to +12
/// stops, as far as the encoding holds them.
///
/// A cube rings where a clip or a kink of the operator runs through its cells: a channel rises and
/// falls between the nodes where the operator's does not, and shows as rings around a lamp.
struct LutRinging {
    /// The largest fall of a channel on a ray, less what the operator itself falls by between the
    /// same exposures; code values, of `linear` those of sRGB.
    double fall = 0;
    /// 99.9th percentile of the errors along the rays, in the same unit.
    double p999 = 0;
    /// Where the largest fall ends.
    std::string color;    // "blue of Rec.2020"
    std::string channel;  // "red"
    double stops = 0;     // from 0.18
};
/// One code of 8 bits: what falls by more than that rings.
inline constexpr double kLargestFall = 1.0 / 255;
/// Of `p999`: what is beyond does not follow the operator in saturated lights.
inline constexpr double kLargestRayError = 0.02;
/// Of a 1D table: nothing.
[[nodiscard]] TONEWRIGHT_API LutRinging measure_ringing(const Lut& lut, const LutRequest& request,
                                                        bool trilinear = false);
[[nodiscard]] TONEWRIGHT_API bool rings(const LutRinging& ringing);
/// It does not ring, and its errors along the rays are within kLargestRayError.
[[nodiscard]] TONEWRIGHT_API bool follows_operator(const LutRinging& ringing);
/// "red falls by 0.19 at +9.4 stops of blue of Rec.2020".
[[nodiscard]] TONEWRIGHT_API std::string to_string(const LutRinging& ringing);

/// Light beyond the ends of an encoding that the operator would still show as something else than
/// the light at the end: by more than one code of 10 bits (of `linear` and `native`: more than
/// 1/1023), on grays, and above also on the six saturated colors of Rec.709.
struct ClippedStops {
    /// Stops from 0.18: where the encoding ends, and the last stop at which it shows.
    double end = 0;
    double last = 0;
    /// The largest difference.
    double error = 0;
};
struct LutClipping {
    std::optional<ClippedStops> below;
    std::optional<ClippedStops> above;
};
/// Of a half-domain table: nothing.
[[nodiscard]] TONEWRIGHT_API LutClipping measure_clipping(const LutRequest& request,
                                                          const Lut& lut);
/// "above +6.50 stops from 0.18, up to +9.25, by up to 3.1e-02; below -10.00 stops, down to black,
/// by up to 1.8e-03"; empty where nothing is.
[[nodiscard]] TONEWRIGHT_API std::string to_string(const LutClipping& clipping);

/// Which values the nodes of a cube have: sampled, fitted, or `automatic`. Automatic nodes are
/// sampled and fitted; where a cube rings, its nodes are changed as little as it takes not to ring.
/// Of the two it is the one that follows the operator along the rays of LutRinging; where both or
/// neither do, the one that is nearer in the mean and in the 99.9th percentile.
enum class LutNodes : unsigned char { automatic, sampled, fitted };

struct BakedLut {
    Lut lut;
    LutError error;
    /// Of a cube: with the other interpolation.
    std::optional<LutError> other_error;
    bool is_fitted = false;
    /// Interpolated as for `error`.
    LutRinging ringing = {};
};

/// A table as its format holds it, and how far it is from the view.
/// @param trilinear  what its reader does in a cube
/// @param max_error  instead of a size: the smallest cube, of 17, 25, 33, 49, 65, 97 and 129 points
///                   a side (or what the format has of such), whose largest error is at most this,
///                   in code values (of `linear` and `native`: in the operator's numbers)
/// @throws Error  as sample_lut(); with a size and a max_error; where no size meets it
[[nodiscard]] TONEWRIGHT_API BakedLut bake_lut(const LutRequest& request,
                                               LutNodes nodes = LutNodes::automatic,
                                               bool trilinear = false,
                                               std::optional<double> max_error = std::nullopt);

/// The table as its format holds it: rounded to the integers of LutRequest::bits, or to
/// LutRequest::decimals.
TONEWRIGHT_API void quantize(Lut& lut, const LutRequest& request);

/// The contents of the file: what it is, what goes in, what clips, what comes out, the measured
/// errors, whether it rings, and a hash of the numbers; then numbers with 9 significant digits
/// (enough for every float), never in exponent notation. Of no picture.
/// @param other_error  of a cube: with the other interpolation
[[nodiscard]] TONEWRIGHT_API std::string write_lut(
    const Lut& lut, const LutRequest& request, const LutError& error,
    const std::optional<LutError>& other_error = std::nullopt,
    const std::optional<LutRinging>& ringing = std::nullopt);
[[nodiscard]] TONEWRIGHT_API std::string write_lut(const BakedLut& baked,
                                                   const LutRequest& request);

/// True for a file that is a picture, by its extension.
[[nodiscard]] TONEWRIGHT_API bool is_lut_picture(const std::string& path);

/// The table as stages, as its readers interpolate it.
/// @param path  of its file, for errors
/// @throws FileError  a 3D LUT of more than 129 nodes a side
[[nodiscard]] TONEWRIGHT_API TableFile table_file_of(const Lut& lut, const std::string& path);

/// Reads LUTs for load_operator(): .cube, .raw, .dds and ICC device links, and whatever `next`
/// reads. It keeps the last four files, and reads a file that has changed again.
[[nodiscard]] TONEWRIGHT_API TableReader table_reader(TableReader next = {});

TONEWRIGHT_NAMESPACE_END
