// SPDX-License-Identifier: Apache-2.0
#include "ocio/references.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <set>

#include "base/input_file.h"
#include "base/strings.h"
#include "lut/lut_text.h"
#include "lut/table_file.h"
#include "tonewright/error.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

/// Each level of a reference is several nested calls in OpenColorIO; real configs have five.
constexpr std::size_t kDeepest = 100;

/// Walks like OpenColorIO when it collects the variables of a processor: through all transforms of
/// a space, look or view, needed or not.
class ReferenceWalk {
  public:
    ReferenceWalk(const OCIO::Config& config, const std::string& path)
        : config_(config), path_(path), spaces_(config) {}

    void run() {
        for (const auto& space : spaces_.all())
            visit_space(space->getName());
        for (int i = 0; i < config_.getNumLooks(); ++i)
            visit_look(config_.getLookNameByIndex(i));
        for (int i = 0; i < config_.getNumViewTransforms(); ++i)
            visit_view_transform(config_.getViewTransformNameByIndex(i));
        for (int d = 0; d < config_.getNumDisplaysAll(); ++d) {
            const std::string display = config_.getDisplayAll(d);
            for (const OCIO::ViewType type : {OCIO::VIEW_SHARED, OCIO::VIEW_DISPLAY_DEFINED}) {
                for (int v = 0; v < config_.getNumViews(type, display.c_str()); ++v)
                    visit_view(display, config_.getView(type, display.c_str(), v));
            }
        }
    }

  private:
    /// @param key    key that is visited once
    /// @param title  for the message
    template <class Children>
    void visit(const std::string& key, const std::string& title, const Children& children) {
        if (done_.contains(key)) return;
        const auto open = std::find_if(open_.begin(), open_.end(),
                                       [&](const auto& entry) { return entry.first == key; });
        if (open != open_.end()) {
            std::vector<std::string> names;
            for (auto it = open; it != open_.end(); ++it)
                names.push_back(it->second);
            names.push_back(title);
            throw FileError(
                fmt::format("read: {}: references form a cycle: {}", path_,
                            one_line(fmt::format("{}", fmt::join(names, " -> ")), 300)));
        }
        if (open_.size() >= kDeepest) {
            throw FileError(fmt::format("read: {}: {} refers to others more than {} deep", path_,
                                        one_line(open_.front().second, 100), kDeepest));
        }
        open_.emplace_back(key, title);
        children();
        open_.pop_back();
        done_.insert(key);
    }

    void visit_space(const std::string& name) {
        const auto space = spaces_.find(resolved(name.c_str()));
        if (!space) return;
        visit("space " + lowercase(space->getName()),
              std::string("color space ") + space->getName(), [&] {
                  for (const auto way :
                       {OCIO::COLORSPACE_DIR_TO_REFERENCE, OCIO::COLORSPACE_DIR_FROM_REFERENCE})
                      visit_transforms(space->getTransform(way));
              });
    }

    void visit_look(const std::string& name) {
        const auto look = config_.getLook(name.c_str());
        if (!look) return;
        visit("look " + lowercase(name), "look " + name, [&] {
            visit_space(look->getProcessSpace());
            visit_transforms(look->getTransform());
            visit_transforms(look->getInverseTransform());
        });
    }

    /// "a, +b, -c | d"
    void visit_looks(const std::string& list) {
        std::string text = resolved(list.c_str());
        std::replace(text.begin(), text.end(), '|', ',');
        for (std::size_t begin = 0; begin <= text.size();) {
            const std::size_t end = std::min(text.find(',', begin), text.size());
            std::string_view name = trimmed(std::string_view(text).substr(begin, end - begin));
            if (!name.empty() && (name.front() == '+' || name.front() == '-'))
                name = trimmed(name.substr(1));
            if (!name.empty()) visit_look(std::string(name));
            begin = end + 1;
        }
    }

    void visit_view_transform(const std::string& name) {
        const auto transform = config_.getViewTransform(name.c_str());
        if (!transform) return;
        visit("view transform " + lowercase(name), "view transform " + name, [&] {
            for (const auto way :
                 {OCIO::VIEWTRANSFORM_DIR_FROM_REFERENCE, OCIO::VIEWTRANSFORM_DIR_TO_REFERENCE})
                visit_transforms(transform->getTransform(way));
        });
    }

