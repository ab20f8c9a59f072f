// SPDX-License-Identifier: Apache-2.0
#include "ocio/operator_facts.h"

#include <algorithm>

#include "tonewright/registry.h"

TONEWRIGHT_NAMESPACE_BEGIN

const std::vector<BuiltinRow>& builtin_rows() {
    static const std::vector<BuiltinRow> rows = {
        {"aces_13", {{"output", "sdr_video"}, {"limit", "none"}}, "SDR-VIDEO_1.0"},
        {"aces_13", {{"output", "sdr_cinema"}, {"limit", "none"}}, "SDR-CINEMA_1.0"},
        {"aces_13", {{"output", "sdr_video"}, {"limit", "rec709"}}, "SDR-VIDEO-REC709lim_1.1"},
        {"aces_13", {{"output", "sdr_cinema"}, {"limit", "rec709"}}, "SDR-CINEMA-REC709lim_1.1"},
        {"aces_13", {{"output", "sdr_video"}, {"limit", "p3d65"}}, "SDR-VIDEO-P3lim_1.1"},
        {"aces_13",
         {{"output", "hdr_1000"}, {"limit", "p3d65"}},
         "HDR-VIDEO-1000nit-15nit-P3lim_1.1"},
        {"aces_13",
         {{"output", "hdr_2000"}, {"limit", "p3d65"}},
         "HDR-VIDEO-2000nit-15nit-P3lim_1.1"},
        {"aces_13",
         {{"output", "hdr_4000"}, {"limit", "p3d65"}},
         "HDR-VIDEO-4000nit-15nit-P3lim_1.1"},
        {"aces_13",
         {{"output", "hdr_1000"}, {"limit", "rec2020"}},
         "HDR-VIDEO-1000nit-15nit-REC2020lim_1.1"},
        {"aces_13",
         {{"output", "hdr_2000"}, {"limit", "rec2020"}},
         "HDR-VIDEO-2000nit-15nit-REC2020lim_1.1"},
        {"aces_13",
         {{"output", "hdr_4000"}, {"limit", "rec2020"}},
         "HDR-VIDEO-4000nit-15nit-REC2020lim_1.1"},
        {"aces_13",
         {{"output", "hdr_cinema"}, {"limit", "p3d65"}},
         "HDR-CINEMA-108nit-7.2nit-P3lim_1.1"},
        {"aces_20", {{"peak", "100"}, {"limit", "rec709"}}, "SDR-100nit-REC709_2.0"},
        {"aces_20", {{"peak", "100"}, {"limit", "p3d65"}}, "SDR-100nit-P3-D65_2.0"},
        {"aces_20", {{"peak", "500"}, {"limit", "p3d65"}}, "HDR-500nit-P3-D65_2.0"},
        {"aces_20", {{"peak", "1000"}, {"limit", "p3d65"}}, "HDR-1000nit-P3-D65_2.0"},
        {"aces_20", {{"peak", "2000"}, {"limit", "p3d65"}}, "HDR-2000nit-P3-D65_2.0"},
        {"aces_20", {{"peak", "4000"}, {"limit", "p3d65"}}, "HDR-4000nit-P3-D65_2.0"},
        {"aces_20", {{"peak", "500"}, {"limit", "rec2020"}}, "HDR-500nit-REC2020_2.0"},
        {"aces_20", {{"peak", "1000"}, {"limit", "rec2020"}}, "HDR-1000nit-REC2020_2.0"},
        {"aces_20", {{"peak", "2000"}, {"limit", "rec2020"}}, "HDR-2000nit-REC2020_2.0"},
        {"aces_20", {{"peak", "4000"}, {"limit", "rec2020"}}, "HDR-4000nit-REC2020_2.0"},
    };
    return rows;
}

std::string builtin_style(const ResolvedOperator& op) {
    if (!op.op->file.empty()) return "";  // for any id
    for (const BuiltinRow& row : builtin_rows()) {
        if (row.op == op.op->id && resolve_operator(row.op, row.settings).params == op.params)
            return kBuiltinPrefix + std::string(row.style);
    }
    return "";
}

std::string blender_difference(const ResolvedOperator& op) {
    if (op.op->id != "aces_13" || !op.op->file.empty()) return "";
    // Blender 5.2, config.ocio: its view takes the P3-limited output transforms there.
    const std::string& limit = op.params.choice("limit");
    if (limit != "rec2020" && limit != "none") return "";
    return " Blender limits its ACES 1.3 to P3-D65 on such displays: --operator "
           "aces_13:limit=p3d65.";
}

const std::vector<std::string_view>& fitted_operators() {
    static const std::vector<std::string_view> ids = {"aces_20", "agx_blender"};
    return ids;
}

LowerOptions lower_options(const Operator& op, const std::string& cache_folder) {
    const auto& fitted = fitted_operators();
    return {.primaries = op.working,
            .fits_cubes = std::find(fitted.begin(), fitted.end(), op.id) != fitted.end(),
            .cache_folder = cache_folder};
}

TONEWRIGHT_NAMESPACE_END
