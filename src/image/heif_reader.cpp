// SPDX-License-Identifier: Apache-2.0
#include "image/heif_reader.h"

#ifdef TONEWRIGHT_HAVE_LIBHEIF

#include <OpenImageIO/imageio.h>
#include <fmt/format.h>
#include <libheif/heif.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <fstream>
#include <limits>
#include <mutex>
#include <new>
#include <optional>
#include <string_view>
#include <vector>

#include "base/strings.h"
#include "image/report_thrown.h"
#include "tonewright/error.h"

// OpenImageIO/tiffutils.h declares these. It includes a header of libtiff, which Debian's package
// of OpenImageIO does not bring.
#ifdef OIIO_NAMESPACE_3_1_BEGIN
OIIO_NAMESPACE_3_1_BEGIN
#else
OIIO_NAMESPACE_BEGIN
#endif
OIIO_API bool decode_exif(string_view exif, ImageSpec& spec);
OIIO_API bool decode_xmp(string_view xml, ImageSpec& spec);
#ifdef OIIO_NAMESPACE_3_1_BEGIN
OIIO_NAMESPACE_3_1_END
OIIO_NAMESPACE_BEGIN
using v3_1::decode_exif;
using v3_1::decode_xmp;
#endif
OIIO_NAMESPACE_END

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

using OIIO::ImageSpec;
using OIIO::TypeDesc;

std::uint64_t big_endian(std::string_view bytes, std::size_t at, std::size_t count) {
    std::uint64_t value = 0;
    for (std::size_t i = 0; i < count; ++i)
        value = value << 8 | static_cast<unsigned char>(bytes[at + i]);
    return value;
}

/// Size and type of a box, ISO/IEC 14496-12, 4.2.
struct Box {
    std::uint64_t header = 8;
    std::uint64_t size = 0;  // with its header; 0: up to the end
    std::string type;
};

/// @param bytes  the box, or its first 16 bytes
std::optional<Box> parse_box(std::string_view bytes) {
    if (bytes.size() < 8) return std::nullopt;
    Box box = {8, big_endian(bytes, 0, 4), std::string(bytes.substr(4, 4))};
    if (box.size == 1) {
        if (bytes.size() < 16) return std::nullopt;
        box.header = 16;
        box.size = big_endian(bytes, 8, 8);
    }
    if (box.size != 0 && box.size < box.header) return std::nullopt;
    return box;
}

/// Calls `visit` with the type and the contents of each box. Stops at a damaged one.
template <class Visit>
void for_each_box(std::string_view bytes, const Visit& visit) {
    while (const std::optional<Box> box = parse_box(bytes)) {
        const std::uint64_t size = box->size == 0 ? bytes.size() : box->size;
        if (size > bytes.size()) return;
        visit(box->type, bytes.substr(box->header, size - box->header));
        bytes.remove_prefix(size);
    }
}

/// Facts about a file that libheif 1.15 does not give.
struct Boxes {
    bool has_sequence = false;  // `moov`
    bool has_tone_map = false;  // an item `tmap`: ISO 21496-1
    /// All different code points (`nclx`) of the items.
    std::vector<std::array<int, 4>> code_points;

    void add_properties(std::string_view contents) {
        for_each_box(contents, [&](const std::string& type, std::string_view property) {
            if (type != "colr" || property.size() < 11 || property.substr(0, 4) != "nclx") return;
            const auto number = [&](std::size_t at, std::size_t count) {
                return static_cast<int>(big_endian(property, at, count));
            };
            const std::array<int, 4> points = {number(4, 2), number(6, 2), number(8, 2),
                                               number(10, 1) >> 7};
            if (std::find(code_points.begin(), code_points.end(), points) == code_points.end())
                code_points.push_back(points);
        });
    }

