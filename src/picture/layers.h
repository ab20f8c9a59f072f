// SPDX-License-Identifier: Apache-2.0
//
// Layers of OpenEXR files: groups of channels with a common name, "ViewLayer.Combined.R".
#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

#include "picture/picture_spec.h"

TONEWRIGHT_NAMESPACE_BEGIN

/// A group of channels that holds a picture in color.
struct Layer {
    /// Common part of the names: "ViewLayer.Combined"; empty for R, G, B.
    std::string name;
    /// Indices of red, green, blue and, if the layer has it, alpha.
    std::vector<int> channels;
};

/// The layers in color, in the order of the file.
/// Names end in R, G, B; r, g, b; or red, green, blue, after a `.` or nothing.
[[nodiscard]] TONEWRIGHT_API std::vector<Layer> color_layers(const PictureSpec& spec);

/// True for names of layers that hold data and no picture: ambient occlusion, depth, normals,
/// positions, motion, cryptomattes, masks, object indices, UV coordinates.
[[nodiscard]] TONEWRIGHT_API bool is_data_layer(std::string_view name);

/// The layer that is the picture, or null if the file has none in color. The first of these that
/// exists: R, G, B; a layer with a name of renderers' pictures (Combined, beauty, rgba, ...); the
/// first layer that holds no data.
[[nodiscard]] TONEWRIGHT_API const Layer* picture_layer(const std::vector<Layer>& layers);

/// A layer by its name, or by the last parts of it ("Combined" of "ViewLayer.Combined"). Ignores
/// case. Null if there is none, or several.
[[nodiscard]] TONEWRIGHT_API const Layer* find_layer(const std::vector<Layer>& layers,
                                                     std::string_view name);

/// Channels with those of a layer first, and all others in their order.
[[nodiscard]] TONEWRIGHT_API std::vector<int> order_of(const Layer& layer, const PictureSpec& spec);
/// The names and special channels of a spec in another order. Red, green, blue and alpha of a layer
/// without a name get capital letters, which other programs look for.
/// @param channels   that stay, in their new order
/// @param has_alpha  the fourth is alpha; else none of the first is
TONEWRIGHT_API void reorder(PictureSpec& spec, const std::vector<int>& channels, bool has_alpha);
/// Pixels in that order. `from` and `to` do not overlap.
/// @param stored  channels of `from`
/// @param bytes   of a sample
TONEWRIGHT_API void reorder(const std::byte* from, int stored, const std::vector<int>& channels,
                            std::size_t bytes, std::size_t pixels, std::byte* to);

/// The names, for messages: "RGB, AO, ViewLayer.Combined"; long lists end in "...".
[[nodiscard]] TONEWRIGHT_API std::string layer_names(const std::vector<Layer>& layers);

TONEWRIGHT_NAMESPACE_END
