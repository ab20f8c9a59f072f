// SPDX-License-Identifier: Apache-2.0
#include "tonewright/error.h"

#include <algorithm>
#include <new>
#include <utility>

#include "base/problem.h"
#include "base/strings.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

constexpr std::string_view kBegin = "<<";
constexpr std::string_view kEnd = ">>";

std::string setting(const MessageStyle& style, std::string_view name, std::string_view value) {
    if (style.setting) return style.setting(name, value);
    if (name == "list") return "the list of " + std::string(value);
    if (name == "task") return std::string(value);
    std::string text(name);
    if (!value.empty()) text.append("=").append(value);
    return text;
}

bool is_name(std::string_view text) {
    return !text.empty() && std::all_of(text.begin(), text.end(),
                                        [](char c) { return (c >= 'a' && c <= 'z') || c == '_'; });
}

Problem of_file(Problem problem) {
    if (problem.kind == Problem::Kind::usage) problem.kind = Problem::Kind::file;
    return problem;
}

}  // namespace

std::string render(std::string_view text, const MessageStyle& style) {
    std::string result;
    for (;;) {
        const std::size_t begin = std::min(text.find(kBegin), text.size());
        const std::size_t end = text.find(kEnd, begin);
        if (end == std::string_view::npos) return result.append(text);
        const std::string_view inside =
            text.substr(begin + kBegin.size(), end - begin - kBegin.size());
        const std::size_t equals = std::min(inside.find('='), inside.size());
        const std::string_view name = inside.substr(0, equals);
        result.append(text.substr(0, begin));
        if (is_name(name)) {
            result.append(setting(style, name, inside.substr(std::min(equals + 1, inside.size()))));
            text.remove_prefix(end + kEnd.size());
        } else {  // signs of a formula, or of a file's name
            result.append(kBegin);
            text.remove_prefix(begin + kBegin.size());
        }
    }
}

std::string render(const Problem& problem, const MessageStyle& style) {
    // A name within a file or an operator is the same everywhere.
    if (!problem.what.empty() || problem.parameter.empty() || !style.name)
        return render(unrendered(problem), style);
    Problem named = problem;
    named.parameter.clear();
    return style.name(problem.parameter) + " is " + render(unrendered(named), style);
}

std::string unrendered(const Problem& problem) {
    std::string text = problem.what;
    if (!text.empty() && !(problem.parameter.empty() && problem.value.empty())) text += ": ";
    if (!problem.parameter.empty()) {
        std::string name = problem.parameter;
        if (problem.what.empty()) std::replace(name.begin(), name.end(), '_', ' ');
        text += name + " is ";
    }
    text += problem.value;
    if (!problem.expected.empty()) text += "; expected " + problem.expected;
    if (!problem.suggestion.empty()) text += "; did you mean " + problem.suggestion + "?";
    return text;
}

Problem within(std::string_view what, Problem problem) {
    std::string place(what);
    if (!problem.what.empty()) place.append(": ").append(problem.what);
    problem.what = std::move(place);
    return problem;
}

Error::Error(Problem problem)
    : std::runtime_error(render(problem)),
      problem_(std::make_shared<const Problem>(std::move(problem))) {}

Problem problem_of(const std::exception& error) {
    if (const auto* own = dynamic_cast<const Error*>(&error)) return own->problem();
    if (dynamic_cast<const std::bad_alloc*>(&error))
        return {.kind = Problem::Kind::memory, .what = "not enough memory"};
    return {.kind = Problem::Kind::internal, .what = one_line(error.what())};
}

void throw_problem(const Problem& problem) {
    if (problem.kind == Problem::Kind::file || problem.kind == Problem::Kind::memory)
        throw FileError(problem);
    throw Error(problem);
}

FileError::FileError(Problem problem) : Error(of_file(std::move(problem))) {}

TONEWRIGHT_NAMESPACE_END
