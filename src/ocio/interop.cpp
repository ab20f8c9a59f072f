// SPDX-License-Identifier: Apache-2.0
#include "ocio/interop.h"

#include <algorithm>
#include <array>

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

constexpr std::string_view kUrn = "urn:ampas:aces:transformId:";
constexpr std::string_view kStyle = "ACES-OUTPUT - ACES2065-1_to_CIE-XYZ-D65 - ";

struct SpaceId {
    std::string_view space;
    std::string_view version;
    std::string_view to_aces;
    std::string_view from_aces;
};

constexpr std::array<SpaceId, 15> kSpaces = {{
    {"ACEScg", "v2.0", "CSC.Academy.ACEScg_to_ACES.a2.v1", "CSC.Academy.ACES_to_ACEScg.a2.v1"},
    {"ACEScct", "v2.0", "CSC.Academy.ACEScct_to_ACES.a2.v1", "CSC.Academy.ACES_to_ACEScct.a2.v1"},
    {"ACEScc", "v2.0", "CSC.Academy.ACEScc_to_ACES.a2.v1", "CSC.Academy.ACES_to_ACEScc.a2.v1"},
    {"ADX10", "v2.0", "CSC.Academy.ADX10_to_ACES.a2.v1", ""},
    {"ADX16", "v2.0", "CSC.Academy.ADX16_to_ACES.a2.v1", ""},
    {"ARRI LogC3 (EI800)", "v2.0", "CSC.Arri.LogC3_to_ACES.a2.v1", "CSC.Arri.ACES_to_LogC3.a2.v1"},
    {"ARRI LogC4", "v2.0", "CSC.Arri.LogC4_to_ACES.a2.v1", "CSC.Arri.ACES_to_LogC4.a2.v1"},
    {"CanonLog2 CinemaGamut D55", "v2.0", "CSC.Canon.CLog2_CGamut_to_ACES.a1.v1",
     "CSC.Canon.ACES_to_CLog2_CGamut.a1.v1"},
    {"CanonLog3 CinemaGamut D55", "v2.0", "CSC.Canon.CLog3_CGamut_to_ACES.a1.v1",
     "CSC.Canon.ACES_to_CLog3_CGamut.a1.v1"},
    {"V-Log V-Gamut", "v2.0", "CSC.Panasonic.VLog_VGamut_to_ACES.a2.v1",
     "CSC.Panasonic.ACES_to_VLog_VGamut.a2.v1"},
    {"Log3G10 REDWideGamutRGB", "v2.0", "CSC.Red.Log3G10_RWG_to_ACES.a2.v1",
     "CSC.Red.ACES_to_Log3G10_RWG.a2.v1"},
    {"S-Log3 S-Gamut3", "v2.0", "CSC.Sony.SLog3_SGamut3_to_ACES.a2.v1",
     "CSC.Sony.ACES_to_SLog3_SGamut3.a2.v1"},
    {"S-Log3 S-Gamut3.Cine", "v2.0", "CSC.Sony.SLog3_SGamut3Cine_to_ACES.a2.v1",
     "CSC.Sony.ACES_to_SLog3_SGamut3Cine.a2.v1"},
    {"S-Log3 Venice S-Gamut3", "v2.0", "CSC.Sony.Venice_SLog3_SGamut3_to_ACES.a2.v1",
     "CSC.Sony.ACES_to_Venice_SLog3_SGamut3.a2.v1"},
    {"S-Log3 Venice S-Gamut3.Cine", "v2.0", "CSC.Sony.Venice_SLog3_SGamut3Cine_to_ACES.a2.v1",
     "CSC.Sony.ACES_to_Venice_SLog3_SGamut3Cine.a2.v1"},
}};

struct OutputId {
    std::string_view style;  // after kStyle
    std::string_view display;
    std::string_view version;
    std::string_view output;
};

