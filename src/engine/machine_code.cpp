// SPDX-License-Identifier: Apache-2.0
#include "engine/machine_code.h"

#if defined(TONEWRIGHT_HAVE_XBYAK) && defined(__x86_64__) && !defined(_WIN32)

#include <xbyak/xbyak.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <functional>
#include <limits>
#include <map>

#include "engine/simd_kernels.h"
#include "engine/vector_code.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace simd {
namespace {

constexpr std::int32_t kNone = VectorOperand::kNone;
constexpr int kFirstMask = 1;  // k0 means "no mask"
constexpr int kMaskEnd = 6;
/// Blocks of pixels that a turn of the loop computes side by side. Three gained nothing: registers
/// run out.
constexpr int kInterleaved = 2;
/// Registers that an instruction may take beside those of its operands (gather).
constexpr int kSpare = 3;
/// How far ahead pixels are fetched by code that runs over all of them at once, in bytes. 512 to
/// 4096 are equally fast with Zen 4, a third faster than without; with Emerald Rapids and AVX-512,
/// 2048 is 1.1 times as fast as 1024 and 4096.
constexpr int kFetchAhead = 2048;

/// Bytes of the stack frame: a line for the caller's stack pointer, then four lines a block for
/// spill_index.
constexpr int kKeptBytes = 64 + 4 * 64 * kInterleaved;
/// An index in the vector register with this number is none for QEMU 7.2 and for FEX before its
/// pull request 3776, as it is in a general register: gathers read the first entry of the table.
constexpr int kNoIndex = 4;
/// Encodings of comparisons (ordered, quiet).
constexpr std::uint8_t kEqual = 0x00;
constexpr std::uint8_t kLess = 0x11;
constexpr std::uint8_t kLessEqual = 0x12;
constexpr std::uint8_t kGreaterEqual = 0x1D;
constexpr std::uint8_t kGreater = 0x1E;

/// Straight-line code in a loop over blocks of pixels. Registers are given as the code is
/// written; where none is free, the value that is needed latest goes to the stack (Belady).
class Generator : public Xbyak::CodeGenerator {
  public:
    explicit Generator(const VectorMachine& machine)
        : CodeGenerator(Xbyak::DEFAULT_MAX_CODE_SIZE, Xbyak::AutoGrow), machine_(machine) {}

    /// Where the function begins.
    /// @param fetch_ahead, claim_ahead  see fetch(); not at all where the first is 0
    std::size_t write(const VectorCode& code, PixelLayout layout, int fetch_ahead, int claim_ahead,
                      int interleaved_blocks) {
        layout_ = layout;
        fetch_ahead_ = fetch_ahead;
        claim_ahead_ = claim_ahead;
        slot_count_ = 0;
        align(32);
        const std::size_t entry = getSize();
        endbr64();  // called through a pointer, as CET's indirect branch tracking requires
        const std::array saved = {rbp, rbx, r12, r13, r14, r15};
        for (const Xbyak::Reg64& r : saved)
            push(r);
        mov(r9, rsp);
        mov(rbp, rsp);
        and_(rbp, -64);
        lea(rsp, ptr[rbp - kKeptBytes]);
        mov(ptr[rsp], r9);
        mov(ebx, 32);
        mov(r9d, std::numeric_limits<std::int32_t>::max());
        const std::size_t frame = getSize() - sizeof(std::int32_t);
        sub(rsp, r9);
        mov(rax, r8);  // the pool
        if (machine_.has_avx512) {
            mov(r9d, 0x7777);
            kmovw(k7, r9d);
        }
        xor_(r8, r8);
        if (interleaved_blocks > 1)
            write_loop(interleaved(code, interleaved_blocks), interleaved_blocks);
        write_loop(code, 1);
        mov(rsp, ptr[rbp - kKeptBytes]);
        std::for_each(saved.rbegin(), saved.rend(), [&](const Xbyak::Reg64& r) { pop(r); });
        vzeroupper();
        ret();
        // The stack stays aligned to 64.
        const int frame_bytes = (slot_count_ * machine_.bytes() + 63) / 64 * 64;
        rewrite(frame, static_cast<std::uint64_t>(frame_bytes), sizeof(std::int32_t));
        return entry;
    }

  private:
    /// Registers of a kind.
    struct File {
        int first, end;  // those that values may have
        std::vector<std::int32_t> holder = std::vector(static_cast<std::size_t>(end), kNone);
        std::vector<bool> is_locked = std::vector<bool>(holder.size());
    };
    struct State {
        int reg = -1;
        bool is_mask = false;  // in k
        int slot = -1;         // on the stack
        std::vector<std::size_t> uses;
        std::size_t next = 0;  // of the uses
    };

