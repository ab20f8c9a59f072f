// SPDX-License-Identifier: Apache-2.0
#include "operators/camera_response/response_curve.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <vector>

#include "tonewright/error.h"
#include "tonewright/pipeline.h"
#include "tonewright/registry.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

namespace fs = std::filesystem;

const std::string kData = TONEWRIGHT_TEST_DATA "/";

/// Error of reading the text as the file `f`; empty if it can be read.
std::string refusal(std::string_view text, std::string_view curve = {}) {
    try {
        (void)parse_response_curves(text, "f", curve);
    } catch (const FileError& e) {
        return e.what();
    } catch (const Error& e) {
        return std::string("not FileError: ") + e.what();
    }
    return {};
}

double at(const ResponseCurves& curves, std::size_t channel, double x) {
    return (*curves[channel])(x);
}

/// The curves that python_check/make_synthetic_response.py writes.
double synthetic(std::size_t channel, double b) {
    constexpr double k[] = {3.0, 2.8, 3.3};
    constexpr double p[] = {0.7, 0.75, 0.8};
    return (1 - std::exp(-k[channel] * std::pow(b, p[channel]))) / (1 - std::exp(-k[channel]));
}

// ---------------------------------------------------------------------------------------------
// Layouts

TEST(ResponseCurve, ReadsColumns) {
    const ResponseCurves c = read_response_curves(kData + "synthetic_response.rf");
    for (std::size_t k = 0; k < 3; ++k) {
        EXPECT_EQ(c[k]->samples.size(), 256U);
        EXPECT_TRUE(c[k]->positions.empty()) << "equal distances";
        for (const int i : {0, 1, 17, 128, 254, 255})
            EXPECT_NEAR(at(c, k, i / 255.0), synthetic(k, i / 255.0), 1e-12);
        // Half-way between two samples: their mean.
        EXPECT_NEAR(at(c, k, 17.5 / 255), (synthetic(k, 17.0 / 255) + synthetic(k, 18.0 / 255)) / 2,
                    1e-12);
    }
    EXPECT_NE(c[0], c[1]);
    EXPECT_NE(c[1], c[2]);
}

TEST(ResponseCurve, ReadsCsvWithUnevenIrradiance) {
    const ResponseCurves c = read_response_curves(kData + "synthetic_response_uneven.csv");
    const auto b = [](int i) { return std::pow(i / 63.0, 2); };
    for (std::size_t k = 0; k < 3; ++k) {
        ASSERT_EQ(c[k]->positions.size(), 64U);
        for (const int i : {0, 1, 17, 62, 63})
            EXPECT_NEAR(at(c, k, b(i)), synthetic(k, b(i)), 1e-12);
        EXPECT_NEAR(at(c, k, 0.25 * b(4) + 0.75 * b(5)),
                    0.25 * synthetic(k, b(4)) + 0.75 * synthetic(k, b(5)), 1e-12);
    }
}

TEST(ResponseCurve, ReadsDorf) {
    const std::string file = kData + "synthetic_dorf.txt";
    const ResponseCurves three = read_response_curves(file, "Synthetic-1");
    for (std::size_t k = 0; k < 3; ++k) {
        EXPECT_EQ(three[k]->samples.size(), 32U);
        EXPECT_NEAR(at(three, k, 10 / 31.0), synthetic(k, 10 / 31.0), 2e-6) << "7 digits";
    }
    const ResponseCurves green = read_response_curves(file, "Synthetic-1Green");
    EXPECT_EQ(green[0]->samples, three[1]->samples);
    EXPECT_EQ(green[0], green[1]) << "one table";
    EXPECT_EQ(green[0], green[2]);
    const ResponseCurves mono = read_response_curves(file, "SyntheticMono");
    EXPECT_NEAR(at(mono, 2, 15 / 31.0), (1 - std::exp(-30 / 31.0)) / (1 - std::exp(-2.0)), 2e-6);
    EXPECT_EQ(mono[0], mono[2]);
}

