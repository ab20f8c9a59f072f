// SPDX-License-Identifier: Apache-2.0
#include "ocio/lut_chain.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <sstream>
#include <variant>

#include "base/format_number.h"
#include "lut/header.h"
#include "lut/photograph_error.h"
#include "measure/error_metric.h"
#include "measure/photographs.h"
#include "measure/sample_set.h"
#include "ocio/operator_facts.h"
#include "ocio/transforms.h"
#include "tonewright/engine.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

void check(const LutRequest& request, LutNodes nodes) {
    const std::string format = name_of(request.format);
    if (request.decimals)
        throw Error({.parameter = "decimals",
                     .value = fmt::to_string(*request.decimals),
                     .expected = fmt::format("none for {}; only cube has decimals", format)});
    if (request.bits.value_or(32) != 32)
        throw Error({.parameter = "depth",
                     .value = fmt::to_string(*request.bits),
                     .expected = "32 for " + format});
    if (request.size && (*request.size < 17 || *request.size > 129))
        throw Error(
            {.parameter = "size", .value = fmt::to_string(*request.size), .expected = "[17, 129]"});
    if (nodes == LutNodes::smooth)
        throw Error({.parameter = "nodes",
                     .value = "smooth",
                     .expected = "auto, sampled or fitted for scene-linear input"});
}

Lowered lower(const LutRequest& request, LutNodes nodes, const std::string& cache_folder) {
    LowerOptions options = lower_options(*request.view.op.op, cache_folder);
    if (nodes != LutNodes::automatic) options.fits_cubes = nodes == LutNodes::fitted;
    options.cube_edge = request.size.value_or(options.cube_edge);
    return lower_to_ocio(build_view(request.view), options);
}

bool fits_clf(const LoweredOps& ops) {
    return std::none_of(ops.begin(), ops.end(), [](const LoweredOp& op) {
        const auto* table = std::get_if<Lut1DOp>(&op.op);
        return std::holds_alternative<FixedFunctionOp>(op.op) ||
               std::holds_alternative<BuiltinOp>(op.op) || (table && table->keeps_hue);
    });
}

/// The reference and OpenColorIO on the same light.
class Comparison {
  public:
    Comparison(const View& view, const LoweredOps& ops)
        : engine_(build_view(view)), cpu_(make_processor(ops)) {}

    void run(const std::vector<float>& light, std::vector<double>& shown,
             std::vector<double>& wanted) const {
        std::vector<float> codes(light.size());
        cpu_.run_rgb(light.data(), codes.data(), light.size() / 3);
        shown.assign(codes.begin(), codes.end());
        wanted.resize(light.size());
        engine_.run_rgb(light.data(), wanted.data(), light.size() / 3);
    }

  private:
    ReferenceEngine engine_;
    OcioCpu cpu_;
};

LutError measure(const View& view, const Lowered& lowered) {
    const Comparison comparison(view, lowered.ops);
    const InputSpace& space = find_input_space(view.input);
    const SampleSet samples = make_sample_set(space, {17, 50000});
    std::vector<float> light;
    for (std::size_t i = 0; i < samples.size(); ++i) {
        // A 3D LUT reads negatives as 0.
        if (samples.kind[i] == SampleKind::special ||
            (lowered.loses_negatives && !samples.is_non_negative(i)))
            continue;
        light.insert(light.end(), &samples.rgb[3 * i], &samples.rgb[3 * i] + 3);
    }
    std::vector<double> shown;
    std::vector<double> wanted;
    comparison.run(light, shown, wanted);
    std::vector<double> errors;
    for (std::size_t i = 0; i < light.size(); i += 3) {
        double worst = 0;
        for (std::size_t c = 0; c < 3; ++c) {
            const double difference = std::fabs(shown[i + c] - wanted[i + c]);
            worst = std::isnan(difference) ? std::numeric_limits<double>::infinity()
                                           : std::max(worst, difference);
        }
        errors.push_back(worst);
    }
    const ErrorStats stats = summarise(errors);
    LutError result;
    result.max = stats.max;
    result.p999 = stats.p999;
    result.mean = stats.mean;
    result.interpolation = "tetrahedral";
    if (view.display != kLinearOutput && view.display != kNativeOutput) {
        const ErrorStats seen = summarise(delta_e_itp(find_display(view.display), shown, wanted));
        result.delta_e_max = seen.max;
        result.delta_e_p999 = seen.p999;
        result.delta_e_mean = seen.mean;
    }
    comparison.run(photograph_light(space.primaries), shown, wanted);
    result.photographs = photograph_error(view, shown, wanted, nullptr);
    return result;
}

/// OpenColorIO writes the operations as the file that it reads.
std::string write(const LutRequest& request, const Lowered& lowered, const LutError& error) {
    const bool is_ctf = request.format == LutFormat::ctf;
    const OCIO::GroupTransformRcPtr group = to_ocio(lowered.ops);
    OCIO::FormatMetadata& about = group->getFormatMetadata();
    const std::string input =
        "scene-linear " + find_input_space(request.view.input).title + ", every half float";
    const std::string output = output_line(request.view);
    about.setName(fmt::format("{} ({}), scene-linear {} to {}", request.view.op.op->title,
                              request.view.op.label, request.view.input, request.view.display)
                      .c_str());
    std::vector<std::string> lines = operator_lines(request.view);
    lines.push_back("Input: " + input);
    lines.push_back(output);
    lines.push_back("Operations: " + lowered.summary);
    lines.push_back(photograph_line(error));
    for (const std::string& line : error_lines(error))
        lines.push_back(line);
    for (const std::string& line : lines)
        about.addChildElement("Description", line.c_str());
    about.addChildElement("InputDescriptor", input.c_str());
    about.addChildElement("OutputDescriptor", output.substr(output.find(' ') + 1).c_str());
    std::ostringstream text;
    group->write(OCIO::Config::CreateRaw(),
                 is_ctf ? "Color Transform Format" : "Academy/ASC Common LUT Format", text);
    return text.str();
}

}  // namespace

bool is_lut_chain(const LutRequest& request) {
    const bool holds_chains = request.format == LutFormat::clf || request.format == LutFormat::ctf;
    return holds_chains && request.encoding.is_linear && request.dimension != LutDimension::one &&
           (request.dimension == LutDimension::three || !is_per_channel(build_view(request.view)));
}

LutChain make_lut_chain(const LutRequest& request, LutNodes nodes,
                        const std::string& cache_folder) {
    check(request, nodes);
    const Lowered lowered = lower(request, nodes, cache_folder);
    const bool is_for_both = fits_clf(lowered.ops);
    if (request.format == LutFormat::clf && !is_for_both) {
        throw Error({.parameter = "format",
                     .value = "clf",
                     .expected = fmt::format("ctf, because clf lacks an operation of {}: {}",
                                             request.view.op.label, lowered.summary)});
    }
    const LutError error = measure(request.view, lowered);
    return {write(request, lowered, error), error, lowered.summary, is_for_both};
}

TONEWRIGHT_NAMESPACE_END
