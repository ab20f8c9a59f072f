// SPDX-License-Identifier: Apache-2.0
#include "tasks/exact_files.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "lut/photograph_error.h"
#include "measure/photographs.h"
#include "tonewright/engine.h"
#include "tonewright/registry.h"

TONEWRIGHT_NAMESPACE_BEGIN

ExactFiles::ExactFiles(const BakeRequest& request) {
    request_.op = request.op;
    request_.input = request.input;
    request_.input_units = request.input_units;
    request_.exposure_stops = request.exposure_stops;
    request_.display = request.display;
    request_.reference_white = request.reference_white;
    request_.cache_folder = request.cache_folder;
}

std::vector<ExactFile> ExactFiles::of(const LutApplication& host) {
    std::vector<ExactFile> files;
    if (reads_chains(host, LutFormat::ctf)) files.push_back(chain(host));
    files.push_back(table(host));
    for (const ShaderApplication& application : shader_applications()) {
        if (application.id != host.id) continue;
        if (const std::optional<ExactFile> file = shader(application)) files.push_back(*file);
    }
    std::stable_sort(files.begin(), files.end(),
                     [](const ExactFile& a, const ExactFile& b) { return a.error < b.error; });
    return files;
}

ExactFile ExactFiles::chain(const LutApplication& host) {
    BakeRequest given = request_;
    given.application = &host;
    const LutRequest request = lut_request_of(given, LutFormat::ctf);
    if (!is_lut_chain(request)) return {0, "clf or ctf, scene-linear: a 1D table", ".clf"};
    if (!chain_) chain_ = make_lut_chain(request, LutNodes::automatic, request_.cache_folder);
    const std::string name = chain_->fits_clf ? "clf" : "ctf";
    return {chain_->error.photographs.p999, name + ", scene-linear input", "." + name};
}

/// bake() writes it under the application's own extension, without chains.
ExactFile ExactFiles::table(const LutApplication& host) {
    BakeRequest given = request_;
    given.application = &host;
    given.encoding = parse_input_encoding(host.encoding);
    if (!given.input) given.input = &find_input_space(lut_input_of(host, *given.op.op));
    const LutRequest request = lut_request_of(given, host.format);
    const bool is_curve = request.dimension != LutDimension::three;
    const std::string key =
        fmt::format("{} {} {} {} {} {}", host.encoding, host.display, request.view.input,
                    is_curve ? 0 : host.size, host.bits.value_or(0), host.interpolation);
    if (!known_.contains(key)) {
        known_[key] =
            bake_lut(request, LutNodes::automatic, interpolation_of(&host)).error.photographs.p999;
    }
    return {known_[key],
            is_curve ? "1D table"
                     : fmt::format("{} of {} a side, {} input", name_of(host.format), host.size,
                                   request.encoding.id),
            is_picture_format(host.format) ? ".png" : "." + name_of(host.format)};
}

std::optional<ExactFile> ExactFiles::shader(const ShaderApplication& application) const {
    const InputSpace& input = request_.input ? *request_.input : find_input_space("lin_rec709");
    const View view =
        make_view(request_.op, in_units({input.id, input.primaries}, request_.input_units),
                  request_.exposure_stops, request_.display.value_or(application.display),
                  request_.reference_white);
    double error = 0;
    if (reads_grid(view)) {
        ShaderRequest request;
        request.view = view;
        request.application = &application;
        request.cache_folder = request_.cache_folder;
        try {
            error = write_shader(request).errors.in_float;
        } catch (const Error&) {  // it cannot hold the 3D LUT
            return std::nullopt;
        }
    }
    return ExactFile{error, application.title + ", shader", application.extension, true};
}

TONEWRIGHT_NAMESPACE_END