TEST(ResponseCurve, TellsLayoutsByContent) {
    const auto values = [](std::string_view text, std::string_view curve = {}) {
        const ResponseCurves c = parse_response_curves(text, "f", curve);
        return Vector3{at(c, 0, 0.5), at(c, 1, 0.5), at(c, 2, 0.5)};
    };
    const Vector3 gray = {0.7, 0.7, 0.7};
    EXPECT_EQ(values("0 0\n0.5 0.7\n1 1\n"), gray);
    EXPECT_EQ(values("0 0\n0.5 0.7\n1 1"), gray) << "no end of line at the end";
    EXPECT_EQ(values("\xEF\xBB\xBF# film\r\n\r\n  0\t0 \r\n+0.5  7e-1 # mid\r\n1. 1\r\n"), gray);
    EXPECT_EQ(values("0 0\r0.5 0.7\r1 1\r"), gray);
    EXPECT_EQ(values("0,0\n0.5,0.7\n1,1\n"), gray);
    EXPECT_EQ(values("irradiance, response\n0, 0\n0.5, 0.7\n1, 1\n"), gray);
    EXPECT_EQ(values("x;y\n0;0\n0.5;0.7\n1;1\n"), gray);
    const Vector3 rgb = {0.7, 0.6, 0.5};
    EXPECT_EQ(values("0 0 0 0\n0.5 0.7 0.6 0.5\n1 1 1 1\n"), rgb);
    EXPECT_EQ(values("B,R,G,B\n0,0,0,0\n0.5,0.7,0.6,0.5\n1,1,1,1\n"), rgb);
    EXPECT_EQ(values("0 0 0 0\n0.5 0.7 0.6 0.5\n1 1 1 1\n", "blue"), (Vector3{0.5, 0.5, 0.5}));
    EXPECT_EQ(values("aRed\ngraph\nI =\n0 1\nB=\n0 1\n"), (Vector3{0.5, 0.5, 0.5}))
        << "one curve needs no name";
    const std::string three =
        "aRed\ng\nI =\n0 0.5 1\nB =\n0 0.7 1\n\naGreen\ng\nI =\n0 0.5 1\nB =\n0 0.6 1\n"
        "aBlue\r\ng\r\nI =\r\n0 1\r\nB =\r\n0 1\r\n";
    EXPECT_EQ(values(three), rgb) << "nor do three that can only be one";
    EXPECT_EQ(values(three, "a"), rgb);
    EXPECT_EQ(values(three, "aRed"), gray);
    EXPECT_EQ(values("a-R\ng\nI =\n0 1\nB =\n0 1\na-G\ng\nI =\n0 1\nB =\n0.5 1\n"
                     "a-B\ng\nI =\n0 1\nB =\n0 0.5\n",
                     "a"),
              (Vector3{0.5, 0.75, 0.25}));
}

TEST(ResponseCurve, EqualChannelsAreOneTable) {
    const ResponseCurves c = parse_response_curves("0 0 0 0\n0.3 0.5 0.6 0.5\n1 1 1 1\n", "f");
    EXPECT_NE(c[0], c[1]);
    EXPECT_EQ(c[0], c[2]);
}

TEST(ResponseCurve, OfEqualIrradiancesTheLastCounts) {
    const ResponseCurves c =
        parse_response_curves("0 0\n0 0.1\n0.5 0.5\n0.5 0.6\n0.5 0.7\n1 0.8\n1 0.9\n", "f");
    EXPECT_EQ(c[0]->samples, (std::vector<double>{0.1, 0.7, 0.9}));
    EXPECT_TRUE(c[0]->positions.empty());
    EXPECT_EQ(at(c, 0, 0.25), 0.1 + 0.5 * (0.7 - 0.1));
}