    /// While there are as many blocks.
    void write_loop(const VectorCode& code, int blocks) {
        begin(code);
        Xbyak::Label loop, end;
        sub(rcx, blocks);
        jl(end, T_NEAR);
        keep_constants(code);
        align(32);
        L(loop);
        if (fetch_ahead_ > 0) fetch(blocks);
        for (position_ = 0; position_ < code.instructions.size(); ++position_) {
            const VectorInstruction& step = code.instructions[position_];
            if (step.result != kNone && state(step.result).uses.empty()) {
                release(step);  // nobody reads it
            } else {
                write(step);
            }
            free_slots_.insert(free_slots_.end(), dropped_slots_.begin(), dropped_slots_.end());
            dropped_slots_.clear();
        }
        add(r8, machine_.bytes() * blocks);
        add(rsi, pixel_bytes() * blocks);
        add(rdx, pixel_bytes() * blocks);
        sub(rcx, blocks);
        jge(loop, T_NEAR);
        L(end);
        add(rcx, blocks);
    }

    /// Pixels that are read soon, and the lines where pixels will be written: the processor does
    /// not foresee them early enough, for there is much to do between two reads.
    void fetch(int blocks) {
        for (int at = 0; at < pixel_bytes() * blocks; at += 64) {
            prefetcht0(ptr[rsi + fetch_ahead_ + at]);
            prefetchw(ptr[rdx + claim_ahead_ + at]);
        }
    }

    /// Of a block.
    [[nodiscard]] int pixel_bytes() const {
        return (layout_ == PixelLayout::rgb ? 3 : 4) * machine_.bytes();
    }

    // --- registers -------------------------------------------------------------------------------

    void begin(const VectorCode& code) {
        state_.assign(static_cast<std::size_t>(code.value_count), {});
        vectors_ = {0, machine_.registers};
        masks_ = {kFirstMask, kMaskEnd};
        address_ = 0;
        row_index_ = kNone;
        index_pair_.fill(kNone);
        free_slots_.clear();
        for (int slot = 0; slot < slot_count_; ++slot)
            free_slots_.push_back(slot);
        for (std::size_t i = 0; i < code.instructions.size(); ++i) {
            const VectorInstruction& step = code.instructions[i];
            for (const VectorOperand& operand : step.in) {
                if (operand.is_value()) state(operand.value).uses.push_back(i);
            }
            if (step.mask != kNone) state(step.mask).uses.push_back(i);
            if (step.result != kNone)
                state(step.result).is_mask = machine_.has_avx512 && makes_mask(step.op);
        }
    }

    /// The constants that are read most stay in registers that the code does not need: short code
    /// waits for loads more than for arithmetic (Reinhard by luminance: 1.06 times as fast).
    void keep_constants(const VectorCode& code) {
        kept_.clear();
        std::vector<int> ending(code.instructions.size());
        for (const State& s : state_) {
            if (!s.uses.empty()) ++ending[s.uses.back()];
        }
        std::map<std::pair<std::int32_t, bool>, int> uses;  // by offset in the pool, and width
        int alive = 0;
        int most_alive = 0;
        for (std::size_t i = 0; i < code.instructions.size(); ++i) {
            const VectorInstruction& step = code.instructions[i];
            if (step.result != kNone && !state(step.result).uses.empty()) ++alive;
            most_alive = std::max(most_alive, alive);
            alive -= ending[i];
            // Constants of AVX2 fill a vector, whatever they are.
            const bool is_wide = machine_.has_avx512 && step.wide &&
                                 step.op != VectorOp::promote_low &&
                                 step.op != VectorOp::promote_high;
            for (const VectorOperand& operand : step.in) {
                if (operand.is_constant()) ++uses[{operand.pool, is_wide}];
            }
        }
        std::multimap<int, std::pair<std::int32_t, bool>, std::greater<>> by_uses;
        for (const auto& [constant, count] : uses)
            by_uses.emplace(count, constant);
        for (const auto& [count, constant] : by_uses) {
            if (vectors_.end <= most_alive + kSpare) break;
            kept_.push_back(constant.first);
            load_constant(vector(--vectors_.end), constant.first, constant.second);
        }
    }
    /// Of a constant, or kNone.
    [[nodiscard]] int kept_in(const VectorOperand& operand) const {
        const auto found = std::find(kept_.begin(), kept_.end(), operand.pool);
        if (!operand.is_constant() || found == kept_.end()) return kNone;
        return machine_.registers - 1 - static_cast<int>(found - kept_.begin());
    }

    State& state(std::int32_t value) { return state_[static_cast<std::size_t>(value)]; }
    [[nodiscard]] std::size_t next_use(std::int32_t value) {
        const State& s = state(value);
        return s.next < s.uses.size() ? s.uses[s.next] : std::numeric_limits<std::size_t>::max();
    }

    [[nodiscard]] Xbyak::Xmm vector(int reg) const {
        return {machine_.has_avx512 ? Xbyak::Operand::ZMM : Xbyak::Operand::YMM, reg};
    }
    void unlock() {
        for (File* file : {&vectors_, &masks_})
            std::fill(file->is_locked.begin(), file->is_locked.end(), false);
    }
    File& file_of(const State& s) { return s.is_mask ? masks_ : vectors_; }
    Xbyak::Address slot_of(int slot) {
        return ptr[rsp + static_cast<std::size_t>(slot * machine_.bytes())];
    }

