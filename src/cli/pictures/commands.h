// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "cli/picture_commands.h"

/// Functions of PictureCommands that are in files of their own.
TONEWRIGHT_NAMESPACE_BEGIN

int run_apply(const ApplyOptions& options);
int run_meter(const MeterCommandOptions& options);
void run_compare(const CompareOptions& options);
void run_sheet(const SheetOptions& options);
void run_info(const InfoOptions& options);
[[nodiscard]] Lut load_lut_picture(const std::string& path);

TONEWRIGHT_NAMESPACE_END
