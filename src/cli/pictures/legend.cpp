// SPDX-License-Identifier: Apache-2.0
#include "cli/pictures/legend.h"

#include <fmt/format.h>

#include <array>
#include <cmath>

#include "image/contact_sheet.h"
#include "tonewright/engine.h"
#include "tonewright/registry.h"
#include "tonewright/view.h"

TONEWRIGHT_NAMESPACE_BEGIN

void add_legend(SheetAnnotations& around) {
    const ReferenceEngine engine(
        build_view(make_view(resolve_operator("false_color"), "lin_rec709", 0, "srgb")));
    constexpr int kStops = 7;
    for (int stop = -kStops; stop <= kStops; ++stop) {
        const auto gray = static_cast<float>(0.18 * std::exp2(stop));
        const std::array<float, 3> scene = {gray, gray, gray};
        std::array<double, 3> code{};
        engine.run_rgb(scene.data(), code.data(), 1);
        around.legend.push_back({fmt::format("{}{}", stop > 0 ? "+" : "", stop),
                                 {static_cast<float>(code[0]), static_cast<float>(code[1]),
                                  static_cast<float>(code[2])}});
    }
    around.legend_heading = "False color: stops from mid gray, after exposure";
}

OIIO::ImageBuf with_legend(const OIIO::ImageBuf& picture) {
    SheetAnnotations around;
    add_legend(around);
    return make_contact_sheet({{"", picture}}, 1, shown_window(picture).width(), around);
}

TONEWRIGHT_NAMESPACE_END
