// SPDX-License-Identifier: Apache-2.0
#include "picture/exr_reader.h"

#include <OpenEXR/openexr.h>
#include <libdeflate.h>

#include <algorithm>
#include <bit>
#include <cstdint>
#include <cstring>
#include <new>
#include <optional>
#include <utility>
#include <vector>

#include "lut/in_parallel.h"
#include "picture/exr_core.h"
#include "picture/exr_header.h"
#include "picture/exr_library.h"
#include "picture/half.h"
#include "picture/row_kernels.h"
#include "tonewright/error.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

[[noreturn]] void throw_damaged() { throw FileError("the file is truncated or damaged"); }

struct InflaterCloser {
    void operator()(libdeflate_decompressor* inflater) const {
        libdeflate_free_decompressor(inflater);
    }
};

using Bytes = std::unique_ptr<std::uint8_t[]>;
/// Not cleared.
Bytes make_bytes(std::size_t count) {
    return std::make_unique_for_overwrite<std::uint8_t[]>(count);
}

/// The pixels of a block, as the file has them after decompression: rows of planes of channels.
class Block {
  public:
    /// Reads and decompresses.
    /// @throws FileError  damaged
    Block(exr_const_context_t file, int part_number, const ExrPart& part,
          const exr_chunk_info_t& chunk)
        : kernels_(&row_kernels().front()),
          row_bytes_(static_cast<std::size_t>(chunk.width) * part.pixel_bytes()) {
        const std::size_t bytes = row_bytes_ * static_cast<std::size_t>(chunk.height);
        if (chunk.packed_size == 0 || chunk.packed_size > bytes || chunk.unpacked_size != bytes)
            throw_damaged();
        const bool is_stored = chunk.packed_size == bytes;
        const bool is_deflated =
            part.compression == EXR_COMPRESSION_ZIP || part.compression == EXR_COMPRESSION_ZIPS;
        if (!is_stored && !is_deflated) {
            if (ExrLibrary::knows(part.compression)) {
                unpack(file, part_number, part, chunk, bytes);
            } else {
                decompress(file, part_number, part, chunk, bytes);
            }
            return;
        }
        pixels_ = stored_bytes(file, part_number, chunk);
        if (is_stored) return;
        inflate(chunk.packed_size, bytes);
        first_bytes_ = pixels_.get();
        second_bytes_ = first_bytes_ + (bytes + 1) / 2;
        row_ = make_bytes(row_bytes_);
    }

    /// The planes of a row, until the next call.
    const std::uint8_t* row(int index) {
        const std::size_t at = static_cast<std::size_t>(index) * row_bytes_;
        if (!row_) return pixels_.get() + at;
        kernels_->join_bytes(first_bytes_ + at / 2, second_bytes_ + at / 2, row_bytes_ / 2,
                             row_.get());
        return row_.get();
    }

  private:
    static Bytes stored_bytes(exr_const_context_t file, int part_number,
                              const exr_chunk_info_t& chunk) {
        Bytes bytes = make_bytes(chunk.packed_size);
        check_exr(exr_read_chunk(file, part_number, &chunk, bytes.get()));
        return bytes;
    }

    void inflate(std::size_t packed_bytes, std::size_t bytes) {
        const std::unique_ptr<libdeflate_decompressor, InflaterCloser> inflater(
            libdeflate_alloc_decompressor());
        if (!inflater) throw std::bad_alloc();
        Bytes inflated = make_bytes(bytes);
        if (libdeflate_zlib_decompress(inflater.get(), pixels_.get(), packed_bytes, inflated.get(),
                                       bytes, nullptr) != LIBDEFLATE_SUCCESS)
            throw_damaged();
        pixels_ = std::move(inflated);
        kernels_->undo_differences(pixels_.get(), bytes);
    }

    void unpack(exr_const_context_t file, int part_number, const ExrPart& part,
                const exr_chunk_info_t& chunk, std::size_t bytes) {
        const Bytes packed = stored_bytes(file, part_number, chunk);
        pixels_ = make_bytes(bytes);
        const ExrLibrary library(part.channels, static_cast<std::size_t>(chunk.width),
                                 part.compression);
        try {
            library.unpack(packed.get(), chunk.packed_size, chunk.height, pixels_.get());
        } catch (const FileError&) {  // its message names the file in memory
            throw_damaged();
        }
    }

