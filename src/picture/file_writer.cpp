// SPDX-License-Identifier: Apache-2.0
#include "picture/file_writer.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <optional>
#include <utility>

#include "base/atomic_file.h"
#include "base/strings.h"
#include "base/system_files.h"
#include "picture/color_tags.h"
#include "picture/compression.h"
#include "picture/exr_reader.h"
#include "picture/exr_writer.h"
#include "picture/format_limits.h"
#include "picture/jpeg_writer.h"
#include "picture/light_levels.h"
#include "picture/pixel_access.h"
#include "picture/png_chunks.h"
#include "picture/png_writer.h"
#include "picture/read_back.h"
#include "picture/source_date.h"
#include "tonewright/view.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

namespace fs = std::filesystem;

/// Closes the file of its writer.
class OwnFile final : public RowWriter {
  public:
    OwnFile(int file, std::unique_ptr<RowWriter> rows) : file_(file), rows_(std::move(rows)) {}

    [[nodiscard]] const PictureSpec& spec() const override { return rows_->spec(); }
    void write_rows(int row_count, OIIO::TypeDesc type, const std::byte* rows) override {
        rows_->write_rows(row_count, type, rows);
        file_.begin_sync();
    }
    void finish() override {
        rows_->finish();
        if (const int error = file_.close()) throw FileError(problem_of_system(error));
    }

  private:
    OpenFile file_;
    std::unique_ptr<RowWriter> rows_;
};

/// OpenImageIO's extensions of the formats that this program writes.
std::string own_format(const std::string& path) {
    const std::string extension = extension_of(path);
    constexpr std::array<std::pair<std::string_view, std::string_view>, 10> kFormats = {{
        {".exr", "openexr"},
        {".sxr", "openexr"},
        {".mxr", "openexr"},
        {".png", "png"},
        {".jpg", "jpeg"},
        {".jpe", "jpeg"},
        {".jpeg", "jpeg"},
        {".jif", "jpeg"},
        {".jfif", "jpeg"},
        {".jfi", "jpeg"},
    }};
    for (const auto& [ending, format] : kFormats) {
        if (extension == ending) return std::string(format);
    }
    throw FileError("only OpenImageIO writes this format");
}

std::unique_ptr<RowWriter> create_own(const std::string& format, const PictureSpec& spec,
                                      const NewFile& to) {
    const int file = to.file.descriptor();
    std::unique_ptr<RowWriter> rows;
    if (format == "openexr") rows = create_exr(file, spec, to.threads);
    if (format == "png") rows = create_png(file, spec, to.threads, to.chunks);
    if (format == "jpeg") rows = create_jpeg(file, spec, to.threads);
    if (!rows) return nullptr;
    return std::make_unique<OwnFile>(to.file.release(), std::move(rows));
}

std::string fault_of_exr(const std::string& path, const PictureSpec& spec) {
    const std::unique_ptr<RowReader> reader = open_exr(path, 1);
    if (!reader) return "what was written cannot be read back: it is no complete OpenEXR file";
    const PictureSpec& is = reader->spec(0);
    const auto window_text = [](const PixelWindow& of) {
        return fmt::format("{} x {} at {}, {}", of.width(), of.height(), of.xbegin, of.ybegin);
    };
    if (data_window(is) != data_window(spec))
        return reads_back_with("window", window_text(data_window(is)),
                               window_text(data_window(spec)));
    if (display_window(is) != display_window(spec)) {
        return reads_back_with("display window", window_text(display_window(is)),
                               window_text(display_window(spec)));
    }
    if (std::string fault = fault_of_shape(is.width, is.height, is.nchannels, spec); !fault.empty())
        return fault;
    if (is.format != spec.format)
        return reads_back_with("type", name_of(is.format), name_of(spec.format));
    return "";
}

std::string fault_of_own(const WrittenFile& written) {
    if (written.format == "png") return fault_of_png(written.path, written.spec);
    if (written.format == "jpeg") return fault_of_jpeg(written.path, written.spec);
    return fault_of_exr(written.path, written.spec);
}

/// Counts colors that are infinite as half floats, in floats or halves.
template <class Bits>
double count_beyond_half(const std::byte* pixels, std::size_t count, std::size_t channels) {
    // Larger floats round to infinity: IEEE 754, binary16.
    constexpr float kEnd = 65520;
    constexpr unsigned kInfiniteHalf = 0x7C00;
    const std::size_t colors = std::min<std::size_t>(channels, 3);
    std::size_t beyond = 0;
    for (std::size_t i = 0; i < count; ++i, pixels += channels * sizeof(Bits)) {
        bool is_beyond = false;
        for (std::size_t c = 0; c < colors; ++c) {
            Bits value = 0;
            std::memcpy(&value, pixels + c * sizeof(Bits), sizeof(Bits));
            if constexpr (std::is_same_v<Bits, float>) {
                is_beyond |= std::abs(value) >= kEnd;
            } else {
                is_beyond |= (value & 0x7FFFU) == kInfiniteHalf;
            }
        }
        beyond += is_beyond ? 1 : 0;
    }
    return static_cast<double>(beyond);
}

}  // namespace

