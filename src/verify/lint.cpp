// SPDX-License-Identifier: Apache-2.0
#include "tonewright/lint.h"

#include <OpenColorIO/OpenColorIO.h>
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <filesystem>
#include <functional>
#include <limits>
#include <map>
#include <set>
#include <sstream>

#include "base/strings.h"
#include "ocio/gpu.h"
#include "ocio/read_config.h"
#include "ocio/references.h"
#include "ocio/transforms.h"
#include "tonewright/error.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

using Level = LintFinding::Level;

std::vector<std::string> split(const std::string& list) {
    std::vector<std::string> items;
    std::istringstream in(list);
    for (std::string item; std::getline(in, item, ',');) {
        if (!trimmed(item).empty()) items.emplace_back(trimmed(item));
    }
    return items;
}

class Linter {
  public:
    Linter(std::string path, bool with_gpu)
        : path_(std::move(path)),
          with_gpu_(with_gpu),
          config_(read_config(path_)),
          spaces_(*config_) {}

    std::vector<LintFinding> run() {
        check_whole();
        check_names();
        check_roles();
        check_lists();
        check_transforms();
        check_displays();
        return findings_;
    }

  private:
    void add(Level level, std::string where, std::string what) {
        findings_.push_back({level, std::move(where), std::move(what)});
    }

    void check_whole() {
        try {
            config_->validate();
        } catch (const OCIO::Exception& e) {
            add(Level::error, "config", "OpenColorIO refuses it: " + one_line(e.what()));
        }
        if (config_->getMajorVersion() < 2) {
            add(Level::warning, "config",
                "profile 1: no display spaces, view transforms, file rules or aliases");
        } else if (config_->getMinorVersion() > 1) {
            add(Level::warning, "config",
                fmt::format(
                    "profile {}.{}: Blender 3, Debian 12 and others with OpenColorIO 2.1 or "
                    "older refuse it",
                    config_->getMajorVersion(), config_->getMinorVersion()));
        }
        for (int i = 0; i < config_->getNumSearchPaths(); ++i) {
            const std::filesystem::path path(config_->getSearchPath(i));
            if (path.is_absolute()) {
                add(Level::warning, "config",
                    "search path " + path.string() + " is absolute: the config cannot be moved");
            }
        }
        if (!config_->isStrictParsingEnabled())
            add(Level::note, "config",
                "strictparsing is off: a word in a file name may set the wrong space");
    }

    /// @param is_unique  among all names of its kind
    void check_name(const std::string& where, const std::string& name,
                    std::map<std::string, std::string>* taken) {
        constexpr std::size_t kLongest = 63;
        if (name.size() > kLongest) {
            add(Level::warning, where,
                fmt::format("a name of {} bytes: Blender cuts it at {}", name.size(), kLongest));
        }
        for (const char c : name) {
            if (static_cast<unsigned char>(c) >= 127 || static_cast<unsigned char>(c) < 32) {
                add(Level::warning, where, "a name that is not plain ASCII");
                break;
            }
        }
        if (!taken) return;
        const auto [other, is_new] = taken->emplace(lowercase(name), where);
        if (!is_new && other->second != where)
            add(Level::error, where, "has the name " + name + ", as " + other->second + " has");
    }

    void check_names() {
        std::map<std::string, std::string> taken;
        for (int i = 0; i < config_->getNumRoles(); ++i) {
            const std::string role = config_->getRoleName(i);
            taken[lowercase(role)] = "role " + role;
        }
        for (const OCIO::ConstColorSpaceRcPtr& space : spaces_.all()) {
            const std::string where = std::string("space ") + space->getName();
            check_name(where, space->getName(), &taken);
            for (std::size_t i = 0; i < space->getNumAliases(); ++i)
                check_name(where, space->getAlias(i), &taken);
            if (!*space->getEncoding())
                add(Level::note, where, "has no encoding: applications guess its use");
        }
        for (int i = 0; i < config_->getNumLooks(); ++i) {
            const std::string look = config_->getLookNameByIndex(i);
            check_name("look " + look, look, nullptr);
        }
        for (int i = 0; i < config_->getNumViewTransforms(); ++i) {
            const std::string name = config_->getViewTransformNameByIndex(i);
            check_name("view transform " + name, name, nullptr);
        }
    }

