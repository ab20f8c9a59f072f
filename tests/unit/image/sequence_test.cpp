// SPDX-License-Identifier: Apache-2.0
#include "tonewright/sequence.h"
#include "tonewright/registry.h"

#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <fstream>
#include <set>

#include "image/picture_file.h"
#include "tonewright/image_io.h"
#include "tonewright/tonemap.h"
#include "unit/folder.h"
#include "unit/image/pictures.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

namespace fs = std::filesystem;
using namespace std::chrono_literals;
using OIIO::TypeDesc;

class Sequence : public testing::Test {
  protected:
    /// Writes pictures, an hour ago.
    std::vector<FrameFiles> make_frames(int count, const std::string& extension) {
        std::vector<FrameFiles> frames;
        for (int i = 0; i < count; ++i) {
            const std::string number = std::to_string(i);
            frames.push_back(
                {folder_ / ("in." + number + ".exr"), folder_ / ("out." + number + extension)});
            write_image_atomically(make_rgb(40, 30, TypeDesc::HALF, 1.0F + static_cast<float>(i)),
                                   frames.back().in);
            fs::last_write_time(frames.back().in, fs::file_time_type::clock::now() - 1h);
            fs::remove(frames.back().out);
        }
        return frames;
    }
    static std::vector<FrameFiles> fresh(const std::vector<FrameFiles>& frames) {
        std::vector<FrameFiles> result;
        for (const FrameFiles& frame : frames)
            result.push_back({frame.in, frame.out});
        return result;
    }
    /// The places of the frames that were left as they were.
    std::vector<int> skipped(const std::vector<FrameFiles>& frames, TypeDesc type,
                             const std::string& op = "hable") {
        std::vector<FrameFiles> again = fresh(frames);
        SequenceOptions options;
        options.write.type = type;
        options.skip_existing = true;
        options.nthreads = 3;
        tonemap_files(Tonemapper({.op = resolve_picture_operator(op)}), again, options);
        std::vector<int> result;
        for (std::size_t i = 0; i < again.size(); ++i) {
            EXPECT_FALSE(again[i].problem);
            if (again[i].is_skipped) result.push_back(static_cast<int>(i));
        }
        return result;
    }
    [[nodiscard]] std::set<std::string> names() const {
        std::set<std::string> result;
        for (const auto& entry : fs::directory_iterator(folder_.path()))
            result.insert(entry.path().filename());
        return result;
    }

    Folder folder_;
};

TEST_F(Sequence, OneFrameThatFailsDoesNotStopTheOthers) {
    const std::vector<FrameFiles> all = make_frames(7, ".png");
    fs::remove(all[2].in);
    write_image_atomically(make_picture(make_spec(40, 30, {"X", "Y"}, TypeDesc::HALF)), all[4].in);
    const Tonemapper tonemapper({.op = resolve_picture_operator("hable")});
    for (const int threads : {1, 3, 16}) {
        for (const int jobs : {0, 1, 2, 20}) {
            std::vector<FrameFiles> frames = fresh(all);
            std::vector<std::string> done;
            SequenceOptions options;
            options.write.type = TypeDesc::UINT8;
            options.jobs = jobs;
            options.nthreads = threads;
            options.done = [&](const FrameFiles& frame) { done.push_back(frame.in); };
            tonemap_files(tonemapper, frames, options);
            EXPECT_EQ(done.size(), 7U);
            EXPECT_EQ(std::set(done.begin(), done.end()).size(), 7U);
            for (std::size_t i = 0; i < 7; ++i) {
                const FrameFiles& frame = frames[i];
                EXPECT_EQ(frame.problem.has_value(), i == 2 || i == 4);
                EXPECT_EQ(frame.problem.value_or(Problem{.kind = Problem::Kind::file}).kind,
                          Problem::Kind::file);
                EXPECT_FALSE(frame.is_skipped);
                EXPECT_EQ(fs::exists(frame.out), !frame.problem);
                fs::remove(frame.out);
            }
        }
    }
    std::vector<FrameFiles> none;
    tonemap_files(tonemapper, none);
}