    int take_slot() {
        if (free_slots_.empty()) return slot_count_++;
        const int slot = free_slots_.back();
        free_slots_.pop_back();
        return slot;
    }

    /// A register that holds nothing, not locked.
    int take(File& file) {
        int best = -1;
        std::size_t latest = 0;
        for (int r = file.first; r < file.end; ++r) {
            const auto i = static_cast<std::size_t>(r);
            if (file.is_locked[i]) continue;
            if (file.holder[i] == kNone) {
                best = r;
                break;
            }
            const std::size_t use = next_use(file.holder[i]);
            if (best < 0 || use > latest) {
                best = r;
                latest = use;
            }
        }
        std::int32_t& holder = file.holder[static_cast<std::size_t>(best)];
        if (holder != kNone) {
            State& s = state(holder);
            if (s.slot < 0) {
                s.slot = take_slot();
                if (s.is_mask) {
                    kmovw(slot_of(s.slot), Xbyak::Opmask(best));
                } else {
                    vmovaps(slot_of(s.slot), vector(best));
                }
            }
            s.reg = -1;
            holder = kNone;
        }
        file.is_locked[static_cast<std::size_t>(best)] = true;
        return best;
    }
    int take() { return take(vectors_); }

    /// The operand in a register, which stays its own until the instruction is written.
    Xbyak::Xmm in_register(const VectorOperand& operand, bool wide) {
        if (const int r = kept_in(operand); r != kNone) return vector(r);
        if (operand.is_constant()) {
            const Xbyak::Xmm r = vector(take());
            load_constant(r, operand.pool, wide);
            return r;
        }
        State& s = state(operand.value);
        if (s.reg < 0) {
            hold(operand.value, take());
            vmovaps(vector(s.reg), slot_of(s.slot));
        }
        vectors_.is_locked[static_cast<std::size_t>(s.reg)] = true;
        return vector(s.reg);
    }
    Xbyak::Address constant(std::int32_t offset) {
        return ptr[rax + static_cast<std::size_t>(offset)];
    }
    void load_constant(const Xbyak::Xmm& r, std::int32_t offset, bool wide) {
        if (!machine_.has_avx512) {
            vmovaps(r, constant(offset));
        } else if (wide) {
            vbroadcastsd(zmm(r), constant(offset));
        } else {
            vbroadcastss(r, constant(offset));
        }
    }
    [[nodiscard]] bool is_in_memory(const VectorOperand& operand) {
        return operand.is_constant() ? kept_in(operand) == kNone : state(operand.value).reg < 0;
    }
    /// An operand that is in memory, as the last operand of an instruction.
    Xbyak::Address in_memory(const VectorOperand& operand) {
        if (operand.is_constant())
            return machine_.has_avx512 ? ptr_b[rax + operand.pool] : constant(operand.pool);
        return slot_of(state(operand.value).slot);
    }

    /// Counts the uses of this instruction; what is not used any more leaves its register.
    void release(const VectorInstruction& step) {
        unlock();
        for (const VectorOperand& operand : step.in) {
            if (operand.is_value()) drop(operand.value);
        }
        if (step.mask != kNone) drop(step.mask);
    }
    void drop(std::int32_t value) {
        State& s = state(value);
        while (s.next < s.uses.size() && s.uses[s.next] <= position_)
            ++s.next;
        if (s.next < s.uses.size()) return;
        if (s.reg >= 0) {
            file_of(s).holder[static_cast<std::size_t>(s.reg)] = kNone;
            s.reg = -1;
        }
        if (s.slot >= 0) {
            // This instruction may read it yet, and spill another value before it does.
            dropped_slots_.push_back(s.slot);
            s.slot = -1;
        }
    }
    /// Nobody reads its register after this instruction.
    [[nodiscard]] bool dies(const VectorOperand& operand) {
        if (operand.is_constant()) return kept_in(operand) == kNone;  // a copy
        if (!operand.is_value()) return false;
        const State& s = state(operand.value);
        return s.uses.back() <= position_;
    }

    void hold(std::int32_t value, int reg) {
        State& s = state(value);
        s.reg = reg;
        file_of(s).holder[static_cast<std::size_t>(reg)] = value;
    }
    void define(std::int32_t value, int reg) {
        hold(value, reg);
        unlock();
    }
    /// For the result, when the operands have been read: may be the register of one of them.
    Xbyak::Xmm result_after(const VectorInstruction& step) {
        release(step);
        const int r = take();
        define(step.result, r);
        return vector(r);
    }
    /// For a result that is written before all operands are read.
    Xbyak::Xmm result_apart(const VectorInstruction& step) {
        const int r = take();
        release(step);
        define(step.result, r);
        return vector(r);
    }
    /// A register with a copy of `from`: its own, where nobody else needs it.
    Xbyak::Xmm result_over(const VectorInstruction& step, const VectorOperand& operand,
                           const Xbyak::Xmm& from) {
        if (dies(operand)) {
            release(step);
            define(step.result, from.getIdx());
            return from;
        }
        const int r = take();
        vmovaps(vector(r), from);
        release(step);
        define(step.result, r);
        return vector(r);
    }

