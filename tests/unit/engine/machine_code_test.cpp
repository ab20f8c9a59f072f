// SPDX-License-Identifier: Apache-2.0
//
// Machine code against the interpreter of the same program, which simd_program_test.cpp holds to
// the reference: the same bits, for every operator, every layout of pixels and every count.
#include "engine/machine_code.h"

#include <gtest/gtest.h>
#include <sys/mman.h>
#include <sys/wait.h>
#include <unistd.h>

#ifdef __linux__
#include <linux/filter.h>
#include <linux/seccomp.h>
#include <sys/prctl.h>
#include <sys/syscall.h>
#endif

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <cstddef>
#include <cstring>
#include <functional>
#include <iterator>
#include <string>
#include <vector>

#include "base/random.h"
#include "engine/simd_program.h"
#include "engine/tape.h"
#include "tonewright/engine.h"
#include "tonewright/registry.h"
#include "tonewright/view.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

/// Each instruction set of this processor that machine code is made for: an AVX-512 processor runs
/// the code for AVX2, too.
class MachineCode : public testing::TestWithParam<const char*> {
  protected:
    void SetUp() override {
        if (!simd::MachineCode::is_built_in()) GTEST_SKIP() << "built without xbyak";
        for (const simd::Target& target : simd::targets()) {
            if (target.name == std::string(GetParam())) target_ = &target;
        }
        if (!target_) GTEST_SKIP() << "this processor has no " << GetParam();
        ASSERT_TRUE(target_->machine);
    }
    [[nodiscard]] simd::Program compile(const Pipeline& pipeline, double max_error = kSimdError,
                                        bool has_curves = true,
                                        const LiveUniforms& uniforms = {}) const {
        return simd::compile(pipeline, max_error, *target_, has_curves, uniforms);
    }

  private:
    const simd::Target* target_ = nullptr;
};
INSTANTIATE_TEST_SUITE_P(All, MachineCode, testing::Values("AVX2", "AVX3"));

/// Every number that a float can be, and light.
std::vector<float> floats(std::size_t count) {
    SampleRandom random(7);
    std::vector<float> result(count);
    for (std::size_t i = 0; i < count; ++i) {
        if (i % 3 == 0) {
            const auto bits = static_cast<std::uint32_t>(random.uniform(0, 4294967295.0));
            std::memcpy(&result[i], &bits, sizeof bits);
        } else {
            result[i] = static_cast<float>(std::exp2(random.uniform(-14, 12)) *
                                           (random.uniform(0, 1) < 0.1 ? -1 : 1));
        }
    }
    return result;
}

/// Pixels `stride` floats apart; planes where it is 1. What lies around them stays as it is.
std::vector<float> run(const simd::Program& program, const std::vector<float>& in,
                       std::ptrdiff_t stride, std::size_t count) {
    std::vector<float> out(in.size(), -7.0F);
    const std::size_t step = stride == 1 ? in.size() / 3 : 1;
    simd::run(program, {in.data(), in.data() + step, in.data() + 2 * step}, stride,
              {out.data(), out.data() + step, out.data() + 2 * step}, stride, count);
    return out;
}

void expect_same_bits(simd::Program& program, const std::string& name) {
    static const std::vector<float> in = floats(4 * 1200);
    for (const std::ptrdiff_t stride : {1, 3, 4}) {
        for (std::size_t count = 0; count < 1200; count = count == 70 ? 1199 : count + 1) {
            const std::shared_ptr<const simd::MachineCode> machine = program.machine;
            const std::vector<float> got = run(program, in, stride, count);
            program.machine = nullptr;
            const std::vector<float> expected = run(program, in, stride, count);
            program.machine = machine;
            if (std::memcmp(got.data(), expected.data(), got.size() * sizeof(float)) == 0) continue;
            for (std::size_t i = 0; i < in.size(); ++i) {
                ASSERT_EQ(std::memcmp(&got[i], &expected[i], sizeof(float)), 0)
                    << name << ", stride " << stride << ", " << count << " pixels, float " << i
                    << ": machine code " << got[i] << ", interpreter " << expected[i];
            }
        }
    }
}

