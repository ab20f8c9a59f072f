// SPDX-License-Identifier: Apache-2.0
#include <OpenImageIO/imagebufalgo.h>
#include <OpenImageIO/imagecache.h>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <memory>
#include <numeric>
#include <optional>
#include <string>
#include <string_view>
#include <utility>

#include "base/atomic_file.h"
#include "base/strings.h"
#include "base/system_files.h"
#include "image/output_file.h"
#include "image/picture_file.h"
#include "image/row_output.h"
#include "image/source_picture.h"
#include "image/spec_conversion.h"
#include "image/tonemap_file.h"
#include "image/written_picture.h"
#include "picture/color_tags.h"
#include "picture/compression.h"
#include "picture/exr_writer.h"
#include "picture/format_limits.h"
#include "picture/jpeg_writer.h"
#include "picture/light_levels.h"
#include "picture/png_chunks.h"
#include "picture/png_writer.h"
#include "picture/source_date.h"
#include "picture/source_pixels.h"
#include "tonewright/error.h"
#include "tonewright/view.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

namespace fs = std::filesystem;
using OIIO::ImageBuf;
using OIIO::ImageSpec;
using OIIO::ROI;

/// A share of 0 to 1 as percent, rounded up, so that a single pixel is not 0 %.
std::string percent_text(double share) {
    return fmt::format("{:.3g}", std::ceil(1000 * share) / 10);
}

std::string title_of(const OIIO::TypeDesc& type) {
    if (type == OIIO::TypeDesc::UINT8) return "8 bits";
    if (type == OIIO::TypeDesc::UINT16) return "16 bits";
    return type.c_str();
}

CompressionOptions compression_of(const WriteOptions& options) {
    return {options.compression, options.quality, options.subsampling};
}

}  // namespace

OIIO::TypeDesc openexr_type(const OIIO::TypeDesc& source) {
    return source == OIIO::TypeHalf || source.size() == 1 ? OIIO::TypeHalf : OIIO::TypeFloat;
}

PictureWriter::PictureWriter(const std::string& path, WriteOptions options, int nthreads)
    : path_(path),
      options_(std::move(options)),
      threads_(static_cast<unsigned>(thread_count(nthreads))) {
    temporary_ = std::make_unique<AtomicFile>(path);
    if (!temporary_->refusal().empty()) fail(temporary_->refusal());
    const fs::path& target = temporary_->target();
    out_ = OIIO::ImageOutput::create(target.string());
    if (!out_) {
        fail(target.has_extension() ? first_line(OIIO::geterror())
                                    : "the name has no extension that selects a format");
    }
    out_->threads(nthreads);
    check_compression(path_, codec(), compression_of(options_));
    if (options_.bits > 0 && !format_limits(format()).has_bits) {
        throw Error(
            fmt::format("{}: type is uint{}; expected uint8, uint16, half or float, because "
                        "only DPX has 10 and 12 bits",
                        path_, options_.bits));
    }
}

std::string_view PictureWriter::format() const { return out_->format_name(); }

std::string_view PictureWriter::codec() const {
    const bool is_avif = format() == "heif" &&
                         OIIO::Strutil::iequals(temporary_->target().extension().string(), ".avif");
    return is_avif ? "avif" : format();
}

PictureWriter::~PictureWriter() = default;

void PictureWriter::fail(const std::string& reason) const {
    fail(Problem{.kind = Problem::Kind::file, .value = reason});
}

void PictureWriter::fail(const Problem& why) const {
    throw FileError(within(path_ + ": cannot write", why));
}

void PictureWriter::check_disk() const {
    if (proxy_ && proxy_->error_number()) fail(problem_of_system(proxy_->error_number()));
}

ImageBuf PictureWriter::checked(ImageBuf&& changed) const {
    if (changed.has_error()) fail(problem_of_library(changed.geterror()));
    return std::move(changed);
}

