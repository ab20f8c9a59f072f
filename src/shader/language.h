// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <string>

#include "tonewright/shader.h"

TONEWRIGHT_NAMESPACE_BEGIN

struct TextureForm;

/// Facts about a language for the printer. Patterns use fmt with named fields.
struct LanguageFacts {
    ShaderLanguage language;
    const char* number;  // the type of a number, of a color, ...
    const char* color;
    const char* boolean;
    const char* integer;
    const char* suffix;      // of a literal
    bool is_double;          // numbers have 64 bits
    const char* make_color;  // of three numbers
    std::array<const char*, 3> channel;
    const char* before_function;
    const char* function;    // {result}, {name}, {parameters}
    const char* parameter;   // {type}, {name}
    const char* let;         // {type}, {name}, {value}
    const char* variable;    // the same
    const char* loop;        // {count}; the counter is i
    const char* choose;      // {condition}, {yes}, {no}
    const char* to_integer;  // {value}
    const char* to_number;   // {value}
    const char* half;        // of a whole {value}, rounded down
    const char* array;       // {name}, {count}, {values}
    bool has_textures;
    bool prefers_formula;  // to textures of 3D LUTs
    bool is_for_grids;     // textures hold nodes of 3D LUTs; 1D tables have `tables`
    bool has_one_texture;  // at most
    /// The texture of all 1D tables in a file for an application; null: there is none.
    const TextureForm* tables;
    bool holds_halves;  // as texels
    const char* texel;  // in words
    /// Declaration of a 3D texture with {name} and {binding}.
    const char* texture;
    /// Type and name of a texture as an argument; empty: functions read it without.
    const char* texture_parameter;
    std::size_t first_binding;
    const char* fetch;  // of a texture's {name} at {x}, {y}, {z}: a color, or more than that
    const char* color_of_fetch;  // after it
    /// Comments on how to create the texture from its file. {name}, {width}, {height}, {depth},
    /// {pitch}, {edge}.
    const char* loader;
    /// Largest array for a text of the language.
    std::size_t largest_array;
    /// Arrays are local to the function that reads them.
    bool has_local_arrays;
    /// min, max and clamp take colors, `*` takes a color and a number.
    bool has_color_math;
    const char* splat;    // a color of one {value}; read where it has color math
    const char* product;  // of two colors {a}, {b}: their dot product; empty: there is none
    const char* minimum;
    const char* maximum;
    const char* absolute;
    const char* square_root;
    const char* exp2;  // empty: there is none, and 2 is raised
    const char* log2;
    const char* power;
    const char* sine;
    const char* cosine;
    const char* atan2;
    const char* floor;
    /// First lines of the text.
    const char* prologue;
    enum class Entry : unsigned char { function, pointers, shader } entry;
};

[[nodiscard]] const LanguageFacts& facts_of(ShaderLanguage language);

/// The shortest decimal that reads back as the same float, with a point.
[[nodiscard]] std::string float_literal(double value, const LanguageFacts& language);

TONEWRIGHT_NAMESPACE_END
