// SPDX-License-Identifier: Apache-2.0
#include "picture/exr_writer.h"

#include <OpenEXR/openexr.h>
#include <fmt/format.h>
#include <libdeflate.h>
#include <unistd.h>

#include <algorithm>
#include <bit>
#include <cerrno>
#include <cstdint>
#include <cstring>
#include <mutex>
#include <new>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "base/strings.h"
#include "base/system_files.h"
#include "lut/in_parallel.h"
#include "picture/compression.h"
#include "picture/exr_attributes.h"
#include "picture/exr_core.h"
#include "picture/exr_header.h"
#include "picture/exr_library.h"
#include "picture/file_bytes.h"
#include "picture/half.h"
#include "picture/row_kernels.h"
#include "tonewright/error.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

using T = OIIO::TypeDesc;
using Bytes = std::vector<std::uint8_t>;

struct DeflaterCloser {
    void operator()(libdeflate_compressor* deflater) const { libdeflate_free_compressor(deflater); }
};
using Deflater = std::unique_ptr<libdeflate_compressor, DeflaterCloser>;

/// Compressors, which threads take and give back: each has a megabyte of tables.
class Deflaters {
  public:
    explicit Deflaters(int level) : level_(level) {}

    /// A zlib stream; empty if it is not smaller than the bytes.
    Bytes run(const Bytes& bytes) {
        Deflater deflater = take();
        Bytes packed(bytes.size());
        packed.resize(libdeflate_zlib_compress(deflater.get(), bytes.data(), bytes.size(),
                                               packed.data(), packed.size() - 1));
        const std::scoped_lock lock(mutex_);
        idle_.push_back(std::move(deflater));
        return packed;
    }

  private:
    Deflater take() {
        {
            const std::scoped_lock lock(mutex_);
            if (!idle_.empty()) {
                Deflater deflater = std::move(idle_.back());
                idle_.pop_back();
                return deflater;
            }
        }
        Deflater deflater(libdeflate_alloc_compressor(level_));
        if (!deflater) throw std::bad_alloc();
        return deflater;
    }

    int level_;
    std::mutex mutex_;
    std::vector<Deflater> idle_;
};

/// Compressions of OpenEXR's core, which needs a file for them: one that is never written.
class CoreEncoder {
  public:
    CoreEncoder(const PictureSpec& spec, exr_compression_t compression) {
        exr_context_initializer_t options = exr_options();
        options.write_fn = [](exr_const_context_t, void*, const void*, std::uint64_t count,
                              std::uint64_t, exr_stream_error_func_ptr_t) {
            return static_cast<std::int64_t>(count);
        };
        exr_context_t opened = nullptr;
        check_exr(exr_start_write(&opened, "nowhere", EXR_WRITE_FILE_DIRECTLY, &options));
        file_.reset(opened);
        check_exr(exr_set_longname_support(opened, 1));
        int part = 0;
        check_exr(exr_add_part(opened, nullptr, EXR_STORAGE_SCANLINE, &part));
        const exr_attr_box2i_t window = {{{{spec.x, spec.y}}},
                                         {{{spec.x + spec.width - 1, spec.y + spec.height - 1}}}};
        const exr_attr_v2f_t center = {{{0, 0}}};
        check_exr(exr_initialize_required_attr(opened, part, &window, &window, 1, &center, 1,
                                               EXR_LINEORDER_INCREASING_Y, compression));
        for (const std::string& name :
             std::set<std::string>(spec.channelnames.begin(), spec.channelnames.end())) {
            check_exr(exr_add_channel(opened, part, name.c_str(), pixel_type_of(spec.format),
                                      EXR_PERCEPTUALLY_LOGARITHMIC, 1, 1));
        }
        check_exr(exr_write_header(opened));
    }

