// SPDX-License-Identifier: Apache-2.0
#include "ocio/extend.h"

#include <OpenColorIO/OpenColorIO.h>
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <map>
#include <new>
#include <optional>
#include <set>
#include <system_error>

#include "base/strings.h"
#include "ocio/added_record.h"
#include "ocio/config_builder.h"
#include "ocio/config_location.h"
#include "ocio/lower.h"
#include "ocio/read_config.h"
#include "ocio/transforms.h"
#include "ocio/yaml_text.h"
#include "tonewright/engine.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

/// A display of the existing config, and the equivalent display of Tonewright.
struct HostDisplay {
    std::string name;
    std::string space;
    const Display* ours;
};

std::vector<float> run_processor(const OCIO::ConstProcessorRcPtr& processor,
                                 std::vector<float> rgb) {
    OcioCpu(processor, OCIO::OPTIMIZATION_LOSSLESS).run_rgb(rgb.data(), rgb.data(), rgb.size() / 3);
    return rgb;
}

/// Difference between the display space of the config and ours, for colors that both can show.
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

/// Runs OpenColorIO and yaml-cpp on the contents of a config: what they throw is its fault.
template <class Run>
auto reading(const std::string& path, const Run& run) {
    try {
        return run();
    } catch (const Error&) {
        throw;
    } catch (const std::bad_alloc&) {
        throw;
    } catch (const std::system_error&) {  // no thread, or a file that cannot be read
        throw;
    } catch (const std::exception& e) {
        throw FileError(path + ": " + one_line(e.what()));
    }
}

/// Nearest of our displays, if the space is one of them.
const Display* nearest_display(const OCIO::ConstConfigRcPtr& config, const std::string& space) {
    const Display* nearest = nullptr;
    // OpenColorIO's own displays are up to 1e-4 from the standards.
    double least = 1e-3;
    for (const Display& ours : all_displays()) {
        const double difference = display_difference(config, space, ours);
        if (!(difference < least)) continue;
        least = difference;
        nearest = &ours;
    }
    return nearest;
}

bool is_unread(const AnyConfig& config, const std::string& what) {
    return config.newer && std::find(config.newer->unread.begin(), config.newer->unread.end(),
                                     what) != config.newer->unread.end();
}

std::vector<HostDisplay> match_displays(const AnyConfig& any, const std::string& path,
                                        const std::vector<std::string>& wanted) {
    const OCIO::ConstConfigRcPtr config = any.config;
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
            const auto refuse = [&](const std::string& reason) {
                throw FileError(
                    fmt::format("{}: view {} on display {}: {}", path, view, name, reason));
            };
            const OCIO::ConstColorSpaceRcPtr shown = config->getColorSpace(space.c_str());
            if (!shown)
                refuse("its space " + space + " is missing; expected a display color space");
            if (is_unread(any, std::string("color space ") + shown->getName())) continue;
            try {
                if (const Display* ours = nearest_display(config, space))
                    matched.push_back({name, space, ours});
            } catch (const OCIO::Exception& e) {
                refuse(one_line(e.what()));
            }
            break;
        }
    }
    for (const std::string& name : wanted) {
        if (std::find(names.begin(), names.end(), name) == names.end()) {
            throw Error({.parameter = "displays",
                         .value = name,
                         .expected = join_choices(names),
                         .suggestion = suggested_names(name, names)});
        }
    }
    return matched;
}

/// One line of what is not checked; empty: nothing.
std::string describe_unchecked(const AnyConfig& config, const std::string& path) {
    if (!config.newer) return "";
    const auto list = [](const std::vector<std::string>& names) {
        constexpr std::size_t kMostNames = 3;
        const std::size_t shown = std::min(names.size(), kMostNames);
        std::string text = fmt::format("{}", fmt::join(names.data(), names.data() + shown, ", "));
        if (names.size() > shown) text += fmt::format(" and {} more", names.size() - shown);
        return text;
    };
    const ReadableProfile& newer = *config.newer;
    std::string text =
        fmt::format("{} has profile {}, and OpenColorIO {} reads profiles up to {}: checked as {}",
                    path, newer.profile, OCIO::GetVersion(), newer.newest, newer.newest);
    if (!newer.unread.empty()) text += ", without the " + list(newer.unread);
    if (!newer.older.empty()) text += "; negative values not checked on " + list(newer.older);
    return text;
}

