// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <string>
#include <vector>

#include "engine/reference_operations.h"
#include "engine/tape.h"
#include "expr/grid_place.h"
#include "expr/scalar_ops.h"
#include "tonewright/engine.h"
#include "tonewright/error.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

/// Pixels of a tile, if the live values leave room for so many.
constexpr std::size_t kTile = 128;
/// Doubles of a tile, on the stack of the running thread: its 32 KiB stay in the cache. The
/// operators of the catalog have at most 35 live values.
constexpr std::size_t kTileDoubles = 4096;

/// One operation over a tile. The operation is chosen outside the loop, so that the plain ones
/// become vector code; each computes exactly scalar_op().
template <ExprOp op>
[[gnu::always_inline]] inline void run_with_any_target(double* out, const double* a,
                                                       const double* b, const double* c,
                                                       const Table* table, std::size_t count) {
    for (std::size_t i = 0; i < count; ++i)
        out[i] = scalar_op(op, a[i], b[i], c[i], table);
}

struct Baseline {
    template <ExprOp op>
    static void run(double* out, const double* a, const double* b, const double* c,
                    const Table* table, std::size_t n) {
        run_with_any_target<op>(out, a, b, c, table, n);
    }
};

#if defined(__x86_64__) && defined(__GNUC__)
/// AVX2 has no fused multiply-add, so the bits are the same.
struct Avx2 {
    template <ExprOp op>
    [[gnu::target("avx2")]] static void run(double* out, const double* a, const double* b,
                                            const double* c, const Table* table, std::size_t n) {
        run_with_any_target<op>(out, a, b, c, table, n);
    }
};
#endif

template <class Target, std::size_t... kOp>
constexpr auto all_operations(std::index_sequence<kOp...> /*all*/) {
    return std::array{&Target::template run<static_cast<ExprOp>(kOp)>...};
}
template <class Target>
void run_on(const TapeInstruction& step, double* out, const double* a, const double* b,
            const double* c, std::size_t n) {
    static constexpr auto kAll =
        all_operations<Target>(std::make_index_sequence<std::size(kScalarOperations)>());
    kAll[static_cast<std::size_t>(step.op)](out, a, b, c, step.table, n);
}

/// Channels of a grid that several instructions read at the same place. The place is computed once.
struct GridChannels {
    std::size_t count = 0;
    std::array<std::size_t, 3> channel{};
    std::array<double*, 3> out{};
};

void run_grid(const Grid& grid, const GridChannels& channels, const double* a, const double* b,
              const double* c, std::size_t n) noexcept {
    const double* const nodes = grid.nodes().data();
    for (std::size_t i = 0; i < n; ++i) {
        const GridPlace place(grid.edge(), {a[i], b[i], c[i]});
        for (std::size_t k = 0; k < channels.count; ++k)
            channels.out[k][i] = place.interpolate(nodes + channels.channel[k]);
    }
}

}  // namespace

RunInstruction reference_operations() {
#if defined(__x86_64__) && defined(__GNUC__)
    static const bool has_avx2 = __builtin_cpu_supports("avx2") != 0;
    if (has_avx2) return run_on<Avx2>;
#endif
    return run_on<Baseline>;
}

/// The tape with a register for each value. run() allocates no memory.
struct ReferenceEngine::Program {
    /// A tile of one value: among the constants, or among the registers on the stack.
    struct Row {
        std::size_t index = 0;   // number of the register
        std::size_t offset = 0;  // start of its tile
        bool is_constant = false;
    };
    struct Step {
        const TapeInstruction* instruction;
        Row out, a, b, c;

        /// True if the step reads the same grid at the same place.
        [[nodiscard]] bool is_at_place_of(const Step& other) const {
            const TapeInstruction& i = *instruction;
            const TapeInstruction& o = *other.instruction;
            return i.grid && i.grid == o.grid && i.a == o.a && i.b == o.b && i.c == o.c;
        }
    };

    Tape tape;
    std::size_t tile = 0;
    std::vector<double> constants;
    std::vector<Step> steps;
    std::array<Row, 3> outputs;

    explicit Program(const Pipeline& pipeline) : tape(pipeline) {
        const std::vector<TapeInstruction>& code = tape.code();
        std::vector<std::array<std::int64_t, 4>> operands;
        std::vector<bool> needs_register;
        for (const TapeInstruction& step : code) {
            // run() must not throw, so the functions of users run here.
            if (step.grid) (void)step.grid->nodes();
            std::array<std::int64_t, 4> read = {-1, -1, -1, -1};
            const std::array<std::uint32_t, 3> all = {step.a, step.b, step.c};
            for (std::size_t k = 0; k < static_cast<std::size_t>(operand_count(step.op)); ++k)
                read[k] = all[k];
            operands.push_back(read);
            needs_register.push_back(step.op != ExprOp::constant);
        }
        const RegisterAllocation registers = allocate_registers(
            operands, needs_register, {tape.outputs().begin(), tape.outputs().end()});
        const std::size_t live = std::max<std::size_t>(registers.register_count, 1);
        if (live > kTileDoubles) {
            throw Error("reference engine: live values are " + std::to_string(live) +
                        "; expected at most " + std::to_string(kTileDoubles));
        }
        tile = std::min(kTile, kTileDoubles / live);

        std::vector<Row> rows;
        for (std::size_t i = 0; i < code.size(); ++i) {
            const TapeInstruction& step = code[i];
            if (step.op == ExprOp::constant) {
                rows.push_back({0, constants.size(), true});
                constants.insert(constants.end(), tile, step.value);
                continue;
            }
            rows.push_back({registers.register_of[i], registers.register_of[i] * tile, false});
            // The first operand replaces operands that the operation does not have.
            const int count = operand_count(step.op);
            const Row a = count > 0 ? rows[step.a] : rows[i];
            steps.push_back(
                {&step, rows[i], a, count > 1 ? rows[step.b] : a, count > 2 ? rows[step.c] : a});
        }
        for (std::size_t c = 0; c < 3; ++c)
            outputs[c] = rows[tape.outputs()[c]];
    }
};