const FormatWriters& own_writers() {
    static const FormatWriters writers = {own_format, create_own, fault_of_own};
    return writers;
}

template <class Step>
decltype(auto) FileWriter::naming_file(const Step& step) const {
    try {
        return step();
    } catch (const FileError& e) {
        fail(e.problem());
    }
}

FileWriter::FileWriter(const std::string& path, WriteOptions options, unsigned threads,
                       const FormatWriters& writers)
    : path_(path),
      options_(std::move(options)),
      threads_(threads),
      writers_(writers),
      fitter_({}, {}, {}) {
    temporary_ = std::make_unique<AtomicFile>(path);
    if (!temporary_->refusal().empty()) fail(temporary_->refusal());
    const std::string target = temporary_->target().string();
    format_ = naming_file([&] { return writers.format_of(target); });
    codec_ = format_ == "heif" && extension_of(target) == ".avif" ? "avif" : format_;
    fitter_ = RowFitter(format_, codec_, options_);
    check_compression(path_, codec_,
                      {options_.compression, options_.quality, options_.subsampling});
    if (options_.bits > 0 && !format_limits(format_).has_bits) {
        throw Error(
            fmt::format("{}: type is uint{}; expected uint8, uint16, half or float, because "
                        "only DPX has 10 and 12 bits",
                        path_, options_.bits));
    }
}

FileWriter::~FileWriter() = default;

void FileWriter::fail(const std::string& reason) const {
    fail(Problem{.kind = Problem::Kind::file, .value = reason});
}

void FileWriter::fail(const Problem& why) const {
    throw FileError(within(path_ + ": cannot write", why));
}

void FileWriter::warn(const std::string& text) const {
    if (options_.warn && !text.empty()) options_.warn(text);
}

PictureSpec FileWriter::planned(const PictureSpec& picture) {
    return naming_file([&] { return fitter_.open(picture); });
}

void FileWriter::open(const PictureSpec& picture) {
    if (const int error = temporary_->check_target()) fail(problem_of_system(error));
    PictureSpec spec = planned(picture);
    // These writers record the time of writing.
    if (format_ == "openexr" || format_ == "tiff" || format_ == "dpx") {
        if (const std::string date = source_date();
            !date.empty() && !spec.find_attribute("DateTime"))
            spec.attribute("DateTime", date);
    }
    const ColorDescription color = describe_color(spec, format_);
    if (!color.icc.empty()) {
        const OIIO::TypeDesc bytes(OIIO::TypeDesc::UINT8, static_cast<int>(color.icc.size()));
        spec.attribute("ICCProfile", bytes, color.icc.data());
    }
    std::string chunks;
    if (!color.chunk.empty()) {
        // The levels are known at the end: until then, a chunk without light has their place.
        chunks = color.chunk + clli_chunk({});
        light_levels_place_ = kAfterPngHeader + color.chunk.size();
        light_levels_ = std::make_unique<LightLevelMeter>(find_display(tagged_color(spec)->name));
    }
    // Opens this file, and not a link that another program put there.
    OpenFile file(temporary_->create());
    if (file.descriptor() < 0) fail(problem_of_system(errno));
    const NewFile to = {.path = temporary_->path().string(),
                        .target = fs::path(path_).filename().string(),
                        .file = file,
                        .chunks = chunks,
                        .threads = threads_};
    out_ = naming_file([&] { return writers_.create(format_, spec, to); });
    if (!out_) fail("only OpenImageIO writes this picture");
    warn_of_limits(spec, color.missing);
    warn(fitter_.cut_off());
}

void FileWriter::warn_of_limits(const PictureSpec& requested, const std::string& missing) const {
    std::vector<std::string> limits;
    if (!missing.empty()) limits.push_back(missing);
    const OIIO::TypeDesc type = out_->spec().format;
    if (options_.type != OIIO::TypeDesc::UNKNOWN && options_.type != type && format_ != "null") {
        limits.push_back(fmt::format("pixels are {}, not {}", title_of_type(type),
                                     title_of_type(options_.type)));
    }
    const std::optional<TaggedColor> color = tagged_color(requested);
    if (color && color->code_points && type == OIIO::TypeDesc::UINT8)
        limits.emplace_back("gradients in 8 bits show bands");
    warn(fmt::format("{}", fmt::join(limits, "; ")));
}

OIIO::TypeDesc FileWriter::row_type() const { return fitter_.row_type(out_->spec().format); }

