// SPDX-License-Identifier: Apache-2.0
#include "picture/file_reader.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <filesystem>
#include <system_error>
#include <utility>
#include <vector>

#include "base/strings.h"
#include "picture/header_tags.h"
#include "picture/layers.h"
#include "picture/picture_description.h"
#include "picture/source_pixels.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

/// More subimages are not looked at: a damaged TIFF file may declare an endless chain.
constexpr int kMostSubimages = 1000;
constexpr int kMostNames = 8;
constexpr std::array kColorNames = {'R', 'G', 'B', 'A'};

/// Readers that follow the request for straight alpha do not all say so.
void mark_straight_alpha(PictureSpec& spec, std::string_view format) {
    constexpr int kPremultiplied = 4;  // Truevision TGA 2.0, attributes type
    const bool is_straight =
        format == "jpeg2000" ||
        (format == "targa" && spec.get_int_attribute("targa:alpha_type") != kPremultiplied);
    if (spec.alpha_channel < 0) {
        spec.erase_attribute("oiio:UnassociatedAlpha");
    } else if (is_straight) {
        spec.attribute("oiio:UnassociatedAlpha", 1);
    }
}

}  // namespace

void cannot_read(const std::string& path, Problem why) {
    const bool is_memory = why.kind == Problem::Kind::memory;
    throw FileError(within(is_memory ? path : path + ": cannot read", std::move(why)));
}

void cannot_read(const std::string& path, const std::string& reason) {
    cannot_read(path, Problem{.kind = Problem::Kind::file, .value = reason});
}

void refuse_size(const std::string& path, double width, double height, double max_pixels) {
    cannot_read(
        path,
        Problem{.value = fmt::format("it declares {:.0f} x {:.0f} pixels", width, height),
                .expected = fmt::format("at most {:.0f} in all (<<max_pixels>>)", max_pixels)});
}

FileReader::FileReader(std::string path, std::string_view format, std::unique_ptr<RowReader> rows,
                       const ReadOptions& options)
    : path_(std::move(path)), format_(format), rows_(std::move(rows)) {
    choose_subimage(options);
    spec_ = rows_->spec(subimage_);
    if (spec_.deep)
        cannot_read(path_, "the picture is deep; expected flat pixels (oiiotool --flatten)");
    complete_header(path_, format_, subimage_, spec_);
    const std::string extension = extension_of(path_);
    if (!extension.empty()) spec_.attribute(file_tag::kExtension, extension.substr(1));
    spec_.channelformats.clear();  // all channels are read in the widest of them
    complete_channel_names(spec_);
    mark_straight_alpha(spec_, format_);
    stored_channels_ = spec_.nchannels;
    check_size(options.max_pixels);
    const std::string name = spec_.get_string_attribute("oiio:subimagename");
    spec_.attribute(file_tag::kSubimage, name.empty()
                                             ? fmt::to_string(subimage_)
                                             : fmt::format("{} ({})", subimage_, printable(name)));
    choose_layer(options);
}

void FileReader::check_size(double max_pixels) const {
    if (spec_.width < 1 || spec_.height < 1) {
        cannot_read(path_, fmt::format("it declares {} x {} pixels; expected at least 1 x 1",
                                       spec_.width, spec_.height));
    }
    const double pixels =
        static_cast<double>(spec_.width) * spec_.height * std::max(spec_.depth, 1);
    if (pixels > max_pixels) {
        refuse_size(path_, spec_.width, spec_.height, max_pixels);
    }
    std::error_code error;
    const auto bytes = static_cast<double>(std::filesystem::file_size(path_, error));
    if (error) return;  // no regular file
    // The densest compressions of black (DWAB of wide rows) compress 300,000 bytes to one.
    constexpr double kDensest = 1e6;
    constexpr double kHarmless = 64 << 20;
    const double claimed = pixels * static_cast<double>(spec_.pixel_bytes());
    if (claimed > std::max(kDensest * bytes, kHarmless)) {
        cannot_read(path_, fmt::format("it declares {} x {} pixels of {} channels in {:.0f} bytes",
                                       spec_.width, spec_.height, spec_.nchannels, bytes));
    }
}

