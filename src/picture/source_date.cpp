// SPDX-License-Identifier: Apache-2.0
#include "picture/source_date.h"

#include <fmt/format.h>

#include <array>
#include <charconv>
#include <cstdint>
#include <cstdlib>
#include <string_view>
#include <system_error>

#include "tonewright/error.h"

TONEWRIGHT_NAMESPACE_BEGIN

std::string date_text(std::time_t seconds) {
    std::tm utc{};
    ::gmtime_r(&seconds, &utc);
    std::array<char, 32> text{};
    (void)std::strftime(text.data(), text.size(), "%Y:%m:%d %H:%M:%S", &utc);
    return text.data();
}

std::string source_date() {
    const char* const value = std::getenv("SOURCE_DATE_EPOCH");
    if (!value || !*value) return {};
    const std::string_view text = value;
    constexpr std::int64_t kYear10000 = 253402300800;  // DateTime has four digits for a year
    std::int64_t seconds = -1;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), seconds);
    if (error != std::errc() || end != text.data() + text.size() || seconds < 0 ||
        seconds >= kYear10000) {
        throw Error(fmt::format("SOURCE_DATE_EPOCH is {}; expected seconds since 1970, [0, {})",
                                text, kYear10000));
    }
    return date_text(static_cast<std::time_t>(seconds));
}

TONEWRIGHT_NAMESPACE_END
