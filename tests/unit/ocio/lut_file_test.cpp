// SPDX-License-Identifier: Apache-2.0
//
// LutFile inside an application that uses OpenColorIO itself: neither sees the other. The formats
// are tested by tests/cli/test_lut_files.py.
#include "tonewright/lut_file.h"

#include <OpenColorIO/OpenColorIO.h>
#include <gtest/gtest.h>
#include <stdlib.h>  // setenv()

#include <array>
#include <filesystem>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "tonewright/error.h"
#include "unit/folder.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

namespace fs = std::filesystem;
namespace OCIO = OCIO_NAMESPACE;

/// A matrix that multiplies by `factor`.
std::string clf(double factor, const std::string& more = "") {
    const std::string k = std::to_string(factor);
    return "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n"
           "<ProcessList id=\"x\" compCLFversion=\"3\">\n" +
           more + "<Matrix inBitDepth=\"32f\" outBitDepth=\"32f\">\n<Array dim=\"3 3\">\n" + k +
           " 0 0\n0 " + k + " 0\n0 0 " + k + "\n</Array>\n</Matrix>\n</ProcessList>\n";
}

float factor_of(const LutFile& lut) {
    const std::array<float, 3> in = {1, 1, 1};
    std::array<float, 3> out{};
    lut.run_rgb(in.data(), out.data(), 1);
    return out[1];
}

/// The factor in an application, which has no cache of processors.
float factor_in_application(const std::string& path) {
    const OCIO::FileTransformRcPtr file = OCIO::FileTransform::Create();
    file->setSrc(path.c_str());
    const OCIO::ConfigRcPtr config = OCIO::Config::CreateRaw()->createEditableCopy();
    config->setProcessorCacheFlags(OCIO::PROCESSOR_CACHE_OFF);
    std::array<float, 3> rgb = {1, 1, 1};
    config->getProcessor(file)->getDefaultCPUProcessor()->applyRGB(rgb.data());
    return rgb[1];
}

class LutFileBesideOcio : public testing::Test {
  protected:
    void SetUp() override {
        fs::create_directory(folder_ / "tmp");
        if (const char* value = ::getenv("TMPDIR")) saved_ = value;
        ::setenv("TMPDIR", (folder_ / "tmp").c_str(), 1);
    }
    void TearDown() override {
        if (saved_.empty()) {
            ::unsetenv("TMPDIR");
        } else {
            ::setenv("TMPDIR", saved_.c_str(), 1);
        }
    }
    /// The path of a file with this text.
    [[nodiscard]] std::string written(const std::string& name, const std::string& text) const {
        write(folder_ / name, text);
        return folder_ / name;
    }
    [[nodiscard]] bool leaves_nothing() const { return fs::is_empty(folder_ / "tmp"); }

    Folder folder_;
    std::string saved_;
};

TEST_F(LutFileBesideOcio, ReadsARewrittenFileAgainAndKeepsTheCachesOfTheApplication) {
    const std::string path = written("a.clf", clf(2));
    EXPECT_EQ(factor_in_application(path), 2);
    EXPECT_EQ(factor_of(LutFile(path)), 2);
    for (const int factor : {3, 4, 3}) {
        (void)written("a.clf", clf(factor));
        EXPECT_EQ(factor_of(LutFile(path)), factor);
        EXPECT_EQ(factor_in_application(path), 2) << "OpenColorIO remembers what it has read";
    }
    EXPECT_TRUE(leaves_nothing());
}

TEST_F(LutFileBesideOcio, LeavesTheLogToTheApplication) {
    const OCIO::LoggingLevel level = OCIO::GetLoggingLevel();
    static int messages = 0;
    OCIO::SetLoggingFunction([](const char*) { ++messages; });
    const LutFile lut(written("unknown.clf", clf(5, "<Unknown/>\n")));
    OCIO::ResetToDefaultLoggingFunction();
    EXPECT_EQ(factor_of(lut), 5);
    EXPECT_EQ(OCIO::GetLoggingLevel(), level);
    if (level != OCIO::LOGGING_LEVEL_NONE) {
        EXPECT_GT(messages, 0) << "the warning about <Unknown>";
    }
}

TEST_F(LutFileBesideOcio, ErrorsNameTheFile) {
    const std::string path =
        written("broken.clf", clf(1, "<Matrix inBitDepth=\"8i\" outBitDepth=\"1\"></Matrix>\n"));
    try {
        const LutFile lut(path);
        FAIL();
    } catch (const FileError& e) {
        const std::string message = e.what();
        EXPECT_EQ(message.rfind("read: " + path + ": ", 0), 0U) << message;
        EXPECT_EQ(message.find(folder_ / "tmp"), std::string::npos) << message;
    }
    EXPECT_TRUE(leaves_nothing());
    fs::remove(folder_ / "tmp");
    EXPECT_THROW(LutFile{written("a.clf", clf(2))}, FileError) << "no room for the copy";
}

TEST_F(LutFileBesideOcio, ThreadsReadAtTheSameTime) {
    std::vector<std::string> paths;
    for (int i = 0; i < 8; ++i)
        paths.push_back(written("t" + std::to_string(i) + ".clf", clf(10 + i % 3)));
    std::array<std::vector<float>, 4> factors;
    std::vector<std::thread> threads;
    for (std::vector<float>& found : factors) {
        threads.emplace_back([&] {
            for (int round = 0; round < 5; ++round) {
                for (const std::string& path : paths)
                    found.push_back(factor_of(LutFile(path)));
            }
        });
    }
    for (std::thread& t : threads)
        t.join();
    for (const std::vector<float>& found : factors) {
        for (std::size_t i = 0; i < found.size(); ++i)
            EXPECT_EQ(found[i], 10 + static_cast<int>(i % 8) % 3);
    }
    EXPECT_TRUE(leaves_nothing());
}

TEST_F(LutFileBesideOcio, InterpolationsHaveNames) {
    EXPECT_EQ(parse_lut_interpolation("auto"), LutInterpolation::automatic);
    EXPECT_EQ(parse_lut_interpolation("tetrahedral"), LutInterpolation::tetrahedral);
    EXPECT_EQ(parse_lut_interpolation("trilinear"), LutInterpolation::trilinear);
    EXPECT_THROW((void)parse_lut_interpolation("nearest"), Error);
    // Along an edge that is no edge of the six tetrahedra, the two differ: the middle of a cube
    // whose only lit node is (1, 1, 0) is 0.25 of it in a plane of red and green, trilinearly, and
    // 0.5 on the diagonal between.
    std::string text = "LUT_3D_SIZE 2\n";
    for (int i = 0; i < 8; ++i)
        text += i == 3 ? "1 1 1\n" : "0 0 0\n";
    const std::string path = written("a.cube", text);
    const std::array<float, 3> in = {0.5F, 0.5F, 0};
    for (const auto& [interpolation, expected] : {std::pair(LutInterpolation::trilinear, 0.25F),
                                                  std::pair(LutInterpolation::tetrahedral, 0.5F)}) {
        std::array<float, 3> out{};
        LutFile(path, interpolation).run_rgb(in.data(), out.data(), 1);
        EXPECT_NEAR(out[0], expected, 1e-6F) << "a few roundings of float";
    }
}

TEST_F(LutFileBesideOcio, SilencedOcioWritesNoLog) {
    const OCIO::LoggingLevel level = OCIO::GetLoggingLevel();
    silence_opencolorio();
    EXPECT_EQ(OCIO::GetLoggingLevel(), OCIO::LOGGING_LEVEL_NONE);
    OCIO::SetLoggingLevel(level);
}

}  // namespace
TONEWRIGHT_NAMESPACE_END
