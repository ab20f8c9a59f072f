// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "tonewright/generated_files.h"
#include "tonewright/registry.h"
#include "tonewright/view.h"

TONEWRIGHT_NAMESPACE_BEGIN

/// What goes into a config.
struct ConfigOptions {
    /// 2.0, 2.1 and 2.5: one file for each, with the same views. The first is `config.ocio`, the
    /// others `config-2.0.ocio` and so on.
    std::vector<std::string> profiles = {"2.1", "2.0", "2.5"};
    /// Names of views ("AgX", "AgX Punchy"), operators (`id`, `id:preset`), `all`, or `none` beside
    /// `custom`, in the order of the config; the first is what applications start with. Empty: the
    /// standard ones, without the HDR forms whose tables are largest.
    std::vector<std::string> views = {};
    /// Ids, titles or aliases. Empty: all.
    std::vector<std::string> displays = {};
    /// Names ("AgX - Punchy"). Empty: all of the views' operators; "none".
    std::vector<std::string> looks = {};
    /// Where applications compute: id of an input space.
    std::string working = "lin_rec709";
    /// Views of the user's own, behind the others.
    struct CustomView {
        std::string name;
        /// `id[:preset][:parameter=value...]`
        std::string op;
    };
    std::vector<CustomView> custom = {};
    /// Every view once more, with this many stops more light: "AgX +1 stop".
    std::vector<double> exposure_stops = {};
    /// Operators that the names above may stand for, and what reads LUTs.
    OperatorSet others = {};
};

/// An OpenColorIO config: `config.ocio` and one file for every other profile, `luts/*.clf` named by
/// their contents, `probe.csv` (expected code values for check_config.py), README.md, MANIFEST.csv.
/// Profile 2.5 adds what that OpenColorIO knows: interop ids, the ids of ACES Metadata Files, and
/// its own ACES 2.0 where the others have a cube.
///
/// Scene reference ACES2065-1, display reference CIE XYZ D65. Every view of an operator is a view
/// transform and a view of every display, and a color space for applications that know no views
/// ("Output - AgX - sRGB"); descriptions carry the measured error.
/// @throws Error  for unknown views, looks and displays, and for names that would break a host
/// (over
///                63 bytes, twice the same).
[[nodiscard]] TONEWRIGHT_API std::vector<GeneratedFile> make_config(
    const ConfigOptions& options = {});

/// What make_config() would throw for the options, before anything is computed or written.
TONEWRIGHT_API void check_config_options(const ConfigOptions& options);

/// What a config cannot do as `tonewright apply` does, one line each: operators that take numbers
/// from the picture have constants there.
/// @throws Error  as check_config_options()
[[nodiscard]] TONEWRIGHT_API std::vector<std::string> config_warnings(const ConfigOptions& options);

/// One view that was added to an existing config, and how far its code values are from the double
/// reference, for light of all of AP0.
struct ExtendedView {
    std::string display;
    std::string view;
    double max = 0;
    double p999 = 0;
};

/// A config that views were added to, or taken out of.
struct ExtendedConfig {
    /// Tables, by their paths beside the config; their names have a hash of their contents.
    std::vector<GeneratedFile> files;
    /// What a later update or removal needs to know, beside the config. An empty text: to be
    /// deleted.
    GeneratedFile record;
    /// Tables that nothing needs any more, by their paths beside the config.
    std::vector<std::string> unused_files;
    /// The config: the text that it was, byte for byte, with more in it or less.
    std::string text;
    /// Names of what was added, by its kind: "view transform", "look", "view", "color space".
    struct Added {
        std::string kind;
        std::vector<std::string> names;
    };
    std::vector<Added> added;
    /// Reads the config where it was written, its tables beside it: OpenColorIO takes it, every
    /// space and view that was there before makes the same numbers, and the new views are the
    /// operators. @throws Error  for what is not so.
    std::function<std::vector<ExtendedView>(const std::string& path)> check;
};

/// A user's config with more views, looks and output spaces, on those of its displays that are one
/// of ours by their numbers. All else in the file stays as it is, comments and order included.
/// @param options     views (empty beside custom: none), displays (of the config), looks, custom,
///                    exposure_stops
/// @param is_updated  take out what was added before; options that are all empty are those of then
/// @throws FileError  for a config that cannot be read
/// @throws Error  for a config without both interchange roles or such a display, for a name that is
///                taken
[[nodiscard]] TONEWRIGHT_API ExtendedConfig extend_config(const std::string& path,
                                                          const ConfigOptions& options,
                                                          bool is_updated = false);

/// The config without all that extend_config() added.
/// @throws FileError  for a config that cannot be read, that nothing was added to, or where what
///                    was added has been changed
[[nodiscard]] TONEWRIGHT_API ExtendedConfig reduce_config(const std::string& path);

/// Hands OpenColorIO's own messages to a function, each once and without its prefix, instead of
/// standard error: for all of the process, so for a program to call, not for a library.
TONEWRIGHT_API void redirect_opencolorio_messages(
    const std::function<void(const std::string&)>& print);

/// What the configs that make_config() writes are called inside.
inline constexpr const char* kConfigName = "tonewright";

/// What the config calls a view of an operator on a display: the operator's name, and where its
/// picture is brighter than white, its peak: "AgX - HDR 1000 nits".
/// @param name  the view's, on SDR displays
[[nodiscard]] TONEWRIGHT_API std::string config_view_name(const std::string& name,
                                                          const ResolvedOperator& op,
                                                          const Display& display);

/// The color space that is such a view, for write nodes: "Output - AgX - sRGB".
[[nodiscard]] TONEWRIGHT_API std::string output_space_name(const std::string& view,
                                                           const std::string& display);

/// Name of the config's space for an input space id: "lin_rec709" -> "Linear Rec.709". The config
/// has none for a camera's.
[[nodiscard]] TONEWRIGHT_API std::string config_space_name(std::string_view input_id);

TONEWRIGHT_NAMESPACE_END
