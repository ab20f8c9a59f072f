// SPDX-License-Identifier: Apache-2.0
#include "engine/machine_registers.h"

#if defined(TONEWRIGHT_HAVE_XBYAK) && defined(__x86_64__) && !defined(_WIN32)

#include <algorithm>
#include <functional>
#include <limits>
#include <map>

TONEWRIGHT_NAMESPACE_BEGIN
namespace simd {
namespace {

constexpr int kFirstMask = 1;  // k0 means "no mask"
constexpr int kMaskEnd = 6;
/// Scratch registers that an instruction may need (gather needs 3).
constexpr int kSpare = 3;

}  // namespace

void MachineRegisters::begin(const VectorCode& code) {
    state_.assign(static_cast<std::size_t>(code.value_count), {});
    vectors_ = {0, machine_.registers};
    masks_ = {kFirstMask, kMaskEnd};
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

void MachineRegisters::keep_constants(const VectorCode& code) {
    kept_.clear();
    std::vector<int> ending(code.instructions.size());
    for (const State& s : state_) {
        if (!s.uses.empty()) ++ending[s.uses.back()];
    }
    std::map<std::pair<std::int32_t, bool>, int> uses;  // by pool offset and width
    int alive = 0;
    int most_alive = 0;
    for (std::size_t i = 0; i < code.instructions.size(); ++i) {
        const VectorInstruction& step = code.instructions[i];
        if (step.result != kNone && !state(step.result).uses.empty()) ++alive;
        most_alive = std::max(most_alive, alive);
        alive -= ending[i];
        // With AVX2, each constant fills a vector, so its width does not matter.
        const bool is_wide = machine_.has_avx512 && step.wide && step.op != VectorOp::promote_low &&
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

int MachineRegisters::kept_in(const VectorOperand& operand) const {
    const auto found = std::find(kept_.begin(), kept_.end(), operand.pool);
    if (!operand.is_constant() || found == kept_.end()) return kNone;
    return machine_.registers - 1 - static_cast<int>(found - kept_.begin());
}

std::size_t MachineRegisters::next_use(std::int32_t value) {
    const State& s = state(value);
    return s.next < s.uses.size() ? s.uses[s.next] : std::numeric_limits<std::size_t>::max();
}

void MachineRegisters::unlock() {
    for (File* file : {&vectors_, &masks_})
        std::fill(file->is_locked.begin(), file->is_locked.end(), false);
}

int MachineRegisters::take_slot() {
    if (free_slots_.empty()) return slot_count_++;
    const int slot = free_slots_.back();
    free_slots_.pop_back();
    return slot;
}

int MachineRegisters::take(File& file) {
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

Xbyak::Xmm MachineRegisters::in_register(const VectorOperand& operand, bool wide) {
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

void MachineRegisters::load_constant(const Xbyak::Xmm& r, std::int32_t offset, bool wide) {
    if (!machine_.has_avx512) {
        vmovaps(r, constant(offset));
    } else if (wide) {
        vbroadcastsd(zmm(r), constant(offset));
    } else {
        vbroadcastss(r, constant(offset));
    }
}

Xbyak::Address MachineRegisters::in_memory(const VectorOperand& operand) {
    if (operand.is_constant())
        return machine_.has_avx512 ? ptr_b[rax + operand.pool] : constant(operand.pool);
    return slot_of(state(operand.value).slot);
}

void MachineRegisters::release(const VectorInstruction& step) {
    unlock();
    for (const VectorOperand& operand : step.in) {
        if (operand.is_value()) drop(operand.value);
    }
    if (step.mask != kNone) drop(step.mask);
}

void MachineRegisters::drop(std::int32_t value) {
    State& s = state(value);
    while (s.next < s.uses.size() && s.uses[s.next] <= position_)
        ++s.next;
    if (s.next < s.uses.size()) return;
    if (s.reg >= 0) {
        file_of(s).holder[static_cast<std::size_t>(s.reg)] = kNone;
        s.reg = -1;
    }
    if (s.slot >= 0) {
        // This instruction may still read the slot after it has spilled another value.
        dropped_slots_.push_back(s.slot);
        s.slot = -1;
    }
}

bool MachineRegisters::dies(const VectorOperand& operand) {
    if (operand.is_constant()) return kept_in(operand) == kNone;  // its register is a copy
    if (!operand.is_value()) return false;
    const State& s = state(operand.value);
    return s.uses.back() <= position_;
}

void MachineRegisters::hold(std::int32_t value, int reg) {
    State& s = state(value);
    s.reg = reg;
    file_of(s).holder[static_cast<std::size_t>(reg)] = value;
}

void MachineRegisters::define(std::int32_t value, int reg) {
    hold(value, reg);
    unlock();
}

Xbyak::Xmm MachineRegisters::result_after(const VectorInstruction& step) {
    release(step);
    const int r = take();
    define(step.result, r);
    return vector(r);
}

Xbyak::Xmm MachineRegisters::result_apart(const VectorInstruction& step) {
    const int r = take();
    release(step);
    define(step.result, r);
    return vector(r);
}

Xbyak::Xmm MachineRegisters::result_over(const VectorInstruction& step,
                                         const VectorOperand& operand, const Xbyak::Xmm& from) {
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

Xbyak::Opmask MachineRegisters::mask(std::int32_t value) {
    const State& s = state(value);
    if (s.reg < 0) {
        hold(value, take(masks_));
        kmovw(Xbyak::Opmask(s.reg), slot_of(s.slot));
    }
    return Xbyak::Opmask(s.reg);
}

Xbyak::Opmask MachineRegisters::new_mask(const VectorInstruction& step) {
    release(step);
    define(step.result, take(masks_));
    return Xbyak::Opmask(state(step.result).reg);
}

void MachineRegisters::free_dropped_slots() {
    free_slots_.insert(free_slots_.end(), dropped_slots_.begin(), dropped_slots_.end());
    dropped_slots_.clear();
}

}  // namespace simd
TONEWRIGHT_NAMESPACE_END

#endif
