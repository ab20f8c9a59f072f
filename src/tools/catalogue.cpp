// SPDX-License-Identifier: Apache-2.0
#include "tools/catalogue.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <map>
#include <numeric>
#include <span>
#include <thread>

#include "base/atomic_file.h"
#include "base/format_number.h"
#include "cli/messages.h"
#include "measure/error_metric.h"
#include "measure/sample_set.h"
#include "plot/curve_plot.h"
#include "plot/gray_curve.h"
#include "tasks/operator_facts.h"
#include "tonewright/engine.h"
#include "tonewright/generated_files.h"
#include "tonewright/registry.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

// ---------------------------------------------------------------------------------------------
// Variants of an operator, for plots and tables

/// An operator with its defaults, with one of its presets, or with one of its looks.
struct Variant {
    std::string label;  // `default`, `:preset`, `look id`
    std::string id;     // of an element of a plot: default, preset id, look-id
    std::string help;
    View view;
};

View srgb_view(const std::string& name, const std::string& look = {}) {
    return make_view(resolve_operator(name, {}, look), "lin_rec709", 0, "srgb");
}

std::vector<Variant> variants_of(const Operator& op) {
    std::vector<Variant> all = {{"default", "default", op.character, srgb_view(op.id)}};
    for (const Preset& p : op.presets)
        all.push_back({":" + p.id, p.id, p.title, srgb_view(op.id + ":" + p.id)});
    for (const Look& l : op.looks)
        all.push_back({"look " + l.id, "look-" + l.id, l.help, srgb_view(op.id, l.id)});
    return all;
}

// ---------------------------------------------------------------------------------------------
// Plots

/// A color whose hue and saturation the plots show; its largest channel is 1.
struct SceneColor {
    const char* name;
    const char* numbers;
    Vector3 rgb;
};
constexpr SceneColor kOrange = {"orange", "1, 0.25, 0.02", {1, 0.25, 0.02}};
constexpr SceneColor kGreen = {"green", "0.05, 1, 0.1", {0.05, 1, 0.1}};
constexpr SceneColor kBlue = {"blue", "0.02, 0.06, 1", {0.02, 0.06, 1}};
constexpr SceneColor kGray = {"gray", "1, 1, 1", {1, 1, 1}};

constexpr std::array kChannelColors = {"#d1242f", "#1a8f3c", "#1f6feb"};
constexpr std::array kChannelNames = {"red", "green", "blue"};

PlotLine reference_line(const std::vector<double>& scene) {
    return {"clamp",   "no tone mapping: clamp",
            "#a8b0b9", 1.2,
            {5, 3},    gray_codes(srgb_view("clamp"), scene)};
}

/// "0.18 -> 0.435" where the curve is at that scene value.
PlotMark mark_at(const View& view, double scene) {
    const double code = gray_code(view, scene);
    return {std::log2(scene / kMidGray), code,
            fmt::format("{} \u2192 {:.3f}", shortest(scene), code)};
}

std::vector<Vector3> colors_of(const Pipeline& pipeline, const Vector3& color,
                               const std::vector<double>& stops) {
    const Planes planes = codes_of(pipeline, color, scene_of(stops));
    std::vector<Vector3> colors;
    for (std::size_t i = 0; i < stops.size(); ++i)
        colors.push_back({planes[0][i], planes[1][i], planes[2][i]});
    return colors;
}

