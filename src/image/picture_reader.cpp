// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>
#include <algorithm>
#include <array>
#include <cerrno>
#include <charconv>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <string_view>
#include <system_error>

#include <OpenImageIO/filesystem.h>
#include <OpenImageIO/strutil.h>

#include "base/input_file.h"
#include "base/strings.h"
#include "image/converted_picture.h"
#include "image/heif_reader.h"
#include "image/picture_file.h"
#include "image/resize.h"
#include "image/row_input.h"
#include "image/source_picture.h"
#include "image/spec_conversion.h"
#include "picture/exr_reader.h"
#include "picture/header_tags.h"
#include "picture/layers.h"
#include "picture/picture_description.h"
#include "picture/source_pixels.h"
#include "tonewright/image_io.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

using OIIO::ImageBuf;
using OIIO::ROI;

[[noreturn]] void cannot_read(const std::string& path, Problem why) {
    const bool is_memory = why.kind == Problem::Kind::memory;
    throw FileError(within(is_memory ? path : path + ": cannot read", std::move(why)));
}
[[noreturn]] void cannot_read(const std::string& path, const std::string& reason) {
    cannot_read(path, Problem{.kind = Problem::Kind::file, .value = reason});
}

/// If a file is truncated, OpenImageIO's reader delivers the previous contents of its memory. SMPTE
/// ST 268:2003, table 1 (offsets in bytes), if the pixels of the first element are not compressed.
void check_dpx_size(const std::string& path) {
    std::array<unsigned char, 808> header{};
    std::ifstream file(path, std::ios::binary);
    if (!file.read(reinterpret_cast<char*>(header.data()), header.size()))
        cannot_read(path, "the file is truncated or damaged");
    const bool is_little = header[0] == 'X';
    const auto number = [&](std::size_t at, std::size_t bytes) {
        std::uint64_t value = 0;
        for (std::size_t i = 0; i < bytes; ++i)
            value = value << 8 | header[at + (is_little ? bytes - 1 - i : i)];
        return value;
    };
    const std::uint64_t width = number(772, 4);
    const std::uint64_t height = number(776, 4);
    const std::uint64_t bits = number(803, 1);
    const std::uint64_t packing = number(804, 2);
    const std::uint64_t encoding = number(806, 2);
    std::uint64_t per_pixel = 0;
    switch (number(800, 1)) {  // the descriptor: ST 268:2003, table 1, field 21.6
        case 50:
            per_pixel = 3;
            break;
        case 51:
        case 52:
            per_pixel = 4;
            break;
        case 1:
        case 2:
        case 3:
        case 4:
        case 6:
            per_pixel = 1;
            break;
        default:
            return;  // subsampled or of a maker's own
    }
    if (encoding != 0) return;
    const std::uint64_t samples = width * per_pixel;
    std::uint64_t row = 0;
    if (bits == 10 && (packing == 1 || packing == 2)) {
        row = (samples + 2) / 3 * 4;
    } else if (bits == 12 && (packing == 1 || packing == 2)) {
        row = samples * 2;
    } else {
        row = (samples * bits + 7) / 8;
    }
    const std::uint64_t offset = number(4, 4);
    std::error_code error;
    const std::uint64_t size = std::filesystem::file_size(path, error);
    if (error || offset == 0xFFFFFFFFU || offset + row * height <= size) return;
    cannot_read(path, fmt::format("the file is truncated: it has {} bytes; expected {}", size,
                                  offset + row * height));
}

[[noreturn]] void refuse_size(const std::string& path, double width, double height,
                              double max_pixels) {
    cannot_read(
        path,
        Problem{.value = fmt::format("it declares {:.0f} x {:.0f} pixels", width, height),
                .expected = fmt::format("at most {:.0f} in all (<<max_pixels>>)", max_pixels)});
}