ImageBuf PictureWriter::select_channels(const ImageBuf& picture) const {
    const std::vector<float> opaque(channels_.size(), 1.0F);
    std::vector<std::string> names;
    const bool becomes_rgb = channels_.size() >= 3 && channels_[0] == channels_[1];
    for (std::size_t c = 0; c < channels_.size(); ++c) {
        const bool is_new = (becomes_rgb && c < 3) || channels_[c] < 0;
        constexpr std::array kNew = {'R', 'G', 'B', 'A'};
        names.push_back(is_new ? std::string(1, kNew.at(c))
                               : std::string(picture.spec().channel_name(channels_[c])));
    }
    ImageBuf selected = checked(OIIO::ImageBufAlgo::channels(
        picture, static_cast<int>(channels_.size()), channels_, opaque, names));
    const auto alpha = std::find(channels_.begin(), channels_.end(), picture.spec().alpha_channel);
    selected.specmod().alpha_channel =
        alpha == channels_.end() ? -1 : static_cast<int>(alpha - channels_.begin());
    return selected;
}

void PictureWriter::plan_alpha(ImageSpec& spec) {
    using Alpha = WriteOptions::Alpha;
    const bool is_straight =
        spec.alpha_channel >= 0 && spec.get_int_attribute("oiio:UnassociatedAlpha", 0) != 0;
    const FileAlpha kind = format_limits(format()).alpha;
    const bool keeps = kind == FileAlpha::straight || kind == FileAlpha::either;
    multiplies_by_alpha_ =
        is_straight && (options_.alpha == Alpha::over || (options_.alpha == Alpha::keep && !keeps));
    if (multiplies_by_alpha_ || spec.alpha_channel < 0 || options_.alpha == Alpha::ignore)
        erase_attribute(spec, "oiio:UnassociatedAlpha");
}

void PictureWriter::plan_channels(ImageSpec& spec, const FormatLimits& limits) {
    const bool is_over = options_.alpha == WriteOptions::Alpha::over && spec.alpha_channel >= 0;
    const std::array<float, 3>& back = options_.background;
    if (is_over && spec.nchannels < 3 && (back[0] != back[1] || back[1] != back[2])) {
        fail(
            fmt::format("alpha is over:{},{},{}; expected three equal numbers, because the picture "
                        "is gray",
                        back[0], back[1], back[2]));
    }
    plan_alpha(spec);
    channels_ = file_channels(picture_spec(spec), limits,
                              options_.alpha == WriteOptions::Alpha::ignore || is_over);
    if (channels_.empty())
        fail(fmt::format("the picture is in color; expected gray for {}", limits.title));
    std::vector<int> all(static_cast<std::size_t>(spec.nchannels));
    std::iota(all.begin(), all.end(), 0);
    if (channels_ == all) channels_.clear();
    if (!channels_.empty()) {
        // One pixel shows the format's names and order of channels.
        ImageSpec pixel = spec;
        pixel.width = pixel.height = pixel.depth = 1;
        pixel = select_channels(ImageBuf(pixel)).spec();
        pixel.width = spec.width;
        pixel.height = spec.height;
        pixel.depth = spec.depth;
        spec = std::move(pixel);
    }
}

void PictureWriter::plan_window(ImageSpec& spec, const ImageSpec& picture,
                                const FormatLimits& limits) {
    // Viewers show the display window. Formats without data windows store only that.
    const ROI window = picture.roi_full();
    const ROI data = picture.roi();
    last_row_ = data.yend;
    next_row_ = data.ybegin;
    const bool same = window.xbegin == data.xbegin && window.xend == data.xend &&
                      window.ybegin == data.ybegin && window.yend == data.yend;
    const bool is_kept = limits.windows == FileWindows::all ||
                         (limits.windows == FileWindows::not_negative && data.xbegin >= 0 &&
                          data.ybegin >= 0 && window.xbegin == 0 && window.ybegin == 0 &&
                          window.xend >= data.xend && window.yend >= data.yend);
    if (!same && !is_kept) {
        const double most = std::max(options_.max_pixels, 4 * static_cast<double>(data.npixels()));
        if (static_cast<double>(window.npixels()) > most) {
            throw FileError(
                {.what = path_ + ": cannot write",
                 .value =
                     fmt::format("the display window is {} x {} pixels, the data window {} x {}",
                                 window.width(), window.height(), data.width(), data.height()),
                 .expected = fmt::format(
                     "at most {:.0f} pixels (<<max_pixels>>) to fill with black", most)});
        }
        window_ = window;
        window_->chbegin = 0;
        window_->chend = spec.nchannels;
        next_row_ = window.ybegin;
        spec.x = spec.y = spec.z = spec.full_x = spec.full_y = spec.full_z = 0;
        spec.width = spec.full_width = window.width();
        spec.height = spec.full_height = window.height();
        spec.depth = spec.full_depth = window.depth();
    }
}