CurvePlot plot_of(const Operator& op) {
    const std::vector<double> scene = scene_of(plot_stops());
    const std::vector<Variant> variants = variants_of(op);
    CurvePlot plot;
    plot.title = op.title;
    plot.subtitle = "sRGB code value of scene-linear gray";
    for (const Variant& v : variants) {
        const std::size_t index = plot.lines.size();
        add_line(plot.lines,
                 {v.id, v.label, line_color(index), index == 0 ? 2.4 : 1.3, line_dashes(index),
                  gray_codes(v.view, scene)},
                 v.label);
    }
    if (variants.size() == 1) plot.lines[0].label.clear();

    const Pipeline view = build_view(variants[0].view);
    const Planes gray = codes_of(view, kGray.rgb, scene);
    double tint = 0;
    for (const std::vector<double>& channel : gray)
        tint = std::max(tint, largest_difference(channel, plot.lines[0].values));
    if (tint > 0.5 / 255) {
        if (variants.size() == 1) plot.lines[0].label = "luminance of the shown gray";
        for (std::size_t c = 0; c < 3; ++c) {
            plot.lines.push_back({fmt::format("gray-{}", kChannelNames[c]),
                                  fmt::format("{} of the shown gray", kChannelNames[c]),
                                  kChannelColors[c],
                                  1,
                                  {},
                                  gray[c]});
        }
    }
    PlotLine clamp = reference_line(scene);
    if (largest_difference(clamp.values, plot.lines[0].values) >= kSameLine)
        plot.lines.push_back(clamp);
    if (!op.is_diagnostic) {
        plot.marks = {mark_at(variants[0].view, kMidGray), mark_at(variants[0].view, 1)};
        plot.lower_heading = fmt::format("red, green and blue of {} ({}) \u00d7 scene",
                                         kOrange.name, kOrange.numbers);
        plot.lower_scale.step = 0.5;
        const Planes orange = codes_of(view, kOrange.rgb, scene);
        for (std::size_t c = 0; c < 3; ++c)
            plot.lower_lines.push_back(
                {kChannelNames[c], "", kChannelColors[c], 1.6, {}, orange[c]});
    }
    std::vector<double> whole_stops(21);
    std::iota(whole_stops.begin(), whole_stops.end(), -10.0);
    for (const SceneColor& color : {kGray, kOrange, kBlue})
        plot.sweeps.push_back({color.name, colors_of(view, color.rgb, whole_stops)});
    return plot;
}

// ---------------------------------------------------------------------------------------------
// Dialects: operators of one name

/// One member of a group: an operator, or a preset of it.
struct Dialect {
    std::string letter;
    std::string name;
    std::string op;
    std::string help;
    View view;
    /// Results for the samples; interleaved RGB.
    std::vector<double> codes = {};
    std::vector<double> ictcp = {};
};

struct DialectGroup {
    std::string name;
    std::string slug;
    std::vector<Dialect> dialects;
};

std::string slug_of(const std::string& name) {
    std::string slug;
    for (const char c : name) {
        const bool is_plain = (c >= 'a' && c <= 'z') || (c >= '0' && c <= '9');
        if (c >= 'A' && c <= 'Z') {
            slug += static_cast<char>(c - 'A' + 'a');
        } else if (is_plain) {
            slug += c;
        } else if (!slug.empty() && slug.back() != '_') {
            slug += '_';
        }
    }
    return slug;
}

/// A to Z, then AA.
std::string letter_of(std::size_t index) {
    const std::string last(1, static_cast<char>('A' + index % 26));
    return index < 26 ? last : letter_of(index / 26 - 1) + last;
}

/// False if no other operator has that dialect's name.
bool is_dialect(const Operator& op) {
    if (op.dialects.empty()) return false;
    const std::vector<Operator>& all = all_operators();
    return std::count_if(all.begin(), all.end(),
                         [&](const Operator& o) { return o.dialects == op.dialects; }) > 1;
}

/// Sorted by name.
std::vector<DialectGroup> dialect_groups() {
    std::map<std::string, std::vector<Dialect>> by_name;
    for (const Operator& op : all_operators()) {
        if (!is_dialect(op)) continue;
        std::vector<Dialect>& dialects = by_name[op.dialects];
        for (const Variant& v : variants_of(op)) {
            if (!v.view.op.params.look().empty()) continue;  // differs on purpose
            const bool is_preset = v.label.front() == ':';
            dialects.push_back({letter_of(dialects.size()),
                                op.id + (is_preset ? v.label : ""),
                                op.id,
                                is_preset ? v.help : op.title,
                                v.view,
                                {}});
        }
    }
    std::vector<DialectGroup> groups;
    groups.reserve(by_name.size());
    for (auto& [name, dialects] : by_name)
        groups.push_back({name, slug_of(name), std::move(dialects)});
    return groups;
}

