// SPDX-License-Identifier: Apache-2.0
#include <OpenColorIO/OpenColorIO.h>
#include <fmt/format.h>

#include <cmath>
#include <map>
#include <set>
#include <sstream>

#include "engine/error_metric.h"
#include "engine/probe.h"
#include "lut/clf.h"
#include "lut/numbers.h"
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
    /// The same chain with every table replaced by a file of its numbers.
    OCIO::GroupTransformRcPtr externalise(const OCIO::GroupTransformRcPtr& group,
                                          const std::string& stem, const std::string& what,
                                          bool is_exact) {
        OCIO::GroupTransformRcPtr out = OCIO::GroupTransform::Create();
        int count = 0;
        for (int i = 0; i < group->getNumTransforms(); ++i) {
            const OCIO::TransformRcPtr t = group->getTransform(i);
            ClfTable table;
            std::vector<float> values;
            std::string part;
            if (const auto lut = OCIO_DYNAMIC_POINTER_CAST<OCIO::Lut1DTransform>(t)) {
                values = values_of(*lut, table);
                part = "curve";
            } else if (const auto cube = OCIO_DYNAMIC_POINTER_CAST<OCIO::Lut3DTransform>(t)) {
                values = values_of(*cube, table);
                // Half of the fifth decimal is 0.005 codes of 10 bits, a hundredth of what
                // interpolating between the nodes of a sampled operator costs; nine digits would
                // double the file. A lattice has nothing else to be wrong in.
                table.decimals = is_exact ? 8 : 5;
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
            files_.push_back({std::string(kLutFolder) + "/" + it->second,
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
        case Kind::acescct: {
            OCIO::BuiltinTransformRcPtr builtin = OCIO::BuiltinTransform::Create();
            builtin->setStyle("ACEScct_to_ACES2065-1");
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
Pipeline view_stages(const ResolvedOperator& op, const DisplayLimit& limit) {
    Pipeline stages = {MatrixStage{from_reference(op.op->working)}};
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
    for (const Display* display : displays) {
        const ResolvedOperator op =
            make_view(view.op, find_input_space("lin_ap0").id, 0, display->id).op;
        const DisplayLimit limit = display_limit(op, *display);
        const Pipeline stages = view_stages(op, limit);
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
    for (std::size_t d = 0; d < displays.size(); ++d) {
        const Form& form = forms[form_of[d]];
        shown.push_back({forms.size() == 1 ? view.name : form.name, form.stages, displays[d]});
    }
    return shown;
}

struct ViewError {
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

std::string readme(const ConfigModel& model, const std::map<std::string, ViewError>& errors) {
    std::string text =
        "# OpenColorIO config\n\n"
        "Generated by `tonewright config -o ocio_config`; do not edit. Profile 2.1: any "
        "application with\n"
        "OpenColorIO 2.1 or newer reads it.\n\n"
        "```\n"
        "export OCIO=/path/to/ocio_config/config.ocio      # Blender, Nuke, Maya, Houdini, Krita, "
        "...\n"
        "oiiotool --colorconfig /path/to/ocio_config/config.ocio in.exr --ociodisplay sRGB \"AgX "
        "Sobotka\" -o out.png\n"
        "```\n\n"
        "Displays: ";
    for (const Display* d : model.displays)
        text += (d == model.displays.front() ? "" : ", ") + d->title;
    text +=
        ". Every display has every view:\n\n"
        "| view | operator | how | max error | 99.9 % | mean |\n|---|---|---|---|---|---|\n";
    for (const auto& view : model.views) {
        const ViewError& e = errors.at(view.name);
        text += fmt::format("| {} | {} | {} | {} | {} | {} |\n", view.name, view.op.op->title,
                            e.is_exact ? "exact chain" : "65^3 cube", rounded_up(e.in_gamut.max),
                            rounded_up(e.in_gamut.p999), rounded_up(e.in_gamut.mean));
    }
    text += fmt::format(
        "\nErrors: sRGB code values (1 code of 10 bits is 0.00098) of OpenColorIO {}'s CPU path "
        "against the\n"
        "double-precision reference, for Rec.709 light from 0 to 4096 and more. "
        "`python_check/check_config.py`\n"
        "measures the same in the application that you run it in, against `probe.csv`.\n",
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
            const ReferenceEngine engine(build_view(make_view(view.op, space.id, 0, display->id)));
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
                    view.name, display->title, space.title, v[0], v[1], v[2], out[0], out[1],
                    out[2], within[0], within[1], within[2]);
            }
        }
    }
    return text;
}

}  // namespace

std::string config_space_name(std::string_view input_id) {
    return find_input_space(input_id).title;
}

std::vector<GeneratedFile> make_config() {
    const ConfigModel model = make_config_model();
    LutFiles luts;
    OCIO::ConfigRcPtr config = OCIO::Config::Create();
    config->setVersion(2, 1);
    config->setName(model.name.c_str());
    config->setDescription(model.description.c_str());
    config->setSearchPath(kLutFolder);
    config->setStrictParsingEnabled(true);
    config->setEnvironmentMode(OCIO::ENV_ENVIRONMENT_LOAD_PREDEFINED);
    double luma[3] = {kRec709Weights[0], kRec709Weights[1], kRec709Weights[2]};
    config->setDefaultLumaCoefs(luma);

    for (const auto& space : model.spaces)
        config->addColorSpace(make_space(space, luts));
    for (const auto& [role, space] : model.roles)
        config->setRole(role.c_str(), space.c_str());

    // First in the list: what libraries before 2.3.1 take as the default.
    OCIO::ViewTransformRcPtr plain = OCIO::ViewTransform::Create(OCIO::REFERENCE_SPACE_SCENE);
    plain->setName(kUntonemappedView);
    plain->setDescription("Scene light shown as it is, not limited: 1 is display white.");
    plain->setTransform(
        lower_part(luts, {MatrixStage{rgb_to_xyz_d65(kAP0)}}, "", kUntonemappedView),
        OCIO::VIEWTRANSFORM_DIR_FROM_REFERENCE);
    config->addViewTransform(plain);
    config->setDefaultViewTransformName(kUntonemappedView);

    const ProbeSet probes = make_probes(find_input_space("lin_rec709"), {9, 40000});
    std::map<std::string, ViewError> errors;
    const ProbeSet wide_probes = make_probes(find_input_space("lin_ap1"), {9, 40000});
    std::map<std::string, std::vector<DisplayedView>> displayed;
    std::map<std::string, std::map<std::string, double>> largest_error;  // of view, display
    for (const auto& view : model.views) {
        displayed[view.name] = displayed_views(view, model.displays);
        std::map<std::string, double> made;  // transform -> its largest error
        for (const DisplayedView& shown : displayed[view.name]) {
            if (const auto known = made.find(shown.transform); known != made.end()) {
                largest_error[view.name][shown.display->title] = known->second;
                continue;
            }
            const ViewError error =
                measure_view(make_view(view.op, "lin_rec709", 0, shown.display->id), probes);
            made[shown.transform] = error.in_gamut.max;
            largest_error[view.name][shown.display->title] = error.in_gamut.max;
            errors.emplace(view.name, error);
            std::string text = fmt::format(
                "{} Error against the double reference, {} code values, OCIO CPU: max {}, 99.9 % "
                "{}.",
                view.description, shown.display->title, rounded_up(error.in_gamut.max),
                rounded_up(error.in_gamut.p999));
            if (!error.is_exact) {
                const ViewError wide =
                    measure_view(make_view(view.op, "lin_ap1", 0, shown.display->id), wide_probes);
                text += fmt::format(
                    " A 3D table: mean {}, dE ITP at most {}; colors of all of AP1: max {}, 99.9 % "
                    "{}, mean {}.",
                    rounded_up(error.in_gamut.mean), rounded_up(error.delta_e),
                    rounded_up(wide.in_gamut.max), rounded_up(wide.in_gamut.p999),
                    rounded_up(wide.in_gamut.mean));
            }
            OCIO::ViewTransformRcPtr vt = OCIO::ViewTransform::Create(OCIO::REFERENCE_SPACE_SCENE);
            vt->setName(shown.transform.c_str());
            vt->setDescription(text.c_str());
            vt->setTransform(lower_part(luts, shown.stages, view.op.op->id, view.op.op->title,
                                        view.op.op->working),
                             OCIO::VIEWTRANSFORM_DIR_FROM_REFERENCE);
            config->addViewTransform(vt);
        }
    }

    std::string active_displays;
    for (const Display* display : model.displays) {
        active_displays += (active_displays.empty() ? "" : ", ") + display->title;
    }
    std::string active_views;
    const auto add_view = [&](const std::string& name, const std::string& transform,
                              const std::string& space, const std::string& description) {
        config->addSharedView(name.c_str(), transform.c_str(), space.c_str(), "", "",
                              description.c_str());
        active_views += (active_views.empty() ? "" : ", ") + name;
        for (const Display* display : model.displays) {
            config->addDisplaySharedView(display->title.c_str(), name.c_str());
        }
    };
    for (const auto& view : model.views) {
        if (displayed[view.name].front().transform == view.name) {
            add_view(view.name, view.name, OCIO::OCIO_VIEW_USE_DISPLAY_NAME, view.description);
            continue;
        }
        active_views += (active_views.empty() ? "" : ", ") + view.name;
        for (const DisplayedView& shown : displayed[view.name]) {
            config->addDisplayView(
                shown.display->title.c_str(), view.name.c_str(), shown.transform.c_str(),
                (shown.display->title + kDisplaySuffix).c_str(), "", "", view.description.c_str());
        }
    }
    add_view(kUntonemappedView, kUntonemappedView, OCIO::OCIO_VIEW_USE_DISPLAY_NAME,
             "Scene light shown as it is.");
    add_view(kRawView, "", kDataSpace, "The numbers as they are.");
    config->setActiveDisplays(active_displays.c_str());
    config->setActiveViews(active_views.c_str());

    const OCIO::FileRulesRcPtr rules = config->getFileRules()->createEditableCopy();
    std::size_t index = 0;
    for (const auto& [extension, space] : model.file_rules) {
        rules->insertRule(index++, extension.c_str(), space.c_str(), "*", extension.c_str());
    }
    rules->setDefaultRuleColorSpace(model.default_space.c_str());
    config->setFileRules(rules);

    std::ostringstream yaml;
    config->serialize(yaml);

    std::vector<GeneratedFile> files = luts.files();
    std::string manifest = "path,content_hash\n";
    for (const GeneratedFile& f : files)
        manifest += f.path + "," + content_hash(f.contents) + "\n";
    files.push_back({"probe.csv", probe_csv(model, largest_error)});
    files.push_back({"README.md", readme(model, errors)});
    files.push_back({"MANIFEST.csv", manifest});
    files.push_back({"config.ocio", yaml.str()});
    return files;
}

}  // namespace tonewright
