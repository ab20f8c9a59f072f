// SPDX-License-Identifier: Apache-2.0
#include "ocio/lut_files.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstddef>
#include <utility>

#include "base/strings.h"
#include "lut/in_parallel.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

/// Kind of an operation's table, for its file name.
std::string part_name(const LoweredOps& ops, std::size_t index) {
    if (std::holds_alternative<Lut3DOp>(ops[index].op)) return "cube";
    const bool is_shaper =
        index + 1 < ops.size() && std::holds_alternative<Lut3DOp>(ops[index + 1].op);
    return is_shaper ? "shaper" : "curve";
}

ClfTable table_of(const Lut1DOp& lut, double least_precision = 0) {
    return {.dimension = 1,
            .size = lut.size(),
            .channels = lut.channels,
            .is_half_domain = lut.is_half_domain,
            .is_hue_preserving = lut.keeps_hue,
            .values = lut.values,
            .slack = lut.slack,
            .numbers = ClfTable::Numbers::compact,
            .least_precision = least_precision};
}

ClfTable table_of(const Lut3DOp& lut, bool is_exact, bool is_inverted) {
    ClfTable table = {.dimension = 3, .size = lut.edge, .channels = 3, .values = lut.values};
    // An exact 3D LUT only has the error of its numbers: 5e-8. The interpolation error of a sampled
    // operator is much larger: on average 30 times the 8e-6 of codes, and 5 times the 5e-5 of
    // integers.
    using Numbers = ClfTable::Numbers;
    table.numbers = is_exact      ? Numbers::decimals_7
                    : is_inverted ? Numbers::codes
                                  : Numbers::multiples;
    table.unit = lut.unit;
    return table;
}

/// Smallest required precision of the numbers of a 1D table. Before or after an inexact 3D LUT, its
/// error of 1e-3 and more dominates.
double least_precision_of(const LoweredOps& ops, std::size_t index, const LutFiles::Use& use) {
    constexpr double kOfCubes = 2e-7;
    constexpr double kOfCodes = 7.5e-9;
    const bool has_cube = std::any_of(ops.begin(), ops.end(), [](const LoweredOp& op) {
        return std::holds_alternative<Lut3DOp>(op.op);
    });
    const bool is_shaper = part_name(ops, index) == "shaper";
    if (!use.is_exact && has_cube && (is_shaper || use.is_inverse)) return kOfCubes;
    const bool is_last =
        std::none_of(ops.begin() + static_cast<std::ptrdiff_t>(index) + 1, ops.end(),
                     [](const LoweredOp& op) { return std::holds_alternative<Lut1DOp>(op.op); });
    return use.makes_codes && is_last ? kOfCodes : 0;
}

/// Key that identifies a table.
std::string key_of(const std::variant<Lut1DOp, Lut3DOp>& table) {
    const auto bytes = [](const auto& numbers) {
        return std::string(reinterpret_cast<const char*>(numbers.data()),
                           numbers.size() * sizeof(numbers[0]));
    };
    if (const auto* cube = std::get_if<Lut3DOp>(&table)) return bytes(cube->values);
    const auto& lut = std::get<Lut1DOp>(table);
    return bytes(lut.values) + bytes(lut.slack) + std::to_string(lut.channels) +
           (lut.is_half_domain ? "half" : "") + (lut.keeps_hue ? "hue" : "");
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

/// Joins the words that are not empty with underscores.
std::string joined(const std::vector<std::string>& words) {
    std::string result;
    for (const std::string& part : words) {
        if (!part.empty() && !result.empty()) result += '_';
        result += part;
    }
    return result;
}

}  // namespace

OCIO::GroupTransformRcPtr LutFiles::to_ocio(const LoweredOps& ops, const LutStem& stem,
                                            const std::string& title, const Use& use) {
    OCIO::GroupTransformRcPtr out = OCIO::GroupTransform::Create();
    std::map<std::string, int> counts;
    for (std::size_t i = 0; i < ops.size(); ++i) {
        const auto* curve = std::get_if<Lut1DOp>(&ops[i].op);
        const auto* cube = std::get_if<Lut3DOp>(&ops[i].op);
        if (!curve && !cube) {
            out->appendTransform(tonewright::to_ocio(ops[i]));
            continue;
        }
        std::string part = part_name(ops, i);
        if (const int count = ++counts[part]; count > 1) part += std::to_string(count);
        File table = {"", title, {}, use, least_precision_of(ops, i, use)};
        if (curve) table.table = *curve;
        if (cube) table.table = *cube;
        table.use.is_inverted = use.is_inverted || ops[i].is_inverse;
        const OCIO::FileTransformRcPtr file = OCIO::FileTransform::Create();
        file->setSrc(file_for(std::move(table), stem, part).c_str());
        file->setInterpolation(cube ? OCIO::INTERP_TETRAHEDRAL : OCIO::INTERP_LINEAR);
        if (ops[i].is_inverse) file->setDirection(OCIO::TRANSFORM_DIR_INVERSE);
        out->appendTransform(file);
    }
    return out;
}

std::string LutFiles::file_for(File file, const LutStem& stem, const std::string& part) {
    const auto [it, is_new] = index_.emplace(key_of(file.table), files_.size());
    if (!is_new) {
        File& known = files_[it->second];
        known.use.is_exact = known.use.is_exact || file.use.is_exact;
        known.use.is_inverted = known.use.is_inverted || file.use.is_inverted;
        known.least_precision = std::min(known.least_precision, file.least_precision);
        return known.name;
    }
    const std::string subject = word(stem.subject);
    const std::string purpose = word(stem.purpose);
    const std::string qualified = joined({subject, word(stem.qualifier), purpose, part});
    // Variants of an operator often share curves, but never 3D LUTs.
    const auto* curve = std::get_if<Lut1DOp>(&file.table);
    std::string name = curve ? joined({subject, purpose, part}) : qualified;
    if (style_ == Names::hashed) {
        // A different use would change the contents.
        file.use.is_inverted = true;
        file.least_precision = 0;
        name = joined({name, content_hash(contents_of(file))});
    } else {
        if (taken_.contains(name)) name = qualified;
        for (int number = 2; taken_.contains(name); ++number)
            name = joined({qualified, std::to_string(number)});
    }
    taken_.insert(name);
    file.name = name + file_extension(curve ? table_of(*curve) : ClfTable{});
    files_.push_back(std::move(file));
    return files_.back().name;
}

std::string LutFiles::contents_of(const File& file) {
    const auto* curve = std::get_if<Lut1DOp>(&file.table);
    const std::string note = curve ? ": one entry for every half float" : ": after its shaper";
    const ClfTable table =
        curve ? table_of(*curve, file.least_precision)
              : table_of(std::get<Lut3DOp>(file.table), file.use.is_exact, file.use.is_inverted);
    return write_clf(table, file.title, {fmt::format("Tonewright, {}{}", file.title, note)});
}

std::vector<GeneratedFile> LutFiles::files() const {
    std::vector<GeneratedFile> written(files_.size());
    in_parallel(files_.size(), 0, [&](std::size_t i) {
        written[i] = {fmt::format("{}/{}", folder_, files_[i].name), contents_of(files_[i])};
    });
    return written;
}

TONEWRIGHT_NAMESPACE_END