/// The smallest round number that is not below `value`.
double round_scale(double value) {
    double unit = 1;
    while (10 * unit < value)
        unit *= 10;
    for (const double digit : {1, 2, 3, 5, 7}) {
        if (digit * unit >= value) return digit * unit;
    }
    return 10 * unit;
}

CurvePlot plot_of(const DialectGroup& group) {
    const std::vector<double> scene = scene_of(plot_stops());
    CurvePlot plot;
    plot.title = group.name + ": gray curves";
    plot.subtitle = "sRGB code value of scene-linear gray";
    std::vector<double> mean(scene.size());
    for (const Dialect& d : group.dialects) {
        const std::vector<double> codes = gray_codes(d.view, scene);
        const std::size_t index = plot.lines.size();
        add_line(
            plot.lines,
            {d.letter, d.letter + " " + d.name, line_color(index), 1.6, line_dashes(index), codes},
            d.letter);
        for (std::size_t i = 0; i < scene.size(); ++i)
            mean[i] += codes[i] / static_cast<double>(group.dialects.size());
    }
    double largest = 0;
    for (PlotLine line : plot.lines) {
        for (std::size_t i = 0; i < scene.size(); ++i) {
            line.values[i] = 255 * (line.values[i] - mean[i]);
            largest = std::max(largest, std::fabs(line.values[i]));
        }
        line.id += "-difference";
        line.label.clear();
        line.width = 1.3;
        plot.lower_lines.push_back(line);
    }
    const double scale = round_scale(largest);
    plot.lower_heading = "difference from their mean, in 8-bit code values";
    plot.lower_scale = {-scale, scale, scale};
    plot.lines.push_back(reference_line(scene));
    return plot;
}

PatchChart colors_of(const DialectGroup& group) {
    PatchChart chart;
    chart.title = group.name + ": colors";
    chart.subtitle = "scene color at stops from mid gray, on an sRGB display";
    const std::vector<double> stops = {-2, 0, 2, 4, 6};
    const std::vector<SceneColor> colors = {kOrange, kGreen, kBlue};
    for (const SceneColor& color : colors) {
        chart.blocks.push_back({fmt::format("{} ({})", color.name, color.numbers),
                                {"\u22122", "0", "+2", "+4", "+6"}});
    }
    for (const Dialect& d : group.dialects) {
        const Pipeline view = build_view(d.view);
        PatchRow row = {d.letter + " " + d.name, {}};
        for (const SceneColor& color : colors) {
            const std::vector<Vector3> patches = colors_of(view, color.rgb, stops);
            row.codes.insert(row.codes.end(), patches.begin(), patches.end());
        }
        chart.rows.push_back(row);
    }
    return chart;
}

/// Difference of two dialects.
struct Distance {
    std::size_t a, b;
    ErrorStats codes;  // of 255
    ErrorStats delta_e;
};

/// The standard samples that have no negative channel.
std::vector<float> non_negative_samples() {
    const SampleSet samples = make_sample_set(find_input_space("lin_rec709"));
    std::vector<float> rgb;
    for (std::size_t i = 0; i < samples.size(); ++i) {
        if (samples.is_non_negative(i))
            rgb.insert(rgb.end(), &samples.rgb[3 * i], &samples.rgb[3 * i] + 3);
    }
    return rgb;
}

Distance distance_of(const DialectGroup& group, std::size_t a, std::size_t b) {
    const std::vector<double>& x = group.dialects[a].codes;
    const std::vector<double>& y = group.dialects[b].codes;
    std::vector<double> worst(x.size() / 3);
    for (std::size_t i = 0; i < x.size(); ++i)
        worst[i / 3] = std::max(worst[i / 3], 255 * std::fabs(x[i] - y[i]));
    return {a, b, summarise(worst),
            summarise(delta_e_itp(group.dialects[a].ictcp, group.dialects[b].ictcp))};
}

