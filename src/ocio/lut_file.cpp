// SPDX-License-Identifier: Apache-2.0
#include "tonewright/lut_file.h"

#include <fmt/format.h>
#include <stdlib.h>  // mkstemps()
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstdio>
#include <filesystem>
#include <functional>
#include <map>
#include <mutex>
#include <optional>

#include "base/atomic_file.h"
#include "base/input_file.h"
#include "base/strings.h"
#include "lut/dds.h"
#include "lut/icc.h"
#include "lut/lut_text.h"
#include "lut/raw.h"
#include "lut/table_file.h"
#include "ocio/lut_transforms.h"
#include "ocio/transforms.h"
#include "tonewright/lut.h"
#include "tonewright/lut_applications.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

namespace fs = std::filesystem;

bool is_device_link(const std::string& extension) {
    return extension == ".icc" || extension == ".icm";
}

void check_extension(const std::string& path) {
    const std::string extension = extension_of(path);
    std::vector<std::string> known = lut_text_extensions();
    known.insert(known.end(), {".icc", ".icm", ".raw", ".dds"});
    if (std::find(known.begin(), known.end(), extension) != known.end()) return;
    known.emplace_back("a picture's");
    throw FileError(fmt::format("read: {}: extension is {}; expected {}", path,
                                extension.empty() ? "missing" : extension, join_choices(known)));
}

/// OpenColorIO's message about the file in one line, without its search for a format.
std::string reason_of(const OCIO::Exception& e, const std::string& path) {
    std::string what = e.what();
    constexpr std::string_view kFound = "' failed with: ";
    if (const std::size_t at = what.rfind(kFound); at != std::string::npos)
        what.erase(0, at + kFound.size());
    for (const std::string& own : {path + ": ", "(" + path + "). ", "(" + path + ") "}) {
        if (const std::size_t at = what.find(own); at != std::string::npos)
            what.erase(at, own.size());
    }
    return printable(what, 400);
}

/// Default for any file.
void set_interpolation(const OCIO::GroupTransformRcPtr& group, OCIO::Interpolation interpolation) {
    for (int i = 0; i < group->getNumTransforms(); ++i) {
        const OCIO::TransformRcPtr transform = group->getTransform(i);
        if (const auto cube = OCIO_DYNAMIC_POINTER_CAST<OCIO::Lut3DTransform>(transform)) {
            cube->setInterpolation(interpolation);
        } else if (const auto inner = OCIO_DYNAMIC_POINTER_CAST<OCIO::GroupTransform>(transform)) {
            set_interpolation(inner, interpolation);
        }
    }
}

/// Maps a range to [0, 1].
OCIO::TransformRcPtr scale_range(const CubeText::Table& table) {
    const OCIO::MatrixTransformRcPtr matrix = OCIO::MatrixTransform::Create();
    std::array<double, 16> m{};
    std::array<double, 4> offset{};
    for (std::size_t c = 0; c < 3; ++c) {
        m[5 * c] = 1 / (table.hi[c] - table.lo[c]);
        offset[c] = -table.lo[c] / (table.hi[c] - table.lo[c]);
    }
    m[15] = 1;
    matrix->setMatrix(m.data());
    matrix->setOffset(offset.data());
    return matrix;
}

OCIO::GroupTransformRcPtr group_of(const CubeText& file) {
    OCIO::GroupTransformRcPtr group = OCIO::GroupTransform::Create();
    if (const auto n = static_cast<unsigned long>(file.table.size); n > 0) {
        const OCIO::Lut1DTransformRcPtr table = OCIO::Lut1DTransform::Create();
        table->setLength(n);
        table->setInterpolation(OCIO::INTERP_LINEAR);
        const float* row = file.table.rows.data();
        for (unsigned long i = 0; i < n; ++i, row += 3)
            table->setValue(i, row[0], row[1], row[2]);
        group->appendTransform(scale_range(file.table));
        group->appendTransform(table);
    }
    if (const auto n = static_cast<unsigned long>(file.cube.size); n > 0) {
        const OCIO::Lut3DTransformRcPtr cube = OCIO::Lut3DTransform::Create();
        cube->setGridSize(n);
        cube->setInterpolation(OCIO::INTERP_TETRAHEDRAL);
        const float* row = file.cube.rows.data();
        for (unsigned long b = 0; b < n; ++b) {
            for (unsigned long g = 0; g < n; ++g) {
                for (unsigned long r = 0; r < n; ++r, row += 3)
                    cube->setValue(r, g, b, row[0], row[1], row[2]);
            }
        }
        group->appendTransform(scale_range(file.cube));
        group->appendTransform(cube);
    }
    return group;
}