    void add_items(std::string_view contents) {
        if (contents.size() < 8) return;
        const std::size_t count_bytes = contents[0] == 0 ? 2 : 4;
        for_each_box(contents.substr(4 + count_bytes),
                     [&](const std::string& type, std::string_view entry) {
                         if (type != "infe" || entry.empty()) return;
                         // ISO/IEC 14496-12, 8.11.6: version 3 has longer numbers of items.
                         const std::size_t at = entry[0] == 3 ? 10 : 8;
                         if (entry.size() < at + 4) return;
                         has_tone_map = has_tone_map || entry.substr(at, 4) == "tmap";
                     });
    }

    void add_meta(std::string_view contents) {
        if (contents.size() < 4) return;
        for_each_box(contents.substr(4), [&](const std::string& type, std::string_view box) {
            if (type == "iinf") add_items(box);
            if (type != "iprp") return;
            for_each_box(box, [&](const std::string& name, std::string_view properties) {
                if (name == "ipco") add_properties(properties);
            });
        });
    }
};

Boxes read_boxes(const std::string& path) {
    Boxes boxes;
    std::ifstream file(path, std::ios::binary);
    constexpr std::size_t kLongest = std::size_t{16} << 20;
    constexpr int kMost = 1000;
    std::uint64_t at = 0;
    for (int i = 0; i < kMost && file; ++i) {
        file.seekg(static_cast<std::streamoff>(at));
        std::string head(16, '\0');
        file.read(head.data(), 16);
        head.resize(static_cast<std::size_t>(file.gcount()));
        const std::optional<Box> box = parse_box(head);
        if (!box) break;
        boxes.has_sequence = boxes.has_sequence || box->type == "moov";
        if (box->type == "meta" && box->size >= box->header && box->size <= kLongest) {
            std::string contents(box->size - box->header, '\0');
            file.clear();
            file.seekg(static_cast<std::streamoff>(at + box->header));
            file.read(contents.data(), static_cast<std::streamsize>(contents.size()));
            contents.resize(static_cast<std::size_t>(file.gcount()));
            boxes.add_meta(contents);
        }
        constexpr std::uint64_t kEnd = std::numeric_limits<std::int64_t>::max();
        if (box->size == 0 || box->size > kEnd - at) break;
        at += box->size;
    }
    return boxes;
}

struct Free {
    void operator()(heif_context* p) const { heif_context_free(p); }
    void operator()(const heif_image_handle* p) const { heif_image_handle_release(p); }
    void operator()(const heif_image* p) const { heif_image_release(p); }
    void operator()(heif_decoding_options* p) const { heif_decoding_options_free(p); }
    void operator()(heif_color_profile_nclx* p) const { heif_nclx_color_profile_free(p); }
};
template <class T>
using Owned = std::unique_ptr<T, Free>;

/// @throws Error
void require(const heif_error& error) {
    if (error.code == heif_error_Ok) return;
    if (error.code == heif_error_Memory_allocation_error &&
        error.subcode != heif_suberror_Security_limit_exceeded)
        throw std::bad_alloc();
    throw Error(error.message ? one_line(error.message) : "libheif reports no reason");
}

/// A channel of a decoded picture.
struct Plane {
    const std::uint8_t* pixels;
    std::size_t stride;
    unsigned largest;  // code
    bool is_wide;      // 16 bits a sample
};

Plane plane_of(const heif_image* image, heif_channel channel, int width, int height) {
#if LIBHEIF_HAVE_VERSION(1, 20, 2)
    std::size_t stride = 0;
    const std::uint8_t* pixels = heif_image_get_plane_readonly2(image, channel, &stride);
#else
    int stride = 0;
    const std::uint8_t* pixels = heif_image_get_plane_readonly(image, channel, &stride);
#endif
    const int bits = heif_image_get_bits_per_pixel_range(image, channel);
    if (!pixels || bits < 1 || bits > 16 || heif_image_get_width(image, channel) != width ||
        heif_image_get_height(image, channel) != height)
        throw Error("its channels do not have the size that it declares");
    return {pixels, static_cast<std::size_t>(stride), (1U << bits) - 1, bits > 8};
}

