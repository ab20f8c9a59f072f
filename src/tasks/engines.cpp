// SPDX-License-Identifier: Apache-2.0
#include "tasks/engines.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <functional>
#include <utility>

#include "tonewright/engine.h"
#include "tonewright/registry.h"
#include "tonewright/view.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

/// The colors of the report's dialect matrix (src/report/web/parity.js).
std::vector<Vector3> compared_colors() {
    std::vector<Vector3> colors;
    for (int stops = -6; stops <= 6; ++stops) {
        const double light = 0.18 * std::exp2(stops);
        for (const double saturation : {0.0, 0.5, 0.9}) {
            for (int hue = 0; hue < (saturation > 0 ? 12 : 1); ++hue) {
                Vector3 color{};
                for (std::size_t c = 0; c < 3; ++c) {
                    const double turn = std::fmod(hue / 2.0 + 6 - 2.0 * static_cast<double>(c), 6);
                    const double full = std::clamp(std::abs(turn - 3) - 1, 0.0, 1.0);
                    color[c] = light * (1 - saturation + saturation * full);
                }
                colors.push_back(color);
            }
        }
    }
    return colors;
}

std::vector<Vector3> shown_by(const std::string& op) {
    const ReferenceEngine engine(
        build_view(make_view(resolve_operator(op), "lin_rec709", 0, "srgb")));
    std::vector<Vector3> shown = compared_colors();
    for (Vector3& color : shown)
        color = engine(color);
    return shown;
}

double mean_difference(const std::vector<Vector3>& a, const std::vector<Vector3>& b) {
    double sum = 0;
    for (std::size_t i = 0; i < a.size(); ++i) {
        for (std::size_t c = 0; c < 3; ++c)
            sum += std::abs(a[i][c] - b[i][c]);
    }
    return 255 * sum / (3 * static_cast<double>(a.size()));
}

std::string distance_text(double distance) {
    return fmt::format("{:.{}f}", distance, distance < 10 ? 1 : 0);
}

std::string difference_of(const EngineToneMapper& row) {
    if (!row.difference) return "";
    return fmt::format("{:.2g}", *row.difference) + (row.is_clamped ? " clamped" : "");
}

/// Rows of one version of a program.
using Group = std::vector<const EngineToneMapper*>;

std::vector<Group> groups() {
    std::vector<Group> all;
    for (const EngineToneMapper& row : engine_tone_mappers()) {
        const bool is_new = all.empty() || all.back().front()->program != row.program ||
                            all.back().front()->version != row.version ||
                            all.back().front()->package != row.package;
        if (is_new) all.emplace_back();
        all.back().push_back(&row);
    }
    return all;
}

/// The order that most rows of the group have.
const std::string& usual_order(const Group& group) {
    const auto count = [&](const std::string& order) {
        return std::count_if(group.begin(), group.end(),
                             [&](const EngineToneMapper* row) { return row->order == order; });
    };
    const auto most = std::max_element(group.begin(), group.end(),
                                       [&](const EngineToneMapper* a, const EngineToneMapper* b) {
                                           return count(a->order) < count(b->order);
                                       });
    return (*most)->order;
}

/// The row's note, and its order if that is not the group's.
std::string notes_of(const EngineToneMapper& row, const std::string& usual) {
    std::string text = row.note;
    if (row.order != usual) text += (text.empty() ? "" : "; ") + row.order;
    return text;
}

/// The texts with commas between them, in lines of at most 100 columns.
std::string wrapped(const std::vector<std::string>& texts) {
    constexpr std::size_t kLine = 100;
    std::string text = "     ";
    std::size_t length = text.size();
    for (std::size_t i = 0; i < texts.size(); ++i) {
        const std::string part = texts[i] + (i + 1 < texts.size() ? "," : "");
        if (i > 0 && length + 1 + part.size() > kLine) {
            text += "\n     ";
            length = 5;
        }
        text += " " + part;
        length += 1 + part.size();
    }
    return text;
}

std::string in_code(const std::string& text) { return text.empty() ? "" : "`" + text + "`"; }

}  // namespace

MeaningTable meaning_table(std::string_view name) {
    MeaningTable table{std::string(name), {}, {}};
    std::vector<std::vector<Vector3>> shown;
    for (NameMeaning& meaning : meanings_of(name)) {
        if (meaning.op.empty()) continue;
        shown.push_back(shown_by(meaning.op));
        table.meanings.push_back(std::move(meaning));
    }
    for (const std::vector<Vector3>& a : shown) {
        std::vector<double>& row = table.distances.emplace_back();
        for (const std::vector<Vector3>& b : shown)
            row.push_back(mean_difference(a, b));
    }
    return table;
}

