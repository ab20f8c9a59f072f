// SPDX-License-Identifier: Apache-2.0
//
// The interface between the program and OpenImageIO. OpenImageIO loads some 250 shared libraries,
// which takes a fifth of a second. Everything that reads or writes a picture is therefore in a
// module (the folder pictures/), which the program loads when a command needs a picture.
#pragma once

#include <string>
#include <vector>

#include "cli/messages.h"
#include "cli/picture_options.h"
#include "plot/curve_plot.h"
#include "tonewright/lut.h"
#include "tonewright/version.h"

TONEWRIGHT_NAMESPACE_BEGIN

/// Functions that return int return the exit code. All throw Error and FileError as the library
/// does.
class PictureCommands {
  public:
    PictureCommands() = default;
    PictureCommands(const PictureCommands&) = delete;
    PictureCommands& operator=(const PictureCommands&) = delete;
    virtual ~PictureCommands() = default;

    /// Called once, after loading.
    virtual void use_messages(const MessageOptions& options) const = 0;

    [[nodiscard]] virtual int apply(const ApplyOptions& options) const = 0;
    [[nodiscard]] virtual int meter(const MeterCommandOptions& options) const = 0;
    virtual void compare(const CompareOptions& options) const = 0;
    virtual void chart(const ChartOptions& options) const = 0;
    virtual void sheet(const SheetOptions& options) const = 0;
    virtual void info(const InfoOptions& options) const = 0;

    /// Scene-linear RGB of a picture: every pixel up to a million, then every n-th.
    [[nodiscard]] virtual std::vector<float> read_pixels(const std::string& path) const = 0;
    /// @param width  pixels
    virtual void write_plot(const CurvePlot& plot, const std::string& path, int width) const = 0;
    [[nodiscard]] virtual Lut read_lut(const std::string& path) const = 0;
    /// @param bits  8, 16 or 32 (float)
    virtual void write_lut(const Lut& lut, LutFormat format, const std::string& path,
                           int bits) const = 0;
    /// The set of `bake --all`: LUTs by application, thumbnails, README.md, MANIFEST.csv.
    /// @param application  only its LUTs; empty: all
    virtual void write_shipped_luts(const std::string& folder,
                                    const std::string& application) const = 0;
    [[nodiscard]] virtual ReportPicture read_report_picture(
        const ReportPictureOptions& options) const = 0;
};

/// Loads the module at the first call.
/// @throws FileError  it is missing, cannot be loaded, or is from another build
[[nodiscard]] const PictureCommands& picture_commands();

/// True while the module is being loaded under a limit of addresses (ulimit -v): libraries below
/// OpenImageIO that get no thread then end the process.
[[nodiscard]] bool is_loading_under_limit() noexcept;

/// Entry point of the module.
/// @param build   kPictureCommandsBuild of the program
/// @returns       null if the module was built with another interface or version
extern "C" const PictureCommands* tonewright_picture_commands(const char* build);
inline constexpr const char* kPictureCommandsEntry = "tonewright_picture_commands";
/// The release, and the number of this interface: increase it with every change of the interface
/// or of the options.
inline constexpr const char* kPictureCommandsBuild = TONEWRIGHT_VERSION " interface 10";

TONEWRIGHT_NAMESPACE_END
