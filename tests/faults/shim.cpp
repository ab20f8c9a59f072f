// SPDX-License-Identifier: Apache-2.0
//
// For LD_PRELOAD: makes one call of the program fail, or counts them. Counting begins when all
// libraries are initialized. What libraries do while they are loaded does not count: GLib, HDF5 and
// libnuma end the process there. Neither do the dynamic loader's own allocations.
//
//     TONEWRIGHT_FAULT=memory:N        allocation N fails
//     TONEWRIGHT_FAULT=memory-from:N   allocation N and all later ones fail
//     TONEWRIGHT_FAULT=file:N[:ERRNO]  call N that writes, creates, syncs or renames (ENOSPC)
//     TONEWRIGHT_FAULT=short:N         write N takes one byte
//     TONEWRIGHT_FAULT=kill:N          the process is killed at call N on a file
//     TONEWRIGHT_FAULT_LOG=FILE        gets `memory N` for each new call stack of an allocation,
//                                      and `file N NAME` for each call on a file
#include <dlfcn.h>
#include <fcntl.h>
#include <sys/auxv.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <sys/types.h>
#include <sys/uio.h>
#include <unistd.h>
#include <unwind.h>

#include <array>
#include <atomic>
#include <cerrno>
#include <csignal>
#include <cstdarg>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <utility>

extern "C" {
void* __libc_malloc(std::size_t);
void* __libc_calloc(std::size_t, std::size_t);
void* __libc_realloc(void*, std::size_t);
void* __libc_memalign(std::size_t, std::size_t);
}