std::string to_text(const MeaningTable& table) {
    constexpr std::string_view kHead = "  mean difference in 8-bit steps ";
    std::size_t width = kHead.size() - 5;
    for (const NameMeaning& meaning : table.meanings)
        width = std::max(width, meaning.op.size());
    const bool has_distances = table.meanings.size() > 1;
    std::string text;
    if (has_distances) {
        text = fmt::format("{:<{}}", kHead, width + 5);
        for (std::size_t i = 0; i < table.meanings.size(); ++i)
            text += fmt::format("{:>5}", i + 1);
        text += "\n";
    }
    for (std::size_t i = 0; i < table.meanings.size(); ++i) {
        const NameMeaning& meaning = table.meanings[i];
        if (i > 0) text += "\n";
        if (has_distances) {
            text += fmt::format("{:>3} {:<{}} ", i + 1, meaning.op, width);
            for (const double distance : table.distances[i])
                text += fmt::format("{:>5}", distance_text(distance));
        } else {
            text += "  " + meaning.op;
        }
        text += "\n" + wrapped(meaning.uses);
    }
    return text;
}

Json to_json(const MeaningTable& table) {
    Json meanings = Json::array();
    for (const NameMeaning& meaning : table.meanings)
        meanings.push_back({{"operator", meaning.op}, {"uses", meaning.uses}});
    return {{"name", table.name}, {"meanings", meanings}, {"distances", table.distances}};
}

std::vector<MeaningTable> meaning_tables() {
    std::vector<MeaningTable> tables;
    for (const std::string& name : ambiguous_names())
        tables.push_back(meaning_table(name));
    return tables;
}

Json to_json(const EngineToneMapper& row) {
    return {{"engine", row.program},
            {"version", row.version},
            {"package", row.package},
            {"name", row.name},
            {"names", row.names},
            {"operator", row.op},
            {"order", row.order},
            {"verdict", name_of(row.verdict)},
            {"difference", row.difference},
            {"unit", row.unit},
            {"compared", row.is_clamped ? "clamped to [0, 1]" : "as they come out"},
            {"display", row.display},
            {"measured", row.measured},
            {"note", row.note}};
}

std::string engines_as_text() {
    std::string text =
        "tone mappers of other programs, the operators that compute the same, and the largest\n"
        "difference of both (clamped: after a clamp of both to [0, 1])\n";
    for (const Group& group : groups()) {
        const EngineToneMapper& first = *group.front();
        const std::string& usual = usual_order(group);
        text += fmt::format("\n{} {}: {}\n  {}, measured {}{}{}\n", first.program, first.version,
                            usual, first.unit, first.measured, first.package.empty() ? "" : ", ",
                            first.package);
        for (const EngineToneMapper* row : group) {
            std::string line = fmt::format("  {:<33} {:<42} {:<8} {}", row->name, row->op,
                                           name_of(row->verdict), difference_of(*row));
            line.erase(line.find_last_not_of(' ') + 1);
            text += line + "\n";
            if (const std::string notes = notes_of(*row, usual); !notes.empty())
                text += "      " + notes + "\n";
        }
    }
    return text;
}

std::string engines_as_markdown() {
    std::string text;
    std::string program;
    for (const Group& group : groups()) {
        const EngineToneMapper& first = *group.front();
        const std::string& usual = usual_order(group);
        if (program != first.program) text += fmt::format("### {}\n\n", first.program);
        program = first.program;
        text +=
            fmt::format("Version {}{}. Order: {}. Differences: {}, measured {}.\n\n", first.version,
                        first.package.empty() ? "" : " (" + in_code(first.package) + ")", usual,
                        first.unit, first.measured);
        text +=
            "| tone mapper | operator | verdict | largest difference | |\n|---|---|---|--:|---|\n";
        for (const EngineToneMapper* row : group) {
            text +=
                fmt::format("| {} | {} | {} | {} | {} |\n", in_code(row->name), in_code(row->op),
                            name_of(row->verdict), difference_of(*row), notes_of(*row, usual));
        }
        text += "\n";
    }
    text += "## Names with several meanings\n";
    for (const MeaningTable& table : meaning_tables()) {
        text += fmt::format("\n### \"{}\"\n\n| | operator | used by |", table.name);
        for (std::size_t i = 0; i < table.meanings.size(); ++i)
            text += fmt::format(" {} |", i + 1);
        text += "\n|---|---|---|";
        for (std::size_t i = 0; i < table.meanings.size(); ++i)
            text += "--:|";
        for (std::size_t i = 0; i < table.meanings.size(); ++i) {
            text += fmt::format("\n| {} | `{}` | {} |", i + 1, table.meanings[i].op,
                                fmt::join(table.meanings[i].uses, ", "));
            for (const double distance : table.distances[i])
                text += fmt::format(" {} |", distance_text(distance));
        }
        text += "\n";
    }
    return text;
}

TONEWRIGHT_NAMESPACE_END
