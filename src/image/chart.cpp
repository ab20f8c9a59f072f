// SPDX-License-Identifier: Apache-2.0
//
// The synthetic HDR test chart.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>

#include "image/canvas.h"
#include "image/chart_scene.h"
#include "measure/chart_colors.h"
#include "tonewright/chart.h"
#include "tonewright/color.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

constexpr double kMidGray = 0.18;
// The chart is laid out on a sheet of this size, then scaled.
constexpr double kSheetWidth = 1536;
constexpr double kSheetHeight = 864;
constexpr double kMargin = 24;
constexpr double kColumn = 484;  // width of each of three columns
constexpr double kColumnStep = 502;

// A few stops below mid gray: patches are distinct from it, and no operator makes it black.
const Rgb kBackground = gray_of(0.018);
const Rgb kTitle = gray_of(0.32);
const Rgb kLabel = gray_of(0.16);

double stops(double s) { return kMidGray * std::exp2(s); }

Rgb rgb_of(const Vector3& v) {
    return {static_cast<float>(v[0]), static_cast<float>(v[1]), static_cast<float>(v[2])};
}

Rgb scaled(const Rgb& c, double factor) {
    const auto f = static_cast<float>(factor);
    return {c[0] * f, c[1] * f, c[2] * f};
}

/// Draws in the coordinates of the sheet.
class Sheet {
  public:
    Sheet(int width, int height)
        : canvas_(width, height, kBackground),
          sx_(width / kSheetWidth),
          sy_(height / kSheetHeight),
          text_scale_(std::min(sx_, sy_)) {}

    [[nodiscard]] int px(double x) const { return static_cast<int>(std::lround(x * sx_)); }
    [[nodiscard]] int py(double y) const { return static_cast<int>(std::lround(y * sy_)); }
    [[nodiscard]] Canvas& canvas() { return canvas_; }

    template <class ColorAt>
    void paint(double x0, double y0, double x1, double y1, ColorAt&& color_at) {
        canvas_.paint(px(x0), py(y0), px(x1), py(y1), color_at);
    }
    void fill(double x0, double y0, double x1, double y1, const Rgb& color) {
        canvas_.fill(px(x0), py(y0), px(x1), py(y1), color);
    }
    void text(std::string_view text, double x, double baseline, double cap_height, const Rgb& color,
              Canvas::Align align = Canvas::Align::left) {
        const double size = cap_height * text_scale_;
        if (size < 4.5) return;  // too small to read
        canvas_.text(text, x * sx_, baseline * sy_, size, color, align);
    }
    void title(std::string_view title, double x, double baseline) {
        text(title, x, baseline, 10, kTitle);
    }
    void label(std::string_view label, double x, double baseline,
               Canvas::Align align = Canvas::Align::center) {
        text(label, x, baseline, 7.5, kLabel, align);
    }

  private:
    Canvas canvas_;
    double sx_;
    double sy_;
    double text_scale_;
};

std::string signed_number(int n) { return n == 0 ? "0" : fmt::format("{:+d}", n); }

constexpr std::array<const char*, 6> kHueNames = {"R", "Y", "G", "C", "B", "M"};

void draw_stop_ramp(Sheet& sheet, double top) {
    constexpr int kStops = 12;
    constexpr int kCount = 2 * kStops + 1;
    const double left = kMargin;
    const double right = kSheetWidth - kMargin;
    const double step = (right - left) / kCount;
    sheet.title("Stops around mid gray 0.18, in steps and continuous", left, top - 10);
    for (int i = 0; i < kCount; ++i) {
        const double x = left + i * step;
        sheet.fill(x, top, x + step, top + 58, gray_of(stops(i - kStops)));
        sheet.label(signed_number(i - kStops), x + step / 2, top + 118);
    }
    // The ramp reaches the value of a step below the middle of the step.
    sheet.paint(left, top + 58, right, top + 102,
                [&](double u, double) { return gray_of(stops(u * kCount - 0.5 - kStops)); });
}

