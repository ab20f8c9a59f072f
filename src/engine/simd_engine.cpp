// SPDX-License-Identifier: Apache-2.0
//
// SimdEngine: a program, and the choice between its machine code and the interpreter.
#include <algorithm>
#include <optional>

#include "engine/machine_code.h"
#include "engine/simd_kernels.h"
#include "engine/simd_program.h"
#include "engine/tape.h"
#include "tonewright/engine.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace simd {
namespace {

/// Runs the parts of the machine code one after the other over a tile.
void run_parts(const MachineCode& code, const Numbers& numbers, PixelLayout layout, int lanes,
               unsigned char* tile, const float* in, float* out, std::size_t count) {
    for (std::size_t part = 0; part < code.part_count(layout); ++part)
        code.run(part, layout, numbers, tile, in, out, count / static_cast<std::size_t>(lanes));
}

void run_machine_code(const Program& program, const Numbers& numbers,
                      const std::array<const float*, 3>& in, std::ptrdiff_t in_stride,
                      const std::array<float*, 3>& out, std::ptrdiff_t out_stride,
                      std::size_t count) noexcept {
    alignas(kVectorBytes) unsigned char tile[kRegisterFileBytes];
    const Target& target = *program.target;
    const int lanes = target.machine->lanes;
    const std::size_t tile_pixels = program.machine->program().tile;
    std::size_t done = 0;
    if (in_stride == out_stride && are_interleaved(in, in_stride) &&
        are_interleaved(out, out_stride)) {
        const PixelLayout layout = in_stride == 3 ? PixelLayout::rgb : PixelLayout::rgba;
        const auto stride = static_cast<std::size_t>(in_stride);
        // The floats after the last pixel's three channels belong to the caller.
        const std::size_t whole =
            (stride == 4 && count > 0 ? count - 1 : count) / kLaneMultiple * kLaneMultiple;
        // Code of one part keeps nothing in a tile, so it runs over all pixels at once.
        const std::size_t step = program.machine->part_count(layout) == 1
                                     ? std::max<std::size_t>(whole, 1)
                                     : tile_pixels;
        for (; done < whole; done += std::min(step, whole - done)) {
            run_parts(*program.machine, numbers, layout, lanes, tile, in[0] + done * stride,
                      out[0] + done * stride, std::min(step, whole - done));
        }
    }
    // Copies the last pixels, and all pixels of other layouts.
    alignas(kVectorBytes) float rgb[3 * kMaxTile];
    for (; done < count; done += std::min(tile_pixels, count - done)) {
        const std::size_t n = std::min(tile_pixels, count - done);
        const std::size_t padded = (n + kLaneMultiple - 1) / kLaneMultiple * kLaneMultiple;
        target.pack(from(in, in_stride, done), in_stride, n, padded, rgb);
        run_parts(*program.machine, numbers, PixelLayout::rgb, lanes, tile, rgb, rgb, padded);
        target.unpack(rgb, from(out, out_stride, done), out_stride, n);
    }
}

}  // namespace

void run(const Program& program, const Numbers& numbers, const std::array<const float*, 3>& in,
         std::ptrdiff_t in_stride, const std::array<float*, 3>& out, std::ptrdiff_t out_stride,
         std::size_t count) noexcept {
    const auto runner = program.machine ? run_machine_code : program.target->interpret;
    runner(program, numbers, in, in_stride, out, out_stride, count);
}

}  // namespace simd

struct SimdEngine::Program {
    std::shared_ptr<const simd::Program> compiled;
    /// Numbers with other values of uniforms. Empty: the compiled program's own.
    std::optional<simd::Numbers> numbers;

    explicit Program(simd::Program program)
        : compiled(std::make_shared<const simd::Program>(std::move(program))) {}
};

SimdEngine::SimdEngine(std::unique_ptr<const Program> program) : program_(std::move(program)) {}

SimdEngine::SimdEngine(const Pipeline& pipeline, double max_error, std::string_view target)
    : SimdEngine(pipeline, LiveUniforms{}, max_error, target) {}
SimdEngine::SimdEngine(const Pipeline& pipeline, const LiveUniforms& uniforms, double max_error,
                       std::string_view target)
    : program_(std::make_unique<const Program>(
          simd::compile(pipeline, max_error, simd::find_target(target), true, uniforms))) {}
SimdEngine::~SimdEngine() = default;
SimdEngine::SimdEngine(SimdEngine&&) noexcept = default;
SimdEngine& SimdEngine::operator=(SimdEngine&&) noexcept = default;

void SimdEngine::run(const std::array<const float*, 3>& in, std::ptrdiff_t in_stride,
                     const std::array<float*, 3>& out, std::ptrdiff_t out_stride,
                     std::size_t count) const noexcept {
    const Program& program = *program_;
    simd::run(*program.compiled, program.numbers ? *program.numbers : program.compiled->numbers, in,
              in_stride, out, out_stride, count);
}

void SimdEngine::run_rgb(const float* in, float* out, std::size_t pixel_count) const noexcept {
    run({in, in + 1, in + 2}, 3, {out, out + 1, out + 2}, 3, pixel_count);
}

SimdEngine SimdEngine::with_uniforms(const UniformValues& values) const {
    const simd::Program& compiled = *program_->compiled;
    auto program = std::make_unique<Program>(*program_);
    program->numbers = compiled.numbers;
    simd::set_uniforms(compiled, compiled.source->evaluate_numbers(values), *program->numbers);
    return SimdEngine(std::unique_ptr<const Program>(std::move(program)));
}

std::vector<std::string> SimdEngine::targets() {
    std::vector<std::string> names;
    for (const simd::Target& target : simd::targets())
        names.emplace_back(target.name);
    return names;
}

std::vector<SimdEngine> SimdEngine::of_all_targets(const Pipeline& pipeline, double max_error) {
    std::vector<SimdEngine> engines;
    for (simd::Program& program : simd::compile_for_all_targets(pipeline, max_error)) {
        engines.push_back(SimdEngine(std::make_unique<const Program>(std::move(program))));
    }
    return engines;
}

TONEWRIGHT_NAMESPACE_END
