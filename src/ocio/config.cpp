// SPDX-License-Identifier: Apache-2.0
#include <OpenColorIO/OpenColorIO.h>
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <cstring>
#include <map>
#include <set>
#include <sstream>

#include "engine/error_metric.h"
#include "engine/probe.h"
#include "lut/clf.h"
#include "lut/numbers.h"
#include "ocio/inverse.h"
#include "ocio/lower.h"
#include "ocio/model.h"
#include "tonewright/engine.h"
#include "tonewright/ocio.h"

namespace tonewright {
namespace {

constexpr const char* kLutFolder = "luts";

/// Collects the LUT files that transforms need: OCIO configs cannot hold tables themselves.
class LutFiles {
  public:
    /// @param folder  that they are in, beside the config
    explicit LutFiles(std::string folder) : folder_(std::move(folder)) {}

    /// The same chain with every table replaced by a file of its numbers.
    OCIO::GroupTransformRcPtr externalise(const OCIO::GroupTransformRcPtr& group,
                                          const std::string& stem, const std::string& what,
                                          bool is_exact) {
        OCIO::GroupTransformRcPtr out = OCIO::GroupTransform::Create();
        int count = 0;
        for (int i = 0; i < group->getNumTransforms(); ++i) {
            const OCIO::TransformRcPtr t = group->getTransform(i);
            ClfTable table;
            table.numbers = ClfTable::Numbers::compact;
            std::vector<float> values;
            std::string part;
            if (const auto lut = OCIO_DYNAMIC_POINTER_CAST<OCIO::Lut1DTransform>(t)) {
                values = values_of(*lut, table);
                part = "curve";
            } else if (const auto cube = OCIO_DYNAMIC_POINTER_CAST<OCIO::Lut3DTransform>(t)) {
                values = values_of(*cube, table);
                // 8e-6, a thirtieth of what interpolating between the nodes of a sampled operator
                // costs in the mean. A lattice has nothing else to be wrong in: 5e-8.
                table.numbers = is_exact ? ClfTable::Numbers::decimals_7 : ClfTable::Numbers::codes;
                part = "cube";
            } else {
                out->appendTransform(t);
                continue;
            }
            table.values = &values;
            part += count++ ? std::to_string(count) : "";
            OCIO::FileTransformRcPtr file = OCIO::FileTransform::Create();
            file->setSrc(file_for(table, stem + "_" + part, what).c_str());
            file->setInterpolation(table.dimension == 3 ? OCIO::INTERP_TETRAHEDRAL
                                                        : OCIO::INTERP_LINEAR);
            out->appendTransform(file);
        }
        return out;
    }

    [[nodiscard]] const std::vector<GeneratedFile>& files() const { return files_; }

  private:
    /// Equal tables are one file; its name has the hash of its numbers, because OCIO caches by
    /// name.
    std::string file_for(const ClfTable& table, const std::string& stem, const std::string& what) {
        std::string key(reinterpret_cast<const char*>(table.values->data()),
                        table.values->size() * sizeof(float));
        key += std::to_string(table.size) + (table.is_half_domain ? "half" : "") +
               (table.is_hue_preserving ? "hue" : "");
        const auto [it, is_new] =
            names_.emplace(key, stem + "_" + content_hash(key) + file_extension(table));
        if (is_new) {
            const std::string note =
                table.dimension == 1 ? ": one entry for every half float" : ": behind its shaper";
            files_.push_back({folder_ + "/" + it->second,
                              write_clf(table, what, {"Tonewright, " + what + note})});
        }
        return it->second;
    }

    static std::vector<float> values_of(const OCIO::Lut1DTransform& lut, ClfTable& table) {
        const unsigned long n = lut.getLength();
        std::array<std::vector<float>, 3> channel;
        for (unsigned long i = 0; i < n; ++i) {
            float r = 0;
            float g = 0;
            float b = 0;
            lut.getValue(i, r, g, b);
            channel[0].push_back(r);
            channel[1].push_back(g);
            channel[2].push_back(b);
        }
        std::vector<float> values;
        const bool one = channel[0] == channel[1] && channel[1] == channel[2];
        for (unsigned long i = 0; i < n; ++i) {
            for (std::size_t c = 0; c < (one ? 1U : 3U); ++c)
                values.push_back(channel[c][i]);
        }
        table.size = static_cast<int>(n);
        table.channels = one ? 1 : 3;
        table.is_half_domain = lut.getInputHalfDomain();
        table.is_hue_preserving = lut.getHueAdjust() == OCIO::HUE_DW3;
        return values;
    }

    static std::vector<float> values_of(const OCIO::Lut3DTransform& cube, ClfTable& table) {
        const unsigned long n = cube.getGridSize();
        std::vector<float> values;
        values.reserve(3 * n * n * n);
        for (unsigned long r = 0; r < n; ++r) {
            for (unsigned long g = 0; g < n; ++g) {
                for (unsigned long b = 0; b < n; ++b) {
                    std::array<float, 3> v{};
                    cube.getValue(r, g, b, v[0], v[1], v[2]);
                    values.insert(values.end(), v.begin(), v.end());
                }
            }
        }
        table.dimension = 3;
        table.size = static_cast<int>(n);
        table.channels = 3;
        return values;
    }

