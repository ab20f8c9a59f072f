// SPDX-License-Identifier: Apache-2.0
#include "ocio/config_builder.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <optional>
#include <sstream>
#include <utility>

#include "base/format_number.h"
#include "base/strings.h"
#include "lut/in_parallel.h"
#include "ocio/inverse.h"
#include "ocio/operator_facts.h"
#include "ocio/profile_2_5.h"
#include "ocio/read_config.h"
#include "ocio/round_trip.h"
#include "tonewright/engine.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

OCIO::GroupTransformRcPtr lower_part(LutFiles& luts, const Pipeline& stages, const LutStem& stem,
                                     const std::string& title,
                                     const Primaries& primaries = kRec709) {
    const Lowered lowered = lower_to_ocio(stages, {.primaries = primaries});
    return luts.to_ocio(lowered.ops, stem, title,
                        {.is_exact = lowered.is_exact, .makes_codes = stem.purpose == "encode"});
}

/// The references of configs of Tonewright are AP0 (scene) and XYZ D65 (display).
Matrix3 from_reference(const Primaries& p) { return rgb_to_rgb(kAP0, p); }
Matrix3 to_reference(const Primaries& p) { return rgb_to_rgb(p, kAP0); }

Pipeline joined(Pipeline a, const Pipeline& b) {
    a.insert(a.end(), b.begin(), b.end());
    return a;
}

/// Rest of a name after its prefix, or the whole name without that prefix.
std::string without(const std::string& name, const std::string& beginning) {
    return name.starts_with(beginning) ? name.substr(beginning.size()) : name;
}

/// sRGB's linear segment continues below 0; powers do not, and PQ and HLG only have values above 0.
bool has_code_below_black(const Display& display) {
    return !display.is_hdr && ReferenceEngine(display.encode)({-1, -1, -1})[0] != 0;
}

