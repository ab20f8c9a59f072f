// SPDX-License-Identifier: Apache-2.0
//
// ICC.1:2001-04 (version 2) and ICC.1:2022 (version 4).
#include "lut/icc_source.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <memory>
#include <vector>

#include "base/strings.h"
#include "lut/icc_handles.h"
#include "lut/icc_profile.h"
#include "tonewright/error.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

/// Profiles of printers with large tables have a few MiB.
constexpr std::size_t kLongest = std::size_t{32} << 20;

/// White of the profile connection space, ICC.1:2022, 7.2.16.
constexpr Vector3 kConnectionWhite = {0.9642, 1, 0.8249};

Chromaticity chromaticity_of(const Vector3& xyz) {
    const double sum = xyz[0] + xyz[1] + xyz[2];
    return {xyz[0] / sum, xyz[1] / sum};
}

const Chromaticity kD50 = chromaticity_of(kConnectionWhite);

/// s15Fixed16Number, ICC.1:2022, 4.6.
double fixed_number(std::string_view bytes, std::size_t at) {
    return static_cast<double>(static_cast<std::int32_t>(big_endian(bytes, at, 4))) / 65536;
}

/// A function of input 0, and the bytes that define it.
struct Curve {
    Expr f = Expr::input();
    std::string_view bytes;
};

/// curveType, ICC.1:2022, 10.6.
Expr sampled_curve(std::string_view tag, const RefuseIcc& refuse) {
    if (tag.size() < 12) refuse("a curve is longer than its tag");
    const std::size_t count = big_endian(tag, 8, 4);
    if (count > (tag.size() - 12) / 2) refuse("a curve is longer than its tag");
    Expr x = Expr::input();
    if (count == 0) return x;
    if (count == 1) {  // u8Fixed8Number
        const double exponent = big_endian(tag, 12, 2) / 256.0;
        return exponent == 1 ? x : power_decode(x, exponent);
    }
    Table table;
    for (std::size_t i = 0; i < count; ++i)
        table.samples.push_back(big_endian(tag, 12 + 2 * i, 2) / 65535.0);
    return lookup(std::make_shared<const Table>(std::move(table)), x);
}

/// parametricCurveType, ICC.1:2022, 10.18, tables 67 and 68.
Expr parametric_curve(std::string_view tag, const RefuseIcc& refuse) {
    constexpr std::array<std::size_t, 5> kCounts = {1, 3, 4, 5, 7};
    if (tag.size() < 12) refuse("a curve is longer than its tag");
    const std::size_t type = big_endian(tag, 8, 2);
    if (type >= kCounts.size())
        refuse(fmt::format("a parametric curve is of type {}; expected 0 to 4", type));
    if (tag.size() < 12 + 4 * kCounts[type]) refuse("a curve is longer than its tag");
    const auto parameter = [&](std::size_t i) { return fixed_number(tag, 12 + 4 * i); };
    const Expr x = Expr::input();
    const double g = parameter(0);
    if (type == 0) return g == 1 ? x : power_decode(x, g);
    const double a = parameter(1);
    const double b = parameter(2);
    const Expr base = max(a * x + b, 0);
    const Expr power = g == 1 ? base : pow(base, g);
    if (type == 1) return a == 0 ? Expr(0) : select(less(x, -b / a), 0, power);
    if (type == 2) {
        const double c = parameter(3);
        return a == 0 ? Expr(c) : select(less(x, -b / a), c, power + c);
    }
    const double c = parameter(3);
    const double d = parameter(4);
    const double e = type == 4 ? parameter(5) : 0;
    const double f = type == 4 ? parameter(6) : 0;
    return select(less(x, d), c * x + f, power + e);
}

/// Numbers at which curves are compared and checked: the codes of 8 bits.
constexpr int kCodes = 256;
double code(int i) { return static_cast<double>(i) / (kCodes - 1); }

Curve read_curve(const IccTags& tags, std::string_view name, const RefuseIcc& refuse) {
    const std::string_view tag = tags.find(name);
    if (tag.empty()) refuse(fmt::format("there is no tag {}", name));
    const std::string_view type = tag.substr(0, 4);
    Curve curve;
    curve.bytes = tag;
    if (type == "curv") {
        curve.f = sampled_curve(tag, refuse);
    } else if (type == "para") {
        curve.f = parametric_curve(tag, refuse);
    } else {
        refuse(fmt::format("{} is of type \"{}\"; expected curv or para", name, printable(type)));
    }
    double least = kInfinity;
    double largest = -kInfinity;
    for (int i = 0; i < kCodes; ++i) {
        const double y = evaluate(curve.f, code(i));
        if (!(std::fabs(y) <= kHalfMax))
            refuse(fmt::format("{} gives {} for {}; expected a finite number", name, y, code(i)));
        least = std::min(least, y);
        largest = std::max(largest, y);
    }
    if (least == largest) refuse(fmt::format("{} is constant", name));
    return curve;
}

