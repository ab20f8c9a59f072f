// SPDX-License-Identifier: Apache-2.0
#include "tasks/exact_files.h"

#include <gtest/gtest.h>

#include <vector>

#include "tonewright/registry.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

std::vector<ExactFile> files_of(const char* op, const char* application) {
    BakeRequest request;
    request.op = resolve_operator(op);
    request.size = 2;  // does not count
    return ExactFiles(request).of(find_lut_application(application));
}

TEST(ExactFiles, CurveIsExactAsATable) {
    const std::vector<ExactFile> files = files_of("reinhard", "nuke");
    ASSERT_GE(files.size(), 2U);
    EXPECT_LT(files[0].error, 1e-4);
    for (std::size_t i = 1; i < files.size(); ++i)
        EXPECT_LE(files[i - 1].error, files[i].error);
    EXPECT_EQ(files.back().extension, ".cube");
    EXPECT_GT(files.back().error, 0) << "a grid";
}

TEST(ExactFiles, ShaderComputesTheNodesOfAGrid) {
    const std::vector<ExactFile> files = files_of("agx_blender", "unity");
    ASSERT_EQ(files.size(), 2U);
    const ExactFile& shader = files[files[0].is_shader ? 0 : 1];
    EXPECT_TRUE(shader.is_shader);
    EXPECT_GT(shader.error, 0);
    EXPECT_LT(shader.error, 1e-5) << "float, without a texture";
}

}  // namespace
TONEWRIGHT_NAMESPACE_END
