// SPDX-License-Identifier: Apache-2.0
#include "lut/formats/xml.h"

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "tonewright/error.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

const std::string kPath = "a.clf";

/// @returns  the message of the error, without the path; empty without one
std::string error_of(const std::string& text) {
    try {
        visit_xml(TextLines(kPath, text), "a", [](const auto&, const auto&) {});
    } catch (const FileError& e) {
        const std::string message = e.what();
        const std::string begin = "read: a.clf: ";
        EXPECT_EQ(message.rfind(begin, 0), 0U) << message;
        return message.substr(begin.size());
    }
    return "";
}

TEST(Xml, ElementsHaveTheirAttributesBodiesAndLines) {
    const std::string text =
        "<?xml version=\"1.0\"?>\n<!-- x -->\n<A Id='1>2'>\n<b\nc=\"&lt;\"> 1 2\n</b><d/></A>\n";
    std::vector<std::string> seen;
    visit_xml(
        TextLines(kPath, text), "a",
        [&](const XmlElement& element, const std::vector<XmlElement>& around) {
            seen.push_back(element.name + std::to_string(around.size()) + " " +
                           std::to_string(element.line) + " " + std::to_string(element.body_line) +
                           " " + std::string(element.body));
            EXPECT_EQ(element.attribute("id").value_or("none"),
                      element.title == "A" ? "1>2" : "none");
            EXPECT_EQ(element.attribute("c").value_or("none"), element.title == "b" ? "<" : "none");
        });
    EXPECT_EQ(seen, (std::vector<std::string>{"b1 4 5  1 2\n", "d1 6 6 ",
                                              "a0 3 3 \n<b\nc=\"&lt;\"> 1 2\n</b><d/>"}));
}

TEST(Xml, EntitiesAreNeverDeclared) {
    const std::string expected = "; expected no document type or entities";
    const std::string laughs = "<!DOCTYPE a [<!ENTITY b \"ha\"><!ENTITY c \"&b;&b;&b;\">]>";
    const std::string use = laughs + "<a>&c;</a>";
    EXPECT_EQ(error_of("<?xml version='1.0'?>\n" + use),
              "line 2: " + use.substr(0, 60) + "..." + expected);
    EXPECT_EQ(error_of("<!DOCTYPE a SYSTEM \"file:///etc/passwd\">\n<a/>"),
              "line 1: <!DOCTYPE a SYSTEM \"file:///etc/passwd\">" + expected);
    EXPECT_EQ(error_of("<a>\n&b;</a>"), "line 2: &b;</a>" + expected);
    EXPECT_EQ(error_of("<a><![CDATA[b]]></a>"), "line 1: <![CDATA[b]]></a>" + expected);
    EXPECT_EQ(error_of("<a>&amp;&#65;</a>"), "") << "these are XML's own";
}

TEST(Xml, WrongFilesAreRefusedInOurWords) {
    struct Case {
        std::string text;
        std::string error;
    };
    const std::vector<Case> cases = {
        {"0 0 0", "line 1: 0 0 0; expected XML, which begins with <"},
        {"<b/>", "line 1: <b> is the first element; expected a"},
        {"<a>\n", "line 2: the file ends; expected </a>"},
        {"<!-- x -->\n", "line 2: the file ends; expected <a>"},
        {"<a>\n<b></a>", "line 2: </a> closes no element; expected </b>"},
        {"</a>", "line 1: </a> closes no element; expected <a>"},
        {"<a/>\n</a>", "line 2: </a> closes no element; expected nothing after the document"},
        {"<a/>\n<a/>", "line 2: <a/>; expected nothing after the document"},
        {"<a>\n<b", "line 2: the tag does not close; expected >"},
        {"<a>\n<b c=\"1\"\n<d/></a>", "line 2: the tag does not close; expected >"},
        {"<a>\n<!-- b", "line 2: the comment does not close; expected -->"},
        {"<a>\n<?b ", "line 2: the instruction does not close; expected ?>"},
        {"<a>\n<b c=1/></a>", "line 2: <b c=1/>; expected attributes such as dim=\"...\""},
        {"<a><1/></a>", "line 1: <1/>; expected a tag such as <Array dim=\"...\">"},
        {"<a b='1' b='2'/>", "line 1: <a b='1' b='2'/>; expected XML (duplicate attribute)"},
        {"<a>b & c</a>", "line 1: & c</a>; expected UTF-8 with &amp; for & and &lt; for <"},
        {"<a>\xff\xfe</a>", "line 1: ?\?</a>; expected UTF-8 with &amp; for & and &lt; for <"},
        {"<a>\x01</a>", "line 1: ?</a>; expected UTF-8 with &amp; for & and &lt; for <"},
        {std::string("<a>\n\0</a>", 9),
         "line 2: the line holds bytes that are not text; expected a text file"},
        {"\n<?xml version='1.0'?><a/>",
         "line 2: <?xml version='1.0'?><a/>; expected it at the beginning of the file"},
        {"<?xml version='1.0' encoding='EBCDIC'?><a/>",
         "line 1: <?xml version='1.0' encoding='EBCDIC'?>; expected XML (unknown encoding)"},
        {"<?xml version='1.0' encoding='UTF-16'?><a/>",
         "line 1: <?xml version='1.0' encoding='UTF-16'?>; expected XML (encoding specified in XML "
         "declaration is incorrect)"},
    };
    for (const auto& [text, error] : cases)
        EXPECT_EQ(error_of(text), error) << text;
    EXPECT_EQ(error_of("<?xml version='1.0' encoding='ISO-8859-1'?><a>\xe9</a>"), "");
}