/// Equal bytes give the same function, so that one curve serves all channels.
std::array<Curve, 3> read_curves(const IccTags& tags, const RefuseIcc& refuse) {
    std::array<Curve, 3> curves;
    constexpr std::array<const char*, 3> kNames = {"rTRC", "gTRC", "bTRC"};
    for (std::size_t c = 0; c < 3; ++c) {
        const std::string_view tag = tags.find(kNames[c]);
        curves[c] =
            c > 0 && tag == curves[0].bytes ? curves[0] : read_curve(tags, kNames[c], refuse);
    }
    return curves;
}

/// Linear RGB -> XYZ of the connection space: the colorants are its columns.
Matrix3 read_colorants(const IccTags& tags, const RefuseIcc& refuse) {
    Matrix3 m{};
    constexpr std::array<const char*, 3> kNames = {"rXYZ", "gXYZ", "bXYZ"};
    for (std::size_t c = 0; c < 3; ++c) {
        const std::string_view tag = tags.find(kNames[c]);
        if (tag.empty()) refuse(fmt::format("there is no tag {}", kNames[c]));
        if (tag.substr(0, 4) != "XYZ " || tag.size() < 20)
            refuse(fmt::format("{} is no XYZ number", kNames[c]));
        for (std::size_t i = 0; i < 3; ++i)
            m[i][c] = fixed_number(tag, 8 + 4 * i);
    }
    const double determinant = m[0][0] * (m[1][1] * m[2][2] - m[1][2] * m[2][1]) -
                               m[0][1] * (m[1][0] * m[2][2] - m[1][2] * m[2][0]) +
                               m[0][2] * (m[1][0] * m[2][1] - m[1][1] * m[2][0]);
    // sRGB has 0.2, ACES2065-1 0.8.
    if (!(std::fabs(determinant) > 1e-4)) refuse("the colorants lie on one line");
    return m;
}

/// A color that profiles agree with.
struct Known {
    SourceColor color;
    Matrix3 to_connection;  // linear RGB -> XYZ of the connection space
};

Matrix3 to_connection(const Primaries& p) {
    return multiply(bradford_adaptation(kD65, kD50), rgb_to_xyz_d65(p));
}

/// Displays first: their names are the shorter ones.
const std::vector<Known>& known_colors() {
    static const std::vector<Known> colors = [] {
        std::vector<Known> all;
        const auto add = [&](SourceColor color) {
            const Matrix3 m = to_connection(color.primaries);
            all.push_back({std::move(color), m});
        };
        for (const Display& display : all_displays()) {
            if (!display.is_hdr) add(find_source_color(display.id));
        }
        add(find_source_color("Rec709"));
        for (const InputSpace& space : all_input_spaces())
            add(find_source_color(space.id));
        // Their exponents as the profiles of Adobe and Kodak have them, in u8Fixed8Number.
        const auto power = [&](const char* name, const Primaries& primaries, double exponent) {
            add({name, primaries, {curve_stage(power_decode(Expr::input(), exponent))}});
        };
        // Adobe RGB (1998) Color Image Encoding, version 2005-05, 4.3.1 and 4.3.4.
        power("Adobe RGB (1998)", {"Adobe RGB", {0.64, 0.33}, {0.21, 0.71}, {0.15, 0.06}, kD65},
              563 / 256.0);
        // ANSI/I3A IT10.7666 (ROMM RGB), without its straight part.
        power("ProPhoto RGB",
              {"ProPhoto", {0.7347, 0.2653}, {0.1596, 0.8404}, {0.0366, 0.0001}, {0.3457, 0.3585}},
              461 / 256.0);
        return all;
    }();
    return colors;
}