    Xbyak::Opmask mask(std::int32_t value) {
        const State& s = state(value);
        if (s.reg < 0) {
            hold(value, take(masks_));
            kmovw(Xbyak::Opmask(s.reg), slot_of(s.slot));
        }
        return Xbyak::Opmask(s.reg);
    }
    Xbyak::Opmask new_mask(const VectorInstruction& step) {
        release(step);
        define(step.result, take(masks_));
        return Xbyak::Opmask(state(step.result).reg);
    }

    // --- instructions ----------------------------------------------------------------------------

    static bool commutes(VectorOp op) {
        return op == VectorOp::add || op == VectorOp::multiply || op == VectorOp::bit_and ||
               op == VectorOp::bit_or || op == VectorOp::bit_xor || op == VectorOp::integer_add;
    }

    /// op(result, a, b), b from memory where it is there.
    template <class F>
    void binary(const VectorInstruction& step, F op) {
        VectorOperand a = step.in[0];
        VectorOperand b = step.in[1];
        if (commutes(step.op) && is_in_memory(a) && !is_in_memory(b)) std::swap(a, b);
        const Xbyak::Xmm ra = in_register(a, step.wide);
        if (is_in_memory(b)) {
            const Xbyak::Address mb = in_memory(b);
            op(result_after(step), ra, mb);
        } else {
            const Xbyak::Xmm rb = in_register(b, step.wide);
            op(result_after(step), ra, rb);
        }
    }
    template <class F>
    void unary(const VectorInstruction& step, F op) {
        if (is_in_memory(step.in[0])) {
            const Xbyak::Address m = in_memory(step.in[0]);
            op(result_after(step), m);
        } else {
            const Xbyak::Xmm r = in_register(step.in[0], step.wide);
            op(result_after(step), r);
        }
    }

    /// @param over_a  a := a*b + c; `over_c`: c := a*b + c. Of the last operand, memory.
    template <class A, class B, class C>
    void fused(const VectorInstruction& step, A over_a, B over_a_c_first, C over_c) {
        VectorOperand a = step.in[0];
        VectorOperand b = step.in[1];
        const VectorOperand c = step.in[2];
        if (is_in_memory(a) && !is_in_memory(b)) std::swap(a, b);
        const Xbyak::Xmm ra = in_register(a, step.wide);
        if (is_in_memory(c)) {
            // a := a*b + [c]
            const Xbyak::Xmm rb = in_register(b, step.wide);
            if (!is_in_memory(c)) return fused(step, over_a, over_a_c_first, over_c);
            const Xbyak::Address mc = in_memory(c);
            if (!dies(a) && dies(b)) {
                over_a(result_over(step, b, rb), ra, mc);
            } else {
                over_a(result_over(step, a, ra), rb, mc);
            }
            return;
        }
        const Xbyak::Xmm rc = in_register(c, step.wide);
        if (is_in_memory(b)) {
            const Xbyak::Address mb = in_memory(b);
            if (dies(c) || !dies(a)) {
                over_c(result_over(step, c, rc), ra, mb);
            } else {
                over_a_c_first(result_over(step, a, ra), rc, mb);  // a := a*[b] + c
            }
            return;
        }
        const Xbyak::Xmm rb = in_register(b, step.wide);
        if (dies(c) || (!dies(a) && !dies(b))) {
            over_c(result_over(step, c, rc), ra, rb);
        } else if (dies(a)) {
            over_a(result_over(step, a, ra), rb, rc);
        } else {
            over_a(result_over(step, b, rb), ra, rc);
        }
    }

    void compare(const VectorInstruction& step, std::uint8_t predicate, std::uint8_t swapped) {
        VectorOperand a = step.in[0];
        VectorOperand b = step.in[1];
        if (is_in_memory(a) && !is_in_memory(b)) {
            std::swap(a, b);
            predicate = swapped;
        }
        const Xbyak::Xmm ra = in_register(a, step.wide);
        const auto write = [&](const Xbyak::Operand& vb) {
            const auto to = [&](const Xbyak::Xmm& r) {
                step.wide ? vcmppd(r, ra, vb, predicate) : vcmpps(r, ra, vb, predicate);
            };
            if (!machine_.has_avx512) return to(result_after(step));
            const Xbyak::Opmask k = new_mask(step);
            step.wide ? vcmppd(k, ra, vb, predicate) : vcmpps(k, ra, vb, predicate);
        };
        if (is_in_memory(b)) return write(in_memory(b));
        write(in_register(b, step.wide));
    }