void draw_hue_sweep(Sheet& sheet, double left, double top, double bottom, double saturation,
                    std::string_view title) {
    constexpr double kLow = -4;
    constexpr double kHigh = 10;
    sheet.title(title, left, top - 10);
    const double panel = left + 24;
    const double right = left + kColumn;
    sheet.paint(panel, top, right, bottom, [&](double u, double v) {
        return rgb_of(hue_color(u, saturation, stops(kHigh + v * (kLow - kHigh))));
    });
    for (int s = static_cast<int>(kLow); s <= static_cast<int>(kHigh); s += 2) {
        const double y = top + (kHigh - s) / (kHigh - kLow) * (bottom - top);
        const double baseline = std::clamp(y + 3.5, top + 7.5, bottom);
        sheet.label(signed_number(s), panel - 6, baseline, Canvas::Align::right);
    }
    for (std::size_t i = 0; i < kHueNames.size(); ++i) {
        const double x = panel + static_cast<double>(i) / 6 * (right - panel);
        sheet.label(kHueNames[i], std::max(x, panel + 4), bottom + 15);
    }
}

/// 8-bit sRGB of the 24 patches of the ColorChecker (C. S. McCamy, H. Marcus, J. G. Davidson, "A
/// Color-Rendition Chart", Journal of Applied Photographic Engineering 2(3), 1976) as its maker,
/// GretagMacbeth, later X-Rite, publishes them; listed by D. Pascale, "RGB coordinates of the
/// Macbeth ColorChecker", The BabelColor Company, 2006. Approximate: rounded, and D50 adapted to
/// D65.
constexpr std::array<std::array<std::uint8_t, 3>, 24> kColorChecker = {{
    {115, 82, 68},   {194, 150, 130}, {98, 122, 157}, {87, 108, 67},   {133, 128, 177},
    {103, 189, 170}, {214, 126, 44},  {80, 91, 166},  {193, 90, 99},   {94, 60, 108},
    {157, 188, 64},  {224, 163, 46},  {56, 61, 150},  {70, 148, 73},   {175, 54, 60},
    {231, 199, 31},  {187, 86, 149},  {8, 133, 161},  {243, 243, 242}, {200, 200, 200},
    {160, 160, 160}, {122, 122, 121}, {85, 85, 85},   {52, 52, 52},
}};

void draw_color_checker(Sheet& sheet, double left, double top, double bottom) {
    sheet.title("Reflectances of a ColorChecker", left, top - 10);
    const Expr decode = srgb_decode(Expr::input());
    const double step_x = kColumn / 6;
    const double step_y = (bottom - top) / 4;
    for (std::size_t i = 0; i < kColorChecker.size(); ++i) {
        Vector3 linear{};
        for (std::size_t c = 0; c < 3; ++c)
            linear[c] = evaluate(decode, kColorChecker[i][c] / 255.0);
        const std::size_t row = i / 6;
        const double x = left + static_cast<double>(i % 6) * step_x;
        const double y = top + static_cast<double>(row) * step_y;
        sheet.fill(x + 3, y + 3, x + step_x - 3, y + step_y - 3, rgb_of(linear));
    }
}

void draw_near_black(Sheet& sheet, double left, double top, double bottom) {
    constexpr std::array<double, 8> kSteps = {-0.002, 0, 0.0005, 0.001, 0.002, 0.004, 0.008, 0.016};
    sheet.title("Near black: linear -0.002 .. 0.016, and steps", left, top - 10);
    const double middle = top + (bottom - top) * 0.42;
    sheet.paint(left, top, left + kColumn, middle,
                [](double u, double) { return gray_of(-0.002 + 0.018 * u); });
    const double step = kColumn / kSteps.size();
    for (std::size_t i = 0; i < kSteps.size(); ++i) {
        const double x = left + static_cast<double>(i) * step;
        sheet.fill(x, middle, x + step, bottom - 15, gray_of(kSteps[i]));
        sheet.label(fmt::format("{:g}", kSteps[i]), x + step / 2, bottom);
    }
}

/// Primaries and secondaries of three gamuts, each with the same channel values in its own gamut.
void draw_gamuts(Sheet& sheet, double left, double top, double bottom) {
    constexpr std::array<const Primaries*, 3> kGamuts = {&kRec709, &kP3D65, &kRec2020};
    constexpr std::array<const char*, 3> kNames = {"709", "P3", "2020"};
    constexpr std::array<double, 4> kExposures = {0, 2, 4, 6};
    sheet.title("Primaries of Rec.709, P3, Rec.2020 at 0, +2, +4, +6 stops", left, top - 10);
    const double panel = left + 36;
    const double step_x = (left + kColumn - panel) / 6;
    const double step_y = (bottom - top) / 3;
    for (std::size_t g = 0; g < kGamuts.size(); ++g) {
        const Matrix3 to_rec709 = rgb_to_rgb(*kGamuts[g], kRec709);
        const double y = top + static_cast<double>(g) * step_y;
        sheet.label(kNames[g], panel - 6, y + step_y / 2 + 3, Canvas::Align::right);
        for (std::size_t h = 0; h < 6; ++h) {
            const Rgb color =
                rgb_of(multiply(to_rec709, hue_color(static_cast<double>(h) / 6, 1, 1)));
            const double x = panel + static_cast<double>(h) * step_x + 3;
            const double part = (step_x - 6) / kExposures.size();
            for (std::size_t e = 0; e < kExposures.size(); ++e) {
                const double from = x + static_cast<double>(e) * part;
                sheet.fill(from, y + 3, from + part, y + step_y - 3,
                           scaled(color, stops(kExposures[e])));
            }
        }
    }
}

