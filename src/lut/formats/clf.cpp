// SPDX-License-Identifier: Apache-2.0
//
// Academy S-2014-006 (CLF), Autodesk's CTF, and ASC's CC as implemented in OpenColorIO. Names
// ignore case, as in OpenColorIO.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <vector>

#include "base/strings.h"
#include "lut/formats/formats.h"
#include "lut/formats/xml.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

constexpr std::string_view kSpace = " \t\r\n";

class ElementCheck {
  public:
    ElementCheck(const TextLines& text, const XmlElement& element, const XmlElement& parent)
        : text_(text), element_(element), parent_(parent) {}

    void check() {
        // OpenColorIO would read any file named there.
        if (element_.name == "reference")
            fail("Reference is not supported; expected the transform itself");
        const bool has_numbers =
            element_.name == "array" || element_.name == "indexmap" || holds_numbers();
        if (has_numbers && element_.body.find_first_of("<&") != element_.body.npos) {
            fail(fmt::format("{} has a tag, comment or reference in it; expected numbers",
                             printable(element_.title)));
        }
        if (element_.name == "array") {
            check_array(numbers_of_array(sizes("Array")));
        } else if (element_.name == "indexmap") {
            check_index_map(static_cast<std::size_t>(sizes("IndexMap")[0]));
        } else if (holds_numbers()) {
            check_numbers();
        }
    }

  private:
    [[noreturn]] void fail(const std::string& reason) const { text_.fail_at(line_, reason); }
    [[noreturn]] void refuse(std::string_view dim, const std::string& expected) const {
        fail("dim is " + (dim.empty() ? "empty" : printable(dim)) + "; expected " + expected);
    }

    /// Removes blanks and the next word of a body, and counts lines.
    std::string_view word(std::string_view& body) {
        for (; !body.empty() && kSpace.find(body.front()) != std::string_view::npos;
             body.remove_prefix(1))
            line_ += body.front() == '\n' ? 1 : 0;
        const std::string_view result = body.substr(0, body.find_first_of(kSpace));
        body.remove_prefix(result.size());
        return result;
    }

    /// Elements of color corrections and ranges, which OpenColorIO parses as floats.
    [[nodiscard]] bool holds_numbers() const {
        static constexpr std::array<std::string_view, 8> kNames = {
            "slope",      "offset",     "power",       "saturation",
            "mininvalue", "maxinvalue", "minoutvalue", "maxoutvalue"};
        return std::find(kNames.begin(), kNames.end(), element_.name) != kNames.end();
    }
    /// OpenColorIO refuses text that is no number.
    void check_numbers() {
        line_ = element_.body_line;
        std::string_view body = element_.body;
        for (std::string_view next = word(body); !next.empty(); next = word(body)) {
            const std::optional<double> value = parse_number(next);
            if (value && !is_float(*value))
                fail(fmt::format("{} is {}; expected a finite number", printable(element_.title),
                                 printable(next)));
        }
    }

    /// Numbers of dim: one to four, none above the largest table.
    [[nodiscard]] std::vector<int> sizes(const char* title) const {
        const std::optional<std::string> dim = element_.attribute("dim");
        if (!dim) fail(fmt::format("{} has no dim; expected dim=\"...\"", title));
        std::vector<int> sizes;
        for (std::size_t i = 0; i < dim->size();) {
            if (kSpace.find((*dim)[i]) != std::string_view::npos) {
                ++i;
                continue;
            }
            int value = 0;
            const auto r = std::from_chars(dim->data() + i, dim->data() + dim->size(), value);
            if (r.ec != std::errc() || value < 1 || sizes.size() == 4)
                refuse(*dim, "one to four whole numbers above 0");
            if (value > kLargestTable)
                refuse(*dim, fmt::format("numbers of at most {}", kLargestTable));
            sizes.push_back(value);
            i = static_cast<std::size_t>(r.ptr - dim->data());
        }
        if (sizes.empty()) refuse(*dim, "one to four whole numbers above 0");
        return sizes;
    }
    /// Declared count of numbers of an Array.
    [[nodiscard]] std::size_t numbers_of_array(const std::vector<int>& sizes) const {
        const std::string& parent = parent_.name;
        const std::string dim = fmt::format("{}", fmt::join(sizes, " "));
        if (parent == "lut3d" || parent == "inverselut3d") {
            const bool is_cube = sizes.size() == 4 && sizes[0] == sizes[1] &&
                                 sizes[0] == sizes[2] && sizes[3] == 3 && sizes[0] >= 2 &&
                                 sizes[0] <= kLargestCube;
            if (!is_cube) refuse(dim, fmt::format("N N N 3 with N in [2, {}]", kLargestCube));
            return 3 * cubed(sizes[0]);
        }
        if (parent == "lut1d" || parent == "inverselut1d") {
            if (sizes.size() != 2 || sizes[0] < 2 || (sizes[1] != 1 && sizes[1] != 3))
                refuse(dim, fmt::format("N 1 or N 3 with N in [2, {}]", kLargestTable));
        } else if (parent == "matrix") {
            if (sizes.size() < 2 || sizes.size() > 3 || sizes[0] > 4 || sizes[1] > 5)
                refuse(dim, "a matrix's, such as 3 3");
        } else {
            fail(fmt::format(
                "Array is inside {}; expected LUT1D, LUT3D, InverseLUT1D, InverseLUT3D or Matrix",
                parent.empty() ? "no element" : printable(parent_.title)));
        }
        return static_cast<std::size_t>(sizes[0]) * static_cast<std::size_t>(sizes[1]);
    }

    void check_array(std::size_t expected) {
        line_ = element_.body_line;
        // Some entries of a half-domain table belong to infinities and NaN.
        const bool is_half_domain =
            lowercase(parent_.attribute("halfdomain").value_or("")) == "true";
        std::size_t found = 0;
        std::string_view body = element_.body;
        for (std::string_view next = word(body); !next.empty(); next = word(body)) {
            const std::optional<double> value = parse_number(next);
            if (!value) fail("number is " + printable(next) + "; expected a number");
            if (!is_float(*value) && !is_half_domain)
                fail("number is " + printable(next) + "; expected a finite number");
            if (++found > expected)
                fail(fmt::format("the Array has more than {0} numbers; expected {0}", expected));
        }
        if (found != expected)
            fail(fmt::format("the Array has {} numbers; expected {}", found, expected));
    }
    void check_index_map(std::size_t expected) {
        line_ = element_.body_line;
        const auto found = std::count(element_.body.begin(), element_.body.end(), '@');
        if (static_cast<std::size_t>(found) != expected)
            fail(fmt::format("IndexMap has {} entries; expected {}", found, expected));
    }

    const TextLines& text_;
    const XmlElement& element_;
    const XmlElement& parent_;
    int line_ = element_.line;
};

void check_elements(TextLines& text, std::string_view root) {
    visit_xml(text, root, [&](const XmlElement& element, const std::vector<XmlElement>& around) {
        static const XmlElement none{};
        ElementCheck(text, element, around.empty() ? none : around.back()).check();
    });
}

}  // namespace

void check_clf(TextLines& text) { check_elements(text, "ProcessList"); }

void check_cc(TextLines& text) { check_elements(text, "ColorCorrection"); }

TONEWRIGHT_NAMESPACE_END
