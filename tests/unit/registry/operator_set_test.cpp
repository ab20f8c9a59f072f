// SPDX-License-Identifier: Apache-2.0
#include "tonewright/definition.h"

#include <gtest/gtest.h>

#include <string>

#include "tonewright/registry.h"
#include "tonewright/view.h"
#include "unit/definition/definitions.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

TEST(Definition, OperatorSetGivesTextsMoreNames) {
    OperatorSet set;
    set.add(parsed("title = \"My Curve\"\n" + kStage));
    const ResolvedOperator op = resolve_operator("my curve", {}, "", set);
    EXPECT_EQ(op.op->id, "my");
    EXPECT_EQ(op.owner.use_count(), 2);
    EXPECT_THROW((void)resolve_operator("my curve"), Error);
    EXPECT_THROW(set.add(parsed(kStage)), Error) << "it has an operator of this id";
    EXPECT_THROW(set.add(parse_operator(
                     "tonewright = 1\nid = \"agx\"\ntitle = \"Hable\"\n" + kStage, "a.tone")),
                 Error);
}

TEST(Definition, TextsHaveSettingsAfterTheFile) {
    const std::string path = TONEWRIGHT_TEST_DATA "/../../docs/examples/reinhard_055.tone";
    EXPECT_EQ(resolve_operator(path).params.number("k"), 0.55);
    for (const char* rest : {":firm", ":k=0.3", " k=0.3", ": k=0.3", ":firm:k=0.3", ":K=0.3"}) {
        const ResolvedOperator op = resolve_operator(path + rest);
        EXPECT_EQ(op.params.number("k"), 0.3) << rest;
        // The text that names it reads back.
        EXPECT_EQ(resolve_operator(operator_text(op)).params.number("k"), 0.3) << rest;
    }
    EXPECT_THROW((void)resolve_operator(path + ":none"), Error);
    EXPECT_THROW((void)resolve_operator(path + ".tone"), FileError);
}

TEST(Definition, TextsNameFiles) {
    for (const char* text : {"my.tone", "MY.TONE", "./my.tone:soft", "a:b.tone", "C:\\x\\my.tone",
                             "my.tone:k=2", "my.tone k=2", "my op.tone", "x.tone.tone"})
        EXPECT_TRUE(names_a_file(text)) << text;
    for (const char* text : {"agx_blender", "agx_blender:punchy", "my.tones", "tone",
                             "my.tonex:k=2", "camera_response:file=a.tone", "hable:b.tone", ""})
        EXPECT_FALSE(names_a_file(text)) << text;
}

}  // namespace
TONEWRIGHT_NAMESPACE_END
