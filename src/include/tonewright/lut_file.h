// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "tonewright/lut.h"

TONEWRIGHT_NAMESPACE_BEGIN

/// What stands between the nodes of a cube. 1D tables are linear. Automatic: what the file says
/// (CLF and CTF can), else tetrahedral.
enum class LutInterpolation : unsigned char { automatic, tetrahedral, trilinear };
/// @throws Error with the nearest name.
[[nodiscard]] TONEWRIGHT_API LutInterpolation parse_lut_interpolation(std::string_view text);

/// A LUT file of any format, ready to run.
///
/// OpenColorIO runs what it reads (.cube, .clf, .ctf, .spi1d, .spi3d, .csp, .3dl, .lut, .itx,
/// .spimtx, .cc), LittleCMS an ICC device link (.icc, .icm), and our
/// own interpolation raw floats (.raw: the cube's size follows from the file's), volumes (.dds) and
/// tables from elsewhere, such as the pictures of read_lut_picture().
class TONEWRIGHT_API LutFile {
  public:
    /// Nothing is taken from the file before it has been looked through: sizes, numbers of rows,
    /// numbers.
    ///
    /// Formats that OpenColorIO reads go through a temporary copy: a file that was rewritten is
    /// read again, and OpenColorIO's caches, log and settings stay those of the application.
    /// @throws FileError  missing, malformed, of unknown format, or of a size that its reader has
    ///                    not; with path, line where there are lines, and reason. Also when the
    ///                    temporary folder cannot be written.
    /// @throws Error      trilinear for an ICC device link.
    explicit LutFile(const std::string& path,
                     LutInterpolation interpolation = LutInterpolation::automatic);
    explicit LutFile(Lut table, LutInterpolation interpolation = LutInterpolation::automatic);
    ~LutFile();
    LutFile(LutFile&&) noexcept;
    LutFile& operator=(LutFile&&) noexcept;

    /// Interleaved RGB; safe to use from several threads at once.
    void run_rgb(const float* in, float* out, std::size_t count) const;

  private:
    struct Form;
    std::unique_ptr<const Form> form_;
};

/// Reads the LUTs that OpenColorIO reads for load_operator(): tables, matrices, ranges, logarithms
/// and CDLs. Other files go to `next`. @see table_reader()
[[nodiscard]] TONEWRIGHT_API TableReader ocio_table_reader(TableReader next = {});

/// Turns off OpenColorIO's log for the whole process. For a program to call: LutFile throws errors,
/// and OpenColorIO's warnings about the file go to the log.
TONEWRIGHT_API void silence_opencolorio();

TONEWRIGHT_NAMESPACE_END
