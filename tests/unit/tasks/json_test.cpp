// SPDX-License-Identifier: Apache-2.0
#include "tasks/json.h"

#include <gtest/gtest.h>

#include <cstdint>
#include <string>
#include <vector>

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

TEST(Json, ObjectsKeepTheirOrder) {
    Json value = {{"z", 1}, {"a", std::vector<double>{0.5, 2}}, {"t", true}};
    value.add("none", nullptr);
    EXPECT_EQ(value.dump(), R"({"z":1,"a":[0.5,2.0],"t":true,"none":null})");
}

TEST(Json, WhatIsDumpedIsParsedAgain) {
    const Json value = {
        {"text", "a \"b\" \\ \n"}, {"number", 1.0 / 3}, {"list", Json::array({1, "x"})}};
    EXPECT_EQ(Json::parse(value.dump()).dump(), value.dump());
    EXPECT_EQ(Json::parse(value.dump(2)).dump(), value.dump());
}

TEST(Json, OtherKindsAreErrors) {
    const Json value = Json::parse(R"({"number":-3,"list":[1,2,3]})");
    std::int64_t number = 0;
    value.at("number").get_to(number);
    EXPECT_EQ(number, -3);
    std::uint64_t count = 0;
    EXPECT_THROW(value.at("number").get_to(count), JsonError);
    EXPECT_THROW((void)value.at("none"), JsonError);
    std::array<double, 2> two{};
    EXPECT_THROW(value.at("list").get_to(two), JsonError);
    EXPECT_THROW((void)Json::parse("{"), JsonError);
}

}  // namespace
TONEWRIGHT_NAMESPACE_END