/// The space of an interchange role.
OCIO::ConstColorSpaceRcPtr interchange_space(const AnyConfig& any, const std::string& path,
                                             const std::string& role, const char* expected) {
    const OCIO::ConstConfigRcPtr config = any.config;
    const char* name = nullptr;
    for (int i = 0; i < config->getNumRoles(); ++i) {
        if (lowercase(config->getRoleName(i)) == role) name = config->getRoleColorSpace(i);
    }
    if (!name) {
        throw FileError(path + " has no role " + role +
                        "; expected both interchange roles, which define its color spaces");
    }
    OCIO::ConstColorSpaceRcPtr space = config->getColorSpace(name);
    if (!space || space->isData()) {
        throw FileError(
            fmt::format("{}: role {} is {}, which is {}; expected {}", path, role, one_line(name),
                        space ? "a data space" : "no color space of the config", expected));
    }
    if (is_unread(any, std::string("color space ") + space->getName())) {
        throw FileError(fmt::format(
            "{}: role {} is {}, whose transform OpenColorIO {} does not know; expected one "
            "of profile {}",
            path, role, one_line(name), OCIO::GetVersion(), any.newer->newest));
    }
    return space;
}

/// Results of a config for some colors: every space and its inverse, every view of every display.
std::map<std::string, std::vector<float>> pictures_of(const OCIO::ConstConfigRcPtr& config) {
    const std::vector<float> colors = {0.18F, 0.18F,  0.18F, 1,    1,    1,     0.8F, 0.1F, 0.02F,
                                       0.1F,  0.7F,   0.1F,  0.1F, 0.1F, 0.9F,  4,    2,    9,
                                       0,     0.002F, 0.01F, 0,    0,    -0.1F, 0.5F, 0.3F, 0.2F};
    std::map<std::string, std::vector<float>> pictures;
    const auto add = [&](const std::string& name, const auto& make_processor_of) {
        try {
            pictures[name] = run_processor(make_processor_of(), colors);
        } catch (const std::bad_alloc&) {
            throw;
        } catch (const std::exception&) {
            pictures[name] = {};  // it failed before, too
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
            add(fmt::format("view {} / {}", display, view), [&] {
                return config->getProcessor("aces_interchange", display.c_str(), view.c_str(),
                                            OCIO::TRANSFORM_DIR_FORWARD);
            });
        }
    }
    return pictures;
}

void require_valid(const OCIO::Config& config, const std::string& what) {
    try {
        config.validate();
    } catch (const std::bad_alloc&) {
        throw;
    } catch (const std::exception& e) {
        throw FileError("OpenColorIO refuses " + what + ": " + one_line(e.what()));
    }
}

/// Checks that OpenColorIO accepts the result, and that existing entries give the same values.
/// @param before  results that must stay the same; others may be added or missing
OCIO::ConfigRcPtr check_result(const std::string& path, const std::string& written,
                               const std::map<std::string, std::vector<float>>& before) {
    OCIO::ConfigRcPtr made = read_any_config(written, read_config_text(written)).config;
    require_valid(*made, "the result");
    const std::map<std::string, std::vector<float>> after = pictures_of(made);
    for (const auto& [name, picture] : before) {
        const auto it = after.find(name);
        const bool is_same =
            it != after.end() && it->second.size() == picture.size() &&
            std::memcmp(it->second.data(), picture.data(), picture.size() * sizeof(float)) == 0;
        if (!is_same) throw FileError(fmt::format("the result changes {} of {}", name, path));
    }
    return made;
}

/// Colors of a linear space through a view of the config.
OCIO::GroupTransformRcPtr scene_to_view(const InputSpace& input, const std::string& display,
                                        const std::string& view) {
    OCIO::GroupTransformRcPtr group = OCIO::GroupTransform::Create();
    append(group, lower_to_ocio({MatrixStage{rgb_to_rgb(input.primaries, kAP0)}}).ops);
    OCIO::DisplayViewTransformRcPtr through = OCIO::DisplayViewTransform::Create();
    through->setSrc("aces_interchange");
    through->setDisplay(display.c_str());
    through->setView(view.c_str());
    group->appendTransform(through);
    return group;
}