/// Every pair of the group.
std::vector<Distance> distances_of(DialectGroup& group, const std::vector<float>& samples) {
    for (Dialect& d : group.dialects) {
        d.codes.resize(samples.size());
        ReferenceEngine(build_view(d.view))
            .run_rgb(samples.data(), d.codes.data(), samples.size() / 3);
        d.ictcp = ictcp_of_codes(find_display("srgb"), d.codes);
    }
    std::vector<Distance> all;
    for (std::size_t a = 0; a < group.dialects.size(); ++a) {
        for (std::size_t b = a + 1; b < group.dialects.size(); ++b)
            all.push_back({a, b, {}, {}});
    }
    const std::size_t workers = std::max(1U, std::thread::hardware_concurrency());
    std::vector<std::thread> threads;
    for (std::size_t w = 0; w < workers; ++w) {
        threads.emplace_back([&, w] {
            for (std::size_t i = w; i < all.size(); i += workers)
                all[i] = distance_of(group, all[i].a, all[i].b);
        });
    }
    for (std::thread& t : threads)
        t.join();
    for (Dialect& d : group.dialects)
        d.codes = d.ictcp = {};
    return all;
}

// ---------------------------------------------------------------------------------------------
// The page

/// Escapes text for a cell of a table.
std::string cell(std::string text) {
    for (std::size_t at = 0; (at = text.find('|', at)) != std::string::npos; at += 2)
        text.insert(at, "\\");
    return text;
}

std::string signed_stops(double stops) { return fmt::format("{:+.1f}", stops); }

/// Stops from mid gray at which the displayed gray reaches `code`; nothing if it never does.
std::optional<double> stops_at_code(const View& view, double code) {
    std::vector<double> stops;
    for (int i = -20 * 32; i <= 18 * 32; ++i)
        stops.push_back(i / 32.0);
    const std::vector<double> codes = gray_codes(view, scene_of(stops));
    const auto found =
        std::find_if(codes.begin(), codes.end(), [&](double c) { return c >= code; });
    if (found == codes.begin() || found == codes.end()) return std::nullopt;
    double hi = stops[static_cast<std::size_t>(found - codes.begin())];
    double lo = hi - 1 / 32.0;
    for (int i = 0; i < 30; ++i) {
        const double middle = (lo + hi) / 2;
        (gray_code(view, kMidGray * std::exp2(middle)) >= code ? hi : lo) = middle;
    }
    return hi;
}

/// Slope of log output over log scene value at mid gray: 1 without tone mapping.
double contrast_at_mid_gray(const View& view) {
    View linear = view;
    const Display& display = find_display(view.display);
    constexpr double kStep = 1.0 / 256;
    std::vector<double> stops = {-kStep, kStep};
    const std::vector<double> codes = gray_codes(linear, scene_of(stops));
    const ReferenceEngine decode(display.decode);
    const double low = decode({codes[0], codes[0], codes[0]})[0];
    const double high = decode({codes[1], codes[1], codes[1]})[0];
    if (!(low > 0)) return 0;
    return std::log2(high / low) / (2 * kStep);
}

std::string measured_line(const Operator& op) {
    const View view = srgb_view(op.id);
    const double darkest = gray_code(view, 0);
    const double brightest = gray_code(view, kHalfMax);
    const std::optional<double> black = stops_at_code(view, 0.5 / 255);
    const std::optional<double> white = stops_at_code(view, 254.5 / 255);
    std::string text = fmt::format(
        "* Measured on sRGB: 0.18 \u2192 {:.3f}, 1 \u2192 {:.3f}; contrast at mid gray {:.2f}; ",
        gray_code(view, kMidGray), gray_code(view, 1), contrast_at_mid_gray(view));
    if (black) {
        text += fmt::format("black below {} stops", signed_stops(*black));
    } else {
        text += fmt::format("black at code {:.3f}", darkest);
    }
    if (white) {
        text += fmt::format(", white from {} stops (scene-linear {:.3g})\n", signed_stops(*white),
                            kMidGray * std::exp2(*white));
    } else {
        text += fmt::format(", white at code {:.3f}\n", brightest);
    }
    return text;
}

/// Group of an operator in the index.
std::string family_of(const Operator& op) {
    if (op.is_diagnostic) return "Diagnostic";
    if (is_dialect(op)) return op.dialects;
    for (const ParameterSpec& p : op.parameters) {
        if (p.from_picture) return "Operators that adapt to the picture";
    }
    return is_per_channel(resolve_operator(op.id).build()) ? "Per-channel curves"
                                                           : "Operators that mix channels";
}

