// SPDX-License-Identifier: Apache-2.0
//
// The interface between the program and its two modules. OpenImageIO loads some 250 shared
// libraries, which takes a fifth of a second. Everything that needs it is therefore in a module
// (the folder pictures/), which the program loads when a command needs it. The other module (rows/)
// has the libraries of OpenEXR, PNG and JPEG alone, and starts in a tenth of that time.
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
struct PictureCommands {
    /// Called once, after loading.
    void (*use_messages)(const MessageOptions& options);

    int (*apply)(const ApplyOptions& options);
    int (*meter)(const MeterCommandOptions& options);
    void (*compare)(const CompareOptions& options);
    void (*chart)(const ChartOptions& options);
    void (*sheet)(const SheetOptions& options);
    void (*info)(const InfoOptions& options);

    /// Scene-linear RGB of a picture: every pixel up to a million, then every n-th.
    std::vector<float> (*read_pixels)(const std::string& path);
    /// @param width  pixels
    void (*write_plot)(const CurvePlot& plot, const std::string& path, int width);
    Lut (*read_lut)(const std::string& path);
    /// @param bits  8, 16 or 32 (float)
    void (*write_lut)(const Lut& lut, LutFormat format, const std::string& path, int bits);
    /// The set of `bake --all`: LUTs by application, thumbnails, README.md, MANIFEST.csv.
    /// @param application  only its LUTs; empty: all
    void (*write_shipped_luts)(const std::string& folder, const std::string& application);
    ReportPicture (*read_report_picture)(const ReportPictureOptions& options);
};

/// Functions without OpenImageIO.
struct RowCommands {
    /// Called once, after loading.
    void (*use_messages)(const MessageOptions& options);
    /// @returns  false: PictureCommands::apply must do it. Nothing was written or printed.
    bool (*apply)(const ApplyOptions& options);
};

/// These load their module at the first call.
/// @throws FileError  it is missing, cannot be loaded, or is from another build
[[nodiscard]] const PictureCommands& picture_commands();
[[nodiscard]] const RowCommands& row_commands();

/// True while the module is being loaded under a limit of addresses (ulimit -v): libraries below
/// OpenImageIO that get no thread then end the process.
[[nodiscard]] bool is_loading_under_limit() noexcept;

/// Entry points of the modules.
/// @param build   kPictureCommandsBuild of the program
/// @returns       null if the module was built with another interface or version
extern "C" const PictureCommands* tonewright_picture_commands(const char* build);
extern "C" const RowCommands* tonewright_row_commands(const char* build);
/// The release, and the number of this interface: increase it with every change of the interface
/// or of the options.
inline constexpr const char* kPictureCommandsBuild = TONEWRIGHT_VERSION " interface 12";

TONEWRIGHT_NAMESPACE_END