    /// @param y  of the first row of the block
    /// @returns  empty if it is not smaller than the planes
    Bytes run(int y, const Bytes& planes) {
        exr_chunk_info_t chunk = {};
        check_exr(exr_write_scanline_chunk_info(file_.get(), 0, y, &chunk));
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wmissing-field-initializers"
        exr_encode_pipeline_t encoder = EXR_ENCODE_PIPELINE_INITIALIZER;
#pragma GCC diagnostic pop
        struct Destroyer {
            exr_const_context_t file;
            exr_encode_pipeline_t* encoder;
            ~Destroyer() { exr_encoding_destroy(file, encoder); }
        };
        check_exr(exr_encoding_initialize(file_.get(), 0, &chunk, &encoder));
        const Destroyer destroyer = {file_.get(), &encoder};
        const std::uint8_t* from = planes.data();
        for (int c = 0; c < encoder.channel_count; ++c) {
            exr_coding_channel_info_t& channel = encoder.channels[c];
            channel.encode_from_ptr = from;
            channel.user_pixel_stride = static_cast<std::uint8_t>(channel.bytes_per_element);
            channel.user_line_stride =
                static_cast<std::int32_t>(planes.size() / static_cast<std::size_t>(chunk.height));
            from += static_cast<std::size_t>(chunk.width) *
                    static_cast<std::size_t>(channel.bytes_per_element);
        }
        check_exr(exr_encoding_choose_default_routines(file_.get(), 0, &encoder));
        encoder.yield_until_ready_fn = nullptr;  // the block is written elsewhere
        encoder.write_fn = nullptr;
        check_exr(exr_encoding_run(file_.get(), 0, &encoder));
        if (encoder.compressed_bytes >= planes.size()) return {};
        const auto* const packed = static_cast<const std::uint8_t*>(encoder.compressed_buffer);
        return {packed, packed + encoder.compressed_bytes};
    }

  private:
    ExrFile file_;
};

/// Rows of a block to its bytes in the file, which are those of other writers of OpenEXR.
class BlockEncoder {
  public:
    BlockEncoder(const PictureSpec& spec, exr_compression_t compression, int level)
        : width_(static_cast<std::size_t>(spec.width)),
          channels_(static_cast<std::size_t>(spec.nchannels)),
          type_(spec.format),
          compression_(compression),
          order_(channels_),
          deflaters_(level) {
        std::vector<std::size_t> by_name(channels_);
        for (std::size_t c = 0; c < channels_; ++c)
            by_name[c] = c;
        std::sort(by_name.begin(), by_name.end(), [&](std::size_t a, std::size_t b) {
            return spec.channelnames[a] < spec.channelnames[b];
        });
        for (std::size_t c = 0; c < channels_; ++c)
            order_[by_name[c]] = c;
        if (ExrLibrary::knows(compression)) {
            std::vector<ExrChannel> planes;
            planes.reserve(channels_);
            for (const std::size_t c : by_name)
                planes.push_back(
                    {.name = spec.channelnames[c], .type = pixel_type_of(spec.format)});
            library_.emplace(std::move(planes), width_, compression,
                             spec.get_float_attribute("openexr:dwaCompressionLevel"));
        } else if (!is_deflated() && compression != EXR_COMPRESSION_NONE) {
            core_.emplace(spec, compression);
        }
    }

    /// The stored bytes.
    /// @param y     of the first row
    /// @param rows  interleaved, of `type`
    Bytes run(int y, int row_count, const T& type, const std::byte* rows) {
        // A block of the size of its planes holds them as they are: readers know it by the size.
        if (is_deflated()) {
            Bytes packed = deflaters_.run(predicted(row_count, type, rows));
            return packed.empty() ? planes_of(row_count, type, rows) : packed;
        }
        Bytes planes = planes_of(row_count, type, rows);
        if (library_) return library_->pack(std::move(planes));
        if (!core_) return planes;
        Bytes packed = core_->run(y, planes);
        return packed.empty() ? planes : packed;
    }

    [[nodiscard]] std::size_t row_bytes() const { return width_ * channels_ * number_bytes(); }

  private:
    [[nodiscard]] bool is_deflated() const {
        return compression_ == EXR_COMPRESSION_ZIP || compression_ == EXR_COMPRESSION_ZIPS;
    }
    [[nodiscard]] std::size_t number_bytes() const { return type_ == T::HALF ? 2 : 4; }

    /// Planes of channels by name, row after row, to a function of (row, bytes).
    template <class F>
    void for_each_row(int row_count, const T& type, const std::byte* rows, std::uint8_t* to,
                      std::size_t to_step, const F& use) const {
        const RowKernels& kernels = row_kernels().front();
        const bool converts = type != type_;
        Bytes converted(converts ? row_bytes() : 0);
        const std::size_t from_step = width_ * channels_ * size_of(type);
        std::vector<std::uint8_t*> planes(channels_);
        for (int row = 0; row < row_count; ++row, to += to_step) {
            const std::byte* pixels = rows + static_cast<std::size_t>(row) * from_step;
            if (converts) {
                convert(type, pixels, converted.data());
                pixels = reinterpret_cast<const std::byte*>(converted.data());
            }
            for (std::size_t c = 0; c < channels_; ++c)
                planes[c] = to + order_[c] * width_ * number_bytes();
            (type_ == T::HALF ? kernels.separate_16 : kernels.separate_32)(
                reinterpret_cast<const std::uint8_t*>(pixels), channels_, width_, planes.data());
            use(static_cast<std::size_t>(row));
        }
    }