    Xbyak::Address plane(const VectorInstruction& step) {
        return ptr[rdi + r8 +
                   (step.offset + static_cast<std::size_t>(machine_.bytes()) * step.block)];
    }
    Xbyak::Address pixels(const Xbyak::Reg64& base, const VectorInstruction& step) {
        return pixels(base, step, machine_.bytes() * step.immediate);
    }
    Xbyak::Address pixels(const Xbyak::Reg64& base, const VectorInstruction& step, int at) {
        return ptr[base + static_cast<std::size_t>(at + pixel_bytes() * step.block)];
    }
    /// The i-th group of four floats of load_thirds.
    Xbyak::Address third(const Xbyak::Reg64& base, const VectorInstruction& step, int i) {
        return pixels(base, step, 16 * (step.immediate + 3 * i));
    }
    /// Behind the line of the stack pointer, which lies behind the spilled values.
    Xbyak::Address kept_index(const VectorInstruction& step, int number, int pixel) {
        const int offset = 64 * (1 + number + 4 * step.block) + 4 * pixel;
        return ptr[rbp - static_cast<std::size_t>(kKeptBytes - offset)];
    }
    /// The distance of the address from r10; loads r10 where it is too far away.
    int distance_to(const void* address) {
        const auto to = reinterpret_cast<std::uintptr_t>(address);
        const auto distance = static_cast<std::intptr_t>(to - address_);
        constexpr std::intptr_t kFar = sizeof(CompiledCurve);
        if (address_ != 0 && distance >= 0 && distance < kFar) return static_cast<int>(distance);
        address_ = to;
        mov(r10, to);
        return 0;
    }

    /// What has half the bits of a vector.
    [[nodiscard]] Xbyak::Xmm half(const Xbyak::Xmm& r) const {
        return {machine_.has_avx512 ? Xbyak::Operand::YMM : Xbyak::Operand::XMM, r.getIdx()};
    }
    static Xbyak::Zmm zmm(const Xbyak::Xmm& r) { return Xbyak::Zmm(r.getIdx()); }

    void rows(const VectorInstruction& step) {
        const Xbyak::Xmm r = result_apart(step);
        const Xbyak::Xmm low(r.getIdx());
        const int quarter = step.immediate / 4;
        const int at_address = distance_to(step.address);
        const auto index_of = [&](int pixel) {
            return kept_index(step, step.immediate % 4, pixel);
        };
        const auto row = [&](const Xbyak::Reg64& at) { return ptr[r10 + at * 4 + at_address]; };
        if (machine_.has_avx512) {
            for (int i = 0; i < 4; ++i) {
                const Xbyak::Reg64 at = i % 2 == 0 ? r9 : r11;
                mov(at.cvt32(), index_of(quarter + 4 * i));
                i == 0 ? vmovaps(low, row(at))
                       : vinsertf32x4(zmm(r), zmm(r), row(at), static_cast<std::uint8_t>(i));
            }
            return;
        }
        if (row_index_ != step.immediate + 16 * step.block) {
            // One load brings the indices of two rows.
            const bool is_odd = quarter % 2 == 1;
            const bool is_first_block = step.block % 2 == 0;
            const Xbyak::Reg64& low_pair = is_first_block ? r12 : r13;
            const Xbyak::Reg64& high_pair = is_first_block ? r14 : r15;
            const int pair = step.immediate - (is_odd ? 4 : 0) + 16 * step.block;
            if (index_pair_[step.block % 2] != pair) {
                mov(low_pair, index_of(quarter / 2 * 2));
                mov(high_pair, index_of(quarter / 2 * 2 + 4));
                index_pair_[step.block % 2] = pair;
            }
            if (is_odd) {
                shrx(r9, low_pair, rbx);
                shrx(r11, high_pair, rbx);
            } else {
                mov(r9d, low_pair.cvt32());
                mov(r11d, high_pair.cvt32());
            }
            row_index_ = step.immediate + 16 * step.block;
        }
        vmovaps(low, row(r9));
        vinsertf128(Xbyak::Ymm(r.getIdx()), Xbyak::Ymm(r.getIdx()), row(r11), 1);
    }

