// SPDX-License-Identifier: Apache-2.0
//
// A picture file, tone mapped, as an image format of OpenImageIO: "shot.exr.tonewright?op=hable" is
// shot.exr through Hable, in every program that reads through OpenImageIO.
//
// It throws no exception, and exports only the symbols that OpenImageIO needs of a plugin.
#include <OpenImageIO/imagebuf.h>
#include <OpenImageIO/imageio.h>
#include <fmt/format.h>

#include <algorithm>
#include <cstddef>
#include <exception>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "base/input_file.h"
#include "base/strings.h"
#include "image/lut_picture.h"
#include "image/picture_file.h"
#include "image/report_thrown.h"
#include "image/scene_meter.h"
#include "image/spec_conversion.h"
#include "image/tonemap_arguments.h"
#include "image/tonemap_file.h"
#include "picture/header_tags.h"
#include "picture/layers.h"
#include "picture/picture_description.h"
#include "picture/source_pixels.h"
#include "plugin/request.h"
#include "tonewright/lut.h"
#include "tonewright/registry.h"
#include "tonewright/tonemap.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

using OIIO::ImageBuf;
using OIIO::ImageInput;
using OIIO::ImageSpec;
using OIIO::ROI;

/// Set while a thread opens the picture of a name. The picture's name must not be one that this
/// format opens: a text file that names itself would never end.
class Opening {
  public:
    /// @throws Error
    explicit Opening(const std::string& name) {
        if (is_open_)
            throw Error("picture is " + name + "; expected one that is not tone mapped yet");
        is_open_ = true;
    }
    ~Opening() { is_open_ = false; }
    Opening(const Opening&) = delete;
    Opening& operator=(const Opening&) = delete;

  private:
    static thread_local bool is_open_;
};
thread_local bool Opening::is_open_ = false;

TonemapArguments parse_arguments(const Arguments& arguments, const ImageSpec& config) {
    TonemapArguments options;
    // Settings of an application for the format: `tonewright:op` and so on.
    constexpr std::string_view kPrefix = "tonewright:";
    for (const OIIO::ParamValue& hint : config.extra_attribs) {
        const std::string name(hint.name());
        if (name.compare(0, kPrefix.size(), kPrefix) != 0) continue;
        set_tonemap_argument(options, std::string_view(name).substr(kPrefix.size()),
                             hint.get_string());
    }
    for (const auto& [name, value] : arguments)
        set_tonemap_argument(options, name, value);
    if (options.op.empty())
        throw Error("op is missing; expected ?op=OPERATOR, an id from `tonewright list`");
    return options;
}

/// A picture and its tonemapper.
class TonemappedInput final : public ImageInput {
  public:
    TonemappedInput() = default;
    ~TonemappedInput() override { TonemappedInput::close(); }
    TonemappedInput(const TonemappedInput&) = delete;
    TonemappedInput& operator=(const TonemappedInput&) = delete;

    [[nodiscard]] const char* format_name() const override { return "tonewright"; }
    // Not "procedural", which is for pictures without a file: OpenImageIO's programs would continue
    // if the file is missing.
    [[nodiscard]] int supports(OIIO::string_view feature) const override {
        return picture_ && feature != "thumbnail" && feature != "procedural" && feature != "ioproxy"
                   ? picture_->supports(feature)
                   : 0;
    }

    bool open(const std::string& name, ImageSpec& spec) override {
        return open(name, spec, ImageSpec());
    }
    bool open(const std::string& name, ImageSpec& spec, const ImageSpec& config) override {
        close();
        const bool is_open = guarded([&] {
            const Opening opening(name);
            const Request request = parse_request(name);
            path_ = request.picture;
            take_arguments(parse_arguments(request.arguments, config));
            picture_ = open_picture(path_, &config);
            go_to(0, 0);
        });
        if (is_open) {
            spec = m_spec;
        } else {
            close();
        }
        return is_open;
    }

    bool close() override {
        picture_.reset();
        tonemapper_.reset();
        levels_.clear();
        measured_.clear();
        subimage_ = miplevel_ = 0;
        return true;
    }

    [[nodiscard]] int current_subimage() const override { return subimage_; }
    [[nodiscard]] int current_miplevel() const override { return miplevel_; }
    bool seek_subimage(int subimage, int miplevel) override {
        if (!picture_) return false;
        // Not an error: applications find the last subimage in this way.
        const std::lock_guard lock(mutex_);
        if (levels_.count({subimage, miplevel}) == 0) {
            const std::unique_lock header = lock_header(path_);
            if (!picture_->seek_subimage(subimage, miplevel)) return false;
        }
        return guarded([&] { go_to(subimage, miplevel); });
    }