    void convert(const T& from_type, const std::byte* from, std::uint8_t* to) const {
        for (std::size_t i = 0; i < width_ * channels_; ++i) {
            if (from_type == T::FLOAT) {
                float value = 0;
                std::memcpy(&value, from + i * sizeof value, sizeof value);
                const std::uint16_t half = nearest_half(value);
                std::memcpy(to + i * sizeof half, &half, sizeof half);
            } else {
                std::uint16_t half = 0;
                std::memcpy(&half, from + i * sizeof half, sizeof half);
                const float value = half_value(half);
                std::memcpy(to + i * sizeof value, &value, sizeof value);
            }
        }
    }

    Bytes planes_of(int row_count, const T& type, const std::byte* rows) const {
        Bytes planes(row_bytes() * static_cast<std::size_t>(row_count));
        for_each_row(row_count, type, rows, planes.data(), row_bytes(), [](std::size_t) {});
        return planes;
    }

    /// First the even bytes of all planes, then the odd ones, as differences.
    Bytes predicted(int row_count, const T& type, const std::byte* rows) const {
        const RowKernels& kernels = row_kernels().front();
        Bytes row_planes(row_bytes());
        Bytes bytes(row_bytes() * static_cast<std::size_t>(row_count));
        const std::size_t pairs = row_bytes() / 2;
        std::uint8_t* const second = bytes.data() + bytes.size() / 2;
        for_each_row(row_count, type, rows, row_planes.data(), 0, [&](std::size_t row) {
            kernels.split_bytes(row_planes.data(), pairs, bytes.data() + row * pairs,
                                second + row * pairs);
        });
        kernels.differences(bytes.data(), bytes.size());
        return bytes;
    }

    std::size_t width_;
    std::size_t channels_;
    T type_;
    exr_compression_t compression_;
    std::vector<std::size_t> order_;  // of each channel, its place among the planes
    Deflaters deflaters_;
    std::optional<CoreEncoder> core_;
    std::optional<ExrLibrary> library_;
};

class ExrWriter final : public RowWriter {
  public:
    ExrWriter(int file, PictureSpec spec, exr_compression_t compression, int rows_of_block,
              int level, unsigned threads)
        : file_(file),
          spec_(std::move(spec)),
          rows_of_block_(rows_of_block),
          encoder_(spec_, compression, level),
          threads_(threads) {
        const std::string header = exr_header_of(spec_, compression);
        table_place_ = header.size();
        const auto blocks = static_cast<std::size_t>((spec_.height - 1) / rows_of_block) + 1;
        table_.reserve(blocks);
        end_ = table_place_ + blocks * sizeof(std::uint64_t);
        write_all(file_, header.data(), header.size());
        const std::vector<std::uint64_t> empty(blocks);
        write_all(file_, empty.data(), blocks * sizeof(std::uint64_t));
    }

    [[nodiscard]] const PictureSpec& spec() const override { return spec_; }

    void write_rows(int row_count, T type, const std::byte* rows) override {
        const std::size_t step = size_of(type) * static_cast<std::size_t>(spec_.nchannels) *
                                 static_cast<std::size_t>(spec_.width);
        // A block that began in the rows before, which were of the same type.
        if (begun_rows_ > 0) {
            const int taken = std::min(row_count, rows_of_next_block() - begun_rows_);
            begin(taken, step, rows);
            row_count -= taken;
            rows += static_cast<std::size_t>(taken) * step;
            if (begun_rows_ < rows_of_next_block()) return;
            write_blocks(begun_rows_, type, step, begun_.data());
            begun_rows_ = 0;
            begun_.clear();
        }
        const int left = spec_.height - written_rows_;
        const int whole =
            row_count == left ? row_count : row_count / rows_of_block_ * rows_of_block_;
        write_blocks(whole, type, step, rows);
        begin(row_count - whole, step, rows + static_cast<std::size_t>(whole) * step);
    }

    void finish() override {
        if (written_rows_ != spec_.height)
            throw FileError(fmt::format("{} of {} rows were written", written_rows_, spec_.height));
        if (::lseek(file_, static_cast<::off_t>(table_place_), SEEK_SET) < 0)
            throw FileError(problem_of_system(errno));
        write_all(file_, table_.data(), table_.size() * sizeof(std::uint64_t));
    }

