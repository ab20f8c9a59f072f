// SPDX-License-Identifier: Apache-2.0
#include "tonewright/error.h"

#include <gtest/gtest.h>

#include <cerrno>
#include <new>
#include <optional>
#include <stdexcept>
#include <string>
#include <system_error>

#include "base/atomic_file.h"
#include "base/input_file.h"
#include "base/strings.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

using Kind = Problem::Kind;

/// The command's style.
constexpr MessageStyle kOptions = {[](std::string_view name) { return "--" + std::string(name); },
                                   [](std::string_view name, std::string_view value) {
                                       return "--" + std::string(name) +
                                              (value.empty() ? "" : " " + std::string(value));
                                   }};
/// Python's style.
constexpr MessageStyle kArguments = {[](std::string_view name) { return std::string(name); },
                                     [](std::string_view name, std::string_view value) {
                                         return std::string(name) + "=" + std::string(value);
                                     }};

TEST(Problem, IsOneLine) {
    EXPECT_EQ(render(Problem{.parameter = "size", .value = "1", .expected = "[2, 129]"}),
              "size is 1; expected [2, 129]");
    EXPECT_EQ(render(Problem{.parameter = "format",
                             .value = "cub",
                             .expected = "cube or clf",
                             .suggestion = "cube"}),
              "format is cub; expected cube or clf; did you mean cube?");
    EXPECT_EQ(render(Problem{.what = "hable", .parameter = "white", .value = "-1"}),
              "hable: white is -1");
    EXPECT_EQ(render(Problem{.what = "a.exr", .value = "is a folder"}), "a.exr: is a folder");
    EXPECT_EQ(render(Problem{.value = "picture is deep", .expected = "flat pixels"}),
              "picture is deep; expected flat pixels");
    EXPECT_EQ(render(Problem{.what = "in words of its own"}), "in words of its own");
    EXPECT_EQ(render(Problem{}), "");
}

TEST(Problem, IsRenderedForEachApplication) {
    const Problem problem = {
        .parameter = "max_error", .value = "0", .expected = "above 0, or <<size>>, as <<size=65>>"};
    EXPECT_EQ(render(problem), "max error is 0; expected above 0, or size, as size=65");
    EXPECT_EQ(render(problem, kOptions),
              "--max_error is 0; expected above 0, or --size, as --size 65");
    EXPECT_EQ(render(problem, kArguments),
              "max_error is 0; expected above 0, or size=, as size=65");
}

TEST(Problem, NamesWithinAFileStay) {
    const Problem problem = within(
        "my.tone", {.parameter = "max_error", .value = "0", .expected = "above 0 (<<depth>>)"});
    EXPECT_EQ(render(problem, kOptions), "my.tone: max_error is 0; expected above 0 (--depth)");
    EXPECT_EQ(render(within("read: b", problem)),
              "read: b: my.tone: max_error is 0; expected above 0 (depth)");
}

TEST(References, AreWrittenInTheStyle) {
    EXPECT_EQ(render("take <<size=65>> or <<a_b>>.", kOptions), "take --size 65 or --a_b.");
    EXPECT_EQ(render("<<parameter=k=1>>"), "parameter=k=1");
    EXPECT_EQ(render("a name of <<list=operators>>"), "a name of the list of operators");
    EXPECT_EQ(render("or <<task=apply>>"), "or apply");
}

TEST(References, OtherBracketsStay) {
    for (const char* text :
         {"x << 1", "a<<1>>.exr", "<<", ">>", "<<size", "<<>>", "<<A>>", "[[stage]]"})
        EXPECT_EQ(render(text, kOptions), text);
    EXPECT_EQ(render("<<1>> <<size>>", kOptions), "<<1>> --size");
}