    /// By OpenEXR's core.
    void decompress(exr_const_context_t file, int part_number, const ExrPart& part,
                    const exr_chunk_info_t& chunk, std::size_t bytes) {
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wmissing-field-initializers"
        exr_decode_pipeline_t decoder = EXR_DECODE_PIPELINE_INITIALIZER;
#pragma GCC diagnostic pop
        struct Destroyer {
            exr_const_context_t file;
            exr_decode_pipeline_t* decoder;
            ~Destroyer() { exr_decoding_destroy(file, decoder); }
        };
        check_exr(exr_decoding_initialize(file, part_number, &chunk, &decoder));
        const Destroyer destroyer = {file, &decoder};
        pixels_ = make_bytes(bytes);
        std::uint8_t* to = pixels_.get();
        for (std::size_t c = 0; c < part.channels.size(); ++c) {
            exr_coding_channel_info_t& channel = decoder.channels[c];
            channel.decode_to_ptr = to;
            channel.user_pixel_stride = static_cast<std::uint8_t>(channel.bytes_per_element);
            channel.user_line_stride = static_cast<std::int32_t>(row_bytes_);
            to += static_cast<std::size_t>(chunk.width) * part.channels[c].bytes();
        }
        check_exr(exr_decoding_choose_default_routines(file, part_number, &decoder));
        const exr_result_t result = exr_decoding_run(file, part_number, &decoder);
        // The library's messages are about its own steps.
        if (result != EXR_ERR_SUCCESS && result != EXR_ERR_OUT_OF_MEMORY &&
            result != EXR_ERR_READ_IO)
            throw_damaged();
        check_exr(result);
    }

    const RowKernels* kernels_;
    std::size_t row_bytes_;
    Bytes pixels_;
    const std::uint8_t* first_bytes_ = nullptr;  // of pairs, where they are not joined yet
    const std::uint8_t* second_bytes_ = nullptr;
    Bytes row_;
};

/// Makes pixels of the planes of a row.
class Interleaver {
  public:
    explicit Interleaver(const ExrPart& part)
        : part_(&part), kernels_(&row_kernels().front()), planes_(part.channels.size()) {}

    void run(const std::uint8_t* row, std::size_t width, std::uint8_t* pixels) {
        for (const ExrChannel& channel : part_->channels) {
            planes_[channel.index] = row;
            row += width * channel.bytes();
        }
        if (!part_->spec.channelformats.empty()) {
            convert(width, pixels);
        } else if (part_->channels.front().bytes() == 2) {
            kernels_->interleave_16(planes_.data(), planes_.size(), width, pixels);
        } else {
            kernels_->interleave_32(planes_.data(), planes_.size(), width, pixels);
        }
    }

  private:
    void convert(std::size_t width, std::uint8_t* pixels) const {
        const std::size_t pixel_bytes = planes_.size() * sizeof(float);
        for (const ExrChannel& channel : part_->channels) {
            const std::uint8_t* from = planes_[channel.index];
            std::uint8_t* to = pixels + channel.index * sizeof(float);
            for (std::size_t x = 0; x < width; ++x, from += channel.bytes(), to += pixel_bytes) {
                const float value = float_of(from, channel.type);
                std::memcpy(to, &value, sizeof value);
            }
        }
    }
    static float float_of(const std::uint8_t* from, exr_pixel_type_t type) {
        if (type == EXR_PIXEL_HALF) {
            std::uint16_t half = 0;
            std::memcpy(&half, from, sizeof half);
            return half_value(half);
        }
        std::uint32_t bits = 0;
        std::memcpy(&bits, from, sizeof bits);
        return type == EXR_PIXEL_FLOAT ? std::bit_cast<float>(bits)
                                       : static_cast<float>(bits) * 0x1p-32F;
    }

    const ExrPart* part_;
    const RowKernels* kernels_;
    std::vector<const std::uint8_t*> planes_;  // in the order of the spec
};

class ExrReader final : public RowReader {
  public:
    ExrReader(ExrFile file, std::vector<ExrPart> parts, unsigned threads)
        : file_(std::move(file)), parts_(std::move(parts)), threads_(threads) {}

    void use_threads(unsigned count) override { threads_ = count; }
    [[nodiscard]] bool has_picture(int number) override {
        return number >= 0 && static_cast<std::size_t>(number) < parts_.size();
    }
    [[nodiscard]] const PictureSpec& spec(int picture) override {
        return parts_[static_cast<std::size_t>(picture)].spec;
    }

    void read_rows(int picture, int ybegin, int yend, std::byte* to) override {
        const ExrPart& part = parts_[static_cast<std::size_t>(picture)];
        const PictureSpec& spec = part.spec;
        const int first = (ybegin - spec.y) / part.rows_of_block;
        const int last = (yend - 1 - spec.y) / part.rows_of_block;
        const int columns =
            part.is_tiled ? static_cast<int>((std::int64_t{spec.width} + spec.tile_width - 1) /
                                             spec.tile_width)
                          : 1;
        const auto count =
            static_cast<std::size_t>(last - first + 1) * static_cast<std::size_t>(columns);
        in_parallel(count, threads_, [&](std::size_t i) {
            const int column = static_cast<int>(i % static_cast<std::size_t>(columns));
            const int row = first + static_cast<int>(i / static_cast<std::size_t>(columns));
            read_block(picture, part, column, row, ybegin, yend, to);
        });
    }

