// SPDX-License-Identifier: Apache-2.0
#include "base/number_cache.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <iterator>
#include <limits>
#include <optional>
#include <string>

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

namespace fs = std::filesystem;

/// A cache folder of the test's own.
class NumberCache : public testing::Test {
  protected:
    void SetUp() override {
        root_ = fs::path(testing::TempDir()) /
                ("tonewright_cache_" +
                 std::string(testing::UnitTest::GetInstance()->current_test_info()->name()));
        fs::remove_all(root_);
    }
    void TearDown() override { fs::remove_all(root_); }

    std::vector<double> get(const std::string& key, std::vector<double> numbers) {
        return cached_numbers(folder_.value_or((root_ / "tonewright").string()), "test", key,
                              is_usable_, [&] {
                                  ++made_;
                                  return numbers;
                              });
    }
    [[nodiscard]] fs::path only_file() const {
        const fs::directory_iterator files(root_ / "tonewright");
        const fs::path path = files->path();
        EXPECT_EQ(std::distance(fs::begin(files), fs::end(files)), 1);
        return path;
    }

    NumberCheck is_usable_ = [](const std::vector<double>&) { return true; };
    fs::path root_;
    std::optional<std::string> folder_;
    int made_ = 0;
};

TEST_F(NumberCache, ComputesOnce) {
    const std::vector<double> numbers = {0.1, -0.0, 1e300, 3};
    EXPECT_EQ(get("a", numbers), numbers);
    EXPECT_EQ(get("a", {}), numbers) << "the same bits";
    EXPECT_EQ(made_, 1);
    EXPECT_EQ(get("b", {7}), std::vector<double>{7}) << "another key";
    EXPECT_EQ(made_, 2);
    fs::remove_all(root_);
    EXPECT_EQ(get("a", numbers), numbers) << "the folder may go at any time";
    EXPECT_EQ(made_, 3);
}

TEST_F(NumberCache, IgnoresDamagedFiles) {
    const std::vector<double> numbers = {1, 2, 3};
    get("a", numbers);
    const fs::path path = only_file();
    std::ifstream file(path, std::ios::binary);
    const std::string good((std::istreambuf_iterator<char>(file)), {});
    for (std::size_t i = 0; i <= good.size(); ++i) {
        std::string bad = good;
        if (i < good.size()) {
            bad[i] = static_cast<char>(bad[i] ^ 0x10);
        } else {
            bad.resize(good.size() - 8);
        }
        std::ofstream(path, std::ios::binary | std::ios::trunc) << bad;
        made_ = 0;
        EXPECT_EQ(get("a", numbers), numbers) << i;
        EXPECT_EQ(made_, 1) << i;
        EXPECT_EQ(get("a", {}), numbers) << "replaced";
    }
}

TEST_F(NumberCache, IgnoresNumbersThatTheCallerCannotUse) {
    constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
    for (const std::vector<double>& bad :
         {std::vector<double>{}, {1}, {1, 2, 3}, {1, kNone}, {1, 2.5}, {-0.5, 1}}) {
        fs::remove_all(root_);
        is_usable_ = [](const std::vector<double>&) { return true; };
        (void)get("a", bad);  // a file with the right key and checksum
        is_usable_ = numbers_in(2, 0, 2);
        made_ = 0;
        EXPECT_EQ(get("a", {0, 2}), (std::vector<double>{0, 2}));
        EXPECT_EQ(made_, 1);
        EXPECT_EQ(get("a", {1, 1}), (std::vector<double>{0, 2})) << "replaced";
    }
    EXPECT_TRUE(numbers_in(
        1, 0, std::numeric_limits<double>::infinity())({std::numeric_limits<double>::infinity()}));
    EXPECT_FALSE(numbers_in(1)({std::numeric_limits<double>::infinity()}));
}

TEST_F(NumberCache, ItsFilesAreNoLinksAndNobodyElsesFiles) {
    (void)get("a", {1});
    const fs::path path = only_file();
    EXPECT_EQ(fs::status(path).permissions(), fs::perms::owner_read | fs::perms::owner_write);
    EXPECT_EQ(fs::status(path.parent_path()).permissions(), fs::perms::owner_all);

    const fs::path other = root_ / "other";
    fs::rename(path, other);
    fs::create_symlink(other, path);
    EXPECT_EQ(get("a", {2}), std::vector<double>{2}) << "a link is not read";
    EXPECT_TRUE(fs::is_regular_file(fs::symlink_status(path))) << "but replaced";
    fs::remove(path);
    std::ofstream(other, std::ios::trunc) << "precious";
    fs::create_symlink(other, path);
    (void)get("a", {3});
    std::string text;
    std::getline(std::ifstream(other), text);
    EXPECT_EQ(text, "precious") << "nothing is written through a link";

    fs::permissions(path, fs::perms::others_write, fs::perm_options::add);
    EXPECT_EQ(get("a", {4}), std::vector<double>{4}) << "others could have written it";
}

TEST_F(NumberCache, WorksWithoutAFolder) {
    for (const char* folder : {"/dev/null/nowhere", ""}) {
        folder_ = folder;
        EXPECT_EQ(get("a", {4}), std::vector<double>{4});
        EXPECT_EQ(get("a", {5}), std::vector<double>{5}) << "nothing was kept";
    }
    EXPECT_FALSE(fs::exists(root_));
}

TEST_F(NumberCache, DropsTheOldestFilesOfMoreThan256MiB) {
    get("a", {1});
    const fs::path first = only_file();
    // A sparse file of the cache's own kind, older than the first.
    const fs::path large = first.parent_path() / "test_00000000.numbers";
    std::ofstream{large};
    fs::resize_file(large, std::uintmax_t{257} << 20);
    fs::last_write_time(large, fs::last_write_time(first) - std::chrono::hours(1));
    const fs::path strange = first.parent_path() / "notes.txt";
    std::ofstream{strange};
    get("b", {2});
    EXPECT_FALSE(fs::exists(large));
    EXPECT_TRUE(fs::exists(first));
    EXPECT_TRUE(fs::exists(strange));
}

}  // namespace
TONEWRIGHT_NAMESPACE_END
