// SPDX-License-Identifier: Apache-2.0
#include "cli/pictures/reading.h"

#include "cli/rows/apply_request.h"
#include "cli/rows/picture_messages.h"
#include "tasks/pictures/read_picture.h"

TONEWRIGHT_NAMESPACE_BEGIN

OIIO::ImageBuf read_picture(const std::string& path, const PictureChoice& choice,
                            std::string_view input) {
    PictureMessages messages(path);
    ReadOptions read = read_options_of(choice);
    messages.attach_to(read);
    OIIO::ImageBuf picture = [&] {
        const QuietStderr quiet;
        return read_picture(path, read, input);
    }();
    messages.print();
    return picture;
}

TONEWRIGHT_NAMESPACE_END
