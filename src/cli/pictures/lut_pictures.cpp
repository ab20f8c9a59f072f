// SPDX-License-Identifier: Apache-2.0
#include "base/atomic_file.h"
#include "cli/elapsed_line.h"
#include "cli/messages.h"
#include "cli/pictures/commands.h"
#include "cli/pictures/picture_input.h"
#include "image/lut_picture.h"
#include "image/shipped_pictures.h"

#include "lut/shipped_set.h"
#include "tonewright/generated_files.h"
#include "tonewright/image_io.h"
#include "tonewright/lut.h"

TONEWRIGHT_NAMESPACE_BEGIN

void write_shipped_luts(const std::string& folder, const std::string& application) {
    require_writable_folder(folder);
    const ElapsedLine line("bake --all");
    std::vector<ShippedLut> luts = bake_shipped_luts(application);
    std::vector<GeneratedFile> files = make_shipped_files(luts);
    std::vector<GeneratedFile> about = describe_shipped_luts(luts);
    for (GeneratedFile& file : about) {
        if (file.path.ends_with(".md")) file.contents = render(file.contents, command_style());
    }
    files.insert(files.end(), about.begin(), about.end());
    write_generated_files(folder, files, "MANIFEST.csv");
}

void write_lut_picture(const Lut& lut, LutFormat format, const std::string& path, int bits) {
    OIIO::TypeDesc type = OIIO::TypeDesc::FLOAT;
    if (bits == 8) type = OIIO::TypeDesc::UINT8;
    if (bits == 16) type = OIIO::TypeDesc::UINT16;
    write_image_atomically(make_lut_picture(lut, format), path, type);
}

Lut load_lut_picture(const std::string& path) {
    const QuietStderr quiet;
    return read_lut_picture(path);
}

TONEWRIGHT_NAMESPACE_END
