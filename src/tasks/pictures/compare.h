// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <OpenImageIO/imagebuf.h>

#include <optional>
#include <string>
#include <vector>

#include "tonewright/tonemap.h"

TONEWRIGHT_NAMESPACE_BEGIN

/// The operator that shows exposure as colors.
inline constexpr const char* kFalseColor = "false_color";

/// A picture in false color, sRGB code values, with the legend below it: a patch for every stop.
/// @throws Error  wider than 16384 pixels, or narrower than 16
[[nodiscard]] OIIO::ImageBuf with_legend(const OIIO::ImageBuf& picture);

/// True if both names are one file, also through links. False if one does not exist.
[[nodiscard]] bool is_same_file(const std::string& a, const std::string& b);

/// A picture through several operators.
struct ComparisonRequest {
    /// The picture's file.
    std::string in;
    /// The sheet or the split picture.
    std::string file;
    /// Folder for each operator's picture at full size. Empty: none.
    std::string pictures = {};
    std::vector<ResolvedOperator> operators;
    /// Exposure, input and units of the picture; no operator.
    TonemapOptions tonemap = {};
    /// @see ReadOptions
    std::string resize = {};
    double max_pixels = kMaxPixels;
    /// Pictures in a row of the sheet. 0: the number that fits a screen.
    int columns = 0;
    int cell_width = 480;
    /// Adds the absolute difference of two operators in code values, times this.
    std::optional<double> difference = {};
    /// Two operators in one picture: the part of the width that shows the first, [0, 1].
    std::optional<double> split = {};
    /// Splits the height.
    bool is_horizontal = false;
    bool has_labels = true;
};

/// Writes a contact sheet or a split picture.
class Comparison {
  public:
    /// @throws Error  an output is the input, or two outputs are one file; a split or a difference
    /// of
    ///                other than two operators
    explicit Comparison(ComparisonRequest request);
    /// @param picture  of the request's file, with associated alpha, upright
    /// @throws PictureError  a picture that cannot be compared
    /// @throws FileError     a file that cannot be written
    void write(OIIO::ImageBuf picture);

  private:
    struct Rendering {
        ResolvedOperator op;
        Tonemapper tonemapper;
        [[nodiscard]] std::string label() const;
    };
    void make_renderings();
    void check_outputs() const;
    void take_statistics(const OIIO::ImageBuf& picture);
    [[nodiscard]] std::string picture_path(const Rendering& rendering) const;
    void write_pictures(const OIIO::ImageBuf& picture) const;
    void write_sheet(const OIIO::ImageBuf& picture, const std::string& remark) const;
    void write_split(const OIIO::ImageBuf& picture) const;

    ComparisonRequest request_;
    std::vector<Rendering> renderings_;
};

TONEWRIGHT_NAMESPACE_END
