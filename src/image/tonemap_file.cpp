// SPDX-License-Identifier: Apache-2.0
//
// Tone mapping from file to file, in batches of rows. One thread reads the next batch, one tone
// maps, and one writes the previous batch. The number of batches is small, so memory does not grow
// with the picture.
#include <OpenImageIO/imagebuf.h>
#include <OpenImageIO/imageio.h>
#include <fmt/format.h>
#include <sys/stat.h>

#include <algorithm>
#include <array>
#include <exception>
#include <map>
#include <mutex>
#include <optional>
#include <string_view>
#include <thread>
#include <utility>
#include <vector>

#include "base/atomic_file.h"
#include "base/format_number.h"
#include "base/strings.h"
#include "image/batch_queue.h"
#include "image/converted_picture.h"
#include "image/picture_file.h"
#include "image/scene_meter.h"
#include "image/spec_conversion.h"
#include "image/tonemap_file.h"
#include "picture/picture_description.h"
#include "picture/source_date.h"
#include "picture/source_pixels.h"
#include "tonewright/engine.h"
#include "tonewright/image_io.h"
#include "tonewright/registry.h"
#include "tonewright/tonemap.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

using OIIO::ImageBuf;
using OIIO::ImageSpec;

/// Provenance of the result, without date and machine: the same run writes the same bytes.
/// @param resize  @see ReadOptions::resize
void add_provenance(ImageSpec& picture, const TonemapOptions& options, const std::string& resize) {
    const std::string op = operator_text(options.op);
    const std::string exposure = shortest(options.exposure_stops);
    std::string display = options.display;
    if (options.reference_white != kUnitLuminance)
        display += fmt::format(", reference white {}", shortest(options.reference_white));
    if (options.input_units == InputUnits::luminance) display += ", input in cd/m2";
    const std::string mix = options.mix == 1 ? "" : ", mix " + shortest(options.mix);
    const std::string size = resize.empty() ? "" : ", resize " + resize;
    picture.attribute("Software",
                      fmt::format("Tonewright {}: {}, exposure {}{}{}, display {}",
                                  TONEWRIGHT_VERSION, op, exposure, mix, size, display));
    picture.attribute("tonewright:operator", op);
    picture.attribute("tonewright:exposure", exposure);
    // The source may be a picture that another run resized.
    erase_attribute(picture, "tonewright:resize");
    if (!resize.empty()) picture.attribute("tonewright:resize", resize);
    // For native output, the name of its color may be there, and says more.
    if (options.display != kNativeOutput || !picture.find_attribute("tonewright:display"))
        picture.attribute("tonewright:display", display);
}

/// A picture without a date gets that of SOURCE_DATE_EPOCH, or its file's: writers of EXR, TIFF and
/// DPX would record the current time, and a second run would give other bytes.
void give_date(ImageSpec& picture, const std::string& path) {
    if (picture.find_attribute("DateTime")) return;
    std::string date = source_date();
    struct stat file {};
    if (date.empty() && ::stat(path.c_str(), &file) == 0) date = date_text(file.st_mtime);
    if (!date.empty()) picture.attribute("DateTime", date);
}

}  // namespace

int thread_count(int nthreads) {
    if (nthreads == 0) OIIO::getattribute("threads", nthreads);
    return nthreads > 0 ? nthreads
                        : static_cast<int>(std::max(std::thread::hardware_concurrency(), 1U));
}

ImageSpec result_spec(const Tonemapper& tonemapper, const ImageSpec& source) {
    return image_spec(rows_of(tonemapper).result_spec(picture_spec(source)));
}

namespace {

struct Batch {
    int ybegin = 0;
    int yend = 0;
    std::vector<std::byte> source;
    std::vector<std::byte> result;
};

/// One picture between two files.
class FilePass {
  public:
    FilePass(const Tonemapper& tonemapper, PictureReader& reader, PictureWriter& writer,
             const WriteOptions& options, const std::string& resize, int nthreads,
             std::size_t batch_bytes, const std::string& in)
        : tonemapper_(rows_of(tonemapper)),
          reader_(reader),
          writer_(writer),
          nthreads_(nthreads),
          source_(with_color_metadata_alone(picture_spec(reader.spec()))) {
        ImageSpec result = result_spec(tonemapper, reader.spec());
        give_date(result, in);
        if (options.write_provenance) add_provenance(result, tonemapper.options(), resize);
        writer.open(result);
        result_ = image_spec(with_color_metadata_alone(picture_spec(result)));
        result_.set_format(writer.row_type());
        step_ = rows_of_batch(source_.scanline_bytes() + result_.scanline_bytes(),
                              reader.row_step(), source_.height, batch_bytes);
    }

