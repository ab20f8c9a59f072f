// SPDX-License-Identifier: Apache-2.0
#ifndef _WIN32

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#ifdef __linux__
#include <sys/xattr.h>
#endif

#include <array>
#include <cerrno>
#include <csignal>
#include <cstdint>
#include <cstdio>
#include <string>
#include <system_error>

#include "base/system_files.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace fs = std::filesystem;

std::string machine_and_container() {
    std::array<char, 256> host{};
    (void)::gethostname(host.data(), host.size() - 1);
    std::error_code none;
    return host.data() + fs::read_symlink("/proc/self/ns/pid", none).string();
}

int this_process() { return ::getpid(); }
bool has_ended(int process) { return ::kill(process, 0) != 0 && errno == ESRCH; }

int check_access(const fs::path& path, bool is_for_writing) {
    return ::access(path.c_str(), is_for_writing ? W_OK : R_OK) == 0 ? 0 : errno;
}

bool is_file_itself(const fs::path& path) {
    struct stat status {};
    return ::lstat(path.c_str(), &status) == 0 && S_ISREG(status.st_mode);
}

int create_new(const fs::path& path, bool is_private) {
    return ::open(path.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_NOFOLLOW | O_CLOEXEC,
                  is_private ? 0600 : 0666);
}

int open_to_read(const fs::path& path) {
    return ::open(path.c_str(), O_RDONLY | O_NONBLOCK | O_CLOEXEC);
}

int open_own_file(const fs::path& path) {
    const int file = ::open(path.c_str(), O_RDONLY | O_NONBLOCK | O_NOFOLLOW | O_CLOEXEC);
    if (file < 0) return -1;
    struct stat status {};
    const bool is_own = ::fstat(file, &status) == 0 && S_ISREG(status.st_mode) &&
                        (status.st_uid == ::geteuid() || status.st_uid == 0) &&
                        (status.st_mode & (S_IWGRP | S_IWOTH)) == 0;
    if (is_own) return file;
    ::close(file);
    return -1;
}

void mark_as_used(int file) { (void)::futimens(file, nullptr); }

std::optional<std::pair<std::uint64_t, std::uint64_t>> identity_of(const fs::path& path) {
    struct stat status {};
    if (::stat(path.c_str(), &status) != 0) return std::nullopt;
    return std::pair<std::uint64_t, std::uint64_t>(status.st_dev, status.st_ino);
}

namespace {

/// The access control list of a file, as Linux stores it: a version, and entries of a tag, its
/// permissions and an id (linux/posix_acl_xattr.h). Empty where the file has none.
class AccessList {
  public:
    explicit AccessList([[maybe_unused]] const fs::path& path) {
#ifdef __linux__
        const ssize_t size = ::lgetxattr(path.c_str(), kName, nullptr, 0);
        if (size <= 0) return;
        bytes_.resize(static_cast<std::size_t>(size));
        if (::lgetxattr(path.c_str(), kName, bytes_.data(), bytes_.size()) != size) bytes_.clear();
#endif
    }

    [[nodiscard]] bool is_empty() const { return bytes_.empty(); }
    /// The permissions of the file's group, three bits. The group bits of the file's mode are a
    /// mask for it where there is a list.
    [[nodiscard]] unsigned of_group() const { return find(kGroup) ? byte_at(find(kGroup)) : 0; }
    /// For a file of another group.
    void give_group_what_others_have() {
        if (!find(kGroup) || !find(kOthers)) return;
        const unsigned both = of_group() & byte_at(find(kOthers));
        bytes_[find(kGroup)] = static_cast<char>(both);
    }
    /// Also takes away a list that the file has from its folder.
    [[nodiscard]] bool give_to([[maybe_unused]] int file) const {
#ifdef __linux__
        if (!is_empty()) return ::fsetxattr(file, kName, bytes_.data(), bytes_.size(), 0) == 0;
        (void)::fremovexattr(file, kName);
#endif
        return is_empty();
    }

  private:
    static constexpr const char* kName = "system.posix_acl_access";
    static constexpr std::size_t kHeader = 4;
    static constexpr std::size_t kEntry = 8;
    static constexpr unsigned kGroup = 0x04;
    static constexpr unsigned kOthers = 0x20;

    [[nodiscard]] unsigned byte_at(std::size_t at) const {
        return static_cast<unsigned char>(bytes_[at]);
    }
    /// Position of an entry's permissions; 0 if there is no such entry.
    [[nodiscard]] std::size_t find(unsigned tag) const {
        for (std::size_t at = kHeader; at + kEntry <= bytes_.size(); at += kEntry) {
            if (byte_at(at) == tag && byte_at(at + 1) == 0) return at + 2;
        }
        return 0;
    }

    std::string bytes_;
};

/// Only its user has access to the file before this.
void take_access(int file, const fs::path& like) {
    struct stat old {};
    if (::lstat(like.c_str(), &old) != 0 || !S_ISREG(old.st_mode)) return;
    AccessList list(like);
    // The written file may run with the rights of its owner only if the owner says so again.
    mode_t mode = old.st_mode & (S_IRWXU | S_IRWXG | S_IRWXO);
    constexpr auto kKept = static_cast<uid_t>(-1);
    const bool has_group =
        ::fchown(file, old.st_uid, old.st_gid) == 0 || ::fchown(file, kKept, old.st_gid) == 0;
    // The bits of the old group are not those of the user's group.
    if (!has_group) list.give_group_what_others_have();
    const bool has_list = !list.is_empty() && list.give_to(file);
    if (!has_list) {
        unsigned of_group = mode >> 3U & 7U;
        if (!list.is_empty()) of_group &= list.of_group();
        if (!has_group) of_group &= mode & 7U;
        mode = (mode & ~static_cast<mode_t>(S_IRWXG)) | of_group << 3U;
        (void)AccessList(fs::path()).give_to(file);
    }
    (void)::fchmod(file, mode);
}

}  // namespace

int replace(const fs::path& target, const fs::path& written, const fs::path& like) {
    const int file = ::open(written.c_str(), O_RDONLY | O_NOFOLLOW | O_CLOEXEC);
    if (file < 0) return errno;
    take_access(file, like);
    const int error = ::fsync(file) == 0 ? 0 : errno;
    ::close(file);
    if (error) return error;
    if (::rename(written.c_str(), target.c_str()) != 0) return errno;
    // The new name is on the disk after its directory is synced. Some file systems cannot sync a
    // directory.
    const fs::path folder = target.has_parent_path() ? target.parent_path() : fs::path(".");
    const int directory = ::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
    if (directory >= 0) {
        (void)::fsync(directory);
        ::close(directory);
    }
    return 0;
}

void remove_name(const char* path) noexcept {
    if (::unlink(path) != 0) ::rmdir(path);
}

void set_end_handler(void (*handler)(int signal)) {
    for (const int number : {SIGINT, SIGTERM, SIGHUP}) {
        // nohup stays in effect.
        if (::signal(number, handler) == SIG_IGN) ::signal(number, SIG_IGN);
    }
    ::signal(SIGXFSZ, SIG_IGN);
}

TONEWRIGHT_NAMESPACE_END

#endif
