// SPDX-License-Identifier: Apache-2.0
#include "tasks/report.h"

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "tonewright/registry.h"
#include "unit/errors.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

ReportRequest request_for(const std::vector<const char*>& operators) {
    ReportRequest request;
    for (const char* op : operators)
        request.operators.push_back(resolve_picture_operator(op));
    request.read_picture = [](const std::string& path, const std::vector<ResolvedOperator>& local) {
        return ReportPicture{.name = path,
                             .width = 2,
                             .height = 1,
                             .exr = "exr",
                             .rgb = {0, 0.5F, 1, 2, 4, 8},
                             .shown = std::vector<std::string>(local.size(), "png")};
    };
    request.has_parity = false;
    return request;
}

TEST(ReportTask, PageIsOneFileOfTheSameBytes) {
    const ReportRequest request = request_for({"hable"});
    const std::string page = make_report(request);
    EXPECT_TRUE(page.starts_with("<!doctype html>") || page.starts_with("<!DOCTYPE html>"));
    EXPECT_EQ(page, make_report(request));
    EXPECT_EQ(page, make_report(request_for({"hable", "hable", "false_color"}))) << "each once";
}

TEST(ReportTask, PicturesAreReadWithLocalOperators) {
    ReportRequest request = request_for({"reinhard_local", "reinhard_local"});
    request.pictures = {"a.exr", "b.exr"};
    std::vector<std::string> calls;
    const auto read = request.read_picture;
    request.read_picture = [&](const std::string& path,
                               const std::vector<ResolvedOperator>& local) {
        calls.push_back(path + " " + std::to_string(local.size()));
        return read(path, local);
    };
    EXPECT_FALSE(make_report(request).empty());
    EXPECT_EQ(calls, (std::vector<std::string>{"a.exr 1", "b.exr 1"}));
    calls.clear();
    request.pictures.clear();
    EXPECT_FALSE(make_report(request).empty());
    EXPECT_EQ(calls, std::vector<std::string>{" 1"}) << "the chart";
}

TEST(ReportTask, ShadersRunForTheParityTableOnly) {
    ReportRequest request = request_for({"hable"});
    request.shader_runs = []() -> std::vector<LanguageRun> { throw Error("shaders run"); };
    EXPECT_FALSE(make_report(request).empty());
    request.has_parity = true;
    EXPECT_EQ(error_of([&] { (void)make_report(request); }), "shaders run");
}

TEST(ReportTask, AllOperatorsAreBuiltInOnes) {
    EXPECT_EQ(report_operators(false).size(), all_operators().size() + local_operators().size());
    EXPECT_EQ(report_operators(true).size(), all_variants().size() + local_operators().size());
}

}  // namespace
TONEWRIGHT_NAMESPACE_END