    std::string folder_;
    std::map<std::string, std::string> names_;
    std::vector<GeneratedFile> files_;
};

OCIO::GroupTransformRcPtr lower_part(LutFiles& luts, const Pipeline& stages,
                                     const std::string& stem, const std::string& what,
                                     const Primaries& primaries = kRec709) {
    const Lowered lowered = lower_to_ocio(stages, {.primaries = primaries});
    return luts.externalise(lowered.transform, stem, what, lowered.is_exact);
}

/// The scene reference is AP0, the display reference XYZ D65.
Matrix3 from_reference(const Primaries& p) { return rgb_to_rgb(kAP0, p); }
Matrix3 to_reference(const Primaries& p) { return rgb_to_rgb(p, kAP0); }

Pipeline joined(Pipeline a, const Pipeline& b) {
    a.insert(a.end(), b.begin(), b.end());
    return a;
}

/// sRGB's straight part goes on below 0; powers do not, and of PQ and HLG only light is shown.
bool has_code_below_black(const Display& display) {
    return !display.is_hdr && ReferenceEngine(display.encode)({-1, -1, -1})[0] != 0;
}

OCIO::ColorSpaceRcPtr make_space(const ConfigModel::Space& space, LutFiles& luts) {
    using Kind = ConfigModel::SpaceKind;
    const bool is_display = space.kind == Kind::display || space.kind == Kind::display_reference;
    OCIO::ColorSpaceRcPtr cs = OCIO::ColorSpace::Create(is_display ? OCIO::REFERENCE_SPACE_DISPLAY
                                                                   : OCIO::REFERENCE_SPACE_SCENE);
    cs->setName(space.name.c_str());
    for (const std::string& alias : space.aliases)
        cs->addAlias(alias.c_str());
    cs->setFamily(space.family.c_str());
    cs->setDescription(space.description.c_str());
    cs->setEncoding(space.encoding.c_str());
    cs->setBitDepth(OCIO::BIT_DEPTH_F32);
    for (const std::string& category : space.categories)
        cs->addCategory(category.c_str());
    cs->setIsData(space.kind == Kind::data);

    const auto set = [&](const Pipeline& to, const Pipeline& from, const std::string& stem) {
        if (!simplify(to).empty()) {
            cs->setTransform(lower_part(luts, to, stem + "_decode", space.name + " to reference"),
                             OCIO::COLORSPACE_DIR_TO_REFERENCE);
        }
        if (!simplify(from).empty()) {
            cs->setTransform(lower_part(luts, from, stem + "_encode", "reference to " + space.name),
                             OCIO::COLORSPACE_DIR_FROM_REFERENCE);
        }
    };
    switch (space.kind) {
        case Kind::scene_linear:
            // One matrix; OCIO inverts it.
            if (!simplify({MatrixStage{to_reference(*space.primaries)}}).empty()) {
                cs->setTransform(
                    lower_part(luts, {MatrixStage{to_reference(*space.primaries)}}, "", space.name),
                    OCIO::COLORSPACE_DIR_TO_REFERENCE);
            }
            break;
        case Kind::builtin: {
            OCIO::BuiltinTransformRcPtr builtin = OCIO::BuiltinTransform::Create();
            builtin->setStyle(space.style.c_str());
            cs->setTransform(builtin, OCIO::COLORSPACE_DIR_TO_REFERENCE);
            break;
        }
        case Kind::texture:
            set(joined(space.display->decode, {MatrixStage{to_reference(*space.primaries)}}),
                joined({MatrixStage{from_reference(*space.primaries)}}, space.display->encode),
                space.display->id);
            break;
        case Kind::display: {
            const Matrix3 to_xyz = rgb_to_xyz_d65(*space.primaries);
            Pipeline from = {MatrixStage{inverse(to_xyz)}};
            // Where the slope at black is infinite, tables are finest where light is limited: twice
            // the display's largest leaves room for what an application does with its result.
            if (!has_code_below_black(*space.display))
                from.push_back(ClampStage{0, 2 * space.display->largest_light});
            set(joined(space.display->decode, {MatrixStage{to_xyz}}),
                joined(from, space.display->encode), space.display->id);
            break;
        }
        case Kind::data:
        case Kind::display_reference:
            break;
    }
    return cs;
}

/// Scene reference -> display reference.
///
/// The matrix to the operator's primaries comes first and its clamp right behind: with an input
/// space of the same primaries OCIO multiplies the two matrices to the identity, and the clamp is
/// the first thing that a pixel meets, NaN and infinities included. A Range before the matrix would
/// keep the matrices apart and cost 1e-6 by float32 cancellation.
Pipeline view_stages(const ResolvedOperator& op, double exposure_stops, const DisplayLimit& limit) {
    Pipeline stages = {
        MatrixStage{scale(from_reference(op.op->working), std::exp2(exposure_stops))}};
    for (const Pipeline& part : {op.build(), display_light_stages(op, limit)})
        stages.insert(stages.end(), part.begin(), part.end());
    stages.push_back(MatrixStage{rgb_to_xyz_d65(limit.primaries)});
    return stages;
}

/// The view transform that a view takes on a display.
struct DisplayedView {
    std::string transform;
    Pipeline stages;
    const Display* display;
    /// What the view is called on the display.
    std::string name;
    ResolvedOperator op;
};

/// One view transform for all displays that it is the same for. "AgX", or where there are several,
/// "AgX (P3-D65)", "AgX (Rec.2020, 1000 nit)".
std::vector<DisplayedView> displayed_views(const ConfigModel::View& view,
                                           const std::vector<const Display*>& displays) {
    struct Form {
        std::string name;
        Pipeline stages;
        std::array<Expr, 3> rgb;
    };
    std::vector<Form> forms;
    std::vector<std::size_t> form_of;
    std::vector<ResolvedOperator> op_of;
    std::vector<const Display*> its_displays;
    for (const Display* display : displays) {
        if (!view.is_on(*display)) continue;
        its_displays.push_back(display);
        const ResolvedOperator op =
            make_view(view.op, find_input_space("lin_ap0").id, 0, display->id).op;
        op_of.push_back(op);
        const DisplayLimit limit = display_limit(op, *display);
        const Pipeline stages = view_stages(op, view.exposure_stops, limit);
        const std::array<Expr, 3> rgb = compose(stages);
        std::size_t i = 0;
        while (i < forms.size() &&
               !(same(forms[i].rgb[0], rgb[0]) && same(forms[i].rgb[1], rgb[1]) &&
                 same(forms[i].rgb[2], rgb[2])))
            ++i;
        if (i == forms.size()) {
            std::string where(limit.primaries.name);
            if (limit.peak > 1) where += fmt::format(", {:g} nit", limit.peak * kReferenceWhite);
            forms.push_back({view.name + " (" + where + ")", stages, rgb});
        }
        form_of.push_back(i);
    }
    std::vector<DisplayedView> shown;
    for (std::size_t d = 0; d < its_displays.size(); ++d) {
        const Form& form = forms[form_of[d]];
        shown.push_back({forms.size() == 1 ? view.name : form.name, form.stages, its_displays[d],
                         config_view_name(view.name, op_of[d], *its_displays[d]), op_of[d]});
    }
    return shown;
}

/// "AgX - HDR 1000 nits" on "Rec.2100-PQ" -> "agx_hdr_1000_nits_rec2100_pq".
std::string output_alias(const std::string& view, const std::string& display) {
    std::string alias = "out_";
    for (std::size_t i = 0; i < view.size(); ++i) {
        const char c = view[i];
        const bool is_sign =
            i + 1 < view.size() && std::isdigit(static_cast<unsigned char>(view[i + 1])) != 0;
        if (is_sign && c == '+') alias += "plus";
        if (is_sign && c == '-') alias += "minus";
        const bool is_word = std::isalnum(static_cast<unsigned char>(c)) != 0;
        if (is_word) alias += static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
        if (!is_word && alias.back() != '_') alias += '_';
    }
    return alias + "_" + display;
}

/// A view as a colour space: write nodes, textures and `--colorconvert` know no views.
OCIO::ColorSpaceRcPtr make_output_space(const DisplayedView& shown, const std::string& display) {
    OCIO::ColorSpaceRcPtr cs = OCIO::ColorSpace::Create(OCIO::REFERENCE_SPACE_SCENE);
    cs->setName(("Output - " + shown.name + " - " + display).c_str());
    if (display == shown.display->title)
        cs->addAlias(output_alias(shown.name, shown.display->id).c_str());
    cs->setFamily(("Output/" + display).c_str());
    cs->setDescription(
        ("The picture of the view " + shown.name + " on " + display + ", in its code values.")
            .c_str());
    cs->setEncoding(shown.display->is_hdr ? "hdr-video" : "sdr-video");
    cs->setBitDepth(OCIO::BIT_DEPTH_F32);
    cs->addCategory("file-io");
    OCIO::DisplayViewTransformRcPtr view = OCIO::DisplayViewTransform::Create();
    view->setSrc(find_input_space("lin_ap0").title.c_str());
    view->setDisplay(display.c_str());
    view->setView(shown.name.c_str());
    cs->setTransform(view, OCIO::COLORSPACE_DIR_FROM_REFERENCE);
    return cs;
}

/// The space that is linear in these primaries.
const InputSpace& space_of(const Primaries& primaries) {
    for (const InputSpace& space : all_input_spaces()) {
        if (space.primaries == primaries) return space;
    }
    throw Error("config: no space has the primaries " + std::string(primaries.name));
}

void append(OCIO::GroupTransformRcPtr& group, const Pipeline& stages) {
    const Lowered lowered = lower_to_ocio(stages);  // nothing, of identities
    for (int i = 0; i < lowered.transform->getNumTransforms(); ++i)
        group->appendTransform(lowered.transform->getTransform(i));
}

/// Display reference -> scene reference, of what the view transform makes; null where OpenColorIO's
/// own inversion of the view transform is as good: its tables and cubes, on the CPU.
OCIO::GroupTransformRcPtr way_back(const ConfigModel::View& view, const DisplayedView& shown) {
    const DisplayLimit limit = display_limit(shown.op, *shown.display);
    const OCIO::GroupTransformRcPtr inverted = invert_light(shown.op, limit);
    if (!inverted) return nullptr;
    OCIO::GroupTransformRcPtr group = OCIO::GroupTransform::Create();
    append(group, {MatrixStage{inverse(rgb_to_xyz_d65(limit.primaries))}});
    for (int i = 0; i < inverted->getNumTransforms(); ++i)
        group->appendTransform(inverted->getTransform(i));
    append(
        group,
        {MatrixStage{scale(to_reference(shown.op.op->working), std::exp2(-view.exposure_stops))}});
    return group;
}

/// How far code values of the view's own pictures are from themselves after the way back and the
/// view once more, by the reference.
ErrorStats measure_round_trip(const View& view, const OCIO::GroupTransformRcPtr& back,
                              OCIO::OptimizationFlags flags, const ProbeSet& probes) {
    const Display& display = find_display(view.display);
    const ReferenceEngine engine(build_view(view));
    OCIO::GroupTransformRcPtr whole = OCIO::GroupTransform::Create();
    append(whole, joined(display.decode, {MatrixStage{rgb_to_xyz_d65(display.primaries)}}));
    whole->appendTransform(back);
    append(whole, {MatrixStage{rgb_to_rgb(kAP0, find_input_space(view.input).primaries)}});
    std::vector<float> in;
    for (std::size_t i = 0; i < probes.size(); ++i) {
        if (!probes.is_non_negative(i) || probes.kind[i] == ProbeKind::special) continue;
        in.insert(in.end(), &probes.rgb[3 * i], &probes.rgb[3 * i] + 3);
    }
    const std::size_t count = in.size() / 3;
    std::vector<double> codes(in.size());
    engine.run_rgb(in.data(), codes.data(), count);
    const std::vector<float> given(codes.begin(), codes.end());
    std::vector<float> scene(in.size());
    Lowered lowered;
    lowered.transform = whole;
    OcioCpu(make_processor(lowered), flags).run_rgb(given.data(), scene.data(), count);
    std::vector<double> again(in.size());
    engine.run_rgb(scene.data(), again.data(), count);
    std::vector<double> errors;
    for (std::size_t i = 0; i < count; ++i) {
        double error = 0;
        for (std::size_t c = 0; c < 3; ++c)
            error = std::max(error, std::fabs(again[3 * i + c] - codes[3 * i + c]));
        errors.push_back(error);
    }
    return summarise(errors);
}

/// Beyond this, what comes back is another picture.
bool is_way_back(const ErrorStats& lossless) { return lossless.mean <= 5e-3; }

struct ViewError {
    /// Of the way back without loss, and as applications have it: with OpenColorIO's default
    /// optimisation, which inverts a cube by a table of 48^3, as its shaders always do.
    ErrorStats round_trip_lossless;
    ErrorStats round_trip;
    bool has_way_back = false;
    ErrorStats in_gamut;
    double delta_e = 0;
    bool is_exact = true;
};

/// OCIO's CPU path of the view against the reference, for colors of the input space >= 0.
ViewError measure_view(const View& view, const ProbeSet& probes) {
    const Pipeline stages = build_view(view);
    const Lowered lowered = lower_to_ocio(stages, {.primaries = view.op.op->working});
    std::vector<double> truth(probes.rgb.size());
    ReferenceEngine(stages).run_rgb(probes.rgb.data(), truth.data(), probes.size());
    std::vector<float> shown(probes.rgb.size());
    OcioCpu(make_processor(lowered)).run_rgb(probes.rgb.data(), shown.data(), probes.size());
    std::vector<double> errors;
    std::vector<double> a;
    std::vector<double> b;
    for (std::size_t i = 0; i < probes.size(); ++i) {
        if (!probes.is_non_negative(i) || probes.kind[i] == ProbeKind::special) continue;
        errors.push_back(channel_error(&truth[3 * i], &shown[3 * i]));
        for (std::size_t c = 0; c < 3; ++c) {
            a.push_back(truth[3 * i + c]);
            b.push_back(static_cast<double>(shown[3 * i + c]));
        }
    }
    ViewError result;
    result.is_exact = lowered.is_exact;
    result.in_gamut = summarise(errors);
    result.delta_e = summarise(delta_e_itp(find_display(view.display), a, b)).max;
    return result;
}

/// As one argument of a shell.
std::string quoted(const std::string& name) {
    return name.find(' ') == std::string::npos ? name : '"' + name + '"';
}

std::string readme(const ConfigModel& model, const std::string& profile,
                   const std::map<std::string, ViewError>& errors) {
    std::string text = fmt::format(
        "# OpenColorIO config\n\n"
        "Generated by `tonewright config`; do not edit. Profile {0}: any application with\n"
        "OpenColorIO {0} or newer reads it.\n\n"
        "```\n"
        "export OCIO=/path/to/ocio_config/config.ocio      # Blender, Nuke, Maya, Houdini, Krita, "
        "...\n"
        "oiiotool --colorconfig /path/to/ocio_config/config.ocio in.exr --ociodisplay sRGB {1} "
        "-o out.png\n"
        "```\n\n",
        profile, quoted(model.views.front().name));
    text += "Displays: ";
    for (const Display* d : model.displays)
        text += (d == model.displays.front() ? "" : ", ") + d->title;
    text +=
        ".\n\n| view | operator | how | max error | 99.9 % | mean | and back, 99.9 %: "
        "without loss | by default |\n"
        "|---|---|---|---|---|---|---|---|\n";
    for (const auto& view : model.views) {
        const ViewError& e = errors.at(view.name);
        text +=
            fmt::format("| {} | {} | {} | {} | {} | {} | {} | {} |\n", view.name, view.op.op->title,
                        e.is_exact ? "exact chain" : "65^3 cube", rounded_up(e.in_gamut.max),
                        rounded_up(e.in_gamut.p999), rounded_up(e.in_gamut.mean),
                        e.has_way_back ? rounded_up(e.round_trip_lossless.p999) : "none",
                        e.has_way_back ? rounded_up(e.round_trip.p999) : "none");
    }
    text += fmt::format(
        "\nErrors: sRGB code values (1 code of 10 bits is 0.00098) of OpenColorIO {}'s CPU path "
        "against the\n"
        "double-precision reference, for Rec.709 light from 0 to 4096 and more. "
        "`python_check/check_config.py`\n"
        "measures the same in the application that you run it in, against `probe.csv`. And back: "
        "how far code\n"
        "values are from themselves after `Output - VIEW - sRGB` to the scene and the view again. "
        "By default\n"
        "OpenColorIO inverts a cube by a coarse table (48^3; always on the GPU), without loss "
        "exactly.\n",
        OCIO::GetVersion());
    return text;
}

/// How far code values may be from the reference where light may be `bound`/12.92 away from it,
/// which is sRGB's slope at black, or the code value `bound`: powers are infinitely steep there.
Vector3 code_tolerance(const Display& display, const Vector3& code, double bound) {
    constexpr double kSrgbSlopeAtBlack = 12.92;
    const ReferenceEngine decode(display.decode);
    const ReferenceEngine encode(display.encode);
    const Vector3 light = decode(code);
    Vector3 tolerance = {bound, bound, bound};
    for (std::size_t c = 0; c < 3; ++c) {
        for (const double step : {bound / kSrgbSlopeAtBlack, -bound / kSrgbSlopeAtBlack}) {
            Vector3 moved = light;
            moved[c] = std::max(0.0, moved[c] + step);
            tolerance[c] = std::max(tolerance[c], std::fabs(encode(moved)[c] - code[c]));
        }
    }
    return tolerance;
}

/// Expected code values and how near they are to be met, for check_config.py: a program that has
/// only PyOpenColorIO.
/// @param errors  of each view on each display, largest code value
std::string probe_csv(const ConfigModel& model,
                      const std::map<std::string, std::map<std::string, double>>& errors) {
    // Debian's OpenColorIO 2.1 is within 3e-7 of exact chains; other versions and processors round
    // in another order and get the rest. What was measured of the others is of random colors: there
    // is more between them.
    constexpr double exact = 1e-6;
    constexpr double between_probes = 3;
    const InputSpace& space = find_input_space("lin_rec709");
    std::vector<Vector3> colors;
    for (int stops = -12; stops <= 12; stops += 2) {
        const double v = 0.18 * std::exp2(stops);
        colors.push_back({v, v, v});
    }
    ProbeRandom random(5);
    for (int i = 0; i < 24; ++i) {
        Vector3 v{};
        for (double& x : v)
            x = std::exp2(random.uniform(-10, 8));
        colors.push_back(v);
    }
    const double light[] = {0.05, 0.8, 20};
    for (const double x : light) {
        for (int bits = 1; bits < 7; ++bits) {
            colors.push_back({bits & 1 ? x : 0, bits & 2 ? x : 0, bits & 4 ? x : 0});
        }
    }
    colors.push_back({0, 0, 0});
    colors.push_back({-0.1, 0.2, 0.5});
    colors.push_back({0.3, -0.05, 2});
    for (Vector3& v : colors) {
        for (double& x : v)
            x = static_cast<double>(static_cast<float>(x));
    }
    std::string text =
        "view,display,space,in_r,in_g,in_b,out_r,out_g,out_b,within_r,within_g,within_b\n";
    for (const auto& view : model.views) {
        for (const Display* display : model.displays) {
            if (!view.is_on(*display)) continue;
            const View shown = make_view(view.op, space.id, view.exposure_stops, display->id);
            const std::string name = config_view_name(view.name, shown.op, *display);
            const ReferenceEngine engine(build_view(shown));
            for (const Vector3& v : colors) {
                const Vector3 out = engine(v);
                double bound =
                    std::max(exact, between_probes * errors.at(view.name).at(display->title));
                // With a negative channel, matrices subtract numbers of the size of the brightest
                // channel, in float32.
                if (std::min({v[0], v[1], v[2]}) < 0)
                    bound *= std::max({1.0, std::fabs(v[0]), std::fabs(v[1]), std::fabs(v[2])});
                const Vector3 within = code_tolerance(*display, out, bound);
                text += fmt::format(
                    "{},{},{},{:.9g},{:.9g},{:.9g},{:.9g},{:.9g},{:.9g},{:.2g},{:.2g},{:.2g}\n",
                    name, display->title, space.title, v[0], v[1], v[2], out[0], out[1], out[2],
                    within[0], within[1], within[2]);
            }
        }
    }
    return text;
}

/// Makes the parts of a config from the model and adds them to an OCIO one: to a new one, or to
/// somebody's.
class ConfigBuilder {
  public:
    ConfigBuilder(const ConfigModel& model, OCIO::ConfigRcPtr config, std::string lut_folder)
        : model_(model), config_(std::move(config)), luts_(std::move(lut_folder)) {}

