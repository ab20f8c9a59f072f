// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include "unit/lut/lut_cases.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

const Expr kX = Expr::input();

TEST(WriteClf, HasTheVersionOfOneFormat) {
    // OCIO refuses a file with both.
    std::string extension;
    const std::string clf = half_table(kX, false, &extension);
    EXPECT_EQ(extension, ".clf");
    EXPECT_NE(clf.find(" compCLFversion=\"3\">"), std::string::npos);
    EXPECT_EQ(clf.find(" version=\"1.4\""), std::string::npos);
    EXPECT_EQ(clf.find("hueAdjust"), std::string::npos) << "CLF has no such attribute";

    const std::string ctf = half_table(kX, true, &extension);
    EXPECT_EQ(extension, ".ctf");
    EXPECT_NE(ctf.find(" name=\"a &lt; b\" version=\"1.4\">"), std::string::npos);
    EXPECT_EQ(ctf.find("compCLFversion"), std::string::npos);
    EXPECT_NE(ctf.find("halfDomain=\"true\" hueAdjust=\"dw3\""), std::string::npos);
    EXPECT_NE(ctf.find("<Description>one &amp; two</Description>"), std::string::npos);
}

}  // namespace
TONEWRIGHT_NAMESPACE_END