/// Temporary file with the validated bytes, while OpenColorIO reads it.
///
/// OpenColorIO caches files by name for the whole process. It would not see that a file has
/// changed, and clearing its cache would clear that of the application. Therefore the name is a
/// hash of the bytes. OpenColorIO caches equal bytes once, and parses exactly the validated ones.
class PrivateCopy {
  public:
    /// @throws FileError  names `path`, the source of the bytes.
    PrivateCopy(const std::string& path, const std::string& bytes) {
        std::error_code error;
        const fs::path folder = fs::temp_directory_path(error);
        const std::string extension = extension_of(path);
        std::string unfinished = (folder / ("tonewright-XXXXXX" + extension)).string();
        path_ = (folder / fmt::format("tonewright-{}-{:x}-{:x}{}", ::getpid(),
                                      std::hash<std::string>()(bytes), bytes.size(), extension))
                    .string();
        if (!error) error.assign(write(unfinished, bytes), std::generic_category());
        if (error) {
            throw FileError("read: " + path + ": the temporary copy " + unfinished +
                            " cannot be written: " + error.message());
        }
    }
    ~PrivateCopy() {
        const std::lock_guard lock(mutex_);
        if (--users_[path_] > 0) return;
        users_.erase(path_);
        ::unlink(path_.c_str());
    }
    PrivateCopy(const PrivateCopy&) = delete;
    PrivateCopy& operator=(const PrivateCopy&) = delete;

    [[nodiscard]] const std::string& path() const { return path_; }

  private:
    /// @param unfinished  a pattern, replaced by the initial name of the file
    /// @returns  0 or an errno.
    [[nodiscard]] int write(std::string& unfinished, const std::string& bytes) const {
        const int extension = static_cast<int>(fs::path(unfinished).extension().string().size());
        const int file = ::mkstemps(unfinished.data(), extension);
        if (file < 0) return errno;
        int error = 0;
        for (std::size_t written = 0; written < bytes.size() && !error;) {
            const ssize_t n = ::write(file, bytes.data() + written, bytes.size() - written);
            if (n > 0) written += static_cast<std::size_t>(n);
            if (n < 0 && errno != EINTR) error = errno;
        }
        if (::close(file) != 0 && !error) error = errno;
        // Threads that read equal bytes at the same time share one file.
        const std::lock_guard lock(mutex_);
        if (!error && !users_.contains(path_) &&
            std::rename(unfinished.c_str(), path_.c_str()) != 0)
            error = errno;
        if (!error) ++users_[path_];
        if (error || users_[path_] > 1) ::unlink(unfinished.c_str());
        return error;
    }

    static inline std::mutex mutex_;
    static inline std::map<std::string, int> users_;  // of the files that there are now
    std::string path_;
};

OCIO::GroupTransformRcPtr group_of(const std::string& path) {
    const OCIO::FileTransformRcPtr file = OCIO::FileTransform::Create();
    file->setSrc(path.c_str());
    // Tetrahedral for a 3D LUT, linear for a 1D LUT, without a warning for either.
    file->setInterpolation(OCIO::INTERP_BEST);
    OCIO::GroupTransformRcPtr group = OCIO::GroupTransform::Create();
    group->appendTransform(file);
    return group;
}