/// Page and anchor of a group.
std::string dialects_page(const DialectGroup& group) {
    return fmt::format("dialects.md#dialects_{}", group.slug);
}

/// Name of an operator in the index. Links to the index may name it as an anchor.
std::string index_cell(const Operator& op) {
    return fmt::format("<a id=\"{0}\"></a>[{1}](operators/{0}.md)<br>`{0}`", op.id, cell(op.title));
}

std::string index_section(const std::vector<DialectGroup>& groups) {
    std::map<std::string, std::vector<const Operator*>> families;
    for (const Operator& op : all_operators())
        families[family_of(op)].push_back(&op);
    std::vector<std::string> order;
    for (const auto& [name, members] : families) {
        if (is_dialect(*members[0])) order.push_back(name);
    }
    for (const char* name : {"Per-channel curves", "Operators that mix channels",
                             "Operators that adapt to the picture", "Diagnostic"}) {
        if (families.count(name)) order.emplace_back(name);
    }
    std::string text = "| operator | character | 0.18 \u2192 | 1 \u2192 |\n|---|---|---|---|\n";
    for (const std::string& family : order) {
        const auto group = std::find_if(groups.begin(), groups.end(),
                                        [&](const DialectGroup& g) { return g.name == family; });
        if (group == groups.end()) {
            text += fmt::format("| **{}** | | | |\n", cell(family));
        } else {
            text += fmt::format("| <a id=\"dialects_{0}\"></a>**{1}** | [differences]({2}) | | |\n",
                                group->slug, cell(family), "operators/" + dialects_page(*group));
        }
        for (const Operator* op : families[family]) {
            const View view = srgb_view(op->id);
            text += fmt::format("| {} | {} | {:.3f} | {:.3f} |\n", index_cell(*op),
                                cell(op->character), gray_code(view, kMidGray), gray_code(view, 1));
        }
    }
    text += "| **Local: pictures only** | [local operators](local.md) | | |\n";
    for (const Operator& op : local_operators())
        text += fmt::format("| {} | {} | | |\n", index_cell(op), cell(op.character));
    return text + "\n";
}

std::string link_to(const Dialect& d) { return fmt::format("[`{}`]({}.md)", d.name, d.op); }

std::string pair_table(const DialectGroup& group, std::vector<Distance> distances) {
    // Compare the printed digits, so that rounding of doubles does not change the order.
    std::stable_sort(distances.begin(), distances.end(), [](const Distance& x, const Distance& y) {
        return std::lround(100 * x.delta_e.mean) > std::lround(100 * y.delta_e.mean);
    });
    std::string text =
        "| pair | max | 99.9 % | mean | \u0394E ITP max | \u0394E ITP mean |\n"
        "|---|---|---|---|---|---|\n";
    for (const Distance& d : distances) {
        const Dialect& a = group.dialects[d.a];
        const Dialect& b = group.dialects[d.b];
        text += fmt::format("| {} `{}`, {} `{}` | {:.1f} | {:.1f} | {:.2f} | {:.1f} | {:.2f} |\n",
                            a.letter, a.name, b.letter, b.name, d.codes.max, d.codes.p999,
                            d.codes.mean, d.delta_e.max, d.delta_e.mean);
    }
    return text + "\n";
}

/// Mean dE ITP below the diagonal, mean of the code values above it.
std::string distance_matrix(const DialectGroup& group, const std::vector<Distance>& distances) {
    const std::size_t n = group.dialects.size();
    std::vector<std::vector<std::string>> cells(n, std::vector<std::string>(n, "\u00b7"));
    for (const Distance& d : distances) {
        cells[d.a][d.b] = fmt::format("{:.1f}", d.codes.mean);
        cells[d.b][d.a] = fmt::format("{:.1f}", d.delta_e.mean);
    }
    std::string text = "|  |";
    std::string rule = "|---|";
    for (const Dialect& d : group.dialects) {
        text += fmt::format(" {} |", d.letter);
        rule += "--:|";
    }
    text += "\n" + rule + "\n";
    for (std::size_t a = 0; a < n; ++a) {
        text += fmt::format("| **{}** |", group.dialects[a].letter);
        for (std::size_t b = 0; b < n; ++b)
            text += fmt::format(" {} |", cells[a][b]);
        text += "\n";
    }
    return text + "\n";
}