/// Items of a list with these names, in the order of the names.
std::vector<YAML::Node> named(const YAML::Node& list, const std::vector<std::string>& names) {
    std::map<std::string, YAML::Node> items;
    for (const YAML::Node& item : list) {
        if (item.IsMap() && item["name"]) items[item["name"].Scalar()] = item;
    }
    std::vector<YAML::Node> found;
    found.reserve(names.size());
    for (const std::string& name : names) {
        const auto item = items.find(name);
        if (item == items.end()) {
            throw YAML::RepresentationException(YAML::Mark::null_mark(),
                                                "OpenColorIO does not write the new " + name);
        }
        found.push_back(item->second);
    }
    return found;
}

/// Active or not; OpenColorIO ignores case.
bool has_view(const OCIO::Config& config, const std::string& display, const std::string& view) {
    for (const OCIO::ViewType type : {OCIO::VIEW_SHARED, OCIO::VIEW_DISPLAY_DEFINED}) {
        for (int v = 0; v < config.getNumViews(type, display.c_str()); ++v) {
            if (lowercase(config.getView(type, display.c_str(), v)) == lowercase(view)) return true;
        }
    }
    return false;
}

void append_or_add(YamlText& yaml, const std::string& key, const std::vector<YAML::Node>& items) {
    const YAML::Node list = yaml.root()[key];
    const bool is_there =
        list && list.IsSequence() && (list.size() > 0 || list.Style() == YAML::EmitterStyle::Flow);
    if (is_there) {
        yaml.append(list, items);
    } else if (list) {
        throw YAML::RepresentationException(YAML::Mark::null_mark(),
                                            key + " is empty; expected at least one, or no " + key);
    } else {
        yaml.add(key, items);
    }
}

/// "a, b", or a list.
void append_names(YamlText& yaml, const std::string& key, const std::string& separator,
                  const std::vector<std::string>& names) {
    const YAML::Node list = yaml.root()[key];
    if (list && list.IsSequence() && list.size() > 0) {
        std::vector<YAML::Node> items;
        items.reserve(names.size());
        for (const std::string& name : names)
            items.emplace_back(name);
        yaml.append(list, items);
        return;
    }
    for (const std::string& name : names)
        yaml.append_text(list, (list.Scalar().empty() ? "" : separator) + name);
}

/// Tables of the folder that no other config beside this one has added.
std::vector<std::string> unused(const std::string& config, const std::vector<std::string>& files,
                                const std::vector<std::string>& used) {
    namespace fs = std::filesystem;
    std::set<std::string> kept(used.begin(), used.end());
    const fs::path folder = fs::absolute(config).parent_path();
    std::error_code ignored;
    for (const fs::directory_entry& entry :
         fs::directory_iterator(folder / kAddedFolder, ignored)) {
        fs::path name = entry.path().filename();
        if (name.extension() == ".new") name = name.stem();
        if (name.extension() != ".yaml" ||
            name == fs::path(AddedRecord::path_of(config)).filename())
            continue;
        const std::string path = (folder / name.stem()).string();
        const auto other =
            AddedRecord::find(path, fs::exists(path, ignored) ? read_config_text(path) : "");
        if (other) kept.insert(other->files.begin(), other->files.end());
    }
    std::vector<std::string> result;
    for (const std::string& file : files) {
        if (!kept.contains(file)) result.push_back(file);
    }
    return result;
}

bool is_empty(const ConfigOptions& o) {
    return o.views.empty() && o.displays.empty() && o.looks.empty() && o.custom.empty() &&
           o.exposure_stops.empty();
}

/// Files of an earlier run that the config does not need any more.
/// @param used  tables of the new record
std::vector<std::string> obsolete(const ConfigLocation& location, const FoundRecord& earlier,
                                  const std::vector<std::string>& used) {
    namespace fs = std::filesystem;
    if (earlier.config == location.file) return unused(location.file, earlier.record.files, used);
    std::error_code ignored;
    const fs::path folder = fs::canonical(fs::absolute(earlier.config).parent_path(), ignored);
    const fs::path own = fs::canonical(fs::absolute(location.file).parent_path(), ignored);
    const bool is_shared =
        fs::weakly_canonical(folder / kAddedFolder) == fs::weakly_canonical(own / kAddedFolder);
    std::vector<std::string> files;
    for (const std::string& file : unused(earlier.config, earlier.record.files,
                                          is_shared ? used : std::vector<std::string>{}))
        files.push_back((folder / file).string());
    const std::string record = AddedRecord::path_of(earlier.config);
    for (const std::string& name : {record, record + ".new"}) {
        if (fs::exists(folder / name, ignored)) files.push_back((folder / name).string());
    }
    return files;
}

