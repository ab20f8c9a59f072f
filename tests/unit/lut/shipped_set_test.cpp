// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <algorithm>
#include <set>

#include "lut/shipped_set.h"
#include "tonewright/lut.h"
#include "tonewright/registry.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

LutRequest hable_cube(std::optional<int> decimals) {
    LutRequest request;
    request.encoding = parse_input_encoding("log2");
    request.view = make_view(resolve_operator("hable"), "lin_rec709", 0, "srgb");
    request.dimension = LutDimension::three;
    request.size = 17;
    request.decimals = decimals;
    return request;
}

TEST(ShippedSet, ItsSetsAreOfApplicationsAndOperatorsThatThereAre) {
    std::set<std::string> hosts;
    std::set<std::string> operators;
    for (const LutPresetSet& set : lut_preset_sets()) {
        EXPECT_TRUE(hosts.insert(set.host->id + set.display).second) << set.host->id;
        EXPECT_FALSE(set.operators.empty());
        for (const std::string& id : set.operators)
            operators.insert(find_operator(id).id);
    }
    EXPECT_EQ(operators.size(), 10U);
    EXPECT_GE(hosts.size(), 9U);
}

TEST(ShippedSet, DecimalsOfACubeAreThoseOfItsNumbers) {
    const LutRequest request = hable_cube(4);
    Lut lut = sample_lut(request);
    const Lut exact = lut;
    quantize(lut, request);
    for (std::size_t i = 0; i < lut.values.size(); ++i)
        EXPECT_NEAR(lut.values[i], exact.values[i], 0.5e-4F + 1e-7F);
    const std::string text = write_lut(lut, request, measure_lut(lut, request));
    const std::size_t numbers = text.find("DOMAIN_MAX 1 1 1\n") + 17;
    std::size_t longest = 0;
    for (std::size_t begin = numbers; begin < text.size();) {
        const std::size_t end = text.find_first_of(" \n", begin);
        longest = std::max(longest, end - begin);
        begin = end + 1;
    }
    EXPECT_EQ(longest, 6U);  // 0.1234
}

TEST(ShippedSet, DecimalsAreRefusedWhereTheyMeanNothing) {
    const auto message = [](const LutRequest& request) {
        try {
            (void)sample_lut(request);
        } catch (const Error& e) {
            return std::string(e.what());
        }
        return std::string();
    };
    EXPECT_EQ(message(hable_cube(2)), "decimals is 2; expected [3, 9]");
    LutRequest clf = hable_cube(4);
    clf.format = LutFormat::clf;
    EXPECT_EQ(message(clf), "decimals is 4; expected none for clf; only cube has decimals");
}

}  // namespace
TONEWRIGHT_NAMESPACE_END