    void check_roles() {
        const auto want = [&](const char* role, Level level, const char* why) {
            if (!config_->hasRole(role)) add(level, std::string("role ") + role, why);
        };
        want("scene_linear", Level::error,
             "is missing: applications do not know the working space");
        want("aces_interchange", Level::warning,
             "is missing: this config's spaces cannot be exchanged with another's");
        want("cie_xyz_d65_interchange", Level::warning,
             "is missing: displays cannot be exchanged, and Blender cannot tell its gamut");
        want("data", Level::warning, "is missing: Blender 4 refuses the config");
        want("color_picking", Level::warning, "is missing: Blender 4 refuses the config");
        want("texture_paint", Level::warning, "is missing: Blender 4 refuses the config");
        want("default_byte", Level::warning,
             "is missing: Blender opens 8-bit pictures as texture_paint");
        want("default_float", Level::note, "is missing: Blender takes scene_linear");
        want("default_sequencer", Level::note, "is missing: Blender takes scene_linear");
        want("compositing_log", Level::note, "is missing: Nuke's OCIOLogConvert has none");
        for (const char* name : {"Linear", "sRGB"}) {
            if (!spaces_.find(name)) {
                add(Level::note, "config",
                    std::string("no space is called ") + name +
                        ": oiiotool and Blender's older files ask for it");
            }
        }
    }

    void check_lists() {
        const auto known_spaces = split(config_->getInactiveColorSpaces());
        for (const std::string& name : known_spaces) {
            if (!spaces_.find(name))
                add(Level::warning, "inactive_colorspaces", "there is no space " + name);
        }
        std::set<std::string> displays;
        std::set<std::string> views;
        for (int i = 0; i < config_->getNumDisplaysAll(); ++i) {
            const std::string display = config_->getDisplayAll(i);
            displays.insert(display);
            for (const OCIO::ViewType type : {OCIO::VIEW_SHARED, OCIO::VIEW_DISPLAY_DEFINED}) {
                for (int v = 0; v < config_->getNumViews(type, display.c_str()); ++v)
                    views.insert(config_->getView(type, display.c_str(), v));
            }
        }
        for (const std::string& name : split(config_->getActiveDisplays())) {
            if (!displays.contains(name))
                add(Level::warning, "active_displays", "there is no display " + name);
        }
        for (const std::string& name : split(config_->getActiveViews())) {
            if (!views.contains(name))
                add(Level::warning, "active_views", "no display has a view " + name);
        }
        for (const std::string& display : displays)
            check_name("display " + display, display, nullptr);
        for (const std::string& view : views)
            check_name("view " + view, view, nullptr);
    }

    void check_transform(const std::string& where, const OCIO::ConstTransformRcPtr& transform) {
        for_each_transform(transform, [&](const OCIO::ConstTransformRcPtr& part) {
            const auto file = OCIO_DYNAMIC_POINTER_CAST<const OCIO::FileTransform>(part);
            if (!file) return;
            const std::string source = file->getSrc();
            const std::string extension =
                lowercase(std::filesystem::path(source).extension().string());
            const auto interpolation = file->getInterpolation();
            // A .spi1d file is never a 3D LUT.
            const bool may_be_cube = extension != ".spi1d" && extension != ".spimtx" &&
                                     source.find("curve") == std::string::npos;
            if (may_be_cube && interpolation != OCIO::INTERP_TETRAHEDRAL &&
                interpolation != OCIO::INTERP_BEST && extension != ".cc" && extension != ".ccc" &&
                extension != ".cdl" && extension != ".clf" && extension != ".ctf") {
                add(Level::note, where,
                    source + " is not interpolated in tetrahedra: on a GPU it bands");
            }
        });
    }