unsigned code_at(const Plane& plane, int x, int y) {
    const std::uint8_t* row = plane.pixels + static_cast<std::size_t>(y) * plane.stride;
    const auto i = static_cast<std::size_t>(x);
    // libheif's samples have the byte order of the machine.
    if (plane.is_wide) return reinterpret_cast<const std::uint16_t*>(row)[i];
    return row[i];
}

/// Exif and XMP. Their orientation and color do not count: HEIF has its own properties.
void add_metadata(ImageSpec& spec, const heif_image_handle* handle) {
    constexpr int kMost = 16;
    constexpr std::size_t kLongest = std::size_t{16} << 20;
    std::array<heif_item_id, kMost> ids{};
    const int count =
        heif_image_handle_get_list_of_metadata_block_IDs(handle, nullptr, ids.data(), kMost);
    for (int i = 0; i < std::min(count, kMost); ++i) {
        const heif_item_id id = ids[static_cast<std::size_t>(i)];
        const std::size_t size = heif_image_handle_get_metadata_size(handle, id);
        if (size == 0 || size > kLongest) continue;
        std::string block(size, '\0');
        if (heif_image_handle_get_metadata(handle, id, block.data()).code != heif_error_Ok)
            continue;
        const std::string_view type = heif_image_handle_get_metadata_type(handle, id);
        const char* content = heif_image_handle_get_metadata_content_type(handle, id);
        if (type == "Exif" && size > 4) {
            // ISO/IEC 23008-12, A.2.1: bytes between this number and the TIFF header.
            const std::uint64_t skipped = big_endian(block, 0, 4);
            if (skipped < size - 4)
                OIIO::decode_exif(OIIO::string_view(block).substr(4 + skipped), spec);
        } else if (type == "mime" && content &&
                   std::string_view(content) == "application/rdf+xml") {
            OIIO::decode_xmp(OIIO::string_view(block), spec);
        }
    }
    if (const int orientation = spec.get_int_attribute("Orientation", 1); orientation != 1)
        spec.attribute("heif:ExifOrientation", orientation);
    spec.attribute("Orientation", 1);
}

/// @param boxes  for numbers that libheif does not know, and drops
void add_code_points(ImageSpec& spec, const heif_image_handle* handle, const Boxes& boxes) {
    heif_color_profile_nclx* out = nullptr;
    const heif_error error = heif_image_handle_get_nclx_color_profile(handle, &out);
    const Owned<heif_color_profile_nclx> nclx(out);
    std::array<int, 4> points{};
    if (error.code == heif_error_Ok && nclx) {
        points = {nclx->color_primaries, nclx->transfer_characteristics, nclx->matrix_coefficients,
                  nclx->full_range_flag ? 1 : 0};
        // libheif 1.21 says 2, unspecified, where the file says nothing.
        if (points[0] == 2 && points[1] == 2 && points[2] == 2) return;
    } else if (error.code != heif_error_Color_profile_does_not_exist &&
               boxes.code_points.size() == 1) {
        points = boxes.code_points[0];
    } else if (error.code != heif_error_Color_profile_does_not_exist) {
        require(error);
        return;
    } else {
        return;
    }
    spec.attribute("CICP", TypeDesc(TypeDesc::INT, 4), points.data());
}

void add_icc(ImageSpec& spec, const heif_image_handle* handle) {
    constexpr std::size_t kLongest = std::size_t{32} << 20;
    const std::size_t size = heif_image_handle_get_raw_color_profile_size(handle);
    if (size == 0) return;
    if (size > kLongest) throw Error("its ICC profile has more than 32 MiB");
    std::vector<std::uint8_t> profile(size);
    require(heif_image_handle_get_raw_color_profile(handle, profile.data()));
    spec.attribute("ICCProfile", TypeDesc(TypeDesc::UINT8, static_cast<int>(size)), profile.data());
}