/// OpenImageIO's reader of JPEG 2000 decodes the picture while it opens it. ISO/IEC 15444-1: the
/// codestream begins with the markers SOC and SIZ (A.5.1), alone or in a box `jp2c` (I.4).
void check_jpeg2000_size(const std::string& path, double max_pixels) {
    std::ifstream file(path, std::ios::binary);
    const auto number = [&](std::size_t bytes) {
        std::uint64_t value = 0;
        for (std::size_t i = 0; i < bytes; ++i)
            value = value << 8 | static_cast<std::uint64_t>(file.get() & 0xFF);
        return value;
    };
    constexpr std::uint64_t kSocAndSiz = 0xFF4FFF51;
    constexpr std::uint64_t kCodestream = 0x6A703263;  // "jp2c"
    constexpr std::uint64_t kSignature = 0x6A502020;   // "jP  "
    std::uint64_t first = number(4);
    if (first != kSocAndSiz) {
        if (number(4) != kSignature) return;
        std::uint64_t at = 0;
        std::uint64_t type = kSignature;
        while (type != kCodestream) {
            // A box that extends to the end of the file, or one without its own header.
            if (first == 1) first = number(8);
            if (first < 8 || first > INT64_MAX - at) return;
            at += first;
            file.seekg(static_cast<std::streamoff>(at));
            first = number(4);
            type = number(4);
            if (!file) return;
        }
        if (first == 1) (void)number(8);
        if (number(4) != kSocAndSiz) return;
    }
    (void)number(4);  // length of the segment, capabilities
    const auto right = static_cast<double>(number(4));
    const auto bottom = static_cast<double>(number(4));
    const auto left = static_cast<double>(number(4));
    const auto top = static_cast<double>(number(4));
    if (!file) return;  // the reader has the reason
    const double width = std::max(right - left, 0.0);
    const double height = std::max(bottom - top, 0.0);
    if (width * height > max_pixels) refuse_size(path, width, height, max_pixels);
}

/// The reason why a picture could not be opened, in one line.
/// @param reported  OpenImageIO's message
Problem why_not_open(const std::string& path, const std::string& reported) {
    if (std::optional<Problem> why = why_not_readable(path)) return *std::move(why);
    std::error_code error;
    if (std::filesystem::file_size(path, error) == 0) return {.value = "the file is empty"};
    return problem_of_library(reported);
}

/// More subimages are not looked at: a damaged TIFF file may declare an endless chain.
constexpr int kMostSubimages = 1000;
constexpr int kMostNames = 8;
constexpr std::array kColorNames = {'R', 'G', 'B', 'A'};

/// OpenImageIO 2.4 stores errors by the address of a reader and by thread. If another thread
/// destroys a reader, its errors remain for the next reader at that address.
void forget_errors(const OIIO::ImageInput& in) { (void)in.geterror(); }

/// DICOM PS3.10, 7.1: a preamble of 128 bytes, then "DICM".
bool is_dicom(const std::string& path) {
    std::array<char, 132> head{};
    std::ifstream file(path, std::ios::binary);
    return file.read(head.data(), head.size()) && std::string_view(head.data() + 128, 4) == "DICM";
}

/// Opens a file with the reader of its extension; if that says no, with the first that says yes.
/// `ImageInput::open` does the same, with two differences that matter: it takes the text after a ?
/// as arguments of a reader, and it tries DCMTK on every file, which ends the process if memory is
/// short (3.6.7, while it loads its dictionary).
std::unique_ptr<OIIO::ImageInput> open_file(const std::string& path,
                                            const OIIO::ImageSpec& config) {
    OIIO::ImageSpec spec;
    std::string reason;
    const auto opened = [&](const std::string& format) {
        std::unique_ptr<OIIO::ImageInput> in = OIIO::ImageInput::create(format);
        if (!in) return in;
        forget_errors(*in);
        if (in->open(path, spec, config)) return in;
        if (reason.empty()) reason = in->geterror();
        // Its own file, but damaged or too large for memory: another reader would give less of it.
        if (in->valid_file(path)) cannot_read(path, why_not_open(path, reason));
        return std::unique_ptr<OIIO::ImageInput>();
    };
    const std::string extension = extension_of(path);
    if (!extension.empty()) {
        if (std::unique_ptr<OIIO::ImageInput> in = opened(extension.substr(1))) return in;
    }
    const std::string first_reason = reason;
    for (const std::string& format :
         OIIO::Strutil::splits(OIIO::get_string_attribute("input_format_list"), ",")) {
        if (format == "null" || (format == "dicom" && !is_dicom(path))) continue;
        if (std::unique_ptr<OIIO::ImageInput> in = opened(format)) return in;
    }
    (void)OIIO::geterror();  // of create()
    cannot_read(path, why_not_open(path, first_reason.empty() ? "no reader knows its format"
                                                              : first_reason));
}

}  // namespace