    /// The config is somebody's, with references of its own.
    /// @param scene, display  what its interchange spaces are of its references
    void set_references(OCIO::ConstColorSpaceRcPtr scene, OCIO::ConstColorSpaceRcPtr display) {
        scene_ = std::move(scene);
        display_ = std::move(display);
    }

    void add_spaces() {
        for (const auto& space : model_.spaces)
            config_->addColorSpace(make_space(space, luts_));
        for (const auto& [role, space] : model_.roles)
            config_->setRole(role.c_str(), space.c_str());
    }

    void add_untonemapped() {
        OCIO::ViewTransformRcPtr plain = OCIO::ViewTransform::Create(OCIO::REFERENCE_SPACE_SCENE);
        plain->setName(kUntonemappedView);
        plain->setDescription("Scene light shown as it is, not limited: 1 is display white.");
        plain->setTransform(
            lower_part(luts_, {MatrixStage{rgb_to_xyz_d65(kAP0)}}, "", kUntonemappedView),
            OCIO::VIEWTRANSFORM_DIR_FROM_REFERENCE);
        config_->addViewTransform(plain);
        config_->setDefaultViewTransformName(kUntonemappedView);
    }

    void add_view_transforms() {
        for (const auto& view : model_.views) {
            displayed_[view.name] = displayed_views(view, model_.displays);
            std::map<std::string, double> made;  // transform -> its largest error
            for (const DisplayedView& shown : displayed_[view.name]) {
                if (!made.contains(shown.transform))
                    made[shown.transform] = add_view_transform(view, shown, made.empty());
                largest_error_[view.name][shown.display->title] = made[shown.transform];
            }
        }
    }