    void run_all() {
        if (nthreads_ == 1 || source_.height <= step_) {
            Batch batch;
            while (next(batch)) {
                read(batch);
                tonemap(batch);
                write(batch);
            }
        } else {
            run_in_threads();
        }
        writer_.finish();
    }

  private:
    /// @returns  false when there are no rows left.
    bool next(Batch& batch) {
        if (rows_done_ >= source_.height) return false;
        const int top = source_.y;
        const int bottom = source_.y + source_.height;
        // Batches begin at multiples of the step from the top, in both directions.
        const int count = (source_.height + step_ - 1) / step_;
        const int index = rows_done_ / step_;
        batch.ybegin = top + (writer_.is_bottom_up() ? count - 1 - index : index) * step_;
        batch.yend = std::min(batch.ybegin + step_, bottom);
        rows_done_ += step_;
        return true;
    }

    void read(Batch& batch) {
        batch.source.resize(source_.scanline_bytes() *
                            static_cast<std::size_t>(batch.yend - batch.ybegin));
        reader_.read_rows(batch.ybegin, batch.yend, batch.source.data());
    }
    void tonemap(Batch& batch) const {
        const int rows = batch.yend - batch.ybegin;
        batch.result.resize(result_.scanline_bytes() * static_cast<std::size_t>(rows));
        tonemapper_.run(source_, batch.source.data(), rows, result_.format, batch.result.data(),
                        static_cast<unsigned>(nthreads_));
    }
    void write(Batch& batch) {
        writer_.write_rows(
            ImageBuf(spec_of_rows(result_, batch.ybegin, batch.yend), batch.result.data()));
    }

    void run_in_threads() {
        std::array<Batch, 4> batches;  // one in each step, and one to hand over
        BatchQueue<Batch*> free, read_ones, done;
        for (Batch& batch : batches)
            free.push(&batch);
        std::mutex mutex;
        std::exception_ptr error;
        const auto guarded = [&](auto&& step) {
            try {
                step();
            } catch (...) {
                const std::lock_guard lock(mutex);
                if (!error) error = std::current_exception();
                for (BatchQueue<Batch*>* queue : {&free, &read_ones, &done})
                    queue->cancel();
            }
        };
        const auto read_batches = [&] {
            while (const std::optional<Batch*> batch = free.pop()) {
                if (!next(**batch)) break;
                read(**batch);
                read_ones.push(*batch);
            }
            read_ones.close();
        };
        const auto write_batches = [&] {
            while (const std::optional<Batch*> batch = done.pop()) {
                write(**batch);
                free.push(*batch);
            }
        };
        std::jthread reader, writer;
        guarded([&] {
            reader = std::jthread([&] { guarded(read_batches); });
            writer = std::jthread([&] { guarded(write_batches); });
            while (const std::optional<Batch*> batch = read_ones.pop()) {
                tonemap(**batch);
                done.push(*batch);
            }
            done.close();
        });
        for (std::jthread* thread : {&reader, &writer}) {
            if (thread->joinable()) thread->join();
        }
        if (error) std::rethrow_exception(error);
    }

    const RowTonemapper& tonemapper_;
    PictureReader& reader_;
    PictureWriter& writer_;
    int nthreads_;
    PictureSpec source_;
    ImageSpec result_;
    int step_ = 0;
    int rows_done_ = 0;
};

}  // namespace

namespace {

/// True for code values of an SDR display: white is 1. Logs of cameras and film reach far beyond.
bool is_for_display(const SourceColor& color) {
    if (color.is_absolute) return false;
    if (color.convert) return true;
    // The curves of cameras, and textures, which are a part of a scene.
    for (const std::string_view scene : {"_scene", "Rec709", "Texture"}) {
        if (color.name.ends_with(scene)) return false;
    }
    constexpr double kMostWhite = 2;  // code 1 of a narrow range is 1.2
    const Vector3 white = ReferenceEngine(color.decode)({1, 1, 1});
    return !color.decode.empty() && *std::max_element(white.begin(), white.end()) < kMostWhite;
}

bool expects_a_scene(const ResolvedOperator& op) {
    const std::string& file = op.op->file;
    const bool is_formula = op.op->source == "typed";
    const bool is_lut = !file.empty() && !is_formula && !file.ends_with(".tone");
    return !is_lut && op.op->id != "clamp" && op.op->id != "false_color";
}

}  // namespace

