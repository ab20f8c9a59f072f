// SPDX-License-Identifier: Apache-2.0
#include "lut/table_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <memory>
#include <optional>
#include <system_error>
#include <utility>

#include "base/bounded_cache.h"
#include "base/format_number.h"
#include "base/input_file.h"
#include "base/strings.h"
#include "lut/dds.h"
#include "lut/half_domain.h"
#include "lut/icc.h"
#include "lut/lut_text.h"
#include "lut/raw.h"
#include "lut/stated_input.h"
#include "tonewright/lut.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

constexpr int kLargestEdge = 129;  // of OpenColorIO

/// One curve if the channels are equal.
CurveStage curve_of(const std::array<Table, 3>& tables) {
    std::array<Expr, 3> f = {0, 0, 0};
    for (std::size_t c = 0; c < 3; ++c) {
        const bool is_known = c > 0 && tables[c].samples == tables[0].samples;
        f[c] = is_known ? f[0] : lookup(std::make_shared<const Table>(tables[c]), Expr::input());
    }
    return {f, std::nullopt};
}

TableFile read_cube(const std::string& path, const std::string& bytes) {
    const CubeText cube = parse_cube(path, bytes);
    TableFile table;
    if (cube.table.size > 0) {
        add_range(table.stages, cube.table.lo, cube.table.hi);
        table.stages.emplace_back(tables_of(cube.table.rows));
    }
    if (cube.cube.size > 0) {
        add_range(table.stages, cube.cube.lo, cube.cube.hi);
        table.stages.emplace_back(grid_of(cube.cube.size, cube.cube.rows));
    }
    table.note = cube.note;
    return table;
}

/// LittleCMS evaluates the profile at the nodes of the 3D LUT.
TableFile read_device_link(const std::string& path, const std::string& bytes) {
    const DeviceLink link(path, bytes);
    const int n = link.edge();
    if (n < 2)
        throw FileError("read: " + path +
                        ": its table has different sides; expected as many nodes on each");
    const auto run = [&](int steps) {
        std::vector<float> at;
        for (int i = 0; i < steps * steps * steps; ++i) {
            for (const int place : {i % steps, i / steps % steps, i / (steps * steps)})
                at.push_back(static_cast<float>(place) / static_cast<float>(steps - 1));
        }
        std::vector<float> out(at.size());
        link.run_rgb(at.data(), out.data(), out.size() / 3);
        return std::pair(std::move(at), std::move(out));
    };
    TableFile table;
    const GridStage stage = grid_of(n, run(n).second);
    table.stages.emplace_back(stage);
    // The nodes would lose curves before its table. 16 bits round nodes, position and result by
    // 1.5e-5 each.
    constexpr double kRounding = 1e-4;
    const auto [at, wanted] = run(18);
    for (std::size_t i = 0; i < at.size(); i += 3) {
        const std::array<double, 3> is =
            (*stage.grid)(static_cast<double>(at[i]), static_cast<double>(at[i + 1]),
                          static_cast<double>(at[i + 2]));
        for (std::size_t c = 0; c < 3; ++c) {
            if (std::fabs(is[c] - static_cast<double>(wanted[i + c])) <= kRounding) continue;
            throw FileError("read: " + path +
                            ": it has curves beside its table; expected a table alone");
        }
    }
    return table;
}

TableFile read_own(const std::string& path, const std::string& extension) {
    const std::string bytes = read_file(path, kLargestLutFile, [&](const Problem& why) {
        throw FileError(within("read: " + path, why));
    });
    TableFile table;
    if (is_parsed_here(extension)) {
        table = read_cube(path, bytes);
    } else if (extension == ".raw") {
        table = table_file_of(parse_raw_lut(path, bytes), path);
    } else if (extension == ".dds") {
        table = table_file_of(parse_dds(path, bytes), path);
    } else {
        table = read_device_link(path, bytes);
    }
    describe_table(table, path, bytes);
    return table;
}

/// Identifies a version of a file.
struct FileState {
    std::string path;
    std::filesystem::file_time_type time;
    std::uintmax_t size;

    friend bool operator==(const FileState& a, const FileState& b) {
        return a.path == b.path && a.time == b.time && a.size == b.size;
    }
};

/// Nothing if it is no file.
std::optional<FileState> state_of(const std::string& path) {
    namespace fs = std::filesystem;
    std::error_code error;
    FileState state = {path, fs::last_write_time(path, error), 0};
    if (error || !fs::is_regular_file(path, error)) return std::nullopt;
    state.size = fs::file_size(path, error);
    return error ? std::nullopt : std::optional(state);
}

std::string description_of(const Pipeline& stages) {
    std::string text;
    for (const Stage& stage : stages) {
        std::string part;
        if (const auto* grid = std::get_if<GridStage>(&stage))
            part = fmt::format("3D LUT of {0} x {0} x {0} nodes", grid->grid->edge());
        const auto* curve = std::get_if<CurveStage>(&stage);
        if (curve && curve->f[0].op() == ExprOp::lookup)
            part = fmt::format("1D table of {} entries", curve->f[0].table()->samples.size());
        if (!part.empty()) text += (text.empty() ? "" : ", ") + part;
    }
    return text.empty() ? "Formulas without a table" : text;
}