constexpr OutputId kOutputs[] = {
    // Limiting to a display's gamut on that display equals the clamp of the Academy's transform for
    // it.
    {"SDR-VIDEO-REC709lim_1.1", "srgb", "v1.5", "ODT.Academy.RGBmonitor_100nits_dim.a1.0.3"},
    {"SDR-VIDEO-REC709lim_1.1", "rec1886", "v1.5", "ODT.Academy.Rec709_100nits_dim.a1.0.3"},
    {"SDR-VIDEO-P3lim_1.1", "display_p3", "v1.5", "ODT.Academy.DisplayP3_dim.a1.0.0"},
    {"SDR-VIDEO_1.0", "rec2020", "v1.5", "ODT.Academy.Rec2020_100nits_dim.a1.0.3"},
    {"HDR-VIDEO-1000nit-15nit-REC2020lim_1.1", "rec2100_pq", "v1.5",
     "RRTODT.Academy.Rec2020_1000nits_15nits_ST2084.a1.1.0"},
    {"HDR-VIDEO-1000nit-15nit-REC2020lim_1.1", "rec2100_hlg", "v1.5",
     "RRTODT.Academy.Rec2020_1000nits_15nits_HLG.a1.1.0"},
    {"HDR-VIDEO-1000nit-15nit-P3lim_1.1", "p3d65_pq", "v1.5",
     "RRTODT.Academy.P3D65_1000nits_15nits_ST2084.a1.1.0"},
    {"SDR-100nit-REC709_2.0", "srgb", "v2.0",
     "Output.Academy.Rec709-D65_100nit_in_Rec709-D65_sRGB-Piecewise.a2.v1"},
    {"SDR-100nit-REC709_2.0", "g22", "v2.0",
     "Output.Academy.Rec709-D65_100nit_in_Rec709-D65_Gamma2pt2.a2.v1"},
    {"SDR-100nit-REC709_2.0", "rec1886", "v2.0",
     "Output.Academy.Rec709-D65_100nit_in_Rec709-D65_BT1886.a2.v1"},
    {"SDR-100nit-P3-D65_2.0", "display_p3", "v2.0",
     "Output.Academy.P3-D65_100nit_in_P3-D65_sRGB-Piecewise.a2.v1"},
    {"HDR-500nit-P3-D65_2.0", "p3d65_pq", "v2.0",
     "Output.Academy.P3-D65_500nit_in_P3-D65_ST2084.a2.v1"},
    {"HDR-1000nit-P3-D65_2.0", "p3d65_pq", "v2.0",
     "Output.Academy.P3-D65_1000nit_in_P3-D65_ST2084.a2.v1"},
    {"HDR-2000nit-P3-D65_2.0", "p3d65_pq", "v2.0",
     "Output.Academy.P3-D65_2000nit_in_P3-D65_ST2084.a2.v1"},
    {"HDR-4000nit-P3-D65_2.0", "p3d65_pq", "v2.0",
     "Output.Academy.P3-D65_4000nit_in_P3-D65_ST2084.a2.v1"},
    {"HDR-1000nit-P3-D65_2.0", "rec2100_hlg", "v2.0",
     "Output.Academy.P3-D65_1000nit_in_Rec2100-D65_HLG.a2.v1"},
    {"HDR-500nit-P3-D65_2.0", "rec2100_pq", "v2.0",
     "Output.Academy.P3-D65_500nit_in_Rec2100-D65_ST2084.a2.v1"},
    {"HDR-1000nit-P3-D65_2.0", "rec2100_pq", "v2.0",
     "Output.Academy.P3-D65_1000nit_in_Rec2100-D65_ST2084.a2.v1"},
    {"HDR-2000nit-P3-D65_2.0", "rec2100_pq", "v2.0",
     "Output.Academy.P3-D65_2000nit_in_Rec2100-D65_ST2084.a2.v1"},
    {"HDR-4000nit-P3-D65_2.0", "rec2100_pq", "v2.0",
     "Output.Academy.P3-D65_4000nit_in_Rec2100-D65_ST2084.a2.v1"},
    {"HDR-500nit-REC2020_2.0", "rec2100_pq", "v2.0",
     "Output.Academy.Rec2100-D65_500nit_in_Rec2100-D65_ST2084.a2.v1"},
    {"HDR-1000nit-REC2020_2.0", "rec2100_pq", "v2.0",
     "Output.Academy.Rec2100-D65_1000nit_in_Rec2100-D65_ST2084.a2.v1"},
    {"HDR-2000nit-REC2020_2.0", "rec2100_pq", "v2.0",
     "Output.Academy.Rec2100-D65_2000nit_in_Rec2100-D65_ST2084.a2.v1"},
    {"HDR-4000nit-REC2020_2.0", "rec2100_pq", "v2.0",
     "Output.Academy.Rec2100-D65_4000nit_in_Rec2100-D65_ST2084.a2.v1"},
};

std::string urn(std::string_view version, std::string_view id, std::string_view prefix = "") {
    std::string text(kUrn);
    text += version;
    text += ':';
    text += prefix;
    text += id;
    return text;
}

}  // namespace

std::vector<std::string> amf_ids_of_space(std::string_view name) {
    std::vector<std::string> ids;
    for (const SpaceId& space : kSpaces) {
        if (space.space != name) continue;
        for (const std::string_view id : {space.from_aces, space.to_aces}) {
            if (!id.empty()) ids.push_back(urn(space.version, id));
        }
    }
    return ids;
}

std::vector<std::string> amf_ids_of_output(std::string_view style, std::string_view display) {
    std::vector<std::string> ids;
    for (const OutputId& output : kOutputs) {
        const bool is_style =
            style.starts_with(kStyle) && style.substr(kStyle.size()) == output.style;
        if ((!style.empty() && !is_style) || display != output.display) continue;
        ids.push_back(urn(output.version, output.output, "Inv"));
        ids.push_back(urn(output.version, output.output));
    }
    std::sort(ids.begin(), ids.end());
    return ids;
}

TONEWRIGHT_NAMESPACE_END