std::string dialect_section(DialectGroup& group, const std::vector<float>& samples) {
    const std::vector<Distance> distances = distances_of(group, samples);
    std::string text = fmt::format(
        "<a id=\"dialects_{0}\"></a>\n\n## {1}\n\n![Gray curves of {1}]"
        "(../curves/dialects_{0}.svg)\n\n![Colors of {1}](../curves/dialects_{0}_colors.svg)\n\n"
        "|  | dialect |  | 0.18 \u2192 | 1 \u2192 | 4 \u2192 |\n|---|---|---|---|---|---|\n",
        group.slug, group.name);
    for (const Dialect& d : group.dialects) {
        text += fmt::format("| **{}** | {} | {} | {:.3f} | {:.3f} | {:.3f} |\n", d.letter,
                            link_to(d), cell(d.help), gray_code(d.view, kMidGray),
                            gray_code(d.view, 1), gray_code(d.view, 4));
    }
    text += "\n";
    constexpr std::size_t kPlainList = 10;
    if (distances.size() <= kPlainList) return text + pair_table(group, distances);
    const auto closest = std::min_element(
        distances.begin(), distances.end(),
        [](const auto& x, const auto& y) { return x.delta_e.mean < y.delta_e.mean; });
    const auto farthest = std::max_element(
        distances.begin(), distances.end(),
        [](const auto& x, const auto& y) { return x.delta_e.mean < y.delta_e.mean; });
    text += fmt::format(
        "Mean differences: code values above the diagonal, \u0394E ITP below it. Closest pair: {} "
        "and {}; farthest pair: {} and {}.\n\n",
        group.dialects[closest->a].letter, group.dialects[closest->b].letter,
        group.dialects[farthest->a].letter, group.dialects[farthest->b].letter);
    text += distance_matrix(group, distances);
    return text + fmt::format("<details><summary>All {} pairs</summary>\n\n{}</details>\n\n",
                              distances.size(), pair_table(group, distances));
}

constexpr const char* kIntroduction =
    "# Operators\n\n"
    "Each operator has a page with its plot, parameters and source. The two figures are sRGB code "
    "values of scene-linear 0.18 (mid\ngray) and 1 (diffuse white). <a "
    "id=\"dialects\"></a>[Dialects](operators/dialects.md) compares operators that share a name.\n"
    "`./run artifacts` generates these pages.\n\n";

/// Below the index.
std::string legend() {
    return fmt::format(
        "## How to read the plots\n\n"
        "The plots show an operator with its default parameters on an sRGB display, from the "
        "double-precision reference.\n\n"
        "* *Upper graph*: code value of a scene-linear gray, over stops from mid gray. The right "
        "axis shows the display-linear value\n  of the code value; the numbers below the stops "
        "are scene values. Thin lines are presets and looks. The line of a tinted\n  gray is its "
        "luminance. Vertical lines mark 0.18 (mid gray) and 1 (diffuse white). The broken line "
        "is a clamp, without\n  tone mapping.\n"
        "* *Lower graph*: red, green and blue of a saturated orange, ({}) times the scene value. "
        "Where the lines meet,\n  bright colors fade to white. Where one line stays at 1 while "
        "the others rise, the hue shifts.\n"
        "* *Strips*: displayed colors, one patch per stop: of gray, of that orange, and of a blue "
        "({}).\n"
        "* *Small graphs*: one per line, with the first line in gray, if a plot has more than six "
        "lines.\n\n"
        "The plots clip at display white, as every SDR view does. Presets for brighter displays "
        "also clip.\n\n"
        "Measured values are code values from 0 to 1. *Contrast at mid gray* is the slope of "
        "log output over log scene value: 1 without\ntone mapping. *Black* and *white* are the "
        "scene values at 8-bit codes 0 and 255. An operator that adapts to the picture is\nshown "
        "with its default parameters; `tonewright apply` measures the picture.\n\n",
        kOrange.numbers, kBlue.numbers);
}