    void write(const VectorInstruction& step) {
        using Z = Xbyak::Xmm;
        using O = Xbyak::Operand;
        const bool wide = step.wide;
        switch (step.op) {
            case VectorOp::add:
                return binary(step, [&](auto... x) { wide ? vaddpd(x...) : vaddps(x...); });
            case VectorOp::subtract:
                return binary(step, [&](auto... x) { wide ? vsubpd(x...) : vsubps(x...); });
            case VectorOp::multiply:
                return binary(step, [&](auto... x) { wide ? vmulpd(x...) : vmulps(x...); });
            case VectorOp::divide:
                return binary(step, [&](auto... x) { wide ? vdivpd(x...) : vdivps(x...); });
            case VectorOp::minimum:
                return binary(step, [&](auto... x) { wide ? vminpd(x...) : vminps(x...); });
            case VectorOp::maximum:
                return binary(step, [&](auto... x) { wide ? vmaxpd(x...) : vmaxps(x...); });
            case VectorOp::bit_and:
                return binary(step, [&](auto... x) { wide ? vandpd(x...) : vandps(x...); });
            case VectorOp::bit_or:
                return binary(step, [&](auto... x) { wide ? vorpd(x...) : vorps(x...); });
            case VectorOp::bit_xor:
                return binary(step, [&](auto... x) { wide ? vxorpd(x...) : vxorps(x...); });
            case VectorOp::bit_and_not:
                return binary(step, [&](auto... x) { wide ? vandnpd(x...) : vandnps(x...); });
            case VectorOp::integer_add:
                return binary(step, [&](auto... x) { wide ? vpaddq(x...) : vpaddd(x...); });
            case VectorOp::integer_subtract:
                return binary(step, [&](auto... x) { wide ? vpsubq(x...) : vpsubd(x...); });
            case VectorOp::to_float:
                return unary(step, [&](Z r, const O& a) { vcvtdq2ps(r, a); });
            case VectorOp::multiply_add:
                return fused(
                    step, [&](auto... x) { wide ? vfmadd213pd(x...) : vfmadd213ps(x...); },
                    [&](auto... x) { wide ? vfmadd132pd(x...) : vfmadd132ps(x...); },
                    [&](auto... x) { wide ? vfmadd231pd(x...) : vfmadd231ps(x...); });
            case VectorOp::multiply_subtract:
                return fused(
                    step, [&](auto... x) { wide ? vfmsub213pd(x...) : vfmsub213ps(x...); },
                    [&](auto... x) { wide ? vfmsub132pd(x...) : vfmsub132ps(x...); },
                    [&](auto... x) { wide ? vfmsub231pd(x...) : vfmsub231ps(x...); });
            case VectorOp::subtract_product:
                return fused(
                    step, [&](auto... x) { wide ? vfnmadd213pd(x...) : vfnmadd213ps(x...); },
                    [&](auto... x) { wide ? vfnmadd132pd(x...) : vfnmadd132ps(x...); },
                    [&](auto... x) { wide ? vfnmadd231pd(x...) : vfnmadd231ps(x...); });
            case VectorOp::square_root:
                return unary(step, [&](auto... x) { wide ? vsqrtpd(x...) : vsqrtps(x...); });
            case VectorOp::round:
            case VectorOp::floor: {
                const std::uint8_t mode = step.op == VectorOp::round ? 8 : 9;
                return unary(step, [&](Z r, const O& a) {
                    if (machine_.has_avx512) {
                        wide ? vrndscalepd(r, a, mode) : vrndscaleps(r, a, mode);
                    } else {
                        wide ? vroundpd(r, a, mode) : vroundps(r, a, mode);
                    }
                });
            }
            case VectorOp::shift_right:
            case VectorOp::shift_left: {
                const Z a = in_register(step.in[0], wide);
                const Z r = result_after(step);
                if (step.op == VectorOp::shift_left)
                    return wide ? vpsllq(r, a, step.immediate) : vpslld(r, a, step.immediate);
                return wide ? vpsrlq(r, a, step.immediate) : vpsrad(r, a, step.immediate);
            }
            case VectorOp::promote_low: {
                const Z a = in_register(step.in[0], false);
                return vcvtps2pd(result_after(step), half(a));
            }
            case VectorOp::promote_high: {
                const Z a = in_register(step.in[0], false);
                const Z r = result_after(step);
                if (machine_.has_avx512) {
                    vextractf64x4(half(r), zmm(a), 1);
                } else {
                    vextractf128(half(r), Xbyak::Ymm(a.getIdx()), 1);
                }
                return vcvtps2pd(r, half(r));
            }
            case VectorOp::demote: {
                const Z low = in_register(step.in[0], true);
                const Z high = in_register(step.in[1], true);
                const Z upper = half(vector(take()));
                vcvtpd2ps(upper, high);
                release(step);
                vectors_.is_locked[static_cast<std::size_t>(upper.getIdx())] = true;
                const Z r = vector(take());
                vcvtpd2ps(half(r), low);
                if (machine_.has_avx512) {
                    vinsertf64x4(zmm(r), zmm(r), upper, 1);
                } else {
                    vinsertf128(Xbyak::Ymm(r.getIdx()), Xbyak::Ymm(r.getIdx()), upper, 1);
                }
                return define(step.result, r.getIdx());
            }
            case VectorOp::equal:
                return compare(step, kEqual, kEqual);
            case VectorOp::less:
                return compare(step, kLess, kGreater);
            case VectorOp::less_equal:
                return compare(step, kLessEqual, kGreaterEqual);
            case VectorOp::greater:
                return compare(step, kGreater, kLess);
            case VectorOp::greater_equal:
                return compare(step, kGreaterEqual, kLessEqual);
            case VectorOp::is_minus: {
                const Z a = in_register(step.in[0], wide);
                if (!machine_.has_avx512) return (void)result_over(step, step.in[0], a);
                const Xbyak::Opmask k = new_mask(step);
                return wide ? vpmovq2m(k, a) : vpmovd2m(k, a);
            }
            case VectorOp::blend: {
                const Z no = in_register(step.in[1], wide);
                const auto write = [&](const O& yes) {
                    if (!machine_.has_avx512) {
                        const Z where = in_register({step.mask, kNone}, wide);
                        const Z r = result_after(step);
                        return wide ? vblendvpd(r, no, yes, where) : vblendvps(r, no, yes, where);
                    }
                    const Xbyak::Opmask k = mask(step.mask);
                    const Z r = result_after(step);
                    wide ? vblendmpd(r | k, no, yes) : vblendmps(r | k, no, yes);
                };
                if (is_in_memory(step.in[0])) return write(in_memory(step.in[0]));
                return write(in_register(step.in[0], wide));
            }
            case VectorOp::zero_unless: {
                if (!machine_.has_avx512) {
                    VectorInstruction both = step;
                    both.op = VectorOp::bit_and;
                    both.in[1] = {step.mask, kNone};
                    both.mask = kNone;
                    return write(both);
                }
                const Xbyak::Opmask k = mask(step.mask);
                if (step.in[0].is_constant()) {
                    const Z r = result_after(step);
                    const Xbyak::Address number = ptr[rax + step.in[0].pool];
                    return wide ? vbroadcastsd(zmm(r) | k | Xbyak::util::T_z, number)
                                : vbroadcastss(r | k | Xbyak::util::T_z, number);
                }
                const Z a = in_register(step.in[0], wide);
                const Z r = result_after(step);
                return wide ? vmovapd(r | k | Xbyak::util::T_z, a)
                            : vmovaps(r | k | Xbyak::util::T_z, a);
            }
            case VectorOp::to_index: {
                const Z a = in_register(step.in[0], wide);
                if (!wide) return vcvttps2dq(result_after(step), a);
                return vcvttpd2dq(half(result_after(step)), a);
            }
            case VectorOp::permute_16: {
                const Z index = in_register(step.in[0], false);
                const int at = distance_to(step.address);
                return vpermps(zmm(result_after(step)), zmm(index), ptr[r10 + at]);
            }
            case VectorOp::permute_32: {
                const Z index = in_register(step.in[0], false);
                const Z r = result_apart(step);
                const int at = distance_to(step.address);
                vmovaps(r, ptr[r10 + at]);
                return vpermt2ps(r, index, ptr[r10 + at + 64]);
            }
            case VectorOp::gather: {
                Z index = in_register(step.in[0], false);
                if (index.getIdx() == kNoIndex) {
                    const Z copy = vector(take());
                    vmovaps(copy, index);
                    index = copy;
                }
                const Z all = machine_.has_avx512 ? index : vector(take());
                const Z r = result_apart(step);
                const int at = distance_to(step.address);
                const Xbyak::Address number = ptr[r10 + (wide ? half(index) * 8 : index * 4) + at];
                vxorpd(r, r, r);
                if (machine_.has_avx512) {
                    kxnorw(k6, k6, k6);
                    return wide ? vgatherdpd(r | k6, number) : vgatherdps(r | k6, number);
                }
                vpcmpeqd(all, all, all);
                return wide ? vgatherdpd(r, number, all) : vgatherdps(r, number, all);
            }
            case VectorOp::spill_index: {
                const Z a = in_register(step.in[0], false);
                vmovaps(kept_index(step, step.immediate, 0), a);
                row_index_ = kNone;
                index_pair_.fill(kNone);
                return release(step);
            }
            case VectorOp::rows:
                return rows(step);
            case VectorOp::load_plane:
                return vmovaps(result_after(step), plane(step));
            case VectorOp::store_plane: {
                const Z a = in_register(step.in[0], wide);
                vmovaps(plane(step), a);
                return release(step);
            }
            case VectorOp::load_pixels:
                return vmovups(result_after(step), pixels(rsi, step));
            case VectorOp::store_pixels: {
                const Z a = in_register(step.in[0], false);
                vmovups(pixels(rdx, step), a);
                return release(step);
            }
            case VectorOp::load_thirds: {
                const int r = result_after(step).getIdx();
                vmovups(Xbyak::Xmm(r), third(rsi, step, 0));
                if (!machine_.has_avx512)
                    return vinsertf128(Xbyak::Ymm(r), Xbyak::Ymm(r), third(rsi, step, 1), 1);
                for (std::uint8_t i = 1; i < 4; ++i)
                    vinsertf32x4(Xbyak::Zmm(r), Xbyak::Zmm(r), third(rsi, step, i), i);
                return;
            }
            case VectorOp::store_thirds: {
                const int a = in_register(step.in[0], false).getIdx();
                vmovups(third(rdx, step, 0), Xbyak::Xmm(a));
                if (!machine_.has_avx512) {
                    vextractf128(third(rdx, step, 1), Xbyak::Ymm(a), 1);
                } else {
                    for (std::uint8_t i = 1; i < 4; ++i)
                        vextractf32x4(third(rdx, step, i), Xbyak::Zmm(a), i);
                }
                return release(step);
            }
            case VectorOp::store_colors: {
                const Z a = in_register(step.in[0], false);
                if (!machine_.has_avx512) {  // the fourth as it was read: masked stores are slow
                    const Z r = dies(step.in[0]) ? a : vector(take());
                    vblendps(r, a, pixels(rdx, step), 0x88);
                    vmovups(pixels(rdx, step), r);
                    return release(step);
                }
                vmovups(pixels(rdx, step) | k7, a);
                return release(step);
            }
            case VectorOp::shuffle_4: {
                const Z a = in_register(step.in[0], false);
                const Z b = in_register(step.in[1], false);
                return vshufps(result_after(step), a, b, step.immediate);
            }
        }
    }

