// SPDX-License-Identifier: Apache-2.0
#include "engine/vector_code.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <map>

#include "engine/schedule.h"
#include "engine/vector_writer-inl.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace simd {
namespace {

constexpr std::int32_t kNone = VectorOperand::kNone;
/// Bytes of a tile: stays in a first-level cache of 32 KiB.
constexpr std::size_t kTileBytes = std::size_t{24} * 1024;
/// Vector instructions of a part. Much shorter ones write more values to the tile than they
/// compute (with AVX2 and 50, AgX of Blender is 10 % slower); with AVX2 and 300, ACES 1.3 is 8 %
/// slower. With AVX-512, ten operators are 1 % faster than with 90.
constexpr int kLongestPart = 150;

/// One value of all pixels of a block: a vector of floats, or two of doubles, or both.
struct Lanes {
    VF narrow;
    Doubles wide;
};

/// The program with every value defined once, divided into parts.
class Translator {
  public:
    explicit Translator(const Code& code)
        : code_(code),
          machine_(*code.target->machine),
          pool_(machine_.has_avx512 ? 0 : static_cast<std::size_t>(machine_.bytes())) {
        for (std::size_t c = 0; c < 3; ++c) {
            if (code.reads_input[c]) {
                input_[c] = define(false);
                at_[code.input_offset[c]] = input_[c];
            }
        }
        for (const Instruction& step : code.instructions) {
            Step s{&step, {kNone, kNone, kNone, kNone}, {kNone, kNone, kNone}, 0};
            for (std::size_t i = 0; i < static_cast<std::size_t>(operation(step.op).operands);
                 ++i) {
                if (!step.in[i].constant) s.in[i] = at_.at(step.in[i].offset);
            }
            for (std::size_t i = 0; i < 3; ++i) {
                if (step.out[i].constant) continue;
                s.out[i] = define(step.out[i].wide);
                at_[step.out[i].offset] = s.out[i];
            }
            steps_.push_back(s);
        }
        for (std::size_t c = 0; c < 3; ++c) {
            if (!code.output[c].constant) output_[c] = at_.at(code.output[c].offset);
        }
        divide();
        find_crossings();
    }

    std::optional<VectorProgram> translate() {
        VectorProgram program;
        if (!place_in_tile(program)) return std::nullopt;
        for (const PixelLayout layout : {PixelLayout::rgb, PixelLayout::rgba}) {
            auto& parts = program.parts[static_cast<std::size_t>(layout)];
            for (std::size_t part = 0; part < part_count_; ++part)
                parts.push_back(write(part, layout));
        }
        program.pool = pool_.take();
        program.uniforms = pool_.take_uniforms();
        return program;
    }

  private:
    struct Value {
        std::size_t part = 0;  // that defines it
        bool wide = false;
        bool crosses = false;       // into another part
        bool is_sanitized = false;  // by the curves that are all that reads it
        std::uint32_t offset = 0;
    };
    struct Step {
        const Instruction* step;
        std::array<std::int32_t, 4> in;
        std::array<std::int32_t, 3> out;
        std::size_t part;
    };

    std::int32_t define(bool wide) {
        values_.push_back({0, wide, false, false, 0});
        return static_cast<std::int32_t>(values_.size() - 1);
    }
    Value& value(std::int32_t i) { return values_[static_cast<std::size_t>(i)]; }

    /// How many bytes of a pixel are defined before step `at` and read from there on.
    [[nodiscard]] std::vector<std::size_t> bytes_across() {
        std::vector<std::size_t> first(values_.size(), 0), last(values_.size(), 0);
        for (std::size_t i = 0; i < steps_.size(); ++i) {
            for (const std::int32_t v : steps_[i].out) {
                if (v != kNone) first[static_cast<std::size_t>(v)] = i + 1;
            }
            for (const std::int32_t v : steps_[i].in) {
                if (v != kNone) last[static_cast<std::size_t>(v)] = i;
            }
        }
        for (const std::int32_t v : output_) {
            if (v != kNone) last[static_cast<std::size_t>(v)] = steps_.size();
        }
        std::vector<std::size_t> result(steps_.size() + 1, 0);
        for (std::size_t v = 0; v < values_.size(); ++v) {
            for (std::size_t at = first[v]; at <= last[v]; ++at)
                result[at] += values_[v].wide ? sizeof(double) : sizeof(float);
        }
        return result;
    }

