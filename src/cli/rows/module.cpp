// SPDX-License-Identifier: Apache-2.0
#include <string_view>

#include "base/atomic_file.h"
#include "cli/picture_commands.h"
#include "cli/rows/apply_rows.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

void use_messages(const MessageOptions& options) { message_options() = options; }

}  // namespace

extern "C" [[gnu::visibility("default")]] const RowCommands* tonewright_row_commands(
    const char* build) {
    if (std::string_view(build) != kPictureCommandsBuild) return nullptr;
    // In a static build the module has a list of unfinished files of its own.
    remove_unfinished_files_on_signals();
    static constexpr RowCommands kCommands = {.use_messages = use_messages, .apply = apply_rows};
    return &kCommands;
}

TONEWRIGHT_NAMESPACE_END