TEST_P(MachineCode, ComputesTheInterpretersBits) {
    for (const Operator& op : all_operators()) {
        for (const char* display : {"srgb", "linear"}) {
            simd::Program program =
                compile(build_view(make_view(resolve_operator(op.id), "lin_ap1", 1, display)),
                        op.bounds.simd_goal);
            ASSERT_TRUE(program.machine) << op.id;
            expect_same_bits(program, op.id + ", " + display);
            if (HasFatalFailure()) return;
        }
    }
}

TEST_P(MachineCode, ComputesTheInterpretersBitsAtAnyExposure) {
    const std::string exposure(kExposureUniform);
    for (const Operator& op : all_operators()) {
        if (op.is_local()) continue;
        simd::Program program = compile(
            build_live_view(make_view(resolve_operator(op.id), "lin_ap1", 0, "srgb"), {exposure}),
            op.bounds.simd_goal, true, {{exposure, {0, -16, 16}}});
        ASSERT_TRUE(program.machine) << op.id;
        ASSERT_FALSE(program.uniforms.empty()) << op.id;
        simd::set_uniforms(program, program.source->evaluate_numbers({{exposure, -3.3}}),
                           program.numbers);
        expect_same_bits(program, op.id);
        if (HasFatalFailure()) return;
    }
}

/// A processor with Intel's CET stops a call through a pointer that leads anywhere else than to an
/// ENDBR64 (Intel SDM, volume 1, chapter 17).
TEST_P(MachineCode, BeginsWhereIndirectCallsMayGo) {
    struct Functions : simd::MachineCode {
        static const auto& of(const simd::MachineCode& code) {
            return code.*(&Functions::function_);
        }
    };
    const simd::Program program =
        compile(build_view(make_view(resolve_operator("hable"), "lin_rec709", 0, "srgb")));
    ASSERT_TRUE(program.machine);
    constexpr unsigned char kEndbr64[] = {0xF3, 0x0F, 0x1E, 0xFA};
    for (const auto& parts : Functions::of(*program.machine)) {
        ASSERT_FALSE(parts.empty());
        for (const auto function : parts)
            EXPECT_EQ(std::memcmp(reinterpret_cast<const void*>(function), kEndbr64, 4), 0);
    }
}

#ifdef __linux__

/// From here on the system refuses memory that has all of these PROT_ bits.
bool refuse_memory(std::uint32_t protection) {
    constexpr auto kProtection = offsetof(seccomp_data, args) + 2 * sizeof(std::uint64_t);
    sock_filter filter[] = {
        BPF_STMT(BPF_LD | BPF_W | BPF_ABS, offsetof(seccomp_data, nr)),
        BPF_JUMP(BPF_JMP | BPF_JEQ | BPF_K, SYS_mprotect, 1, 0),
        BPF_JUMP(BPF_JMP | BPF_JEQ | BPF_K, SYS_mmap, 0, 4),
        BPF_STMT(BPF_LD | BPF_W | BPF_ABS, kProtection),
        BPF_STMT(BPF_ALU | BPF_AND | BPF_K, protection),
        BPF_JUMP(BPF_JMP | BPF_JEQ | BPF_K, protection, 0, 1),
        BPF_STMT(BPF_RET | BPF_K, SECCOMP_RET_ERRNO | EACCES),
        BPF_STMT(BPF_RET | BPF_K, SECCOMP_RET_ALLOW),
    };
    const sock_fprog filter_program = {std::size(filter), filter};
    return prctl(PR_SET_NO_NEW_PRIVS, 1, 0, 0, 0) == 0 &&
           prctl(PR_SET_SECCOMP, SECCOMP_MODE_FILTER, &filter_program) == 0;
}

/// Answer of a process with fewer rights.
enum Answer : int { kAsExpected = 40, kOtherwise, kNotSupported };

/// Runs `body` in a process of its own: what it gives up is given up for good.
int answer_of(const std::function<Answer()>& body) {
    const pid_t child = fork();
    if (child == 0) _exit(body());
    int status = 0;
    if (child < 0 || waitpid(child, &status, 0) != child) return -1;
    return WIFEXITED(status) ? WEXITSTATUS(status) : -WTERMSIG(status);
}

