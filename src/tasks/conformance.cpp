// SPDX-License-Identifier: Apache-2.0
#include "tasks/conformance.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <utility>
#include <vector>

#include "base/atomic_file.h"
#include "base/format_number.h"
#include "base/random.h"
#include "lut/header.h"
#include "pipeline/settings_text.h"
#include "pipeline/stand_ins.h"
#include "tasks/conformance_files.h"
#include "tonewright/color.h"
#include "tonewright/engine.h"
#include "tonewright/registry.h"
#include "tonewright/shader.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

constexpr double kTenBits = 1.0 / 1023;
constexpr double kGray = 0.18;

/// A color of the scene, whose channels 32-bit float holds exactly.
struct Color {
    const char* group;
    Vector3 rgb;
};

Color color_of(const char* group, const Vector3& rgb) {
    Color color{group, rgb};
    for (double& channel : color.rgb)
        channel = static_cast<double>(static_cast<float>(channel));
    return color;
}

Vector3 times(double factor, const Vector3& rgb) {
    return {factor * rgb[0], factor * rgb[1], factor * rgb[2]};
}

constexpr std::array<Vector3, 6> kHues = {
    {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {0, 1, 1}, {1, 0, 1}, {1, 1, 0}}};

/// Text of the README.
constexpr const char* kGroups =
    "`black`; `gray`: 24 stops around 0.18; `saturated`: primaries and secondaries over 20 stops; "
    "`random`: a fixed seed; `bright`: random, all channels above white; `near_black`: random";

std::vector<Color> ordinary_colors() {
    std::vector<Color> colors = {{"black", {0, 0, 0}}};
    const auto add = [&](const char* group, const Vector3& rgb) {
        colors.push_back(color_of(group, rgb));
    };
    for (int half_stops = -24; half_stops <= 24; ++half_stops)
        add("gray", times(kGray * std::exp2(half_stops / 2.0), {1, 1, 1}));
    for (const Vector3& hue : kHues) {
        for (int stops = -10; stops <= 10; stops += 2)
            add("saturated", times(kGray * std::exp2(stops), hue));
    }
    SampleRandom random(20260801);
    const auto add_random = [&](const char* group, int count, double low, double high) {
        for (int i = 0; i < count; ++i) {
            Vector3 rgb{};
            for (double& channel : rgb)
                channel = std::exp2(random.uniform(low, high));
            add(group, rgb);
        }
    };
    add_random("random", 120, -10, 6);
    add_random("bright", 30, 0, 8);
    add_random("near_black", 20, -24, -10);
    return colors;
}

/// Saturated colors of Rec.2020, as a renderer in Rec.709 has them.
std::vector<Color> negative_colors() {
    std::vector<Color> colors;
    const Matrix3 from_wide_gamut = rgb_to_rgb(kRec2020, kRec709);
    for (const Vector3& hue : kHues) {
        for (int stops = -4; stops <= 4; stops += 2)
            colors.push_back(color_of(
                "negative", times(kGray * std::exp2(stops), multiply(from_wide_gamut, hue))));
    }
    return colors;
}

std::vector<Color> extreme_colors() {
    constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
    std::vector<Color> colors;
    const std::array<std::pair<const char*, double>, 8> sizes = {
        {{"half_max", kHalfMax},
         {"huge", 1e10},
         {"huge", static_cast<double>(std::numeric_limits<float>::max())},
         {"infinite", kInfinity},
         {"infinite", -kInfinity},
         {"negative", -kHalfMax},
         {"denormal", 1e-40},
         {"nan", kNan}}};
    for (const auto& [group, value] : sizes) {
        colors.push_back(color_of(group, {value, value, value}));
        for (std::size_t c = 0; c < 3; ++c) {
            Vector3 rgb = {0.5, 0.5, 0.5};
            rgb.at(c) = value;
            colors.push_back(color_of(group, rgb));
        }
    }
    return colors;
}

bool is_light(const View& view) {
    return view.display == kLinearOutput ||
           (view.display == kNativeOutput && view.op.output() == OutputKind::display_linear);
}

/// The display's code values have more than 8 bits.
bool is_hdr(const View& view) {
    const bool is_display = view.display != kLinearOutput && view.display != kNativeOutput;
    return is_display && find_display(view.display).is_hdr;
}

/// In code values, as ShaderErrors. The README of the kit has the reasons.
double tolerance_of(const ShaderErrors& errors) {
    constexpr double kFloat = 2e-6;
    // The estimate is of first order, over a sample set: twice. Where it is useless, 10 bits, or
    // eight times the error in float, of which GPUs have up to six times (docs/shaders.md).
    const double on_gpus = std::isfinite(errors.vulkan_estimate) ? 2 * errors.vulkan_estimate : 0;
    const double most = std::max(kTenBits, 8 * errors.in_float);
    return std::max({kFloat, 4 * errors.in_float, std::min(on_gpus, most)});
}