/// "urn:com:apple:photo:2020:aux:hdrgainmap", ...
std::string kind_of(const heif_image_handle* auxiliary) {
    const char* type = nullptr;
    if (heif_image_handle_get_auxiliary_type(auxiliary, &type).code != heif_error_Ok || !type)
        return "unknown";
    std::string text = printable(type, 200);
#if LIBHEIF_HAVE_VERSION(1, 16, 0)
    heif_image_handle_release_auxiliary_type(auxiliary, &type);
#else
    heif_image_handle_free_auxiliary_types(auxiliary, &type);
#endif
    return text;
}

void add_auxiliary(ImageSpec& spec, const heif_image_handle* handle, const Boxes& boxes) {
    constexpr int kMost = 16;
    std::array<heif_item_id, kMost> ids{};
    const int count = heif_image_handle_get_list_of_auxiliary_image_IDs(
        handle, LIBHEIF_AUX_IMAGE_FILTER_OMIT_ALPHA, ids.data(), kMost);
    std::string others;
    if (boxes.has_tone_map) spec.attribute("heif:GainMap", "tmap (ISO 21496-1)");
    for (int i = 0; i < std::min(count, kMost); ++i) {
        heif_image_handle* out = nullptr;
        const heif_error error = heif_image_handle_get_auxiliary_image_handle(
            handle, ids[static_cast<std::size_t>(i)], &out);
        const Owned<heif_image_handle> auxiliary(out);
        if (error.code != heif_error_Ok || !auxiliary) continue;
        const std::string kind = kind_of(auxiliary.get());
        if (kind.find("gainmap") != std::string::npos || kind.find("21496") != std::string::npos) {
            spec.attribute("heif:GainMap", kind);
        } else {
            others += (others.empty() ? "" : ", ") + kind;
        }
    }
    if (!others.empty()) spec.attribute("heif:Auxiliary", others);
}

void add_luminance(ImageSpec& spec, const heif_image* image) {
    if (heif_image_has_content_light_level(image)) {
        heif_content_light_level level{};
        heif_image_get_content_light_level(image, &level);
        spec.attribute("heif:MaxCLL", static_cast<int>(level.max_content_light_level));
        spec.attribute("heif:MaxFALL", static_cast<int>(level.max_pic_average_light_level));
    }
    if (heif_image_has_mastering_display_colour_volume(image)) {
        heif_mastering_display_colour_volume volume{};
        heif_image_get_mastering_display_colour_volume(image, &volume);
        constexpr float kUnit = 1e-4F;  // cd/m2
        const std::array<float, 2> luminance = {
            static_cast<float>(volume.min_display_mastering_luminance) * kUnit,
            static_cast<float>(volume.max_display_mastering_luminance) * kUnit};
        spec.attribute("heif:MasteringLuminance", TypeDesc(TypeDesc::FLOAT, 2), luminance.data());
    }
    std::uint32_t horizontal = 1;
    std::uint32_t vertical = 1;
    heif_image_get_pixel_aspect_ratio(image, &horizontal, &vertical);
    if (horizontal != vertical && horizontal > 0 && vertical > 0)
        spec.attribute("PixelAspectRatio",
                       static_cast<float>(static_cast<double>(horizontal) / vertical));
}

/// The pictures of a file, as an image format of OpenImageIO. Throws no exception.
class HeifInput final : public OIIO::ImageInput {
  public:
    explicit HeifInput(double max_pixels) : max_pixels_(max_pixels) {}
    ~HeifInput() override { HeifInput::close(); }
    HeifInput(const HeifInput&) = delete;
    HeifInput& operator=(const HeifInput&) = delete;

    [[nodiscard]] const char* format_name() const override { return "heif"; }
    [[nodiscard]] int supports(OIIO::string_view feature) const override {
        return feature == "exif" || feature == "cicp" ? 1 : 0;
    }