    void check_transforms() {
        // OpenColorIO searches all other spaces for each.
        constexpr std::size_t kMostTried = 1000;
        std::size_t count = 0;
        if (spaces_.all().size() > kMostTried) {
            add(Level::warning, "config",
                fmt::format("has {} color spaces: only the first {} were tested by a round "
                            "trip through scene_linear",
                            spaces_.all().size(), kMostTried));
        }
        for (const OCIO::ConstColorSpaceRcPtr& space : spaces_.all()) {
            const std::string where = std::string("space ") + space->getName();
            check_transform(where, space->getTransform(OCIO::COLORSPACE_DIR_TO_REFERENCE));
            check_transform(where, space->getTransform(OCIO::COLORSPACE_DIR_FROM_REFERENCE));
            if (space->isData() || !config_->hasRole("scene_linear") || ++count > kMostTried)
                continue;
            // Tests both directions: a missing table, or a matrix without an inverse.
            const auto build = [&](const char* from, const char* to, const char* way) {
                try {
                    (void)config_->getProcessor(from, to)->getDefaultCPUProcessor();
                } catch (const OCIO::Exception& e) {
                    add(way[0] == 't' ? Level::error : Level::note, where,
                        std::string(way) + ": " + one_line(e.what()));
                }
            };
            const bool is_forward_only = !space->getTransform(OCIO::COLORSPACE_DIR_TO_REFERENCE) &&
                                         space->getTransform(OCIO::COLORSPACE_DIR_FROM_REFERENCE);
            if (is_forward_only) {
                build("scene_linear", space->getName(), "to it from scene_linear");
                build(space->getName(), "scene_linear", "from it to scene_linear");
            } else {
                build(space->getName(), "scene_linear", "to scene_linear");
                build("scene_linear", space->getName(), "from scene_linear");
            }
        }
        for (int i = 0; i < config_->getNumViewTransforms(); ++i) {
            const char* name = config_->getViewTransformNameByIndex(i);
            if (const auto transform = config_->getViewTransform(name)) {
                check_transform(std::string("view transform ") + name,
                                transform->getTransform(OCIO::VIEWTRANSFORM_DIR_FROM_REFERENCE));
            }
        }
        for (int i = 0; i < config_->getNumLooks(); ++i) {
            const char* name = config_->getLookNameByIndex(i);
            if (const auto look = config_->getLook(name))
                check_transform(std::string("look ") + name, look->getTransform());
        }
    }

    void check_displays() {
        if (config_->getNumDisplays() == 0) add(Level::error, "config", "has no display");
        for (int d = 0; d < config_->getNumDisplays(); ++d) {
            const char* display = config_->getDisplay(d);
            if (config_->getNumViews(display) == 0)
                add(Level::warning, std::string("display ") + display, "has no active view");
            for (int v = 0; v < config_->getNumViews(display); ++v)
                check_view(display, config_->getView(display, v));
        }
    }

    void check_view(const std::string& display, const std::string& view) {
        const std::string where = "view " + display + " / " + view;
        const char* transform = config_->getDisplayViewTransformName(display.c_str(), view.c_str());
        std::string space_name =
            config_->getDisplayViewColorSpaceName(display.c_str(), view.c_str());
        if (space_name == OCIO::OCIO_VIEW_USE_DISPLAY_NAME) space_name = display;
        const auto space = spaces_.find(space_name);
        if (!space) {
            add(Level::error, where, "its space " + space_name + " is not in the config");
            return;
        }
        if (space->isData()) return;
        if (!transform || !*transform) {
            add(Level::warning, where,
                "has no view transform: applications cannot show it on another display, nor in "
                "HDR");
        } else if (space->getReferenceSpaceType() != OCIO::REFERENCE_SPACE_DISPLAY) {
            add(Level::error, where, "its space " + space_name + " is no display space");
        }
        try {
            const OCIO::ConstProcessorRcPtr processor = config_->getProcessor(
                "scene_linear", display.c_str(), view.c_str(), OCIO::TRANSFORM_DIR_FORWARD);
            check_numbers(where, processor);
            if (with_gpu_ && OcioGpu::unavailable_reason().empty()) check_gpu(where, processor);
        } catch (const OCIO::Exception& e) {
            add(Level::error, where, one_line(e.what()));
        }
    }

