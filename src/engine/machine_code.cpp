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

#include "engine/machine_registers.h"
#include "engine/vector_code.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace simd {
namespace {

/// Blocks of pixels that a turn of the loop computes side by side. Three are no faster, because
/// registers run out.
constexpr int kInterleaved = 2;
/// Distance in bytes at which code that runs over all pixels at once prefetches. 512 to 4096 are
/// equally fast with Zen 4, a third faster than without; with Emerald Rapids and AVX-512, 2048 is
/// 1.1 times as fast as 1024 and 4096.
constexpr int kFetchAhead = 2048;

/// Bytes of the stack frame: a line for the caller's stack pointer, then four lines a block for
/// spill_index.
constexpr int kKeptBytes = 64 + 4 * 64 * kInterleaved;
/// QEMU 7.2 and FEX before its pull request 3776 ignore the VSIB index if it is vector register 4:
/// gathers read the first entry of the table. (General register 4 means no index.) So a gather
/// never uses register 4 for its index.
constexpr int kNoIndex = 4;
using X86 = Xbyak::CodeGenerator;
using Register = Xbyak::Xmm;
using Xbyak::Operand;

/// Writes an instruction of two operands. Fused multiply-adds read the result, too.
using Encode = void (*)(X86&, const Register&, const Register&, const Operand&);
template <void (X86::*kInstruction)(const Register&, const Register&, const Operand&)>
void encode(X86& code, const Register& result, const Register& a, const Operand& b) {
    (code.*kInstruction)(result, a, b);
}
template <void (X86::*kInstruction)(const Register&, const Operand&, const Operand&)>
void encode(X86& code, const Register& result, const Register& a, const Operand& b) {
    (code.*kInstruction)(result, a, b);
}

/// The instructions of an operation for floats and for doubles.
struct Binary {  // NOLINT(clang-analyzer-optin.performance.Padding): a row reads from left to right
    VectorOp op;
    Encode of_floats, of_doubles;
    bool commutes = false;
};
constexpr Binary kBinary[] = {
    {VectorOp::add, encode<&X86::vaddps>, encode<&X86::vaddpd>, true},
    {VectorOp::subtract, encode<&X86::vsubps>, encode<&X86::vsubpd>},
    {VectorOp::multiply, encode<&X86::vmulps>, encode<&X86::vmulpd>, true},
    {VectorOp::divide, encode<&X86::vdivps>, encode<&X86::vdivpd>},
    {VectorOp::minimum, encode<&X86::vminps>, encode<&X86::vminpd>},
    {VectorOp::maximum, encode<&X86::vmaxps>, encode<&X86::vmaxpd>},
    {VectorOp::bit_and, encode<&X86::vandps>, encode<&X86::vandpd>, true},
    {VectorOp::bit_or, encode<&X86::vorps>, encode<&X86::vorpd>, true},
    {VectorOp::bit_xor, encode<&X86::vxorps>, encode<&X86::vxorpd>, true},
    {VectorOp::bit_and_not, encode<&X86::vandnps>, encode<&X86::vandnpd>},
    {VectorOp::integer_add, encode<&X86::vpaddd>, encode<&X86::vpaddq>, true},
    {VectorOp::integer_subtract, encode<&X86::vpsubd>, encode<&X86::vpsubq>},
};

/// The three orders of operands 1 (the result), 2 and 3 (maybe in memory): 132 computes 1 * 3 + 2.
struct FusedOrders {
    Encode of_213, of_132, of_231;
};
struct Fused {
    VectorOp op;
    FusedOrders of_floats, of_doubles;
};
constexpr Fused kFused[] = {
    {VectorOp::multiply_add,
     {encode<&X86::vfmadd213ps>, encode<&X86::vfmadd132ps>, encode<&X86::vfmadd231ps>},
     {encode<&X86::vfmadd213pd>, encode<&X86::vfmadd132pd>, encode<&X86::vfmadd231pd>}},
    {VectorOp::multiply_subtract,
     {encode<&X86::vfmsub213ps>, encode<&X86::vfmsub132ps>, encode<&X86::vfmsub231ps>},
     {encode<&X86::vfmsub213pd>, encode<&X86::vfmsub132pd>, encode<&X86::vfmsub231pd>}},
    {VectorOp::subtract_product,
     {encode<&X86::vfnmadd213ps>, encode<&X86::vfnmadd132ps>, encode<&X86::vfnmadd231ps>},
     {encode<&X86::vfnmadd213pd>, encode<&X86::vfnmadd132pd>, encode<&X86::vfnmadd231pd>}},
};

/// Encodings of comparisons (ordered, quiet).
struct Comparison {
    VectorOp op;
    std::uint8_t predicate, swapped;
};
constexpr std::uint8_t kEqual = 0x00;
constexpr std::uint8_t kLess = 0x11;
constexpr std::uint8_t kLessEqual = 0x12;
constexpr std::uint8_t kGreaterEqual = 0x1D;
constexpr std::uint8_t kGreater = 0x1E;
constexpr Comparison kComparisons[] = {
    {VectorOp::equal, kEqual, kEqual},
    {VectorOp::less, kLess, kGreater},
    {VectorOp::less_equal, kLessEqual, kGreaterEqual},
    {VectorOp::greater, kGreater, kLess},
    {VectorOp::greater_equal, kGreaterEqual, kLessEqual},
};

template <class Row, std::size_t kSize>
const Row* find_row(const Row (&rows)[kSize], VectorOp op) {
    const auto has_op = [op](const Row& row) { return row.op == op; };
    const Row* const found = std::find_if(std::begin(rows), std::end(rows), has_op);
    return found == std::end(rows) ? nullptr : found;
}

/// Generates functions: straight-line code in loops over blocks of pixels.
class Generator : public MachineRegisters {
  public:
    explicit Generator(const VectorMachine& machine) : MachineRegisters(machine) {}

