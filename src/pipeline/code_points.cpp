// SPDX-License-Identifier: Apache-2.0
#include "tonewright/source_color.h"

#include <algorithm>
#include <array>
#include <string_view>

#include "pipeline/spaces.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

/// A row of ITU-T H.273 (07/2021), table 2.
struct PrimariesRow {
    int value;
    Primaries primaries;  // named for messages
};

constexpr int kXyz = 10;
constexpr Chromaticity kIlluminantC = {0.310, 0.316};
constexpr Chromaticity kDciWhite = {0.314, 0.351};

constexpr Primaries renamed(std::string_view name, const Primaries& primaries) {
    return {name, primaries.red, primaries.green, primaries.blue, primaries.whitepoint};
}

constexpr std::array kPrimaries = {
    PrimariesRow{1, renamed("BT.709", kRec709)},
    PrimariesRow{4, {"BT.470M", {0.67, 0.33}, {0.21, 0.71}, {0.14, 0.08}, kIlluminantC}},
    PrimariesRow{5, {"BT.470BG", {0.64, 0.33}, {0.29, 0.60}, {0.15, 0.06}, kD65}},
    PrimariesRow{6, {"SMPTE 170M", {0.630, 0.340}, {0.310, 0.595}, {0.155, 0.070}, kD65}},
    PrimariesRow{7, {"SMPTE 240M", {0.630, 0.340}, {0.310, 0.595}, {0.155, 0.070}, kD65}},
    PrimariesRow{8, {"generic film", {0.681, 0.319}, {0.243, 0.692}, {0.145, 0.049}, kIlluminantC}},
    PrimariesRow{9, renamed("BT.2020", kRec2020)},
    PrimariesRow{kXyz, {"CIE XYZ", {1, 0}, {0, 1}, {0, 0}, kD65}},
    PrimariesRow{11, {"DCI-P3", {0.680, 0.320}, {0.265, 0.690}, {0.150, 0.060}, kDciWhite}},
    PrimariesRow{12, renamed("Display P3", kP3D65)},
    PrimariesRow{22, {"EBU 3213-E", {0.630, 0.340}, {0.295, 0.605}, {0.155, 0.077}, kD65}},
};

/// A row of table 3.
struct TransferRow {
    int value;
    std::string_view name;
    /// Code values -> light, a curve of one channel; null for linear light and HLG.
    Expr (*decode)(const Expr&);
};

Expr pq_light(const Expr& code) { return pq_decode_nits(code) / kUnitLuminance; }
Expr log_100_decode(const Expr& code) { return log_range_decode(code, 2); }
Expr log_316_decode(const Expr& code) { return log_range_decode(code, 2.5); }

constexpr int kLinear = 8;
constexpr int kPq = 16;
constexpr int kSt428 = 17;
constexpr int kHlg = 18;

constexpr std::array kTransfers = {
    TransferRow{1, "BT.709", bt1886_decode},
    TransferRow{4, "gamma 2.2", [](const Expr& code) { return power_decode(code, 2.2); }},
    TransferRow{5, "gamma 2.8", [](const Expr& code) { return power_decode(code, 2.8); }},
    TransferRow{6, "SMPTE 170M", bt1886_decode},
    TransferRow{7, "SMPTE 240M", smpte_240m_decode},
    TransferRow{kLinear, "linear", nullptr},
    TransferRow{9, "log 100:1", log_100_decode},
    TransferRow{10, "log 316:1", log_316_decode},
    TransferRow{11, "xvYCC", xvycc_decode},
    TransferRow{12, "BT.1361", bt1361_decode},
    TransferRow{13, "sRGB", srgb_decode},
    TransferRow{14, "BT.2020, 10 bits", bt1886_decode},
    TransferRow{15, "BT.2020, 12 bits", bt1886_decode},
    TransferRow{kPq, "PQ", pq_light},
    TransferRow{kSt428, "SMPTE ST 428", st428_decode},
    TransferRow{kHlg, "HLG", nullptr},
};