    void visit_view(const std::string& display, const std::string& view) {
        const char* d = display.c_str();
        const char* v = view.c_str();
        visit(fmt::format("view {} / {}", lowercase(display), lowercase(view)),
              fmt::format("view {} / {}", display, view), [&] {
                  visit_looks(config_.getDisplayViewLooks(d, v));
                  const char* transform = config_.getDisplayViewTransformName(d, v);
                  if (transform && *transform) visit_view_transform(transform);
                  std::string space = config_.getDisplayViewColorSpaceName(d, v);
                  if (space == OCIO::OCIO_VIEW_USE_DISPLAY_NAME) space = display;
                  visit_space(space);
              });
    }

    void visit_transforms(const OCIO::ConstTransformRcPtr& tree) {
        for_each_transform(tree, [&](const OCIO::ConstTransformRcPtr& part) {
            if (const auto conversion =
                    OCIO_DYNAMIC_POINTER_CAST<const OCIO::ColorSpaceTransform>(part)) {
                visit_space(conversion->getSrc());
                visit_space(conversion->getDst());
            } else if (const auto look =
                           OCIO_DYNAMIC_POINTER_CAST<const OCIO::LookTransform>(part)) {
                visit_space(look->getSrc());
                visit_space(look->getDst());
                visit_looks(look->getLooks());
            } else if (const auto shown =
                           OCIO_DYNAMIC_POINTER_CAST<const OCIO::DisplayViewTransform>(part)) {
                visit_space(shown->getSrc());
                visit_view(resolved(shown->getDisplay()), resolved(shown->getView()));
            } else if (const auto file =
                           OCIO_DYNAMIC_POINTER_CAST<const OCIO::FileTransform>(part)) {
                check_file(file->getSrc());
            }
        });
    }

    void check_file(const std::string& source) {
        if (!files_.insert(source).second) return;
        try {
            const std::string file =
                config_.getCurrentContext()->resolveFileLocation(source.c_str());
            require_regular_file(file);
            const auto ignore = [](const Problem& why) {
                throw OCIO::Exception(why.value.c_str());
            };
            check_lut_words(file, read_file(file, kLargestLutFile, ignore));
        } catch (const OCIO::Exception&) {
            return;  // missing or unreadable: OpenColorIO reports it at its use
        } catch (const FileError& e) {
            throw FileError(fmt::format("{} ({} uses it as a LUT)", e.text(), path_));
        }
    }

    /// With the config's variables.
    [[nodiscard]] std::string resolved(const char* name) const {
        return config_.getCurrentContext()->resolveStringVar(name);
    }

    const OCIO::Config& config_;
    const std::string& path_;
    SpaceIndex spaces_;
    std::set<std::string> done_;
    std::vector<std::pair<std::string, std::string>> open_;
    std::set<std::string> files_;
};

}  // namespace

SpaceIndex::SpaceIndex(const OCIO::Config& config) {
    const int count =
        config.getNumColorSpaces(OCIO::SEARCH_REFERENCE_SPACE_ALL, OCIO::COLORSPACE_ALL);
    for (int i = 0; i < count; ++i) {
        const char* name = config.getColorSpaceNameByIndex(OCIO::SEARCH_REFERENCE_SPACE_ALL,
                                                           OCIO::COLORSPACE_ALL, i);
        const OCIO::ConstColorSpaceRcPtr space = config.getColorSpace(name);
        if (!space) continue;
        all_.push_back(space);
        by_name_.emplace(lowercase(space->getName()), space);
        for (std::size_t a = 0; a < space->getNumAliases(); ++a)
            by_name_.emplace(lowercase(space->getAlias(a)), space);
    }
    for (int i = 0; i < config.getNumRoles(); ++i) {
        const char* role = config.getRoleName(i);
        if (const auto space = config.getColorSpace(role)) by_name_.emplace(lowercase(role), space);
    }
}

OCIO::ConstColorSpaceRcPtr SpaceIndex::find(std::string_view name) const {
    const auto found = by_name_.find(lowercase(name));
    return found == by_name_.end() ? nullptr : found->second;
}

void for_each_transform(const OCIO::ConstTransformRcPtr& transform,
                        const std::function<void(const OCIO::ConstTransformRcPtr&)>& visit) {
    if (!transform) return;
    visit(transform);
    if (const auto group = OCIO_DYNAMIC_POINTER_CAST<const OCIO::GroupTransform>(transform)) {
        for (int i = 0; i < group->getNumTransforms(); ++i)
            for_each_transform(group->getTransform(i), visit);
    }
}

void check_references(const OCIO::Config& config, const std::string& path) {
    ReferenceWalk(config, path).run();
}

TONEWRIGHT_NAMESPACE_END