    /// Writes a function, and returns the offset at which it begins.
    /// @param fetch_ahead, claim_ahead  see fetch(), which is left out if fetch_ahead is 0
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
        // A multiple of 64 keeps the stack aligned.
        const int frame_bytes = (slot_count_ * machine_.bytes() + 63) / 64 * 64;
        rewrite(frame, static_cast<std::uint64_t>(frame_bytes), sizeof(std::int32_t));
        return entry;
    }

  private:
    /// Writes a loop that runs while `blocks` blocks are left.
    void write_loop(const VectorCode& code, int blocks) {
        begin(code);
        address_ = 0;
        row_index_ = kNone;
        index_pair_.fill(kNone);
        Xbyak::Label loop, end;
        sub(rcx, blocks);
        jl(end, T_NEAR);
        keep_constants(code);
        align(32);
        L(loop);
        if (fetch_ahead_ > 0) fetch(blocks);
        for (position_ = 0; position_ < code.instructions.size(); ++position_) {
            const VectorInstruction& step = code.instructions[position_];
            if (is_unread(step)) {
                release(step);  // nothing to write
            } else {
                write(step);
            }
            free_dropped_slots();
        }
        add(r8, machine_.bytes() * blocks);
        add(rsi, bytes_per_block() * blocks);
        add(rdx, bytes_per_block() * blocks);
        sub(rcx, blocks);
        jge(loop, T_NEAR);
        L(end);
        add(rcx, blocks);
    }

    /// Prefetches pixels that are read soon, and the lines where pixels will be written. The
    /// processor alone prefetches them too late, because there is much to do between two reads.
    void fetch(int blocks) {
        for (int at = 0; at < bytes_per_block() * blocks; at += 64) {
            prefetcht0(ptr[rsi + fetch_ahead_ + at]);
            prefetchw(ptr[rdx + claim_ahead_ + at]);
        }
    }