OCIO::TransformRcPtr log_to_linear(const LogCurve& curve) {
    const double log_slope[] = {curve.log_slope, curve.log_slope, curve.log_slope};
    const double log_offset[] = {curve.log_offset, curve.log_offset, curve.log_offset};
    const double linear_slope[] = {curve.linear_slope, curve.linear_slope, curve.linear_slope};
    const double linear_offset[] = {curve.linear_offset, curve.linear_offset, curve.linear_offset};
    const auto with_parameters = [&](const auto& log) -> OCIO::TransformRcPtr {
        log->setBase(curve.base);
        log->setLogSideSlopeValue(log_slope);
        log->setLogSideOffsetValue(log_offset);
        log->setLinSideSlopeValue(linear_slope);
        log->setLinSideOffsetValue(linear_offset);
        log->setDirection(OCIO::TRANSFORM_DIR_INVERSE);
        return log;
    };
    if (!curve.linear_break) return with_parameters(OCIO::LogAffineTransform::Create());
    const double at[] = {*curve.linear_break, *curve.linear_break, *curve.linear_break};
    return with_parameters(OCIO::LogCameraTransform::Create(at));
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

    const auto set = [&](const Pipeline& to, const Pipeline& from) {
        const auto stem = [&](const char* purpose) {
            return LutStem{space.display->id, is_display ? "display" : "texture", purpose};
        };
        if (!simplify(to).empty()) {
            cs->setTransform(lower_part(luts, to, stem("decode"), space.name + " to reference"),
                             OCIO::COLORSPACE_DIR_TO_REFERENCE);
        }
        if (!simplify(from).empty()) {
            cs->setTransform(lower_part(luts, from, stem("encode"), "reference to " + space.name),
                             OCIO::COLORSPACE_DIR_FROM_REFERENCE);
        }
    };
    switch (space.kind) {
        case Kind::scene_linear:
            // One matrix; OCIO inverts it.
            if (!simplify({MatrixStage{to_reference(*space.primaries)}}).empty()) {
                cs->setTransform(
                    lower_part(luts, {MatrixStage{to_reference(*space.primaries)}}, {}, space.name),
                    OCIO::COLORSPACE_DIR_TO_REFERENCE);
            }
            break;
        case Kind::builtin: {
            OCIO::BuiltinTransformRcPtr builtin = OCIO::BuiltinTransform::Create();
            builtin->setStyle(space.style.c_str());
            cs->setTransform(builtin, OCIO::COLORSPACE_DIR_TO_REFERENCE);
            break;
        }
        case Kind::log: {
            OCIO::GroupTransformRcPtr group = OCIO::GroupTransform::Create();
            group->appendTransform(log_to_linear(space.curve));
            append(group, lower_to_ocio({MatrixStage{to_reference(*space.primaries)}}).ops);
            cs->setTransform(group, OCIO::COLORSPACE_DIR_TO_REFERENCE);
            break;
        }
        case Kind::texture:
            set(joined(space.display->decode, {MatrixStage{to_reference(*space.primaries)}}),
                joined({MatrixStage{from_reference(*space.primaries)}}, space.display->encode));
            break;
        case Kind::display: {
            const Matrix3 to_xyz = rgb_to_xyz_d65(*space.primaries);
            Pipeline from = {MatrixStage{inverse(to_xyz)}};
            // If the slope at black is infinite, tables are finest with a limited range. Twice the
            // display's maximum leaves room for operations of the application on the result.
            if (!has_code_below_black(*space.display))
                from.push_back(ClampStage{0, 2 * space.display->largest_light});
            set(joined(space.display->decode, {MatrixStage{to_xyz}}),
                joined(from, space.display->encode));
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
/// The matrix to the operator's primaries comes first, directly followed by its clamp: with an
/// input space of the same primaries OCIO multiplies the two matrices to the identity, and the
/// clamp is the first thing that a pixel meets, NaN and infinities included. A Range before the
/// matrix would keep the matrices apart and cost 1e-6 by float32 cancellation.
Pipeline view_stages(const ResolvedOperator& op, double exposure_stops, const DisplayLimit& limit) {
    Pipeline stages = {
        MatrixStage{scale(from_reference(op.op->working), std::exp2(exposure_stops))}};
    for (const Pipeline& part : {op.build(), display_light_stages(op, limit)})
        stages.insert(stages.end(), part.begin(), part.end());
    stages.push_back(MatrixStage{rgb_to_xyz_d65(limit.primaries)});
    return stages;
}

/// "AgX - HDR 1000 nits" on "Rec.2100-PQ" -> "agx_hdr_1000_nits_rec2100_pq".
std::string output_alias(const std::string& view, const std::string& display) {
    std::string alias = "out_";
    const std::string name = lowercase(view);
    for (std::size_t i = 0; i < name.size(); ++i) {
        const char c = name[i];
        const bool is_sign =
            i + 1 < name.size() && std::isdigit(static_cast<unsigned char>(name[i + 1])) != 0;
        if (is_sign && c == '+') alias += "plus";
        if (is_sign && c == '-') alias += "minus";
        const bool is_word = std::isalnum(static_cast<unsigned char>(c)) != 0;
        if (is_word) alias += c;
        if (!is_word && alias.back() != '_') alias += '_';
    }
    return alias + "_" + display;
}

/// A view as a color space, because write nodes, textures and `--colorconvert` do not support
/// views.
/// @param inverse_space  text about the inverse in the description
OCIO::ColorSpaceRcPtr make_output_space(const DisplayedView& shown, const std::string& display,
                                        const std::string& inverse_space) {
    OCIO::ColorSpaceRcPtr cs = OCIO::ColorSpace::Create(OCIO::REFERENCE_SPACE_SCENE);
    cs->setName(output_space_name(shown.name, display).c_str());
    if (display == shown.display->title)
        cs->addAlias(output_alias(shown.name, shown.display->id).c_str());
    cs->setFamily(("Output/" + display).c_str());
    cs->setDescription(
        ("Code values of the view " + shown.name + " on " + display + "." + inverse_space).c_str());
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

/// The linear space with these primaries.
const InputSpace& space_of(const Primaries& primaries) {
    for (const InputSpace& space : all_input_spaces()) {
        if (space.primaries == primaries) return space;
    }
    throw Error(Problem{.value = "no space has the primaries " + std::string(primaries.name)});
}

/// Null for identities.
void append(OCIO::GroupTransformRcPtr& group, const Pipeline& stages) {
    append(group, lower_to_ocio(stages).ops);
}

/// Display reference -> scene reference, for colors of the view transform. Nothing if OpenColorIO's
/// own inversion of the view transform is as accurate on the CPU, including its 1D and 3D LUTs.
std::optional<LoweredOps> inverse_space(const ConfigModel::View& view, const DisplayedView& shown,
                                        const std::string& cache_folder) {
    const DisplayLimit limit = display_limit(shown.op, *shown.display);
    std::optional<LoweredOps> inverted = invert_light(shown.op, limit, cache_folder);
    if (!inverted) return std::nullopt;
    LoweredOps ops = lower_to_ocio({MatrixStage{inverse(rgb_to_xyz_d65(limit.primaries))}}).ops;
    append(ops, std::move(*inverted));
    append(ops, lower_to_ocio({MatrixStage{scale(to_reference(shown.op.op->working),
                                                 std::exp2(-view.exposure_stops))}})
                    .ops);
    return ops;
}

/// @param back  display reference -> scene reference
RoundTripError measure_round_trip(const View& view, const LoweredOps& back, const RoundTrip& trip) {
    const Display& display = find_display(view.display);
    LoweredOps ops =
        lower_to_ocio(joined(display.decode, {MatrixStage{rgb_to_xyz_d65(display.primaries)}})).ops;
    append(ops, back);
    append(
        ops,
        lower_to_ocio({MatrixStage{rgb_to_rgb(kAP0, find_input_space(view.input).primaries)}}).ops);
    const OCIO::ConstProcessorRcPtr processor = make_processor(ops);
    const auto errors = [&](OCIO::OptimizationFlags flags) {
        const OcioCpu cpu(processor, flags);
        return trip
            .measure([&](const float* in, float* out, std::size_t n) { cpu.run_rgb(in, out, n); })
            .errors;
    };
    return {errors(OCIO::OPTIMIZATION_LOSSLESS), errors(OCIO::OPTIMIZATION_DEFAULT), true};
}

/// Larger round trip errors give another picture.
bool is_inverse_space(const ErrorStats& lossless) {
    return lossless.mean <= 5e-3 && lossless.p999 <= 3.5e-2;
}

/// Description of a view on a display, for HDR with its limits.
std::string describe(const ConfigModel::View& view, const DisplayedView& shown) {
    const DisplayLimit limit = display_limit(shown.op, *shown.display);
    if (!shown.display->is_hdr || limit.peak <= 1)
        return view.description + blender_difference(shown.op);
    const double peak = std::min(limit.peak * kUnitLuminance, shown.display->peak);
    return fmt::format("{} Up to {:g} cd/m2, limited to {}.{}", view.description, peak,
                       limit.primaries.name, blender_difference(shown.op));
}

/// Text about the inverse and its round trip error.
std::string describe_inverse(const RoundTripError& back, bool is_diagnostic) {
    if (is_diagnostic) return " No inverse: the view shows many scene colors as one.";
    if (!back.is_measured) return "";
    if (!back.exists) return " No inverse.";
    const auto figures = [](const ErrorStats& stats) {
        return fmt::format("max {}, 99.9 % {}, mean {}", rounded_up(stats.max),
                           rounded_up(stats.p999), rounded_up(stats.mean));
    };
    std::string text =
        " Round trip of the view's code values of Rec.709 colors: " + figures(back.by_default);
    if (back.lossless.p999 < back.by_default.p999 / 2)
        text += " (lossless: " + figures(back.lossless) + ")";
    return text + ".";
}

std::string yaml_of(const OCIO::Config& config) {
    std::ostringstream yaml;
    config.serialize(yaml);
    return yaml.str();
}

/// Code values of the reference.
std::vector<double> true_codes(const Pipeline& stages, const SampleSet& samples) {
    std::vector<double> codes(samples.rgb.size());
    ReferenceEngine(stages).run_rgb(samples.rgb.data(), codes.data(), samples.size());
    return codes;
}

/// Measures OCIO's CPU path of the view against the reference.
/// @param truth  true_codes() of the samples
ViewError measure_view(const View& view, const Lowered& lowered, const SampleSet& samples,
                       const std::vector<double>& truth) {
    std::vector<float> shown(samples.rgb.size());
    OcioCpu(make_processor(lowered.ops)).run_rgb(samples.rgb.data(), shown.data(), samples.size());
    std::vector<double> errors;
    for (std::size_t i = 0; i < samples.size(); ++i)
        errors.push_back(channel_error(&truth[3 * i], &shown[3 * i]));
    ViewError result;
    result.is_exact = lowered.is_exact;
    result.in_gamut = summarise(errors);
    if (!result.is_exact) {
        const std::vector<double> codes(shown.begin(), shown.end());
        result.delta_e = summarise(delta_e_itp(find_display(view.display), truth, codes)).max;
    }
    return result;
}

/// Samples without negative channels.
SampleSet measured_samples(const InputSpace& space, const SampleSetOptions& options) {
    const SampleSet all = make_sample_set(space, options);
    SampleSet kept;
    for (std::size_t i = 0; i < all.size(); ++i) {
        if (!all.is_non_negative(i) || all.kind[i] == SampleKind::special) continue;
        kept.rgb.insert(kept.rgb.end(), &all.rgb[3 * i], &all.rgb[3 * i] + 3);
        kept.kind.push_back(all.kind[i]);
    }
    return kept;
}

}  // namespace

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
            // Named after the nominal peak, which single channels may exceed.
            const double peak = std::min(limit.peak * kUnitLuminance, display->peak);
            if (limit.peak > 1) where += fmt::format(", {:g} nit", peak);
            const std::string name = view.name + " (" + where + ")";
            const bool is_taken = std::any_of(forms.begin(), forms.end(),
                                              [&](const Form& form) { return form.name == name; });
            forms.push_back(
                {is_taken ? view.name + " (" + where + ", " + display->title + ")" : name, stages,
                 rgb});
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

ConfigBuilder::ConfigBuilder(const ConfigModel& model, OCIO::ConfigRcPtr config, LutFiles luts)
    : model_(model),
      config_(std::move(config)),
      luts_(std::move(luts)),
      samples_(measured_samples(find_input_space("lin_rec709"), {9, 40000})),
      wide_samples_(measured_samples(find_input_space("lin_ap1"), {9, 40000})),
      few_samples_(measured_samples(find_input_space("lin_rec709"), {3, 1000})) {}

void ConfigBuilder::add_spaces() {
    for (const auto& space : model_.spaces)
        config_->addColorSpace(make_space(space, luts_));
    for (const auto& [role, space] : model_.roles)
        config_->setRole(role.c_str(), space.c_str());
}

void ConfigBuilder::add_untonemapped() {
    OCIO::ViewTransformRcPtr plain = OCIO::ViewTransform::Create(OCIO::REFERENCE_SPACE_SCENE);
    plain->setName(kUntonemappedView);
    plain->setDescription(
        "Scene-linear values without tone mapping, not limited: 1 is display white.");
    plain->setTransform(
        lower_part(luts_, {MatrixStage{rgb_to_xyz_d65(kAP0)}}, {}, kUntonemappedView),
        OCIO::VIEWTRANSFORM_DIR_FROM_REFERENCE);
    config_->addViewTransform(plain);
    config_->setDefaultViewTransformName(kUntonemappedView);
}

struct ConfigBuilder::LoweredView {
    Lowered forward;
    std::optional<LoweredOps> back;  // empty: OpenColorIO inverts it
    ViewError error;
    ErrorStats wide;  // all AP1 colors, for a view that is not exact
};

void ConfigBuilder::add_view_transforms() {
    struct Part {
        const ConfigModel::View* view;
        const DisplayedView* shown;
        bool is_first;
        LoweredView lowered;
    };
    std::vector<Part> parts;
    for (const auto& view : model_.views) {
        displayed_[view.name] = displayed_views(view, model_.displays);
        std::set<std::string> made;
        for (const DisplayedView& shown : displayed_[view.name]) {
            const bool is_first = made.empty();
            if (made.insert(shown.transform).second) parts.push_back({&view, &shown, is_first, {}});
        }
    }
    in_parallel(parts.size(), 0, [&](std::size_t i) {
        Part& part = parts[i];
        part.lowered = lower_view(*part.view, *part.shown, part.is_first);
    });
    for (const Part& part : parts) {
        add_view_transform(*part.view, *part.shown, part.lowered);
        for (const DisplayedView& shown : displayed_[part.view->name]) {
            if (shown.transform == part.shown->transform)
                largest_errors_[part.view->name][shown.display->title] =
                    part.lowered.error.in_gamut.max;
        }
    }
}

void ConfigBuilder::add_looks() {
    for (const auto& look : model_.looks) {
        OCIO::LookRcPtr added = OCIO::Look::Create();
        added->setName(look.name.c_str());
        added->setDescription(look.description.c_str());
        const OCIO::GroupTransformRcPtr transform = lower_part(
            luts_, look.stages, {look.op->id + "_look" + without(look.name, look.op->view)},
            look.name, look.op->working);
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

void ConfigBuilder::add_views() {
    std::vector<std::string> active;
    const auto activate = [&](const std::string& name) {
        if (std::find(active.begin(), active.end(), name) == active.end()) active.push_back(name);
    };
    for (const auto& view : model_.views) {
        const std::vector<DisplayedView>& forms = displayed_[view.name];
        for (const DisplayedView& shown : forms)
            activate(shown.name);
        const bool is_shared = forms.size() == model_.displays.size() &&
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
                                    shown.transform.c_str(), shown.display->title.c_str(), "", "",
                                    describe(view, shown).c_str());
        }
    }
    add_shared_view(kUntonemappedView, kUntonemappedView, OCIO::OCIO_VIEW_USE_DISPLAY_NAME,
                    "Scene-linear values without tone mapping, not limited.");
    add_shared_view(kRawView, "", kDataSpace, "Unconverted values.");
    activate(kUntonemappedView);
    activate(kRawView);
    add_virtual_display();
    std::vector<std::string> displays;
    for (const Display* display : model_.displays)
        displays.push_back(display->title);
    config_->setActiveDisplays(fmt::format("{}", fmt::join(displays, ", ")).c_str());
    config_->setActiveViews(fmt::format("{}", fmt::join(active, ", ")).c_str());
}

/// Applications make a display of this if the system reports a monitor profile. The gamut of the
/// monitor is unknown here, so the views are those of the first SDR display.
void ConfigBuilder::add_virtual_display() {
    const auto is_shared = [&](const std::string& name) {
        for (int i = 0; i < config_->getNumViews(OCIO::VIEW_SHARED, ""); ++i) {
            if (name == config_->getView(OCIO::VIEW_SHARED, "", i)) return true;
        }
        return false;
    };
    for (const auto& view : model_.views) {
        if (is_shared(view.name)) {
            config_->addVirtualDisplaySharedView(view.name.c_str());
            continue;
        }
        const std::vector<DisplayedView>& forms = displayed_[view.name];
        const auto form = std::find_if(forms.begin(), forms.end(), [](const DisplayedView& shown) {
            return !shown.display->is_hdr;
        });
        if (form == forms.end()) continue;
        config_->addVirtualDisplayView(view.name.c_str(), form->transform.c_str(),
                                       OCIO::OCIO_VIEW_USE_DISPLAY_NAME, "", "",
                                       view.description.c_str());
    }
    config_->addVirtualDisplaySharedView(kUntonemappedView);
    config_->addVirtualDisplaySharedView(kRawView);
}

void ConfigBuilder::add_output_spaces() {
    for (const auto& view : model_.views) {
        for (const DisplayedView& shown : displayed_[view.name])
            config_->addColorSpace(
                make_output_space(shown, shown.display->title, inverses_.at(shown.transform)));
    }
}

void ConfigBuilder::add_views_to(const Display& display, const std::string& host_display,
                                 const std::string& host_space) {
    std::string active = config_->getActiveViews();
    for (const auto& view : model_.views) {
        for (const DisplayedView& shown : displayed_[view.name]) {
            if (shown.display != &display) continue;
            config_->addDisplayView(host_display.c_str(), shown.name.c_str(),
                                    shown.transform.c_str(), host_space.c_str(), "", "",
                                    describe(view, shown).c_str());
            // An empty list means all.
            const std::string listed = ", " + active + ",";
            if (!active.empty() && listed.find(", " + shown.name + ",") == std::string::npos)
                active += ", " + shown.name;
            const OCIO::ColorSpaceRcPtr space =
                make_output_space(shown, host_display, inverses_.at(shown.transform));
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

void ConfigBuilder::add_file_rules() {
    const OCIO::FileRulesRcPtr rules = config_->getFileRules()->createEditableCopy();
    std::size_t index = 0;
    for (const auto& rule : model_.file_rules) {
        if (rule.regex.empty()) {
            rules->insertRule(index++, rule.name.c_str(), rule.space.c_str(), "*",
                              rule.extension.c_str());
        } else {
            rules->insertRule(index++, rule.name.c_str(), rule.space.c_str(), rule.regex.c_str());
        }
    }
    rules->setDefaultRuleColorSpace(model_.default_space.c_str());
    config_->setFileRules(rules);
}

void ConfigBuilder::use_builtins(const OCIO::ConfigRcPtr& config) const {
    for (const auto& view : model_.views) {
        for (const DisplayedView& shown : displayed_.at(view.name)) {
            const std::string style = builtin_style(shown.op);
            if (style.empty() || !cubes_.contains(shown.transform)) continue;
            const DisplayLimit limit = display_limit(shown.op, *shown.display);
            const Matrix3 to_xyz = rgb_to_xyz_d65(limit.primaries);
            OCIO::GroupTransformRcPtr group = OCIO::GroupTransform::Create();
            append(group, {MatrixStage{scale(kIdentity3, std::exp2(view.exposure_stops))}});
            group->appendTransform(builtin_of_profile_2_5(style));
            append(group,
                   {MatrixStage{inverse(to_xyz)}, ClampStage{0, limit.peak}, MatrixStage{to_xyz}});
            OCIO::ViewTransformRcPtr vt = OCIO::ViewTransform::Create(OCIO::REFERENCE_SPACE_SCENE);
            vt->setName(shown.transform.c_str());
            vt->setDescription(
                (view.description + " OpenColorIO's built-in transform " + style + ".").c_str());
            vt->setTransform(group, OCIO::VIEWTRANSFORM_DIR_FROM_REFERENCE);
            config->addViewTransform(vt);
        }
    }
}

std::string ConfigBuilder::text() const { return yaml_of(*config_); }

std::string ConfigBuilder::text(const std::string& profile) const {
    const OCIO::ConfigRcPtr config = editable_copy(*config_);
    config->setVersion(2, profile == "2.0" ? 0 : 1);
    if (profile != "2.5") return yaml_of(*config);
    use_builtins(config);
    return to_profile_2_5(yaml_of(*config), model_, displayed_);
}

OCIO::GroupTransformRcPtr ConfigBuilder::between_references(
    const OCIO::GroupTransformRcPtr& group, OCIO::TransformDirection direction) const {
    if (!scene_) return group;
    const bool is_forward = direction == OCIO::TRANSFORM_DIR_FORWARD;
    OCIO::GroupTransformRcPtr whole = OCIO::GroupTransform::Create();
    append_conversion(whole, is_forward ? *scene_ : *display_, OCIO::COLORSPACE_DIR_FROM_REFERENCE);
    for (int i = 0; i < group->getNumTransforms(); ++i)
        whole->appendTransform(group->getTransform(i));
    append_conversion(whole, is_forward ? *display_ : *scene_, OCIO::COLORSPACE_DIR_TO_REFERENCE);
    return whole;
}

void ConfigBuilder::append_conversion(OCIO::GroupTransformRcPtr& group,
                                      const OCIO::ColorSpace& space,
                                      OCIO::ColorSpaceDirection direction) {
    const auto other = direction == OCIO::COLORSPACE_DIR_FROM_REFERENCE
                           ? OCIO::COLORSPACE_DIR_TO_REFERENCE
                           : OCIO::COLORSPACE_DIR_FROM_REFERENCE;
    if (const auto given = space.getTransform(direction)) {
        group->appendTransform(given->createEditableCopy());
    } else if (const auto inverse = space.getTransform(other)) {
        const OCIO::TransformRcPtr copy = inverse->createEditableCopy();
        copy->setDirection(
            OCIO::CombineTransformDirections(copy->getDirection(), OCIO::TRANSFORM_DIR_INVERSE));
        group->appendTransform(copy);
    }
}

void ConfigBuilder::add_shared_view(const std::string& name, const std::string& transform,
                                    const std::string& space, const std::string& description) {
    config_->addSharedView(name.c_str(), transform.c_str(), space.c_str(), "", "",
                           description.c_str());
    for (const Display* display : model_.displays)
        config_->addDisplaySharedView(display->title.c_str(), name.c_str());
}

ConfigBuilder::LoweredView ConfigBuilder::lower_view(const ConfigModel::View& view,
                                                     const DisplayedView& shown,
                                                     bool is_first) const {
    LoweredView result;
    const LowerOptions options = lower_options(*view.op.op, model_.cache_folder);
    const View measured = make_view(view.op, "lin_rec709", view.exposure_stops, shown.display->id);
    const Pipeline stages = build_view(measured);
    const std::vector<double> truth = true_codes(stages, samples_);
    ViewError& error = result.error;
    error = measure_view(measured, lower_to_ocio(stages, options), samples_, truth);
    result.forward = lower_to_ocio(shown.stages, options);
    result.back = inverse_space(view, shown, model_.cache_folder);
    // OpenColorIO takes seconds to invert a 3D LUT: measure it once per view, with few colors.
    const bool is_slow = !result.back && !result.forward.is_exact;
    if (!view.op.op->is_diagnostic && (is_first || !is_slow)) {
        const RoundTrip trip = is_slow ? RoundTrip(measured, few_samples_)
                                       : RoundTrip(measured, {truth.begin(), truth.end()});
        error.back = measure_round_trip(
            measured, result.back ? *result.back : inverse(result.forward.ops), trip);
        error.back.exists = is_inverse_space(error.back.lossless);
    }
    if (!error.is_exact) {
        const View wide = make_view(view.op, "lin_ap1", view.exposure_stops, shown.display->id);
        const Pipeline wide_stages = build_view(wide);
        result.wide = measure_view(wide, lower_to_ocio(wide_stages, options), wide_samples_,
                                   true_codes(wide_stages, wide_samples_))
                          .in_gamut;
    }
    return result;
}

void ConfigBuilder::add_view_transform(const ConfigModel::View& view, const DisplayedView& shown,
                                       const LoweredView& lowered) {
    const ViewError& error = lowered.error;
    errors_.emplace(view.name, error);
    if (!error.is_exact) cubes_.insert(shown.transform);
    std::string text = fmt::format(
        "{} Error of OCIO's CPU path against the double reference, in {} code values: max {}, 99.9 "
        "% {}.",
        view.description, shown.display->title, rounded_up(error.in_gamut.max),
        rounded_up(error.in_gamut.p999));
    if (!error.is_exact) {
        text += fmt::format(
            " 3D LUT: mean {}, dE ITP at most {}; all AP1 colors: max {}, 99.9 % {}, mean {}.",
            rounded_up(error.in_gamut.mean), rounded_up(error.delta_e),
            rounded_up(lowered.wide.max), rounded_up(lowered.wide.p999),
            rounded_up(lowered.wide.mean));
    }
    const std::string inverse_space_text = describe_inverse(error.back, view.op.op->is_diagnostic);
    inverses_[shown.transform] = inverse_space_text;
    text += inverse_space_text;
    OCIO::ViewTransformRcPtr vt = OCIO::ViewTransform::Create(OCIO::REFERENCE_SPACE_SCENE);
    vt->setName(shown.transform.c_str());
    vt->setDescription(text.c_str());
    const LutStem stem = {view.op.op->id + " " + without(view.name, view.op.op->view),
                          without(shown.transform, view.name)};
    const bool has_inverse = lowered.back && error.back.exists;
    vt->setTransform(between_references(luts_.to_ocio(lowered.forward.ops, stem, view.op.op->title,
                                                      {.is_exact = lowered.forward.is_exact,
                                                       .is_inverted = !has_inverse}),
                                        OCIO::TRANSFORM_DIR_FORWARD),
                     OCIO::VIEWTRANSFORM_DIR_FROM_REFERENCE);
    if (has_inverse) {
        vt->setTransform(
            between_references(
                luts_.to_ocio(*lowered.back, {stem.subject, stem.qualifier, "inverse"},
                              view.op.op->title + ", inverse",
                              {.is_exact = false, .is_inverted = false, .is_inverse = true}),
                OCIO::TRANSFORM_DIR_INVERSE),
            OCIO::VIEWTRANSFORM_DIR_TO_REFERENCE);
    }
    config_->addViewTransform(vt);
}

TONEWRIGHT_NAMESPACE_END