    bool read_native_scanline(int subimage, int miplevel, int y, int z, void* data) override {
        return read_native_scanlines(subimage, miplevel, y, y + 1, z, data);
    }
    bool read_native_scanlines(int subimage, int miplevel, int ybegin, int yend, int z,
                               void* data) override {
        return guarded([&] {
            const Level& level = level_of(subimage, miplevel);
            const ImageSpec& s = level.source;
            const ROI part(s.x, s.x + s.width, ybegin, std::min(yend, s.y + s.height), z, z + 1, 0,
                           s.nchannels);
            std::vector<std::byte> pixels = buffer_for(level, part);
            check(picture_->read_scanlines(subimage, miplevel, part.ybegin, part.yend, z, 0,
                                           s.nchannels, s.format, pixels.data()));
            tonemap(subimage, level, part, pixels.data(), data, part.width());
        });
    }
    bool read_native_tile(int subimage, int miplevel, int x, int y, int z, void* data) override {
        return guarded([&] {
            const ImageSpec& s = level_of(subimage, miplevel).source;
            read_tiles_of(subimage, miplevel, x, x + s.tile_width, y, y + s.tile_height, z,
                          z + s.tile_depth, data, s.tile_width);
        });
    }
    bool read_native_tiles(int subimage, int miplevel, int xbegin, int xend, int ybegin, int yend,
                           int zbegin, int zend, void* data) override {
        return guarded([&] {
            read_tiles_of(subimage, miplevel, xbegin, xend, ybegin, yend, zbegin, zend, data,
                          xend - xbegin);
        });
    }
    // The ranges of channels that the base class takes from these are its own.
    using ImageInput::read_native_scanlines;
    using ImageInput::read_native_tiles;

  private:
    /// One picture of the file.
    struct Level {
        ImageSpec source;  // the fields that tonemap() reads
        ImageSpec result;
        /// Order of the file's channels, the picture's layer first; empty: as stored.
        std::vector<int> order;
    };

    /// Runs `step`; its exceptions become the error of this reader.
    template <class Step>
    bool guarded(const Step& step) noexcept {
        try {
            step();
            return true;
        } catch (...) {
            return report_thrown(*this, "tonewright: ");
        }
    }

    /// Throws the error of the picture's own reader.
    /// @throws FileError
    void check(bool was_read) const {
        if (was_read) return;
        const std::string reported = picture_->geterror();
        throw FileError(fmt::format(
            "{}: cannot read: {}", path_,
            reported.empty() ? "the file is truncated or damaged" : first_line(reported)));
    }

    /// @throws Error  without anything of the operator's file in it
    void take_arguments(const TonemapArguments& arguments) {
        static const OperatorSet files(table_reader(picture_table_reader()));
        try {
            tonemapper_.emplace(resolve_arguments(arguments, files));
        } catch (const FileError& e) {
            std::vector<std::string> named = {arguments.op};
            for (const auto& [name, value] : arguments.settings)
                named.push_back(value);
            throw FileError(without_contents(e.what(), named));
        }
    }

    /// Called with the lock.
    void go_to(int subimage, int miplevel) {
        auto found = levels_.find({subimage, miplevel});
        if (found == levels_.end()) {
            const std::unique_lock header = lock_header(path_);
            ImageSpec source = picture_->spec(subimage, miplevel);
            if (source.deep)
                throw Error(path_ + " is deep; expected flat pixels (oiiotool --flatten)");
            if (source.width < 1 || source.height < 1)
                throw FileError(path_ + ": cannot read: the picture has no pixels");
            check_pixel_type("picture", source.format);
            source.channelformats.clear();  // all channels are read in the widest of them
            std::vector<int> order;
            change_spec(source, [&](PictureSpec& spec) {
                complete_channel_names(spec);
                complete_header(path_, picture_->format_name(), subimage, spec);
                const std::vector<Layer> layers = color_layers(spec);
                const bool has_layers = std::string_view(picture_->format_name()) == "openexr";
                if (const Layer* layer = has_layers ? picture_layer(layers) : nullptr) {
                    order = order_of(*layer, spec);
                    reorder(spec, order, layer->channels.size() > 3);
                    if (std::is_sorted(order.begin(), order.end())) order.clear();
                }
            });
            ImageSpec result = result_spec(*tonemapper_, source);
            result.tile_width = source.tile_width;
            result.tile_height = source.tile_height;
            result.tile_depth = source.tile_depth;
            found = levels_
                        .emplace(std::pair(subimage, miplevel),
                                 Level{image_spec(with_color_metadata_alone(picture_spec(source))),
                                       std::move(result), std::move(order)})
                        .first;
        }
        subimage_ = subimage;
        miplevel_ = miplevel;
        m_spec = found->second.result;
    }

    /// Levels stay where they are until the picture is closed.
    const Level& level_of(int subimage, int miplevel) {
        const std::lock_guard lock(mutex_);
        if (!picture_) throw Error("no picture is open");
        const auto found = levels_.find({subimage, miplevel});
        if (found != levels_.end()) return found->second;
        const int current_subimage = subimage_;
        const int current_miplevel = miplevel_;
        const std::unique_lock header = lock_header(path_);
        if (!picture_->seek_subimage(subimage, miplevel))
            throw Error(fmt::format("{} has no subimage {}, level {}", path_, subimage, miplevel));
        go_to(subimage, miplevel);
        go_to(current_subimage, current_miplevel);
        return levels_.at({subimage, miplevel});
    }