ExtendedConfig reduce(const ConfigLocation& location) {
    const std::string& path = location.file;
    const std::string text = read_config_text(path);
    const FoundRecord earlier = read_record(location, text);
    ExtendedConfig result;
    result.path = path;
    result.text = earlier.record.without(text, path);
    result.record = {AddedRecord::path_of(path), AddedRecord::mark_of(result.text)};
    result.unused_files = obsolete(location, earlier, {});
    result.folder_links = linked_folders(location);
    const AnyConfig left = read_any_config(path, result.text);
    result.unchecked = describe_unchecked(left, path);
    const std::map<std::string, std::vector<float>> all =
        pictures_of(read_any_config(path, text).config);
    std::map<std::string, std::vector<float>> before;
    for (const auto& [name, picture] : pictures_of(left.config)) {
        if (const auto it = all.find(name); it != all.end()) before.insert(*it);
    }
    result.check = [before, path](const std::string& written) {
        return reading(path, [&] {
            check_result(path, written, before);
            return std::vector<ExtendedView>{};
        });
    };
    return result;
}

/// The config that gets the views.
struct Host {
    std::string path;
    AnyConfig any;
    OCIO::ConstColorSpaceRcPtr scene;
    OCIO::ConstColorSpaceRcPtr display;
    std::vector<HostDisplay> displays;
    std::string active_views;
    bool has_folder = false;
    std::map<std::string, std::vector<float>> pictures;
};

/// @param displays  empty: all that Tonewright knows
Host read_host(const std::string& path, const std::string& text,
               const std::vector<std::string>& displays) {
    Host host;
    host.path = path;
    host.any = read_any_config(path, text);
    const OCIO::Config& config = *host.any.config;
    for (int i = 0; i < config.getNumSearchPaths(); ++i)
        host.has_folder =
            host.has_folder || std::string_view(config.getSearchPath(i)) == kAddedFolder;
    host.active_views = config.getActiveViews();
    host.scene = interchange_space(host.any, path, "aces_interchange", "ACES2065-1");
    host.display = interchange_space(host.any, path, "cie_xyz_d65_interchange", "CIE XYZ D65");
    require_valid(config, path);
    host.pictures = pictures_of(host.any.config);
    host.displays = match_displays(host.any, path, displays);
    if (host.displays.empty()) {
        throw FileError(
            path +
            " has no display that Tonewright knows with a view transform; expected sRGB, Display "
            "P3, Rec.1886, Rec.2020, 2.2, PQ or HLG");
    }
    return host;
}

ConfigModel model_for(const Host& host, ConfigOptions options) {
    options.displays.clear();
    for (const HostDisplay& display : host.displays)
        options.displays.push_back(display.ours->id);
    return make_config_model(options);
}

/// Existing entries are never replaced.
void refuse_existing(const Host& host, const ConfigModel& model) {
    const OCIO::Config& config = *host.any.config;
    const auto refuse = [&](const std::string& what, const std::string& name) {
        throw Error(Problem{.value = host.path + " has " + what + " " + name + " already",
                            .expected = "another name (<<custom=ID>> <<name=NAME>>)"});
    };
    for (const auto& look : model.looks) {
        if (config.getLook(look.name.c_str())) refuse("a look", look.name);
    }
    for (const auto& view : model.views) {
        for (const DisplayedView& shown : displayed_views(view, model.displays)) {
            if (config.getViewTransform(shown.transform.c_str()))
                refuse("a view transform", shown.transform);
            for (const HostDisplay& display : host.displays) {
                if (display.ours != shown.display) continue;
                if (has_view(config, display.name, shown.name))
                    refuse("on the display " + display.name + " a view", shown.name);
                const std::string space = output_space_name(shown.name, display.name);
                if (config.getColorSpace(space.c_str())) refuse("a space", space);
            }
        }
    }
}

/// Names of what is added.
struct Additions {
    std::vector<std::string> transforms;
    std::vector<std::string> looks;
    std::vector<std::string> views;  // with their displays
    std::vector<std::string> spaces;
    std::vector<std::string> active_views;
};

