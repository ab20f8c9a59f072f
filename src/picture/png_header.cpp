// SPDX-License-Identifier: Apache-2.0
#include "picture/png_header.h"

#include <png.h>

#include <array>
#include <charconv>
#include <csetjmp>
#include <string_view>
#include <system_error>
#include <vector>

#include "base/strings.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

using T = OIIO::TypeDesc;

bool is_text(const PictureAttribute& attribute) {
    return attribute.type == T(T::STRING) && !attribute.texts.empty();
}

/// The attribute is absent or of the type that OpenImageIO's writer expects; it converts others.
bool is_plain(const PictureSpec& spec, std::string_view name, OIIO::TypeDesc type) {
    const PictureAttribute* const found = spec.find_attribute(name);
    return !found || found->type == type;
}

/// Reads one whole number after blanks.
bool take_int(std::string_view& text, int& value) {
    text.remove_prefix(std::min(text.find_first_not_of(" \t\n\r\f\v"), text.size()));
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (error != std::errc()) return false;
    text.remove_prefix(static_cast<std::size_t>(end - text.data()));
    return true;
}

bool take_one_of(std::string_view& text, std::string_view characters) {
    if (text.empty() || characters.find(text.front()) == std::string_view::npos) return false;
    text.remove_prefix(1);
    return true;
}

/// `2026:11:30 12:00:00`, also with `-` or `/`; OpenImageIO leaves other times out.
std::optional<png_time> time_of(std::string_view text) {
    int year = 0, month = 0, day = 0, hour = 0, minute = 0, second = 0;
    const bool is_read = take_int(text, year) && take_one_of(text, ":-/") &&
                         take_int(text, month) && take_one_of(text, ":-/") && take_int(text, day) &&
                         take_int(text, hour) && take_one_of(text, ":") && take_int(text, minute) &&
                         take_one_of(text, ":") && take_int(text, second);
    const auto is_within = [](int value, int least, int most) {
        return value >= least && value <= most;
    };
    if (!is_read || !is_within(month, 1, 12) || !is_within(day, 1, 31) || !is_within(hour, 0, 23) ||
        !is_within(minute, 0, 59) || !is_within(second, 0, 59)) {
        return {};
    }
    return png_time{static_cast<png_uint_16>(year), static_cast<png_byte>(month),
                    static_cast<png_byte>(day),     static_cast<png_byte>(hour),
                    static_cast<png_byte>(minute),  static_cast<png_byte>(second)};
}

/// Pixels per meter, or of an unknown unit.
struct Resolution {
    float x, y;
    int unit;
};
std::optional<Resolution> resolution_of(const PictureSpec& spec) {
    const std::string unit = spec.get_string_attribute("ResolutionUnit");
    float x = spec.get_float_attribute("XResolution");
    float y = spec.get_float_attribute("YResolution");
    const float aspect = spec.get_float_attribute("PixelAspectRatio");
    if (x == 0 && y == 0 && aspect == 0 && unit.empty()) return {};
    // The aspect ratio takes precedence over the second resolution.
    if (aspect != 0) (x != 0 ? y : x) = 0;
    const float ratio = aspect != 0 ? aspect : 1;
    if (x == 0 && y == 0) x = 100;
    if (x == 0) {
        x = y / ratio;
    } else if (y == 0) {
        y = x * ratio;
    }
    struct Unit {
        std::string_view name;
        float per_meter;
    };
    constexpr std::array<Unit, 5> kUnits = {
        {{"meter", 1}, {"m", 1}, {"cm", 100}, {"inch", 100 / 2.54F}, {"in", 100 / 2.54F}}};
    for (const Unit& known : kUnits) {
        if (is_same_name(unit, known.name))
            return Resolution{x * known.per_meter, y * known.per_meter, PNG_RESOLUTION_METER};
    }
    return Resolution{x, y, PNG_RESOLUTION_UNKNOWN};
}

/// The value of the chunk gAMA; 0: none.
float gamma_of(const PictureSpec& spec, std::string_view space) {
    constexpr std::string_view kGamma = "gamma";
    if (is_same_name(space, "Linear")) return 1;
    if (space.size() < kGamma.size() || !is_same_name(space.substr(0, kGamma.size()), kGamma))
        return 0;
    float power = 0;
    std::from_chars(space.data() + kGamma.size(), space.data() + space.size(), power);
    if (power < 0.01F || power > 10) power = spec.get_float_attribute("oiio:Gamma", 1);
    return 1 / power;
}

/// The keyword of a text; empty: the attribute has no text of its own.
std::string_view keyword_of(const PictureAttribute& attribute) {
    struct Keyword {
        std::string_view attribute, keyword;
    };
    constexpr std::array<Keyword, 11> kKeywords = {{{"planarconfig", ""},
                                                    {"compression", ""},
                                                    {"ResolutionUnit", ""},
                                                    {"XResolution", ""},
                                                    {"YResolution", ""},
                                                    {"DateTime", ""},
                                                    {"Artist", "Author"},
                                                    {"name", "Title"},
                                                    {"DocumentName", "Title"},
                                                    {"description", "Description"},
                                                    {"ImageDescription", "Description"}}};
    for (const Keyword& known : kKeywords) {
        if (is_same_name(attribute.name, known.attribute)) return known.keyword;
    }
    return attribute.name;
}