  private:
    /// Reads those rows of a block that lie within the interval.
    void read_block(int picture, const ExrPart& part, int column, int row, int ybegin, int yend,
                    std::byte* to) const {
        const PictureSpec& spec = part.spec;
        const int y = spec.y + row * part.rows_of_block;
        exr_chunk_info_t chunk = {};
        check_exr(part.is_tiled
                      ? exr_read_tile_chunk_info(file_.get(), picture, column, row, 0, 0, &chunk)
                      : exr_read_scanline_chunk_info(file_.get(), picture, y, &chunk));
        const std::int64_t left = std::int64_t{column} * spec.tile_width;
        // The size of a tile by the library is compared with the place that is left for it.
        if (chunk.height != std::min(part.rows_of_block, spec.y + spec.height - y) ||
            chunk.width != (part.is_tiled
                                ? std::min<std::int64_t>(spec.tile_width, spec.width - left)
                                : spec.width))
            throw_damaged();
        Block block(file_.get(), picture, part, chunk);
        Interleaver interleaver(part);
        auto* const pixels = reinterpret_cast<std::uint8_t*>(to);
        const int end = std::min(y + chunk.height, yend);
        for (int at = std::max(y, ybegin); at < end; ++at) {
            interleaver.run(block.row(at - y), static_cast<std::size_t>(chunk.width),
                            pixels + static_cast<std::size_t>(at - ybegin) * spec.scanline_bytes() +
                                static_cast<std::size_t>(left) * spec.pixel_bytes());
        }
    }

    ExrFile file_;
    std::vector<ExrPart> parts_;
    unsigned threads_;
};

/// Blocks of tiles are no file of their own for OpenEXR's library.
bool is_read(const ExrPart& part) {
    return !part.is_luminance_chroma && !(part.is_tiled && ExrLibrary::knows(part.compression));
}

/// The file has its table of blocks, which a writer adds at its end.
bool is_finished(exr_const_context_t file, int number, const ExrPart& part) {
    exr_chunk_info_t chunk = {};
    return (part.is_tiled ? exr_read_tile_chunk_info(file, number, 0, 0, 0, 0, &chunk)
                          : exr_read_scanline_chunk_info(file, number, part.spec.y, &chunk)) ==
           EXR_ERR_SUCCESS;
}

}  // namespace

std::unique_ptr<RowReader> open_exr(const std::string& path, unsigned threads) {
    if constexpr (std::endian::native != std::endian::little) return nullptr;
    exr_context_initializer_t options = exr_options();
    // OpenImageIO reads files without their table of blocks, and knows what their headers lack.
    options.flags = EXR_CONTEXT_FLAG_STRICT_HEADER | EXR_CONTEXT_FLAG_DISABLE_CHUNK_RECONSTRUCTION;
    exr_context_t opened = nullptr;
    if (exr_start_read(&opened, path.c_str(), &options) != EXR_ERR_SUCCESS) return nullptr;
    ExrFile file(opened);
    int count = 0;
    if (exr_get_count(file.get(), &count) != EXR_ERR_SUCCESS) return nullptr;
    std::vector<ExrPart> parts;
    for (int i = 0; i < count; ++i) {
        std::optional<ExrPart> part = read_header(file.get(), i, count);
        if (!part || !is_read(*part) || !is_finished(file.get(), i, *part)) return nullptr;
        parts.push_back(*std::move(part));
    }
    return std::make_unique<ExrReader>(std::move(file), std::move(parts), threads);
}

std::optional<PictureSpec> luminance_chroma_spec(const std::string& path) {
    exr_context_initializer_t options = exr_options();
    options.flags = EXR_CONTEXT_FLAG_STRICT_HEADER;
    exr_context_t opened = nullptr;
    if (exr_start_read(&opened, path.c_str(), &options) != EXR_ERR_SUCCESS) return {};
    const ExrFile file(opened);
    int count = 0;
    if (exr_get_count(file.get(), &count) != EXR_ERR_SUCCESS || count != 1) return {};
    std::optional<ExrPart> part = read_header(file.get(), 0, count);
    if (!part || !part->is_luminance_chroma) return {};
    return std::move(part->spec);
}

TONEWRIGHT_NAMESPACE_END
