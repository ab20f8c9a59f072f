// SPDX-License-Identifier: Apache-2.0
#include "engine/vector_code.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <map>

#include "engine/schedule.h"
#include "engine/simd_kernels.h"
#include "engine/vector_writer-inl.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace simd {
namespace {

constexpr std::int32_t kNone = VectorOperand::kNone;
/// Bytes of a tile, which stays in a first-level cache of 32 KiB.
constexpr std::size_t kTileBytes = std::size_t{24} * 1024;
/// A cut costs one unit, and one more for each vector handed on. A part of n instructions costs
/// (n / kLengthOfOneVector)^2: in a long part, the processor cannot begin with the next pixels
/// while it waits for results. With 89, eight operators are 2 % slower (Emerald Rapids). With 145,
/// they are slower with AVX2 only.
constexpr double kLengthOfOneVector = 114;
constexpr std::size_t kLongestPart = 2000;

/// The element for value v.
auto& at(auto& by_value, std::int32_t v) { return by_value[static_cast<std::size_t>(v)]; }

/// Divides a program into parts, and finds the vectors that parts hand on to later ones.
class Division {
  public:
    explicit Division(const VectorCode& code)
        : code_(code),
          first_(static_cast<std::size_t>(code.value_count)),
          last_(first_.size()),
          plane_(first_.size()) {
        const std::size_t n = code.instructions.size();
        // Number of live vectors before each instruction. Masks and indices are never handed on, so
        // there is no cut while one is alive.
        constexpr double kNeverCut = kInfinity;
        std::vector<double> alive(n + 1);
        const auto add = [&](std::size_t from, std::size_t to, double count) {
            for (std::size_t i = from + 1; i <= to; ++i)
                alive[i] += count;
        };
        std::array<std::size_t, 4> spill{};
        for (std::size_t i = 0; i < n; ++i) {
            const VectorInstruction& step = code.instructions[i];
            for (const VectorOperand& operand : step.in) {
                if (operand.is_value()) at(last_, operand.value) = i;
            }
            if (step.mask != kNone) at(last_, step.mask) = i;
            if (step.result != kNone) at(first_, step.result) = i;
            if (step.op == VectorOp::spill_index) spill[step.immediate] = i;
            if (step.op == VectorOp::rows) add(spill[step.immediate % 4], i, kNeverCut);
        }
        for (std::size_t v = 0; v < first_.size(); ++v)
            add(first_[v], last_[v], makes_mask(code.instructions[first_[v]].op) ? kNeverCut : 1);
        // For each possible end of a part: the least cost up to it, and the start of that part.
        std::vector<double> cost(n + 1, kInfinity);
        std::vector<std::size_t> begin(n + 1);
        cost[0] = 0;
        // Starts of parts that a later start may not replace: an earlier start makes a longer part,
        // so it counts only while it costs less.
        std::vector<double> cost_of_start(n);
        std::vector<std::size_t> starts;
        for (std::size_t end = 1; end <= n; ++end) {
            cost_of_start[end - 1] = cost[end - 1] + 1 + alive[end - 1];
            while (!starts.empty() && cost_of_start[starts.back()] >= cost_of_start[end - 1])
                starts.pop_back();
            starts.push_back(end - 1);
            for (const std::size_t i : starts) {
                if (end - i > kLongestPart) continue;
                const double length = static_cast<double>(end - i) / kLengthOfOneVector;
                const double here = cost_of_start[i] + length * length;
                if (here >= cost[end]) continue;
                cost[end] = here;
                begin[end] = i;
            }
        }
        for (std::size_t end = n; end > 0; end = begin[end])
            ends_.insert(ends_.begin(), end);
        for (std::size_t v = 0; v < first_.size(); ++v) {
            if (part_of(first_[v]) < part_of(last_[v])) plane_[v] = planes_++;
        }
    }

    /// Number of planes in a tile. A plane holds a vector for each block of pixels.
    [[nodiscard]] std::size_t planes() const { return planes_; }

    [[nodiscard]] std::vector<VectorCode> parts(std::size_t plane_bytes) const {
        std::vector<VectorCode> result;
        std::size_t begin = 0;
        for (const std::size_t end : ends_) {
            VectorCode part;
            std::map<std::int32_t, std::int32_t> number;  // the part's own numbers of its values
            const auto offset_of = [&](std::int32_t v) {
                return static_cast<std::uint32_t>(at(plane_, v) * plane_bytes);
            };
            const auto renumber = [&](std::int32_t& value) {
                if (value == kNone) return;
                const auto [it, is_new] =
                    number.try_emplace(value, static_cast<std::int32_t>(number.size()));
                if (is_new && at(first_, value) < begin)
                    part.instructions.push_back({.op = VectorOp::load_plane,
                                                 .offset = offset_of(value),
                                                 .result = it->second});
                value = it->second;
            };
            for (std::size_t i = begin; i < end; ++i) {
                VectorInstruction step = code_.instructions[i];
                const std::int32_t made = step.result;
                for (VectorOperand& operand : step.in)
                    renumber(operand.value);
                renumber(step.mask);
                renumber(step.result);
                part.instructions.push_back(step);
                if (made != kNone && at(last_, made) >= end)
                    part.instructions.push_back({.op = VectorOp::store_plane,
                                                 .offset = offset_of(made),
                                                 .in = {{{step.result}}}});
            }
            part.value_count = static_cast<std::int32_t>(number.size());
            result.push_back(scheduled(part));
            begin = end;
        }
        return result;
    }