    void add_looks() {
        for (const auto& look : model_.looks) {
            OCIO::LookRcPtr added = OCIO::Look::Create();
            added->setName(look.name.c_str());
            added->setDescription(look.description.c_str());
            const OCIO::GroupTransformRcPtr transform =
                lower_part(luts_, look.stages, look.op->id + "_look", look.name, look.op->working);
            if (!scene_) {
                added->setProcessSpace(space_of(look.op->working).title.c_str());
                added->setTransform(transform);
            } else {
                OCIO::GroupTransformRcPtr group = OCIO::GroupTransform::Create();
                append(group, {MatrixStage{from_reference(look.op->working)}});
                group->appendTransform(transform);
                append(group, {MatrixStage{to_reference(look.op->working)}});
                added->setProcessSpace(scene_->getName());
                added->setTransform(group);
            }
            config_->addLook(added);
        }
    }

    /// The views of a new config: shared where they are the same on every display.
    void add_views() {
        std::vector<std::string> active;
        const auto activate = [&](const std::string& name) {
            if (std::find(active.begin(), active.end(), name) == active.end())
                active.push_back(name);
        };
        for (const auto& view : model_.views) {
            const std::vector<DisplayedView>& forms = displayed_[view.name];
            for (const DisplayedView& shown : forms)
                activate(shown.name);
            const bool is_shared =
                forms.size() == model_.displays.size() &&
                std::all_of(forms.begin(), forms.end(), [&](const auto& shown) {
                    return shown.transform == view.name && shown.name == view.name;
                });
            if (is_shared) {
                add_shared_view(view.name, view.name, OCIO::OCIO_VIEW_USE_DISPLAY_NAME,
                                view.description);
                continue;
            }
            for (const DisplayedView& shown : forms) {
                config_->addDisplayView(shown.display->title.c_str(), shown.name.c_str(),
                                        shown.transform.c_str(), shown.display->title.c_str(), "",
                                        "", view.description.c_str());
            }
        }
        add_shared_view(kUntonemappedView, kUntonemappedView, OCIO::OCIO_VIEW_USE_DISPLAY_NAME,
                        "Scene light shown as it is, not limited.");
        add_shared_view(kRawView, "", kDataSpace, "The numbers as they are.");
        activate(kUntonemappedView);
        activate(kRawView);
        std::vector<std::string> displays;
        for (const Display* display : model_.displays)
            displays.push_back(display->title);
        config_->setActiveDisplays(fmt::format("{}", fmt::join(displays, ", ")).c_str());
        config_->setActiveViews(fmt::format("{}", fmt::join(active, ", ")).c_str());
    }

