// SPDX-License-Identifier: Apache-2.0
#include "tasks/archive.h"
#include "tonewright/error.h"
#include "tonewright/generated_files.h"

#include <zip.h>

#include <memory>

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

struct Closer {
    void operator()(zip_source_t* source) const { zip_source_free(source); }
    void operator()(zip_t* archive) const { zip_discard(archive); }
};

}  // namespace

std::string make_archive(const std::vector<GeneratedFile>& files) {
    zip_error_t error;
    zip_error_init(&error);
    const auto fail = [&](const std::string& what) {
        throw Error("archive: " + what + ": " + zip_error_strerror(&error));
    };
    const std::unique_ptr<zip_source_t, Closer> memory(
        zip_source_buffer_create(nullptr, 0, 0, &error));
    if (!memory) fail("not enough memory");
    zip_source_keep(memory.get());  // the archive takes one of two
    std::unique_ptr<zip_t, Closer> archive(
        zip_open_from_source(memory.get(), ZIP_TRUNCATE, &error));
    if (!archive) {
        zip_source_free(memory.get());
        fail("cannot be created");
    }
    for (const GeneratedFile& file : files) {
        zip_source_t* contents =
            zip_source_buffer(archive.get(), file.contents.data(), file.contents.size(), 0);
        const zip_int64_t index =
            contents ? zip_file_add(archive.get(), file.path.c_str(), contents, ZIP_FL_ENC_UTF_8)
                     : -1;
        if (index < 0) {
            zip_source_free(contents);
            throw Error("archive: " + file.path + ": " + zip_strerror(archive.get()));
        }
        // 1980-01-01, the earliest date of a ZIP, in the ZIP's own format: the same bytes on every
        // day and in every time zone.
        constexpr zip_uint16_t kMidnight = 0;
        constexpr zip_uint16_t kEarliest = (1 << 5) | 1;
        zip_file_set_dostime(archive.get(), static_cast<zip_uint64_t>(index), kMidnight, kEarliest,
                             0);
    }
    if (zip_close(archive.get()) != 0)
        throw Error(std::string("archive: ") + zip_strerror(archive.get()));
    (void)archive.release();  // closed

    zip_stat_t stat;
    zip_stat_init(&stat);
    if (zip_source_open(memory.get()) != 0 || zip_source_stat(memory.get(), &stat) != 0)
        throw Error("archive: cannot be read back");
    std::string bytes(stat.size, '\0');
    const zip_int64_t read = zip_source_read(memory.get(), bytes.data(), bytes.size());
    zip_source_close(memory.get());
    if (read != static_cast<zip_int64_t>(bytes.size())) throw Error("archive: cannot be read back");
    return bytes;
}

TONEWRIGHT_NAMESPACE_END
