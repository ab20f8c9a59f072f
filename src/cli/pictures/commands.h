// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "cli/picture_commands.h"

/// The implementation of PictureCommands.
TONEWRIGHT_NAMESPACE_BEGIN

int run_apply(const ApplyOptions& options);
int run_meter(const MeterCommandOptions& options);
void run_compare(CompareOptions options);
void run_chart(const ChartOptions& options);
void run_sheet(const SheetOptions& options);
void run_info(const InfoOptions& options);
[[nodiscard]] std::vector<float> read_picture_pixels(const std::string& path);
void write_plot_file(const CurvePlot& plot, const std::string& path, int width);
[[nodiscard]] Lut load_lut_picture(const std::string& path);
void write_lut_picture(const Lut& lut, LutFormat format, const std::string& path, int bits);
[[nodiscard]] ReportPicture read_report_picture(const ReportPictureOptions& options);
void write_shipped_luts(const std::string& folder, const std::string& application);

TONEWRIGHT_NAMESPACE_END