/// Makers round colorants differently: those of HP's sRGB and Adobe's own profile are up to 0.0003
/// away from the ones of their standards. Other spaces are 0.01 away.
bool is_near(const Matrix3& a, const Matrix3& b) {
    constexpr double kRounding = 4e-4;
    for (std::size_t i = 0; i < 3; ++i) {
        for (std::size_t c = 0; c < 3; ++c) {
            if (!(std::fabs(a[i][c] - b[i][c]) <= kRounding)) return false;
        }
    }
    return true;
}

/// Sampled curves have 16 bits, and some makers cut them off.
bool is_decoded_by(const Pipeline& decode, const Expr& f) {
    constexpr double kRounding = 1.5 / 65535;
    const Expr known = compose(decode)[0];
    for (int i = 0; i < kCodes; ++i) {
        const std::array<double, 3> gray = {code(i), code(i), code(i)};
        if (!(std::fabs(evaluate(known, gray) - evaluate(f, code(i))) <= kRounding)) return false;
    }
    return true;
}

/// The known color with this matrix and these curves; null: none.
const SourceColor* find_known(const Matrix3& colorants, const std::array<Curve, 3>& curves) {
    for (const Known& known : known_colors()) {
        if (!is_near(known.to_connection, colorants)) continue;
        const bool is_same = std::all_of(curves.begin(), curves.end(), [&](const Curve& curve) {
            return is_decoded_by(known.color.decode, curve.f);
        });
        if (is_same) return &known.color;
    }
    return nullptr;
}

std::string unique_name(const std::string& description, std::string_view defining) {
    return fmt::format("ICC: {}{}({})", description, description.empty() ? "" : " ",
                       content_hash(defining));
}

CurveStage stage_of(const std::array<Curve, 3>& curves) {
    return {{curves[0].f, curves[1].f, curves[2].f}, std::nullopt, "decode"};
}

/// Sets the primaries, or appends the matrix to Rec.709 where the profile's white is another one
/// than D50: cameras without white balance, and profiles that forgot the adaptation.
void add_colorants(SourceColor& color, const Matrix3& colorants) {
    const Matrix3 xyz = multiply(bradford_adaptation(kD50, kD65), colorants);
    const auto column = [&](std::size_t c) { return Vector3{xyz[0][c], xyz[1][c], xyz[2][c]}; };
    const Vector3 white = multiply(xyz, Vector3{1, 1, 1});
    const Vector3 d65 = xyz_of(kD65);
    // Rounded colorants tint white by up to this; the primaries keep grays neutral.
    constexpr double kRounding = 2e-3;
    bool has_primaries = true;
    for (std::size_t i = 0; i < 3; ++i) {
        has_primaries = has_primaries && std::fabs(white[i] - d65[i]) <= kRounding &&
                        std::fabs(xyz[0][i] + xyz[1][i] + xyz[2][i]) > 1e-3;
    }
    if (has_primaries) {
        color.primaries = {"ICC profile", chromaticity_of(column(0)), chromaticity_of(column(1)),
                           chromaticity_of(column(2)), chromaticity_of(white)};
    } else {
        color.primaries = kRec709;
        color.decode.push_back(
            MatrixStage{multiply(inverse(rgb_to_xyz(kRec709)), xyz), "to_rec709"});
    }
}

SourceColor color_of_matrix(const IccTags& tags, const std::string& description,
                            const RefuseIcc& refuse) {
    const Matrix3 colorants = read_colorants(tags, refuse);
    const std::array<Curve, 3> curves = read_curves(tags, refuse);
    if (const SourceColor* known = find_known(colorants, curves)) return *known;
    std::string defining;
    for (const char* name : {"rXYZ", "gXYZ", "bXYZ", "rTRC", "gTRC", "bTRC"})
        defining += tags.find(name);
    SourceColor color = {unique_name(description, defining), kRec709, {stage_of(curves)}};
    add_colorants(color, colorants);
    return color;
}

/// CIE 1976 L*, 1 for white -> Y.
Expr luminance_of_lightness(const Expr& lightness) {
    const Expr t = (100 * lightness + 16) / 116;
    constexpr double kCorner = 6.0 / 29;
    return select(less_equal(t, kCorner), (t - 4.0 / 29) * (3 * kCorner * kCorner), t * t * t);
}

SourceColor color_of_gray(const IccTags& tags, bool has_lightness, const std::string& description,
                          const RefuseIcc& refuse) {
    Curve curve = read_curve(tags, "kTRC", refuse);
    if (has_lightness) curve.f = luminance_of_lightness(curve.f);
    const std::array<Curve, 3> curves = {curve, curve, curve};
    if (const SourceColor* known = find_known(to_connection(kRec709), curves)) return *known;
    return {unique_name(description, (has_lightness ? "L" : "Y") + std::string(tags.find("kTRC"))),
            kRec709,
            {stage_of(curves)}};
}

