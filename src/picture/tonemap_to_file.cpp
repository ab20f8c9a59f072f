// SPDX-License-Identifier: Apache-2.0
#include "picture/tonemap_to_file.h"

#include <memory>
#include <utility>

#include "picture/file_reader.h"
#include "picture/picture_description.h"
#include "picture/result_metadata.h"
#include "picture/source_pixels.h"

TONEWRIGHT_NAMESPACE_BEGIN

void tonemap_to_file(const RowTonemapper& tonemapper, const PictureToFile& picture,
                     FileWriter& file) {
    RowPass pass;
    pass.source = with_color_metadata_alone(picture.source);
    PictureSpec result = tonemapper.result_spec(picture.source);
    give_date(result, picture.path);
    if (picture.writes_provenance) add_provenance(result, tonemapper.options(), picture.resize);
    file.open(result);
    pass.result = with_color_metadata_alone(result);
    pass.result.format = file.row_type();
    pass.is_bottom_up = file.is_bottom_up();
    pass.nthreads = picture.nthreads;
    pass.step = rows_of_batch(pass.source.scanline_bytes() + pass.result.scanline_bytes(),
                              picture.row_step, pass.source.height, picture.batch_bytes);
    pass.read = picture.read;
    pass.write = [&](int ybegin, int yend, const std::byte* from) {
        file.write_rows({ybegin, yend, pass.result.format, from});
    };
    pass.run(tonemapper);
    file.finish();
}

bool tonemap_own_file(const RowTonemapper& tonemapper, std::unique_ptr<RowReader> rows,
                      const std::string& in, const std::string& out, const WriteOptions& write,
                      const ReadOptions& read,
                      const std::function<void(const PictureSpec&)>& header, int nthreads) {
    if (!rows || tonemapper.takes_statistics() || tonemapper.needs_whole_picture() ||
        write.verifies || !read.resize.empty())
        return false;
    const auto threads = static_cast<unsigned>(nthreads);
    rows->use_threads(threads);
    FileWriter file(out, write, threads, own_writers());
    FileReader picture(in, "openexr", std::move(rows), read);
    const PictureSpec& source = picture.spec();
    check_pixel_type("source", source.format);
    (void)channel_layout(source);  // reports wrong channels before it reads them
    file.keep_type(source.format);
    const std::string& input = tonemapper.options().input;
    report_header(source, input, read);
    if (header) header(source);
    if (read.warn) {
        const std::string text = finished_warning(source, tonemapper.options());
        if (!text.empty()) read.warn(text);
    }
    const bool turns = orientation_of(source) != 1 && !file.keeps_orientation();
    if (source.depth > 1 || turns || source_color(source, input).convert) return false;
    tonemap_to_file(
        tonemapper,
        {.source = source,
         .read = [&](int ybegin, int yend, std::byte* to) { picture.read_rows(ybegin, yend, to); },
         .row_step = picture.row_step(),
         .path = in,
         .writes_provenance = write.write_provenance,
         .resize = read.resize,
         .nthreads = nthreads},
        file);
    return true;
}

TONEWRIGHT_NAMESPACE_END