    void add_output_spaces() {
        for (const auto& view : model_.views) {
            for (const DisplayedView& shown : displayed_[view.name])
                config_->addColorSpace(make_output_space(shown, shown.display->title));
        }
    }

    /// On somebody's display, which shows what `display` does through its own space.
    void add_views_to(const Display& display, const std::string& host_display,
                      const std::string& host_space) {
        std::string active = config_->getActiveViews();
        for (const auto& view : model_.views) {
            for (const DisplayedView& shown : displayed_[view.name]) {
                if (shown.display != &display) continue;
                config_->addDisplayView(host_display.c_str(), shown.name.c_str(),
                                        shown.transform.c_str(), host_space.c_str(), "", "",
                                        view.description.c_str());
                // An empty list means all.
                const std::string listed = ", " + active + ",";
                if (!active.empty() && listed.find(", " + shown.name + ",") == std::string::npos)
                    active += ", " + shown.name;
                const OCIO::ColorSpaceRcPtr space = make_output_space(shown, host_display);
                OCIO::GroupTransformRcPtr whole = OCIO::GroupTransform::Create();
                append_conversion(whole, *scene_, OCIO::COLORSPACE_DIR_FROM_REFERENCE);
                OCIO::DisplayViewTransformRcPtr through = OCIO::DisplayViewTransform::Create();
                through->setSrc(scene_->getName());
                through->setDisplay(host_display.c_str());
                through->setView(shown.name.c_str());
                whole->appendTransform(through);
                space->setTransform(whole, OCIO::COLORSPACE_DIR_FROM_REFERENCE);
                config_->addColorSpace(space);
            }
        }
        config_->setActiveViews(active.c_str());
    }

    [[nodiscard]] const std::vector<DisplayedView>& displayed(const std::string& view) const {
        return displayed_.at(view);
    }
    [[nodiscard]] double largest_error(const std::string& view, const Display& display) const {
        return largest_error_.at(view).at(display.title);
    }
    [[nodiscard]] const std::vector<GeneratedFile>& tables() const { return luts_.files(); }

    void add_file_rules() {
        const OCIO::FileRulesRcPtr rules = config_->getFileRules()->createEditableCopy();
        std::size_t index = 0;
        for (const auto& rule : model_.file_rules) {
            if (rule.regex.empty()) {
                rules->insertRule(index++, rule.name.c_str(), rule.space.c_str(), "*",
                                  rule.extension.c_str());
            } else {
                rules->insertRule(index++, rule.name.c_str(), rule.space.c_str(),
                                  rule.regex.c_str());
            }
        }
        rules->setDefaultRuleColorSpace(model_.default_space.c_str());
        config_->setFileRules(rules);
    }

