// SPDX-License-Identifier: Apache-2.0
#include "image/luminance_chroma.h"

#include <OpenEXR/ImfArray.h>
#include <OpenEXR/ImfRgbaFile.h>

#include <cstddef>
#include <optional>
#include <utility>
#include <vector>

#include "picture/exr_library.h"
#include "picture/exr_reader.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

class LuminanceChroma final : public RowReader {
  public:
    LuminanceChroma(const std::string& path, PictureSpec spec)
        : spec_(std::move(spec)),
          file_(by_openexr([&] { return Imf::RgbaInputFile(path.c_str()); })) {}

    void use_threads(unsigned /*count*/) override {}
    [[nodiscard]] bool has_picture(int number) override { return number == 0; }
    [[nodiscard]] const PictureSpec& spec(int /*picture*/) override { return spec_; }
    void read_rows(int /*picture*/, int ybegin, int yend, std::byte* to) override {
        const auto width = static_cast<std::size_t>(spec_.width);
        const auto channels = static_cast<std::size_t>(spec_.nchannels);
        std::vector<Imf::Rgba> row(width);
        auto* value = reinterpret_cast<half*>(to);
        for (int y = ybegin; y < yend; ++y) {
            by_openexr([&] {
                // The address of the pixel at 0, 0.
                file_.setFrameBuffer(row.data() - spec_.x, 1, 0);
                file_.readPixels(y);
            });
            for (const Imf::Rgba& pixel : row) {
                value[0] = pixel.r;
                value[1] = pixel.g;
                value[2] = pixel.b;
                if (channels > 3) value[3] = pixel.a;
                value += channels;
            }
        }
    }

  private:
    PictureSpec spec_;
    Imf::RgbaInputFile file_;
};

}  // namespace

std::unique_ptr<RowReader> open_luminance_chroma(const std::string& path) {
    std::optional<PictureSpec> spec = luminance_chroma_spec(path);
    if (!spec) return nullptr;
    return std::make_unique<LuminanceChroma>(path, *std::move(spec));
}

TONEWRIGHT_NAMESPACE_END
