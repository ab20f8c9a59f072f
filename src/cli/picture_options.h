// SPDX-License-Identifier: Apache-2.0
//
// Options of the commands that read or write pictures. They use no type of OpenImageIO: the program
// fills them in, and the picture commands, which it loads, run with them.
#pragma once

#include <optional>
#include <set>
#include <string>
#include <vector>

#include "cli/command.h"
#include "cli/lut_input.h"
#include "tasks/report.h"

TONEWRIGHT_NAMESPACE_BEGIN

/// Which picture of a file is read. @see ReadOptions
struct PictureChoice {
    std::string subimage;
    std::string layer;
    /// Unset: the default of the library.
    std::optional<double> max_pixels = {};
};

/// The meaning of a picture's numbers. @see TonemapOptions
struct LightOptions {
    std::string input = "auto";
    std::string units = "relative";
    double reference_white = kUnitLuminance;
};

/// Options for reading pictures: the choice, alpha, threads, time limit.
struct PictureInput : PictureChoice {
    int threads = 0;
    /// Seconds; each picture then has its own process. 0: no limit.
    double timeout = 0;
    bool unpremult = false;
    bool no_unpremult = false;
};

/// Treatment of the frames of a shot by `apply`.
struct FrameOptions {
    std::string frames;
    std::string missing = "error";
    bool skip_existing = false;
    int jobs = 0;
};

/// Metering, and the exposure that follows.
struct ExposureOptions {
    /// Empty: no metering.
    std::string method;
    std::string region;
    double delta = 1e-3;
    std::string percentiles = "0,100";
    /// Empty: the library's, which grows.
    std::string histogram_range;
    int histogram_bins = 256;
    bool exact = false;
    std::string key;
    std::string calibration = "key";
    double compensation = 0;
    std::string limits = "-20,20";
};

/// Adaptation of the exposure over a shot.
struct ShotOptions {
    bool adapt = false;
    std::string form = "exponential";
    std::optional<double> up;
    std::optional<double> down;
    double fps = 24;
    std::optional<double> start;
    std::string meter_frames;
    std::string cache;
};

struct ApplyOptions : ViewOptions {
    /// Words of the command line: pictures, folders, @lists; without -o the last is the output.
    std::vector<std::string> pictures;
    /// -o: a file, or a folder.
    std::string output;
    /// Extension of the files in a folder.
    std::string format;
    FrameOptions frames;
    std::string type;
    std::string statistics = "picture";
    double mix = 1;
    bool is_false_color = false;
    bool has_legend = false;
    bool dither = false;
    /// @see ReadOptions::resize
    std::string resize;
    bool is_in_place = false;
    std::string alpha = "keep";
    std::string compression;
    int quality = 0;
    std::string subsampling;
    bool verifies_output = false;
    bool has_no_metadata = false;
    PictureInput picture;
    LutOptions lut;
    ExposureOptions metering;
    ShotOptions shot;
};

struct MeterCommandOptions {
    std::vector<std::string> in;
    std::string frames;
    LightOptions light;
    bool json = false;
    PictureInput picture;
    ExposureOptions metering;
    ShotOptions shot;
};

struct CompareOptions {
    std::string in;
    std::vector<std::string> operators;
    std::string file;
    std::string pictures;
    /// @see ReadOptions::resize
    std::string resize;
    /// Names of the options that the command line has.
    std::set<std::string> given = {};
    double exposure = 0;
    LightOptions light;
    int columns = 0;
    int cell_width = 480;
    bool has_false_color = false;
    std::optional<double> difference;
    std::optional<double> split;
    bool is_horizontal = false;
    bool has_no_labels = false;
    PictureChoice picture;
};

struct ChartOptions {
    std::string file;
    std::string type = "float";
    int width = 1536;
    int height = 864;
};

struct SheetOptions {
    std::string file;
    std::vector<std::string> pictures;
    int columns = 4;
    int cell_width = 480;
    PictureChoice choice;
};

struct InfoOptions {
    std::vector<std::string> pictures;
    std::string input = "auto";
    bool json = false;
    PictureChoice choice;
};

/// A picture of the page.
struct ReportPictureOptions {
    std::string path;  // empty: the chart
    LightOptions light;
    /// A larger picture is made smaller.
    int width = 960;
    PictureChoice choice;
    /// Local operators, which the page cannot run.
    std::vector<ResolvedOperator> local_operators;
};

TONEWRIGHT_NAMESPACE_END
