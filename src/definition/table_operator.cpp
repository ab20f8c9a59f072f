// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <filesystem>
#include <memory>

#include "base/strings.h"
#include "definition/recipe.h"
#include "definition/table_stages.h"
#include "tonewright/input_encoding.h"
#include "tonewright/view.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

/// "Film Print v2" -> "film_print_v2".
std::string id_of(const std::string& name) {
    std::string id;
    for (const char c : lowercase(name)) {
        const bool is_plain = (c >= 'a' && c <= 'z') || (c >= '0' && c <= '9');
        if (is_plain) {
            id += c;
        } else if (!id.empty() && id.back() != '_') {
            id += '_';
        }
    }
    if (id.empty() || (id.front() >= '0' && id.front() <= '9')) id.insert(0, "lut_");
    return id.substr(0, kLongestName);
}

ParameterSpec text_with_default(std::string name, std::string value, std::string help) {
    ParameterSpec spec = text_parameter(std::move(name), std::move(help));
    spec.default_choice = std::move(value);
    return spec;
}

/// The setting, else the file's value, else the likely one.
std::string display_of(const TableFile& table, const Params& params) {
    const std::string& given = params.text("output");
    const std::string name = given.empty() ? table.likely_display : given;
    return is_same_name(name, kLinearOutput) ? std::string(kLinearOutput)
                                             : find_display(name, {std::string(kLinearOutput)}).id;
}

const Display* shown_on(const TableFile& table, const Params& params) {
    const std::string display = display_of(table, params);
    return display == kLinearOutput ? nullptr : &find_display(display);
}

std::string caution_of(const TableFile& table, const std::string& path, const Params& params) {
    std::string text;
    const auto add = [&](const std::string& more) {
        if (!more.empty()) text += (text.empty() ? path + ": " : "; ") + more;
    };
    if (params.text("input").empty()) {
        add("the encoding that the LUT expects is unknown, so colors are passed unchanged (set "
            "input; `none` keeps them unchanged)");
    }
    if (params.text("output").empty()) {
        add("the output is unknown and assumed to be " + table.likely_display +
            " (set output to a display or `linear`)");
    }
    add(table.note);
    return text;
}

/// The space that the file states belongs to the encoding that it states.
std::string space_of(const Params& params, const std::string& stated_encoding,
                     const std::string& stated_space) {
    const std::string& space = params.text("space");
    return space == stated_space && params.text("input") != stated_encoding ? "" : space;
}

}  // namespace

const std::vector<std::string>& table_extensions() {
    static const std::vector<std::string> all = {
        ".cube", ".clf", ".ctf", ".spi1d", ".spi3d", ".csp",  ".3dl", ".lut", ".itx", ".spimtx",
        ".cub",  ".vf",  ".mga", ".m3d",   ".dat",   ".look", ".cc",  ".icc", ".icm", ".raw",
        ".dds",  ".png", ".tif", ".tiff",  ".exr",   ".tga",  ".bmp", ".dpx"};
    return all;
}

Pipeline table_stages(const TableFile& table, const std::string& encoding, const std::string& space,
                      const Primaries& working) {
    if (encoding.empty() || encoding == kNoEncoding) {
        if (!space.empty())
            throw Error("space is " + space + "; expected an input encoding beside it");
        return table.stages;
    }
    const InputEncoding encode = parse_input_encoding(encoding);
    const Primaries& own = find_input_space(space.empty() ? encode.default_input : space).primaries;
    Pipeline stages;
    if (!(own == working)) stages.push_back(MatrixStage{rgb_to_rgb(working, own), "to_lut"});
    if (!same(encode.encode, Expr::input()))
        stages.push_back(named("encode_for_lut", curve_stage(encode.encode)));
    stages.insert(stages.end(), table.stages.begin(), table.stages.end());
    return stages;
}

std::shared_ptr<const Operator> operator_of_table(const TableFile& file, const std::string& path) {
    const auto table = std::make_shared<const TableFile>(file);
    const std::string stem = one_line(std::filesystem::path(path).stem().string());
    Operator op;
    op.id = id_of(stem);
    op.title = table->title.empty() ? stem : one_line(table->title);
    op.view = op.title.substr(0, kLongestName);
    op.character = table->description;
    op.source = std::filesystem::path(path).filename().string();
    op.license = "not stated";
    op.negatives = "limited by the LUT";
    op.file = path;
    op.parameters = {
        text_with_default("input", table->encoding,
                          "encoding that the LUT expects (see `bake --help`), or `none`"),
        text_with_default("space", table->space,
                          "scene-linear space of the LUT's input (default: that of its encoding)"),
        text_with_default("output", table->display,
                          "display whose code values the LUT gives, or `linear`")};
    const bool has_curve =
        std::any_of(table->stages.begin(), table->stages.end(), [](const Stage& stage) {
            const auto* const curve = std::get_if<CurveStage>(&stage);
            return curve && curve->f[0].op() == ExprOp::lookup;
        });
    if (has_curve) {
        // At a corner between two half floats, a quarter of their distance of at most 1/2048 times
        // the change of the slope.
        op.bounds.ocio_cpu = op.bounds.ocio_gpu = 5e-5;
        op.bounds.reason = "OpenColorIO joins a 1D table with its encoding at half floats";
    }
    op.display = [table](const Params& params) { return display_of(*table, params); };
    op.output_primaries = [table](const Params& params) {
        const Display* const display = shown_on(*table, params);
        return display ? display->primaries : kRec709;
    };
    op.peak = [table](const Params& params) {
        const Display* const display = shown_on(*table, params);
        return display && display->is_hdr ? display->largest_light : 1;
    };
    op.caution = [table, path](const Params& params) { return caution_of(*table, path, params); };
    op.build = [table](const Params& params) {
        (void)display_of(*table, params);  // a wrong name is an error of the settings
        return table_stages(*table, params.text("input"),
                            space_of(params, table->encoding, table->space), kRec709);
    };
    return std::make_shared<const Operator>(std::move(op));
}

bool is_table_operator(const Operator& op) {
    const std::vector<std::string>& known = table_extensions();
    return std::find(known.begin(), known.end(), extension_of(op.file)) != known.end();
}

std::string space_of_table(const ResolvedOperator& op) {
    const std::vector<ParameterSpec>& specs = op.op->parameters;
    return space_of(op.params, specs[0].default_choice, specs[1].default_choice);
}

TONEWRIGHT_NAMESPACE_END