bool FileWriter::keeps_orientation() const { return format_ == "jpeg" || format_ == "tiff"; }

bool FileWriter::is_bottom_up() const {
    return format_ == "openexr" &&
           out_->spec().get_string_attribute("openexr:lineOrder") == "decreasingY";
}

void FileWriter::write_rows(const RowFitter::Rows& rows) {
    naming_file(
        [&] { fitter_.run(rows, [&](const RowFitter::Rows& fitted) { write_fitted(fitted); }); });
}

void FileWriter::watch_range(const RowFitter::Rows& rows, std::size_t count) {
    const auto channels = static_cast<std::size_t>(out_->spec().nchannels);
    if (out_->spec().format != OIIO::TypeDesc::HALF) return;
    if (rows.type == OIIO::TypeDesc::HALF)
        beyond_half_count_ += count_beyond_half<std::uint16_t>(rows.pixels, count, channels);
    if (rows.type == OIIO::TypeDesc::FLOAT)
        beyond_half_count_ += count_beyond_half<float>(rows.pixels, count, channels);
}

void FileWriter::warn_of_range() const {
    if (beyond_half_count_ == 0) return;
    const PictureSpec& file = out_->spec();
    const double pixels = static_cast<double>(file.width) * file.height * std::max(file.depth, 1);
    warn(
        fmt::format("{} % of the pixels are infinite, because half ends at 65504; "
                    "<<pixel_type=float>> keeps them",
                    percent_text(beyond_half_count_ / pixels)));
}

void FileWriter::write_fitted(const RowFitter::Rows& rows) {
    const PictureSpec& file = out_->spec();
    const auto width = static_cast<std::size_t>(file.width);
    const auto channels = static_cast<std::size_t>(file.nchannels);
    const std::size_t count = width * static_cast<std::size_t>(rows.yend - rows.ybegin) *
                              static_cast<std::size_t>(std::max(file.depth, 1));
    watch_range(rows, count);
    const PixelAccess& access = *pixel_access(rows.type);
    if (options_.verifies) {
        kept_.resize(width * static_cast<std::size_t>(file.height) *
                     static_cast<std::size_t>(std::max(file.depth, 1)) * channels);
        access.run_to_float(
            rows.pixels, &kept_[static_cast<std::size_t>(rows.ybegin - file.y) * width * channels],
            count * channels);
    }
    if (light_levels_) {
        std::vector<float> line(width * channels);
        for (std::size_t i = 0; i < count; i += width) {
            access.run_to_float(rows.pixels + i * channels * size_of(rows.type), line.data(),
                                width * channels);
            light_levels_->add(line.data(), width, channels, file.format,
                               file.alpha_channel < file.nchannels ? file.alpha_channel : -1);
        }
    }
    const int row_count = rows.yend - rows.ybegin;
    const bool is_taken = rows.type == OIIO::TypeDesc::HALF || rows.type == OIIO::TypeDesc::FLOAT ||
                          rows.type == file.format;
    if (is_taken) {
        out_->write_rows(row_count, rows.type, rows.pixels);
    } else {
        std::vector<float> floats(count * channels);
        access.run_to_float(rows.pixels, floats.data(), floats.size());
        out_->write_rows(row_count, OIIO::TypeDesc::FLOAT,
                         reinterpret_cast<const std::byte*>(floats.data()));
    }
    rows_written_ += row_count;
    if (options_.progress) {
        options_.progress(static_cast<std::size_t>(rows_written_),
                          static_cast<std::size_t>(file.height));
    }
}

void FileWriter::patch_light_levels() const {
    const int opened = ::open(temporary_->path().c_str(), O_WRONLY | O_NOFOLLOW | O_CLOEXEC);
    if (opened < 0) fail(problem_of_system(errno));
    OpenFile file(opened);
    const std::string levels = clli_chunk(light_levels_->levels());
    if (const int error = file.patch(light_levels_place_, levels)) fail(problem_of_system(error));
    if (const int error = file.close()) fail(problem_of_system(error));
}

void FileWriter::finish() {
    warn(fitter_.lost_cover());
    warn_of_range();
    const PictureSpec requested = out_->spec();
    const bool is_opened_by_name = out_->is_opened_by_name();
    naming_file([&] { out_->finish(); });
    out_.reset();  // some write their last bytes only now
    if (light_levels_) patch_light_levels();
    const std::string fault = writers_.fault_of({.path = temporary_->path().string(),
                                                 .spec = requested,
                                                 .format = format_,
                                                 .codec = codec_,
                                                 .is_opened_by_name = is_opened_by_name,
                                                 .bits = options_.bits,
                                                 .pixels = options_.verifies ? &kept_ : nullptr});
    if (!fault.empty()) fail(fault);
    if (const int error = temporary_->keep()) fail(problem_of_system(error));
}

TONEWRIGHT_NAMESPACE_END