TEST(ResponseCurve, HoldsItsEnds) {
    const ResponseCurves c = parse_response_curves("0.25 0.1\n0.5 0.4\n0.625 0.9\n", "f");
    EXPECT_EQ(at(c, 0, 0), 0.1);
    EXPECT_EQ(at(c, 0, 0.5625), 0.65);
    EXPECT_EQ(at(c, 0, 1), 0.9);
}

// ---------------------------------------------------------------------------------------------
// Refusals

TEST(ResponseCurve, RefusesColumnsByLine) {
    const std::string layouts =
        "; expected columns irradiance and intensity, columns irradiance, red, green, blue, or "
        "DoRF's six lines a curve";
    EXPECT_EQ(refusal(""), "f:1: no curve" + layouts);
    EXPECT_EQ(refusal("# nothing\n\n"), "f:2: no curve" + layouts);
    EXPECT_EQ(refusal("0 0\n"), "f:1: 1 sample of different irradiance; expected 2 or more");
    EXPECT_EQ(refusal("0.5 0\n0.5 1\n"),
              "f:2: 1 sample of different irradiance; expected 2 or more");
    EXPECT_EQ(refusal("x,y\n"), "f:1: 0 samples of different irradiance; expected 2 or more");
    EXPECT_EQ(refusal("0 0 0\n1 1 1\n"), "f:1: 3 columns in 0 0 0" + layouts);
    EXPECT_EQ(refusal("\n#\n0\n1\n"), "f:3: 1 column in 0" + layouts);
    EXPECT_EQ(refusal("0 0\n0.5\n1 1\n"), "f:2: 1 column; expected 2 as in line 1");
    EXPECT_EQ(refusal("# c\n0,0,0,0\n1,1,1\n"), "f:3: 3 columns; expected 4 as in line 2");
    EXPECT_EQ(refusal("0,0\n1,1,\n"), "f:2: 3 columns; expected 2 as in line 1");

    const std::string number = "; expected a number in [0, 1]";
    EXPECT_EQ(refusal("0 0\n0.5x 1\n"), "f:2: irradiance is 0.5x" + number);
    EXPECT_EQ(refusal("0 0\n1 one\n"), "f:2: intensity is one" + number);
    EXPECT_EQ(refusal("B R\n0 0\n1 1\n"), "f:1: irradiance is B" + number) << "CSV alone has names";
    EXPECT_EQ(refusal("0,0\nx,y\n1,1\n"), "f:2: irradiance is x" + number) << "at the beginning";
    EXPECT_EQ(refusal("0,0\n0.5,\n1,1\n"), "f:2: intensity is empty" + number);
    EXPECT_EQ(refusal("0,0\n0,5;0,7\n1,1\n"), "f:2: 3 columns; expected 2 as in line 1");
    EXPECT_EQ(refusal("0 0\nnan 1\n"), "f:2: irradiance is nan" + number);
    EXPECT_EQ(refusal("nan,nan\n1,1\n"), "f:1: irradiance is nan" + number);
    EXPECT_EQ(refusal("0 0\n1 inf\n"), "f:2: intensity is inf" + number);
    EXPECT_EQ(refusal("0 0 0 0\n1 1 -inf 1\n"), "f:2: green intensity is -inf" + number);
    EXPECT_EQ(refusal("0 0\n1 1e999\n"), "f:2: intensity is 1e999" + number);
    EXPECT_EQ(refusal("-0.1 0\n1 1\n"), "f:1: irradiance is -0.1" + number);
    EXPECT_EQ(refusal("0 0\n255 1\n"), "f:2: irradiance is 255" + number);
    EXPECT_EQ(refusal("0 0 0 0\n1 1 1 1.5\n"), "f:2: blue intensity is 1.5" + number);
    EXPECT_EQ(refusal("0 +-0.5\n1 1\n"), "f:1: intensity is +-0.5" + number);

    const std::string fall = "; expected it not to fall";
    EXPECT_EQ(refusal("0 0\n0.5 0.2\n0.4 0.3\n1 1\n"), "f:3: irradiance is 0.4 after 0.5" + fall);
    EXPECT_EQ(refusal("0 0\n0.5 0.7\n\n0.6 0.6999\n1 1\n"),
              "f:4: intensity is 0.6999 after 0.7" + fall);
    EXPECT_EQ(refusal("0 0 0 0\n0.5 0.5 0.5 0.5\n1 1 0.4 1\n"),
              "f:3: green intensity is 0.4 after 0.5" + fall);
    EXPECT_EQ(refusal("0 0\n0.5 0.7\n0.5 0.6\n1 1\n"), "f:3: intensity is 0.6 after 0.7" + fall);
    EXPECT_EQ(refusal("0 0\n0.25 0.5\n0.5 0.5\n1 1\n"), "") << "flat is not falling";
}

