// SPDX-License-Identifier: Apache-2.0
#include "report/page.h"

#include <array>
#include <cstdint>

#include "report/sha256.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

std::string base64(std::string_view bytes) {
    constexpr std::string_view kDigits =
        "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    std::string text;
    text.reserve((bytes.size() + 2) / 3 * 4);
    for (std::size_t i = 0; i < bytes.size(); i += 3) {
        std::uint32_t group = 0;
        for (std::size_t k = 0; k < 3; ++k) {
            const auto byte = i + k < bytes.size() ? static_cast<unsigned char>(bytes[i + k]) : 0U;
            group = group << 8U | byte;
        }
        for (std::size_t k = 0; k < 4; ++k) {
            const bool is_filled = i + k <= bytes.size();
            text += is_filled ? kDigits[group >> (18 - 6 * k) & 63U] : '=';
        }
    }
    return text;
}

}  // namespace

std::string make_report_page(std::string_view archive, std::string_view references) {
    std::string page(kReportViewer);
    const auto fill = [&](std::string_view place, const std::string& text) {
        page.replace(page.find(place), place.size(), text);
    };
    fill("@TONEWRIGHT_REFERENCES@", base64(sha256(references)));
    fill("@TONEWRIGHT_DATA@", base64(archive));
    return page;
}

TONEWRIGHT_NAMESPACE_END