    bool open(const std::string& name, ImageSpec& spec) override {
        close();
        const bool is_open = guarded([&] {
            open_file(name);
            decode(0);
        });
        if (is_open) {
            spec = m_spec;
        } else {
            close();
        }
        return is_open;
    }

    bool close() override {
        image_.reset();
        handle_.reset();
        context_.reset();
        ids_.clear();
        subimage_ = -1;
        return true;
    }

    [[nodiscard]] int current_subimage() const override { return subimage_; }
    bool seek_subimage(int subimage, int miplevel) override {
        const std::lock_guard lock(mutex_);
        if (subimage < 0 || subimage >= static_cast<int>(ids_.size()) || miplevel != 0)
            return false;
        return subimage == subimage_ || guarded([&] { decode(subimage); });
    }

    bool read_native_scanline(int subimage, int miplevel, int y, int /*z*/, void* data) override {
        const std::lock_guard lock(mutex_);
        if (!seek_subimage(subimage, miplevel) || y < 0 || y >= m_spec.height) return false;
        const auto channels = planes_.size();
        for (std::size_t c = 0; c < channels; ++c) {
            for (int x = 0; x < m_spec.width; ++x) {
                const std::size_t at = static_cast<std::size_t>(x) * channels + c;
                const std::uint16_t value =
                    tables_[c][code_at(planes_[c], x, y) & planes_[c].largest];
                if (m_spec.format == TypeDesc::UINT8) {
                    static_cast<std::uint8_t*>(data)[at] = static_cast<std::uint8_t>(value);
                } else {
                    static_cast<std::uint16_t*>(data)[at] = value;
                }
            }
        }
        return true;
    }

  private:
    /// Runs `step`; its exceptions become the error of this reader.
    template <class Step>
    bool guarded(const Step& step) noexcept {
        try {
            step();
            return true;
        } catch (...) {
            return report_thrown(*this, "", true);
        }
    }

    void open_file(const std::string& path) {
        context_.reset(heif_context_alloc());
        if (!context_) throw std::bad_alloc();
#if LIBHEIF_HAVE_VERSION(1, 19, 0)
        // Tiles may be larger than the picture.
        constexpr double kTile = 1 << 24;
        constexpr double kMost = 1e18;
        heif_context_get_security_limits(context_.get())->max_image_size_pixels =
            static_cast<std::uint64_t>(std::clamp(max_pixels_, kTile, kMost));
#endif
        require(heif_context_read_from_file(context_.get(), path.c_str(), nullptr));
        heif_item_id primary = 0;
        require(heif_context_get_primary_image_ID(context_.get(), &primary));
        const int count = heif_context_get_number_of_top_level_images(context_.get());
        std::vector<heif_item_id> all(static_cast<std::size_t>(std::max(count, 0)));
        (void)heif_context_get_list_of_top_level_image_IDs(context_.get(), all.data(), count);
        ids_ = {primary};
        std::copy_if(all.begin(), all.end(), std::back_inserter(ids_),
                     [&](heif_item_id id) { return id != primary; });
        boxes_ = read_boxes(path);
    }

    void decode(int subimage) {
        image_.reset();
        subimage_ = -1;
        heif_image_handle* handle = nullptr;
        require(heif_context_get_image_handle(context_.get(),
                                              ids_[static_cast<std::size_t>(subimage)], &handle));
        handle_.reset(handle);
        const int width = heif_image_handle_get_width(handle);
        const int height = heif_image_handle_get_height(handle);
        if (width < 1 || height < 1)
            throw Error(fmt::format("it declares {} x {} pixels", width, height));
        if (static_cast<double>(width) * height > max_pixels_) {
            throw Error(Problem{
                .value = fmt::format("it declares {} x {} pixels", width, height),
                .expected = fmt::format("at most {:.0f} in all (<<max_pixels>>)", max_pixels_)});
        }
        decode_pixels(width, height);
        ImageSpec spec(width, height, static_cast<int>(planes_.size()),
                       is_wide() ? TypeDesc::UINT16 : TypeDesc::UINT8);
        describe(spec);
        m_spec = spec;
        subimage_ = subimage;
    }

