// SPDX-License-Identifier: Apache-2.0
#include "ocio/lut_files.h"

#include <cstddef>
#include <optional>

#include "base/strings.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

/// The table of an operation that has one.
std::optional<ClfTable> table_of(const LoweredOp& op, bool is_exact) {
    if (const auto* lut = std::get_if<Lut1DOp>(&op.op)) {
        return ClfTable{.dimension = 1,
                        .size = lut->size(),
                        .channels = lut->channels,
                        .is_half_domain = lut->is_half_domain,
                        .is_hue_preserving = lut->keeps_hue,
                        .values = lut->values,
                        .numbers = ClfTable::Numbers::compact};
    }
    if (const auto* lut = std::get_if<Lut3DOp>(&op.op)) {
        // 8e-6, a thirtieth of what interpolating between the nodes of a sampled operator costs in
        // the mean. A lattice has nothing else to be wrong in: 5e-8.
        return ClfTable{
            .dimension = 3,
            .size = lut->edge,
            .channels = 3,
            .values = lut->values,
            .numbers = is_exact ? ClfTable::Numbers::decimals_7 : ClfTable::Numbers::codes};
    }
    return std::nullopt;
}

/// "Rec.2020, 1000 nit" -> "rec2020_1000_nit".
std::string word(const std::string& text) {
    const auto is_alnum = [](char c) { return (c >= 'a' && c <= 'z') || (c >= '0' && c <= '9'); };
    const std::string name = lowercase(text);
    std::string result;
    for (std::size_t i = 0; i < name.size(); ++i) {
        const bool is_first = i == 0 || !is_alnum(name[i - 1]);
        const bool is_next = i + 1 < name.size() && is_alnum(name[i + 1]);
        const bool is_joint = (name[i] == '.' || name[i] == '-') && is_next;
        if (is_alnum(name[i])) {
            result += name[i];
        } else if (is_first && is_next && (name[i] == '-' || name[i] == '+')) {
            result += name[i] == '-' ? "minus" : "plus";
        } else if ((is_first || !is_joint) && !result.empty() && result.back() != '_') {
            result += '_';
        }
    }
    while (!result.empty() && result.back() == '_')
        result.pop_back();
    return result;
}

/// The words that are not empty, with an underscore between them.
std::string joined(const std::vector<std::string>& words) {
    std::string result;
    for (const std::string& part : words) {
        if (!part.empty() && !result.empty()) result += '_';
        result += part;
    }
    return result;
}

/// What the table of an operation is, for its file's name.
std::string part_name(const LoweredOps& ops, std::size_t index) {
    if (std::holds_alternative<Lut3DOp>(ops[index].op)) return "cube";
    const bool is_shaper =
        index + 1 < ops.size() && std::holds_alternative<Lut3DOp>(ops[index + 1].op);
    return is_shaper ? "shaper" : "curve";
}

}  // namespace

OCIO::GroupTransformRcPtr LutFiles::to_ocio(const LoweredOps& ops, const LutStem& stem,
                                            const std::string& title, bool is_exact) {
    OCIO::GroupTransformRcPtr out = OCIO::GroupTransform::Create();
    std::map<std::string, int> counts;
    for (std::size_t i = 0; i < ops.size(); ++i) {
        const auto table = table_of(ops[i], is_exact);
        if (!table) {
            out->appendTransform(tonewright::to_ocio(ops[i]));
            continue;
        }
        std::string part = part_name(ops, i);
        if (const int count = ++counts[part]; count > 1) part += std::to_string(count);
        const OCIO::FileTransformRcPtr file = OCIO::FileTransform::Create();
        file->setSrc(file_for(*table, stem, part, title).c_str());
        file->setInterpolation(table->dimension == 3 ? OCIO::INTERP_TETRAHEDRAL
                                                     : OCIO::INTERP_LINEAR);
        if (ops[i].is_inverse) file->setDirection(OCIO::TRANSFORM_DIR_INVERSE);
        out->appendTransform(file);
    }
    return out;
}

std::string LutFiles::file_for(const ClfTable& table, const LutStem& stem, const std::string& part,
                               const std::string& title) {
    std::string key(reinterpret_cast<const char*>(table.values.data()),
                    table.values.size() * sizeof(float));
    key += std::to_string(table.size) + (table.is_half_domain ? "half" : "") +
           (table.is_hue_preserving ? "hue" : "");
    const auto [it, is_new] = names_.emplace(key, "");
    if (!is_new) return it->second;

    const std::string note =
        table.dimension == 1 ? ": one entry for every half float" : ": behind its shaper";
    std::string contents = write_clf(table, title, {"Tonewright, " + title + note});
    const std::string subject = word(stem.subject);
    const std::string purpose = word(stem.purpose);
    const std::string qualified = joined({subject, word(stem.qualifier), purpose, part});
    // Forms of an operator often share curves and never cubes.
    std::string name = table.dimension == 1 ? joined({subject, purpose, part}) : qualified;
    if (style_ == Names::hashed) {
        name += "_" + content_hash(contents);
    } else {
        if (taken_.contains(name)) name = qualified;
        for (int number = 2; taken_.contains(name); ++number)
            name = qualified + "_" + std::to_string(number);
    }
    taken_.insert(name);
    it->second = name + file_extension(table);
    files_.push_back({folder_ + "/" + it->second, std::move(contents)});
    return it->second;
}

TONEWRIGHT_NAMESPACE_END
