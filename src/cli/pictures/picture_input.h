// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <OpenImageIO/imagebuf.h>

#include <functional>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "cli/picture_options.h"
#include "tonewright/tonemap.h"

TONEWRIGHT_NAMESPACE_BEGIN

/// Discards standard error while it lives: libraries below OpenImageIO (libpng, libtiff) print
/// their errors themselves, and our one line repeats them. Use one of these at a time.
class QuietStderr {
  public:
    QuietStderr();
    ~QuietStderr();
    QuietStderr(const QuietStderr&) = delete;
    QuietStderr& operator=(const QuietStderr&) = delete;

    /// A copy of the file descriptor of standard error; -1: none.
    [[nodiscard]] int before() const { return saved_; }

  private:
    int saved_;
};

/// True if both names are one file, also through links. False if one does not exist.
[[nodiscard]] bool is_same_file(const std::string& a, const std::string& b);

/// Collects warnings of the library, from several threads, while QuietStderr lives. print() prints
/// each text once.
class Warnings {
  public:
    /// @param name  of the file or the files, before each text
    explicit Warnings(std::string name) : name_(std::move(name)) {}
    /// @throws Error  of kind `check`: --strict was given
    void add(const std::string& text);
    void print();
    /// For WriteOptions.
    [[nodiscard]] std::function<void(const std::string&)> hearer() {
        return [this](const std::string& text) { add(text); };
    }

  private:
    std::string name_;
    std::vector<std::string> texts_;
};

/// Collects lines that say what was decided, as Warnings does. Not with --quiet, and no error with
/// --strict.
class Notes {
  public:
    explicit Notes(std::string name) : name_(std::move(name)) {}
    void add(const std::string& text);
    void print();

  private:
    std::string name_;
    std::vector<std::string> texts_;
};

[[nodiscard]] TonemapOptions::Unpremult alpha_of(const PictureInput& input);

/// Sets the number of threads of OpenImageIO and OpenEXR. With a timeout, does nothing: the
/// processes of the pictures have their own thread pools. @see run_contained
void use_threads(const PictureInput& input);

/// Scene-linear Rec.709 light of a picture with the color `source`.
/// @param reference_white  of absolute sources, cd/m2
/// @throws FileError  a picture that cannot be read
[[nodiscard]] OIIO::ImageBuf to_rec709_light(const OIIO::ImageBuf& picture,
                                             const SourceColor& source, double reference_white,
                                             const std::string& path);

/// The options of the library, without callbacks.
[[nodiscard]] ReadOptions read_options_of(const PictureChoice& choice);

/// @throws Error  --resize is a size that no picture can have
void check_resize(const char* command, const std::string& resize, const PictureChoice& choice);

/// Warns of pictures that are tone mapped a second time (kFinishedPicture): one line for all with
/// the same reason. Not with --quiet, unless --strict was given.
class FinishedPictures {
  public:
    /// @param name  as for Warnings
    explicit FinishedPictures(std::string name) : name_(std::move(name)) {}
    /// False for other texts.
    /// @throws Error  of kind `check`: --strict was given
    [[nodiscard]] bool take(const std::string& text);
    void print();

  private:
    std::string name_;
    std::map<std::string, std::set<std::string>> pictures_;  // by the reason
};

/// Messages of a command about the picture that it reads. print() after QuietStderr has ended.
class ReadMessages {
  public:
    /// @param name  of the picture, or of the pictures
    explicit ReadMessages(const std::string& name)
        : warnings_(name), notes_(name), finished_(name) {}
    /// The options with callbacks to this object, which must live as long as they do.
    [[nodiscard]] ReadOptions hearing(ReadOptions options);
    void print();

  private:
    Warnings warnings_;
    Notes notes_;
    FinishedPictures finished_;
};

/// read_image() with associated alpha, upright, without messages of other libraries on the
/// terminal.
/// @param input  color of the picture, @see TonemapOptions::input; for warnings about its header
[[nodiscard]] OIIO::ImageBuf read_picture(const std::string& path, const PictureChoice& choice = {},
                                          std::string_view input = kAutoInput);

TONEWRIGHT_NAMESPACE_END
