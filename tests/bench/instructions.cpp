// SPDX-License-Identifier: Apache-2.0
//
// Runs the engine of each operator once on the same pixels, for test_instructions.py to count the
// instructions of. On AVX2, for valgrind knows no AVX-512.
//
//   tonewright_instructions PIXELS OPERATOR...
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <exception>
#include <string>
#include <vector>

#include "base/random.h"
#include "tonewright/engine.h"
#include "tonewright/registry.h"
#include "tonewright/view.h"

/// The function to count. It has a name and a frame of its own: neither inlined nor left by a jump.
extern "C" [[gnu::noinline]] void counted_run(const tonewright::SimdEngine& engine, const float* in,
                                              float* out, std::size_t pixels) {
    engine.run({in, in + 1, in + 2}, 3, {out, out + 1, out + 2}, 3, pixels);
    asm volatile("");
}

int main(int argc, char** argv) {
    using namespace tonewright;  // NOLINT(google-build-using-namespace): this is its program
    constexpr const char* kTarget = "AVX2";
    const std::vector<std::string> targets = SimdEngine::targets();
    if (std::find(targets.begin(), targets.end(), kTarget) == targets.end()) {
        std::printf("skipped: this machine has no %s\n", kTarget);
        return 77;
    }
    try {
        const std::size_t pixels = std::stoul(argc > 1 ? argv[1] : "0");
        SampleRandom random(1);
        std::vector<float> in(3 * pixels), out(3 * pixels);
        for (float& x : in)
            x = static_cast<float>(std::exp2(random.uniform(-10, 6)));
        for (int i = 2; i < argc; ++i) {
            const View view = make_view(resolve_operator(argv[i]), "lin_rec709", 0, "srgb");
            const SimdEngine engine(build_view(view), view.op.op->bounds.simd_goal, kTarget);
            counted_run(engine, in.data(), out.data(), pixels);
        }
    } catch (const std::exception& e) {
        std::fprintf(stderr, "%s\n", e.what());
        return 1;
    }
    return 0;
}
