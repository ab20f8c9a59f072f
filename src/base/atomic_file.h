// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "tonewright/error.h"
#include "tonewright/version.h"

TONEWRIGHT_NAMESPACE_BEGIN

/// Lives while a thread creates a file, or opens one by its name: what removes unfinished files
/// waits for its end (a second at most). Once they are being removed, a thread that begins waits
/// here for the end of the process.
class TONEWRIGHT_API FileCreation {
  public:
    FileCreation() noexcept;
    ~FileCreation();
    FileCreation(const FileCreation&) = delete;
    FileCreation& operator=(const FileCreation&) = delete;
};

/// A file that is written under a temporary name beside its target and gets the target's name when
/// it is complete. A failed or killed run leaves the old file whole.
///
/// The temporary name is `.<stem>.<machine>.<pid>.<random>.tmp.<extension>`. The extension comes
/// last because it selects the format. Nobody can guess the name and put a link there.
class TONEWRIGHT_API AtomicFile {
  public:
    enum class Kind {
        /// A link stays, and the file that it leads to is replaced. A new file has the permissions
        /// that the umask says. While an old one is replaced, only this user can read the new one.
        of_user,
        /// For caches: a link is replaced, and no other user can read the file.
        of_program,
    };

    /// Touches nothing yet.
    explicit AtomicFile(const std::string& path, Kind kind = Kind::of_user);
    /// For a file that is written from the contents of another one, as a backup is.
    /// @param like  where the target is new, it gets the access of this file
    AtomicFile(const std::string& path, const std::string& like);
    /// Removes the temporary file unless it was kept.
    ~AtomicFile();
    AtomicFile(const AtomicFile&) = delete;
    AtomicFile& operator=(const AtomicFile&) = delete;

    /// The temporary name.
    [[nodiscard]] const std::filesystem::path& path() const { return path_; }
    /// The final place of the bytes.
    [[nodiscard]] const std::filesystem::path& target() const { return target_; }
    /// Why no file can be written there (a folder, a device, a pipe, a broken link); empty if one
    /// can.
    [[nodiscard]] const std::string& refusal() const { return refusal_; }
    /// Renaming asks only the folder for permission, and would replace a write-protected file.
    /// @returns  0 or an errno.
    [[nodiscard]] int check_target() const;
    /// Creates the temporary file, which nothing else may have made, and opens it for writing, as a
    /// FileCreation.
    /// @returns  a descriptor, which the caller closes; or -1, and an errno in `errno`.
    [[nodiscard]] int create();
    /// Creates the temporary file with these contents.
    /// @returns  0 or an errno.
    [[nodiscard]] int write(std::string_view contents);
    /// Gives the temporary file the access of the old one (owner and group as far as this user may,
    /// permissions without setuid and setgid, access control list), syncs it and renames it.
    /// @returns  0 or an errno.
    [[nodiscard]] int keep();

  private:
    /// The file whose access the new one gets; empty if there is none.
    [[nodiscard]] std::filesystem::path like() const;

    Kind kind_ = Kind::of_user;
    std::string refusal_;
    std::filesystem::path target_;
    std::filesystem::path like_;  // of a new target
    std::filesystem::path path_;  // empty once kept
    std::atomic<const char*>* unfinished_ = nullptr;
};

/// Writes a whole file, and removes what killed runs left of it. @throws FileError  "write: <path>:
/// <reason>"
TONEWRIGHT_API void write_text_atomically(const std::string& path, std::string_view contents,
                                          AtomicFile::Kind kind = AtomicFile::Kind::of_user);

/// Two of these outputs would be one file: through links, hard links too, or because the disk does
/// not tell capital letters (ASCII) from small ones. The second would replace the first. Equal
/// names are one output.
/// @throws Error  "outputs <path> and <path> are one file; expected different files"
TONEWRIGHT_API void require_separate_files(const std::vector<std::string>& paths);

/// Throws what write_text_atomically() will throw, before a long computation.
TONEWRIGHT_API void require_writable_file(const std::string& path);

/// Creates the folder if it is missing, and a file in it for a moment, so that a long computation
/// does not find out at its end that it cannot write. A signal that ends the program removes the
/// folder if nothing was written into it.
/// @throws FileError  naming the path and the reason.
TONEWRIGHT_API void require_writable_folder(const std::string& folder);

/// Removes the temporary files of these targets that killed runs left: those of processes of this
/// machine that no longer exist, and those that are older than a day (processes of other machines
/// cannot be asked). Files that cannot be removed stay.
TONEWRIGHT_API void remove_leftovers(const std::vector<std::string>& paths,
                                     AtomicFile::Kind kind = AtomicFile::Kind::of_user);

/// Removes unfinished files and new empty folders, for a process that ends at once. Without memory;
/// also for signal handlers. Threads that create a file afterward stop there.
TONEWRIGHT_API void remove_unfinished_files() noexcept;

/// On SIGINT, SIGTERM and SIGHUP, removes unfinished files and new empty folders before the process
/// ends; a file that becomes too large (SIGXFSZ) is an error of writing it, and ends nothing. For a
/// program to call once.
TONEWRIGHT_API void remove_unfinished_files_on_signals();

TONEWRIGHT_NAMESPACE_END