    /// The tables, the config, and what describes them.
    [[nodiscard]] std::vector<GeneratedFile> files(const std::string& profile) const {
        std::vector<GeneratedFile> files = luts_.files();
        std::string manifest = "path,content_hash\n";
        for (const GeneratedFile& f : files)
            manifest += f.path + "," + content_hash(f.contents) + "\n";
        files.push_back({"probe.csv", probe_csv(model_, largest_error_)});
        files.push_back({"README.md", readme(model_, profile, errors_)});
        files.push_back({"MANIFEST.csv", manifest});
        files.push_back({"config.ocio", text()});
        return files;
    }

    [[nodiscard]] std::string text() const {
        std::ostringstream yaml;
        config_->serialize(yaml);
        return yaml.str();
    }

  private:
    /// The config's scene reference -> what this is given: ACES2065-1 -> ... -> the config's
    /// display reference, of what puts out CIE XYZ D65.
    [[nodiscard]] OCIO::GroupTransformRcPtr between_references(
        const OCIO::GroupTransformRcPtr& group) const {
        if (!scene_) return group;
        OCIO::GroupTransformRcPtr whole = OCIO::GroupTransform::Create();
        append_conversion(whole, *scene_, OCIO::COLORSPACE_DIR_FROM_REFERENCE);
        for (int i = 0; i < group->getNumTransforms(); ++i)
            whole->appendTransform(group->getTransform(i));
        append_conversion(whole, *display_, OCIO::COLORSPACE_DIR_TO_REFERENCE);
        return whole;
    }
    /// The same the other way.
    [[nodiscard]] OCIO::GroupTransformRcPtr back_between_references(
        const OCIO::GroupTransformRcPtr& group) const {
        if (!scene_) return group;
        OCIO::GroupTransformRcPtr whole = OCIO::GroupTransform::Create();
        append_conversion(whole, *display_, OCIO::COLORSPACE_DIR_FROM_REFERENCE);
        for (int i = 0; i < group->getNumTransforms(); ++i)
            whole->appendTransform(group->getTransform(i));
        append_conversion(whole, *scene_, OCIO::COLORSPACE_DIR_TO_REFERENCE);
        return whole;
    }
    static void append_conversion(OCIO::GroupTransformRcPtr& group, const OCIO::ColorSpace& space,
                                  OCIO::ColorSpaceDirection direction) {
        const auto other = direction == OCIO::COLORSPACE_DIR_FROM_REFERENCE
                               ? OCIO::COLORSPACE_DIR_TO_REFERENCE
                               : OCIO::COLORSPACE_DIR_FROM_REFERENCE;
        if (const auto given = space.getTransform(direction)) {
            group->appendTransform(given->createEditableCopy());
        } else if (const auto inverse = space.getTransform(other)) {
            const OCIO::TransformRcPtr copy = inverse->createEditableCopy();
            copy->setDirection(OCIO::CombineTransformDirections(copy->getDirection(),
                                                                OCIO::TRANSFORM_DIR_INVERSE));
            group->appendTransform(copy);
        }
    }

    void add_shared_view(const std::string& name, const std::string& transform,
                         const std::string& space, const std::string& description) {
        config_->addSharedView(name.c_str(), transform.c_str(), space.c_str(), "", "",
                               description.c_str());
        for (const Display* display : model_.displays)
            config_->addDisplaySharedView(display->title.c_str(), name.c_str());
    }

    /// @return its largest error
    double add_view_transform(const ConfigModel::View& view, const DisplayedView& shown,
                              bool is_first) {
        const View measured =
            make_view(view.op, "lin_rec709", view.exposure_stops, shown.display->id);
        ViewError error = measure_view(measured, probes_);
        const Lowered forward = lower_to_ocio(shown.stages, {.primaries = view.op.op->working});
        const OCIO::GroupTransformRcPtr own_back = way_back(view, shown);
        OCIO::GroupTransformRcPtr back = own_back;
        if (!back) {
            back = OCIO::GroupTransform::Create();
            for (int i = 0; i < forward.transform->getNumTransforms(); ++i)
                back->appendTransform(forward.transform->getTransform(i));
            back->setDirection(OCIO::TRANSFORM_DIR_INVERSE);
        }
        // OpenColorIO takes seconds to invert a cube: once for a view.
        const bool is_diagnostic = view.op.op->is_diagnostic;
        const bool is_measured = !is_diagnostic && (own_back || is_first);
        if (is_measured) {
            error.round_trip_lossless =
                measure_round_trip(measured, back, OCIO::OPTIMIZATION_LOSSLESS, few_probes_);
            error.round_trip =
                measure_round_trip(measured, back, OCIO::OPTIMIZATION_DEFAULT, few_probes_);
            error.has_way_back = is_way_back(error.round_trip_lossless);
        }
        errors_.emplace(view.name, error);
        std::string text = fmt::format(
            "{} Error against the double reference, {} code values, OCIO CPU: max {}, 99.9 % {}.",
            view.description, shown.display->title, rounded_up(error.in_gamut.max),
            rounded_up(error.in_gamut.p999));
        if (!error.is_exact) {
            const ViewError wide =
                measure_view(make_view(view.op, "lin_ap1", view.exposure_stops, shown.display->id),
                             wide_probes_);
            text += fmt::format(
                " A 3D table: mean {}, dE ITP at most {}; colors of all of AP1: max {}, 99.9 % {}, "
                "mean {}.",
                rounded_up(error.in_gamut.mean), rounded_up(error.delta_e),
                rounded_up(wide.in_gamut.max), rounded_up(wide.in_gamut.p999),
                rounded_up(wide.in_gamut.mean));
        }
        if (error.has_way_back) {
            text += fmt::format(" And back: 99.9 % {} without loss, {} by default.",
                                rounded_up(error.round_trip_lossless.p999),
                                rounded_up(error.round_trip.p999));
        } else if (is_measured || is_diagnostic) {
            text += " There is no way back.";
        }
        OCIO::ViewTransformRcPtr vt = OCIO::ViewTransform::Create(OCIO::REFERENCE_SPACE_SCENE);
        vt->setName(shown.transform.c_str());
        vt->setDescription(text.c_str());
        vt->setTransform(between_references(luts_.externalise(forward.transform, view.op.op->id,
                                                              view.op.op->title, forward.is_exact)),
                         OCIO::VIEWTRANSFORM_DIR_FROM_REFERENCE);
        if (own_back) {
            vt->setTransform(
                back_between_references(luts_.externalise(own_back, view.op.op->id + "_inverse",
                                                          view.op.op->title + ", inverse", true)),
                OCIO::VIEWTRANSFORM_DIR_TO_REFERENCE);
        }
        config_->addViewTransform(vt);
        return error.in_gamut.max;
    }