namespace {

enum class Kind { none, memory, memory_from, file, short_write, kill };

Kind kind = Kind::none;
std::uint64_t wanted = 0;
int error_number = ENOSPC;
int log_file = -1;
std::atomic<bool> is_armed = false;
std::atomic<std::uint64_t> allocations = 0;
std::atomic<std::uint64_t> file_calls = 0;
// Unwinding may allocate, the first time.
__attribute__((tls_model("initial-exec"))) thread_local bool is_inside = false;

/// Distinct call stacks, by the hash of their innermost frames: more of them tell apart what
/// recursion visits.
constexpr int kFrames = 8;
std::array<std::atomic<std::uint64_t>, 1 << 18> stacks;

struct Frames {
    int count = 0;
    std::uint64_t hash = 0xcbf29ce484222325u;
};

_Unwind_Reason_Code add_frame(_Unwind_Context* context, void* data) {
    auto& frames = *static_cast<Frames*>(data);
    frames.hash = (frames.hash ^ _Unwind_GetIP(context)) * 0x100000001b3u;
    return ++frames.count < kFrames ? _URC_NO_REASON : _URC_END_OF_STACK;
}

bool is_new_stack() {
    Frames frames;
    _Unwind_Backtrace(add_frame, &frames);
    for (std::size_t i = frames.hash % stacks.size();; i = (i + 1) % stacks.size()) {
        std::uint64_t none = 0;
        if (stacks[i].compare_exchange_strong(none, frames.hash)) return true;
        if (none == frames.hash) return false;
    }
}

void log_line(const char* what, std::uint64_t number, const char* name) {
    std::array<char, 512> line{};
    const int size = std::snprintf(line.data(), line.size(), "%s %llu %s\n", what,
                                   static_cast<unsigned long long>(number), name);
    (void)::syscall(SYS_write, log_file, line.data(), static_cast<std::size_t>(size));
}

/// The dynamic loader ends the process where a thread's data find no memory.
bool is_in_loader(const void* caller) {
    static const std::uintptr_t begin = ::getauxval(AT_BASE);
    constexpr std::uintptr_t kLoaderBytes = 0x40000;  // glibc 2.36: 0x38000
    return reinterpret_cast<std::uintptr_t>(caller) - begin < kLoaderBytes;
}

/// OpenImageIO 2.4 does not look whether the C library had memory for an attribute of many values,
/// such as an ICC profile, and copies to the null pointer.
bool is_of_attribute(const void* caller) {
    Dl_info found{};
    return ::dladdr(caller, &found) != 0 && found.dli_sname &&
           std::strstr(found.dli_sname, "ParamValue12init_noclear");
}

/// True if this allocation fails.
bool fails_allocation(const void* caller) {
    if (!is_armed || is_inside || is_in_loader(caller)) return false;
    is_inside = true;
    const std::uint64_t number = ++allocations;
    if (log_file >= 0 && is_new_stack()) log_line("memory", number, "");
    is_inside = false;
    const bool fails = ((kind == Kind::memory && number == wanted) ||
                        (kind == Kind::memory_from && number >= wanted)) &&
                       !is_of_attribute(caller);
    if (fails) errno = ENOMEM;
    return fails;
}

/// True if this call on a file fails; errno says why.
bool fails_file(const char* name, bool is_write = false) {
    if (!is_armed || is_inside) return false;
    is_inside = true;
    const std::uint64_t number = ++file_calls;
    if (log_file >= 0) log_line("file", number, name);
    is_inside = false;
    if (number != wanted) return false;
    if (kind == Kind::kill) (void)::raise(SIGKILL);
    if (kind == Kind::file) errno = error_number;
    return kind == Kind::file || (kind == Kind::short_write && is_write);
}

/// The program's messages are no files.
bool is_message(int file) { return file == STDERR_FILENO; }

template <typename Function>
Function* next(const char* name) {
    return reinterpret_cast<Function*>(::dlsym(RTLD_NEXT, name));
}

__attribute__((constructor)) void arm() {
    if (const char* path = std::getenv("TONEWRIGHT_FAULT_LOG"))
        log_file = static_cast<int>(
            ::syscall(SYS_openat, AT_FDCWD, path, O_WRONLY | O_CREAT | O_APPEND | O_CLOEXEC, 0666));
    if (const char* fault = std::getenv("TONEWRIGHT_FAULT")) {
        const char* colon = std::strchr(fault, ':');
        if (!colon) std::abort();
        const auto is = [&](const char* name) {
            return std::strlen(name) == static_cast<std::size_t>(colon - fault) &&
                   std::strncmp(fault, name, std::strlen(name)) == 0;
        };
        kind = is("memory")        ? Kind::memory
               : is("memory-from") ? Kind::memory_from
               : is("file")        ? Kind::file
               : is("kill")        ? Kind::kill
                                   : Kind::short_write;
        char* end = nullptr;
        wanted = std::strtoull(colon + 1, &end, 10);
        if (*end == ':') error_number = std::atoi(end + 1);
    }
    if (log_file >= 0) (void)is_new_stack();  // what unwinding loads is there before it counts
    is_armed = log_file >= 0 || kind != Kind::none;
}

}  // namespace