std::string dialect_introduction(std::size_t sample_count) {
    return fmt::format(
        "# Dialects\n\n"
        "Operators of one name that show different pictures, and their presets. Looks are left "
        "out, because they are meant to differ. The\ndifference of two dialects is measured on "
        "the {} colors of the [sample set](../conventions.md) without negative channels, "
        "in\nlinear "
        "Rec.709, on an sRGB display.\n\n"
        "The first columns are differences in 8-bit code values (code value \u00d7 255), of the "
        "worst channel of each color. \u0394E ITP (ITU-R BT.2124,\nwhite at 100 cd/m\u00b2) is "
        "about 1 for the smallest visible difference. Most samples are saturated, and many are "
        "far above\nwhite, so the largest differences belong to colors that are rare in pictures. "
        "Use the means to compare pairs.\n\n",
        sample_count);
}

/// Last line of an operator's page.
std::string links_of(const Operator& op, const std::vector<DialectGroup>& groups) {
    std::string text = "More: [all operators](../operators.md)";
    text += op.is_local() ? ", [local operators](../local.md)"
                          : ", [how to read the plot](../operators.md#how-to-read-the-plots)";
    const auto group = std::find_if(groups.begin(), groups.end(),
                                    [&](const DialectGroup& g) { return g.name == op.dialects; });
    if (!op.is_local() && group != groups.end()) {
        text += fmt::format(", [differences from other {} operators]({})", group->name,
                            dialects_page(*group));
    }
    return text + ".\n";
}

/// The text with one line break at its end.
std::string with_one_end(std::string text) {
    while (text.size() > 1 && text[text.size() - 2] == '\n')
        text.pop_back();
    return text;
}

/// A folder with a manifest of its own, because the folder of documents has other files, too.
class Subfolder {
  public:
    explicit Subfolder(const std::string& path) : path_(path) { require_writable_folder(path); }

    void add(const std::string& name, const std::string& shows, std::string text) {
        files_.push_back({name, std::move(text)});
        manifest_ += fmt::format("{},{}\n", name, shows);
    }
    void write() {
        files_.push_back({kManifest, manifest_});
        write_generated_files(path_, files_, kManifest);
    }

  private:
    static constexpr const char* kManifest = "MANIFEST.csv";
    std::string path_;
    std::string manifest_ = "path,shows\n";
    std::vector<GeneratedFile> files_;
};

}  // namespace

void write_catalogue(const std::string& folder) {
    Subfolder plots(folder + "/curves");
    Subfolder pages(folder + "/operators");
    const auto add_page = [&](const std::string& id, std::string text) {
        pages.add(id + ".md", id, with_one_end(std::move(text)));
    };
    std::vector<DialectGroup> groups = dialect_groups();
    for (const Operator& op : all_operators()) {
        plots.add(op.id + ".svg", op.id, to_svg(plot_of(op)));
        const std::string plot =
            fmt::format("![Curve of {}](../curves/{}.svg)\n\n", op.title, op.id);
        add_page(op.id,
                 render(operator_section(op, plot + measured_line(op), true), command_style()) +
                     links_of(op, groups));
    }
    for (const Operator& op : local_operators())
        add_page(op.id,
                 render(operator_section(op, {}, true), command_style()) + links_of(op, groups));
    if (!groups.empty()) {
        const std::vector<float> samples = non_negative_samples();
        std::string page = dialect_introduction(samples.size() / 3);
        for (DialectGroup& group : groups) {
            const std::string name = "dialects_" + group.slug;
            plots.add(name + ".svg", group.name, to_svg(plot_of(group)));
            plots.add(name + "_colors.svg", group.name, to_svg(colors_of(group)));
            page += dialect_section(group, samples);
        }
        add_page("dialects", page);
    }
    plots.write();
    pages.write();
    write_text_atomically(folder + "/operators.md",
                          with_one_end(kIntroduction + index_section(groups) + legend()));
}

TONEWRIGHT_NAMESPACE_END
