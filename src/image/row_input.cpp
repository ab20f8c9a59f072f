// SPDX-License-Identifier: Apache-2.0
#include "image/row_input.h"

#include <algorithm>
#include <cstring>
#include <string>
#include <utility>
#include <vector>

#include "image/report_thrown.h"
#include "image/spec_conversion.h"
#include "image/tonemap_file.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

class RowInput final : public OIIO::ImageInput {
  public:
    RowInput(std::unique_ptr<RowReader> rows, const char* format)
        : rows_(std::move(rows)), format_(format) {
        m_spec = image_spec(rows_->spec(0));
    }

    [[nodiscard]] const char* format_name() const override { return format_; }
    [[nodiscard]] int supports(OIIO::string_view feature) const override {
        return feature == "arbitrary_metadata" || feature == "multiimage" ? 1 : 0;
    }
    bool open(const std::string& /*name*/, OIIO::ImageSpec& /*spec*/) override { return false; }
    bool close() override { return true; }
    [[nodiscard]] int current_subimage() const override { return subimage_; }
    bool seek_subimage(int subimage, int miplevel) override {
        if (subimage < 0 || subimage >= rows_->picture_count() || miplevel != 0) return false;
        if (subimage != subimage_) m_spec = image_spec(rows_->spec(subimage));
        subimage_ = subimage;
        return true;
    }

    bool read_native_scanline(int subimage, int miplevel, int y, int z, void* data) override {
        return read_native_scanlines(subimage, miplevel, y, y + 1, z, data);
    }
    bool read_native_scanlines(int subimage, int miplevel, int ybegin, int yend, int /*z*/,
                               void* data) override {
        if (!seek_subimage(subimage, miplevel)) return false;
        try {
            rows_->use_threads(static_cast<unsigned>(thread_count(threads())));
            rows_->read_rows(subimage, ybegin, std::min(yend, m_spec.y + m_spec.height),
                             static_cast<std::byte*>(data));
            return true;
        } catch (...) {
            return report_thrown(*this, "", true);
        }
    }

    /// Rows of tiles are read together: read_native_tiles() of all columns.
    bool read_native_tile(int subimage, int miplevel, int x, int y, int z, void* data) override {
        const int xend = std::min(x + m_spec.tile_width, m_spec.x + m_spec.width);
        const int yend = std::min(y + m_spec.tile_height, m_spec.y + m_spec.height);
        const std::size_t pixel = m_spec.pixel_bytes();
        const std::size_t row = pixel * static_cast<std::size_t>(m_spec.width);
        std::vector<std::byte> rows(row * static_cast<std::size_t>(yend - y));
        if (!read_native_scanlines(subimage, miplevel, y, yend, z, rows.data())) return false;
        for (int i = 0; i < yend - y; ++i) {
            std::memcpy(static_cast<std::byte*>(data) +
                            pixel * static_cast<std::size_t>(m_spec.tile_width * i),
                        rows.data() + row * static_cast<std::size_t>(i) +
                            pixel * static_cast<std::size_t>(x - m_spec.x),
                        pixel * static_cast<std::size_t>(xend - x));
        }
        return true;
    }
    bool read_native_tiles(int subimage, int miplevel, int xbegin, int xend, int ybegin, int yend,
                           int zbegin, int zend, void* data) override {
        const bool is_whole = xbegin == m_spec.x && xend >= m_spec.x + m_spec.width;
        return is_whole ? read_native_scanlines(subimage, miplevel, ybegin, yend, zbegin, data)
                        : OIIO::ImageInput::read_native_tiles(subimage, miplevel, xbegin, xend,
                                                              ybegin, yend, zbegin, zend, data);
    }

  private:
    std::unique_ptr<RowReader> rows_;
    const char* format_;
    int subimage_ = 0;
};

}  // namespace

std::unique_ptr<OIIO::ImageInput> row_input(std::unique_ptr<RowReader> rows, const char* format) {
    return std::make_unique<RowInput>(std::move(rows), format);
}

TONEWRIGHT_NAMESPACE_END
