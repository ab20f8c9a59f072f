// SPDX-License-Identifier: Apache-2.0
#include "picture/png_writer.h"

#include <libdeflate.h>
#include <png.h>
#include <zlib.h>

#include <algorithm>
#include <array>
#include <csetjmp>
#include <cstdint>
#include <cstdio>
#include <cstring>
#include <optional>
#include <thread>
#include <utility>
#include <vector>

#include "base/strings.h"
#include "base/system_files.h"
#include "lut/in_parallel.h"
#include "picture/file_bytes.h"
#include "picture/png_header.h"
#include "picture/png_kernels.h"
#include "picture/read_back.h"
#include "picture/row_codes.h"

#include <fmt/format.h>

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

using T = OIIO::TypeDesc;
using Bytes = std::vector<std::uint8_t>;

/// Bytes of a block, about: large enough for good statistics, small enough for all threads to have
/// some.
constexpr std::size_t kBlockBytes = std::size_t{1} << 19;
/// RFC 1951, 2: a match begins at most so many bytes before.
constexpr std::size_t kWindow = 32768;
constexpr std::size_t kAfterHeader = 33;  // 8 bytes of signature, 25 of IHDR
constexpr std::array<std::uint8_t, 12> kEnd = {0,   0,   0,    0,    'I',  'E',
                                               'N', 'D', 0xAE, 0x42, 0x60, 0x82};
constexpr int kDefaultLevel = 6;  // of zlib and of OpenImageIO

void put_big_endian(std::uint8_t* to, std::uint32_t value) {
    for (const unsigned shift : {24U, 16U, 8U, 0U})
        *to++ = static_cast<std::uint8_t>(value >> shift);
}

struct Compression {
    int strategy = Z_DEFAULT_STRATEGY;
    int level = kDefaultLevel;
};

/// Appends a part of a raw deflate stream (RFC 1951), which ends at a whole byte.
/// @param before   bytes before it, in which matches may begin
/// @param is_last  the stream ends there
void deflate_part(const std::uint8_t* from, std::size_t count, std::size_t before, bool is_last,
                  const Compression& with, Bytes& to) {
    z_stream stream{};
    constexpr int kRaw = -15;  // no header, the whole window
    constexpr int kMemory = MAX_MEM_LEVEL;
    if (deflateInit2(&stream, with.level, Z_DEFLATED, kRaw, kMemory, with.strategy) != Z_OK)
        throw std::bad_alloc();
    const bool has_matches = with.strategy == Z_DEFAULT_STRATEGY || with.strategy == Z_FILTERED;
    if (before > 0 && has_matches)
        deflateSetDictionary(&stream, from - before, static_cast<uInt>(before));
    const std::size_t at = to.size();
    constexpr std::size_t kFlush = 16;  // an empty stored block, and bits before it
    to.resize(at + deflateBound(&stream, static_cast<uLong>(count)) + kFlush);
    stream.next_in = const_cast<Bytef*>(from);
    stream.avail_in = static_cast<uInt>(count);
    std::size_t size = at;
    for (;;) {
        stream.next_out = to.data() + size;
        stream.avail_out = static_cast<uInt>(to.size() - size);
        deflate(&stream, is_last ? Z_FINISH : Z_SYNC_FLUSH);
        size = to.size() - stream.avail_out;
        if (stream.avail_out > 0) break;
        to.resize(to.size() + kBlockBytes / 8);
    }
    deflateEnd(&stream);
    to.resize(size);
}

/// Matches may be shorter than runs: a sample says so, or the block is a drawing, whose patterns
/// repeat.
bool may_suit_matches(const std::uint8_t* from, std::size_t count, std::size_t runs_bytes) {
    constexpr std::size_t kDrawing = 20;  // photographs of 8 bits shrink to a seventh
    if (runs_bytes < count / kDrawing) return true;
    constexpr std::size_t kSample = 16384;
    const std::size_t size = std::min(count, kSample);
    const std::uint8_t* const sample = from + (count - size) / 2;
    Bytes runs;
    Bytes matches;
    deflate_part(sample, size, 0, true, {.strategy = Z_RLE}, runs);
    deflate_part(sample, size, 0, true, {.level = 1}, matches);
    return matches.size() < runs.size();
}

