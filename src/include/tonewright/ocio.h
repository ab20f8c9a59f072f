// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "tonewright/generated_files.h"
#include "tonewright/registry.h"
#include "tonewright/view.h"

TONEWRIGHT_NAMESPACE_BEGIN

/// Contents of a config.
struct ConfigOptions {
    /// 2.0, 2.1 and 2.5: one file for each, with the same views. The first is `config.ocio`, the
    /// others `config-2.0.ocio` and so on.
    std::vector<std::string> profiles = {"2.1", "2.0", "2.5"};
    /// Names of views ("AgX", "AgX Punchy"), operators (`id`, `id:preset`), `all`, or `none` for
    /// `custom` only, in the order of the config. The first is the default view. Empty: the
    /// standard views, without the HDR versions that have the largest tables.
    std::vector<std::string> views = {};
    /// Ids, titles or aliases. Empty: all.
    std::vector<std::string> displays = {};
    /// Names ("AgX - Punchy"). Empty: all looks of the views' operators. "none": no looks.
    std::vector<std::string> looks = {};
    /// Working space of applications: id of an input space.
    std::string working = "lin_rec709";
    /// Custom views, after the others.
    struct CustomView {
        std::string name;
        ResolvedOperator op;
    };
    std::vector<CustomView> custom = {};
    /// Adds every view again with these exposures, in stops: "AgX +1 stop".
    std::vector<double> exposure_stops = {};
    /// Operators that `views` may name, and the reader of LUTs.
    OperatorSet others = {};
    /// Folder that keeps fitted 3D LUTs, at most 256 MiB; empty: nothing is stored.
    std::string cache_folder = {};
};

struct ConfigModel;

/// Contents of a config after its names are resolved. Files of operators are read here, and not
/// again.
class TONEWRIGHT_API ConfigPlan {
  public:
    /// @throws Error      unknown views, looks and displays, and names that break applications
    ///                    (over 63 bytes, or duplicates)
    /// @throws FileError  a file of an operator cannot be read
    explicit ConfigPlan(const ConfigOptions& options = {});

    /// Differences between the config and `tonewright apply`, one line each: operators that take
    /// numbers from the picture have constants in a config. @see render
    [[nodiscard]] std::vector<std::string> warnings() const;

    [[nodiscard]] const ConfigModel& model() const { return *model_; }
    [[nodiscard]] const std::vector<std::string>& profiles() const { return profiles_; }

  private:
    std::shared_ptr<const ConfigModel> model_;
    std::vector<std::string> profiles_;
};

/// An OpenColorIO config: `config.ocio` and one file for every other profile, `luts/*.clf`,
/// `probe.csv` (expected code values for check_config.py), README.md, MANIFEST.csv. Profile 2.5
/// adds interop ids, the ids of ACES Metadata Files, and OpenColorIO's own ACES 2.0 instead of a 3D
/// LUT.
///
/// Scene reference ACES2065-1, display reference CIE XYZ D65. Every view of an operator is a view
/// transform and a view of every display. It is also a color space for applications that do not
/// support views ("Output - AgX - sRGB"). Descriptions have the measured error.
[[nodiscard]] TONEWRIGHT_API std::vector<GeneratedFile> make_config(const ConfigPlan& plan);
/// The same of a new plan. @throws Error  @see ConfigPlan
[[nodiscard]] TONEWRIGHT_API std::vector<GeneratedFile> make_config(
    const ConfigOptions& options = {});

/// A view that was added to an existing config, and its errors against the double reference, over
/// all of AP0.
struct ExtendedView {
    std::string display;
    std::string view;
    double max = 0;
    double p999 = 0;
};

/// A change of an existing config.
struct ConfigChange {
    enum class Kind : unsigned char {
        add,
        update,  ///< removes the earlier additions first; without options, repeats them
        remove,  ///< removes everything that was added; takes no views
    };
    Kind kind = Kind::add;
    /// Views (empty, if there are custom ones: none), displays (of the config), looks, custom
    /// views, exposures, `others` and `cache_folder`. The rest does not count.
    ConfigOptions options = {};
    /// Keeps the old config as PATH.bak, or under the first such name with a number that is free.
    bool has_backup = false;
    /// Receives warnings, one line each, before anything is written. @see render. What it throws
    /// ends the change. Null: none.
    std::function<void(const std::string& line)> warn = {};
};

/// An existing config that was changed.
struct ChangedConfig {
    /// The file that was replaced: the given name, or the file that this symbolic link leads to.
    std::string path;
    /// Empty: none.
    std::string backup = {};
    /// OpenColorIO looks for tables beside the name that it opens: new symbolic links to their
    /// folder.
    struct Link {
        std::string path;
        std::string target;
    };
    std::vector<Link> links = {};
    /// Names of the added items, by kind: "view transform", "look", "view", "color space".
    struct Added {
        std::string kind;
        std::vector<std::string> names;
    };
    std::vector<Added> added = {};
    /// The folder of the tables beside the config, and the count of those that no view uses and
    /// that are gone.
    std::string folder;
    std::size_t removed_tables = 0;
    /// Errors of the added views. Empty after `remove`, and if the linked OpenColorIO cannot read
    /// the config's profile.
    std::vector<ExtendedView> views = {};
};

/// Adds views, looks and output spaces to a user's config, on its displays whose numbers match one
/// of Tonewright's, or removes them. The rest of the file stays as it is, with comments and order.
/// Tables go to a folder beside it.
///
/// The config is replaced after all checks: OpenColorIO accepts the new one, all old spaces and
/// views give the same numbers, and the new views match the operators. Until then the old one
/// stays, also if the process is killed.
/// @throws FileError  the config cannot be read or written, OpenColorIO refuses it, or it lacks an
///                    interchange role, a space or such a display; `update` and `remove`: nothing
///                    was added to it, or an added text was edited
/// @throws Error      an option is wrong, a name is taken, or a check fails
TONEWRIGHT_API ChangedConfig change_config(const std::string& path, const ConfigChange& change);

/// Passes OpenColorIO's messages to a function instead of standard error, each once and without its
/// prefix. This changes the whole process. Programs may call it; libraries should not.
TONEWRIGHT_API void redirect_opencolorio_messages(
    const std::function<void(const std::string&)>& print);

/// The `name` of the configs that make_config() writes.
inline constexpr const char* kConfigName = "tonewright";

/// The name of a view on a display: the view's name and, for an HDR version, its peak: "AgX - HDR
/// 1000 nits".
/// @param name  of the view, on SDR displays
[[nodiscard]] TONEWRIGHT_API std::string config_view_name(const std::string& name,
                                                          const ResolvedOperator& op,
                                                          const Display& display);

/// The name of the color space of such a view, for write nodes: "Output - AgX - sRGB".
[[nodiscard]] TONEWRIGHT_API std::string output_space_name(const std::string& view,
                                                           const std::string& display);

/// Name of the config's space for an input space id: "lin_rec709" -> "Linear Rec.709". The config
/// has no linear spaces of cameras.
[[nodiscard]] TONEWRIGHT_API std::string config_space_name(std::string_view input_id);

TONEWRIGHT_NAMESPACE_END
