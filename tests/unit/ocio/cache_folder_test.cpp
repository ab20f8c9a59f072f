// SPDX-License-Identifier: Apache-2.0
//
// Libraries keep numbers in the folder that the caller names, and nowhere else.
#include <gtest/gtest.h>

#include <cstdlib>
#include <string>

#include "ocio/inverse.h"
#include "ocio/lower.h"
#include "tonewright/registry.h"
#include "unit/folder.h"
#include "unit/shader/requests.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

/// Fits a small 3D LUT. Another size is another fit, which the memory of the process does not have.
void fit_cube_into(const std::string& cache_folder, int edge) {
    const Expr r = Expr::input(0);
    const CrossTalkStage stage = {{r / (r + 1), 0.5 * r + 0.25 * Expr::input(1), Expr::input(2)}};
    (void)lower_to_ocio({ClampStage{0, kInfinity}, stage, ClampStage{0, 1}},
                        {.cube_edge = edge, .fits_cubes = true, .cache_folder = cache_folder});
}

void write_shader_with(const std::string& cache_folder) {
    ShaderRequest request = request_of("reinhard");
    request.cache_folder = cache_folder;
    (void)write_shader(request);
}

TEST(CacheFolder, LibrariesWriteNothingUnasked) {
    const Folder home;
    for (const char* variable : {"HOME", "XDG_CACHE_HOME"})
        setenv(variable, home.path().c_str(), 1);
    write_shader_with("");
    fit_cube_into("", 9);
    (void)invert_light(resolve_operator("agx_blender"), {kRec709, 1});
    EXPECT_EQ(home.files().size(), 0U);

    const Folder own;
    write_shader_with(own.path());
    fit_cube_into(own.path(), 11);
    EXPECT_EQ(home.files().size(), 0U);
    ASSERT_EQ(own.files().size(), 2U);
    EXPECT_EQ(own.files()[0].substr(0, 5), "cube_");
    EXPECT_EQ(own.files()[1].substr(0, 14), "shader_errors_");
}

}  // namespace
TONEWRIGHT_NAMESPACE_END