TEST(Xml, EveryBeginningOfAFileIsRefused) {
    const std::string text = "<?xml version='1.0'?><a b=\"1\"><!-- c --><d>&amp;</d><e/></a>";
    for (std::size_t size = 1; size < text.size(); ++size)
        EXPECT_NE(error_of(text.substr(0, size)), "") << text.substr(0, size);
}

TEST(Xml, DepthIsLimited) {
    const auto nested = [](int depth) {
        std::string text;
        for (int i = 0; i < depth; ++i)
            text += "<a>";
        for (int i = 0; i < depth; ++i)
            text += "</a>";
        return text;
    };
    EXPECT_EQ(error_of(nested(32)), "");
    EXPECT_EQ(error_of(nested(33)), "line 1: elements are more than 32 deep; expected at most 32");
}

TEST(Xml, TagsAreLimited) {
    const auto with_attributes = [](int count) {
        std::string text = "<a";
        for (int i = 0; i < count; ++i)
            text += " b" + std::to_string(i) + "=''";
        return text + "/>";
    };
    EXPECT_EQ(error_of(with_attributes(64)), "");
    EXPECT_EQ(error_of(with_attributes(65)),
              "line 1: <a> has more than 64 attributes; expected fewer");
    EXPECT_EQ(error_of("<a b='1' B='2'/>"), "line 1: b stands twice; expected it once")
        << "OpenColorIO ignores case";
    // A comment may be as long as several pieces of the file, and text as long as it likes.
    constexpr std::size_t kMiB = 1U << 20U;
    EXPECT_EQ(error_of("<a>" + std::string(3 * kMiB, ' ') + "<!--" + std::string(kMiB / 2, 'x') +
                       "--></a>"),
              "");
    for (const char* begin : {"<!--", "<b c='", "</", "<?x "}) {
        EXPECT_NE(error_of("<a>\n" + std::string(begin) + std::string(2 * kMiB, 'x'))
                      .find(" is longer than 1 MiB; expected a shorter tag or comment"),
                  std::string::npos)
            << begin;
    }
}

TEST(Xml, BodiesReachAcrossPieces) {
    std::string numbers;
    while (numbers.size() < 200000)
        numbers += "0.5 ";
    std::size_t found = 0;
    visit_xml(TextLines(kPath, "<a><b>" + numbers + "</b></a>"), "a",
              [&](const XmlElement& element, const auto&) {
                  if (element.name == "b") found = element.body.size();
              });
    EXPECT_EQ(found, numbers.size());
}

TEST(Xml, AnErrorOfTheVisitorComesThrough) {
    for (const char* text : {"<a/>", "<a></a>", "<a><b/><c/></a>"}) {
        int calls = 0;
        EXPECT_THROW(visit_xml(TextLines(kPath, text), "a",
                               [&](const auto&, const auto&) {
                                   ++calls;
                                   throw FileError("x");
                               }),
                     FileError);
        EXPECT_EQ(calls, 1) << text;
    }
}

}  // namespace
TONEWRIGHT_NAMESPACE_END
