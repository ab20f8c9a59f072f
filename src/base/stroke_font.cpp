// SPDX-License-Identifier: Apache-2.0
//
// A built-in stroke font for labels in pictures and plots: no font file has to be installed, and
// every machine draws the same picture at any size.
#include "base/stroke_font.h"

#include <fmt/format.h>

#include <array>
#include <charconv>
#include <cmath>
#include <numbers>
#include <string_view>

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

struct GlyphSource {
    float width;
    /// M x y: move; L x y: line; E cx cy rx ry: ellipse; A cx cy rx ry from to: arc in degrees,
    /// counterclockwise where from < to, joined to what was drawn last; S: the same, not joined.
    const char* path;
};

// clang-format off
constexpr std::array<GlyphSource, 95> kGlyphs = {{
    /*   */ {2.0F, ""},
    /* ! */ {0.0F, "M0 7 L0 2.2 M0 0 L0 0.4"},
    /* " */ {1.4F, "M0 7 L0 5.2 M1.4 7 L1.4 5.2"},
    /* # */ {4.2F, "M1.2 0 L1.7 7 M3 0 L3.5 7 M0 2.2 L4 2.2 M0.3 4.8 L4.3 4.8"},
    /* $ */ {3.8F, "S1.95 5.05 1.75 1.55 35 270 A1.95 1.95 1.9 1.55 90 -145 M1.95 -0.8 L1.95 7.8"},
    /* % */ {5.0F, "M0.6 0 L4.4 7 E1 5.6 1 1.4 E4 1.4 1 1.4"},
    /* & */ {4.6F, "M4.6 0 L1 4.6 S1.95 5.5 1.3 1.5 220 -30 L0.7 3.1 A1.7 1.6 "
                   "1.7 1.6 120 330 L4.3 3.4"},
    /* ' */ {0.0F, "M0 7 L0 5.2"},
    /* ( */ {1.1F, "S3 3 3 6 130 230"},
    /* ) */ {1.1F, "S-1.9 3 3 6 50 -50"},
    /* * */ {2.6F, "M1.3 7 L1.3 4 M0 6.2 L2.6 4.8 M0 4.8 L2.6 6.2"},
    /* + */ {3.4F, "M0 3 L3.4 3 M1.7 1.3 L1.7 4.7"},
    /* , */ {0.4F, "M0.4 0.2 L0 -1.2"},
    /* - */ {2.0F, "M0 2.8 L2 2.8"},
    /* . */ {0.0F, "M0 0 L0 0.4"},
    /* / */ {2.6F, "M0 -0.8 L2.6 7.6"},
    /* 0 */ {3.8F, "E1.9 3.5 1.9 3.5"},
    /* 1 */ {3.8F, "M0.7 5.5 L2.3 7 L2.3 0"},
    /* 2 */ {3.8F, "S1.9 5.2 1.8 1.8 165 -35 L0 0 L3.8 0"},
    /* 3 */ {3.8F, "S1.8 5.3 1.65 1.7 150 -90 A1.85 1.8 1.9 1.8 90 -150"},
    /* 4 */ {3.8F, "M2.9 0 L2.9 7 L0 2.1 L3.9 2.1"},
    /* 5 */ {3.8F, "M3.5 7 L0.6 7 L0.34 3.84 A1.75 2.25 2 2.25 135 -145"},
    /* 6 */ {3.8F, "E1.9 2.2 1.9 2.2 M3 7 L0.25 3.3"},
    /* 7 */ {3.8F, "M0 7 L3.8 7 L1.2 0"},
    /* 8 */ {3.8F, "E1.9 5.35 1.6 1.65 E1.9 1.85 1.9 1.85"},
    /* 9 */ {3.8F, "E1.9 4.8 1.9 2.2 M0.8 0 L3.55 3.7"},
    /* : */ {0.0F, "M0 0 L0 0.4 M0 4 L0 4.4"},
    /* ; */ {0.4F, "M0.4 0.2 L0 -1.2 M0.4 4 L0.4 4.4"},
    /* < */ {3.2F, "M3.2 5.4 L0 3 L3.2 0.6"},
    /* = */ {3.4F, "M0 4 L3.4 4 M0 2 L3.4 2"},
    /* > */ {3.2F, "M0 5.4 L3.2 3 L0 0.6"},
    /* ? */ {3.2F, "S1.6 5.3 1.6 1.7 165 -55 L1.6 2.2 M1.6 0 L1.6 0.4"},
    /* @ */ {6.0F, "E2.8 2.6 1.2 1.5 M4 4.1 L4 1.9 A5 1.9 1 0.8 180 360 L6 2.8 A3 2.8 3 3.6 0 310"},
    /* A */ {4.6F, "M0 0 L2.3 7 L4.6 0 M0.8 2.3 L3.8 2.3"},
    /* B */ {4.0F, "M0 0 L0 7 L2.2 7 A2.2 5.3 1.6 1.7 90 -90 L0 3.6 M2.2 3.6 "
                   "A2.3 1.8 1.7 1.8 90 -90 L0 0"},
    /* C */ {4.2F, "S2.4 3.5 2.4 3.5 48 312"},
    /* D */ {4.4F, "M0 0 L0 7 L1.6 7 A1.6 3.5 2.8 3.5 90 -90 L0 0"},
    /* E */ {3.5F, "M3.5 7 L0 7 L0 0 L3.5 0 M0 3.6 L3 3.6"},
    /* F */ {3.4F, "M3.4 7 L0 7 L0 0 M0 3.6 L2.9 3.6"},
    /* G */ {4.8F, "S2.4 3.5 2.4 3.5 48 360 L2.8 3.5"},
    /* H */ {4.4F, "M0 0 L0 7 M4.4 0 L4.4 7 M0 3.6 L4.4 3.6"},
    /* I */ {0.0F, "M0 0 L0 7"},
    /* J */ {2.8F, "M2.8 7 L2.8 1.6 A1.4 1.6 1.4 1.6 0 -180"},
    /* K */ {4.1F, "M0 0 L0 7 M4 7 L0 2.8 M1.4 4.2 L4.1 0"},
    /* L */ {3.3F, "M0 7 L0 0 L3.3 0"},
    /* M */ {5.2F, "M0 0 L0 7 L2.6 2 L5.2 7 L5.2 0"},
    /* N */ {4.4F, "M0 0 L0 7 L4.4 0 L4.4 7"},
    /* O */ {5.0F, "E2.5 3.5 2.5 3.5"},
    /* P */ {3.9F, "M0 0 L0 7 L2.1 7 A2.1 5.1 1.8 1.9 90 -90 L0 3.2"},
    /* Q */ {5.0F, "E2.5 3.5 2.5 3.5 M3.2 1.7 L5 -0.4"},
    /* R */ {4.1F, "M0 0 L0 7 L2.1 7 A2.1 5.1 1.8 1.9 90 -90 L0 3.2 M2.1 3.2 L4.1 0"},
    /* S */ {3.8F, "S1.95 5.25 1.75 1.75 35 270 A1.95 1.75 1.9 1.75 90 -145"},
    /* T */ {4.4F, "M0 7 L4.4 7 M2.2 7 L2.2 0"},
    /* U */ {4.3F, "M0 7 L0 2.15 A2.15 2.15 2.15 2.15 180 360 L4.3 7"},
    /* V */ {4.6F, "M0 7 L2.3 0 L4.6 7"},
    /* W */ {6.4F, "M0 7 L1.6 0 L3.2 6 L4.8 0 L6.4 7"},
    /* X */ {4.4F, "M0 0 L4.4 7 M0 7 L4.4 0"},
    /* Y */ {4.4F, "M0 7 L2.2 3.3 L4.4 7 M2.2 3.3 L2.2 0"},
    /* Z */ {4.2F, "M0 7 L4.2 7 L0 0 L4.2 0"},
    /* [ */ {1.2F, "M1.2 7.6 L0 7.6 L0 -1 L1.2 -1"},
    /* \ */ {2.6F, "M0 7.6 L2.6 -0.8"},
    /* ] */ {1.2F, "M0 7.6 L1.2 7.6 L1.2 -1 L0 -1"},
    /* ^ */ {2.8F, "M0 5 L1.4 7 L2.8 5"},
    /* _ */ {4.0F, "M0 -0.8 L4 -0.8"},
    /* ` */ {0.8F, "M0 7 L0.8 5.8"},
    /* a */ {3.6F, "E1.8 2.5 1.8 2.5 M3.6 5 L3.6 0"},
    /* b */ {3.6F, "M0 7 L0 0 E1.8 2.5 1.8 2.5"},
    /* c */ {3.1F, "S1.85 2.5 1.85 2.5 48 312"},
    /* d */ {3.6F, "E1.8 2.5 1.8 2.5 M3.6 7 L3.6 0"},
    /* e */ {3.6F, "M0 2.6 L3.6 2.6 A1.8 2.5 1.8 2.5 2 312"},
    /* f */ {2.2F, "S2.3 5.6 1.4 1.4 85 180 L0.9 0 M0 4.8 L2.2 4.8"},
    /* g */ {3.6F, "E1.8 2.5 1.8 2.5 M3.6 5 L3.6 -0.4 A1.8 -0.4 1.8 1.7 0 -150"},
    /* h */ {3.4F, "M0 7 L0 0 M0 3.2 A1.7 3.2 1.7 1.8 180 0 L3.4 0"},
    /* i */ {0.0F, "M0 5 L0 0 M0 6.6 L0 6.9"},
    /* j */ {0.9F, "M0.9 5 L0.9 -0.9 A-0.1 -0.9 1 1.1 0 -90 M0.9 6.6 L0.9 6.9"},
    /* k */ {3.3F, "M0 7 L0 0 M3.1 5 L0 1.9 M1.2 3.1 L3.3 0"},
    /* l */ {0.0F, "M0 7 L0 0"},
    /* m */ {5.6F, "M0 5 L0 0 M0 3.5 A1.4 3.5 1.4 1.5 180 0 L2.8 0 M2.8 3.5 "
                   "A4.2 3.5 1.4 1.5 180 0 L5.6 0"},
    /* n */ {3.4F, "M0 5 L0 0 M0 3.2 A1.7 3.2 1.7 1.8 180 0 L3.4 0"},
    /* o */ {3.7F, "E1.85 2.5 1.85 2.5"},
    /* p */ {3.6F, "M0 5 L0 -2 E1.8 2.5 1.8 2.5"},
    /* q */ {3.6F, "E1.8 2.5 1.8 2.5 M3.6 5 L3.6 -2"},
    /* r */ {2.1F, "M0 5 L0 0 M0 3.2 A1.8 3.2 1.8 1.8 180 75"},
    /* s */ {3.0F, "S1.5 3.75 1.35 1.25 35 270 A1.5 1.25 1.45 1.25 90 -145"},
    /* t */ {2.2F, "M0.8 6.6 L0.8 1.3 A2.1 1.3 1.3 1.3 180 275 M0 4.9 L2.2 4.9"},
    /* u */ {3.4F, "M0 5 L0 1.8 A1.7 1.8 1.7 1.8 180 360 M3.4 5 L3.4 0"},
    /* v */ {3.4F, "M0 5 L1.7 0 L3.4 5"},
    /* w */ {5.0F, "M0 5 L1.25 0 L2.5 4.4 L3.75 0 L5 5"},
    /* x */ {3.4F, "M0 5 L3.4 0 M0 0 L3.4 5"},
    /* y */ {3.4F, "M0 5 L1.72 0.1 M3.4 5 L1 -2"},
    /* z */ {3.0F, "M0 5 L3 5 L0 0 L3 0"},
    /* { */ {1.6F, "M1.6 7.6 L0.8 7.2 L0.8 4 L0 3.3 L0.8 2.6 L0.8 -0.6 L1.6 -1"},
    /* | */ {0.0F, "M0 7.6 L0 -1"},
    /* } */ {1.6F, "M0 7.6 L0.8 7.2 L0.8 4 L1.6 3.3 L0.8 2.6 L0.8 -0.6 L0 -1"},
    /* ~ */ {3.6F, "M0 2.5 L0.9 3.4 L2.7 2.4 L3.6 3.3"},
}};
// clang-format on

