// SPDX-License-Identifier: Apache-2.0
#include "tasks/import.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <vector>

#include "unit/errors.h"
#include "unit/folder.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

TEST(ImportOperator, NamesTheBuiltInOperator) {
    const Folder folder;
    write(folder / "a.glsl", "vec3 f(vec3 x) { return x / (x + 1.0); }");
    const ImportResult result = import_operator(folder / "a.glsl", {}, folder / "a.tone", {});
    EXPECT_EQ(read(folder / "a.tone"), result.shader.definition);
    EXPECT_NE(std::find(result.equals.begin(), result.equals.end(), "reinhard"),
              result.equals.end());
}

TEST(ImportOperator, WarnsOfABrightMidGrayBeforeItWrites) {
    const Folder folder;
    write(folder / "a.glsl", "vec3 f(vec3 x) { return 3.0 * x / (3.0 * x + 0.4); }");
    const Listener refuses = {.warn = [](const std::string& line) { throw Error(line); }};
    const auto import_with = [&](const ShaderImport& settings) {
        return error_of([&] {
            (void)import_operator(folder / "a.glsl", settings, folder / "a.tone", refuses);
        });
    };
    EXPECT_NE(import_with({}).find("encoded=srgb"), std::string::npos) << import_with({});
    EXPECT_EQ(folder.files(), (std::vector<std::string>{"a.glsl"}));
    ShaderImport settings;
    settings.output = ShaderImport::Output::display_linear;
    EXPECT_EQ(import_with(settings), "no error");
}

}  // namespace
TONEWRIGHT_NAMESPACE_END