ReferenceEngine::ReferenceEngine(const Pipeline& pipeline)
    : program_(std::make_unique<const Program>(pipeline)) {}
ReferenceEngine::~ReferenceEngine() = default;
ReferenceEngine::ReferenceEngine(ReferenceEngine&&) noexcept = default;
ReferenceEngine& ReferenceEngine::operator=(ReferenceEngine&&) noexcept = default;

void ReferenceEngine::run(const std::array<const double*, 3>& in, const std::array<double*, 3>& out,
                          std::size_t count) const noexcept {
    const Program& program = *program_;
    const RunInstruction run_step = reference_operations();
    alignas(64) std::array<double, kTileDoubles> registers;
    const auto read = [&](const Program::Row& row) -> const double* {
        return (row.is_constant ? program.constants.data() : registers.data()) + row.offset;
    };
    for (std::size_t begin = 0; begin < count; begin += program.tile) {
        const std::size_t n = std::min(program.tile, count - begin);
        for (auto at = program.steps.begin(); at != program.steps.end(); ++at) {
            const Program::Step& step = *at;
            double* const result = registers.data() + step.out.offset;
            if (step.instruction->op == ExprOp::input) {
                const double* plane = in[static_cast<std::size_t>(step.instruction->input)] + begin;
                const bool is_limited = step.instruction->is_limited;
                for (std::size_t k = 0; k < n; ++k)
                    result[k] = is_limited ? sanitize(plane[k]) : without_nan(plane[k]);
            } else if (step.instruction->op == ExprOp::grid) {
                GridChannels channels;
                const auto add = [&](const Program::Step& same) {
                    channels.channel[channels.count] =
                        static_cast<std::size_t>(same.instruction->input);
                    channels.out[channels.count] = registers.data() + same.out.offset;
                    ++channels.count;
                };
                add(step);
                while (channels.count < 3 && at + 1 != program.steps.end() &&
                       (at + 1)->is_at_place_of(step))
                    add(*++at);
                run_grid(*step.instruction->grid, channels, read(step.a), read(step.b),
                         read(step.c), n);
            } else {
                run_step(*step.instruction, result, read(step.a), read(step.b), read(step.c), n);
            }
        }
        for (std::size_t c = 0; c < 3; ++c)
            std::copy_n(read(program.outputs[c]), n, out[c] + begin);
    }
}

Vector3 ReferenceEngine::operator()(const Vector3& rgb) const noexcept {
    const Program& program = *program_;
    // These registers are side by side. A tile apart, they would push each other out of the cache.
    alignas(64) std::array<double, kTileDoubles> registers;
    const auto read = [&](const Program::Row& row) {
        return row.is_constant ? program.constants[row.offset] : registers[row.index];
    };
    for (const Program::Step& step : program.steps) {
        const TapeInstruction& instruction = *step.instruction;
        double& result = registers[step.out.index];
        if (instruction.op == ExprOp::input) {
            const double x = rgb[static_cast<std::size_t>(instruction.input)];
            result = instruction.is_limited ? sanitize(x) : without_nan(x);
        } else if (instruction.op == ExprOp::grid) {
            result =
                (*instruction.grid)(instruction.input, read(step.a), read(step.b), read(step.c));
        } else {
            result = scalar_op(instruction.op, read(step.a), read(step.b), read(step.c),
                               instruction.table);
        }
    }
    return {read(program.outputs[0]), read(program.outputs[1]), read(program.outputs[2])};
}

void ReferenceEngine::run_rgb(const float* in, double* out,
                              std::size_t pixel_count) const noexcept {
    constexpr std::size_t kChunk = kTile;
    std::array<std::array<double, kChunk>, 3> planes;
    const std::array<double*, 3> plane = {planes[0].data(), planes[1].data(), planes[2].data()};
    for (std::size_t begin = 0; begin < pixel_count; begin += kChunk) {
        const std::size_t n = std::min(kChunk, pixel_count - begin);
        for (std::size_t i = 0; i < n; ++i) {
            for (std::size_t c = 0; c < 3; ++c) {
                plane[c][i] = static_cast<double>(in[(begin + i) * 3 + c]);
            }
        }
        run({plane[0], plane[1], plane[2]}, plane, n);
        for (std::size_t i = 0; i < n; ++i) {
            for (std::size_t c = 0; c < 3; ++c)
                out[(begin + i) * 3 + c] = plane[c][i];
        }
    }
}

TONEWRIGHT_NAMESPACE_END