/// Calls the pen for each command of a glyph: move(x, y), line(x, y), and
/// arc(cx, cy, rx, ry, from, to, is_joined).
template <class Pen>
void draw(std::string_view path, Pen&& pen) {
    std::size_t at = 0;
    std::array<float, 6> n{};
    // Not strtof: a host program may have set a locale with a decimal comma.
    const auto read = [&](std::size_t count) {
        for (std::size_t i = 0; i < count; ++i) {
            at = path.find_first_not_of(' ', at);
            const auto end = std::from_chars(path.data() + at, path.data() + path.size(), n[i]).ptr;
            at = static_cast<std::size_t>(end - path.data());
        }
    };
    while (at < path.size()) {
        const char command = path[at++];
        switch (command) {
            case 'M':
                read(2);
                pen.move(n[0], n[1]);
                break;
            case 'L':
                read(2);
                pen.line(n[0], n[1]);
                break;
            case 'E':
                read(4);
                pen.arc(n[0], n[1], n[2], n[3], 0, 360, false);
                break;
            case 'A':
            case 'S':
                read(6);
                pen.arc(n[0], n[1], n[2], n[3], n[4], n[5], command == 'A');
                break;
            default:
                break;  // spaces
        }
    }
}

float advance_of(const GlyphSource& source) {
    return source.width + static_cast<float>(kLetterSpacing);
}