TEST(ResponseCurve, RefusesDorfByLine) {
    const std::string good = "a\ng\nI =\n0 1\nB =\n0 1\n";
    const std::string layout = ", six lines a curve";
    EXPECT_EQ(refusal(good), "");
    EXPECT_EQ(refusal("a\ng\nI =\n"),
              "f:3: curve a ends here; expected irradiances in the next line" + layout);
    EXPECT_EQ(refusal("a\ng\nI =\n0 1\nB =\n"),
              "f:5: curve a ends here; expected intensities in the next line" + layout);
    EXPECT_EQ(refusal(good + "b\n"),
              "f:7: curve b ends here; expected the kind of graph in the next line" + layout);
    EXPECT_EQ(refusal("a\nI =\n0 1\nB =\n0 1\n"),
              "f:2: line is I =; expected the kind of graph" + layout);
    EXPECT_EQ(refusal("a\ng\nI =\nB =\n0 1\n"), "f:4: line is B =; expected irradiances" + layout);
    EXPECT_EQ(refusal("a\ng\nI =\n0 1\nI =\n0 1\n"), "f:5: line is I =; expected `B =`" + layout);
    EXPECT_EQ(refusal("a\ng\nI =\n0 1\n0.5 1\nB =\n"),
              "f:5: line is 0.5 1; expected `B =`" + layout);

    EXPECT_EQ(refusal("a\ng\nI =\n0 0.5 1\nB =\n0 1\n"),
              "f:6: a has 2 numbers behind `B =` and 3 behind `I =`; expected as many");
    EXPECT_EQ(refusal("a\ng\nI =\n0\nB =\n0\n"),
              "f:4: 1 sample of different irradiance; expected 2 or more");
    EXPECT_EQ(refusal("a\ng\nI =\n0 0.5 0.4 1\nB =\n0 0 0 1\n"),
              "f:4: irradiance 3 of a is 0.4 after 0.5; expected it not to fall");
    EXPECT_EQ(refusal("a\ng\nI =\n0 0.5 1\nB =\n0 0.5 0.25\n"),
              "f:6: intensity 3 of a is 0.25 after 0.5; expected it not to fall");
    EXPECT_EQ(refusal("a\ng\nI =\n0 x 1\nB =\n0 0 1\n"),
              "f:4: irradiance 2 of a is x; expected a number in [0, 1]");
    EXPECT_EQ(refusal("a\ng\nI =\n0 1\nB =\n0 nan\n"),
              "f:6: intensity 2 of a is nan; expected a number in [0, 1]");
    EXPECT_EQ(refusal("a\ng\nI =\n0 1\nB =\n0 100\n"),
              "f:6: intensity 2 of a is 100; expected a number in [0, 1]");
    EXPECT_EQ(refusal(good + good, "a"),
              "f:7: second curve a after line 1; expected names that differ");
    EXPECT_EQ(refusal(good + "b\ng\nI =\n0 x\nB =\n0 1\n", "a"), "") << "b was not asked for";
}

