// SPDX-License-Identifier: Apache-2.0
#include "base/atomic_file.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <chrono>
#include <csignal>
#include <fstream>
#include <map>
#include <memory>
#include <optional>
#include <random>
#include <set>
#include <system_error>
#include <thread>
#include <tuple>
#include <utility>

#include "base/input_file.h"
#include "base/strings.h"
#include "base/system_files.h"
#include "tonewright/error.h"
#include "tonewright/generated_files.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace fs = std::filesystem;

namespace {

/// The final target, after symbolic links.
/// @param why  the reason, if no file can be there
fs::path resolve_target(const std::string& path, AtomicFile::Kind kind, std::string& why) {
    std::error_code error;
    fs::path target = path;
    why.clear();
    if (kind == AtomicFile::Kind::of_program && fs::is_symlink(fs::symlink_status(target, error)))
        return target;
    why = why_no_file(path);
    if (!why.empty()) return target;
    if (fs::is_symlink(fs::symlink_status(target, error))) {
        target = fs::weakly_canonical(target, error);
        if (error) why = error.message();
    }
    // Renaming over a device or a folder would destroy it, or fail late.
    if (why.empty()) why = why_no_file(target.string());
    return target;
}

/// Stem and extension of the temporary names of a target. Names have at most 255 bytes.
std::pair<std::string, std::string> name_parts(const fs::path& target) {
    return {target.stem().string().substr(0, 200), target.extension().string()};
}

/// A name that no other program can guess.
std::uint64_t random_bits() {
    std::random_device device;
    return std::uint64_t{device()} << 32 | device();
}

const std::string& machine_tag() {
    static const std::string tag = content_hash(machine_and_container());
    return tag;
}

/// The names of the unfinished temporary files and of new folders, for the signal handler. The one
/// that takes a name out removes the file.
std::array<std::atomic<const char*>, 256> unfinished_names;
static_assert(std::atomic<const char*>::is_always_lock_free);

/// The signal handler is removing the files: a file that is created after this would stay.
std::atomic<bool> is_ending = false;
/// FileCreations of all threads, and of this one.
std::atomic<int> creations = 0;
thread_local int own_creations = 0;
static_assert(std::atomic<int>::is_always_lock_free);

/// Null if so many files are unfinished that this one could not be removed after a signal.
std::atomic<const char*>* register_unfinished(const std::string& path) {
    auto name = std::make_unique<char[]>(path.size() + 1);
    std::copy(path.begin(), path.end(), name.get());
    for (std::atomic<const char*>& place : unfinished_names) {
        const char* none = nullptr;
        if (!place.compare_exchange_strong(none, name.get())) continue;
        (void)name.release();
        return &place;
    }
    return nullptr;
}

void release_unfinished(std::atomic<const char*>*& place) {
    if (place) delete[] place->exchange(nullptr);
    place = nullptr;
}

void end_by_signal(int number) {
    remove_unfinished_files();
    std::signal(number, SIG_DFL);
    std::raise(number);
}

/// `.<stem>.<machine>.<pid>.<random>.tmp<extension>`. The stem may have dots.
struct TemporaryName {
    std::string stem, machine, extension;
    int process = 0;
};

bool is_made_of(std::string_view text, const char* characters) {
    return !text.empty() && text.find_first_not_of(characters) == std::string_view::npos;
}

/// Nothing for other names.
std::optional<TemporaryName> parse_temporary(std::string_view name) {
    const auto take_last = [&](std::string_view& part) {
        const std::size_t dot = name.rfind('.');
        if (dot == std::string_view::npos) return false;
        part = name.substr(dot + 1);
        name = name.substr(0, dot);
        return true;
    };
    TemporaryName result;
    std::string_view ending, random, process, machine;
    if (!take_last(ending)) return std::nullopt;
    if (name.ends_with(".tmp")) {
        result.extension = "." + std::string(ending);
        (void)take_last(ending);
    }
    if (ending != "tmp") return std::nullopt;
    constexpr const char* kHexadecimal = "0123456789abcdef";
    if (!take_last(random) || !take_last(process) || !take_last(machine)) return std::nullopt;
    if (!is_made_of(random, kHexadecimal) || !is_made_of(machine, kHexadecimal) ||
        machine.size() != 8 || !is_made_of(process, "0123456789") || process.size() > 9 ||
        name.size() < 2 || name[0] != '.')
        return std::nullopt;
    result.stem = name.substr(1);
    result.machine = machine;
    result.process = std::stoi(std::string(process));
    return result;
}

}  // namespace