void PictureWriter::plan_cover(ImageSpec& spec, const ImageSpec& picture,
                               const FormatLimits& limits) {
    // OIIO's writers divide integers, rounding down, and for "Gamma2.2" and similar spaces some
    // divide by a power of alpha: 0.25 of 0.5 becomes 1.
    const bool is_associated =
        spec.alpha_channel >= 0 && spec.get_int_attribute("oiio:UnassociatedAlpha", 0) == 0;
    divides_by_alpha_ = is_associated && limits.alpha == FileAlpha::straight;
    if (divides_by_alpha_) spec.attribute("oiio:UnassociatedAlpha", 1);
    // Displays end at 1, light does not: above it, an opaque surface is clipped, too.
    const std::optional<TaggedColor> shown = tagged_color(picture_spec(picture));
    const bool is_light = shown && shown->curve && shown->curve->exponent == 1;
    surface_light_ = is_light ? static_cast<float>(kMostSurfaceLight) : 1.0F;
    becomes_straight_ =
        divides_by_alpha_ || (is_associated && limits.alpha == FileAlpha::straight_by_writer);
    alpha_ = spec.alpha_channel < spec.nchannels ? spec.alpha_channel : -1;
    // OpenEXR's viewers show color with zero alpha, and elements such as flames have nothing else.
    watches_cover_ =
        alpha_ >= 0 && options_.alpha == WriteOptions::Alpha::keep && format() != "openexr";
}

void PictureWriter::plan_type(ImageSpec& spec, const ImageSpec& picture,
                              const FormatLimits& limits) const {
    OIIO::TypeDesc type = limits.is_8_bit ? OIIO::TypeDesc::UINT8 : options_.type;
    const std::optional<TaggedColor> color = tagged_color(picture_spec(picture));
    // ITU-R BT.2100-2 has 10 and 12 bits: 8 show bands.
    if (type == OIIO::TypeUnknown && format() == "png" && color && color->code_points &&
        picture.format.is_floating_point()) {
        type = OIIO::TypeDesc::UINT16;
    }
    spec.set_format(type == OIIO::TypeUnknown ? picture.format : type);
    if (type != OIIO::TypeUnknown)
        erase_attribute(spec, "oiio:BitsPerSample");  // overrules the type
    if (options_.bits > 0) spec.attribute("oiio:BitsPerSample", options_.bits);
}

void PictureWriter::keep_type(const OIIO::TypeDesc& source) {
    if (format() != "openexr" || options_.type != OIIO::TypeUnknown || source == OIIO::TypeUnknown)
        return;
    options_.type = openexr_type(source);
}

ImageSpec PictureWriter::plan(const ImageSpec& picture) {
    ImageSpec spec = picture;
    spec.tile_width = spec.tile_height = spec.tile_depth = 0;  // those of the file it came from
    spec.channelformats.clear();
    // A single level is not a texture: OpenEXR's writer would wait for the others.
    if (spec.get_string_attribute("textureformat") == "Plain Texture")
        erase_attribute(spec, "textureformat");
    const FormatLimits& limits = format_limits(format());
    plan_channels(spec, limits);
    plan_window(spec, picture, limits);
    if (const std::string refusal = size_refusal(limits, spec.width, spec.height); !refusal.empty())
        fail(refusal);
    plan_cover(spec, picture, limits);
    plan_type(spec, picture, limits);
    change_spec(spec, [&](PictureSpec& of) {
        set_compression(of, codec(), compression_of(options_));
        if (format() == "openexr") return;  // the only format whose color tags they are
        erase_attributes(of, "colorInteropID");
        if (format() != "png" || !options_.write_provenance) erase_attributes(of, "tonewright:*");
    });
    return spec;
}

ImageSpec PictureWriter::file_spec(const ImageSpec& picture) {
    ImageSpec spec = plan(picture);
    if (out_->supports("ioproxy") == 0) {
        spec.format = OIIO::TypeUnknown;
        return spec;
    }
    // Formats lack some types. One pixel in memory shows the replacement.
    std::vector<unsigned char> memory;
    OIIO::Filesystem::IOVecOutput proxy(memory);
    const std::string name = temporary_->path().string();
    const auto out = OIIO::ImageOutput::create(name);
    const ImageSpec pixel(1, 1, spec.nchannels, spec.format);
    const std::vector<float> black(static_cast<std::size_t>(spec.nchannels));
    out->set_ioproxy(&proxy);
    if (!out->open(name, pixel)) fail(problem_of_library(out->geterror()));
    spec.format = out->spec().format;
    out->write_scanline(0, 0, OIIO::TypeFloat, black.data());
    out->close();
    return spec;
}