    [[nodiscard]] int bytes_per_block() const {
        return (layout_ == PixelLayout::rgb ? 3 : 4) * machine_.bytes();
    }

    /// Reads b from memory if it is there.
    void write_binary(const VectorInstruction& step, const Binary& binary) {
        const Encode encode = step.wide ? binary.of_doubles : binary.of_floats;
        VectorOperand a = step.in[0];
        VectorOperand b = step.in[1];
        if (binary.commutes && is_in_memory(a) && !is_in_memory(b)) std::swap(a, b);
        const Register ra = in_register(a, step.wide);
        if (is_in_memory(b)) {
            const Xbyak::Address mb = in_memory(b);
            encode(*this, result_after(step), ra, mb);
        } else {
            const Register rb = in_register(b, step.wide);
            encode(*this, result_after(step), ra, rb);
        }
    }
    template <class F>
    void write_unary(const VectorInstruction& step, F op) {
        if (is_in_memory(step.in[0])) {
            const Xbyak::Address m = in_memory(step.in[0]);
            op(result_after(step), m);
        } else {
            const Register r = in_register(step.in[0], step.wide);
            op(result_after(step), r);
        }
    }

    void write_fused(const VectorInstruction& step, const Fused& fused) {
        const FusedOrders& orders = step.wide ? fused.of_doubles : fused.of_floats;
        VectorOperand a = step.in[0];
        VectorOperand b = step.in[1];
        const VectorOperand c = step.in[2];
        if (is_in_memory(a) && !is_in_memory(b)) std::swap(a, b);
        const Register ra = in_register(a, step.wide);
        if (is_in_memory(c)) {
            // a := a*b + [c]
            const Register rb = in_register(b, step.wide);
            if (!is_in_memory(c)) return write_fused(step, fused);
            const Xbyak::Address mc = in_memory(c);
            if (!dies(a) && dies(b)) {
                orders.of_213(*this, result_over(step, b, rb), ra, mc);
            } else {
                orders.of_213(*this, result_over(step, a, ra), rb, mc);
            }
            return;
        }
        const Register rc = in_register(c, step.wide);
        if (is_in_memory(b)) {
            const Xbyak::Address mb = in_memory(b);
            if (dies(c) || !dies(a)) {
                orders.of_231(*this, result_over(step, c, rc), ra, mb);
            } else {
                orders.of_132(*this, result_over(step, a, ra), rc, mb);  // a := a*[b] + c
            }
            return;
        }
        const Register rb = in_register(b, step.wide);
        if (dies(c) || (!dies(a) && !dies(b))) {
            orders.of_231(*this, result_over(step, c, rc), ra, rb);
        } else if (dies(a)) {
            orders.of_213(*this, result_over(step, a, ra), rb, rc);
        } else {
            orders.of_213(*this, result_over(step, b, rb), ra, rc);
        }
    }

