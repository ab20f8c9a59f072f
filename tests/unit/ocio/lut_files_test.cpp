// SPDX-License-Identifier: Apache-2.0
//
// The numbers of LUT files, as OpenColorIO reads them.
#include <gtest/gtest.h>

#include <algorithm>

#include "lut/clf.h"
#include "lut/half_domain.h"
#include "measure/sample_set.h"
#include "ocio/gpu.h"
#include "ocio/transforms.h"
#include "tonewright/engine.h"
#include "unit/folder.h"
#include "unit/ocio/lowered_forms.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

const Expr kX = Expr::input();

/// OpenColorIO's results for colors with a table from a file.
std::vector<float> through_file(const ClfTable& table, std::vector<float> rgb) {
    const Folder folder;
    const std::string path = folder / (std::string("table") + file_extension(table));
    write(path, write_clf(table, "table", {"a test"}));
    const OCIO::FileTransformRcPtr file = OCIO::FileTransform::Create();
    file->setSrc(path.c_str());
    file->setInterpolation(table.dimension == 3 ? OCIO::INTERP_TETRAHEDRAL : OCIO::INTERP_LINEAR);
    OcioCpu(make_processor(file)).run_rgb(rgb.data(), rgb.data(), rgb.size() / 3);
    OCIO::ClearAllCaches();
    return rgb;
}

TEST(LutFileNumbers, AreReadBackByOpenColorIO) {
    const Expr f = kX / (1 + kX);
    std::vector<float> values = sample_half_domain(f, 0, 4);
    const std::vector<signed char> slack = unused_entries(values, 0, 4);
    std::vector<float> in;
    for (const float x : positive_colors())
        in.push_back(std::min(x, 4.0F));
    ClfTable table;
    table.size = 65536;
    table.is_half_domain = true;
    table.values = values;
    table.slack = slack;
    table.numbers = ClfTable::Numbers::compact;
    const std::string text = write_clf(table, "table", {});
    EXPECT_NE(text.find("<Matrix"), std::string::npos) << "of a power of two";
    for (const bool is_ctf : {false, true}) {
        table.is_ctf = is_ctf;
        const std::vector<float> out = through_file(table, in);
        for (std::size_t i = 0; i < in.size(); ++i) {
            const double x = static_cast<double>(in[i]);
            EXPECT_NEAR(static_cast<double>(out[i]), x / (1 + x), 2e-7) << x;
        }
    }
}

TEST(LutFileNumbers, WholeOnesOfACubeAreReadBack) {
    const std::vector<float> nodes = {0, 0, 0, 0, 0, 1, 0, 1, 0, 0, 1, 1,
                                      1, 0, 0, 1, 0, 1, 1, 1, 0, 1, 1, 1};
    ClfTable table;
    table.dimension = 3;
    table.size = 2;
    table.channels = 3;
    table.values = nodes;
    table.numbers = ClfTable::Numbers::multiples;
    table.unit = 1e-4;
    EXPECT_NE(write_clf(table, "cube", {}).find("\n1e4 0 1e4\n"), std::string::npos);
    const std::vector<float> in = {0.25F, 0.5F, 1, 0, 0.125F, 0.75F};
    const std::vector<float> out = through_file(table, in);
    for (std::size_t i = 0; i < in.size(); ++i)
        EXPECT_NEAR(static_cast<double>(out[i]), static_cast<double>(in[i]), 2e-7);
}

}  // namespace
TONEWRIGHT_NAMESPACE_END
