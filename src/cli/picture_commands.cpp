// SPDX-License-Identifier: Apache-2.0
#include "cli/picture_commands.h"

#include <dlfcn.h>
#include <fmt/format.h>
#include <malloc.h>
#include <sys/resource.h>
#include <unistd.h>

#include <atomic>
#include <filesystem>
#include <optional>
#include <string_view>
#include <system_error>

#include "tonewright/error.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

// Binding functions at their first call saves an eighth of the time.
constexpr int kBinding = RTLD_LAZY | RTLD_LOCAL;

/// The limit of `ulimit -v`, in MB.
std::optional<double> address_limit() {
    struct rlimit limit {};
    if (::getrlimit(RLIMIT_AS, &limit) != 0 || limit.rlim_cur == RLIM_INFINITY) return {};
    return static_cast<double>(limit.rlim_cur) / 1e6;
}

std::atomic<bool> is_loading = false;

/// Each batch of rows and each frame allocates the buffers that the one before it freed. The
/// allocator keeps them instead of returning them to the system, which would clear their pages
/// again: `apply` of a UHD picture in PIZ has 25,000 page faults instead of 82,000, and takes 0.82
/// of the time.
void keep_freed_memory() {
    constexpr int kMostThreshold = 32 << 20;  // glibc refuses more: malloc/malloc.c, HEAP_MAX_SIZE
    ::mallopt(M_MMAP_THRESHOLD, kMostThreshold);
    ::mallopt(M_TRIM_THRESHOLD, 1 << 30);
}

/// A module stays loaded until the process ends.
/// @param name  picture_commands or row_commands
template <class Commands>
const Commands& load(const std::string& name) {
    namespace fs = std::filesystem;
    std::error_code error;
    const fs::path self = fs::read_symlink("/proc/self/exe", error);
    if (error) throw FileError("start: /proc/self/exe: " + error.message());
    const std::string path =
        (self.parent_path() / TONEWRIGHT_LIBEXEC / (name + ".so")).lexically_normal();
    const auto fail = [&](const std::string& reason) {
        throw FileError("start: cannot load the picture commands: " + reason);
    };
    const std::optional<double> limit = address_limit();
    if (limit) {
        // Each further arena of malloc reserves 64 to 128 MB of addresses for a thread.
        ::mallopt(M_ARENA_MAX, 1);
    } else {
        keep_freed_memory();
    }
    is_loading = limit.has_value();
    void* module = ::dlopen(path.c_str(), kBinding);
    is_loading = false;
    // A module that is there does not load for lack of addresses, where they are limited.
    if (!module && limit && ::access(path.c_str(), R_OK) == 0) {
        fail(
            fmt::format("not enough memory; expected more addresses than the limit of {:.0f} MB "
                        "(ulimit -v)",
                        *limit));
    }
    if (!module) fail(::dlerror());
    using Entry = const Commands* (*)(const char* build);
    const auto entry = reinterpret_cast<Entry>(::dlsym(module, ("tonewright_" + name).c_str()));
    const Commands* commands = entry ? entry(kPictureCommandsBuild) : nullptr;
    if (!commands)
        fail(path + ": belongs to another build; expected " + std::string(kPictureCommandsBuild));
    commands->use_messages(message_options());
    return *commands;
}

}  // namespace

bool is_loading_under_limit() noexcept { return is_loading; }

const PictureCommands& picture_commands() {
    static const auto& commands = load<PictureCommands>("picture_commands");
    return commands;
}

const RowCommands& row_commands() {
    static const auto& commands = load<RowCommands>("row_commands");
    return commands;
}

TONEWRIGHT_NAMESPACE_END
