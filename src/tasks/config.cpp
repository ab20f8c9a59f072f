// SPDX-License-Identifier: Apache-2.0
#include "tasks/config.h"

#include <filesystem>

#include "base/atomic_file.h"
#include "base/input_file.h"
#include "tasks/archive.h"
#include "tonewright/generated_files.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

WrittenConfig describe(const std::string& path, const std::vector<GeneratedFile>& files) {
    WrittenConfig written{path, files.size()};
    for (const GeneratedFile& file : files)
        written.bytes += file.contents.size();
    return written;
}

}  // namespace

std::vector<WrittenConfig> write_config(const ConfigRequest& request, const Listener& listener) {
    const std::string& folder = request.folder;
    const std::filesystem::path archive(request.archive);
    if (folder.empty() && archive.empty())
        throw Error(
            Problem{.value = "there is no folder and no archive", .expected = "one of them"});
    const ConfigPlan plan(request.options);
    for (const std::string& text : plan.warnings())
        listener.warn_of(text);
    if (!archive.empty() && archive.extension() != ".ocioz") {
        throw Error({.parameter = "archive",
                     .value = request.archive,
                     .expected = "a name that ends in .ocioz"});
    }
    if (!folder.empty()) require_writable_folder(folder);
    if (!archive.empty())
        require_writable_folder(std::filesystem::absolute(archive).parent_path().string());
    std::vector<WrittenConfig> written;
    with_memory_for(folder.empty() ? request.archive : folder, [&] {
        const std::vector<GeneratedFile> files = make_config(plan);
        if (!folder.empty()) {
            write_generated_files(folder, files, "config.ocio");
            written.push_back(describe(folder, files));
        }
        if (archive.empty()) return;
        std::vector<GeneratedFile> packed;
        for (const GeneratedFile& file : files) {
            if (file.path == "config.ocio" || file.path.starts_with("luts/"))
                packed.push_back(file);
        }
        write_text_atomically(request.archive, make_archive(packed));
        written.push_back(describe(request.archive, packed));
    });
    return written;
}

TONEWRIGHT_NAMESPACE_END
