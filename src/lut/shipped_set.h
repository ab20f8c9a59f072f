// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <functional>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "tonewright/generated_files.h"
#include "tonewright/lut.h"
#include "tonewright/lut_applications.h"

TONEWRIGHT_NAMESPACE_BEGIN

/// A preset set of `bake --all`: the LUTs of one application.
struct LutPresetSet {
    const LutApplication* host = nullptr;
    /// Further applications that can use the same files.
    std::string also = {};
    std::vector<std::string> operators;
    /// Replaces the application's size.
    std::optional<int> size = {};
    /// Sizes of single operators.
    std::map<std::string, int> sizes = {};
    /// Operators whose LUT does not follow them in saturated lamps, @see follows_operator().
    std::set<std::string> approximate = {};
    /// Advice about LUTs that are nearer to the operators: the rest of a sentence that begins with
    /// "Nearer: ".
    std::string nearer = {};
    /// Replaces the application's display.
    std::string display = {};
};
[[nodiscard]] TONEWRIGHT_API const std::vector<LutPresetSet>& lut_preset_sets();

/// @throws Error  this application has no preset set
TONEWRIGHT_API void require_preset_set(const std::string& application);

/// A LUT of the set.
struct ShippedLut {
    const LutPresetSet* set = nullptr;
    LutRequest request;
    /// In the set's folder: `resolve/agx_blender_davinci_to_rec1886.cube`.
    std::string path;
    /// The test chart through this LUT.
    std::string thumbnail;
    Lut lut;
    bool is_fitted = false;
    LutError tetrahedral;
    LutError trilinear;
    /// Error with the interpolation of its application.
    LutRinging ringing;
    /// Contents of the file. Empty for a picture, which OpenImageIO writes.
    std::string contents;
};

/// The LUTs of bake_shipped_luts() in the same order, without tables and measurements.
[[nodiscard]] TONEWRIGHT_API std::vector<ShippedLut> plan_shipped_luts(
    const std::string& application = {});
TONEWRIGHT_API void bake_shipped_lut(ShippedLut& planned);

/// Bakes all of them, in the order of lut_preset_sets(). The same on every run, for any number of
/// threads.
/// @param application  only its preset set; empty: all sets
/// @param progress     receives the number of baked LUTs and of all, from one thread at a time
/// @throws Error  the application has no set
[[nodiscard]] TONEWRIGHT_API std::vector<ShippedLut> bake_shipped_luts(
    const std::string& application = {},
    const std::function<void(std::size_t done, std::size_t total)>& progress = {});

/// README.md and MANIFEST.csv, for LUTs that have contents.
[[nodiscard]] TONEWRIGHT_API std::vector<GeneratedFile> describe_shipped_luts(
    const std::vector<ShippedLut>& luts);

TONEWRIGHT_NAMESPACE_END