    void check_numbers(const std::string& where, const OCIO::ConstProcessorRcPtr& processor) {
        constexpr float nan = std::numeric_limits<float>::quiet_NaN();
        constexpr float inf = std::numeric_limits<float>::infinity();
        struct Probe {
            const char* what;
            std::array<float, 3> rgb;
        };
        const std::array<Probe, 5> probes = {{{"NaN", {nan, 0.18F, 0.18F}},
                                              {"+inf", {inf, 0.18F, 0.18F}},
                                              {"-inf", {-inf, 0.18F, 0.18F}},
                                              {"a negative channel", {-0.05F, 0.3F, 0.6F}},
                                              {"65504", {65504, 65504, 65504}}}};
        const OcioCpu cpu(processor);
        std::string not_finite;
        std::string outside;
        for (const Probe& probe : probes) {
            std::array<float, 3> out{};
            cpu.run_rgb(probe.rgb.data(), out.data(), 1);
            bool is_finite = true;
            bool is_inside = true;
            for (const float x : out) {
                is_finite = is_finite && std::isfinite(x);
                is_inside = is_inside && x >= -1e-4F && x <= 1 + 1e-4F;
            }
            if (!is_finite) {
                not_finite += (not_finite.empty() ? "" : ", ") + std::string(probe.what);
            } else if (!is_inside) {
                outside += (outside.empty() ? "" : ", ") + std::string(probe.what);
            }
        }
        if (!not_finite.empty())
            add(Level::warning, where, "NaN or infinities come out of " + not_finite);
        if (!outside.empty())
            add(Level::note, where, "codes outside of [0, 1] come out of " + outside);
    }

    void check_gpu(const std::string& where, const OCIO::ConstProcessorRcPtr& processor) {
        std::vector<float> in;
        for (int i = 0; i < 512; ++i) {  // by turns gray and colored, 14 stops
            const float light = 0.18F * std::exp2(static_cast<float>(i) / 36 - 8);
            const bool is_gray = i % 2 == 0;
            in.push_back(light);
            in.push_back(is_gray ? light : light * 0.2F);
            in.push_back(is_gray || i % 4 == 1 ? light : light * 0.05F);
        }
        std::vector<float> cpu(in.size());
        std::vector<float> gpu(in.size());
        try {
            OcioCpu(processor).run_rgb(in.data(), cpu.data(), in.size() / 3);
            OcioGpu(processor).run_rgb(in.data(), gpu.data(), in.size() / 3);
        } catch (const Error& e) {
            add(Level::warning, where, std::string("cannot run on a GPU: ") + e.what());
            return;
        }
        float largest = 0;
        for (std::size_t i = 0; i < in.size(); ++i)
            largest = std::max(largest, std::fabs(cpu[i] - gpu[i]));
        constexpr float kCode = 1.0F / 1023;
        if (largest > kCode) {
            add(Level::warning, where,
                fmt::format("its GPU path is {:.1e} from its CPU path: {:.0f} codes of 10 bits",
                            static_cast<double>(largest), static_cast<double>(largest / kCode)));
        }
    }

    std::string path_;
    bool with_gpu_;
    OCIO::ConstConfigRcPtr config_;
    SpaceIndex spaces_;
    std::vector<LintFinding> findings_;
};

}  // namespace

std::vector<LintFinding> lint_config(const std::string& path, bool with_gpu) {
    return Linter(path, with_gpu).run();
}

TONEWRIGHT_NAMESPACE_END
