// SPDX-License-Identifier: Apache-2.0
//
// Tone mapping from file to file, in batches of rows (RowPass).
#include <OpenImageIO/imagebuf.h>
#include <OpenImageIO/imageio.h>
#include <fmt/format.h>
#include <sys/stat.h>

#include <algorithm>
#include <map>
#include <optional>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "base/atomic_file.h"
#include "image/converted_picture.h"
#include "image/picture_file.h"
#include "image/scene_meter.h"
#include "image/spec_conversion.h"
#include "image/tonemap_file.h"
#include "picture/picture_description.h"
#include "picture/result_metadata.h"
#include "picture/row_pass.h"
#include "picture/row_tonemapper.h"
#include "picture/source_pixels.h"
#include "picture/tonemap_to_file.h"
#include "tonewright/image_io.h"
#include "tonewright/tonemap.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

using OIIO::ImageBuf;
using OIIO::ImageSpec;

}  // namespace

int thread_count(int nthreads) {
    if (nthreads == 0) OIIO::getattribute("threads", nthreads);
    return nthreads > 0 ? nthreads
                        : static_cast<int>(std::max(std::thread::hardware_concurrency(), 1U));
}

ImageSpec result_spec(const Tonemapper& tonemapper, const ImageSpec& source) {
    return image_spec(rows_of(tonemapper).result_spec(picture_spec(source)));
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
    report_header(picture_spec(reader.spec()), tonemapper.options().input, read);
    if (read.header) read.header(reader.spec());
    if (read.warn) {
        const std::string text =
            finished_warning(picture_spec(reader.spec()), tonemapper.options());
        if (!text.empty()) read.warn(text);
    }
    reader.convert_colors(tonemapper.options());
    const bool turns =
        orientation_of(picture_spec(reader.spec())) != 1 && !writer.rows().keeps_orientation();
    if (reader.spec().depth > 1 || tonemapper.needs_whole_picture() || turns) {
        ImageBuf source = reader.read_all();
        if (turns) source = upright(std::move(source));
        ImageBuf result;
        tonemapper.run(result, source, {}, nthreads);
        change_spec(result.specmod(), [&](PictureSpec& spec) {
            give_date(spec, in);
            if (write.write_provenance) add_provenance(spec, tonemapper.options(), read.resize);
        });
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
    const PictureSpec source = picture_spec(reader.spec());
    tonemap_to_file(
        rows_of(own ? *own : tonemapper),
        {.source = source,
         .read = [&](int ybegin, int yend, std::byte* to) { reader.read_rows(ybegin, yend, to); },
         .row_step = reader.row_step(),
         .path = in,
         .writes_provenance = write.write_provenance,
         .resize = read.resize,
         .nthreads = nthreads,
         .batch_bytes = batch_bytes},
        writer.rows());
    writer.forget_cached();
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
