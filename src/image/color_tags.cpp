// SPDX-License-Identifier: Apache-2.0
#include "image/color_tags.h"
#include "base/format_number.h"

#include <array>
#include <cmath>
#include <string>

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

/// What can be said about the numbers of a result.
struct Claim {
    std::string color_space;  // empty: nothing
    Primaries primaries;
};

Claim power_claim(double exponent, const Primaries& primaries) {
    // OIIO parses the number, and its writers (PNG's gAMA) want the point: "Gamma2.0".
    std::string number = shortest(exponent);
    if (number.find('.') == std::string::npos) number += ".0";
    return {"Gamma" + number, primaries};
}

Claim claim_of(const View& view) {
    if (view.display == kLinearOutput) return {"Linear", kRec709};
    if (view.display == kNativeOutput) {
        const Operator& op = *view.op.op;
        const Primaries primaries = view.op.output_primaries();
        // OIIO's names imply Rec.709: for other primaries there is none.
        if (!(primaries == kRec709)) return {"", primaries};
        if (op.output == OutputKind::display_linear) return {"Linear", kRec709};
        return power_claim(op.code_power, kRec709);
    }
    const Display& display = find_display(view.display);
    if (display.id == "srgb") return {"sRGB", display.primaries};
    if (display.id == "g22") return power_claim(2.2, display.primaries);
    // OIIO's "Rec709" is the camera curve of BT.709. Rec.1886 is the 2.4 power of a display.
    if (display.id == "rec1886") return power_claim(2.4, display.primaries);
    return {display.title, display.primaries};
}

}  // namespace

void tag_as_unknown(OIIO::ImageSpec& spec) {
    // Regular expressions, letters' case apart. Each of these described the source; where a writer
    // prefers one of them to oiio:ColorSpace (DPX does), the file would lie. oiio:Gamma repeats the
    // name "GammaX.Y", is deprecated, and makes OIIO's TGA writer divide by a power of alpha.
    for (const char* stale : {
             "oiio:ColorSpace",
             "oiio:Gamma",
             "ICCProfile.*",
             "photoshop:ICCProfile",
             "CICP",
             "colorInteropID",
             "Exif:ColorSpace",
             "Exif:Gamma",
             "tiff:ColorSpace",
             "png:gamma",
             "dpx:Transfer",
             "dpx:Colorimetric",
             "chromaticities",
             "adoptedNeutral",
             "whiteLuminance",
             "renderingTransform",
             "lookModTransform",
             "acesImageContainerFlag",
             "rla:ColorChannel",
             "rla:RedChroma",
             "rla:GreenChroma",
             "rla:BlueChroma",
             "rla:WhitePoint",
         }) {
        spec.erase_attribute(stale);
    }
}

void tag_as_result_of(const View& view, OIIO::ImageSpec& spec) {
    tag_as_unknown(spec);
    const Claim claim = claim_of(view);
    if (!claim.color_space.empty()) spec.attribute("oiio:ColorSpace", claim.color_space);
    if (claim.primaries == kRec709) return;  // what OpenEXR files without the attribute have
    const Primaries& p = claim.primaries;
    std::array<float, 8> xy{};
    std::size_t i = 0;
    for (const Chromaticity& c : {p.red, p.green, p.blue, p.whitepoint}) {
        xy[i++] = static_cast<float>(c.x);
        xy[i++] = static_cast<float>(c.y);
    }
    spec.attribute("chromaticities", OIIO::TypeDesc(OIIO::TypeDesc::FLOAT, 8), xy.data());
}

TONEWRIGHT_NAMESPACE_END