/// Makes line segments.
class StrokePen {
  public:
    explicit StrokePen(std::vector<Stroke>& strokes) : strokes_(strokes) {}
    void move(float x, float y) {
        x_ = x;
        y_ = y;
    }
    void line(float x, float y) {
        strokes_.push_back({x_, y_, x, y});
        move(x, y);
    }
    void arc(float cx, float cy, float rx, float ry, float from, float to, bool is_joined) {
        const int pieces = 2 + static_cast<int>(std::fabs(to - from) / 12);
        for (int i = 0; i <= pieces; ++i) {
            const float degrees =
                from + (to - from) * static_cast<float>(i) / static_cast<float>(pieces);
            const float angle = degrees * std::numbers::pi_v<float> / 180;
            const float x = cx + rx * std::cos(angle);
            const float y = cy + ry * std::sin(angle);
            if (i > 0 || is_joined) {
                line(x, y);
            } else {
                move(x, y);
            }
        }
    }

  private:
    std::vector<Stroke>& strokes_;
    float x_ = 0;
    float y_ = 0;
};

/// Makes commands of an SVG path, in whole hundredths of a unit. Commands are relative, which is
/// shorter; points are rounded before, so that no error adds up.
class SvgPen {
  public:
    /// @param left  of the glyph
    void begin_glyph(float left) { left_ = left; }
    void move(float x, float y) { add('m', rounded(left_ + x), rounded(y)); }
    void line(float x, float y) {
        const long to_x = rounded(left_ + x);
        const long to_y = rounded(y);
        if (to_x == x_ && to_y == y_) return;
        if (to_y == y_) {
            path_ += fmt::format("h{}", to_x - x_);
        } else if (to_x == x_) {
            path_ += fmt::format("v{}", to_y - y_);
        } else {
            add('l', to_x, to_y);
        }
        x_ = to_x;
        y_ = to_y;
    }
    void arc(float cx, float cy, float rx, float ry, float from, float to, bool is_joined) {
        const auto point = [&](float degrees) {
            const float angle = degrees * std::numbers::pi_v<float> / 180;
            return std::array{cx + rx * std::cos(angle), cy + ry * std::sin(angle)};
        };
        const auto [x, y] = point(from);
        if (is_joined) {
            line(x, y);
        } else {
            move(x, y);
        }
        // An arc of SVG has two ends that differ.
        const int pieces = std::fabs(to - from) < 360 ? 1 : 2;
        for (int i = 1; i <= pieces; ++i) {
            const float turn = (to - from) / static_cast<float>(pieces);
            const auto [to_x, to_y] = point(from + turn * static_cast<float>(i));
            path_ += fmt::format("a{} {} 0 {} {}", rounded(rx), rounded(ry),
                                 std::fabs(turn) > 180 ? 1 : 0, turn > 0 ? 1 : 0);
            add(' ', rounded(left_ + to_x), rounded(to_y));
        }
    }
    [[nodiscard]] std::string take() { return std::move(path_); }

