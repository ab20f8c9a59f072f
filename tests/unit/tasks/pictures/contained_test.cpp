// SPDX-License-Identifier: Apache-2.0
#include "tasks/pictures/contained.h"

#include <OpenImageIO/imageio.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <csignal>
#include <string>
#include <vector>

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

std::vector<ContainedResult> results_of(std::size_t count, double seconds,
                                        const std::function<std::string(std::size_t)>& work) {
    std::vector<std::string> names;
    for (std::size_t i = 0; i < count; ++i)
        names.push_back("picture " + std::to_string(i));
    std::vector<ContainedResult> results(count);
    run_contained(names, 2, seconds, work,
                  [&](std::size_t i, const ContainedResult& result) { results[i] = result; });
    return results;
}

TEST(Contained, ValuesArriveWithTheirNumbers) {
    const std::string zero("a\0b", 3);
    const auto results = results_of(5, 60, [&](std::size_t i) { return std::to_string(i) + zero; });
    for (std::size_t i = 0; i < results.size(); ++i) {
        EXPECT_FALSE(results[i].problem);
        EXPECT_EQ(results[i].value, std::to_string(i) + zero);
    }
}

TEST(Contained, ProblemsArriveAsRecords) {
    const Problem sent = {.kind = Problem::Kind::check,
                          .what = "a.exr",
                          .parameter = "size",
                          .value = "3",
                          .expected = "<<other=4>>",
                          .suggestion = "4",
                          .error_number = 13};
    const auto results = results_of(1, 60, [&](std::size_t) -> std::string { throw Error(sent); });
    ASSERT_TRUE(results[0].problem);
    EXPECT_EQ(results[0].problem->kind, Problem::Kind::check);
    EXPECT_EQ(unrendered(*results[0].problem), unrendered(sent));
    EXPECT_EQ(results[0].problem->parameter, "size");
    EXPECT_EQ(results[0].problem->error_number, 13);
}

TEST(Contained, CrashesAndHangsStopNoOther) {
    const auto results = results_of(4, 8, [](std::size_t i) -> std::string {
        if (i == 0) ::raise(SIGKILL);
        if (i == 1) ::_exit(5);
        if (i == 2) ::pause();
        return "done";
    });
    for (std::size_t i = 0; i < 3; ++i) {
        ASSERT_TRUE(results[i].problem) << i;
        EXPECT_EQ(results[i].problem->kind, Problem::Kind::file);
    }
    EXPECT_TRUE(results[0].problem->what.starts_with("picture 0: the process crashed (signal 9"))
        << results[0].problem->what;
    EXPECT_EQ(results[1].problem->what, "picture 1: the process ended early (exit code 5)");
    EXPECT_EQ(results[2].problem->what, "picture 2: no result after 8 s (<<timeout>>)");
    EXPECT_EQ(results[3].value, "done");
}

TEST(Contained, ThreadsAreThoseOfOpenImageIO) {
    const int before = OIIO::get_int_attribute("threads");
    set_picture_threads(3);
    EXPECT_EQ(OIIO::get_int_attribute("threads"), 3);
    EXPECT_EQ(OIIO::get_int_attribute("exr_threads"), 3);
    set_picture_threads(before);
}

}  // namespace
TONEWRIGHT_NAMESPACE_END
