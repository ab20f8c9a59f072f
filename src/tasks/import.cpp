// SPDX-License-Identifier: Apache-2.0
#include "tasks/import.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>

#include "base/atomic_file.h"
#include "tonewright/engine.h"
#include "tonewright/registry.h"
#include "tonewright/view.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

/// Colors that tell operators apart: grays, saturated colors, light above white, a negative.
constexpr std::array<Vector3, 8> kColors = {{{0, 0, 0},
                                             {0.01, 0.01, 0.01},
                                             {0.18, 0.18, 0.18},
                                             {0.9, 0.2, 0.05},
                                             {0.02, 0.3, 0.8},
                                             {3, 2, 0.5},
                                             {0.5, 12, 2},
                                             {-0.1, 0.4, 0.2}}};
using Shown = std::array<std::array<double, kColors.size()>, 3>;

/// In code values of sRGB.
Shown shown_by(const ResolvedOperator& op) {
    Shown shown{};
    for (std::size_t i = 0; i < kColors.size(); ++i) {
        for (std::size_t c = 0; c < 3; ++c)
            shown.at(c).at(i) = kColors.at(i).at(c);
    }
    const std::array<double*, 3> at = {shown[0].data(), shown[1].data(), shown[2].data()};
    ReferenceEngine(build_view(make_view(op, "lin_rec709", 0, "srgb")))
        .run({at[0], at[1], at[2]}, at, kColors.size());
    return shown;
}

/// Names of built-in operators that show the same; the function may round its constants to five
/// digits.
std::vector<std::string> equals_of(const Shown& shown) {
    constexpr double kSame = 1e-5;
    std::vector<std::string> names;
    for (const OperatorVariant& variant : all_variants()) {
        const Shown other = shown_by(resolve_operator(variant.name, {}, variant.look));
        double error = 0;
        for (std::size_t c = 0; c < 3; ++c) {
            for (std::size_t i = 0; i < kColors.size(); ++i)
                error = std::max(error, std::fabs(shown.at(c).at(i) - other.at(c).at(i)));
        }
        if (error < kSame) names.push_back(variant.name);
    }
    return names;
}

}  // namespace

ImportResult import_operator(const std::string& shader, const ShaderImport& settings,
                             const std::string& to, const Listener& listener) {
    ImportResult result{load_shader(shader, settings), {}};
    const ImportedShader& imported = result.shader;
    for (const std::string& warning : imported.warnings)
        listener.warn_of(warning);
    const std::shared_ptr<const Operator> op =
        parse_operator(imported.definition, "the definition");
    const Shown shown = shown_by(resolve(*op, nullptr, {}, ""));
    result.equals = equals_of(shown);
    // Code 0.64 is linear 0.36, a stop above mid gray.
    constexpr std::size_t kGray = 2;
    constexpr double kBright = 0.64;
    const double gray = shown[1].at(kGray);
    if (result.equals.empty() && !settings.output && imported.warnings.empty() && gray > kBright &&
        gray < 1) {
        listener.warn_of(
            fmt::format("mid gray is shown as {:.2g}; if the function returns code "
                        "values, say which: <<encoded=srgb>>, gamma22 or gamma24",
                        gray));
    }
    if (!to.empty()) write_text_atomically(to, imported.definition);
    return result;
}

TONEWRIGHT_NAMESPACE_END