TEST_F(Sequence, SkipsCompleteNewerFramesOfTheSameSizeAndType) {
    for (const std::string extension : {".png", ".exr", ".tif", ".dpx", ".sgi", ".jpg"}) {
        const std::vector<FrameFiles> frames = make_frames(6, extension);
        EXPECT_EQ(skipped(frames, TypeDesc::UINT8), std::vector<int>{}) << extension;
        const std::vector<int> all = {0, 1, 2, 3, 4, 5};
        EXPECT_EQ(skipped(frames, TypeDesc::UINT8), all) << extension;
        EXPECT_EQ(skipped(frames, TypeDesc::UINT8, "drago"), all) << "it cannot know";

        const std::string whole = read(frames[0].out);
        std::ofstream(frames[0].out, std::ios::binary) << whole.substr(0, whole.size() * 3 / 4);
        std::ofstream(frames[1].out, std::ios::binary) << "";
        fs::last_write_time(frames[2].out, fs::last_write_time(frames[2].in));  // as old
        write_image_atomically(make_rgb(41, 30), frames[3].out, TypeDesc::UINT8);
        fs::remove(frames[4].out);
        EXPECT_EQ(skipped(frames, TypeDesc::UINT8), std::vector<int>{5}) << extension;
        // OIIO 2.4 leaves bytes of an SGI file's header to chance.
        EXPECT_TRUE(read(frames[0].out) == whole || extension == ".sgi") << extension;
        EXPECT_EQ(skipped(frames, TypeDesc::UINT8), all) << extension;
        fs::last_write_time(frames[1].in, fs::file_time_type::clock::now() + 1min);
        EXPECT_EQ(skipped(frames, TypeDesc::UINT8), (std::vector<int>{0, 2, 3, 4, 5}));
    }
    // 8 bits become half floats in EXR, and float ones 16 bits in PNG.
    const std::vector<FrameFiles> png = make_frames(2, ".png"), exr = make_frames(2, ".exr");
    const std::vector<int> both = {0, 1};
    EXPECT_EQ(skipped(exr, TypeDesc::UINT8), std::vector<int>{});
    EXPECT_EQ(skipped(exr, TypeDesc::HALF), both);
    EXPECT_EQ(skipped(exr, TypeDesc::FLOAT), std::vector<int>{});
    EXPECT_EQ(skipped(exr, TypeDesc::HALF), std::vector<int>{});
    EXPECT_EQ(skipped(png, TypeDesc::UINT16), std::vector<int>{});
    EXPECT_EQ(skipped(png, TypeDesc::UINT16), both);
    EXPECT_EQ(skipped(png, TypeDesc::UINT8), std::vector<int>{});
    EXPECT_EQ(skipped(png, TypeDesc::UNKNOWN), both) << "8 bits is what PNG has by default";
    // Pixels outside of the display window, which the format cannot hold.
    OIIO::ImageSpec spec = make_spec(40, 30, {"R", "G", "B", "A"}, TypeDesc::HALF);
    spec.x = 5;
    spec.full_width = 60;
    write_image_atomically(make_picture(spec), png[0].in);
    fs::last_write_time(png[0].in, fs::file_time_type::clock::now() - 1h);
    EXPECT_EQ(skipped(png, TypeDesc::UINT8), std::vector<int>{1});
    EXPECT_EQ(skipped(png, TypeDesc::UINT8), both);
}