TEST(ResponseCurve, RefusesCurvesThatAreNotThere) {
    const auto why = [](const std::string& text, std::string_view curve) {
        const std::string message = refusal(text, curve);
        EXPECT_TRUE(message.starts_with("not FileError: f: curve is ")) << message;
        return message.substr(std::string("not FileError: f: curve is ").size());
    };
    std::string dorf;
    for (const std::string name : {"filmRed", "filmGreen", "filmBlue", "lonelyRed", "slide"})
        dorf += name + "\ng\nI =\n0 1\nB =\n0 1\n";
    EXPECT_EQ(why(dorf, ""), "empty; expected film, lonelyRed or slide");
    EXPECT_EQ(why(dorf, "flim"), "flim; expected film, lonelyRed or slide; did you mean film?");
    EXPECT_EQ(why(dorf, "lonely"),
              "lonely; expected film, lonelyRed or slide; did you mean lonelyRed?");
    std::string many;
    for (int i = 10; i < 30; ++i)
        many += "curve" + std::to_string(i) + "\ng\nI =\n0 1\nB =\n0 1\n";
    EXPECT_EQ(why(many, ""),
              "empty; expected one of its 20, such as curve10, curve11, curve12, curve13, curve14, "
              "curve15, curve16 or curve17");
    const std::string four = "0 0 0 0\n1 1 1 1\n";
    EXPECT_EQ(why(four, "rde"),
              "rde; expected none (each channel has its own), red, green or blue; did you mean "
              "red?");
    EXPECT_EQ(why("0 0\n1 1\n", "red"), "red; expected none, the file has one for all channels");
}

TEST(ResponseCurve, RefusesOtherFiles) {
    const fs::path folder = fs::temp_directory_path() / "tonewright_response_curve_test";
    fs::remove_all(folder);
    fs::create_directories(folder);
    const auto why = [](const std::string& file) -> std::string {
        try {
            (void)read_response_curves(file);
        } catch (const FileError& e) {
            return e.what();
        }
        return {};
    };
    const std::string missing = (folder / "missing.rf").string();
    EXPECT_EQ(why(missing), missing + ": cannot read: No such file or directory");
    EXPECT_EQ(why(folder.string()), folder.string() + ": cannot read: is a folder");
    EXPECT_EQ(why("/dev/null"),
              "/dev/null: cannot read: is no regular file (a pipe or a device); expected a file");
    EXPECT_NE(why(""), "");

    const std::string huge = (folder / "huge.rf").string();
    std::ofstream(huge) << "0 0\n1 1\n";
    EXPECT_EQ(why(huge), "");
    fs::resize_file(huge, (std::uintmax_t{64} << 20) + 1);  // sparse
    EXPECT_EQ(why(huge), huge + ": cannot read: it has 67108865 bytes; expected at most 67108864");

    // Other files: one line, nothing unprintable of theirs in it.
    const std::string binary = (folder / "picture.exr").string();
    std::ofstream(binary, std::ios::binary)
        << std::string("v/1\x01\x02\0\0\0\xFF \x1B[31m\n0 0\n", 19);
    const std::string message = why(binary);
    EXPECT_TRUE(message.starts_with(binary + ":1: ")) << message;
    for (const char c : message)
        EXPECT_TRUE(c >= ' ' && c <= '~') << static_cast<int>(c);
    EXPECT_LT(message.size(), binary.size() + 200);
    fs::remove_all(folder);
}

/// Any beginning of a file gives a curve or a refusal.
TEST(ResponseCurve, EveryTruncatedFileIsReadOrRefused) {
    for (const std::string file :
         {"synthetic_response.rf", "synthetic_response_uneven.csv", "synthetic_dorf.txt"}) {
        std::ifstream stream(kData + file, std::ios::binary);
        const std::string text((std::istreambuf_iterator<char>(stream)), {});
        ASSERT_FALSE(text.empty());
        for (std::size_t size = 0; size < text.size(); size += 7) {
            try {
                const ResponseCurves c =
                    parse_response_curves(std::string_view(text).substr(0, size), "f",
                                          file[10] == 'd' ? "SyntheticMono" : "");
                for (std::size_t k = 0; k < 3; ++k) {
                    ASSERT_GE(c[k]->samples.size(), 2U);
                    ASSERT_GE(at(c, k, 0.3), 0);
                    ASSERT_LE(at(c, k, 0.3), 1);
                }
            } catch (const Error& e) {
                ASSERT_EQ(std::string(e.what()).find('\n'), std::string::npos);
            }
        }
    }
}