  private:
    [[nodiscard]] static long rounded(float value) { return std::lround(100 * value); }
    void add(char before, long x, long y) {
        const long dy = y - y_;
        path_ += fmt::format("{}{}{}{}", before, x - x_, dy < 0 ? "" : " ", dy);
        x_ = x;
        y_ = y;
    }

    float left_ = 0;
    long x_ = 0;  // where the pen is
    long y_ = 0;
    std::string path_;
};

std::size_t index_of(char character) {
    const int index = static_cast<unsigned char>(character) - ' ';
    return index >= 0 && index < static_cast<int>(kGlyphs.size())
               ? static_cast<std::size_t>(index)
               : static_cast<std::size_t>('?' - ' ');
}

}  // namespace

const Glyph& glyph_of(char character) {
    static const std::array<Glyph, kGlyphs.size()> glyphs = [] {
        std::array<Glyph, kGlyphs.size()> all;
        for (std::size_t i = 0; i < all.size(); ++i) {
            all[i].advance = advance_of(kGlyphs[i]);
            draw(kGlyphs[i].path, StrokePen(all[i].strokes));
        }
        return all;
    }();
    return glyphs[index_of(character)];
}

double stroke_text_width(std::string_view text) {
    double width = 0;
    for (const char c : text)
        width += static_cast<double>(glyph_of(c).advance);
    return text.empty() ? 0 : width - kLetterSpacing;
}

std::string stroke_text_path(std::string_view text) {
    SvgPen pen;
    float left = 0;
    for (const char c : text) {
        const GlyphSource& source = kGlyphs[index_of(c)];
        pen.begin_glyph(left);
        draw(source.path, pen);
        left += advance_of(source);
    }
    return pen.take();
}

TONEWRIGHT_NAMESPACE_END