    void decode_pixels(int width, int height) {
        // The grid of a damaged file may be larger than the picture that it declares.
#if !LIBHEIF_HAVE_VERSION(1, 19, 0)
        heif_context_set_maximum_image_size_limit(context_.get(), std::max(width, height) + 1);
#endif
        const Owned<heif_decoding_options> options(heif_decoding_options_alloc());
        if (!options) throw std::bad_alloc();
        options->strict_decoding = 1;  // a truncated picture is an error
#if LIBHEIF_HAVE_VERSION(1, 23, 0)
        options->output_image_nclx_profile_passthrough = 1;
#endif
        heif_colorspace space = heif_colorspace_undefined;
        heif_chroma chroma = heif_chroma_undefined;
#if LIBHEIF_HAVE_VERSION(1, 17, 0)
        if (heif_image_handle_get_preferred_decoding_colorspace(handle_.get(), &space, &chroma)
                    .code != heif_error_Ok ||
            space != heif_colorspace_monochrome) {
            space = heif_colorspace_RGB;
            chroma = heif_chroma_444;
        }
#endif
        // Before 1.17, undefined is monochrome or planar RGB.
        decode_as(space, chroma, *options);
        const heif_colorspace got = heif_image_get_colorspace(image_.get());
        if (got != heif_colorspace_monochrome &&
            (got != heif_colorspace_RGB ||
             heif_image_get_chroma_format(image_.get()) != heif_chroma_444))
            decode_as(heif_colorspace_RGB, heif_chroma_444, *options);
        const bool is_gray = heif_image_get_colorspace(image_.get()) == heif_colorspace_monochrome;
        check_range(is_gray);
        planes_.clear();
        const auto add = [&](heif_channel channel) {
            planes_.push_back(plane_of(image_.get(), channel, width, height));
        };
        if (is_gray) {
            add(heif_channel_Y);
        } else {
            add(heif_channel_R);
            add(heif_channel_G);
            add(heif_channel_B);
        }
        if (heif_image_has_channel(image_.get(), heif_channel_Alpha)) add(heif_channel_Alpha);
        fill_tables(is_gray);
    }

    void decode_as(heif_colorspace space, heif_chroma chroma,
                   const heif_decoding_options& options) {
        heif_image* image = nullptr;
        const heif_error error = heif_decode_image(handle_.get(), &image, space, chroma, &options);
        image_.reset(image);
        require(error);
        if (!image_) throw Error("libheif delivers no pixels");
    }

    /// Sets is_limited_ for the luma of monochrome pictures, which libheif delivers as stored.
    void check_range(bool is_gray) {
        heif_color_profile_nclx* out = nullptr;
        if (heif_image_handle_get_nclx_color_profile(handle_.get(), &out).code != heif_error_Ok &&
            !out && is_gray)
            (void)heif_image_get_nclx_color_profile(image_.get(), &out);
        const Owned<heif_color_profile_nclx> nclx(out);
        is_limited_ = nclx && !nclx->full_range_flag;
        // libheif 1.15 narrows these codes once more.
        if (is_limited_ && !is_gray && nclx->matrix_coefficients == 0) {
            throw Error(
                "it stores RGB (matrix coefficients 0) in limited range; expected full range, or "
                "YCbCr");
        }
    }

    [[nodiscard]] bool is_wide() const {
        return std::any_of(planes_.begin(), planes_.end(),
                           [](const Plane& plane) { return plane.is_wide; });
    }