// ---------------------------------------------------------------------------------------------
// The operator

Vector3 native(const Settings& settings, const Vector3& rgb) {
    const auto out = compose(resolve_operator("camera_response", settings).build());
    return {evaluate(out[0], rgb), evaluate(out[1], rgb), evaluate(out[2], rgb)};
}

std::string resolve_refusal(const Settings& settings, bool& is_file_error) {
    try {
        (void)resolve_operator("camera_response", settings);
    } catch (const Error& e) {
        is_file_error = dynamic_cast<const FileError*>(&e) != nullptr;
        return e.what();
    }
    return {};
}

TEST(CameraResponse, BuiltInCurveIsSynthetic) {
    const auto formula = [](double b) {
        return (1 - std::exp(-3 * std::pow(b, 0.7))) / (1 - std::exp(-3.0));
    };
    const Vector3 out = native({}, {6 * 100.0 / 1023, 6.0, 1000});
    EXPECT_NEAR(out[0], formula(100.0 / 1023), 1e-14);
    EXPECT_EQ(out[1], 1);
    EXPECT_EQ(out[2], 1);
    EXPECT_EQ(native({}, {0, -1, -65504}), (Vector3{0, 0, 0}));
    EXPECT_NEAR(native({{"iso", "2"}}, {1.0, 1, 1})[0], formula(0.5), 1e-6);
}

TEST(CameraResponse, OneCurveForAllChannelsIsOneExpression) {
    const auto is_uniform = [](const Settings& settings) {
        const Pipeline p = resolve_operator("camera_response", settings).build();
        return std::get<CurveStage>(p.back()).is_uniform();
    };
    EXPECT_TRUE(is_uniform({}));
    EXPECT_TRUE(is_uniform({{"file", kData + "synthetic_dorf.txt"}, {"curve", "SyntheticMono"}}));
    EXPECT_TRUE(is_uniform({{"file", kData + "synthetic_response.rf"}, {"curve", "green"}}));
    EXPECT_FALSE(is_uniform({{"file", kData + "synthetic_response.rf"}}));
}

TEST(CameraResponse, TakesEachChannelThroughItsCurve) {
    const Vector3 out = native(
        {{"file", kData + "synthetic_response_uneven.csv"}, {"iso", "4"}},
        {4 * std::pow(20 / 63.0, 2), 4 * std::pow(20 / 63.0, 2), 4 * std::pow(20 / 63.0, 2)});
    for (std::size_t k = 0; k < 3; ++k)
        EXPECT_NEAR(out[k], synthetic(k, std::pow(20 / 63.0, 2)), 1e-12);
}

TEST(CameraResponse, NamesItselfInRefusals) {
    bool is_file_error = false;
    EXPECT_EQ(resolve_refusal({{"file", "/nonexistent.rf"}}, is_file_error),
              "camera_response: /nonexistent.rf: cannot read: No such file or directory");
    EXPECT_TRUE(is_file_error);
    EXPECT_EQ(resolve_refusal({{"file", kData + "synthetic_dorf.txt"}}, is_file_error),
              "camera_response: " + kData +
                  "synthetic_dorf.txt: curve is empty; expected Synthetic-1 or SyntheticMono");
    EXPECT_FALSE(is_file_error);
    EXPECT_EQ(resolve_refusal({{"curve", "red"}}, is_file_error),
              "camera_response: curve is red; expected a file that has it");
}

// ---------------------------------------------------------------------------------------------
// Measured curves, which are not part of the project