std::string finished_warning(const ImageSpec& spec, const TonemapOptions& options) {
    if (!is_same_name(options.input, kAutoInput) || options.mix == 0) return {};
    const ResolvedOperator& op = options.op;
    if (!expects_a_scene(op)) return {};
    const PictureDescription description = describe_picture(picture_spec(spec), options.input);
    if (!is_for_display(description.color)) return {};
    const std::string name = op.op->source == "typed" ? "the formula" : op.op->id;
    return fmt::format(
        "{}{} by {}), so {} tone maps it a second time; the operator clamp keeps the colors, "
        "<<input=lin_rec709>> takes the numbers as scene-linear",
        kFinishedPicture, description.color.name, description.rule, name);
}

void tonemap_in_batches(const Tonemapper& tonemapper, const std::string& in, const std::string& out,
                        const WriteOptions& write, const ReadOptions& read, int nthreads,
                        std::size_t batch_bytes) {
    nthreads = thread_count(nthreads);
    PictureWriter writer(out, write,
                         nthreads);  // reports a wrong name before it reads a large file
    PictureReader reader(in, nthreads, read);
    const OIIO::TypeDesc type = reader.spec().format;  // of the file: light is float
    check_pixel_type("source", type);
    (void)channel_layout(
        picture_spec(reader.spec()));  // reports wrong channels before it reads them
    writer.keep_type(type);
    report_header(reader.spec(), tonemapper.options().input, read);
    if (read.header) read.header(reader.spec());
    if (read.warn) {
        const std::string text = finished_warning(reader.spec(), tonemapper.options());
        if (!text.empty()) read.warn(text);
    }
    reader.convert_colors(tonemapper.options());
    const bool turns =
        orientation_of(picture_spec(reader.spec())) != 1 && !writer.keeps_orientation();
    if (reader.spec().depth > 1 || tonemapper.needs_whole_picture() || turns) {
        ImageBuf source = reader.read_all();
        if (turns) source = upright(std::move(source));
        ImageBuf result;
        tonemapper.run(result, source, {}, nthreads);
        give_date(result.specmod(), in);
        if (write.write_provenance)
            add_provenance(result.specmod(), tonemapper.options(), read.resize);
        write_result_atomically(result, out, write, type);
        return;
    }
    std::optional<Tonemapper> own;
    if (tonemapper.takes_statistics()) {
        MeterOptions options = meter_options(tonemapper.options());
        options.read = read;
        options.read.warn = options.read.note = nullptr;
        own = tonemapper.with_statistics(
            measure_file(in, options, SceneMeter::Figures::statistics, nthreads, batch_bytes)
                .statistics());
    }
    FilePass(own ? *own : tonemapper, reader, writer, write, read.resize, nthreads, batch_bytes, in)
        .run_all();
}

void check_overwriting(const std::vector<FrameFiles>& files, bool is_in_place) {
    using Identity = std::pair<dev_t, ino_t>;
    const auto identity_of = [](const std::string& path) -> std::optional<Identity> {
        struct stat file {};
        if (::stat(path.c_str(), &file) != 0) return {};
        return Identity(file.st_dev, file.st_ino);
    };
    std::map<Identity, const FrameFiles*> ins;
    for (const FrameFiles& file : files) {
        if (const auto identity = identity_of(file.in)) ins.emplace(*identity, &file);
    }
    for (const FrameFiles& file : files) {
        const auto identity = identity_of(file.out);
        const auto found = identity ? ins.find(*identity) : ins.end();
        if (found == ins.end()) continue;
        const bool is_own = found->second->out == file.out;
        if (is_own && is_in_place) continue;
        throw Error(
            Problem{.value = fmt::format("output is {}, the same file as the input {}", file.out,
                                         found->second->in),
                    .expected = is_own ? "another file, or <<in_place=yes>>" : "another file"});
    }
    std::vector<std::string> outs;
    outs.reserve(files.size());
    for (const FrameFiles& file : files)
        outs.push_back(file.out);
    require_separate_files(outs);
}

void tonemap_file(const Tonemapper& tonemapper, const std::string& in, const std::string& out,
                  const WriteOptions& write, const ReadOptions& read, int nthreads) {
    about_picture(
        in, [&] { tonemap_in_batches(tonemapper, in, out, write, read, nthreads, kBatchBytes); });
}

void tonemap_file(const Tonemapper& tonemapper, const std::string& in, const std::string& out,
                  const OIIO::TypeDesc& type, int nthreads) {
    WriteOptions write;
    write.type = type;
    tonemap_file(tonemapper, in, out, write, {}, nthreads);
}

TONEWRIGHT_NAMESPACE_END