void remove_unfinished_files() noexcept {
    is_ending = true;
    // This thread may have been stopped while it created a file; it does not continue.
    for (int i = 0; i < 1000 && creations > own_creations; ++i)
        std::this_thread::sleep_for(std::chrono::milliseconds(1));
    for (std::atomic<const char*>& place : unfinished_names) {
        // Folders that are not empty stay.
        if (const char* name = place.exchange(nullptr)) remove_name(name);
    }
}

void remove_unfinished_files_on_signals() { set_end_handler(end_by_signal); }

void remove_leftovers(const std::vector<std::string>& paths, AtomicFile::Kind kind) {
    std::map<fs::path, std::set<std::pair<std::string, std::string>>> names_of_folders;
    for (const std::string& path : paths) {
        std::string why;
        const fs::path target = resolve_target(path, kind, why);
        const fs::path folder = target.parent_path();
        names_of_folders[folder.empty() ? "." : folder].insert(name_parts(target));
    }
    const auto yesterday = fs::file_time_type::clock::now() - std::chrono::hours(24);
    for (const auto& [folder, names] : names_of_folders) {
        std::error_code error;
        for (fs::directory_iterator entry(folder, error), end; !error && entry != end;
             entry.increment(error)) {
            const auto name = parse_temporary(entry->path().filename().string());
            if (!name || !names.contains({name->stem, name->extension})) continue;
            const bool is_of_nobody = name->machine == machine_tag() && has_ended(name->process);
            std::error_code unknown, ignored;
            const bool is_old = fs::last_write_time(entry->path(), unknown) < yesterday && !unknown;
            if (is_of_nobody || is_old) fs::remove(entry->path(), ignored);
        }
    }
}

FileCreation::FileCreation() noexcept {
    ++own_creations;
    ++creations;
    if (!is_ending) return;
    --creations;
    while (true)
        std::this_thread::sleep_for(std::chrono::hours(1));
}

FileCreation::~FileCreation() {
    --creations;
    --own_creations;
}

AtomicFile::AtomicFile(const std::string& path, Kind kind) : kind_(kind) {
    target_ = resolve_target(path, kind, refusal_);
    const auto [stem, extension] = name_parts(target_);
    path_ = target_.parent_path() / fmt::format(".{}.{}.{}.{:016x}.tmp{}", stem, machine_tag(),
                                                this_process(), random_bits(), extension);
    unfinished_ = register_unfinished(path_.string());
}

AtomicFile::AtomicFile(const std::string& path, const std::string& like)
    : AtomicFile(path, Kind::of_user) {
    like_ = like;
}

AtomicFile::~AtomicFile() {
    if (!path_.empty()) {
        std::error_code ignored;
        fs::remove(path_, ignored);
    }
    release_unfinished(unfinished_);
}

fs::path AtomicFile::like() const {
    if (kind_ == Kind::of_program) return {};
    return is_file_itself(target_) ? target_ : like_;
}

int AtomicFile::check_target() const {
    if (kind_ == Kind::of_program) return 0;  // it is replaced if the folder allows it
    const int error = check_access(target_, true);
    return error == ENOENT ? 0 : error;
}

int AtomicFile::create() {
    const FileCreation creation;
    // Nobody has more access to the unfinished file than to the old one.
    return create_new(path_, kind_ == Kind::of_program || is_file_itself(like()));
}