class MeasuredResponse : public ::testing::Test {
  protected:
    void SetUp() override {
        const char* shared = std::getenv("TONEWRIGHT_SHARED");
        folder_ = shared ? fs::path(shared) : fs::path(kData) / "../../../shared";
        folder_ /= "data/camera_response";
        if (!fs::is_directory(folder_)) {
            GTEST_SKIP() << "no measured curves: " << folder_.string()
                         << " is not there (TONEWRIGHT_SHARED names the folder that has data/)";
        }
    }
    [[nodiscard]] std::string file(const std::string& name) const {
        return (folder_ / name).string();
    }

    fs::path folder_;
};

TEST_F(MeasuredResponse, Loads) {
    int files = 0;
    for (const fs::directory_entry& entry : fs::directory_iterator(folder_)) {
        if (entry.path().extension() != ".rf") continue;
        ++files;
        const ResponseCurves c = read_response_curves(entry.path().string());
        for (std::size_t k = 0; k < 3; ++k) {
            EXPECT_EQ(c[k]->samples.size(), 1024U) << entry.path();
            EXPECT_EQ(at(c, k, 0), 0) << entry.path();
            EXPECT_EQ(at(c, k, 1), 1) << entry.path();
        }
    }
    EXPECT_GT(files, 0) << folder_;
}

struct Published {
    Vector3 in, out;
};

void expect_published(const Settings& settings, const std::vector<Published>& rows) {
    for (const auto& [in, out] : rows) {
        const Vector3 actual = native(settings, in);
        for (std::size_t c = 0; c < 3; ++c)
            EXPECT_NEAR(actual[c], out[c], 1e-9 * std::max(out[c], 1e-3)) << in[c];
    }
}

// Figures of the project's reference collection: an independent piecewise linear evaluation of the
// two files, 12 digits.
TEST_F(MeasuredResponse, PortraIsAsPublished) {
    if (!fs::exists(file("Portra-400NCCD.rf"))) GTEST_SKIP() << "no Portra-400NCCD.rf";
    expect_published({{"file", file("Portra-400NCCD.rf")}, {"iso", "6"}},
                     {{{0, 0, 0}, {0, 0, 0}},
                      {{0.18, 0.18, 0.18}, {0.14158434938, 0.133298966244, 0.111933978898}},
                      {{1, 1, 1}, {0.377750770448, 0.366323471042, 0.33336182058}},
                      {{0.8, 0.1, 0.05}, {0.333340067444, 0.0926619018023, 0.0473372986355}},
                      {{0.05, 0.1, 2}, {0.0635985150404, 0.0926619018023, 0.512854431686}},
                      {{4, 2, 0.5}, {0.806275778072, 0.544127230408, 0.215527705427}},
                      {{16, 16, 16}, {1, 1, 1}},
                      {{1000, 100, 10}, {1, 1, 1}}});
}

TEST_F(MeasuredResponse, RedCurveOfDscs315IsAsPublished) {
    if (!fs::exists(file("dscs315-1.rf"))) GTEST_SKIP() << "no dscs315-1.rf";
    expect_published({{"file", file("dscs315-1.rf")}, {"curve", "red"}, {"iso", "6"}},
                     {{{0, 0, 0}, {0, 0, 0}},
                      {{0.18, 0.18, 0.18}, {0.125389013807, 0.125389013807, 0.125389013807}},
                      {{1, 1, 1}, {0.479768934182, 0.479768934182, 0.479768934182}},
                      {{0.8, 0.1, 0.05}, {0.409272132853, 0.0690840629049, 0.0331616196136}},
                      {{0.05, 0.1, 2}, {0.0331616196136, 0.0690840629049, 0.732364031649}},
                      {{4, 2, 0.5}, {0.913863788942, 0.732364031649, 0.292466458483}},
                      {{16, 16, 16}, {1, 1, 1}},
                      {{1000, 100, 10}, {1, 1, 1}}});
}

}  // namespace
TONEWRIGHT_NAMESPACE_END