  private:
    [[nodiscard]] std::ptrdiff_t part_of(std::size_t i) const {
        return std::upper_bound(ends_.begin(), ends_.end(), i) - ends_.begin();
    }

    const VectorCode& code_;
    std::vector<std::size_t> first_, last_;  // instructions that make a value and read it last
    std::vector<std::size_t> ends_;
    std::vector<std::size_t> plane_;  // of each value that is handed on
    std::size_t planes_ = 0;
};

/// A value for all pixels of a block: a vector of floats, two vectors of doubles, or both.
struct Lanes {
    VF narrow;
    Doubles wide;
};

/// Translates a program. Values of vector instructions replace the interpreter's registers.
class Translator {
  public:
    Translator(const Program& program, Pool& pool)
        : program_(program), pool_(pool), writer_(pool) {}

    VectorCode write(PixelLayout layout) {
        read_inputs(layout);
        static const auto writes = all_writes(std::make_index_sequence<std::size(kOperations)>());
        for (const Instruction& step : program_.instructions)
            (this->*writes[static_cast<std::size_t>(computed_by(step))])(step);
        write_outputs(layout);
        return writer_.take();
    }

  private:
    /// True if only curves read the input, and their ranges are within [0, kLargestInput]. Curves
    /// limit every number to their range, and give black for NaN.
    [[nodiscard]] bool is_read_by_curves_alone(std::uint32_t input) const {
        for (const Instruction& step : program_.instructions) {
            for (const Operand& in : step.in) {
                if (in.constant || in.offset != input) continue;
                if (step.op != ProgramOp::curve) return false;
                const CompiledCurve& curve = program_.curves[step.table];
                if (curve.lo < 0 || curve.hi > kLargestInput) return false;
            }
            for (const Operand& out : step.out) {
                if (!out.constant && out.offset == input) return true;
            }
        }
        return std::none_of(
            program_.output.begin(), program_.output.end(),
            [&](const Operand& output) { return !output.constant && output.offset == input; });
    }

    void read_inputs(PixelLayout layout) {
        std::array<VectorOperand, 3> given;
        if (layout == PixelLayout::rgb)
            given = program_.is_one_function ? writer_.load_floats() : writer_.load_rgb();
        if (layout == PixelLayout::rgba) {
            const std::array<VectorOperand, 4> rgba = writer_.load_rgba();
            std::copy_n(rgba.begin(), 3, given.begin());
        }
        for (std::size_t c = 0; c < 3; ++c) {
            if (!program_.reads_input[c]) continue;
            const VF x = {&writer_, given[c]};
            const std::uint32_t at = program_.input_offset[c];
            lanes_[at].narrow = is_read_by_curves_alone(at) ? x
                                : program_.limits_input     ? sanitized(float_tag(), x)
                                                            : without_nan(float_tag(), x);
        }
    }

    void write_outputs(PixelLayout layout) {
        std::array<VectorOperand, 3> result;
        for (std::size_t c = 0; c < 3; ++c)
            result[c] = in(program_.output[c], float_tag()).operand;
        if (layout == PixelLayout::rgba) return writer_.store_rgba(result);
        program_.is_one_function ? writer_.store_floats(result) : writer_.store_rgb(result);
    }

    [[nodiscard]] hn::Tag<float> float_tag() { return {&writer_}; }

    /// Sets a result. A double result is rounded if the value is kept in float.
    void set(const Operand& out, VF x) { lanes_[out.offset] = {x, {}}; }
    void set(const Operand& out, const Doubles& x) {
        if (out.wide) {
            lanes_[out.offset] = {{}, x};
        } else {
            set(out, demote(x));
        }
    }

    /// A vector filled with a constant or a uniform.
    template <class T>
    hn::Vector<T> number(const Operand& source, hn::Tag<T> d) {
        const unsigned char* const bytes =
            program_.numbers.constants[source.offset / kVectorBytes].bytes.data();
        double value = 0;
        if (source.wide) {
            std::memcpy(&value, bytes, sizeof value);
        } else {
            float narrow = 0;
            std::memcpy(&narrow, bytes, sizeof narrow);
            value = static_cast<double>(narrow);  // promoted once, not for each pixel
        }
        for (const UniformPlace& uniform : program_.uniforms) {
            if (uniform.offset != source.offset) continue;
            constexpr bool kIsWide = hn::kIsWide<T>;
            return {d.writer,
                    pool_.uniform(uniform.source, value, kIsWide, kIsWide && !source.wide)};
        }
        return simd::set(d, value);
    }

