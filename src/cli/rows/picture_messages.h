// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "tonewright/picture_options.h"

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

/// Collects warnings and notes about pictures, from several threads, while QuietStderr lives.
/// print() prints each text once, and one line for all pictures that are tone mapped a second time
/// (kFinishedPicture) for the same reason.
class PictureMessages {
  public:
    /// @param in, out  names before each text. Empty: the texts have them.
    explicit PictureMessages(std::string in = {}, std::string out = {})
        : in_(std::move(in)), out_(std::move(out)) {}
    /// Sets callbacks to this object, which must live as long as they do. They throw an Error of
    /// kind `check` for a warning if --strict was given.
    void attach_to(ReadOptions& read);
    void attach_to(WriteOptions& write);
    void print();

  private:
    void add(std::vector<std::string>& warnings, const std::string& name, const std::string& text);
    void add_finished(const std::string& text, std::size_t at);

    std::string in_;
    std::string out_;
    std::vector<std::string> notes_;
    std::vector<std::string> reading_;
    std::vector<std::string> writing_;
    std::map<std::string, std::set<std::string>> finished_;  // pictures, by the reason
};

TONEWRIGHT_NAMESPACE_END
