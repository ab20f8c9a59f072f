// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <OpenImageIO/imagebuf.h>

#include <functional>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "cli/picture_options.h"
#include "tonewright/tonemap.h"

TONEWRIGHT_NAMESPACE_BEGIN

/// Standard error leads nowhere while it lives: libraries below OpenImageIO (libpng, libtiff) print
/// their complaints themselves, and the error that comes back says the same in our one line. For a
/// program with one of these at a time.
class QuietStderr {
  public:
    QuietStderr();
    ~QuietStderr();
    QuietStderr(const QuietStderr&) = delete;
    QuietStderr& operator=(const QuietStderr&) = delete;

    /// The file descriptor of what standard error was; -1: none.
    [[nodiscard]] int before() const { return saved_; }

  private:
    int saved_;
};

/// Two names of one file: the same, or through links. False where one does not exist.
[[nodiscard]] bool is_same_file(const std::string& a, const std::string& b);

/// Warnings of the library, which come while QuietStderr lives and from several threads. Each text
/// is printed once, by print().
class Warnings {
  public:
    /// @param name  of the file or the files, before each text
    explicit Warnings(std::string name) : name_(std::move(name)) {}
    /// @throws std::runtime_error  --strict was given
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

[[nodiscard]] TonemapOptions::Unpremult alpha_of(const PictureInput& input);

/// Tells OpenImageIO and OpenEXR how many threads. With a timeout, does nothing: their thread pools
/// belong to the processes of the pictures. @see run_contained
void use_threads(const PictureInput& input);

/// Scene-linear Rec.709 light of a picture whose numbers mean `source`.
/// @throws FileError  a picture that cannot be read
[[nodiscard]] OIIO::ImageBuf to_rec709_light(const OIIO::ImageBuf& picture,
                                             const SourceColor& source, const std::string& path);

/// read_image() with the terminal kept clean.
/// @param max_pixels  of --max-pixels
[[nodiscard]] OIIO::ImageBuf read_picture(const std::string& path,
                                          std::optional<double> max_pixels = {});

TONEWRIGHT_NAMESPACE_END
