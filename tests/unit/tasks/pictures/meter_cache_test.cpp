// SPDX-License-Identifier: Apache-2.0
#include "tasks/pictures/meter_cache.h"

#include <gtest/gtest.h>

#include <string>

#include "tonewright/image_io.h"
#include "unit/errors.h"
#include "unit/folder.h"
#include "unit/image/pictures.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

class MeterCacheFile : public testing::Test {
  protected:
    MeterCacheFile() { write_image_atomically(make_rgb(16, 12), picture_); }

    Folder folder_;
    std::string picture_ = folder_ / "a.exr";
    std::string file_ = folder_ / "cache.json";
    MeterOptions options_;
};

TEST_F(MeterCacheFile, FiguresSurviveJson) {
    const Json json = to_json(meter_file(picture_, options_));
    EXPECT_EQ(to_json(metering_from(Json::parse(json.dump()))).dump(), json.dump());
    EXPECT_THROW((void)metering_from(Json::parse("{}")), JsonError);
}

TEST_F(MeterCacheFile, KnowsUnchangedFiles) {
    const FileStamp stamp = stamp_of(picture_);
    EXPECT_GT(stamp.bytes, 0U);
    EXPECT_EQ(stamp_of(folder_ / "none"), FileStamp());
    MeterCache cache(file_, options_);
    EXPECT_EQ(cache.find(picture_, stamp), nullptr);
    cache.add(picture_, stamp, meter_file(picture_, options_));
    cache.save();
    EXPECT_NE(MeterCache(file_, options_).find(picture_, stamp), nullptr);
    EXPECT_EQ(MeterCache(file_, options_).find(picture_, {stamp.bytes, stamp.modified + 1}),
              nullptr);
    options_.delta = 0.1;
    EXPECT_EQ(MeterCache(file_, options_).find(picture_, stamp), nullptr);
}

TEST_F(MeterCacheFile, RefusesOtherFiles) {
    write(file_, "{]");
    EXPECT_NE(error_of([&] { MeterCache(file_, options_); }).find("is not a meter cache"),
              std::string::npos);
}

TEST_F(MeterCacheFile, IgnoresImpossibleFigures) {
    const FileStamp stamp = stamp_of(picture_);
    Metering metering = meter_file(picture_, options_);
    metering.mean = -1;
    MeterCache cache(file_, options_);
    cache.add(picture_, stamp, metering);
    cache.save();
    EXPECT_EQ(MeterCache(file_, options_).find(picture_, stamp), nullptr);
}

}  // namespace
TONEWRIGHT_NAMESPACE_END