  private:
    [[nodiscard]] int rows_of_next_block() const {
        return std::min(rows_of_block_, spec_.height - written_rows_);
    }

    /// Keeps rows of a block that is not complete.
    void begin(int row_count, std::size_t step, const std::byte* rows) {
        begun_.insert(begun_.end(), rows, rows + static_cast<std::size_t>(row_count) * step);
        begun_rows_ += row_count;
    }

    void write_blocks(int row_count, T type, std::size_t step, const std::byte* rows) {
        if (row_count == 0) return;
        std::vector<Bytes> blocks(static_cast<std::size_t>((row_count - 1) / rows_of_block_ + 1));
        in_parallel(blocks.size(), threads_, [&](std::size_t i) {
            const int first = static_cast<int>(i) * rows_of_block_;
            blocks[i] = encoder_.run(spec_.y + written_rows_ + first,
                                     std::min(rows_of_block_, row_count - first), type,
                                     rows + static_cast<std::size_t>(first) * step);
        });
        for (const Bytes& block : blocks) {
            const std::int32_t leader[2] = {spec_.y + written_rows_,
                                            static_cast<std::int32_t>(block.size())};
            write_all(file_, leader, sizeof leader);
            write_all(file_, block.data(), block.size());
            table_.push_back(end_);
            end_ += sizeof leader + block.size();
            written_rows_ += rows_of_next_block();
        }
    }

    int file_;
    PictureSpec spec_;
    int rows_of_block_;
    BlockEncoder encoder_;
    unsigned threads_;
    std::size_t table_place_ = 0;       // in the file
    std::vector<std::uint64_t> table_;  // of the blocks' places
    std::uint64_t end_ = 0;             // of what was written
    int written_rows_ = 0;
    std::vector<std::byte> begun_;  // rows of the next block
    int begun_rows_ = 0;
};

/// libdeflate's level for zlib's, which a quality names ("zip:9"). Level 2 gives files as small as
/// zlib's level 4, OpenImageIO's default: 0.70 to 1.00 of their size for the photographs of
/// OpenEXR, where level 1 gives up to 1.03.
int deflate_level(const PictureSpec& spec) {
    constexpr int kDefault = 2;
    const int quality = quality_of(spec, 0);
    if (quality < 1 || quality > 9) return kDefault;
    return quality <= 4 ? std::min(quality, kDefault) : quality;
}

/// Names that the format can hold, each once.
bool has_good_names(const PictureSpec& spec) {
    constexpr std::size_t kLongestName = 255;
    const std::set<std::string> names(spec.channelnames.begin(), spec.channelnames.end());
    return names.size() == spec.channelnames.size() &&
           std::all_of(names.begin(), names.end(), [](const std::string& name) {
               return name.size() <= kLongestName && name.find('\0') == std::string::npos;
           });
}

}  // namespace

std::unique_ptr<RowWriter> create_exr(int file, const PictureSpec& spec, unsigned threads) {
    if constexpr (std::endian::native != std::endian::little) return nullptr;
    if (spec.deep || spec.tile_width > 0 || spec.depth > 1 || !spec.channelformats.empty() ||
        spec.nchannels < 1 || spec.width < 1 || spec.height < 1)
        return nullptr;
    PictureSpec fitted = spec;
    fit_to_exr(fitted);
    if (lowercase(fitted.get_string_attribute("openexr:lineOrder")) == "decreasingy" ||
        !has_good_names(fitted))
        return nullptr;
    // OpenImageIO takes "zip" for a name that it does not know.
    const exr_compression_t compression =
        compression_of(lowercase(fitted.get_string_attribute("compression")))
            .value_or(EXR_COMPRESSION_ZIP);
    const bool is_dwa = compression == EXR_COMPRESSION_DWAA || compression == EXR_COMPRESSION_DWAB;
    if (is_dwa && fitted.nchannels == 1) return nullptr;  // OpenImageIO 2.4 writes ZIP
    const int rows_of_block = tonewright::rows_of_block(compression_name(compression));
    // The size of a block is a number of 31 bits.
    if (fitted.scanline_bytes() > static_cast<std::size_t>(INT32_MAX / rows_of_block))
        return nullptr;
    return std::make_unique<ExrWriter>(file, std::move(fitted), compression, rows_of_block,
                                       deflate_level(spec), threads);
}

TONEWRIGHT_NAMESPACE_END