template <class Rows>
auto find_row(const Rows& rows, int value) -> decltype(&rows[0]) {
    const auto row =
        std::find_if(rows.begin(), rows.end(), [&](const auto& r) { return r.value == value; });
    return row == rows.end() ? nullptr : &*row;
}

/// A name of a value of which the table says nothing that could be used.
std::string name_of_other(int value) {
    return value == 2 ? "unspecified" : "reserved " + std::to_string(value);
}

/// Pairs of a display: its id.
struct DisplayPair {
    int primaries;
    int transfer;
    std::string_view id;
};
constexpr std::array kDisplayPairs = {
    DisplayPair{1, 13, "srgb"},
    DisplayPair{12, 13, "display_p3"},
    DisplayPair{1, 1, "rec1886"},
    DisplayPair{1, 6, "rec1886"},
    DisplayPair{1, 14, "rec1886"},
    DisplayPair{1, 15, "rec1886"},
    DisplayPair{9, 1, "rec2020"},
    DisplayPair{9, 6, "rec2020"},
    DisplayPair{9, 14, "rec2020"},
    DisplayPair{9, 15, "rec2020"},
    DisplayPair{1, 4, "g22"},
    DisplayPair{9, kPq, "rec2100_pq"},
    DisplayPair{9, kHlg, "rec2100_hlg"},
    DisplayPair{12, kPq, "p3d65_pq"},
};

/// Ids of the Color Interop Forum for pairs that are no display of ours.
std::string name_of(int primaries, int transfer) {
    if (primaries == kXyz && transfer == kLinear) return "lin_ciexyzd65_scene";
    if (primaries == kXyz && transfer == kPq) return "pq_xyzd65_display";
    if (primaries == kXyz && transfer == kSt428) return "g26_xyzd65_display";
    return "cicp:" + std::to_string(primaries) + "/" + std::to_string(transfer);
}

/// Luminance that the system gamma of HLG depends on; its display has BT.2020.
Vector3 luminance_of(const PrimariesRow& gamut) {
    if (gamut.value == kXyz) return {0, 1, 0};
    return rgb_to_xyz(gamut.primaries)[1];
}

}  // namespace

std::optional<SourceColor> color_of_code_points(int primaries, int transfer) {
    const PrimariesRow* const gamut = find_row(kPrimaries, primaries);
    const TransferRow* const curve = find_row(kTransfers, transfer);
    if (!gamut || !curve) return std::nullopt;
    for (const DisplayPair& pair : kDisplayPairs) {
        if (pair.primaries == primaries && pair.transfer == transfer)
            return color_of_display(find_display(pair.id));
    }
    if (transfer == kLinear) {
        for (const InputSpace& space : all_input_spaces()) {
            if (space.primaries == gamut->primaries) return SourceColor{space.id, space.primaries};
        }
    }
    const std::string name = name_of(primaries, transfer);
    if (transfer == kLinear && primaries != kXyz) return SourceColor{name, gamut->primaries};
    Pipeline decode;
    if (transfer == kHlg) {
        decode.emplace_back(ClampStage{-8, 8});  // as color_of_display() does
        const Pipeline hlg = hlg_display_decode(luminance_of(*gamut));
        decode.insert(decode.end(), hlg.begin(), hlg.end());
    } else if (curve->decode) {
        decode.push_back(curve_stage(curve->decode(Expr::input())));
    }
    SourceColor color = primaries == kXyz
                            ? xyz_color(name, std::move(decode))
                            : encoded_color(name, std::move(decode), gamut->primaries);
    color.is_absolute = transfer == kHlg || transfer == kPq;
    return color;
}

std::string code_point_names(int primaries, int transfer) {
    const PrimariesRow* const gamut = find_row(kPrimaries, primaries);
    const TransferRow* const curve = find_row(kTransfers, transfer);
    return (gamut ? std::string(gamut->primaries.name) : name_of_other(primaries)) + " / " +
           (curve ? std::string(curve->name) : name_of_other(transfer));
}

TONEWRIGHT_NAMESPACE_END
