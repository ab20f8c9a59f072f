// SPDX-License-Identifier: Apache-2.0
#include "picture/layers.h"

#include <algorithm>
#include <array>
#include <cctype>

#include "base/strings.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

constexpr std::array<std::string_view, 4> kRoles = {"r", "g", "b", "a"};
constexpr std::array<std::string_view, 4> kLongRoles = {"red", "green", "blue", "alpha"};

/// The last part of a channel's name as 0 to 3 for red, green, blue and alpha; else -1.
int role_of(std::string_view part) {
    const std::string name = lowercase(part);
    for (std::size_t i = 0; i < kRoles.size(); ++i) {
        if (name == kRoles[i] || name == kLongRoles[i]) return static_cast<int>(i);
    }
    return -1;
}

/// Parts of a name: at `.`, `_`, `:`, blanks, and where a small letter is followed by a capital.
/// Digits at their ends are left out: "CryptoObject00" is crypto, object.
std::vector<std::string> words_of(std::string_view name) {
    std::vector<std::string> words(1);
    char before = ' ';
    for (const char c : name) {
        const auto u = static_cast<unsigned char>(c);
        if (std::isalnum(u) == 0) {
            words.emplace_back();
        } else {
            if (std::isupper(u) != 0 && std::islower(static_cast<unsigned char>(before)) != 0)
                words.emplace_back();
            if (std::isdigit(u) == 0) words.back() += static_cast<char>(std::tolower(u));
        }
        before = c;
    }
    std::erase(words, std::string());
    return words;
}

std::string last_part(std::string_view name) {
    const std::size_t dot = name.rfind('.');
    return std::string(dot == std::string_view::npos ? name : name.substr(dot + 1));
}

}  // namespace

std::vector<Layer> color_layers(const PictureSpec& spec) {
    struct Group {
        std::string name;
        std::array<int, 4> of_role = {-1, -1, -1, -1};
    };
    std::vector<Group> groups;
    for (int c = 0; c < spec.nchannels && c < static_cast<int>(spec.channelnames.size()); ++c) {
        const std::string& full = spec.channelnames[static_cast<std::size_t>(c)];
        const std::size_t dot = full.rfind('.');
        const std::string name = dot == std::string::npos ? std::string() : full.substr(0, dot);
        const int role =
            role_of(dot == std::string::npos ? full : std::string_view(full).substr(dot + 1));
        if (role < 0) continue;
        auto group = std::find_if(groups.begin(), groups.end(),
                                  [&](const Group& g) { return g.name == name; });
        if (group == groups.end()) group = groups.insert(groups.end(), {name});
        int& index = group->of_role[static_cast<std::size_t>(role)];
        if (index < 0) index = c;
    }
    std::vector<Layer> layers;
    for (const Group& group : groups) {
        const auto& [r, g, b, a] = group.of_role;
        if (r < 0 || g < 0 || b < 0) continue;
        layers.push_back({group.name, {r, g, b}});
        if (a >= 0) layers.back().channels.push_back(a);
    }
    return layers;
}

bool is_data_layer(std::string_view name) {
    // Words of Blender, Arnold, RenderMan, V-Ray, Redshift, Cycles, Karma, Octane and Corona.
    constexpr std::array<std::string_view, 37> kData = {
        "ao",        "occlusion", "depth",   "z",      "zdepth",      "normal",    "normals",
        "n",         "position",  "p",       "pref",   "world",       "vector",    "motion",
        "velocity",  "mv",        "speed",   "crypto", "cryptomatte", "matte",     "mask",
        "id",        "index",     "uv",      "st",     "mist",        "object",    "material",
        "asset",     "variance",  "samples", "count",  "tangent",     "denoising", "debug",
        "wireframe", "coverage"};
    const std::vector<std::string> words = words_of(name);
    return std::any_of(words.begin(), words.end(), [&](const std::string& word) {
        return std::find(kData.begin(), kData.end(), word) != kData.end();
    });
}

const Layer* picture_layer(const std::vector<Layer>& layers) {
    for (const Layer& layer : layers) {
        if (layer.name.empty()) return &layer;
    }
    constexpr std::array<std::string_view, 10> kPictures = {
        "combined", "beauty", "rgba", "rgb", "composite", "ci", "c", "final", "color", "main"};
    for (const std::string_view requested : kPictures) {
        for (const Layer& layer : layers) {
            if (lowercase(last_part(layer.name)) == requested) return &layer;
        }
    }
    for (const Layer& layer : layers) {
        if (!is_data_layer(layer.name)) return &layer;
    }
    return nullptr;
}

const Layer* find_layer(const std::vector<Layer>& layers, std::string_view name) {
    const std::string requested = lowercase(name);
    const Layer* found = nullptr;
    for (const Layer& layer : layers) {
        const std::string full = lowercase(layer.name);
        if (full == requested || (full.empty() && (requested == "rgb" || requested == "rgba")))
            return &layer;
        if (!full.ends_with("." + requested)) continue;
        if (found) return nullptr;
        found = &layer;
    }
    return found;
}

std::vector<int> order_of(const Layer& layer, const PictureSpec& spec) {
    std::vector<int> order = layer.channels;
    for (int c = 0; c < spec.nchannels; ++c) {
        if (std::find(order.begin(), order.end(), c) == order.end()) order.push_back(c);
    }
    return order;
}

void reorder(PictureSpec& spec, const std::vector<int>& channels, bool has_alpha) {
    const std::vector<std::string> names = spec.channelnames;
    const int depth = spec.z_channel;
    spec.nchannels = static_cast<int>(channels.size());
    spec.channelnames.clear();
    spec.z_channel = -1;
    for (std::size_t i = 0; i < channels.size(); ++i) {
        spec.channelnames.push_back(names[static_cast<std::size_t>(channels[i])]);
        if (channels[i] == depth) spec.z_channel = static_cast<int>(i);
    }
    // OpenImageIO takes the first alpha of the file, which may be another layer's.
    spec.alpha_channel = has_alpha ? 3 : -1;
    constexpr std::array kCapitals = {'R', 'G', 'B', 'A'};
    const std::size_t count = has_alpha ? 4 : 3;
    const bool has_name = spec.channelnames[0].find('.') != std::string::npos;
    for (std::size_t i = 0; !has_name && i < count; ++i)
        spec.channelnames[i] = std::string(1, kCapitals.at(i));
}

void reorder(const std::byte* from, int stored, const std::vector<int>& channels, std::size_t bytes,
             std::size_t pixels, std::byte* to) {
    const std::size_t step = bytes * static_cast<std::size_t>(stored);
    for (std::size_t i = 0; i < pixels; ++i, from += step) {
        for (const int c : channels)
            to = std::copy_n(from + static_cast<std::size_t>(c) * bytes, bytes, to);
    }
}

std::string layer_names(const std::vector<Layer>& layers) {
    constexpr std::size_t kMost = 8;
    std::string text;
    for (std::size_t i = 0; i < layers.size() && i < kMost; ++i) {
        if (i > 0) text += ", ";
        text += layers[i].name.empty() ? "RGB" : printable(layers[i].name);
    }
    return layers.size() > kMost ? text + ", ..." : text;
}

TONEWRIGHT_NAMESPACE_END