    /// The tonemapper of a subimage, with the statistics of its full resolution.
    const Tonemapper& tonemapper_of(int subimage) {
        if (!tonemapper_->takes_statistics()) return *tonemapper_;
        const std::lock_guard lock(mutex_);
        auto found = measured_.find(subimage);
        if (found == measured_.end()) {
            MeterOptions options = meter_options(tonemapper_->options());
            options.read.subimage = fmt::to_string(subimage);
            const SceneStatistics statistics =
                measure_file(path_, options, SceneMeter::Figures::statistics, threads())
                    .statistics();
            found = measured_.emplace(subimage, tonemapper_->with_statistics(statistics)).first;
        }
        return found->second;
    }

    static std::vector<std::byte> buffer_for(const Level& level, const ROI& part) {
        return std::vector<std::byte>(static_cast<std::size_t>(part.npixels()) *
                                      level.source.pixel_bytes());
    }

    void read_tiles_of(int subimage, int miplevel, int xbegin, int xend, int ybegin, int yend,
                       int zbegin, int zend, void* data, int row_pixels) {
        const Level& level = level_of(subimage, miplevel);
        const ImageSpec& s = level.source;
        const ROI part(xbegin, std::min(xend, s.x + s.width), ybegin,
                       std::min(yend, s.y + s.height), zbegin, std::min(zend, s.z + s.depth), 0,
                       s.nchannels);
        std::vector<std::byte> pixels = buffer_for(level, part);
        check(picture_->read_tiles(subimage, miplevel, part.xbegin, part.xend, part.ybegin,
                                   part.yend, part.zbegin, part.zend, 0, s.nchannels, s.format,
                                   pixels.data()));
        tonemap(subimage, level, part, pixels.data(), data, row_pixels, yend - ybegin);
    }

    /// @param to           where the part's first pixel goes
    /// @param row_pixels   distance of its rows there, in pixels
    /// @param slice_rows   distance of its slices there, in rows
    void tonemap(int subimage, const Level& level, const ROI& part, std::byte* from, void* to,
                 int row_pixels, int slice_rows = 1) {
        const auto cut = [&](ImageSpec spec) {
            spec.x = part.xbegin;
            spec.y = part.ybegin;
            spec.z = part.zbegin;
            spec.width = part.width();
            spec.height = part.height();
            spec.depth = part.depth();
            spec.tile_width = spec.tile_height = spec.tile_depth = 0;
            return spec;
        };
        std::vector<std::byte> ordered;
        if (!level.order.empty()) {
            ordered.resize(static_cast<std::size_t>(part.npixels()) * level.source.pixel_bytes());
            reorder(from, level.source.nchannels, level.order, level.source.format.size(),
                    static_cast<std::size_t>(part.npixels()), ordered.data());
            from = ordered.data();
        }
        const ImageBuf source(cut(level.source), from);
        const ImageSpec spec =
            cut(image_spec(with_color_metadata_alone(picture_spec(level.result))));
        const auto row = static_cast<OIIO::stride_t>(spec.pixel_bytes()) * row_pixels;
        ImageBuf result(spec, to, static_cast<OIIO::stride_t>(spec.pixel_bytes()), row,
                        row * slice_rows);
        if (!tonemapper_of(subimage)(result, source, {}, threads()))
            throw Error(path_ + ": " + result.geterror());
    }

    std::string path_;
    std::optional<Tonemapper> tonemapper_;
    std::unique_ptr<ImageInput> picture_;
    // OIIO's cache reads from several threads. The picture's own reader locks itself.
    std::recursive_mutex mutex_;
    std::map<std::pair<int, int>, Level> levels_;
    std::map<int, Tonemapper> measured_;
    int subimage_ = 0;
    int miplevel_ = 0;
};

}  // namespace
TONEWRIGHT_NAMESPACE_END

// NOLINTBEGIN(readability-identifier-naming): OpenImageIO looks for these names.
OIIO_PLUGIN_EXPORTS_BEGIN

OIIO_EXPORT int tonewright_imageio_version = OIIO_PLUGIN_VERSION;
OIIO_EXPORT const char* tonewright_imageio_library_version() { return nullptr; }
OIIO_EXPORT OIIO::ImageInput* tonewright_input_imageio_create() {
    try {
        return new tonewright::TonemappedInput;
    } catch (...) {
        return nullptr;
    }
}
OIIO_EXPORT const char* tonewright_input_extensions[] = {"tonewright", nullptr};

OIIO_PLUGIN_EXPORTS_END
// NOLINTEND(readability-identifier-naming)