void draw_saturation(Sheet& sheet, double left, double top, double bottom) {
    sheet.title("Gray to pure hue at +3 stops", left, top - 10);
    const double panel = left + 36;
    const double step = (bottom - top) / 6;
    for (std::size_t h = 0; h < 6; ++h) {
        const double y = top + static_cast<double>(h) * step;
        sheet.label(kHueNames[h], panel - 6, y + step - 3, Canvas::Align::right);
        sheet.paint(panel, y, left + kColumn, y + step, [&](double u, double) {
            return rgb_of(hue_color(static_cast<double>(h) / 6, u, stops(3)));
        });
    }
}

/// Exposure ramps without a step: bands, kinks and turning hues show here.
void draw_gradients(Sheet& sheet, double left, double top, double bottom) {
    sheet.title("Gradients -6 .. +8 stops: gray, skin, orange, blue", left, top - 10);
    const double step = (bottom - top) / kGradientTints.size();
    for (std::size_t i = 0; i < kGradientTints.size(); ++i) {
        const double y = top + static_cast<double>(i) * step;
        sheet.paint(left, y, left + kColumn, y + step, [&](double u, double) {
            return scaled(rgb_of(kGradientTints[i]), stops(-6 + 14 * u));
        });
    }
}

void check_range(const char* name, int value, int low) {
    constexpr int kLargest = 16384;
    if (value >= low && value <= kLargest) return;
    throw Error({.parameter = name,
                 .value = fmt::to_string(value),
                 .expected = fmt::format("[{}, {}] pixels", low, kLargest)});
}

}  // namespace

OIIO::ImageBuf make_chart(int width, int height) {
    check_range("width", width, 320);
    check_range("height", height, 180);
    Sheet sheet(width, height);
    const double column1 = kMargin;
    const double column2 = kMargin + kColumnStep;
    const double column3 = kMargin + 2 * kColumnStep;

    sheet.text("Tonewright HDR test chart", kMargin, 32, 13, kTitle);
    sheet.text("scene-linear Rec.709, mid gray 0.18, diffuse white 1.0", kSheetWidth - kMargin, 32,
               10, kLabel, Canvas::Align::right);
    draw_stop_ramp(sheet, 70);

    const double row2 = 226;
    draw_hue_sweep(sheet, column1, row2, 468, 1, "Hue over exposure: pure Rec.709 hues");
    draw_hue_sweep(sheet, column2, row2, 468, 0.5, "Hue over exposure: half saturated");
    sheet.title("Lit and shining spheres: highlights to 500, lights 24 .. 60", column3, row2 - 10);
    draw_spheres(sheet.canvas(), sheet.px(column3), sheet.py(row2), sheet.px(column3 + kColumn),
                 sheet.py(490));

    const double row3 = 526;
    const double row4 = 756;
    const double bottom = kSheetHeight - kMargin;
    draw_color_checker(sheet, column1, row3, 724);
    draw_near_black(sheet, column1, row4, bottom);
    draw_gamuts(sheet, column2, row3, 724);
    draw_saturation(sheet, column2, row4, bottom);
    sheet.title("Sunset: sun 2000", column3, row3 - 10);
    draw_sunset(sheet.canvas(), sheet.px(column3), sheet.py(row3), sheet.px(column3 + kColumn),
                sheet.py(724));
    draw_gradients(sheet, column3, row4, bottom);

    OIIO::ImageBuf image = sheet.canvas().to_image(OIIO::TypeDesc::FLOAT);
    image.specmod().attribute("oiio:ColorSpace", "Linear");
    image.specmod().attribute("ImageDescription",
                              "Tonewright HDR test chart, scene-linear Rec.709");
    return image;
}

TONEWRIGHT_NAMESPACE_END