std::unique_lock<std::recursive_mutex> lock_header(const std::string& path) {
    // Recursive: a picture may be one of the plugin, which opens another.
    static std::recursive_mutex mutex;
    return extension_of(path) == ".exr" ? std::unique_lock<std::recursive_mutex>()
                                        : std::unique_lock(mutex);
}

std::unique_ptr<OIIO::ImageInput> open_picture(const std::string& path,
                                               const OIIO::ImageSpec* config, double max_pixels) {
    // A reader would wait forever for the end of a pipe. A name without a file may be one that a
    // reader understands: "shot.exr.tonewright?op=hable".
    if (const std::string why = why_no_file(path); !why.empty()) cannot_read(path, why);
    if (is_heif(path)) return open_heif(path, max_pixels);
    // An application's settings are for OpenImageIO's reader, which has the levels of textures, too.
    if (!config) {
        if (std::unique_ptr<RowReader> rows = open_exr(path, 0))
            return row_input(std::move(rows), "openexr");
    }
    check_jpeg2000_size(path, max_pixels);
    // OpenImageIO multiplies straight color by alpha in the file's type: in 8 bits, little is left
    // of color with low alpha.
    OIIO::ImageSpec straight;
    straight.attribute("oiio:UnassociatedAlpha", 1);
    if (!config) config = &straight;
    const std::unique_lock lock = lock_header(path);
    // A name without a file is one that a reader understands, or has its reason in the system.
    if (why_not_readable(path)) {
        std::unique_ptr<OIIO::ImageInput> in;
        if (path.find('?') != std::string::npos) in = OIIO::ImageInput::open(path, config);
        if (!in) cannot_read(path, why_not_open(path, OIIO::geterror()));
        return in;
    }
    return open_file(path, *config);
}