void PictureWriter::open(const ImageSpec& picture) {
    if (const int error = temporary_->check_target()) fail(problem_of_system(error));
    ImageSpec spec = plan(picture);
    // These writers record the time of writing.
    if (format() == "openexr" || format() == "tiff" || format() == "dpx") {
        if (const std::string date = source_date();
            !date.empty() && !spec.find_attribute("DateTime"))
            spec.attribute("DateTime", date);
    }
    const ColorDescription color = describe_color(picture_spec(spec), format());
    if (!color.icc.empty()) {
        spec.attribute("ICCProfile",
                       OIIO::TypeDesc(OIIO::TypeDesc::UINT8, static_cast<int>(color.icc.size())),
                       color.icc.data());
    }
    std::string chunks;
    if (!color.chunk.empty()) {
        // The levels are known at the end: until then, a chunk without light has their place.
        chunks = color.chunk + clli_chunk({});
        light_levels_place_ = kAfterPngHeader + color.chunk.size();
        light_levels_ =
            std::make_unique<LightLevelMeter>(find_display(tagged_color(picture_spec(spec))->name));
    }
    // Opens this file, and not a link that another program put there.
    const int file = temporary_->create();
    if (file < 0) fail(problem_of_system(errno));
    file_ = std::make_unique<OpenFile>(file);
    if (std::unique_ptr<RowWriter> rows = own_writer(file, spec, chunks)) {
        out_ = row_output(std::move(rows), out_->format_name());
    } else {
        open_by_openimageio(spec, chunks);
    }
    warn_of_limits(spec, color.missing);
    if (const std::string text = cut_off(picture); options_.warn && !text.empty())
        options_.warn(text);
}

std::unique_ptr<RowWriter> PictureWriter::own_writer(int file, const ImageSpec& spec,
                                                     const std::string& chunks) const {
    try {
        if (format() == "openexr") return create_exr(file, picture_spec(spec), threads_);
        if (format() == "png") return create_png(file, picture_spec(spec), threads_, chunks);
        if (format() == "jpeg") return create_jpeg(file, picture_spec(spec), threads_);
    } catch (const FileError& e) {
        fail(e.problem());
    }
    return nullptr;
}

void PictureWriter::open_by_openimageio(const ImageSpec& spec, const std::string& chunks) {
    // libtiff reads its own directories again if there is an EXIF directory (as in a picture tagged
    // sRGB), and a proxy for writing cannot be read: the file would lack its first directory.
    std::string name = temporary_->path().string();
    if (out_->supports("ioproxy") && format() != "tiff") {
        proxy_ = std::make_unique<OutputFile>(file_->release(), name);
        check_disk();
        if (!chunks.empty()) proxy_->insert(kAfterPngHeader, chunks);
        out_->set_ioproxy(proxy_.get());
        name = fs::path(path_).filename().string();
    }
    file_.reset();
    const bool is_open = [&] {
        const FileCreation creation;  // the writer may open the file by its name
        return out_->open(name, spec);
    }();
    if (!is_open) fail(problem_of_library(out_->geterror()));
    if (proxy_ && format() == "openexr") {
        rows_of_block_ = rows_of_block(out_->spec().get_string_attribute("compression", "zip"));
        proxy_->begin_blocks();
    }
}

void PictureWriter::warn_of_limits(const ImageSpec& requested, const std::string& missing) const {
    if (!options_.warn) return;
    std::vector<std::string> limits;
    if (!missing.empty()) limits.push_back(missing);
    const OIIO::TypeDesc type = out_->spec().format;
    if (options_.type != OIIO::TypeUnknown && options_.type != type && format() != "null") {
        limits.push_back(
            fmt::format("pixels are {}, not {}", title_of(type), title_of(options_.type)));
    }
    const std::optional<TaggedColor> color = tagged_color(picture_spec(requested));
    if (color && color->code_points && type == OIIO::TypeDesc::UINT8) {
        limits.emplace_back("gradients in 8 bits show bands");
    }
    if (!limits.empty()) options_.warn(fmt::format("{}", fmt::join(limits, "; ")));
}