TEST(Error, CarriesItsProblem) {
    const Error error({.parameter = "size", .value = "1", .expected = "2 (<<depth>>)"});
    EXPECT_EQ(error.problem().kind, Kind::usage);
    EXPECT_EQ(error.problem().parameter, "size");
    EXPECT_STREQ(error.what(), "size is 1; expected 2 (depth)");
    EXPECT_EQ(error.text(), "size is 1; expected 2 (<<depth>>)");
    const Error copy = error;
    EXPECT_STREQ(copy.what(), error.what());
    EXPECT_EQ(&copy.problem(), &error.problem());
    EXPECT_STREQ(Error("words").what(), "words");
}

TEST(Error, OfAFileIsNoUsage) {
    EXPECT_EQ(FileError("a.exr: broken").problem().kind, Kind::file);
    EXPECT_EQ(FileError(Problem{.value = "broken"}).problem().kind, Kind::file);
    EXPECT_EQ(FileError(Problem{.kind = Kind::memory, .value = "x"}).problem().kind, Kind::memory);
}

/// The problem that the step throws.
template <class Step>
std::optional<Problem> problem_of(const Step& step) {
    try {
        step();
    } catch (const FileError& e) {
        return e.problem();
    }
    return {};
}

TEST(Error, OfTheSystemHasItsNumber) {
    const auto missing = problem_of([] {
        (void)read_file("/proc/none", 1,
                        [](const Problem& why) { throw FileError(within("read: a", why)); });
    });
    ASSERT_TRUE(missing);
    EXPECT_EQ(missing->kind, Kind::file);
    EXPECT_EQ(missing->error_number, ENOENT);
    EXPECT_EQ(render(*missing), "read: a: No such file or directory");
    const auto no_folder = problem_of([] { write_text_atomically("/proc/none/b", "text"); });
    ASSERT_TRUE(no_folder);
    EXPECT_EQ(no_folder->error_number, ENOENT);
    const auto folder = why_not_readable("/");
    ASSERT_TRUE(folder);
    EXPECT_EQ(folder->error_number, 0);
    EXPECT_EQ(folder->value, "is a folder");
}

TEST(Error, OfMemoryIsOfThatKind) {
    const auto thrown = [](const auto& exception) {
        return problem_of([&] { with_memory_for("a.exr", [&] { throw exception; }); });
    };
    for (const auto& problem : {thrown(std::bad_alloc()), thrown(std::length_error("vector"))}) {
        ASSERT_TRUE(problem);
        EXPECT_EQ(problem->kind, Kind::memory);
        EXPECT_EQ(render(*problem), "a.exr: not enough memory");
    }
    const auto no_thread =
        thrown(std::system_error(std::make_error_code(std::errc::resource_unavailable_try_again)));
    ASSERT_TRUE(no_thread);
    EXPECT_EQ(no_thread->kind, Kind::memory);
}

TEST(Error, OfAnotherLibraryIsAboutMemoryByItsWords) {
    for (const char* text : {"std::bad_alloc", "could not allocate memory", "no memory for 3"}) {
        EXPECT_EQ(problem_of_library(text).kind, Kind::memory) << text;
        EXPECT_EQ(problem_of_library(text).value, "not enough memory") << text;
    }
    EXPECT_EQ(problem_of_library("it is broken\nas said").kind, Kind::usage);
    EXPECT_EQ(problem_of_library("it is broken\nas said").value, "it is broken");
}

TEST(Problem, UnrenderedKeepsItsReferences) {
    const Problem problem = {.parameter = "max_error",
                             .value = "0",
                             .expected = "above 0 (<<size=65>>)",
                             .suggestion = "1"};
    EXPECT_EQ(unrendered(problem),
              "max error is 0; expected above 0 (<<size=65>>); did you mean 1?");
    EXPECT_EQ(unrendered({.what = "a.tone", .value = "is empty"}), "a.tone: is empty");
    EXPECT_EQ(unrendered({}), "");
    // Two steps are one: references of an inner message are written once, by the outer one.
    EXPECT_EQ(render(unrendered(problem)), render(problem));
}

}  // namespace
TONEWRIGHT_NAMESPACE_END
