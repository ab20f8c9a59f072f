// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <OpenImageIO/typedesc.h>

#include <cstddef>
#include <memory>

#include "picture/picture_spec.h"
#include "picture/prepared_view.h"
#include "picture/span_runner.h"
#include "tonewright/registry.h"
#include "tonewright/tonemap_options.h"
#include "tonewright/view.h"

/// Tone mapping of rows in memory, without OpenImageIO's libraries. Tonemapper (tonemap.h) does the
/// same with pictures of OpenImageIO.
///
/// Views are compiled once for all exposures and statistics, because both are uniforms. An operator
/// that needs its statistics as constants is compiled again for each picture.
TONEWRIGHT_NAMESPACE_BEGIN

/// @throws Error  a volume, which local operators do not take
TONEWRIGHT_API void check_flat(const PictureSpec& source);

/// Options of tone mapping with their compiled programs. Safe to use from several threads.
class TONEWRIGHT_API RowTonemapper {
  public:
    /// @throws Error  unknown name or bad value among the options, with the nearest name; no
    ///                operator
    explicit RowTonemapper(const TonemapOptions& options);
    ~RowTonemapper();
    RowTonemapper(RowTonemapper&&) noexcept;
    RowTonemapper& operator=(RowTonemapper&&) noexcept;

    [[nodiscard]] const TonemapOptions& options() const noexcept;
    /// True if some of the operator's parameters come from each picture.
    [[nodiscard]] bool takes_statistics() const noexcept;
    /// True for a local operator, which maps a pixel by its surroundings.
    [[nodiscard]] bool needs_whole_picture() const noexcept;
    /// @see Tonemapper
    [[nodiscard]] RowTonemapper with_statistics(const SceneStatistics& statistics) const;
    [[nodiscard]] RowTonemapper with_exposure(double stops) const;

    /// The programs for sources of a color.
    [[nodiscard]] std::shared_ptr<const PreparedView> prepared_for(const SourceColor& source) const;
    /// The operations of these programs on a picture.
    /// @param prepared  outlives the result
    [[nodiscard]] PictureMap map_of(const PreparedView& prepared, const PictureSpec& source) const;
    /// Sets the metadata of a result.
    void tag_result(const PreparedView& prepared, PictureSpec& result) const;

    /// Size, channels and metadata of a picture's result: floats, untiled. No pixel is mapped.
    /// @throws PictureError, Error  a picture that cannot be tone mapped
    [[nodiscard]] PictureSpec result_spec(const PictureSpec& source) const;
    /// Tone maps rows. Neither takes_statistics() nor needs_whole_picture(), and the color of the
    /// source is one that a Pipeline holds (SourceColor::convert is empty).
    /// @param source    of the rows; only width, channels and color count. @see
    ///                  with_color_metadata_alone
    /// @param rows      interleaved and packed, in the type of `source`
    /// @param type      of the result
    /// @param result    channels of result_spec(), packed
    /// @param nthreads  0: all cores. The result does not depend on it.
    /// @throws PictureError, Error  a picture that cannot be tone mapped
    void run(const PictureSpec& source, const std::byte* rows, int row_count,
             const OIIO::TypeDesc& type, std::byte* result, unsigned nthreads) const;

  private:
    struct State;
    explicit RowTonemapper(std::unique_ptr<const State> state);
    std::unique_ptr<const State> state_;
};

TONEWRIGHT_NAMESPACE_END
