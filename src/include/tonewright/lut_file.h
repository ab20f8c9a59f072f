// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "tonewright/lut.h"

TONEWRIGHT_NAMESPACE_BEGIN

/// @throws Error with the nearest name.
[[nodiscard]] TONEWRIGHT_API LutInterpolation parse_lut_interpolation(std::string_view text);

/// A LUT file of any format, ready to run.
///
/// OpenColorIO runs .cube, .clf, .ctf, .spi1d, .spi3d, .csp, .3dl, .lut, .itx, .spimtx, .cub, .vf,
/// .dat, .mga, .m3d, .look and .cc.
/// Little CMS runs ICC device links (.icc, .icm). Tonewright's own interpolation runs raw floats
/// (.raw: the size of the grid follows from the size of the file), volumes (.dds) and other tables,
/// such as the pictures of read_lut_picture().
class TONEWRIGHT_API LutFile {
  public:
    /// The file is validated before a library parses it: sizes, numbers of rows, numbers.
    ///
    /// OpenColorIO reads a temporary copy, so a changed file is read again, and the application's
    /// OpenColorIO caches, log and settings stay as they are.
    /// @throws FileError  missing, malformed, of unknown format, or of a size that its reader does
    ///                    not support; with path, line and reason. Also if the temporary folder
    ///                    cannot be written.
    /// @throws Error      trilinear interpolation for an ICC device link
    explicit LutFile(const std::string& path,
                     LutInterpolation interpolation = LutInterpolation::automatic);
    explicit LutFile(Lut table, LutInterpolation interpolation = LutInterpolation::automatic);
    ~LutFile();
    LutFile(LutFile&&) noexcept;
    LutFile& operator=(LutFile&&) noexcept;

    /// Interleaved RGB; safe to use from several threads at once.
    void run_rgb(const float* in, float* out, std::size_t count) const;

    /// One line about a keyword of the file that is unknown and ignored; empty if there is none.
    [[nodiscard]] const std::string& note() const;

  private:
    struct Form;
    std::unique_ptr<const Form> form_;
};

/// A reader for load_operator(), of the LUTs that OpenColorIO reads: tables, matrices, ranges,
/// logarithms and CDLs. Other files go to `next`. @see table_reader()
[[nodiscard]] TONEWRIGHT_API TableReader ocio_table_reader(TableReader next = {});

/// Turns off OpenColorIO's log for the whole process. Programs may call it; libraries should not.
/// LutFile throws errors, and OpenColorIO's warnings about a file go to the log.
TONEWRIGHT_API void silence_opencolorio();

TONEWRIGHT_NAMESPACE_END