/// "the data window ... lies outside the display window"; empty if nothing is cut off.
std::string PictureWriter::cut_off(const ImageSpec& picture) const {
    const ROI data = picture.roi();
    ROI shown = window_ ? OIIO::roi_intersection(data, picture.roi_full()) : data;
    shown.chbegin = data.chbegin;
    shown.chend = data.chend;
    const double lost =
        shown.width() > 0 && shown.height() > 0 && shown.depth() > 0
            ? 1 - static_cast<double>(shown.npixels()) / static_cast<double>(data.npixels())
            : 1;
    if (lost <= 0) return {};
    if (lost >= 1) {
        return fmt::format(
            "all of the data window lies outside the display window, so the picture "
            "is black; {} has no data window",
            format());
    }
    return fmt::format(
        "{} % of the data window lies outside the display window and is left out; {} has no data "
        "window",
        percent_text(lost), format());
}

void PictureWriter::watch_cover(const ImageBuf& rows) {
    if (!watches_cover_ || (has_cover_ && !becomes_straight_)) return;
    ROI line = rows.roi();
    line.zend = line.zbegin + 1;
    const auto channels = static_cast<std::size_t>(rows.nchannels());
    const auto colors = std::min(alpha_, 3);
    // Operators lift black by up to two codes of 8 bits (AgX: 0.7), also where nothing is.
    constexpr float kVisible = 2.0F / 255;
    std::vector<float> pixels(static_cast<std::size_t>(line.width()) * channels);
    for (int y = rows.ybegin(); y < rows.yend(); ++y) {
        line.ybegin = y;
        line.yend = y + 1;
        rows.get_pixels(line, OIIO::TypeFloat, pixels.data());
        for (std::size_t i = 0; i < pixels.size(); i += channels) {
            const float alpha = pixels[i + static_cast<std::size_t>(alpha_)];
            if (alpha != 0) has_cover_ = true;
            const float* const color = &pixels[i];
            const float most = *std::max_element(color, color + colors);
            const float carried = surface_light_ * std::max(alpha, 0.0F);
            if (alpha < 1 && most > carried + kVisible) ++lost_count_;
        }
        pixel_count_ += line.width();
    }
}

void PictureWriter::warn_of_cover() const {
    if (!watches_cover_ || !options_.warn) return;
    if (!has_cover_) {
        options_.warn(
            "alpha is 0 everywhere, so viewers show nothing; <<alpha=ignore>> leaves it out, "
            "<<alpha=opaque>> makes it 1");
    } else if (becomes_straight_ && lost_count_ > 0) {
        options_.warn(
            fmt::format("{} % of the pixels have more light than their alpha carries (flames, "
                        "glass), and {} cannot hold it; <<alpha=opaque>> or ignore keeps it, as "
                        "does EXR",
                        percent_text(lost_count_ / std::max(pixel_count_, 1.0)), format()));
    }
}

void PictureWriter::watch_range(const ImageBuf& rows) {
    if (out_->spec().format != OIIO::TypeHalf || !rows.localpixels()) return;
    // Larger floats round to infinity: IEEE 754, binary16.
    constexpr float kEnd = 65520;
    constexpr unsigned kInfiniteHalf = 0x7C00;
    const bool is_half = rows.spec().format == OIIO::TypeHalf;
    if (!is_half && rows.spec().format != OIIO::TypeFloat) return;
    const int colors = std::min(rows.nchannels(), 3);
    for (int y = rows.ybegin(); y < rows.yend(); ++y) {
        const auto* pixel =
            static_cast<const std::byte*>(rows.pixeladdr(rows.xbegin(), y, rows.zbegin()));
        int count = 0;
        for (int x = rows.xbegin(); x < rows.xend(); ++x, pixel += rows.pixel_stride()) {
            bool is_beyond = false;
            for (int c = 0; c < colors; ++c) {
                if (is_half) {
                    std::uint16_t bits = 0;
                    std::memcpy(&bits, pixel + 2 * c, sizeof(bits));
                    is_beyond |= (bits & 0x7FFFU) == kInfiniteHalf;
                } else {
                    float value = 0;
                    std::memcpy(&value, pixel + 4 * c, sizeof(value));
                    is_beyond |= std::abs(value) >= kEnd;
                }
            }
            count += is_beyond ? 1 : 0;
        }
        beyond_half_count_ += count;
    }
}

