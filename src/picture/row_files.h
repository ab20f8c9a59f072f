// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>

#include "picture/picture_spec.h"

/// Rows from and to files, without OpenImageIO.
TONEWRIGHT_NAMESPACE_BEGIN

/// A file whose pictures (parts, subimages) are read by rows.
class RowReader {
  public:
    virtual ~RowReader() = default;
    RowReader() = default;
    RowReader(const RowReader&) = delete;
    RowReader& operator=(const RowReader&) = delete;

    /// @param count  threads that decode; 0: as many as are idle
    virtual void use_threads(unsigned count) = 0;
    /// @param number  from 0
    [[nodiscard]] virtual bool has_picture(int number) = 0;
    /// Size, channels and attributes as OpenImageIO's reader gives them.
    /// @pre has_picture()
    [[nodiscard]] virtual const PictureSpec& spec(int picture) = 0;
    /// Rows [ybegin, yend) of all channels in the order and in the type of the spec, interleaved
    /// and packed; full resolution.
    /// @param ybegin  y of the first row; a multiple of `tile_height` from the spec's y on
    /// @throws FileError  truncated or damaged: the reason, without the name of the file
    virtual void read_rows(int picture, int ybegin, int yend, std::byte* to) = 0;
};

/// A file that gets one picture, from its first row to its last.
class RowWriter {
  public:
    virtual ~RowWriter() = default;
    RowWriter() = default;
    RowWriter(const RowWriter&) = delete;
    RowWriter& operator=(const RowWriter&) = delete;

    /// The types and attributes of the file, where those that the format lacks are replaced.
    [[nodiscard]] virtual const PictureSpec& spec() const = 0;
    /// The next rows, interleaved and packed.
    /// @param type  HALF or FLOAT, or the type of the file
    /// @throws FileError  the reason, without the name of the file
    virtual void write_rows(int row_count, OIIO::TypeDesc type, const std::byte* rows) = 0;
    /// After the last row: the file is complete and was passed to the system.
    /// @throws FileError  as write_rows()
    virtual void finish() = 0;
    /// A library opened the file by its name, and reports no full disk.
    [[nodiscard]] virtual bool is_opened_by_name() const { return false; }
};

TONEWRIGHT_NAMESPACE_END