class MachineCodeMemory : public MachineCode {
  protected:
    /// Compiled in a process that has given up rights, an operator has machine code or not, and its
    /// pixels are the same.
    [[nodiscard]] int has_machine_code(bool expected,
                                       const std::function<bool()>& give_up_rights) const {
        const Pipeline view =
            build_view(make_view(resolve_operator("agx_blender"), "lin_rec709", 0, "srgb"));
        const std::vector<float> in = floats(3 * 100);
        const std::vector<float> pixels = run(compile(view), in, 3, 100);
        return answer_of([&] {
            if (!give_up_rights()) return kNotSupported;
            const simd::Program program = compile(view);
            const bool is_same = std::memcmp(run(program, in, 3, 100).data(), pixels.data(),
                                             pixels.size() * sizeof(float)) == 0;
            return (program.machine != nullptr) == expected && is_same ? kAsExpected : kOtherwise;
        });
    }
};
INSTANTIATE_TEST_SUITE_P(All, MachineCodeMemory, testing::Values("AVX2", "AVX3"));

TEST_P(MachineCodeMemory, IsNeverWritableAndExecutable) {
    const int answer = has_machine_code(true, [] { return refuse_memory(PROT_WRITE | PROT_EXEC); });
    if (answer == kNotSupported) GTEST_SKIP() << "no system call filters here";
    EXPECT_EQ(answer, kAsExpected);
}

TEST_P(MachineCodeMemory, IsDoneWithoutWhereNoneMayBeExecuted) {
    const int answer = has_machine_code(false, [] { return refuse_memory(PROT_EXEC); });
    if (answer == kNotSupported) GTEST_SKIP() << "no system call filters here";
    EXPECT_EQ(answer, kAsExpected);
}

/// systemd's MemoryDenyWriteExecute=yes, with the kernel's own means.
TEST_P(MachineCodeMemory, IsDoneWithoutWhereTheKernelRefusesIt) {
    constexpr int kSetMdwe = 65;              // PR_SET_MDWE, since Linux 6.3
    constexpr unsigned long kNoExecGain = 1;  // PR_MDWE_REFUSE_EXEC_GAIN
    const int answer =
        has_machine_code(false, [] { return prctl(kSetMdwe, kNoExecGain, 0UL, 0UL, 0UL) == 0; });
    if (answer == kNotSupported) GTEST_SKIP() << "the kernel has no PR_SET_MDWE";
    EXPECT_EQ(answer, kAsExpected);
}

#endif

/// Operations that no operator of the catalog uses by itself.
TEST_P(MachineCode, ComputesEveryOperation) {
    const Expr r = Expr::input(0);
    const Expr g = Expr::input(1);
    const Expr b = Expr::input(2);
    const std::vector<std::array<Expr, 3>> programs = {
        {{pow(abs(r), g), pow(r, Expr(3) + b * 0), pow(abs(r), Expr(5.5))}},
        {{sin(r), cos(g), atan2(r, b)}},
        {{exp2(min(r, Expr(20))), log2(abs(g)), sqrt(abs(b))}},
        {{select(less(r, g), b, r), select(less_equal(r, g), Expr(1), b),
          select(equal(floor(r), r), g, Expr(2))}},
        {{less(r, g), less_equal(g, r) + equal(r, b), -r}},
        {{Expr(0.25), r, g / b}},
        {{select(less(r, Expr(0.5)) * less(g, Expr(0.5)), b, g), r - g * b, g * b - r}},
    };
    for (std::size_t i = 0; i < programs.size(); ++i) {
        const CrossTalkStage stage{.f = programs[i]};
        for (const double max_error : {1e-6, 1e-12}) {  // the second computes in double
            simd::Program program = compile(Pipeline{stage}, max_error, false);
            ASSERT_TRUE(program.machine) << i;
            expect_same_bits(program, "program " + std::to_string(i));
            if (HasFatalFailure()) return;
        }
    }
}