/// TITLE of a .cube.
std::string title_of(std::string_view text) {
    constexpr std::string_view kTitle = "TITLE";
    while (!text.empty()) {
        const std::size_t end = std::min(text.find('\n'), text.size() - 1);
        const std::string_view line = trimmed(text.substr(0, end + 1));
        text.remove_prefix(end + 1);
        if (!line.starts_with(kTitle)) continue;
        std::string_view title = trimmed(line.substr(kTitle.size()));
        if (title.size() > 1 && title.front() == '"' && title.back() == '"')
            title = title.substr(1, title.size() - 2);
        return printable(title);
    }
    return "";
}

}  // namespace

GridStage grid_of(int edge, const std::vector<float>& nodes) {
    if (edge > kLargestEdge) {
        throw Error(fmt::format("3D LUT has {} nodes a side; expected at most {} of an operator",
                                edge, kLargestEdge));
    }
    const auto n = static_cast<std::size_t>(edge);
    const auto turned = std::make_shared<std::vector<double>>(nodes.size());
    for (std::size_t i = 0; i < n * n * n; ++i) {
        const std::size_t from = (i % n * n + i / n % n) * n + i / (n * n);
        for (std::size_t c = 0; c < 3; ++c)
            (*turned)[3 * i + c] = static_cast<double>(nodes[3 * from + c]);
    }
    return {Expr::input(),
            std::make_shared<const Grid>(edge, [turned] { return std::move(*turned); })};
}

CurveStage tables_of(const std::vector<float>& rows) {
    std::array<Table, 3> tables;
    for (std::size_t i = 0; i < rows.size(); ++i)
        tables.at(i % 3).samples.push_back(static_cast<double>(rows[i]));
    return curve_of(tables);
}

CurveStage half_tables_of(const std::vector<float>& rows) {
    std::array<Table, 3> tables;
    const auto add = [&](unsigned bits) {
        for (std::size_t c = 0; c < 3; ++c) {
            tables.at(c).positions.push_back(half_value(bits));
            tables.at(c).samples.push_back(static_cast<double>(rows[3 * std::size_t{bits} + c]));
        }
    };
    constexpr unsigned kLargest = 0x7BFF;
    constexpr unsigned kSign = 0x8000;
    for (unsigned bits = kLargest; bits > 0; --bits)
        add(kSign | bits);
    for (unsigned bits = 0; bits <= kLargest; ++bits)
        add(bits);
    return curve_of(tables);
}

void add_range(Pipeline& stages, const Vector3& lo, const Vector3& hi) {
    const Expr x = Expr::input();
    std::array<Expr, 3> f = {x, x, x};
    for (std::size_t c = 0; c < 3; ++c)
        f[c] = (x - lo[c]) / (hi[c] - lo[c]);
    const CurveStage stage{f, std::nullopt};
    if (!is_identity(stage)) stages.emplace_back(stage);
}

void describe_table(TableFile& table, const std::string& path, std::string_view contents) {
    table.description = description_of(table.stages);
    const std::string extension = extension_of(path);
    const bool is_link = extension == ".icc" || extension == ".icm";
    const std::string_view text = is_link ? contents : contents.substr(0, std::size_t{1} << 16U);
    if (extension == ".cube") table.title = title_of(text);
    if (const std::optional<StatedInput> input = read_stated_input(text)) {
        table.encoding = input->encoding;
        table.space = input->space;
    }
    table.display = read_stated_display(text).value_or("");
    // Formats for linear values: code values have no common exponent.
    if (extension == ".dds") table.likely_display = kLinearOutput;
}

bool is_lut_picture(const std::string& path) {
    constexpr std::array kPictures = {".png", ".tif", ".tiff", ".exr", ".tga", ".bmp", ".dpx"};
    return std::find(kPictures.begin(), kPictures.end(), extension_of(path)) != kPictures.end();
}

TableFile table_file_of(const Lut& lut, const std::string& path) {
    TableFile table;
    try {
        if (lut.dimension == 3) {
            table.stages.emplace_back(grid_of(lut.size, lut.values));
        } else {
            std::vector<float> rows;
            const std::size_t copies = lut.channels == 1 ? 3 : 1;
            for (const float value : lut.values)
                rows.insert(rows.end(), copies, value);
            table.stages.emplace_back(lut.is_half_domain ? half_tables_of(rows) : tables_of(rows));
        }
    } catch (const Error& e) {
        throw FileError(within("read: " + path, e.problem()));
    }
    describe_table(table, path, "");
    return table;
}

TableReader table_reader(TableReader next) {
    using Cache = BoundedCache<FileState, TableFile>;
    constexpr std::size_t kFiles = 4;
    const auto cache = std::make_shared<Cache>(kFiles);
    return [cache, next = std::move(next)](const std::string& path) {
        const std::string extension = extension_of(path);
        constexpr std::array kOwn = {".cube", ".dat", ".mga", ".m3d",
                                     ".raw",  ".dds", ".icc", ".icm"};
        const bool is_own = std::find(kOwn.begin(), kOwn.end(), extension) != kOwn.end();
        const auto read = [&] {
            require_regular_file(path);
            if (is_own) return read_own(path, extension);
            if (next) return next(path);
            throw FileError("read: " + path + ": this program reads no " + extension +
                            " as an operator; expected " +
                            join_choices({kOwn.begin(), kOwn.end()}));
        };
        const std::optional<FileState> state = state_of(path);
        return state ? *cache->get(*state, read) : read();
    };
}

TONEWRIGHT_NAMESPACE_END