void PictureWriter::warn_of_range() const {
    if (beyond_half_count_ == 0 || !options_.warn) return;
    const ImageSpec& file = out_->spec();
    const double pixels = static_cast<double>(file.width) * file.height * std::max(file.depth, 1);
    options_.warn(
        fmt::format("{} % of the pixels are infinite, because half ends at 65504; "
                    "<<pixel_type=float>> keeps them",
                    percent_text(beyond_half_count_ / pixels)));
}

ImageBuf PictureWriter::over_background(const ImageBuf& rows) const {
    ImageBuf result = rows.copy(OIIO::TypeFloat);
    const int alpha = rows.spec().alpha_channel;
    const int colors = std::min(alpha, 3);
    const std::array<float, 3>& background = options_.background;
    for (ImageBuf::Iterator<float> p(result); !p.done(); ++p) {
        const float cover = std::isfinite(p[alpha]) ? std::clamp<float>(p[alpha], 0, 1) : 0;
        for (int c = 0; c < colors; ++c)
            p[c] = p[c] + (1 - cover) * background[static_cast<std::size_t>(c)];
    }
    return result;
}

OIIO::TypeDesc PictureWriter::row_type() const {
    return out_->spec().format == OIIO::TypeHalf && !divides_by_alpha_ && !multiplies_by_alpha_
               ? OIIO::TypeHalf
               : OIIO::TypeFloat;
}

bool PictureWriter::keeps_orientation() const { return format() == "jpeg" || format() == "tiff"; }

bool PictureWriter::is_bottom_up() const {
    return format() == "openexr" &&
           out_->spec().get_string_attribute("openexr:lineOrder") == "decreasingY";
}

void PictureWriter::write_rows(const ImageBuf& rows) {
    ImageBuf changed;
    const ImageBuf* fitted = &rows;
    const auto change = [&](ImageBuf&& to) {
        changed = checked(std::move(to));
        fitted = &changed;
    };
    if (multiplies_by_alpha_) {
        ImageBuf associated = fitted->copy(OIIO::TypeFloat);
        multiply_by_alpha(associated);
        change(std::move(associated));
    }
    if (options_.alpha == WriteOptions::Alpha::over && fitted->spec().alpha_channel >= 0)
        change(over_background(*fitted));
    if (!channels_.empty()) {
        change(select_channels(*fitted));
    }
    watch_cover(*fitted);
    if (alpha_ >= 0 && options_.alpha == WriteOptions::Alpha::opaque) {
        ImageBuf opaque = fitted->copy(fitted->spec().format);
        ROI cover = opaque.roi();
        cover.chbegin = alpha_;
        cover.chend = alpha_ + 1;
        const std::vector<float> one(static_cast<std::size_t>(opaque.nchannels()), 1.0F);
        OIIO::ImageBufAlgo::fill(opaque, one, cover);
        change(std::move(opaque));
    }
    if (!window_) {
        write_part(*fitted);
        return;
    }
    // Adds the black rows above the first and below the last, some at a time.
    const int data_end = rows.roi().yend;
    const int end = data_end == last_row_ ? window_->yend : std::min(data_end, window_->yend);
    const std::size_t row_bytes = static_cast<std::size_t>(window_->width()) *
                                  static_cast<std::size_t>(window_->nchannels()) * sizeof(float);
    const int step = rows_of_batch(row_bytes, 1, window_->height());
    while (next_row_ < end) {
        ROI part = *window_;
        part.ybegin = next_row_;
        part.yend = std::min(next_row_ + step, end);
        next_row_ = part.yend;
        ImageBuf shown = checked(OIIO::ImageBufAlgo::cut(*fitted, part));
        shown.set_origin(0, part.ybegin - window_->ybegin);
        write_part(shown);
    }
}

void PictureWriter::write_part(const ImageBuf& rows) {
    if (!divides_by_alpha_) {
        write_fitted(rows);
        return;
    }
    ImageBuf divided = rows.copy(OIIO::TypeFloat);
    OIIO::ImageBufAlgo::unpremult(divided, divided);
    write_fitted(checked(std::move(divided)));
}