    /// An operand as a vector of floats, or one half of it as a vector of doubles.
    VF in(const Operand& operand, hn::Tag<float> d) {
        if (operand.constant) return number(operand, d);
        Lanes& x = lanes_.at(operand.offset);
        if (!x.narrow.writer) x.narrow = demote(x.wide);
        return x.narrow;
    }
    VD in(const Operand& operand, int half) {
        if (operand.constant) return number(operand, double_tag(float_tag()));
        Lanes& x = lanes_.at(operand.offset);
        VD& result = x.wide.half[half];
        if (!result.writer) result = promote(x.narrow, half);
        return result;
    }

    template <ProgramOp op>
    void write_op(const Instruction& step) {
        const hn::Tag<float> d = float_tag();
        if constexpr (op == ProgramOp::curve) {
            const CompiledCurve& curve = program_.curves[step.table];
            if (curve.rows)
                return write_curve(step, curve, RowPolynomial<hn::Tag<float>>(d, *curve.rows));
            return write_curve(step, curve, SegmentPolynomial<hn::Tag<float>>(d, curve));
        }
        const auto operand = [&](int i) -> const Operand& {
            return step.in[static_cast<std::size_t>(i)];
        };
        if (!step.wide && !is_always_wide(op)) {
            const auto x = [&](int i) { return in(operand(i), d); };
            const auto give = [&](std::size_t c, VF result) { set(step.out[c], result); };
            return compute<op>(d, program_, step, x, give);
        }
        Doubles results[3];
        for (int half = 0; half < kHalves; ++half) {
            const auto x = [&](int i) { return in(operand(i), half); };
            const auto give = [&](std::size_t c, VD result) { results[c].half[half] = result; };
            compute<op>(double_tag(d), program_, step, x, give);
        }
        for (std::size_t c = 0; c < 3; ++c) {
            if (results[c].half[0].writer) set(step.out[c], results[c]);
        }
    }
    using Write = void (Translator::*)(const Instruction&);
    template <std::size_t... kOp>
    static std::array<Write, sizeof...(kOp)> all_writes(std::index_sequence<kOp...> /*all*/) {
        return {&Translator::write_op<static_cast<ProgramOp>(kOp)>...};
    }

    template <class P>
    void write_curve(const Instruction& step, const CompiledCurve& curve, const P& polynomial) {
        const hn::Tag<float> d = float_tag();
        const CurveEnds ends(d, curve);
        const Operand& x = step.in[0];
        const VF given = in(x, d);
        if (!curve.is_precise) return set(step.out[0], curve_value(d, ends, polynomial, given));
        Doubles exact;
        if (x.wide) exact = {in(x, 0), in(x, 1)};
        set(step.out[0], precise_curve_value(d, ends, CurveEnds(double_tag(d), curve), polynomial,
                                             given, x.wide ? &exact : nullptr));
    }

    const Program& program_;
    Pool& pool_;
    Writer writer_;
    std::map<std::uint32_t, Lanes> lanes_;  // by offset in the interpreter's tile
};

}  // namespace

VectorCode interleaved(const VectorCode& code, int blocks) {
    VectorCode result;
    result.value_count = code.value_count * blocks;
    for (const VectorInstruction& one : code.instructions) {
        for (int block = 0; block < blocks; ++block) {
            VectorInstruction step = one;
            step.block = static_cast<std::uint8_t>(block);
            const auto move = [&](std::int32_t& value) {
                if (value != kNone) value += code.value_count * block;
            };
            move(step.result);
            move(step.mask);
            for (VectorOperand& operand : step.in)
                move(operand.value);
            result.instructions.push_back(step);
        }
    }
    return result;
}

std::optional<VectorProgram> translate(const Program& program) {
    const VectorMachine& machine = *program.target->machine;
    Pool pool(machine.has_avx512 ? 0 : static_cast<std::size_t>(machine.bytes()));
    std::vector<VectorCode> whole;
    for (const PixelLayout layout : {PixelLayout::rgb, PixelLayout::rgba})
        whole.push_back(Translator(program, pool).write(layout));
    const std::array division = {Division(whole[0]), Division(whole[1])};
    const std::size_t pixel_bytes =
        sizeof(float) * std::max({division[0].planes(), division[1].planes(), std::size_t{1}});
    VectorProgram result;
    result.tile = std::clamp(kTileBytes / pixel_bytes / kLaneMultiple * kLaneMultiple,
                             kLaneMultiple, kMaxTile);
    if (result.tile * pixel_bytes > kRegisterFileBytes) return std::nullopt;
    for (std::size_t layout = 0; layout < division.size(); ++layout)
        result.parts[layout] = division[layout].parts(result.tile * sizeof(float));
    result.pool = pool.take();
    result.uniforms = pool.take_uniforms();
    return result;
}

}  // namespace simd
TONEWRIGHT_NAMESPACE_END
