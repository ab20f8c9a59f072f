// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <string>

#include "lut/lut_text.h"
#include "tonewright/error.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

std::string error_of(const std::string& path, std::string text) {
    try {
        (void)check_lut_text(path, text);
    } catch (const FileError& e) {
        const std::string begin = "read: " + path + ": ";
        return std::string(e.what()).substr(begin.size());
    }
    return "";
}

std::string error_in(const std::string& elements) {
    return error_of("a.clf", "<ProcessList>\n" + elements + "</ProcessList>\n");
}

TEST(Clf, ArraysHaveTheirDeclaredNumbers) {
    EXPECT_EQ(error_in("<LUT1D><Array dim=\"2 1\">0 1</Array></LUT1D>"), "");
    EXPECT_EQ(error_in("<lut1d><ARRAY DIM=\"2 1\">0 1</ARRAY></lut1d>"), "") << "in any case";
    EXPECT_EQ(error_in("<LUT1D><Array dim=\"2 1\">\n0\n</Array></LUT1D>"),
              "line 4: the Array has 1 numbers; expected 2");
    EXPECT_EQ(error_in("<LUT1D><Array dim=\"2 1\">0\n1\n2</Array></LUT1D>"),
              "line 4: the Array has more than 2 numbers; expected 2");
    EXPECT_EQ(error_in("<LUT1D><Array dim=\"2 1\">0\nx</Array></LUT1D>"),
              "line 3: number is x; expected a number");
    EXPECT_EQ(error_in("<LUT1D><Array dim=\"2 1\"/></LUT1D>"),
              "line 2: the Array has 0 numbers; expected 2");
    EXPECT_EQ(error_in("<Matrix><IndexMap dim=\"2\">0@0</IndexMap></Matrix>"),
              "line 2: IndexMap has 1 entries; expected 2");
}

TEST(Clf, OnlyHalfDomainsHoldInfinities) {
    EXPECT_EQ(error_in("<LUT1D halfDomain=\"true\"><Array dim=\"2 1\">inf nan</Array></LUT1D>"),
              "");
    EXPECT_EQ(error_in("<LUT1D><Array dim=\"2 1\">0 inf</Array></LUT1D>"),
              "line 2: number is inf; expected a finite number");
    EXPECT_EQ(error_in("<Range><minInValue> 1e99 </minInValue></Range>"),
              "line 2: minInValue is 1e99; expected a finite number");
}

TEST(Clf, SizesAreLimitedBeforeAnythingIsRead) {
    const auto error_of_size = [](const std::string& parent, const std::string& dim) {
        return error_in("<" + parent + "><Array dim=\"" + dim + "\"></Array></" + parent + ">");
    };
    EXPECT_EQ(error_of_size("LUT3D", "200 200 200 3"),
              "line 2: dim is 200 200 200 3; expected N N N 3 with N in [2, 129]");
    EXPECT_EQ(error_of_size("LUT1D", "900000000 1"),
              "line 2: dim is 900000000 1; expected numbers of at most 1048576");
    EXPECT_EQ(error_of_size("LUT1D", ""),
              "line 2: dim is empty; expected one to four whole numbers above 0");
    EXPECT_EQ(error_of_size("Matrix", "9 9"),
              "line 2: dim is 9 9; expected a matrix's, such as 3 3");
    EXPECT_EQ(error_of_size("Info", "2 1"),
              "line 2: Array is inside Info; expected LUT1D, LUT3D, InverseLUT1D, InverseLUT3D or "
              "Matrix");
    EXPECT_EQ(error_in("<LUT1D><Array>0 1</Array></LUT1D>"),
              "line 2: Array has no dim; expected dim=\"...\"");
}

TEST(Clf, NumbersStandAlone) {
    // OpenColorIO joins the text around these.
    const std::string error = " has a tag, comment or reference in it; expected numbers";
    for (const char* inside :
         {"0 1<Foo/> 5", "<!-- c -->0 1", "0 1<?pi?>", "0 &#49;", "0 1<!-- c -->"}) {
        EXPECT_EQ(error_in("<LUT1D><Array dim=\"2 1\">" + std::string(inside) + "</Array></LUT1D>"),
                  "line 2: Array" + error)
            << inside;
    }
    EXPECT_EQ(error_in("<SOPNode><Slope>1 1 <!-- c -->1e99</Slope></SOPNode>"),
              "line 2: Slope" + error);
    EXPECT_EQ(error_in("<Matrix><IndexMap dim=\"1\">0@0<a/></IndexMap></Matrix>"),
              "line 2: IndexMap" + error);
    EXPECT_EQ(error_in("<!-- c --><LUT1D><Array dim=\"2 1\">0 1</Array><!-- c --></LUT1D>"), "");
}

TEST(Clf, OtherFilesAreNotOpened) {
    EXPECT_EQ(error_in("<Reference path=\"/etc/passwd\"/>"),
              "line 2: Reference is not supported; expected the transform itself");
    EXPECT_EQ(error_of("a.cc", "<ProcessList/>"),
              "line 1: <ProcessList> is the first element; expected ColorCorrection");
}

}  // namespace
TONEWRIGHT_NAMESPACE_END