    const ConfigModel& model_;
    OCIO::ConfigRcPtr config_;
    OCIO::ConstColorSpaceRcPtr scene_, display_;  // null: ours
    LutFiles luts_;
    std::map<std::string, std::vector<DisplayedView>> displayed_;
    std::map<std::string, std::map<std::string, double>> largest_error_;  // of view, display
    std::map<std::string, ViewError> errors_;                             // of a view's first form
    ProbeSet probes_ = make_probes(find_input_space("lin_rec709"), {9, 40000});
    ProbeSet wide_probes_ = make_probes(find_input_space("lin_ap1"), {9, 40000});
    ProbeSet few_probes_ = make_probes(find_input_space("lin_rec709"), {3, 1000});
};

}  // namespace

std::string config_space_name(std::string_view input_id) {
    return find_input_space(input_id).title;
}

void check_config_options(const ConfigOptions& options) {
    if (options.profile != "2.0" && options.profile != "2.1")
        throw Error("config: profile is " + options.profile + "; expected 2.0 or 2.1");
    (void)make_config_model(options);
}

std::vector<GeneratedFile> make_config(const ConfigOptions& options) {
    check_config_options(options);
    const ConfigModel model = make_config_model(options);
    OCIO::ConfigRcPtr config = OCIO::Config::Create();
    config->setVersion(2, options.profile == "2.0" ? 0 : 1);
    config->setName(model.name.c_str());
    config->setDescription(model.description.c_str());
    config->setSearchPath(kLutFolder);
    config->setStrictParsingEnabled(true);
    config->setEnvironmentMode(OCIO::ENV_ENVIRONMENT_LOAD_PREDEFINED);
    double luma[3] = {kRec709Weights[0], kRec709Weights[1], kRec709Weights[2]};
    config->setDefaultLumaCoefs(luma);

    ConfigBuilder builder(model, config, kLutFolder);
    builder.add_spaces();
    // First in the list: what libraries before 2.3.1 take as the default.
    builder.add_untonemapped();
    builder.add_view_transforms();
    builder.add_looks();
    builder.add_views();
    builder.add_output_spaces();
    builder.add_file_rules();
    return builder.files(options.profile);
}

namespace {

/// A display of somebody's config that shows what one of ours does.
struct HostDisplay {
    std::string name;
    std::string space;
    const Display* ours;
    double difference;  // of code values
};

std::vector<float> run_processor(const OCIO::ConstProcessorRcPtr& processor,
                                 std::vector<float> rgb) {
    OcioCpu(processor, OCIO::OPTIMIZATION_LOSSLESS).run_rgb(rgb.data(), rgb.data(), rgb.size() / 3);
    return rgb;
}

/// How far the host's display space is from ours, for light that both can show.
double display_difference(const OCIO::ConstConfigRcPtr& config, const std::string& space,
                          const Display& ours) {
    const std::vector<Vector3> light = {{1, 1, 1},          {0.18, 0.18, 0.18}, {0.9, 0.1, 0.02},
                                        {0.05, 0.8, 0.1},   {0.1, 0.02, 0.7},   {0.5, 0.5, 0.01},
                                        {0.002, 0.01, 0.05}};
    const ReferenceEngine encode(ours.encode);
    std::vector<float> xyz;
    std::vector<double> codes;
    for (const Vector3& rgb : light) {
        for (const double x : multiply(rgb_to_xyz_d65(ours.primaries), rgb))
            xyz.push_back(static_cast<float>(x));
        for (const double x : encode(rgb))
            codes.push_back(x);
    }
    const std::vector<float> shown =
        run_processor(config->getProcessor("cie_xyz_d65_interchange", space.c_str()), xyz);
    double largest = 0;
    for (std::size_t i = 0; i < shown.size(); ++i)
        largest = std::max(largest, std::fabs(static_cast<double>(shown[i]) - codes[i]));
    return largest;
}

std::vector<HostDisplay> match_displays(const OCIO::ConstConfigRcPtr& config,
                                        const std::vector<std::string>& wanted) {
    std::vector<HostDisplay> matched;
    std::vector<std::string> names;
    for (int d = 0; d < config->getNumDisplays(); ++d) {
        const std::string name = config->getDisplay(d);
        names.push_back(name);
        if (!wanted.empty() && std::find(wanted.begin(), wanted.end(), name) == wanted.end())
            continue;
        for (int v = 0; v < config->getNumViews(name.c_str()); ++v) {
            const char* view = config->getView(name.c_str(), v);
            const char* transform = config->getDisplayViewTransformName(name.c_str(), view);
            if (!transform || !*transform) continue;
            std::string space = config->getDisplayViewColorSpaceName(name.c_str(), view);
            if (space == OCIO::OCIO_VIEW_USE_DISPLAY_NAME) space = name;
            const Display* nearest = nullptr;
            double least = 1;
            for (const Display& ours : all_displays()) {
                const double difference = display_difference(config, space, ours);
                if (difference >= least) continue;
                least = difference;
                nearest = &ours;
            }
            // OpenColorIO's own displays are up to 1e-4 from the standards.
            if (nearest && least < 1e-3) matched.push_back({name, space, nearest, least});
            break;
        }
    }
    for (const std::string& name : wanted) {
        if (std::find(names.begin(), names.end(), name) == names.end()) {
            throw Error("config: display is " + name + "; expected " + join_choices(names) +
                        did_you_mean(name, names));
        }
    }
    return matched;
}

/// Every space there and back, every view of every display: what a config makes of some colors.
std::map<std::string, std::vector<float>> pictures_of(const OCIO::ConstConfigRcPtr& config) {
    const std::vector<float> colors = {0.18F, 0.18F,  0.18F, 1,    1,    1,     0.8F, 0.1F, 0.02F,
                                       0.1F,  0.7F,   0.1F,  0.1F, 0.1F, 0.9F,  4,    2,    9,
                                       0,     0.002F, 0.01F, 0,    0,    -0.1F, 0.5F, 0.3F, 0.2F};
    std::map<std::string, std::vector<float>> pictures;
    const auto add = [&](const std::string& name, const auto& make_processor_of) {
        try {
            pictures[name] = run_processor(make_processor_of(), colors);
        } catch (const OCIO::Exception&) {
            pictures[name] = {};  // it did not work before either
        }
    };
    const int count =
        config->getNumColorSpaces(OCIO::SEARCH_REFERENCE_SPACE_ALL, OCIO::COLORSPACE_ALL);
    for (int i = 0; i < count; ++i) {
        const std::string name = config->getColorSpaceNameByIndex(OCIO::SEARCH_REFERENCE_SPACE_ALL,
                                                                  OCIO::COLORSPACE_ALL, i);
        add("space " + name,
            [&] { return config->getProcessor(name.c_str(), "aces_interchange"); });
        add("to space " + name,
            [&] { return config->getProcessor("aces_interchange", name.c_str()); });
    }
    for (int d = 0; d < config->getNumDisplays(); ++d) {
        const std::string display = config->getDisplay(d);
        for (int v = 0; v < config->getNumViews(display.c_str()); ++v) {
            const std::string view = config->getView(display.c_str(), v);
            add("view " + display + " / " + view, [&] {
                return config->getProcessor("aces_interchange", display.c_str(), view.c_str(),
                                            OCIO::TRANSFORM_DIR_FORWARD);
            });
        }
    }
    return pictures;
}

OCIO::ConfigRcPtr read_host(const std::string& path) {
    try {
        const OCIO::ConfigRcPtr config =
            OCIO::Config::CreateFromFile(path.c_str())->createEditableCopy();
        config->setProcessorCacheFlags(OCIO::PROCESSOR_CACHE_OFF);
        return config;
    } catch (const OCIO::Exception& e) {
        throw FileError("read: " + path + ": " + e.what());
    }
}

}  // namespace

ExtendedConfig extend_config(const std::string& path, const ConfigOptions& options) {
    const OCIO::ConfigRcPtr config = read_host(path);
    for (const char* role : {"aces_interchange", "cie_xyz_d65_interchange"}) {
        if (!config->hasRole(role)) {
            throw Error(
                "config: " + path + " has no role " + role +
                "; expected both interchange roles: nothing else says what its numbers are");
        }
    }
    const std::map<std::string, std::vector<float>> before = pictures_of(config);
    const std::vector<HostDisplay> hosts = match_displays(config, options.displays);
    if (hosts.empty()) {
        throw Error(
            "config: no display of " + path +
            " is one of ours, shown through a view transform; expected one of sRGB, Display "
            "P3, Rec.1886, Rec.2020, 2.2, PQ or HLG");
    }
    ConfigOptions chosen = options;
    chosen.displays.clear();
    for (const HostDisplay& host : hosts)
        chosen.displays.push_back(host.ours->id);
    const ConfigModel model = make_config_model(chosen);

    // Nothing of theirs is replaced.
    const auto refuse = [&](const std::string& what, const std::string& name) {
        throw Error("config: " + path + " has " + what + " " + name +
                    " already; expected another name (--operator ID --name NAME)");
    };
    for (const auto& look : model.looks) {
        if (config->getLook(look.name.c_str())) refuse("a look", look.name);
    }
    for (const auto& view : model.views) {
        for (const DisplayedView& shown : displayed_views(view, model.displays)) {
            if (config->getViewTransform(shown.transform.c_str()))
                refuse("a view transform", shown.transform);
            for (const HostDisplay& host : hosts) {
                if (host.ours != shown.display) continue;
                for (int v = 0; v < config->getNumViews(host.name.c_str()); ++v) {
                    if (shown.name == config->getView(host.name.c_str(), v))
                        refuse("on the display " + host.name + " a view", shown.name);
                }
                const std::string space = "Output - " + shown.name + " - " + host.name;
                if (config->getColorSpace(space.c_str())) refuse("a space", space);
            }
        }
    }

    constexpr const char* kFolder = "tonewright";
    ConfigBuilder builder(model, config, kFolder);
    builder.set_references(config->getColorSpace("aces_interchange"),
                           config->getColorSpace("cie_xyz_d65_interchange"));
    config->addSearchPath(kFolder);
    builder.add_view_transforms();
    builder.add_looks();
    for (const HostDisplay& host : hosts)
        builder.add_views_to(*host.ours, host.name, host.space);

    ExtendedConfig result;
    result.files = builder.tables();
    result.text = builder.text();
    result.check = [before, hosts, model, path, bounds = [&] {
        std::map<std::string, double> all;
        for (const auto& view : model.views) {
            for (const DisplayedView& shown : builder.displayed(view.name))
                all[view.name + shown.display->id] =
                    builder.largest_error(view.name, *shown.display);
        }
        return all;
    }()](const std::string& written) {
        const OCIO::ConfigRcPtr made = read_host(written);
        try {
            made->validate();
        } catch (const OCIO::Exception& e) {
            throw Error("config: OpenColorIO refuses the result: " + std::string(e.what()));
        }
        const std::map<std::string, std::vector<float>> after = pictures_of(made);
        for (const auto& [name, picture] : before) {
            const auto it = after.find(name);
            const bool is_same =
                it != after.end() && it->second.size() == picture.size() &&
                std::memcmp(it->second.data(), picture.data(), picture.size() * sizeof(float)) == 0;
            if (!is_same) throw Error("config: the result changes " + name + " of " + path);
        }
        std::vector<ExtendedView> views;
        const ProbeSet probes = make_probes(find_input_space("lin_ap0"), {5, 4000});
        for (const auto& view : model.views) {
            for (const HostDisplay& host : hosts) {
                if (!view.is_on(*host.ours)) continue;
                const View shown =
                    make_view(view.op, "lin_ap0", view.exposure_stops, host.ours->id);
                const std::string name = config_view_name(view.name, shown.op, *host.ours);
                std::vector<float> in;
                for (std::size_t i = 0; i < probes.size(); ++i) {
                    if (probes.is_non_negative(i) && probes.kind[i] != ProbeKind::special)
                        in.insert(in.end(), &probes.rgb[3 * i], &probes.rgb[3 * i] + 3);
                }
                std::vector<double> truth(in.size());
                ReferenceEngine(build_view(shown)).run_rgb(in.data(), truth.data(), in.size() / 3);
                const std::vector<float> codes =
                    run_processor(made->getProcessor("aces_interchange", host.name.c_str(),
                                                     name.c_str(), OCIO::TRANSFORM_DIR_FORWARD),
                                  in);
                std::vector<double> errors;
                for (std::size_t i = 0; i < codes.size() / 3; ++i)
                    errors.push_back(channel_error(&truth[3 * i], &codes[3 * i]));
                const ErrorStats stats = summarise(errors);
                views.push_back({host.name, name, stats.max, stats.p999});
                // In all of AP0 cubes and cancelling matrices cost more than where they were
                // measured: what is refused is another picture, not one that is less exact.
                constexpr double kAnother = 0.02;
                if (stats.mean > kAnother + bounds.at(view.name + host.ours->id)) {
                    throw Error(fmt::format(
                        "config: view {} on {} would be {:.2g} from the reference in the mean",
                        name, host.name, stats.mean));
                }
            }
        }
        return views;
    };
    return result;
}

}  // namespace tonewright
