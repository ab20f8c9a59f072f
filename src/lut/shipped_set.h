// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "tonewright/generated_files.h"
#include "tonewright/lut.h"
#include "tonewright/lut_applications.h"

TONEWRIGHT_NAMESPACE_BEGIN

/// Of the set of `bake --all`: the LUTs of one application.
struct LutPresetSet {
    const LutApplication* host = nullptr;
    /// Applications that the same files suit.
    std::string also;
    /// Those whose LUT follows them in saturated lights, @see follows_operator(). The others ring.
    std::vector<std::string> operators;
    /// Instead of the host's, where fewer are enough.
    std::optional<int> size;
    /// By operator: the nodes a side that it takes not to ring, where the size above is too small.
    std::map<std::string, int> larger_sizes = {};
};
[[nodiscard]] TONEWRIGHT_API const std::vector<LutPresetSet>& lut_preset_sets();

/// @throws Error  no set is for this application
TONEWRIGHT_API void require_preset_set(const std::string& application);

/// A LUT of the set.
struct ShippedLut {
    const LutPresetSet* set = nullptr;
    LutRequest request;
    /// In the set's folder: `resolve/agx_blender_davinci_to_rec1886.cube`.
    std::string path;
    /// What the chart looks like through it.
    std::string thumbnail;
    Lut lut;
    bool is_fitted = false;
    LutError tetrahedral;
    LutError trilinear;
    /// As its application interpolates.
    LutRinging ringing;
    /// The file. Empty for a picture, which OpenImageIO writes.
    std::string contents;
};

/// What bake_shipped_luts() makes, in its order: all but the tables and what is measured of them.
[[nodiscard]] TONEWRIGHT_API std::vector<ShippedLut> plan_shipped_luts(
    const std::string& application = {});
TONEWRIGHT_API void bake_shipped_lut(ShippedLut& planned);

/// All of them, in the order of lut_preset_sets(). The same on every run, whatever the number of
/// threads.
/// @param application  only those of its set; empty: of all
/// @throws Error  the application has no set
[[nodiscard]] TONEWRIGHT_API std::vector<ShippedLut> bake_shipped_luts(
    const std::string& application = {});

/// README.md and MANIFEST.csv, of LUTs that all have their contents.
[[nodiscard]] TONEWRIGHT_API std::vector<GeneratedFile> describe_shipped_luts(
    const std::vector<ShippedLut>& luts);

TONEWRIGHT_NAMESPACE_END