/// @param name  of the file for OpenColorIO
OcioCpu make_cpu(const std::string& path, const std::string& name, OCIO::GroupTransformRcPtr group,
                 LutInterpolation interpolation) {
    try {
        OCIO::ConstProcessorRcPtr processor = make_processor(group);
        if (interpolation != LutInterpolation::automatic) {
            group = processor->createGroupTransform();
            set_interpolation(group, interpolation == LutInterpolation::trilinear
                                         ? OCIO::INTERP_LINEAR
                                         : OCIO::INTERP_TETRAHEDRAL);
            processor = make_processor(group);
        }
        return {processor, OCIO::OPTIMIZATION_LOSSLESS};
    } catch (const OCIO::Exception& e) {
        throw FileError("read: " + path + ": " + reason_of(e, name));
    }
}

std::string checked_bytes(const std::string& path) {
    require_regular_file(path);
    check_extension(path);
    return read_file(path, kLargestLutFile,
                     [&](const Problem& why) { throw FileError(within("read: " + path, why)); });
}

}  // namespace

OCIO::ConstGroupTransformRcPtr lut_transforms(const std::string& path, std::string& contents,
                                              std::string& note) {
    contents = checked_bytes(path);
    note = check_lut_text(path, contents);
    const PrivateCopy copy(path, contents);
    try {
        return make_processor(group_of(copy.path()))->createGroupTransform();
    } catch (const OCIO::Exception& e) {
        throw FileError("read: " + path + ": " + reason_of(e, copy.path()));
    }
}

void silence_opencolorio() { OCIO::SetLoggingLevel(OCIO::LOGGING_LEVEL_NONE); }

LutInterpolation parse_lut_interpolation(std::string_view text) {
    return static_cast<LutInterpolation>(
        find_choice("interpolation", text, {"auto", "tetrahedral", "trilinear"}));
}

struct LutFile::Form {
    std::optional<OcioCpu> ocio;
    std::optional<DeviceLink> link;
    std::optional<Lut> table;
    LutInterpolation interpolation = LutInterpolation::automatic;
    std::string note;
};

LutFile::LutFile(const std::string& path, LutInterpolation interpolation) {
    auto form = std::make_unique<Form>();
    form->interpolation = interpolation;
    const std::string extension = extension_of(path);
    std::string bytes = checked_bytes(path);
    if (is_device_link(extension)) {
        if (interpolation == LutInterpolation::trilinear) {
            throw Error("interpolation is trilinear; expected tetrahedral for " + path +
                        ", an ICC device link");
        }
        form->link.emplace(path, bytes);
    } else if (extension == ".raw") {
        form->table = parse_raw_lut(path, bytes);
    } else if (extension == ".dds") {
        form->table = parse_dds(path, bytes);
    } else {
        if (is_parsed_here(extension)) {
            const CubeText cube = parse_cube(path, bytes);
            form->note = cube.note;
            form->ocio.emplace(make_cpu(path, path, group_of(cube), interpolation));
        } else {
            form->note = check_lut_text(path, bytes);
            const PrivateCopy copy(path, bytes);
            form->ocio.emplace(make_cpu(path, copy.path(), group_of(copy.path()), interpolation));
        }
    }
    form_ = std::move(form);
}

LutFile::LutFile(Lut table, LutInterpolation interpolation) {
    auto form = std::make_unique<Form>();
    form->interpolation = interpolation;
    form->table = std::move(table);
    form_ = std::move(form);
}
LutFile::~LutFile() = default;
LutFile::LutFile(LutFile&&) noexcept = default;
LutFile& LutFile::operator=(LutFile&&) noexcept = default;

const std::string& LutFile::note() const { return form_->note; }

void LutFile::run_rgb(const float* in, float* out, std::size_t count) const {
    if (form_->ocio) {
        form_->ocio->run_rgb(in, out, count);
    } else if (form_->link) {
        form_->link->run_rgb(in, out, count);
    } else {
        for (std::size_t i = 0; i < 3 * count; i += 3) {
            const Vector3 shown =
                interpolate(*form_->table,
                            {static_cast<double>(in[i]), static_cast<double>(in[i + 1]),
                             static_cast<double>(in[i + 2])},
                            form_->interpolation);
            for (std::size_t c = 0; c < 3; ++c)
                out[i + c] = static_cast<float>(shown[c]);
        }
    }
}

TONEWRIGHT_NAMESPACE_END
