// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cstddef>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "picture/picture_spec.h"
#include "picture/row_files.h"
#include "tonewright/error.h"
#include "tonewright/picture_options.h"

TONEWRIGHT_NAMESPACE_BEGIN

/// @throws FileError  "<path>: cannot read: <reason>"
[[noreturn]] void cannot_read(const std::string& path, Problem why);
[[noreturn]] void cannot_read(const std::string& path, const std::string& reason);
/// @throws FileError  it declares more pixels than the limit
[[noreturn]] void refuse_size(const std::string& path, double width, double height,
                              double max_pixels);

/// The picture of a file that is tone mapped: the part and the layer that the options or the names
/// choose. Its rows come in any order, in full resolution and in the pixel type of the file.
class TONEWRIGHT_API FileReader {
  public:
    /// Chooses the picture, and describes it to the callbacks of `options`.
    /// @param format  OpenImageIO's name
    /// @throws FileError  without that subimage or layer, deep, or with more pixels than the limit
    FileReader(std::string path, std::string_view format, std::unique_ptr<RowReader> rows,
               const ReadOptions& options);

    /// With the facts of the header (header_tags.h).
    [[nodiscard]] const PictureSpec& spec() const { return spec_; }
    [[nodiscard]] int subimage() const { return subimage_; }
    /// The channels of the file in the order of the spec; empty: all, as the file has them.
    [[nodiscard]] const std::vector<int>& channels() const { return channels_; }
    /// Rows are read in multiples of this, from the first one on: the height of a tile, or 1.
    [[nodiscard]] int row_step() const { return std::max(spec_.tile_height, 1); }
    /// Reads rows [ybegin, yend) of all channels, interleaved and packed.
    /// @throws FileError  truncated or damaged.
    void read_rows(int ybegin, int yend, std::byte* to);

  private:
    void choose_subimage(const ReadOptions& options);
    void choose_layer(const ReadOptions& options);
    void deliver(const std::vector<int>& channels, bool has_alpha);
    void check_size(double max_pixels) const;

    std::string path_;
    std::string format_;
    std::unique_ptr<RowReader> rows_;
    int subimage_ = 0;
    PictureSpec spec_;                // of what is delivered
    int stored_channels_ = 0;         // of the file
    std::vector<int> channels_;       // of the file that are delivered; empty: all in their order
    std::vector<std::byte> scratch_;  // rows with all channels
};

/// The warnings about what a header says go to the callbacks of `options`.
TONEWRIGHT_API void report_header(const PictureSpec& spec, std::string_view input,
                                  const ReadOptions& options);

TONEWRIGHT_NAMESPACE_END