/// textDescriptionType of version 2; multiLocalizedUnicodeType of version 4, ICC.1:2022, 10.15.
std::string description_of(const IccTags& tags) {
    const std::string_view tag = tags.find("desc");
    std::string text;
    if (tag.substr(0, 4) == "desc" && tag.size() >= 12) {
        text = tag.substr(12, big_endian(tag, 8, 4));
    } else if (tag.substr(0, 4) == "mluc" && tag.size() >= 28) {
        std::size_t entry = 16;
        const std::size_t count = std::min<std::size_t>(big_endian(tag, 8, 4), 100);
        for (std::size_t i = 0; i < count && 16 + 12 * (i + 1) <= tag.size(); ++i) {
            if (tag.substr(16 + 12 * i, 2) != "en") continue;
            entry = 16 + 12 * i;
            break;
        }
        const std::size_t at = big_endian(tag, entry + 8, 4);
        const std::size_t length = big_endian(tag, entry + 4, 4);
        if (at < tag.size()) {
            for (std::size_t i = at; i + 2 <= std::min(tag.size(), at + length); i += 2) {
                const std::uint32_t unit = big_endian(tag, i, 2);
                text += unit < 128 ? static_cast<char>(unit) : '?';
            }
        }
    }
    text = text.substr(0, text.find('\0'));
    return printable(trimmed(text));
}

std::optional<std::pair<int, int>> code_points_of(const IccTags& tags) {
    const std::string_view tag = tags.find("cicp");
    if (tag.size() < 12 || tag.substr(0, 4) != "cicp") return std::nullopt;
    return std::pair(static_cast<int>(big_endian(tag, 8, 1)),
                     static_cast<int>(big_endian(tag, 9, 1)));
}

/// Relative colorimetric: the tags that LittleCMS takes for it, in their order.
constexpr std::array<const char*, 3> kTables = {"D2B1", "A2B1", "A2B0"};

#ifdef TONEWRIGHT_HAVE_LCMS2

/// A profile's tables -> linear Rec.709.
class Tables {
  public:
    Tables(std::string_view profile, bool is_gray, const RefuseIcc& refuse) : is_gray_(is_gray) {
        const IccOwned<void> from(cmsOpenProfileFromMemTHR(
            context_.get(), profile.data(), static_cast<std::uint32_t>(profile.size())));
        const cmsCIExyY white = {kD65.x, kD65.y, 1};
        const auto xyy = [](const Chromaticity& c) { return cmsCIExyY{c.x, c.y, 1}; };
        const cmsCIExyYTRIPLE rgb = {xyy(kRec709.red), xyy(kRec709.green), xyy(kRec709.blue)};
        const IccOwned<cmsToneCurve> linear(cmsBuildGamma(context_.get(), 1));
        const std::array<cmsToneCurve*, 3> curves = {linear.get(), linear.get(), linear.get()};
        const IccOwned<void> to(
            linear ? cmsCreateRGBProfileTHR(context_.get(), &white, &rgb, curves.data()) : nullptr);
        if (from && to) {
            // One without a cache serves several threads.
            transform_.reset(cmsCreateTransformTHR(context_.get(), from.get(),
                                                   is_gray ? TYPE_GRAY_FLT : TYPE_RGB_FLT, to.get(),
                                                   TYPE_RGB_FLT, INTENT_RELATIVE_COLORIMETRIC,
                                                   cmsFLAGS_NOOPTIMIZE | cmsFLAGS_NOCACHE));
        }
        if (!transform_)
            refuse(message_.empty() ? "its tables cannot be used" : printable(message_, 300));
    }

    void run(const float* in, float* out, std::size_t count) const {
        constexpr std::size_t kChunk = 256;
        constexpr auto kLimit = static_cast<float>(kHalfMax);
        std::array<float, 3 * kChunk> numbers;  // NOLINT(*-init): written below
        const std::size_t channels = is_gray_ ? 1 : 3;
        for (std::size_t done = 0; done < count; done += kChunk) {
            const std::size_t n = std::min(count - done, kChunk);
            for (std::size_t i = 0; i < n * channels; ++i) {
                const float v = in[3 * done + (is_gray_ ? 3 * i : i)];
                numbers[i] = std::isnan(v) ? 0.0F : std::clamp(v, -kLimit, kLimit);
            }
            float* to = out + 3 * done;
            cmsDoTransform(transform_.get(), numbers.data(), to, static_cast<cmsUInt32Number>(n));
            for (std::size_t i = 0; i < 3 * n; ++i)
                to[i] = std::isnan(to[i]) ? 0.0F : std::clamp(to[i], -kLimit, kLimit);
        }
    }