/// Appends a part of a raw deflate stream as deflate_part() does. Runs suit photographs: in the
/// noise of their low bits, zlib takes matches of three bytes that cost more than the bytes.
void deflate_smallest(const std::uint8_t* from, std::size_t count, std::size_t before, bool is_last,
                      Bytes& to) {
    const std::size_t at = to.size();
    deflate_part(from, count, before, is_last, {.strategy = Z_RLE}, to);
    if (!may_suit_matches(from, count, to.size() - at)) return;
    Bytes matches(to.begin(), to.begin() + static_cast<std::ptrdiff_t>(at));
    deflate_part(from, count, before, is_last, {}, matches);
    if (matches.size() < to.size()) to = std::move(matches);
}

/// The compression that attributes ask for; nothing: none. OpenImageIO's names.
std::optional<Compression> requested_compression(const PictureSpec& spec) {
    struct Strategy {
        std::string_view name;
        int strategy;
    };
    constexpr std::array<Strategy, 5> kStrategies = {{{"default", Z_DEFAULT_STRATEGY},
                                                      {"filtered", Z_FILTERED},
                                                      {"huffman", Z_HUFFMAN_ONLY},
                                                      {"rle", Z_RLE},
                                                      {"fixed", Z_FIXED}}};
    const std::string name = spec.get_string_attribute("compression");
    const bool has_level = spec.find_attribute("png:compressionLevel") != nullptr;
    if (name.empty() && !has_level) return {};
    Compression compression;
    for (const Strategy& known : kStrategies) {
        if (is_same_name(known.name, name)) compression.strategy = known.strategy;
    }
    compression.level = std::clamp(spec.get_int_attribute("png:compressionLevel", kDefaultLevel),
                                   Z_NO_COMPRESSION, Z_BEST_COMPRESSION);
    return compression;
}

class PngWriter final : public RowWriter {
  public:
    PngWriter(int file, const PictureSpec& spec, unsigned threads)
        : file_(file),
          spec_(spec),
          threads_(threads),
          requested_(requested_compression(spec)),
          to_codes_(spec),
          row_bytes_(spec.scanline_bytes()),
          stride_(kPngLead + row_bytes_),
          block_rows_(std::max<std::size_t>(1, kBlockBytes / (row_bytes_ + 1))),
          blocks_(2 * std::size_t{threads > 0
                                      ? threads
                                      : std::max(1U, std::thread::hardware_concurrency())}) {
        const std::size_t rows =
            std::min(blocks_.size() * block_rows_, static_cast<std::size_t>(spec.height));
        codes_.resize((rows + 1) * stride_ + kPngSlack);
        filtered_.resize(kWindow + rows * (row_bytes_ + 1));
    }

    [[nodiscard]] const PictureSpec& spec() const override { return spec_; }
    void write_rows(int row_count, OIIO::TypeDesc type, const std::byte* rows) override;
    void finish() override;

  private:
    struct Block {
        Bytes chunk;
        std::uint32_t adler = 1;
        std::size_t bytes = 0;
    };

    [[nodiscard]] std::size_t batch_rows() const {
        return (codes_.size() - kPngSlack) / stride_ - 1;
    }
    /// A row of the batch; -1 is the one above it.
    std::uint8_t* codes_of(std::ptrdiff_t row) {
        return &codes_[static_cast<std::size_t>(row + 1) * stride_ + kPngLead];
    }
    void compress(std::size_t index);
    void write_batch();

    int file_;
    PictureSpec spec_;
    unsigned threads_;
    std::optional<Compression> requested_;
    RowCodes to_codes_;
    const PngKernels& with_ = png_kernels().front();
    std::size_t row_bytes_;
    std::size_t stride_;  // of codes_
    std::size_t block_rows_;
    Bytes codes_;     // the row above the batch, and its rows, each after zeros
    Bytes filtered_;  // the window before the batch, and its rows, each after its filter's number
    std::vector<Block> blocks_;
    std::size_t batch_size_ = 0;  // rows
    std::size_t done_ = 0;        // rows of the batches before
    std::uint32_t adler_ = 1;
};