extern "C" {

void* malloc(std::size_t size) {
    return fails_allocation(__builtin_return_address(0)) ? nullptr : __libc_malloc(size);
}
void* calloc(std::size_t count, std::size_t size) {
    return fails_allocation(__builtin_return_address(0)) ? nullptr : __libc_calloc(count, size);
}
void* realloc(void* old, std::size_t size) {
    return fails_allocation(__builtin_return_address(0)) ? nullptr : __libc_realloc(old, size);
}
void* memalign(std::size_t alignment, std::size_t size) {
    return fails_allocation(__builtin_return_address(0)) ? nullptr
                                                         : __libc_memalign(alignment, size);
}
void* aligned_alloc(std::size_t alignment, std::size_t size) { return memalign(alignment, size); }
int posix_memalign(void** block, std::size_t alignment, std::size_t size) {
    void* const found = memalign(alignment, size);
    if (found) *block = found;
    return found ? 0 : ENOMEM;
}

ssize_t write(int file, const void* bytes, std::size_t size) {
    if (!is_message(file) && fails_file("write", true)) {
        if (kind == Kind::file) return -1;
        size = size > 0 ? 1 : 0;
    }
    return static_cast<ssize_t>(::syscall(SYS_write, file, bytes, size));
}
ssize_t writev(int file, const iovec* parts, int count) {
    if (!is_message(file) && fails_file("writev", true)) {
        if (kind == Kind::file) return -1;
        return static_cast<ssize_t>(
            ::syscall(SYS_write, file, parts[0].iov_base, parts[0].iov_len > 0 ? 1 : 0));
    }
    return static_cast<ssize_t>(::syscall(SYS_writev, file, parts, count));
}
ssize_t pwrite(int file, const void* bytes, std::size_t size, off_t at) {
    if (fails_file("pwrite", true)) {
        if (kind == Kind::file) return -1;
        size = size > 0 ? 1 : 0;
    }
    return static_cast<ssize_t>(::syscall(SYS_pwrite64, file, bytes, size, at));
}
ssize_t pwrite64(int file, const void* bytes, std::size_t size, off64_t at) {
    return pwrite(file, bytes, size, at);
}

/// The C library's own calls inside are hidden, so the streams fail as a whole.
std::size_t fwrite(const void* bytes, std::size_t size, std::size_t count, FILE* stream) {
    static auto* const real =
        next<std::size_t(const void*, std::size_t, std::size_t, FILE*)>("fwrite");
    return !is_message(::fileno(stream)) && fails_file("fwrite") ? 0
                                                                 : real(bytes, size, count, stream);
}
int fflush(FILE* stream) {
    static auto* const real = next<int(FILE*)>("fflush");
    return stream && !is_message(::fileno(stream)) && fails_file("fflush") ? EOF : real(stream);
}
int fclose(FILE* stream) {
    static auto* const real = next<int(FILE*)>("fclose");
    const bool fails =
        (::fcntl(::fileno(stream), F_GETFL) & O_ACCMODE) != O_RDONLY && fails_file("fclose");
    const int error = errno;
    const int result = real(stream);
    if (fails) errno = error;
    return fails ? EOF : result;
}

int open(const char* path, int flags, ...) {
    static auto* const real = next<int(const char*, int, ...)>("open");
    mode_t mode = 0;
    if (flags & (O_CREAT | O_TMPFILE)) {
        va_list arguments;
        va_start(arguments, flags);
        mode = va_arg(arguments, mode_t);
        va_end(arguments);
    }
    return (flags & O_ACCMODE) != O_RDONLY && fails_file("open") ? -1 : real(path, flags, mode);
}
int open64(const char* path, int flags, ...) {
    mode_t mode = 0;
    if (flags & (O_CREAT | O_TMPFILE)) {
        va_list arguments;
        va_start(arguments, flags);
        mode = va_arg(arguments, mode_t);
        va_end(arguments);
    }
    return open(path, flags, mode);
}
FILE* fopen(const char* path, const char* mode) {
    static auto* const real = next<FILE*(const char*, const char*)>("fopen");
    return mode[0] != 'r' && fails_file("fopen") ? nullptr : real(path, mode);
}
FILE* fopen64(const char* path, const char* mode) { return fopen(path, mode); }

void* dlopen(const char* path, int flags) {
    static auto* const real = next<void*(const char*, int)>("dlopen");
    const bool was_inside = std::exchange(is_inside, true);
    void* const library = real(path, flags);
    is_inside = was_inside;
    return library;
}

int fsync(int file) {
    return fails_file("fsync") ? -1 : static_cast<int>(::syscall(SYS_fsync, file));
}
int ftruncate(int file, off_t size) {
    return fails_file("ftruncate") ? -1 : static_cast<int>(::syscall(SYS_ftruncate, file, size));
}
int rename(const char* from, const char* to) {
    return fails_file("rename")
               ? -1
               : static_cast<int>(::syscall(SYS_renameat2, AT_FDCWD, from, AT_FDCWD, to, 0));
}
int mkdir(const char* path, mode_t mode) {
    return fails_file("mkdir") ? -1
                               : static_cast<int>(::syscall(SYS_mkdirat, AT_FDCWD, path, mode));
}
}