/// All that libpng gets. It jumps out of the function that calls it, past every destructor, so the
/// caller of that function owns everything.
struct Header {
    const PictureSpec& spec;
    float gamma = 0;
    bool is_srgb = false;
    const PictureAttribute* icc = nullptr;
    std::optional<Resolution> resolution = {};
    std::optional<png_time> time = {};
    std::vector<std::string> keywords = {};
    std::vector<png_text> texts = {};
    std::string bytes = {};
};

extern "C" {
void append_png_bytes(png_structp png, png_bytep from, std::size_t count) {
    auto& bytes = *static_cast<std::string*>(png_get_io_ptr(png));
    try {
        bytes.append(reinterpret_cast<const char*>(from), count);
    } catch (...) {
        png_error(png, "not enough memory");
    }
}
void flush_png_bytes(png_structp /*png*/) {}
[[noreturn]] void leave_png(png_structp png, png_const_charp /*message*/) { png_longjmp(png, 1); }
void ignore_png_warning(png_structp /*png*/, png_const_charp /*message*/) {}
}

bool write_header(png_structp png, png_infop info, Header& header) {
    if (setjmp(png_jmpbuf(png)) != 0) return false;  // NOLINT(cert-err52-cpp)
    const PictureSpec& spec = header.spec;
    png_set_write_fn(png, &header.bytes, append_png_bytes, flush_png_bytes);
    // Many profiles of sRGB are not those that libpng knows.
    png_set_option(png, PNG_SKIP_sRGB_CHECK_PROFILE, PNG_OPTION_ON);
    constexpr std::array<int, 4> kColorTypes = {PNG_COLOR_TYPE_GRAY, PNG_COLOR_TYPE_GRAY_ALPHA,
                                                PNG_COLOR_TYPE_RGB, PNG_COLOR_TYPE_RGB_ALPHA};
    png_set_IHDR(png, info, static_cast<png_uint_32>(spec.width),
                 static_cast<png_uint_32>(spec.height), spec.format.basetype == T::UINT8 ? 8 : 16,
                 kColorTypes.at(static_cast<std::size_t>(spec.nchannels - 1)), PNG_INTERLACE_NONE,
                 PNG_COMPRESSION_TYPE_DEFAULT, PNG_FILTER_TYPE_DEFAULT);
    png_set_oFFs(png, info, spec.x, spec.y, PNG_OFFSET_PIXEL);
    if (header.gamma != 0) png_set_gAMA(png, info, static_cast<double>(header.gamma));
    if (header.is_srgb) png_set_sRGB_gAMA_and_cHRM(png, info, PNG_sRGB_INTENT_ABSOLUTE);
    if (header.icc) {
        png_set_iCCP(png, info, "Embedded Profile", PNG_COMPRESSION_TYPE_BASE,
                     reinterpret_cast<png_const_bytep>(header.icc->data.data()),
                     static_cast<png_uint_32>(header.icc->data.size()));
    }
    if (header.resolution) {
        png_set_pHYs(png, info, static_cast<png_uint_32>(header.resolution->x),
                     static_cast<png_uint_32>(header.resolution->y), header.resolution->unit);
    }
    if (header.time) png_set_tIME(png, info, &*header.time);
    if (!header.texts.empty())
        png_set_text(png, info, header.texts.data(), static_cast<int>(header.texts.size()));
    png_write_info(png, info);
    return true;
}

}  // namespace

std::optional<std::string> png_header(const PictureSpec& spec) {
    for (const std::string_view name :
         {"XResolution", "YResolution", "PixelAspectRatio", "oiio:Gamma"}) {
        if (!is_plain(spec, name, T(T::FLOAT))) return {};
    }
    for (const std::string_view name : {"ResolutionUnit", "oiio:ColorSpace"}) {
        if (!is_plain(spec, name, T(T::STRING))) return {};
    }
    Header header{.spec = spec};
    const std::string space = spec.get_string_attribute("oiio:ColorSpace");
    header.gamma = gamma_of(spec, space);
    header.is_srgb = is_same_name(space, "sRGB");
    header.icc = spec.find_attribute("ICCProfile");
    if (header.icc && header.icc->data.empty()) header.icc = nullptr;
    header.resolution = resolution_of(spec);
    header.keywords.reserve(spec.attributes.size());  // texts point to them
    for (const PictureAttribute& attribute : spec.attributes) {
        if (!is_text(attribute)) continue;
        if (is_same_name(attribute.name, "DateTime")) header.time = time_of(attribute.texts[0]);
        const std::string_view keyword = keyword_of(attribute);
        if (keyword.empty()) continue;
        png_text& text = header.texts.emplace_back();
        text.compression = PNG_TEXT_COMPRESSION_NONE;
        text.key = header.keywords.emplace_back(keyword).data();
        text.text = const_cast<char*>(attribute.texts[0].c_str());  // libpng copies it
    }
    png_structp png =
        png_create_write_struct(PNG_LIBPNG_VER_STRING, nullptr, leave_png, ignore_png_warning);
    png_infop info = png ? png_create_info_struct(png) : nullptr;
    const bool is_written = info && write_header(png, info, header);
    png_destroy_write_struct(&png, &info);
    if (!is_written) return {};
    return std::move(header.bytes);
}

TONEWRIGHT_NAMESPACE_END
