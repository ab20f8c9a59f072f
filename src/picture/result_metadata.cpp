// SPDX-License-Identifier: Apache-2.0
#include "picture/result_metadata.h"

#include <fmt/format.h>
#include <sys/stat.h>

#include <algorithm>

#include "base/format_number.h"
#include "base/strings.h"
#include "picture/picture_description.h"
#include "picture/source_date.h"
#include "tonewright/engine.h"
#include "tonewright/registry.h"
#include "tonewright/view.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

/// True for code values of an SDR display: white is 1. Logs of cameras and film reach far beyond.
bool is_for_display(const SourceColor& color) {
    if (color.is_absolute) return false;
    if (color.convert) return true;
    // The curves of cameras, and textures, which are a part of a scene.
    for (const std::string_view scene : {"_scene", "Rec709", "Texture"}) {
        if (color.name.ends_with(scene)) return false;
    }
    constexpr double kMostWhite = 2;  // code 1 of a narrow range is 1.2
    const Vector3 white = ReferenceEngine(color.decode)({1, 1, 1});
    return !color.decode.empty() && *std::max_element(white.begin(), white.end()) < kMostWhite;
}

bool expects_a_scene(const ResolvedOperator& op) {
    const std::string& file = op.op->file;
    const bool is_formula = op.op->source == "typed";
    const bool is_lut = !file.empty() && !is_formula && !file.ends_with(".tone");
    return !is_lut && op.op->id != "clamp" && op.op->id != "false_color";
}

}  // namespace

void add_provenance(PictureSpec& picture, const TonemapOptions& options,
                    const std::string& resize) {
    const std::string op = operator_text(options.op);
    const std::string exposure = shortest(options.exposure_stops);
    std::string display = options.display;
    if (options.reference_white != kUnitLuminance)
        display += fmt::format(", reference white {}", shortest(options.reference_white));
    if (options.input_units == InputUnits::luminance) display += ", input in cd/m2";
    const std::string mix = options.mix == 1 ? "" : ", mix " + shortest(options.mix);
    const std::string size = resize.empty() ? "" : ", resize " + resize;
    picture.attribute("Software",
                      fmt::format("Tonewright {}: {}, exposure {}{}{}, display {}",
                                  TONEWRIGHT_VERSION, op, exposure, mix, size, display));
    picture.attribute("tonewright:operator", op);
    picture.attribute("tonewright:exposure", exposure);
    // The source may be a picture that another run resized.
    picture.erase_attribute("tonewright:resize");
    if (!resize.empty()) picture.attribute("tonewright:resize", resize);
    // For native output, the name of its color may be there, and says more.
    if (options.display != kNativeOutput || !picture.find_attribute("tonewright:display"))
        picture.attribute("tonewright:display", display);
}

void give_date(PictureSpec& picture, const std::string& path) {
    if (picture.find_attribute("DateTime")) return;
    std::string date = source_date();
    struct stat file {};
    if (date.empty() && ::stat(path.c_str(), &file) == 0) date = date_text(file.st_mtime);
    if (!date.empty()) picture.attribute("DateTime", date);
}

std::string finished_warning(const PictureSpec& spec, const TonemapOptions& options) {
    if (!is_same_name(options.input, kAutoInput) || options.mix == 0) return {};
    const ResolvedOperator& op = options.op;
    if (!expects_a_scene(op)) return {};
    const PictureDescription description = describe_picture(spec, options.input);
    if (!is_for_display(description.color)) return {};
    const std::string name = op.op->source == "typed" ? "the formula" : op.op->id;
    return fmt::format(
        "{}{} by {}), so {} tone maps it a second time; the operator clamp keeps the colors, "
        "<<input=lin_rec709>> takes the numbers as scene-linear",
        kFinishedPicture, description.color.name, description.rule, name);
}

TONEWRIGHT_NAMESPACE_END
