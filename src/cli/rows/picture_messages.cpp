// SPDX-License-Identifier: Apache-2.0
#include "cli/rows/picture_messages.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <charconv>
#include <cstdio>

#include "cli/messages.h"
#include "picture/result_metadata.h"

TONEWRIGHT_NAMESPACE_BEGIN

QuietStderr::QuietStderr() : saved_(::dup(STDERR_FILENO)) {
    std::fflush(stderr);
    const int nowhere = ::open("/dev/null", O_WRONLY | O_CLOEXEC);
    if (saved_ >= 0 && nowhere >= 0) ::dup2(nowhere, STDERR_FILENO);
    if (nowhere >= 0) ::close(nowhere);
}

QuietStderr::~QuietStderr() {
    std::fflush(stderr);
    if (saved_ < 0) return;
    ::dup2(saved_, STDERR_FILENO);
    ::close(saved_);
}

namespace {

std::string with_name(const std::string& name, const std::string& text) {
    return name.empty() ? text : fmt::format("{}: {}", name, text);
}

bool is_of_number(char c) { return (c >= '0' && c <= '9') || c == '.'; }

std::string without_numbers(std::string text) {
    std::erase_if(text, is_of_number);
    return text;
}

std::vector<double> numbers_of(const std::string& text) {
    std::vector<double> numbers;
    for (std::size_t i = 0; i < text.size(); ++i) {
        if (!is_of_number(text[i])) continue;
        double number = 0;
        const char* const begin = text.data() + i;
        const char* const end =
            std::from_chars(begin, text.data() + text.size(), number, std::chars_format::fixed).ptr;
        numbers.push_back(number);
        if (end > begin) i += static_cast<std::size_t>(end - begin) - 1;
    }
    return numbers;
}

}  // namespace

void PictureMessages::add(std::vector<std::string>& warnings, const std::string& name,
                          const std::string& text) {
    const std::string named = with_name(name, text);
    if (message_options().is_strict) warn(named);  // throws
    // The figures of a shot differ from frame to frame, and one line for all of them is enough: the
    // one of the worst frame, in whatever order the frames end.
    const auto known =
        std::find_if(warnings.begin(), warnings.end(), [&](const std::string& other) {
            return name.empty() ? other == named : without_numbers(other) == without_numbers(named);
        });
    if (known == warnings.end())
        warnings.push_back(named);
    else if (numbers_of(*known) < numbers_of(named))
        *known = named;
}

void PictureMessages::add_finished(const std::string& text, std::size_t at) {
    constexpr std::string_view kColon = ": ";
    const std::string picture = at >= kColon.size() ? text.substr(0, at - kColon.size()) : in_;
    const std::string reason = text.substr(at);
    if (message_options().is_strict) warn(with_name(picture, reason));  // throws
    finished_[reason].insert(picture);
}

void PictureMessages::attach_to(ReadOptions& read) {
    read.warn = [this](const std::string& text) {
        const std::size_t at = text.find(kFinishedPicture);
        at == std::string::npos ? add(reading_, in_, text) : add_finished(text, at);
    };
    read.note = [this](const std::string& text) {
        const std::string named = with_name(in_, text);
        if (std::find(notes_.begin(), notes_.end(), named) == notes_.end()) notes_.push_back(named);
    };
}

void PictureMessages::attach_to(WriteOptions& write) {
    write.warn = [this](const std::string& text) { add(writing_, out_, text); };
}

void PictureMessages::print() {
    if (!message_options().is_quiet) {
        for (const std::string& text : notes_)
            print_message(text);
        for (const auto& [reason, pictures] : finished_) {
            std::string names = *pictures.begin();
            if (pictures.size() > 1) names += fmt::format(" and {} more", pictures.size() - 1);
            warn(fmt::format("{}: {}", names, reason));
        }
    }
    for (const auto* texts : {&reading_, &writing_}) {
        for (const std::string& text : *texts)
            warn(text);
    }
}

TONEWRIGHT_NAMESPACE_END
