// SPDX-License-Identifier: Apache-2.0
#include "image/row_output.h"

#include <cstddef>
#include <cstring>
#include <string>
#include <utility>
#include <vector>

#include "image/report_thrown.h"
#include "image/spec_conversion.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

class RowOutput final : public OIIO::ImageOutput {
  public:
    RowOutput(std::unique_ptr<RowWriter> rows, const char* format)
        : rows_(std::move(rows)), format_(format) {
        m_spec = image_spec(rows_->spec());
    }

    [[nodiscard]] const char* format_name() const override { return format_; }
    bool open(const std::string& /*name*/, const OIIO::ImageSpec& /*spec*/,
              OpenMode /*mode*/) override {
        return false;
    }
    bool close() override {
        return guarded([&] { rows_->finish(); });
    }
    bool write_scanline(int y, int z, OIIO::TypeDesc type, const void* data,
                        OIIO::stride_t xstride) override {
        return write_scanlines(y, y + 1, z, type, data, xstride, OIIO::AutoStride);
    }
    bool write_scanlines(int ybegin, int yend, int /*z*/, OIIO::TypeDesc type, const void* data,
                         OIIO::stride_t xstride, OIIO::stride_t ystride) override {
        if (type == OIIO::TypeUnknown) type = m_spec.format;
        const auto pixel = static_cast<OIIO::stride_t>(type.size()) *
                           static_cast<OIIO::stride_t>(m_spec.nchannels);
        OIIO::ImageSpec::auto_stride(xstride, type, m_spec.nchannels);
        const OIIO::stride_t packed = pixel * m_spec.width;
        if (ystride == OIIO::AutoStride) ystride = xstride * m_spec.width;
        const auto* from = static_cast<const std::byte*>(data);
        const int count = yend - ybegin;
        if (xstride == pixel && (ystride == packed || count == 1))
            return guarded([&] { rows_->write_rows(count, type, from); });
        return guarded([&] {
            std::vector<std::byte> rows(static_cast<std::size_t>(packed * count));
            for (int y = 0; y < count; ++y) {
                for (int x = 0; x < m_spec.width; ++x) {
                    std::memcpy(&rows[static_cast<std::size_t>(packed * y + pixel * x)],
                                from + ystride * y + xstride * x, static_cast<std::size_t>(pixel));
                }
            }
            rows_->write_rows(count, type, rows.data());
        });
    }

  private:
    template <class Step>
    bool guarded(const Step& step) {
        try {
            step();
            return true;
        } catch (...) {
            return report_thrown(*this, "", true);
        }
    }

    std::unique_ptr<RowWriter> rows_;
    const char* format_;
};

}  // namespace

std::unique_ptr<OIIO::ImageOutput> row_output(std::unique_ptr<RowWriter> rows, const char* format) {
    return std::make_unique<RowOutput>(std::move(rows), format);
}

TONEWRIGHT_NAMESPACE_END
