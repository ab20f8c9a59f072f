// SPDX-License-Identifier: Apache-2.0
#include "picture/exr_library.h"

#include <OpenEXR/ImfChannelList.h>
#include <OpenEXR/ImfFrameBuffer.h>
#include <OpenEXR/ImfHeader.h>
#include <OpenEXR/ImfIO.h>
#include <OpenEXR/ImfInputFile.h>
#include <OpenEXR/ImfOutputFile.h>

#include <algorithm>
#include <cstring>
#include <stdexcept>
#include <utility>

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

using Bytes = std::vector<std::uint8_t>;

class MemoryOut final : public Imf::OStream {
  public:
    MemoryOut() : Imf::OStream("block") {}

    void write(const char* from, int count) override {
        const auto size = static_cast<std::size_t>(count);
        bytes.resize(std::max(bytes.size(), place_ + size));
        std::memcpy(bytes.data() + place_, from, size);
        place_ += size;
    }
    std::uint64_t tellp() override { return place_; }
    void seekp(std::uint64_t to) override { place_ = to; }

    Bytes bytes;

  private:
    std::size_t place_ = 0;
};

class MemoryIn final : public Imf::IStream {
  public:
    explicit MemoryIn(Bytes bytes) : Imf::IStream("block"), bytes_(std::move(bytes)) {}

    bool read(char* to, int count) override {
        const auto size = static_cast<std::size_t>(count);
        if (place_ > bytes_.size() || size > bytes_.size() - place_)
            throw std::runtime_error("early end of file");
        std::memcpy(to, bytes_.data() + place_, size);
        place_ += size;
        return place_ < bytes_.size();
    }
    std::uint64_t tellg() override { return place_; }
    void seekg(std::uint64_t to) override { place_ = to; }

  private:
    Bytes bytes_;
    std::size_t place_ = 0;
};

Imf::PixelType pixel_type(exr_pixel_type_t type) {
    return type == EXR_PIXEL_UINT ? Imf::UINT : type == EXR_PIXEL_HALF ? Imf::HALF : Imf::FLOAT;
}

Imf::Compression compression_by_library(exr_compression_t compression) {
    switch (compression) {
        case EXR_COMPRESSION_B44:
            return Imf::B44_COMPRESSION;
        case EXR_COMPRESSION_B44A:
            return Imf::B44A_COMPRESSION;
        case EXR_COMPRESSION_DWAA:
            return Imf::DWAA_COMPRESSION;
        default:
            return Imf::DWAB_COMPRESSION;
    }
}

Imf::Header header_of(const std::vector<ExrChannel>& channels, std::size_t width, int row_count,
                      exr_compression_t compression, float dwa_level) {
    Imf::Header header(static_cast<int>(width), row_count);
    header.compression() = compression_by_library(compression);
    header.dwaCompressionLevel() = dwa_level;
    for (const ExrChannel& channel : channels) {
        header.channels().insert(channel.name, Imf::Channel(pixel_type(channel.type), 1, 1,
                                                            channel.is_perceptually_linear));
    }
    return header;
}

Imf::FrameBuffer frame_buffer(const std::vector<ExrChannel>& channels, std::size_t width,
                              std::size_t row_bytes, std::uint8_t* planes) {
    Imf::FrameBuffer buffer;
    for (const ExrChannel& channel : channels) {
        buffer.insert(channel.name,
                      Imf::Slice(pixel_type(channel.type), reinterpret_cast<char*>(planes),
                                 channel.bytes(), row_bytes));
        planes += width * channel.bytes();
    }
    return buffer;
}

/// The bytes of a file before its only block: magic number, version, header, and the table, which
/// has a zero until the block is written.
Bytes file_without_block(const Imf::Header& header) {
    MemoryOut stream;
    { const Imf::OutputFile file(stream, header, 0); }
    return std::move(stream.bytes);
}

}  // namespace

ExrLibrary::ExrLibrary(std::vector<ExrChannel> channels, std::size_t width,
                       exr_compression_t compression, float dwa_level)
    : channels_(std::move(channels)),
      width_(width),
      compression_(compression),
      dwa_level_(dwa_level) {
    for (const ExrChannel& channel : channels_)
        row_bytes_ += width * channel.bytes();
}

bool ExrLibrary::knows(exr_compression_t compression) {
    return compression == EXR_COMPRESSION_DWAA || compression == EXR_COMPRESSION_DWAB ||
           compression == EXR_COMPRESSION_B44 || compression == EXR_COMPRESSION_B44A;
}

Bytes ExrLibrary::pack(Bytes planes) const {
    const int row_count = static_cast<int>(planes.size() / row_bytes_);
    const Imf::Header header = header_of(channels_, width_, row_count, compression_, dwa_level_);
    return by_openexr([&] {
        const std::size_t start = file_without_block(header).size() + 2 * sizeof(std::int32_t);
        MemoryOut stream;
        {
            Imf::OutputFile file(stream, header, 0);
            file.setFrameBuffer(frame_buffer(channels_, width_, row_bytes_, planes.data()));
            file.writePixels(row_count);
        }
        if (stream.bytes.size() <= start) throw std::runtime_error("a block was not written");
        return Bytes(stream.bytes.begin() + static_cast<std::ptrdiff_t>(start), stream.bytes.end());
    });
}

void ExrLibrary::unpack(const std::uint8_t* packed, std::size_t packed_bytes, int row_count,
                        std::uint8_t* planes) const {
    const Imf::Header header = header_of(channels_, width_, row_count, compression_, dwa_level_);
    by_openexr([&] {
        Bytes bytes = file_without_block(header);
        const std::uint64_t start = bytes.size();
        std::memcpy(&bytes[bytes.size() - sizeof start], &start, sizeof start);
        const std::int32_t leader[2] = {0, static_cast<std::int32_t>(packed_bytes)};
        bytes.resize(bytes.size() + sizeof leader);
        std::memcpy(&bytes[start], leader, sizeof leader);
        bytes.insert(bytes.end(), packed, packed + packed_bytes);
        MemoryIn stream(std::move(bytes));
        Imf::InputFile file(stream, 0);
        file.setFrameBuffer(frame_buffer(channels_, width_, row_bytes_, planes));
        file.readPixels(0, row_count - 1);
    });
}

TONEWRIGHT_NAMESPACE_END