  private:
    struct Delete {
        void operator()(void* transform) const { cmsDeleteTransform(transform); }
    };
    std::string message_;
    IccContext context_ = make_icc_context(message_);
    std::unique_ptr<void, Delete> transform_;
    bool is_gray_;
};

SourceColor color_of_tables(std::string_view profile, const IccTags& tags, bool is_gray,
                            const std::string& description, const RefuseIcc& refuse) {
    for (const char* name : kTables) {
        const std::string_view tag = tags.find(name);
        if (tag.empty()) continue;
        if (name[0] == 'D') {
            check_icc_elements(name, tag, refuse);
        } else {
            check_icc_table(name, tag, is_gray ? 1 : 3, refuse);
        }
    }
    const auto tables = std::make_shared<const Tables>(profile, is_gray, refuse);
    SourceColor color = {unique_name(description, profile), kRec709};
    color.convert = [tables](const float* in, float* out, std::size_t count) {
        tables->run(in, out, count);
    };
    return color;
}

#endif

/// Throws for profiles that describe other numbers than those of the picture.
/// @returns  true for a gray profile
bool check_kind(std::string_view profile, int channels, const RefuseIcc& refuse) {
    const std::string_view kind = profile.substr(kIccClass, 4);
    constexpr std::array<std::string_view, 4> kKinds = {"scnr", "mntr", "prtr", "spac"};
    if (std::find(kKinds.begin(), kKinds.end(), kind) == kKinds.end()) {
        refuse(fmt::format("class is \"{}\"; expected input, display, output or color space",
                           printable(kind)));
    }
    const std::string_view space = profile.substr(kIccSpace, 4);
    if (space != "RGB " && space != "GRAY") {
        refuse(
            fmt::format("color space is \"{}\"; expected \"RGB \" or \"GRAY\"", printable(space)));
    }
    const std::string_view connection = profile.substr(kIccConnectionSpace, 4);
    if (connection != "XYZ " && connection != "Lab ") {
        refuse(fmt::format("connection space is \"{}\"; expected \"XYZ \" or \"Lab \"",
                           printable(connection)));
    }
    const bool is_gray = space == "GRAY";
    if (is_gray && channels > 1)
        refuse(fmt::format("color space is \"GRAY\"; expected \"RGB \" for {} channels", channels));
    return is_gray;
}

}  // namespace

IccSource color_of_icc(std::string_view profile, int channels, const std::string& what) {
    const RefuseIcc refuse = [&](const std::string& reason) {
        throw Error(fmt::format("{}: ICC profile: {}", what, reason));
    };
    const RefuseIcc damaged = [&](const std::string& reason) {
        throw Error(fmt::format("{}: ICC profile is damaged: {}", what, reason));
    };
    if (profile.size() > kLongest)
        refuse(fmt::format("it has {} bytes; expected at most {}", profile.size(), kLongest));
    const IccTags tags(profile, damaged);
    const bool is_gray = check_kind(profile, channels, refuse);
    IccSource source;
    source.description = description_of(tags);
    source.code_points = code_points_of(tags);
    source.has_tables = std::any_of(kTables.begin(), kTables.end(),
                                    [&](const char* name) { return tags.count(name) > 0; });
    const bool has_lab = profile.substr(kIccConnectionSpace, 4) == "Lab ";
    if (source.has_tables) {
#ifdef TONEWRIGHT_HAVE_LCMS2
        source.color = color_of_tables(profile, tags, is_gray, source.description, damaged);
#else
        refuse(
            "it has tables, and this build has no Little CMS; expected one configured with "
            "TONEWRIGHT_WITH_ICC");
#endif
    } else if (is_gray) {
        source.color = color_of_gray(tags, has_lab, source.description, damaged);
    } else {
        if (has_lab) damaged("its connection space is Lab, and it has no table A2B0");
        source.color = color_of_matrix(tags, source.description, damaged);
    }
    return source;
}

TONEWRIGHT_NAMESPACE_END