int AtomicFile::write(std::string_view contents) {
    const int file = create();
    if (file < 0) return errno;
    int error = 0;
    while (!contents.empty() && error == 0) {
        const auto n = ::write(file, contents.data(), piece_of(contents.size()));
        if (n > 0) {
            contents.remove_prefix(static_cast<std::size_t>(n));
        } else if (errno != EINTR) {
            error = errno;
        }
    }
    return ::close(file) != 0 && error == 0 ? errno : error;
}

int AtomicFile::keep() {
    if (const int error = replace(target_, path_, like())) return error;
    path_.clear();
    release_unfinished(unfinished_);
    return 0;
}

namespace {
void write_whole(const std::string& path, std::string_view contents,
                 AtomicFile::Kind kind = AtomicFile::Kind::of_user) {
    const auto fail = [&](int error) {
        throw FileError(within("write: " + path, problem_of_system(error)));
    };
    AtomicFile target(path, kind);
    if (!target.refusal().empty()) throw FileError("write: " + path + ": " + target.refusal());
    if (const int error = target.check_target()) fail(error);
    int error = target.write(contents);
    if (error == 0) error = target.keep();
    if (error != 0) fail(error);
}

void make_folder(const fs::path& folder) {
    std::vector<std::string> missing;  // the deepest first: so they are removed
    std::error_code error;
    for (fs::path path = folder; !path.empty() && !fs::exists(path, error) && !error;
         path = path.parent_path())
        missing.push_back(path.string());
    fs::create_directories(folder, error);
    if (error)
        throw FileError(within("write: " + folder.string(), problem_of_system(error.value())));
    for (const std::string& path : missing)
        (void)register_unfinished(path);
}
}  // namespace

void write_text_atomically(const std::string& path, std::string_view contents,
                           AtomicFile::Kind kind) {
    remove_leftovers({path}, kind);
    write_whole(path, contents, kind);
}

namespace {

/// The nearest folder above that exists.
fs::path existing_folder(fs::path folder) {
    std::error_code error;
    while (!folder.empty() && folder != folder.root_path() && !fs::is_directory(folder, error))
        folder = folder.parent_path();
    return folder.empty() ? "." : folder;
}

/// Creates a file there for a moment.
bool joins_letters(const fs::path& folder) {
    AtomicFile trial((existing_folder(folder) / ".tonewright").string());
    const int file = trial.create();
    if (file < 0) return false;  // the output itself reports why
    ::close(file);
    std::string capitals = trial.path().filename().string();
    for (char& c : capitals)
        c = c >= 'a' && c <= 'z' ? static_cast<char>(c - 'a' + 'A') : c;
    return identity_of(trial.path().parent_path() / capitals).has_value();
}

/// An output that does not exist yet.
struct NewFile {
    int folder = 0;  // a number for each
    std::string name;
    const std::string* path = nullptr;
};

/// The folders of outputs, by all their names.
class Folders {
  public:
    int number_of(const fs::path& folder) {
        const auto known = by_name_.find(folder);
        if (known != by_name_.end()) return known->second;
        std::error_code error;
        const fs::path real = fs::weakly_canonical(folder, error);
        const auto number = static_cast<int>(by_target_.size());
        const int found = by_target_.emplace(error ? folder : real, number).first->second;
        return by_name_.emplace(folder, found).first->second;
    }

  private:
    std::map<fs::path, int> by_name_, by_target_;
};

}  // namespace