/// Each channel hands on 400 values, which no other channel's may replace in the tile.
TEST_P(MachineCode, IsNotMadeOfMoreValuesThanATileHolds) {
    std::array<Expr, 3> rgb = {Expr::input(0), Expr::input(1), Expr::input(2)};
    for (Expr& channel : rgb) {
        Expr last = channel = sin(channel);
        for (int i = 0; i < 400; ++i) {
            last = sin(last);
            channel = last + channel;  // the last sine is computed before the sum
        }
        channel = channel / 400;
    }
    const simd::Program program = compile(Pipeline{CrossTalkStage{.f = rgb}}, 1e-6, false);
    EXPECT_FALSE(program.machine);
    const std::vector<float> in = floats(3 * 64);
    std::vector<double> expected(in.size());
    ReferenceEngine(Pipeline{CrossTalkStage{.f = rgb}}).run_rgb(in.data(), expected.data(), 64);
    std::vector<float> got(in.size());
    simd::run(program, {in.data(), in.data() + 1, in.data() + 2}, 3,
              {got.data(), got.data() + 1, got.data() + 2}, 3, 64);
    for (std::size_t i = 0; i < got.size(); ++i)
        EXPECT_NEAR(static_cast<double>(got[i]), expected[i], 1e-6) << i;
}

/// The last pixel ends where no page follows: reading or writing on ends the program.
TEST_P(MachineCode, TouchesNothingBehindTheLastPixel) {
    const auto page = static_cast<std::size_t>(sysconf(_SC_PAGESIZE));
    void* memory =
        mmap(nullptr, 4 * page, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
    ASSERT_NE(memory, MAP_FAILED);
    ASSERT_EQ(mprotect(static_cast<char*>(memory) + 3 * page, page, PROT_NONE), 0);
    auto* end = reinterpret_cast<float*>(static_cast<char*>(memory) + 3 * page);
    // One curve; curves and matrices; several parts.
    for (const char* name : {"hable", "agx_blender", "aces_20"}) {
        const simd::Program program =
            compile(build_view(make_view(resolve_operator(name), "lin_rec709", 0, "srgb")));
        ASSERT_TRUE(program.machine);
        for (const std::ptrdiff_t stride : {3, 4}) {
            for (std::ptrdiff_t count = 1; count <= 70; ++count) {
                // Three channels of the last pixel are ours, whatever the stride.
                float* pixels = end - (count * stride - (stride - 3));
                std::fill(pixels, end, 0.18F);
                simd::run(program, {pixels, pixels + 1, pixels + 2}, stride,
                          {pixels, pixels + 1, pixels + 2}, stride,
                          static_cast<std::size_t>(count));
                EXPECT_NE(end[-1], 0.18F);
            }
        }
    }
    munmap(memory, 4 * page);
}

TEST_P(MachineCode, WritesInPlaceAndBetweenLayouts) {
    simd::Program program =
        compile(build_view(make_view(resolve_operator("agx_blender"), "lin_rec709", 0, "srgb")));
    ASSERT_TRUE(program.machine);
    const std::vector<float> in = floats(4 * 999);
    const std::shared_ptr<const simd::MachineCode> machine = program.machine;
    program.machine = nullptr;
    const std::vector<float> expected = run(program, in, 4, 999);
    program.machine = machine;
    std::vector<float> pixels = in;
    simd::run(program, {pixels.data(), pixels.data() + 1, pixels.data() + 2}, 4,
              {pixels.data(), pixels.data() + 1, pixels.data() + 2}, 4, 999);
    std::vector<float> packed(3 * 999);
    simd::run(program, {in.data(), in.data() + 1, in.data() + 2}, 4,
              {packed.data(), packed.data() + 1, packed.data() + 2}, 3, 999);
    for (std::size_t i = 0; i < 999; ++i) {
        for (std::size_t c = 0; c < 3; ++c) {
            EXPECT_EQ(pixels[4 * i + c], expected[4 * i + c]) << i;
            EXPECT_EQ(packed[3 * i + c], expected[4 * i + c]) << i;
        }
        EXPECT_EQ(std::memcmp(&pixels[4 * i + 3], &in[4 * i + 3], sizeof(float)), 0) << i;
    }
}

}  // namespace
TONEWRIGHT_NAMESPACE_END