    VectorMachine machine_;
    std::vector<State> state_;
    File vectors_{}, masks_{};
    std::vector<std::int32_t> kept_;  // constants in the last registers: offsets in the pool
    std::vector<int> free_slots_, dropped_slots_;
    int slot_count_ = 0;
    PixelLayout layout_ = PixelLayout::rgb;
    int fetch_ahead_ = 0;  // in bytes
    int claim_ahead_ = 0;
    std::size_t position_ = 0;
    std::uintptr_t address_ = 0;       // in r10
    int row_index_ = kNone;            // in r9 and r11, of AVX2
    std::array<int, 2> index_pair_{};  // of each block: in r12 and r14, or in r13 and r15
};

/// The code.
class Assembled final : public MachineCode {
  public:
    Assembled(VectorProgram program, const VectorMachine& machine)
        : MachineCode(std::move(program)), generator_(machine) {
        std::array<std::vector<std::size_t>, 2> entry;
        for (std::size_t layout = 0; layout < entry.size(); ++layout) {
            std::vector<VectorCode>& parts = program_.parts[layout];
            const bool is_whole = parts.size() == 1;
            const int pixel_bytes = static_cast<PixelLayout>(layout) == PixelLayout::rgb ? 12 : 16;
            for (std::size_t part = 0; part < parts.size(); ++part) {
                // The last of several parts writes a tile's pixels when the first is long done.
                const int claim_ahead = is_whole ? kFetchAhead : 0;
                const int next_tile = part == 0 ? static_cast<int>(program_.tile) * pixel_bytes : 0;
                const int fetch_ahead = is_whole ? kFetchAhead : next_tile;
                // The processor itself begins the next turn of a short program, and 16 registers
                // hold little of two blocks: side by side, Hable (118 instructions) is 7 % slower,
                // and AgX of Sobotka (145) 10 % faster.
                constexpr std::size_t kShort = 130;
                const bool is_alone =
                    is_whole && !machine.has_avx512 && parts[part].instructions.size() <= kShort;
                entry[layout].push_back(
                    generator_.write(parts[part], static_cast<PixelLayout>(layout), fetch_ahead,
                                     claim_ahead, is_alone ? 1 : kInterleaved));
                bytes_[layout].push_back(generator_.getSize() - entry[layout].back());
            }
            parts.clear();  // they are machine code now
        }
        generator_.ready(Xbyak::CodeArray::PROTECT_RE);
        for (std::size_t layout = 0; layout < entry.size(); ++layout) {
            for (const std::size_t at : entry[layout])
                function_[layout].push_back(reinterpret_cast<Function>(
                    const_cast<std::uint8_t*>(generator_.getCode() + at)));
        }
    }

  private:
    Generator generator_;
};

}  // namespace

bool MachineCode::is_built_in() noexcept { return true; }

std::shared_ptr<const MachineCode> MachineCode::make(Code& code) {
    std::optional<VectorProgram> program = translate(code);
    if (!program) return nullptr;
    code.numbers.pool.resize(program->pool.size() / kVectorBytes + 1);
    std::memcpy(code.numbers.pool.data(), program->pool.data(), program->pool.size());
    program->pool.clear();
    try {
        return std::make_shared<const Assembled>(std::move(*program), *code.target->machine);
    } catch (const Xbyak::Error&) {
        return nullptr;  // no memory that can be executed
    }
}

}  // namespace simd
TONEWRIGHT_NAMESPACE_END

#else

TONEWRIGHT_NAMESPACE_BEGIN
namespace simd {

bool MachineCode::is_built_in() noexcept { return false; }

std::shared_ptr<const MachineCode> MachineCode::make(Code& /*code*/) { return nullptr; }

}  // namespace simd
TONEWRIGHT_NAMESPACE_END

#endif