    /// Parts end where they get so long that a processor could not begin with the next pixels while
    /// it waits for the results of these: at the place with the fewest values to hand on. What is
    /// little longer than a part is not divided.
    void divide() {
        const std::vector<std::size_t> across = bytes_across();
        constexpr int kLittleLonger = 60;  // as fast as 30; 0 divides Hable: 4 % slower
        std::size_t part = 0;
        std::size_t begin = 0;
        const auto end_part = [&](std::size_t end) {
            for (; begin < end; ++begin)
                steps_[begin].part = part;
        };
        while (begin < steps_.size()) {
            std::size_t end = begin;
            std::size_t best = begin;
            int length = 0;
            for (; end < steps_.size(); ++end) {
                length += vectors_of(*steps_[end].step);
                if (length > kLongestPart + kLittleLonger) break;
                if (length >= kLongestPart / 2 && length <= kLongestPart &&
                    (best == begin || across[end + 1] <= across[best]))
                    best = end + 1;
            }
            const bool is_whole = end == steps_.size();
            end_part(is_whole || best == begin ? std::max(end, begin + 1) : best);
            if (!is_whole) ++part;
        }
        part_count_ = part + 1;
        for (const Step& s : steps_) {
            for (const std::int32_t v : s.out) {
                if (v != kNone) value(v).part = s.part;
            }
        }
    }

    /// About how many vector instructions it is.
    [[nodiscard]] int vectors_of(const Instruction& step) const {
        const int halves = step.wide ? 2 : 1;
        if (step.op != Op::curve) return halves * operation(step.op).vectors;
        const CompiledCurve& curve = code_.curves[step.table];
        if (curve.rows) return 16 + 2 * curve.rows->length;
        return 20 + (curve.segments > 32 ? 5 : 2) * curve.degree;
    }

    void find_crossings() {
        for (const std::int32_t i : input_) {
            if (i != kNone) value(i).is_sanitized = true;
        }
        for (const Step& s : steps_) {
            for (const std::int32_t i : s.in) {
                if (i == kNone) continue;
                if (s.part != value(i).part) value(i).crosses = true;
                if (!limits_input(*s.step)) value(i).is_sanitized = false;
            }
        }
        for (const std::int32_t i : output_) {
            if (i == kNone) continue;
            if (value(i).part != part_count_ - 1) value(i).crosses = true;
            value(i).is_sanitized = false;
        }
    }

    /// A curve over the light that there is takes every number, and NaN as black, by itself.
    bool limits_input(const Instruction& step) const {
        if (step.op != Op::curve) return false;
        const CompiledCurve& curve = code_.curves[step.table];
        return curve.lo >= 0 && curve.hi <= kLargestInput;
    }

    /// False where the tile is too small.
    bool place_in_tile(VectorProgram& program) {
        const auto size = [](const Value& v) { return v.wide ? sizeof(double) : sizeof(float); };
        std::size_t bytes = 0;
        for (const Value& v : values_)
            bytes += v.crosses ? size(v) : 0;
        program.tile = kMaxTile;
        if (bytes > 0)
            program.tile = std::clamp(kTileBytes / bytes / kLaneMultiple * kLaneMultiple,
                                      kLaneMultiple, kMaxTile);
        if (program.tile * bytes > kRegisterFileBytes) return false;
        std::size_t end = 0;
        for (Value& v : values_) {
            if (!v.crosses) continue;
            v.offset = static_cast<std::uint32_t>(end);
            end += program.tile * size(v);
        }
        return true;
    }

    // --- one part --------------------------------------------------------------------------------