void PictureWriter::write_fitted(const ImageBuf& rows) {
    const ROI part = rows.roi();
    watch_range(rows);
    if (options_.verifies) {
        const ImageSpec& file = out_->spec();
        kept_.resize(static_cast<std::size_t>(file.width) * static_cast<std::size_t>(file.height) *
                     static_cast<std::size_t>(file.nchannels));
        const std::size_t at = static_cast<std::size_t>(part.ybegin - file.y) *
                               static_cast<std::size_t>(file.width) *
                               static_cast<std::size_t>(file.nchannels);
        rows.get_pixels(part, OIIO::TypeFloat, &kept_[at]);
    }
    if (light_levels_) {
        const auto channels = static_cast<std::size_t>(rows.nchannels());
        const auto width = static_cast<std::size_t>(part.width());
        std::vector<float> pixels(width * channels);
        for (int y = part.ybegin; y < part.yend; ++y) {
            ROI line = part;
            line.ybegin = y;
            line.yend = y + 1;
            rows.get_pixels(line, OIIO::TypeFloat, pixels.data());
            light_levels_->add(pixels.data(), width, channels, out_->spec().format, alpha_);
        }
    }
    bool written = false;
    if (format() == "heif") {
        // OpenImageIO 2.4 copies rows as long as libheif's, which have padding: the last one needs
        // something behind it.
        constexpr std::size_t kPadding = 1024;
        const OIIO::TypeDesc type = out_->spec().format;
        const std::size_t values =
            static_cast<std::size_t>(part.npixels()) * static_cast<std::size_t>(rows.nchannels());
        std::vector<std::byte> pixels(values * type.size() + kPadding);
        written = rows.get_pixels(part, type, pixels.data()) &&
                  out_->write_scanlines(part.ybegin, part.yend, part.zbegin, type, pixels.data());
    } else if (part.height() == out_->spec().height) {
        written = rows.write(out_.get());
    } else {
        written =
            out_->write_scanlines(part.ybegin, part.yend, part.zbegin, rows.spec().format,
                                  rows.localpixels(), rows.pixel_stride(), rows.scanline_stride());
    }
    check_disk();
    if (!written) fail(problem_of_library(rows.has_error() ? rows.geterror() : out_->geterror()));
    rows_written_ += part.height();
    if (options_.progress) {
        options_.progress(static_cast<std::size_t>(rows_written_),
                          static_cast<std::size_t>(out_->spec().height));
    }
    check_blocks();
}

void PictureWriter::check_blocks() const {
    if (rows_of_block_ == 0) return;
    const int height = out_->spec().height;
    const int first = is_bottom_up() ? (height - 1) % rows_of_block_ + 1 : rows_of_block_;
    int complete = rows_written_ < first ? 0 : 1 + (rows_written_ - first) / rows_of_block_;
    if (rows_written_ == height) complete = (height - 1) / rows_of_block_ + 1;
    if (proxy_->blocks() < complete)
        fail("OpenEXR could not compress all rows (not enough memory?)");
}

void PictureWriter::finish() {
    warn_of_cover();
    warn_of_range();
    const bool is_avif = codec() == "avif";
    const std::string file_format(format());
    const ImageSpec requested = out_->spec();
    if (!out_->close()) fail(problem_of_library(out_->geterror()));
    out_.reset();  // some write their last bytes only now
    if (light_levels_) {
        const std::string levels = clli_chunk(light_levels_->levels());
        if (proxy_) {
            proxy_->patch(light_levels_place_, levels);
        } else if (const int error = file_->patch(light_levels_place_, levels)) {
            fail(problem_of_system(error));
        }
    }
    const bool is_opened_by_name = !proxy_ && !file_;
    if (const int error = proxy_ ? proxy_->finish() : file_ ? file_->close() : 0)
        fail(problem_of_system(error));
    const std::string fault = fault_of({.path = temporary_->path().string(),
                                        .spec = requested,
                                        .format = file_format,
                                        .is_avif = is_avif,
                                        .is_opened_by_name = is_opened_by_name,
                                        .bits = options_.bits,
                                        .pixels = options_.verifies ? &kept_ : nullptr});
    if (!fault.empty()) fail(fault);
    if (const int error = temporary_->keep()) fail(problem_of_system(error));
    // Readers that use OIIO's shared cache get the new file.
    auto cache = OIIO::ImageCache::create(true);  // a pointer, or since 3.0 a shared one
    if (!cache) return;                           // no memory for a first one
    cache->invalidate(OIIO::ustring(path_));
    OIIO::ImageCache::destroy(cache);
}

TONEWRIGHT_NAMESPACE_END