/// Readers that follow the request for straight alpha do not all say so.
static void mark_straight_alpha(OIIO::ImageSpec& spec, std::string_view format) {
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

/// OpenImageIO refuses Radiance files of CIE XYZ, whose pixels have the same form.
/// @returns  the file as one of RGB; empty for all other files
static std::string radiance_of_xyz(const std::string& path) {
    constexpr std::size_t kLongestHeader = 1 << 16;
    constexpr std::string_view kXyz = "32-bit_rle_xyze";
    constexpr std::string_view kRgb = "32-bit_rle_rgbe";
    std::ifstream file(path, std::ios::binary);
    std::string head(kLongestHeader, '\0');
    file.read(head.data(), static_cast<std::streamsize>(head.size()));
    head.resize(static_cast<std::size_t>(file.gcount()));
    const std::size_t end = head.find("\n\n");
    const std::size_t at = head.find(kXyz);
    if (!head.starts_with("#?") || at == std::string::npos || at > end) return {};
    constexpr std::size_t kLongest = std::size_t{4} << 30;
    std::string bytes =
        read_file(path, kLongest, [&](const Problem& why) { cannot_read(path, why); });
    return bytes.replace(at, kXyz.size(), kRgb);
}

PictureReader::PictureReader(const std::string& path, int nthreads, const ReadOptions& options)
    : path_(path), bytes_(why_no_file(path).empty() ? radiance_of_xyz(path) : std::string()) {
    if (bytes_.empty()) {
        in_ = open_picture(path, nullptr, options.max_pixels);
    } else {
        memory_ = std::make_unique<OIIO::Filesystem::IOMemReader>(bytes_.data(), bytes_.size());
        in_ = OIIO::ImageInput::create("hdr");
        OIIO::ImageSpec spec;
        if (!in_ || !in_->set_ioproxy(memory_.get()) || !in_->open(path, spec))
            cannot_read(path,
                        problem_of_library(in_ ? in_->geterror() : "this format is not supported"));
    }
    // ImageBuf is not used: it asks the shared cache, which may have an older file of this name,
    // and it ignores errors that a reader reports while it delivers pixels.
    in_->threads(nthreads);
    choose_subimage(options);
    spec_ = in_->spec();
    if (spec_.deep)
        cannot_read(path, "the picture is deep; expected flat pixels (oiiotool --flatten)");
    const std::string_view format = in_->format_name();
    const std::string extension = extension_of(path);
    change_spec(spec_, [&](PictureSpec& spec) {
        complete_header(path, format, subimage_, spec);
        if (!extension.empty()) spec.attribute(file_tag::kExtension, extension.substr(1));
        spec.channelformats.clear();  // all channels are read in the widest of them
        complete_channel_names(spec);
    });
    mark_straight_alpha(spec_, format);
    stored_channels_ = spec_.nchannels;
    check_size(options.max_pixels);
    const std::string name = spec_.get_string_attribute("oiio:subimagename");
    spec_.attribute(file_tag::kSubimage, name.empty()
                                             ? fmt::to_string(subimage_)
                                             : fmt::format("{} ({})", subimage_, printable(name)));
    choose_layer(options);
    stored_ = spec_;
    nthreads_ = nthreads;
    if (format == "dpx") check_dpx_size(path);
    if (options.resize.empty()) return;
    try {
        spec_ = resized_spec(stored_, options.resize, options.max_pixels);
    } catch (const PictureError& e) {
        cannot_read(path, e.problem());
    }
    resizing_.emplace();
}

PictureReader::~PictureReader() = default;

void PictureReader::check_size(double max_pixels) const {
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

void PictureReader::choose_subimage(const ReadOptions& options) {
    const std::unique_lock lock = lock_header(path_);
    const std::string_view format = in_->format_name();
    const auto note = [&](const std::string& text) {
        if (options.note) options.note(text);
    };
    const auto name_of = [](const OIIO::ImageSpec& spec) {
        return std::string(spec.get_string_attribute("oiio:subimagename"));
    };
    if (!options.subimage.empty()) {
        int number = -1;
        const std::string& text = options.subimage;
        const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
        std::string names;
        if (error != std::errc() || end != text.data() + text.size()) {
            number = -1;
            for (int i = 0; i < kMostSubimages && in_->seek_subimage(i, 0); ++i) {
                const std::string name = name_of(in_->spec());
                if (OIIO::Strutil::iequals(name, text)) number = i;
                if (number >= 0) break;
                if (!name.empty()) names += (names.empty() ? "" : ", ") + printable(name);
            }
            forget_errors(*in_);
        }
        subimage_ = number;
        if (number >= 0 && in_->seek_subimage(number, 0)) return;
        cannot_read(path_, fmt::format("it has no subimage {}; the first is 0{}", printable(text),
                                       names.empty() ? "" : ", and names are " + names));
    }
    // Frames of movies are decoded one after the other; PSD and HEIF files begin with the picture;
    // OpenImageIO's reader of WebP does not find back.
    if (in_->spec().get_int_attribute("oiio:Movie", 0) != 0 || format == "psd" ||
        format == "heif" || format == "webp" || !in_->seek_subimage(1, 0)) {
        forget_errors(*in_);
        if (!in_->seek_subimage(0, 0)) cannot_read(path_, "it has no picture");
        return;
    }
    std::vector<Layer> pictures;  // by the names of their parts
    std::vector<int> parts;
    std::string names;
    int count = 0;
    for (; count < kMostSubimages && in_->seek_subimage(count, 0); ++count) {
        const OIIO::ImageSpec& spec = in_->spec();
        const std::string name = name_of(spec);
        if (count < kMostNames)
            names += (names.empty() ? "" : ", ") +
                     (name.empty() ? fmt::to_string(count) : printable(name));
        if (spec.deep) continue;
        for (Layer layer : color_layers(picture_spec(spec))) {
            if (layer.name.empty()) layer.name = name;
            // The default view of a stereo file is the first one: OpenEXR, "Multi-View".
            pictures.push_back(std::move(layer));
            parts.push_back(count);
        }
    }
    forget_errors(*in_);
    if (count > kMostNames) names += ", ...";
    if (format == "openexr") {
        if (const Layer* picture = picture_layer(pictures))
            subimage_ = parts[static_cast<std::size_t>(picture - pictures.data())];
    }
    if (!in_->seek_subimage(subimage_, 0)) cannot_read(path_, "it has no picture");
    const std::string name = name_of(in_->spec());
    note(fmt::format("subimage is {}{}, of {}; <<subimage>> chooses another", subimage_,
                     name.empty() ? "" : fmt::format(" ({})", printable(name)),
                     format == "openexr" ? names : fmt::to_string(count)));
}

void PictureReader::choose_layer(const ReadOptions& options) {
    const bool has_layers = std::string_view(in_->format_name()) == "openexr";
    const std::vector<Layer> layers =
        has_layers ? color_layers(picture_spec(spec_)) : std::vector<Layer>();
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
        const bool is_luminance = spec_.channelindex("RY") >= 0 || spec_.channelindex("BY") >= 0;
        if (!is_luminance)
            warn(fmt::format("no layer is a picture in color: channels {} are taken{}", taken,
                             layers.empty() ? "" : "; <<layer>> chooses another"));
        return;
    }
    deliver(order_of(*layer, picture_spec(spec_)), layer->channels.size() > 3);
    spec_.attribute(file_tag::kLayer, layer->name);
    if (layers.size() > 1 && options.note) {
        options.note(fmt::format("layer is {}, of {}; <<layer>> chooses another",
                                 layer->name.empty() ? "RGB" : printable(layer->name),
                                 layer_names(layers)));
    }
}

void PictureReader::deliver(const std::vector<int>& channels, bool has_alpha) {
    bool is_identity = static_cast<int>(channels.size()) == spec_.nchannels;
    for (std::size_t i = 0; i < channels.size(); ++i)
        is_identity = is_identity && channels[i] == static_cast<int>(i);
    change_spec(spec_, [&](PictureSpec& spec) { reorder(spec, channels, has_alpha); });
    channels_ = is_identity ? std::vector<int>() : channels;
}

void PictureReader::convert_colors(const TonemapOptions& options) {
    SourceColor color = source_color(picture_spec(stored_), options.input);
    if (resizing_) {
        resizing_ = options;
        spec_ = light_spec(spec_, color, options.unpremult);
        color_ = std::move(color);
        resized_.reset();
        return;
    }
    if (!color.convert) return;
    spec_ = image_spec(converted_spec(picture_spec(stored_), color));
    color_ = std::move(color);
}

int PictureReader::row_step() const { return std::max(spec_.tile_height, 1); }

void PictureReader::check(bool was_read) const {
    if (was_read && !in_->has_error()) return;
    const std::string reported = in_->geterror();
    // Readers of DPX and PNM do not report a file that ends too early.
    cannot_read(path_, problem_of_library(reported.empty() ? "the file is truncated or damaged"
                                                           : reported));
}

void PictureReader::read_stored(int ybegin, int yend, std::byte* to) {
    const OIIO::ImageSpec& s = stored_;
    const auto rows = static_cast<std::size_t>(yend - ybegin);
    const std::size_t bytes = s.format.size();
    const std::size_t pixels = rows * static_cast<std::size_t>(s.width);
    std::byte* into = to;
    if (!channels_.empty()) {
        scratch_.resize(pixels * bytes * static_cast<std::size_t>(stored_channels_));
        into = scratch_.data();
    }
    forget_errors(*in_);
    // This reader delivers less than it declares, without an error.
    if (std::string_view(in_->format_name()) == "dpx")
        std::fill_n(into, pixels * bytes * static_cast<std::size_t>(stored_channels_), std::byte{});
    check(s.tile_width > 0 ? in_->read_tiles(subimage_, 0, s.x, s.x + s.width, ybegin, yend, s.z,
                                             s.z + 1, 0, stored_channels_, s.format, into)
                           : in_->read_scanlines(subimage_, 0, ybegin, yend, s.z, 0,
                                                 stored_channels_, s.format, into));
    if (channels_.empty()) return;
    reorder(scratch_.data(), stored_channels_, channels_, bytes, pixels, to);
}

void PictureReader::read_rows(int ybegin, int yend, std::byte* to) {
    if (resizing_) {
        const ROI rows(spec_.x, spec_.x + spec_.width, ybegin, yend, spec_.z, spec_.z + 1, 0,
                       spec_.nchannels);
        if (!resized().get_pixels(rows, OIIO::TypeFloat, to)) check(false);
        return;
    }
    if (!color_) {
        read_stored(ybegin, yend, to);
        return;
    }
    const OIIO::ImageSpec rows = spec_of_rows(stored_, ybegin, yend);
    std::vector<std::byte> stored(rows.image_bytes());
    read_stored(ybegin, yend, stored.data());
    const ImageBuf light = converted_picture(ImageBuf(rows, stored.data()), *color_);
    if (!light.get_pixels(light.roi(), OIIO::TypeFloat, to)) check(false);
}

const ImageBuf& PictureReader::resized() {
    if (!color_) convert_colors({});
    if (!resized_) {
        const ImageBuf stored = read_all_stored();
        resized_ = with_memory_for(
            path_, [&] { return resized_light(stored, *color_, *resizing_, spec_, nthreads_); });
    }
    return *resized_;
}

ImageBuf PictureReader::read_all() {
    if (resizing_) return resized();
    ImageBuf image = read_all_stored();
    return color_ ? converted_picture(image, *color_) : std::move(image);
}

ImageBuf PictureReader::read_all_stored() {
    // Cleared, because some readers deliver less than they declare.
    ImageBuf image = with_memory_for(path_, [&] { return black_picture(stored_); });
    if (channels_.empty()) {
        forget_errors(*in_);
        check(in_->read_image(subimage_, 0, 0, stored_channels_, image.spec().format,
                              image.localpixels()));
    } else {
        // Parts of OpenEXR files are flat: rows are all there is.
        const int step = rows_of_batch(stored_.scanline_bytes(), row_step(), stored_.height);
        const int yend = stored_.y + stored_.height;
        auto* to = static_cast<std::byte*>(image.localpixels());
        for (int y = stored_.y; y < yend; y += step) {
            const int end = std::min(y + step, yend);
            read_stored(y, end, to);
            to += stored_.scanline_bytes() * static_cast<std::size_t>(end - y);
        }
    }
    return image;
}

void report_header(const OIIO::ImageSpec& spec, std::string_view input,
                   const ReadOptions& options) {
    if (!options.warn) return;
    for (const std::string& line : describe_picture(picture_spec(spec), input).ignored)
        options.warn(line);
}

OIIO::ImageSpec spec_of_rows(const OIIO::ImageSpec& picture, int ybegin, int yend) {
    OIIO::ImageSpec spec = picture;
    spec.y = ybegin;
    spec.height = yend - ybegin;
    spec.tile_width = spec.tile_height = spec.tile_depth = 0;
    return spec;
}

void check_is_complete(PictureReader& reader) {
    const OIIO::ImageSpec& spec = reader.spec();
    if (spec.depth > 1) {
        (void)reader.read_all();
        return;
    }
    const int step = rows_of_batch(spec.scanline_bytes(), reader.row_step(), spec.height);
    const int yend = spec.y + spec.height;
    std::vector<std::byte> rows(spec.scanline_bytes() * static_cast<std::size_t>(step));
    for (int y = spec.y; y < yend; y += step)
        reader.read_rows(y, std::min(y + step, yend), rows.data());
}

TONEWRIGHT_NAMESPACE_END