TEST_F(Sequence, TheSameBytesAgainWithoutADate) {
    // EXR, TIFF and DPX would take the time of writing.
    for (const std::string extension : {".exr", ".tif", ".dpx"}) {
        std::vector<FrameFiles> frames = make_frames(1, extension);
        OIIO::ImageBuf dateless = make_rgb(40, 30, TypeDesc::HALF);
        const std::string hdr = folder_ / "in.hdr";  // holds no date
        write_image_atomically(dateless, hdr, TypeDesc::FLOAT);
        ASSERT_EQ(read_image(hdr).spec().find_attribute("DateTime"), nullptr);
        // 2001-09-09 01:46:40 UTC is a thousand million seconds after 1970.
        fs::last_write_time(hdr, std::chrono::file_clock::from_sys(
                                     std::chrono::sys_seconds(std::chrono::seconds(1000000000))));
        frames[0].in = hdr;
        tonemap_files(Tonemapper({.op = resolve_picture_operator("hable")}), frames);
        ASSERT_FALSE(frames[0].problem);
        const std::string date = read_image(frames[0].out).spec().get_string_attribute("DateTime");
        EXPECT_EQ(date, "2001:09:09 01:46:40") << extension;
    }
}

TEST_F(Sequence, LeftoversOfKilledRunsAreRemoved) {
    std::vector<FrameFiles> frames = make_frames(2, ".png");
    // The name of a temporary file of this process, and so what stands for this machine.
    PictureWriter writer(frames[0].out);
    writer.open(make_rgb(4, 4).spec());
    std::string own;
    for (const std::string& name : names()) {
        if (name.starts_with(".out.0.")) own = name;
    }
    const std::string pid = std::to_string(::getpid());
    ASSERT_EQ(own.substr(15, pid.size() + 1), "." + pid) << own;
    const std::string machine = own.substr(7, 8);
    const pid_t child = ::fork();
    if (child == 0) ::_exit(0);
    ::waitpid(child, nullptr, 0);  // a process that is no more
    const std::string dead = std::to_string(child);
    const std::string other = machine == "00000000" ? "00000001" : "00000000";

    const std::set<std::string> stay = {
        own,
        ".out.0." + machine + "." + pid + ".77.tmp.png",  // this process is alive
        ".out.0." + machine + ".1.0.tmp.png",             // so is that
        ".out.0." + other + "." + dead + ".0.tmp.png",    // of another machine, young
        ".out.2." + machine + "." + dead + ".0.tmp.png",  // no frame of these
        ".out.0." + machine + "." + dead + ".0.tmp.exr",  // another file
        ".out.0." + machine + "." + dead + ".tmp.png",    // another kind of name
        "out.0." + machine + "." + dead + ".0.tmp.png",
    };
    const std::set<std::string> go = {
        ".out.0." + machine + "." + dead + ".0.tmp.png",
        ".out.1." + machine + "." + dead + ".12.tmp.png",
    };
    const std::set<std::string> old = {".out.0." + other + "." + dead + ".3.tmp.png"};
    std::set<std::string> expected = {"in.0.exr", "in.1.exr", "out.0.png", "out.1.png"};
    for (const auto& some : {stay, go, old}) {
        for (const std::string& name : some) {
            if (name != own) std::ofstream(folder_ / name) << "x";
        }
    }
    for (const std::string& name : old)
        fs::last_write_time(folder_ / name, fs::file_time_type::clock::now() - 25h);
    expected.insert(stay.begin(), stay.end());
    tonemap_files(Tonemapper({.op = resolve_picture_operator("hable")}), frames);
    EXPECT_EQ(names(), expected);
}

TEST_F(Sequence, FilesThatMayNotBeWrittenStay) {
    if (::geteuid() == 0) GTEST_SKIP() << "root may write into any file";
    std::vector<FrameFiles> frames = make_frames(1, ".png");
    std::ofstream(frames[0].out) << "old";
    fs::permissions(frames[0].out, fs::perms::owner_read);
    tonemap_files(Tonemapper({.op = resolve_picture_operator("hable")}), frames);
    ASSERT_TRUE(frames[0].problem);
    EXPECT_EQ(render(*frames[0].problem), frames[0].out + ": cannot write: Permission denied");
    EXPECT_EQ(read(frames[0].out), "old");
}

}  // namespace
TONEWRIGHT_NAMESPACE_END