/// Inserts the views of the display into the text.
void insert_views(YamlText& yaml, const YAML::Node& made, const HostDisplay& display,
                  const Host& host, const ConfigModel& model, const ConfigBuilder& builder,
                  Additions& added) {
    const auto note = [](std::vector<std::string>& names, const std::string& name) {
        if (std::find(names.begin(), names.end(), name) == names.end()) names.push_back(name);
    };
    const std::string listed = ", " + host.active_views + ",";
    std::vector<std::string> views;
    for (const auto& view : model.views) {
        for (const DisplayedView& shown : builder.displayed(view.name)) {
            if (shown.display != display.ours) continue;
            note(added.transforms, shown.transform);
            views.push_back(shown.name);
            added.views.push_back(fmt::format("{} on {}", shown.name, display.name));
            added.spaces.push_back(output_space_name(shown.name, display.name));
            if (listed.find(", " + shown.name + ",") == std::string::npos)
                note(added.active_views, shown.name);
        }
    }
    yaml.append(yaml.root()["displays"][display.name],
                named(made["displays"][display.name], views));
}

/// Writes the text of the config with its views, and the record of the insertions.
void insert(const std::string& text, const Host& host, const ConfigModel& model,
            const ConfigBuilder& builder, ExtendedConfig& result, AddedRecord& record) {
    YamlText yaml(text);
    const YAML::Node made = YAML::Load(builder.text());
    Additions added;
    for (const HostDisplay& display : host.displays)
        insert_views(yaml, made, display, host, model, builder, added);
    for (const auto& look : model.looks)
        added.looks.push_back(look.name);
    append_or_add(yaml, "view_transforms", named(made["view_transforms"], added.transforms));
    append_or_add(yaml, "looks", named(made["looks"], added.looks));
    append_or_add(yaml, "colorspaces", named(made["colorspaces"], added.spaces));
    if (!host.active_views.empty()) append_names(yaml, "active_views", ", ", added.active_views);
    if (!yaml.root()["search_path"]) {
        yaml.add_text("search_path", kAddedFolder);
    } else if (!host.has_folder) {
        append_names(yaml, "search_path", ":", {kAddedFolder});
    }
    result.text = yaml.result();
    record.add(yaml.insertions(), result.text);
    result.added = {{"view", added.views},
                    {"view transform", added.transforms},
                    {"look", added.looks},
                    {"color space", added.spaces}};
}

/// Mean errors that the approximations of the views may have, by the view's name and the display's
/// id.
using MeanBounds = std::map<std::string, double>;

MeanBounds mean_bounds(const ConfigModel& model, const ConfigBuilder& builder) {
    MeanBounds all;
    for (const auto& view : model.views) {
        for (const DisplayedView& shown : builder.displayed(view.name))
            all[view.name + shown.display->id] =
                builder.largest_errors().at(view.name).at(shown.display->title);
    }
    return all;
}

/// Errors of the view on the display of the written config.
ExtendedView measure_view(const OCIO::ConstConfigRcPtr& made, const HostDisplay& display,
                          const ConfigModel::View& view, const InputSpace& input,
                          const std::vector<float>& colors, double bound) {
    const View shown = make_view(view.op, input.id, view.exposure_stops, display.ours->id);
    const std::string name = config_view_name(view.name, shown.op, *display.ours);
    std::vector<double> truth(colors.size());
    ReferenceEngine(build_view(shown)).run_rgb(colors.data(), truth.data(), colors.size() / 3);
    const std::vector<float> codes =
        run_processor(made->getProcessor(scene_to_view(input, display.name, name)), colors);
    std::vector<double> errors;
    for (std::size_t i = 0; i < codes.size(); i += 3)
        errors.push_back(channel_error(&truth[i], &codes[i]));
    const ErrorStats stats = summarise(errors);
    // Displays of other configs are less accurate than ours, above all near black. Refuse another
    // picture, not a less accurate one.
    constexpr double kAnother = 0.02;
    if (stats.mean > kAnother + bound) {
        throw FileError(
            fmt::format("view {} on {} would differ from the reference by {:.2g} on "
                        "average; expected at most 0.02 more than its bound",
                        name, display.name, stats.mean));
    }
    return {display.name, name, stats.max, stats.p999};
}