/// An error of code values as an error of the output near this value.
class OutputError {
  public:
    explicit OutputError(bool is_light) : is_light_(is_light) {}

    [[nodiscard]] double operator()(double shown, double error) const {
        const double value = std::fabs(shown);
        const double code = is_light_ ? evaluate(encode_, value) : value;
        const double more = code + error * std::max(1.0, code);
        return is_light_ ? evaluate(decode_, more) - value : more - value;
    }

  private:
    bool is_light_;
    Expr encode_ = srgb_encode(Expr::input());
    Expr decode_ = srgb_decode(Expr::input());
};

/// A number that C, JavaScript and Python read.
std::string number(double value) {
    if (std::isnan(value)) return "NaN";
    if (std::isinf(value)) return value < 0 ? "-Infinity" : "Infinity";
    return shortest(value);
}

std::string table_of(const View& view, const std::vector<Color>& colors, double tolerance) {
    std::string text;
    for (const std::string& line : operator_lines(view))
        text += "# " + line + "\n";
    text += "# " + output_line(view) + "\n# Columns: README.md\ngroup";
    for (const char* column : {"scene", "display", "float", "code"})
        text += fmt::format(",{0}_r,{0}_g,{0}_b", column);
    text += "\n";
    const ReferenceEngine reference(build_view(view));
    const OutputError error_of(is_light(view));
    const double code = is_hdr(view) ? kTenBits : 1.0 / 255;
    for (const Color& color : colors) {
        const Vector3 shown = reference(color.rgb);
        text += color.group;
        for (const double channel : color.rgb)
            text += "," + number(channel);
        for (const double channel : shown)
            text += fmt::format(",{:.12g}", channel);
        for (const double error : {tolerance, std::max(code, tolerance)}) {
            for (const double channel : shown)
                text += fmt::format(",{:.3g}", error_of(channel, error));
        }
        text += "\n";
    }
    return text;
}

/// README.md with the words of this kit.
std::string filled(std::string text, const std::map<std::string, std::string>& words) {
    for (const auto& [name, word] : words) {
        for (std::size_t at = text.find(name); at != std::string::npos;
             at = text.find(name, at + word.size()))
            text.replace(at, name.size(), word);
    }
    return text;
}

std::map<std::string, std::string> words_of(const View& view, const ShaderErrors& errors,
                                            std::size_t count) {
    const Operator& op = *view.op.op;
    const std::string settings = settings_text(view.op);
    const auto without_title = [](const std::string& line) {
        return line.substr(line.find(' ') + 1);
    };
    const std::string output = without_title(output_line(view));
    std::string exposure;
    if (view.exposure_stops != 0)
        exposure = ", exposure " + shortest(view.exposure_stops) + " stops";
    return {{"@title", op.title},
            {"@operator", fmt::format("{}, `{}`", op.title, operator_text(view.op))},
            {"@source", op.source},
            {"@settings", settings.empty() ? "none" : settings},
            {"@input", view.input},
            {"@white", shortest(1 / view.input_scale)},
            {"@exposure", exposure},
            {"@output", output},
            {"@encoding", is_light(view) ? "light, which your renderer encodes" : output},
            {"@negatives", op.negatives},
            {"@version", TONEWRIGHT_VERSION},
            {"@count", std::to_string(count)},
            {"@groups", kGroups},
            {"@bits", is_hdr(view) ? "10" : "8"},
            {"@tolerance", rounded_up(tolerance_of(errors))},
            {"@units", is_light(view) ? "code values of sRGB" : "code values"},
            {"@in_float", rounded_up(errors.in_float)},
            {"@vulkan", std::isfinite(errors.vulkan_estimate) ? rounded_up(errors.vulkan_estimate)
                                                              : "none for this operator"}};
}

}  // namespace

ConformanceResult write_conformance_kit(const ConformanceRequest& request,
                                        const Listener& listener) {
    const View& view = request.view;
    const ShaderErrors errors = measure_shader({.view = view});
    listener.warn_of(stand_in_warning(view.op, "conformance kit"));
    require_writable_folder(request.folder);
    const double tolerance = tolerance_of(errors);
    const std::vector<Color> colors = ordinary_colors();
    std::vector<GeneratedFile> files = conformance_files();
    for (GeneratedFile& file : files) {
        if (file.path == "README.md")
            file.contents = filled(file.contents, words_of(view, errors, colors.size()));
    }
    files.push_back({"negative.csv", table_of(view, negative_colors(), tolerance)});
    files.push_back({"extremes.csv", table_of(view, extreme_colors(), tolerance)});
    files.push_back({"colors.csv", table_of(view, colors, tolerance)});
    write_generated_files(request.folder, files, "colors.csv");
    return {colors.size(), tolerance};
}

TONEWRIGHT_NAMESPACE_END