void PngWriter::write_rows(int row_count, OIIO::TypeDesc type, const std::byte* rows) {
    auto rest = static_cast<std::size_t>(row_count);
    while (rest > 0) {
        const std::size_t count = std::min(rest, batch_rows() - batch_size_);
        to_codes_.convert(count, type, rows, codes_of(static_cast<std::ptrdiff_t>(batch_size_)),
                          stride_, threads_);
        batch_size_ += count;
        rows += count * to_codes_.row_bytes(type);
        rest -= count;
        if (batch_size_ == batch_rows()) write_batch();
    }
}

/// Makes the chunk IDAT of a block.
void PngWriter::compress(std::size_t index) {
    Block& block = blocks_[index];
    const std::size_t first = index * block_rows_;
    const std::size_t end = std::min(first + block_rows_, batch_size_);
    const std::size_t before = (done_ + first) * (row_bytes_ + 1);
    const std::uint8_t* const from = &filtered_[kWindow + first * (row_bytes_ + 1)];
    const bool is_last = done_ + end == static_cast<std::size_t>(spec_.height);
    block.bytes = (end - first) * (row_bytes_ + 1);
    block.adler = libdeflate_adler32(1, from, block.bytes);
    block.chunk.assign({0, 0, 0, 0, 'I', 'D', 'A', 'T'});
    // RFC 1950, 2.2: deflate with a window of 32 KiB, a fast level.
    if (before == 0) block.chunk.insert(block.chunk.end(), {0x78, 0x01});
    if (requested_) {
        deflate_part(from, block.bytes, std::min(before, kWindow), is_last, *requested_,
                     block.chunk);
    } else {
        deflate_smallest(from, block.bytes, std::min(before, kWindow), is_last, block.chunk);
    }
}

void PngWriter::write_batch() {
    const std::size_t count = (batch_size_ + block_rows_ - 1) / block_rows_;
    in_parallel(count, threads_, [&](std::size_t index) {
        const std::size_t end = std::min((index + 1) * block_rows_, batch_size_);
        for (std::size_t row = index * block_rows_; row < end; ++row) {
            const auto at = static_cast<std::ptrdiff_t>(row);
            with_.filter(codes_of(at), codes_of(at - 1), row_bytes_, spec_.pixel_bytes(),
                         &filtered_[kWindow + row * (row_bytes_ + 1)]);
        }
    });
    in_parallel(count, threads_, [&](std::size_t index) { compress(index); });
    done_ += batch_size_;
    const bool is_last = done_ == static_cast<std::size_t>(spec_.height);
    for (std::size_t index = 0; index < count; ++index) {
        Block& block = blocks_[index];
        adler_ = static_cast<std::uint32_t>(
            adler32_combine(adler_, block.adler, static_cast<z_off_t>(block.bytes)));
        Bytes& chunk = block.chunk;
        if (is_last && index + 1 == count) {
            chunk.resize(chunk.size() + 4);
            put_big_endian(&chunk[chunk.size() - 4], adler_);
        }
        put_big_endian(chunk.data(), static_cast<std::uint32_t>(chunk.size() - 8));
        const std::uint32_t crc = libdeflate_crc32(0, &chunk[4], chunk.size() - 4);
        chunk.resize(chunk.size() + 4);
        put_big_endian(&chunk[chunk.size() - 4], crc);
        write_all(file_, chunk.data(), chunk.size());
    }
    // The next batch begins with the last row and the last bytes of this one.
    std::memcpy(codes_of(-1), codes_of(static_cast<std::ptrdiff_t>(batch_size_) - 1), row_bytes_);
    std::memmove(filtered_.data(), &filtered_[batch_size_ * (row_bytes_ + 1)], kWindow);
    batch_size_ = 0;
}