std::vector<ExtendedView> measure_views(const OCIO::ConstConfigRcPtr& made,
                                        const std::vector<HostDisplay>& displays,
                                        const ConfigModel& model, const MeanBounds& bounds) {
    // The same colors as for the errors of Tonewright's own config. In AP0, colors at the edge of
    // Rec.709 would measure the float32 rounding of a matrix instead.
    const InputSpace& input = find_input_space("lin_rec709");
    const SampleSet samples = make_sample_set(input, {5, 4000});
    std::vector<float> colors;
    for (std::size_t i = 0; i < samples.size(); ++i) {
        if (samples.is_non_negative(i) && samples.kind[i] != SampleKind::special)
            colors.insert(colors.end(), &samples.rgb[3 * i], &samples.rgb[3 * i] + 3);
    }
    std::vector<ExtendedView> views;
    for (const auto& view : model.views) {
        for (const HostDisplay& display : displays) {
            if (!view.is_on(*display.ours)) continue;
            views.push_back(measure_view(made, display, view, input, colors,
                                         bounds.at(view.name + display.ours->id)));
        }
    }
    return views;
}

/// @param replaced  the record of an earlier run that this one replaces
ExtendedConfig extend(const ConfigLocation& location, const std::string& text,
                      ConfigOptions options, AddedRecord record,
                      const std::optional<FoundRecord>& replaced) {
    const std::string& path = location.file;
    // A user who adds an operator to a config wants that one only.
    if (options.views.empty() && !options.custom.empty()) options.views = {"none"};
    record.options = options;
    record.custom.clear();
    for (const ConfigOptions::CustomView& view : options.custom)
        record.custom.push_back({view.name, operator_text(view.op)});
    const Host host = read_host(path, text, options.displays);
    const ConfigModel model = model_for(host, options);
    refuse_existing(host, model);

    // The folder may hold tables of another release that another config needs.
    ConfigBuilder builder(model, host.any.config, LutFiles(kAddedFolder, LutFiles::Names::hashed));
    builder.set_references(host.scene, host.display);
    builder.add_view_transforms();
    builder.add_looks();
    for (const HostDisplay& display : host.displays)
        builder.add_views_to(*display.ours, display.name, display.space);

    ExtendedConfig result;
    result.path = path;
    result.unchecked = describe_unchecked(host.any, path);
    result.warnings = config_warnings(model);
    result.files = builder.tables();
    try {
        insert(text, host, model, builder, result, record);
    } catch (const YAML::Exception& e) {
        throw FileError("read: " + path + ": " + one_line(e.what()));
    }
    std::set<std::string> files(record.files.begin(), record.files.end());
    for (const GeneratedFile& file : result.files)
        files.insert(file.path);
    record.files.assign(files.begin(), files.end());
    result.record = {AddedRecord::path_of(path), record.text(result.text)};
    if (replaced) result.unused_files = obsolete(location, *replaced, record.files);
    result.missing_links = folders_to_link(location, result.unused_files);
    result.check = [path, model, pictures = host.pictures, displays = host.displays,
                    bounds = mean_bounds(model, builder)](const std::string& written) {
        return reading(path, [&] {
            return measure_views(check_result(path, written, pictures), displays, model, bounds);
        });
    };
    return result;
}

}  // namespace

ExtendedConfig reduce_config(const std::string& path) {
    const ConfigLocation location = locate_config(path);
    return reading(location.file, [&] { return reduce(location); });
}

ExtendedConfig extend_config(const std::string& path, const ConfigOptions& given, bool is_updated) {
    const ConfigLocation location = locate_config(path);
    return reading(location.file, [&] {
        const std::string text = read_config_text(location.file);
        if (!is_updated) {
            const auto record = AddedRecord::find(location.file, text);
            return extend(location, text, given, record.value_or(AddedRecord{}), std::nullopt);
        }
        const FoundRecord earlier = read_record(location, text);
        const std::string rest = earlier.record.without(text, location.file);
        if (!is_empty(given)) return extend(location, rest, given, {}, earlier);
        ConfigOptions options = earlier.record.options;
        options.others = given.others;
        options.cache_folder = given.cache_folder;
        try {
            for (const AddedRecord::CustomView& view : earlier.record.custom)
                options.custom.push_back(
                    {view.name, resolve_operator(view.op, {}, {}, options.others)});
            return extend(location, rest, options, {}, earlier);
        } catch (const FileError&) {
            throw;
        } catch (const Error& e) {  // not the caller's options, but those of the record
            throw FileError(within(AddedRecord::path_of(earlier.config), e.problem()));
        }
    });
}

TONEWRIGHT_NAMESPACE_END
