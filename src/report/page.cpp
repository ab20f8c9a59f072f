// SPDX-License-Identifier: Apache-2.0
#include "report/page.h"

#include "base/base64.h"
#include "report/sha256.h"

TONEWRIGHT_NAMESPACE_BEGIN

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