    VectorCode write(std::size_t part, PixelLayout layout) {
        Writer writer(pool_, machine_);
        writer_ = &writer;
        lanes_.assign(values_.size(), {});
        if (part == 0) read_inputs(layout);
        static const auto writes = all_writes(std::make_index_sequence<std::size(kOperations)>());
        for (const Step& s : steps_) {
            if (s.part == part) (this->*writes[static_cast<std::size_t>(computed_by(*s.step))])(s);
        }
        if (part == part_count_ - 1) write_outputs(layout);
        return scheduled(writer.take());
    }

    void read_inputs(PixelLayout layout) {
        std::array<VectorOperand, 3> given;
        if (layout == PixelLayout::rgb)
            given = code_.is_one_function ? writer_->load_floats() : writer_->load_rgb();
        if (layout == PixelLayout::rgba) {
            const std::array<VectorOperand, 4> rgba = writer_->load_rgba();
            std::copy_n(rgba.begin(), 3, given.begin());
        }
        for (std::size_t c = 0; c < 3; ++c) {
            if (input_[c] == kNone) continue;
            const VF x = {writer_, given[c]};
            set(input_[c], value(input_[c]).is_sanitized ? x : sanitized(float_tag(), x));
        }
    }

    void write_outputs(PixelLayout layout) {
        std::array<VectorOperand, 3> result;
        for (std::size_t c = 0; c < 3; ++c) {
            if (output_[c] == kNone) {
                result[c] = number(code_.output[c], float_tag()).operand;
            } else {
                result[c] = narrow(output_[c]).operand;
            }
        }
        if (layout == PixelLayout::rgba) return writer_->store_rgba(result);
        code_.is_one_function ? writer_->store_floats(result) : writer_->store_rgb(result);
    }

    [[nodiscard]] hn::Tag<float> float_tag() const { return {writer_}; }
    Lanes& lanes(std::int32_t i) { return lanes_[static_cast<std::size_t>(i)]; }

    /// A value of this part, or one that has come through the tile.
    Lanes& given(std::int32_t i) {
        Lanes& result = lanes(i);
        const Value& v = value(i);
        if (result.narrow.writer || result.wide.half[0].writer) return result;
        if (v.wide) {
            for (int half = 0; half < kHalves; ++half)
                result.wide.half[half] = {writer_, load(v.offset, true, half)};
        } else {
            result.narrow = {writer_, load(v.offset, false, 0)};
        }
        return result;
    }
    VF narrow(std::int32_t i) {
        Lanes& x = given(i);
        if (!x.narrow.writer) x.narrow = demote(x.wide);
        return x.narrow;
    }
    VD wide(std::int32_t i, int half) {
        Lanes& x = given(i);
        VD& result = x.wide.half[half];
        if (!result.writer) result = promote(x.narrow, half);
        return result;
    }

    /// Results: kept as they are computed, or as what the value is.
    void set(std::int32_t i, VF x) {
        lanes(i).narrow = x;
        keep(i);
    }
    void set(std::int32_t i, const Doubles& x) {
        if (value(i).wide) {
            lanes(i).wide = x;
        } else {
            lanes(i).narrow = demote(x);
        }
        keep(i);
    }
    void keep(std::int32_t i) {
        const Value& v = value(i);
        if (!v.crosses) return;
        if (!v.wide) return store(v.offset, false, 0, narrow(i).operand);
        for (int half = 0; half < kHalves; ++half)
            store(v.offset, true, half, wide(i, half).operand);
    }
    VectorOperand load(std::uint32_t offset, bool wide, int half) {
        return writer_->emit({.op = VectorOp::load_plane,
                              .wide = wide,
                              .immediate = static_cast<std::uint8_t>(half),
                              .offset = offset});
    }
    void store(std::uint32_t offset, bool wide, int half, VectorOperand x) {
        writer_->emit_store({.op = VectorOp::store_plane,
                             .wide = wide,
                             .immediate = static_cast<std::uint8_t>(half),
                             .offset = offset,
                             .in = {x}});
    }