    void write_comparison(const VectorInstruction& step, const Comparison& comparison) {
        std::uint8_t predicate = comparison.predicate;
        VectorOperand a = step.in[0];
        VectorOperand b = step.in[1];
        if (is_in_memory(a) && !is_in_memory(b)) {
            std::swap(a, b);
            predicate = comparison.swapped;
        }
        const Register ra = in_register(a, step.wide);
        const auto write = [&](const Operand& vb) {
            const auto to = [&](const Register& r) {
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
        return ptr[base + static_cast<std::size_t>(at + bytes_per_block() * step.block)];
    }
    /// The i-th group of four floats of load_thirds.
    Xbyak::Address third(const Xbyak::Reg64& base, const VectorInstruction& step, int i) {
        return pixels(base, step, 16 * (step.immediate + 3 * i));
    }
    /// Address of an index that spill_index stored: behind the line of the stack pointer, which
    /// lies behind the spilled values.
    Xbyak::Address kept_index(const VectorInstruction& step, int number, int pixel) {
        const int offset = 64 * (1 + number + 4 * step.block) + 4 * pixel;
        return ptr[rbp - static_cast<std::size_t>(kKeptBytes - offset)];
    }
    /// Distance of the address from r10. Loads r10 if the address is too far away.
    int distance_to(const void* address) {
        const auto to = reinterpret_cast<std::uintptr_t>(address);
        const auto distance = static_cast<std::intptr_t>(to - address_);
        constexpr std::intptr_t kFar = sizeof(CompiledCurve);
        if (address_ != 0 && distance >= 0 && distance < kFar) return static_cast<int>(distance);
        address_ = to;
        mov(r10, to);
        return 0;
    }

    /// The lower half of a vector register.
    [[nodiscard]] Register half(const Register& r) const {
        return {machine_.has_avx512 ? Xbyak::Operand::YMM : Xbyak::Operand::XMM, r.getIdx()};
    }

    void rows(const VectorInstruction& step) {
        const Register r = result_apart(step);
        const Register low(r.getIdx());
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

    void write_rounding(const VectorInstruction& step) {
        const bool wide = step.wide;
        const std::uint8_t mode = step.op == VectorOp::round ? 8 : 9;
        return write_unary(step, [&](Register r, const Operand& a) {
            if (machine_.has_avx512) {
                wide ? vrndscalepd(r, a, mode) : vrndscaleps(r, a, mode);
            } else {
                wide ? vroundpd(r, a, mode) : vroundps(r, a, mode);
            }
        });
    }

    void write_shift(const VectorInstruction& step) {
        const bool wide = step.wide;
        const Register a = in_register(step.in[0], wide);
        const Register r = result_after(step);
        if (step.op == VectorOp::shift_left)
            return wide ? vpsllq(r, a, step.immediate) : vpslld(r, a, step.immediate);
        return wide ? vpsrlq(r, a, step.immediate) : vpsrad(r, a, step.immediate);
    }

    void promote_high(const VectorInstruction& step) {
        const Register a = in_register(step.in[0], false);
        const Register r = result_after(step);
        if (machine_.has_avx512) {
            vextractf64x4(half(r), zmm(a), 1);
        } else {
            vextractf128(half(r), Xbyak::Ymm(a.getIdx()), 1);
        }
        return vcvtps2pd(r, half(r));
    }

    void demote(const VectorInstruction& step) {
        const Register low = in_register(step.in[0], true);
        const Register high = in_register(step.in[1], true);
        const Register upper = half(vector(take()));
        vcvtpd2ps(upper, high);
        release(step);
        lock(upper.getIdx());
        const Register r = vector(take());
        vcvtpd2ps(half(r), low);
        if (machine_.has_avx512) {
            vinsertf64x4(zmm(r), zmm(r), upper, 1);
        } else {
            vinsertf128(Xbyak::Ymm(r.getIdx()), Xbyak::Ymm(r.getIdx()), upper, 1);
        }
        return define(step.result, r.getIdx());
    }

    void write_is_minus(const VectorInstruction& step) {
        const bool wide = step.wide;
        const Register a = in_register(step.in[0], wide);
        if (!machine_.has_avx512) return (void)result_over(step, step.in[0], a);
        const Xbyak::Opmask k = new_mask(step);
        return wide ? vpmovq2m(k, a) : vpmovd2m(k, a);
    }

    void blend(const VectorInstruction& step) {
        const bool wide = step.wide;
        const Register no = in_register(step.in[1], wide);
        const auto write = [&](const Operand& yes) {
            if (!machine_.has_avx512) {
                const Register where = in_register({step.mask, kNone}, wide);
                const Register r = result_after(step);
                return wide ? vblendvpd(r, no, yes, where) : vblendvps(r, no, yes, where);
            }
            const Xbyak::Opmask k = mask(step.mask);
            const Register r = result_after(step);
            wide ? vblendmpd(r | k, no, yes) : vblendmps(r | k, no, yes);
        };
        if (is_in_memory(step.in[0])) return write(in_memory(step.in[0]));
        return write(in_register(step.in[0], wide));
    }

    void zero_unless(const VectorInstruction& step) {
        const bool wide = step.wide;
        if (!machine_.has_avx512) {
            VectorInstruction both = step;
            both.op = VectorOp::bit_and;
            both.in[1] = {step.mask, kNone};
            both.mask = kNone;
            return write(both);
        }
        const Xbyak::Opmask k = mask(step.mask);
        if (step.in[0].is_constant()) {
            const Register r = result_after(step);
            const Xbyak::Address number = ptr[rax + step.in[0].pool];
            return wide ? vbroadcastsd(zmm(r) | k | Xbyak::util::T_z, number)
                        : vbroadcastss(r | k | Xbyak::util::T_z, number);
        }
        const Register a = in_register(step.in[0], wide);
        const Register r = result_after(step);
        return wide ? vmovapd(r | k | Xbyak::util::T_z, a) : vmovaps(r | k | Xbyak::util::T_z, a);
    }

    void permute_32(const VectorInstruction& step) {
        const Register index = in_register(step.in[0], false);
        const Register r = result_apart(step);
        const int at = distance_to(step.address);
        vmovaps(r, ptr[r10 + at]);
        return vpermt2ps(r, index, ptr[r10 + at + 64]);
    }

    void gather(const VectorInstruction& step) {
        const bool wide = step.wide;
        Register index = in_register(step.in[0], false);
        if (index.getIdx() == kNoIndex) {
            const Register copy = vector(take());
            vmovaps(copy, index);
            index = copy;
        }
        const Register all = machine_.has_avx512 ? index : vector(take());
        const Register r = result_apart(step);
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

    void load_thirds(const VectorInstruction& step) {
        const int r = result_after(step).getIdx();
        vmovups(Register(r), third(rsi, step, 0));
        if (!machine_.has_avx512)
            return vinsertf128(Xbyak::Ymm(r), Xbyak::Ymm(r), third(rsi, step, 1), 1);
        for (std::uint8_t i = 1; i < 4; ++i)
            vinsertf32x4(Xbyak::Zmm(r), Xbyak::Zmm(r), third(rsi, step, i), i);
    }

    void store_thirds(const VectorInstruction& step) {
        const int a = in_register(step.in[0], false).getIdx();
        vmovups(third(rdx, step, 0), Register(a));
        if (!machine_.has_avx512) {
            vextractf128(third(rdx, step, 1), Xbyak::Ymm(a), 1);
        } else {
            for (std::uint8_t i = 1; i < 4; ++i)
                vextractf32x4(third(rdx, step, i), Xbyak::Zmm(a), i);
        }
        return release(step);
    }

    void store_colors(const VectorInstruction& step) {
        const Register a = in_register(step.in[0], false);
        if (!machine_.has_avx512) {  // a blend, because masked stores are slow
            const Register r = dies(step.in[0]) ? a : vector(take());
            vblendps(r, a, pixels(rdx, step), 0x88);
            vmovups(pixels(rdx, step), r);
            return release(step);
        }
        vmovups(pixels(rdx, step) | k7, a);
        return release(step);
    }

    void write(const VectorInstruction& step) {
        const bool wide = step.wide;
        if (const Binary* row = find_row(kBinary, step.op)) return write_binary(step, *row);
        if (const Fused* row = find_row(kFused, step.op)) return write_fused(step, *row);
        if (const Comparison* row = find_row(kComparisons, step.op))
            return write_comparison(step, *row);
        switch (step.op) {
            case VectorOp::to_float:
                return write_unary(step, [&](Register r, const Operand& a) { vcvtdq2ps(r, a); });
            case VectorOp::square_root:
                return write_unary(step, [&](auto... x) { wide ? vsqrtpd(x...) : vsqrtps(x...); });
            case VectorOp::round:
            case VectorOp::floor:
                return write_rounding(step);
            case VectorOp::shift_right:
            case VectorOp::shift_left:
                return write_shift(step);
            case VectorOp::promote_low: {
                const Register a = in_register(step.in[0], false);
                return vcvtps2pd(result_after(step), half(a));
            }
            case VectorOp::promote_high:
                return promote_high(step);
            case VectorOp::demote:
                return demote(step);
            case VectorOp::is_minus:
                return write_is_minus(step);
            case VectorOp::blend:
                return blend(step);
            case VectorOp::zero_unless:
                return zero_unless(step);
            case VectorOp::to_index: {
                const Register a = in_register(step.in[0], wide);
                if (!wide) return vcvttps2dq(result_after(step), a);
                return vcvttpd2dq(half(result_after(step)), a);
            }
            case VectorOp::permute_16: {
                const Register index = in_register(step.in[0], false);
                const int at = distance_to(step.address);
                return vpermps(zmm(result_after(step)), zmm(index), ptr[r10 + at]);
            }
            case VectorOp::permute_32:
                return permute_32(step);
            case VectorOp::gather:
                return gather(step);
            case VectorOp::spill_index: {
                const Register a = in_register(step.in[0], false);
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
                const Register a = in_register(step.in[0], wide);
                vmovaps(plane(step), a);
                return release(step);
            }
            case VectorOp::load_pixels:
                return vmovups(result_after(step), pixels(rsi, step));
            case VectorOp::store_pixels: {
                const Register a = in_register(step.in[0], false);
                vmovups(pixels(rdx, step), a);
                return release(step);
            }
            case VectorOp::load_thirds:
                return load_thirds(step);
            case VectorOp::store_thirds:
                return store_thirds(step);
            case VectorOp::store_colors:
                return store_colors(step);
            case VectorOp::shuffle_4: {
                const Register a = in_register(step.in[0], false);
                const Register b = in_register(step.in[1], false);
                return vshufps(result_after(step), a, b, step.immediate);
            }
            default:  // in kBinary, kFused or kComparisons
                return;
        }
    }

    PixelLayout layout_ = PixelLayout::rgb;
    int fetch_ahead_ = 0;  // in bytes, see fetch()
    int claim_ahead_ = 0;
    std::uintptr_t address_ = 0;  // the value of r10
    int row_index_ = kNone;       // rows whose indices are in r9 and r11 (AVX2)
    std::array<int, 2>
        index_pair_{};  // pair of rows in r12 and r14 (or r13 and r15) for each block
};

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
                // If there are several parts, the first one claims the lines of a tile long before
                // the last one writes them.
                const int claim_ahead = is_whole ? kFetchAhead : 0;
                const int next_tile = part == 0 ? static_cast<int>(program_.tile) * pixel_bytes : 0;
                const int fetch_ahead = is_whole ? kFetchAhead : next_tile;
                // For a short program, the processor begins the next turn by itself, and 16
                // registers are few for two blocks. Side by side, Hable (118 instructions) is 7 %
                // slower, and AgX of Sobotka (145) 10 % faster.
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

std::shared_ptr<const MachineCode> MachineCode::make(Program& program) {
    std::optional<VectorProgram> vectors = translate(program);
    if (!vectors) return nullptr;
    program.numbers.pool.resize(vectors->pool.size() / kVectorBytes + 1);
    std::memcpy(program.numbers.pool.data(), vectors->pool.data(), vectors->pool.size());
    vectors->pool.clear();
    try {
        return std::make_shared<const Assembled>(std::move(*vectors), *program.target->machine);
    } catch (const Xbyak::Error&) {
        return nullptr;  // no executable memory
    }
}

}  // namespace simd
TONEWRIGHT_NAMESPACE_END

#else

TONEWRIGHT_NAMESPACE_BEGIN
namespace simd {

bool MachineCode::is_built_in() noexcept { return false; }

std::shared_ptr<const MachineCode> MachineCode::make(Program& /*program*/) { return nullptr; }

}  // namespace simd
TONEWRIGHT_NAMESPACE_END

#endif