void FileReader::choose_subimage(const ReadOptions& options) {
    const auto note = [&](const std::string& text) {
        if (options.note) options.note(text);
    };
    const auto name_of = [](const PictureSpec& spec) {
        return spec.get_string_attribute("oiio:subimagename");
    };
    if (!options.subimage.empty()) {
        int number = -1;
        const std::string& text = options.subimage;
        const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
        std::string names;
        if (error != std::errc() || end != text.data() + text.size()) {
            number = -1;
            for (int i = 0; i < kMostSubimages && rows_->has_picture(i); ++i) {
                const std::string name = name_of(rows_->spec(i));
                if (is_equal_but_for_case(name, text)) number = i;
                if (number >= 0) break;
                if (!name.empty()) names += (names.empty() ? "" : ", ") + printable(name);
            }
        }
        subimage_ = number;
        if (number >= 0 && rows_->has_picture(number)) return;
        cannot_read(path_, fmt::format("it has no subimage {}; the first is 0{}", printable(text),
                                       names.empty() ? "" : ", and names are " + names));
    }
    // Frames of movies are decoded one after the other; PSD and HEIF files begin with the picture;
    // OpenImageIO's reader of WebP does not find back.
    if (rows_->spec(0).get_int_attribute("oiio:Movie") != 0 || format_ == "psd" ||
        format_ == "heif" || format_ == "webp" || !rows_->has_picture(1)) {
        if (!rows_->has_picture(0)) cannot_read(path_, "it has no picture");
        return;
    }
    std::vector<Layer> pictures;  // by the names of their parts
    std::vector<int> parts;
    std::string names;
    int count = 0;
    for (; count < kMostSubimages && rows_->has_picture(count); ++count) {
        const PictureSpec& spec = rows_->spec(count);
        const std::string name = name_of(spec);
        if (count < kMostNames)
            names += (names.empty() ? "" : ", ") +
                     (name.empty() ? fmt::to_string(count) : printable(name));
        if (spec.deep) continue;
        for (Layer layer : color_layers(spec)) {
            if (layer.name.empty()) layer.name = name;
            // The default view of a stereo file is the first one: OpenEXR, "Multi-View".
            pictures.push_back(std::move(layer));
            parts.push_back(count);
        }
    }
    if (count > kMostNames) names += ", ...";
    if (format_ == "openexr") {
        if (const Layer* picture = picture_layer(pictures))
            subimage_ = parts[static_cast<std::size_t>(picture - pictures.data())];
    }
    if (!rows_->has_picture(subimage_)) cannot_read(path_, "it has no picture");
    const std::string name = name_of(rows_->spec(subimage_));
    note(fmt::format("subimage is {}{}, of {}; <<subimage>> chooses another", subimage_,
                     name.empty() ? "" : fmt::format(" ({})", printable(name)),
                     format_ == "openexr" ? names : fmt::to_string(count)));
}

void FileReader::choose_layer(const ReadOptions& options) {
    const bool has_layers = format_ == "openexr";
    const std::vector<Layer> layers = has_layers ? color_layers(spec_) : std::vector<Layer>();
    if (!options.layer.empty()) {
        const Layer* layer = find_layer(layers, options.layer);
        if (!layer) {
            cannot_read(path_,
                        fmt::format("it has no layer {}; {}", printable(options.layer),
                                    layers.empty() ? "it has no layers in color"
                                                   : "expected one of " + layer_names(layers)));
        }
        deliver(layer->channels, layer->channels.size() > 3);
        const auto count = layer->channels.size();
        for (std::size_t i = 0; i < count; ++i)
            spec_.channelnames[i] = std::string(1, kColorNames.at(i));
        spec_.attribute(file_tag::kLayer, layer->name);
        return;
    }
    if (!has_layers || spec_.nchannels < 3) return;
    const auto warn = [&](const std::string& text) {
        if (options.warn) options.warn(text);
    };
    const Layer* layer = picture_layer(layers);
    if (!layer) {
        const std::string taken =
            fmt::format("{}, {}, {}", printable(spec_.channelnames[0]),
                        printable(spec_.channelnames[1]), printable(spec_.channelnames[2]));
        const auto has = [&](std::string_view channel) {
            return std::find(spec_.channelnames.begin(), spec_.channelnames.end(), channel) !=
                   spec_.channelnames.end();
        };
        const bool is_luminance = has("RY") || has("BY");
        if (!is_luminance)
            warn(fmt::format("no layer is a picture in color: channels {} are taken{}", taken,
                             layers.empty() ? "" : "; <<layer>> chooses another"));
        return;
    }
    deliver(order_of(*layer, spec_), layer->channels.size() > 3);
    spec_.attribute(file_tag::kLayer, layer->name);
    if (layers.size() > 1 && options.note) {
        options.note(fmt::format("layer is {}, of {}; <<layer>> chooses another",
                                 layer->name.empty() ? "RGB" : printable(layer->name),
                                 layer_names(layers)));
    }
}

void FileReader::deliver(const std::vector<int>& channels, bool has_alpha) {
    bool is_identity = static_cast<int>(channels.size()) == spec_.nchannels;
    for (std::size_t i = 0; i < channels.size(); ++i)
        is_identity = is_identity && channels[i] == static_cast<int>(i);
    reorder(spec_, channels, has_alpha);
    channels_ = is_identity ? std::vector<int>() : channels;
}

void FileReader::read_rows(int ybegin, int yend, std::byte* to) {
    const auto rows = static_cast<std::size_t>(yend - ybegin);
    const std::size_t bytes = size_of(spec_.format);
    const std::size_t pixels = rows * static_cast<std::size_t>(spec_.width);
    std::byte* into = to;
    if (!channels_.empty()) {
        scratch_.resize(pixels * bytes * static_cast<std::size_t>(stored_channels_));
        into = scratch_.data();
    }
    try {
        rows_->read_rows(subimage_, ybegin, yend, into);
    } catch (const FileError& e) {
        cannot_read(path_, e.problem());
    }
    if (!channels_.empty())
        reorder(scratch_.data(), stored_channels_, channels_, bytes, pixels, to);
}

void report_header(const PictureSpec& spec, std::string_view input, const ReadOptions& options) {
    if (!options.warn) return;
    for (const std::string& line : describe_picture(spec, input).ignored)
        options.warn(line);
}

TONEWRIGHT_NAMESPACE_END