void PngWriter::finish() {
    if (batch_size_ > 0) write_batch();
    if (done_ != static_cast<std::size_t>(spec_.height)) {
        throw FileError(fmt::format("{} rows were written; expected {}", done_, spec_.height));
    }
    write_all(file_, kEnd.data(), kEnd.size());
}

/// OpenImageIO's writer replaces types and names alpha by the number of channels.
PictureSpec file_spec(const PictureSpec& requested) {
    PictureSpec spec = requested;
    if (spec.format != T(T::UINT16)) spec.format = T(T::UINT8);
    spec.channelformats.clear();
    spec.alpha_channel = spec.nchannels % 2 == 0 ? spec.nchannels - 1 : -1;
    return spec;
}

bool is_written_here(const PictureSpec& spec) {
    const bool is_dithered =
        spec.format.basetype == T::UINT8 && spec.get_int_attribute("oiio:dither") != 0;
    const bool is_associated =
        spec.alpha_channel >= 0 && spec.get_int_attribute("oiio:UnassociatedAlpha") == 0;
    return spec.width >= 1 && spec.height >= 1 && spec.depth <= 1 && spec.tile_width == 0 &&
           spec.nchannels >= 1 && spec.nchannels <= 4 && !is_dithered && !is_associated &&
           spec.get_int_attribute("png:filter") == 0;
}

/// Facts that libpng finds.
struct FoundPng {
    png_uint_32 width = 0, height = 0;
    int depth = 0, channels = 0;
};

extern "C" {
[[noreturn]] void leave_png_file(png_structp png, png_const_charp /*message*/) {
    png_longjmp(png, 1);
}
void ignore_warning_of_png_file(png_structp /*png*/, png_const_charp /*message*/) {}
}

bool read_header(png_structp png, png_infop info, std::FILE* file, FoundPng& found) {
    if (setjmp(png_jmpbuf(png)) != 0) return false;  // NOLINT(cert-err52-cpp)
    png_init_io(png, file);
    png_read_info(png, info);
    found.width = png_get_image_width(png, info);
    found.height = png_get_image_height(png, info);
    found.depth = png_get_bit_depth(png, info);
    found.channels = png_get_channels(png, info);
    return true;
}

bool ends_as_png(std::FILE* file) {
    std::array<std::uint8_t, kEnd.size()> last{};
    return std::fseek(file, -static_cast<long>(last.size()), SEEK_END) == 0 &&
           std::fread(last.data(), 1, last.size(), file) == last.size() && last == kEnd;
}

}  // namespace

std::unique_ptr<RowWriter> create_png(int file, const PictureSpec& spec, unsigned threads,
                                      std::string_view chunks) {
    const PictureSpec written = file_spec(spec);
    if (!is_written_here(written)) return nullptr;
    std::optional<std::string> header = png_header(written);
    if (!header) return nullptr;
    header->insert(kAfterHeader, chunks);
    auto writer = std::make_unique<PngWriter>(file, written, threads);
    write_all(file, header->data(), header->size());
    return writer;
}

std::string fault_of_png(const std::string& path, const PictureSpec& spec) {
    const std::unique_ptr<std::FILE, int (*)(std::FILE*)> file(std::fopen(path.c_str(), "rb"),
                                                               std::fclose);
    if (!file) return "what was written cannot be read back: " + reason_of(errno);
    png_structp png = png_create_read_struct(PNG_LIBPNG_VER_STRING, nullptr, leave_png_file,
                                             ignore_warning_of_png_file);
    png_infop info = png ? png_create_info_struct(png) : nullptr;
    FoundPng found;
    const bool is_read = info && read_header(png, info, file.get(), found);
    png_destroy_read_struct(&png, &info, nullptr);
    if (!is_read || !ends_as_png(file.get()))
        return "what was written cannot be read back: it is no complete PNG file";
    if (std::string fault = fault_of_shape(static_cast<int>(found.width),
                                           static_cast<int>(found.height), found.channels, spec);
        !fault.empty())
        return fault;
    const int depth = static_cast<int>(8 * size_of(spec.format));
    if (found.depth != depth) return reads_back_with("bits", found.depth, depth);
    return "";
}

TONEWRIGHT_NAMESPACE_END