    /// A constant or a uniform.
    template <class T>
    hn::Vector<T> number(const Operand& source, hn::Tag<T> d) {
        const unsigned char* const bytes =
            code_.numbers.constants[source.offset / kVectorBytes].bytes.data();
        double value = 0;
        if (source.wide) {
            std::memcpy(&value, bytes, sizeof value);
        } else {
            float narrow = 0;
            std::memcpy(&narrow, bytes, sizeof narrow);
            value = static_cast<double>(narrow);  // promoted here, not there
        }
        for (const UniformPlace& uniform : code_.uniforms) {
            if (uniform.offset != source.offset) continue;
            constexpr bool kIsWide = hn::kIsWide<T>;
            return {d.writer,
                    pool_.uniform(uniform.source, value, kIsWide, kIsWide && !source.wide)};
        }
        return simd::set(d, value);
    }

    /// Operands as vectors of floats, or of doubles of one half.
    VF in(const Step& s, int i) {
        const auto k = static_cast<std::size_t>(i);
        return s.in[k] == kNone ? number(s.step->in[k], float_tag()) : narrow(s.in[k]);
    }
    VD in(const Step& s, int i, int half) {
        const auto k = static_cast<std::size_t>(i);
        return s.in[k] == kNone ? number(s.step->in[k], double_tag(float_tag()))
                                : wide(s.in[k], half);
    }

    template <Op op>
    void write_op(const Step& s) {
        const Instruction& step = *s.step;
        if constexpr (op == Op::curve) {
            const CompiledCurve& curve = code_.curves[step.table];
            if (curve.rows)
                return write_curve(s, curve,
                                   RowPolynomial<hn::Tag<float>>(float_tag(), *curve.rows));
            return write_curve(s, curve, SegmentPolynomial<hn::Tag<float>>(float_tag(), curve));
        }
        if (!step.wide && !is_always_wide(op)) {
            const auto x = [&](int i) { return in(s, i); };
            const auto give = [&](std::size_t c, VF result) { set(s.out[c], result); };
            return compute<op>(float_tag(), code_, step, x, give);
        }
        Doubles results[3];
        for (int half = 0; half < kHalves; ++half) {
            const auto x = [&](int i) { return in(s, i, half); };
            const auto give = [&](std::size_t c, VD result) { results[c].half[half] = result; };
            compute<op>(double_tag(float_tag()), code_, step, x, give);
        }
        for (std::size_t c = 0; c < 3; ++c) {
            if (s.out[c] != kNone) set(s.out[c], results[c]);
        }
    }
    using Write = void (Translator::*)(const Step&);
    template <std::size_t... kOp>
    static std::array<Write, sizeof...(kOp)> all_writes(std::index_sequence<kOp...> /*all*/) {
        return {&Translator::write_op<static_cast<Op>(kOp)>...};
    }

    template <class P>
    void write_curve(const Step& s, const CompiledCurve& curve, const P& polynomial) {
        const hn::Tag<float> d = float_tag();
        const CurveEnds ends(d, curve);
        if (!curve.is_precise) return set(s.out[0], curve_value(d, ends, polynomial, in(s, 0)));
        Doubles exact;
        const bool is_rounded = s.step->in[0].wide;
        if (is_rounded) exact = {in(s, 0, 0), in(s, 0, 1)};
        set(s.out[0], precise_curve_value(d, ends, CurveEnds(double_tag(d), curve), polynomial,
                                          in(s, 0), is_rounded ? &exact : nullptr));
    }

    const Code& code_;
    VectorMachine machine_;
    std::vector<Value> values_;
    std::map<std::uint32_t, std::int32_t> at_;  // by offset in the interpreter's tile
    std::vector<Step> steps_;
    std::array<std::int32_t, 3> input_ = {kNone, kNone, kNone};
    std::array<std::int32_t, 3> output_ = {kNone, kNone, kNone};
    std::size_t part_count_ = 1;
    Pool pool_;
    std::vector<Lanes> lanes_;
    Writer* writer_ = nullptr;
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

std::optional<VectorProgram> translate(const Code& code) { return Translator(code).translate(); }

}  // namespace simd
TONEWRIGHT_NAMESPACE_END
