// SPDX-License-Identifier: Apache-2.0
#include "cli/pictures/standard_streams.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <system_error>

#include "cli/messages.h"
#include "tasks/pictures/streams.h"
#include "tonewright/image_io.h"

TONEWRIGHT_NAMESPACE_BEGIN

StandardStreams::StandardStreams(ApplyOptions& options) {
    constexpr const char* kDash = "-";
    std::vector<std::string>& pictures = options.pictures;
    const bool has_output = options.given.contains("--output");
    std::string& output = has_output || pictures.size() < 2 ? options.output : pictures.back();
    const bool reads = std::count(pictures.begin(), pictures.end(), kDash) >
                       (&output == &options.output || output != kDash ? 0 : 1);
    const bool writes = output == kDash;
    if (!reads && !writes) return;
    if (options.given.contains("--frames") || pictures.size() > (has_output ? 1U : 2U))
        throw Error("apply: - is one of several pictures; expected one picture from or to it");
    if (writes) {
        if (options.format.empty()) {
            throw Error(
                "apply: --format is missing; expected png, exr, ppm, jpg or another extension with "
                "- as the output");
        }
        if (message_options().reports_progress()) {
            throw Error(
                fmt::format("apply: --progress is {}; expected bar or none with - as the output",
                            message_options().progress));
        }
        if (::isatty(STDOUT_FILENO) != 0)
            throw Error("apply: OUT is -, a terminal; expected a pipe or a file");
    }
    make_folder();
    if (writes) {
        out_ = folder_ + "/out." + options.format;
        output = out_;
        options.format.clear();
    }
    if (!reads) return;
    try {
        read_input(options);
    } catch (...) {
        remove_folder();  // there is no object yet that could
        throw;
    }
}

StandardStreams::~StandardStreams() { remove_folder(); }

void StandardStreams::remove_folder() noexcept {
    std::error_code ignored;
    if (!folder_.empty()) std::filesystem::remove_all(folder_, ignored);
}

void StandardStreams::make_folder() {
    std::error_code error;
    std::string name = std::filesystem::temp_directory_path(error).string() + "/tonewright-XXXXXX";
    if (error || !::mkdtemp(name.data())) {
        throw FileError(fmt::format("apply: {}: cannot make a folder: {}", name,
                                    std::system_category().message(errno)));
    }
    folder_ = name;
}

void StandardStreams::read_input(ApplyOptions& options) {
    in_ = save_stream(stdin, folder_ + "/in", options.picture.max_pixels.value_or(kMaxPixels));
    std::replace(options.pictures.begin(), options.pictures.end(), std::string("-"), in_);
}

void StandardStreams::finish() const {
    if (!out_.empty()) copy_to_stream(out_, stdout);
}

std::string StandardStreams::with_dashes(std::string text) const {
    for (const std::string& name : {in_, out_}) {
        if (name.empty()) continue;
        for (std::size_t at = text.find(name); at != std::string::npos; at = text.find(name, at))
            text.replace(at, name.size(), "-");
    }
    return text;
}

TONEWRIGHT_NAMESPACE_END