    /// Code -> uint8 or uint16, exactly rounded.
    void fill_tables(bool is_gray) {
        const double top = is_wide() ? 65535 : 255;
        tables_.assign(planes_.size(), {});
        for (std::size_t c = 0; c < planes_.size(); ++c) {
            const double largest = planes_[c].largest;
            // ITU-T H.273, 8.3: luma from 16 to 235, in the bits of the picture.
            const double unit = (largest + 1) / 256;
            const bool is_limited = is_limited_ && is_gray && c == 0;
            const double black = is_limited ? 16 * unit : 0;
            const double white = is_limited ? 235 * unit : largest;
            tables_[c].resize(planes_[c].largest + 1);
            for (std::size_t i = 0; i < tables_[c].size(); ++i) {
                const double value = (static_cast<double>(i) - black) / (white - black);
                tables_[c][i] =
                    static_cast<std::uint16_t>(std::lround(std::clamp(value, 0.0, 1.0) * top));
            }
        }
    }

    void describe(ImageSpec& spec) const {
        const bool has_alpha = planes_.size() % 2 == 0;
        add_metadata(spec, handle_.get());
        const int bits = heif_image_handle_get_luma_bits_per_pixel(handle_.get());
        if (bits > 0) spec.attribute("oiio:BitsPerSample", bits);
        if (has_alpha && !heif_image_handle_is_premultiplied_alpha(handle_.get()))
            spec.attribute("oiio:UnassociatedAlpha", 1);
        // OpenImageIO's color of this format; code points and profiles take precedence.
        spec.attribute("oiio:ColorSpace", "sRGB");
        add_code_points(spec, handle_.get(), boxes_);
        add_icc(spec, handle_.get());
        add_luminance(spec, image_.get());
        add_auxiliary(spec, handle_.get(), boxes_);
        if (boxes_.has_sequence) spec.attribute("heif:Sequence", 1);
    }

    double max_pixels_;
    Owned<heif_context> context_;
    std::vector<heif_item_id> ids_;  // of the pictures, the primary one first
    Boxes boxes_;
    std::recursive_mutex mutex_;  // OIIO's cache reads from several threads
    int subimage_ = -1;
    // State of the current picture:
    Owned<heif_image_handle> handle_;
    Owned<heif_image> image_;
    bool is_limited_ = false;
    std::vector<Plane> planes_;
    std::vector<std::vector<std::uint16_t>> tables_;
};

}  // namespace

bool is_heif(const std::string& path) {
    std::ifstream file(path, std::ios::binary);
    std::string head(256, '\0');
    file.read(head.data(), static_cast<std::streamsize>(head.size()));
    head.resize(static_cast<std::size_t>(file.gcount()));
    const std::optional<Box> box = parse_box(head);
    if (!box || box->type != "ftyp") return false;
    // ISO/IEC 23008-12 and AV1 Image File Format. The second number in `ftyp` is no brand.
    constexpr std::array<std::string_view, 14> kBrands = {"mif1", "mif2", "mif3", "msf1", "heic",
                                                          "heix", "heim", "heis", "hevc", "hevx",
                                                          "hevm", "hevs", "avif", "avis"};
    const std::size_t end = std::min<std::size_t>(head.size(), box->size);
    for (std::size_t at = box->header; at + 4 <= end; at += 4) {
        if (at == box->header + 4) continue;
        if (std::find(kBrands.begin(), kBrands.end(), std::string_view(head).substr(at, 4)) !=
            kBrands.end())
            return true;
    }
    return false;
}

std::unique_ptr<OIIO::ImageInput> open_heif(const std::string& path, double max_pixels) {
    std::unique_ptr<OIIO::ImageInput> in = std::make_unique<HeifInput>(max_pixels);
    ImageSpec spec;
    if (!in->open(path, spec))
        throw FileError(within(path + ": cannot read", problem_of_library(in->geterror())));
    return in;
}

TONEWRIGHT_NAMESPACE_END

#else

TONEWRIGHT_NAMESPACE_BEGIN

bool is_heif(const std::string&) { return false; }
std::unique_ptr<OIIO::ImageInput> open_heif(const std::string&, double) { return nullptr; }

TONEWRIGHT_NAMESPACE_END

#endif