void require_separate_files(const std::vector<std::string>& paths) {
    const auto refuse = [&](const std::string& a, const std::string& b) {
        throw Error(Problem{.value = fmt::format("outputs {} and {} are one file", a, b),
                            .expected = "different files"});
    };
    std::map<std::pair<std::uint64_t, std::uint64_t>, const std::string*> old_files;
    std::vector<NewFile> new_files;
    Folders folders;
    for (const std::string& path : paths) {
        std::string why;
        const fs::path target = resolve_target(path, AtomicFile::Kind::of_user, why);
        if (const auto file = identity_of(target)) {
            const auto [other, is_new] = old_files.emplace(*file, &path);
            if (!is_new && *other->second != path) refuse(*other->second, path);
        } else {
            const int folder = folders.number_of(fs::absolute(target).parent_path());
            new_files.push_back({folder, target.filename().string(), &path});
        }
    }
    // Names that differ in capital letters only stand side by side.
    const auto key = [](const NewFile& file) {
        return std::tuple(file.folder, lowercase(file.name), file.name);
    };
    std::sort(new_files.begin(), new_files.end(),
              [&](const NewFile& a, const NewFile& b) { return key(a) < key(b); });
    for (std::size_t i = 1; i < new_files.size(); ++i) {
        const NewFile& a = new_files[i - 1];
        const NewFile& b = new_files[i];
        if (a.folder != b.folder || *a.path == *b.path) continue;
        const bool is_one = a.name == b.name || (lowercase(a.name) == lowercase(b.name) &&
                                                 joins_letters(fs::path(*a.path).parent_path()));
        if (is_one) refuse(*a.path, *b.path);
    }
}

void require_writable_file(const std::string& path) {
    const auto fail = [&](int error) {
        throw FileError(within("write: " + path, problem_of_system(error)));
    };
    AtomicFile probe(path);  // which is never kept
    if (!probe.refusal().empty()) throw FileError("write: " + path + ": " + probe.refusal());
    if (const int error = probe.check_target()) fail(error);
    const int file = probe.create();
    if (file < 0) fail(errno);
    ::close(file);
}

void require_writable_folder(const std::string& folder) {
    const fs::path root(folder);
    make_folder(root);
    const std::string name = (root / ".tonewright").string();
    remove_leftovers({name});
    AtomicFile probe(name);  // which is never kept
    const int file = probe.create();
    if (file < 0) throw FileError(within("write: " + folder, problem_of_system(errno)));
    ::close(file);
}

void write_generated_files(const std::string& folder, const std::vector<GeneratedFile>& files,
                           std::string_view last) {
    const fs::path root(folder);
    std::set<std::string> stale;
    const fs::path old_manifest = root / "MANIFEST.csv";
    if (std::ifstream manifest; why_no_file(old_manifest.string()).empty()) {
        manifest.open(old_manifest);
        std::string line;
        std::getline(manifest, line);  // column names; the first column is the path
        while (std::getline(manifest, line)) {
            stale.insert(fs::path(line.substr(0, line.find(','))).lexically_normal().string());
        }
    }
    const auto write = [&](const GeneratedFile& file) {
        const fs::path path = root / file.path;
        make_folder(path.parent_path());
        write_whole(path.string(), file.contents);
        stale.erase(fs::path(file.path).lexically_normal().string());
    };
    std::vector<std::string> paths;
    paths.reserve(files.size());
    for (const GeneratedFile& file : files)
        paths.push_back((root / file.path).string());
    require_separate_files(paths);
    remove_leftovers(paths);
    for (const GeneratedFile& file : files) {
        if (file.path != last) write(file);
    }
    for (const GeneratedFile& file : files) {
        if (file.path == last) write(file);
    }
    // Anyone can edit a manifest, so nothing outside the folder is touched, not even through a link
    // in it.
    std::error_code error;
    const fs::path inside = fs::canonical(root, error);
    for (const std::string& path : stale) {
        const fs::path parent = fs::canonical((root / path).parent_path(), error);
        if (error) continue;  // its folder is gone already
        const auto differ =
            std::mismatch(inside.begin(), inside.end(), parent.begin(), parent.end());
        if (differ.first != inside.end()) continue;
        if (fs::is_regular_file(root / path, error)) fs::remove(root / path, error);
    }
}

TONEWRIGHT_NAMESPACE_END
