// SPDX-License-Identifier: Apache-2.0
#include "base/number_cache.h"

#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

namespace fs = std::filesystem;

/// A cache folder of the test's own.
class NumberCache : public testing::Test {
  protected:
    void SetUp() override {
        const char* known = std::getenv("XDG_CACHE_HOME");
        if (known) before_ = known;
        root_ = fs::path(testing::TempDir()) /
                ("tonewright_cache_" +
                 std::string(testing::UnitTest::GetInstance()->current_test_info()->name()));
        fs::remove_all(root_);
        setenv("XDG_CACHE_HOME", root_.c_str(), 1);
    }
    void TearDown() override {
        if (before_.empty()) {
            unsetenv("XDG_CACHE_HOME");
        } else {
            setenv("XDG_CACHE_HOME", before_.c_str(), 1);
        }
        fs::remove_all(root_);
    }

    std::vector<double> get(const std::string& key, std::vector<double> numbers) {
        return cached_numbers("test", key, [&] {
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

    fs::path root_;
    std::string before_;
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

TEST_F(NumberCache, WorksWithoutAFolder) {
    setenv("XDG_CACHE_HOME", "/dev/null/nowhere", 1);
    EXPECT_EQ(get("a", {4}), std::vector<double>{4});
    EXPECT_EQ(get("a", {5}), std::vector<double>{5}) << "nothing was kept";
    setenv("XDG_CACHE_HOME", "relative", 1);
    EXPECT_NE(cache_folder(), "relative/tonewright") << "XDG Base Directory Specification";
    EXPECT_FALSE(fs::exists("relative"));
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
