// SPDX-License-Identifier: Apache-2.0
//
// Writes the nodes of the default operator's 3D LUT as C++ source. The build runs it and compiles
// the file into the library, so that no start computes these nodes.
//   write_nodes FILE
#include <cstdio>
#include <string>
#include <vector>

#include "operators/agx_cube.h"

namespace {

/// The bytes as a string literal, which compilers read faster than a list of numbers.
std::string text_of(const std::vector<double>& numbers) {
    std::string text =
        "// Written by tools/write_nodes.cpp.\n"
        "#include \"operators/agx_nodes.h\"\n"
        "#pragma GCC diagnostic ignored \"-Woverlength-strings\"\n"
        "TONEWRIGHT_NAMESPACE_BEGIN\n"
        "alignas(double) const char kAgxNodes[sizeof(double) * kAgxNumbers + 1] =";
    const auto* const bytes = reinterpret_cast<const unsigned char*>(numbers.data());
    for (std::size_t i = 0; i < sizeof(double) * numbers.size(); ++i) {
        if (i % 512 == 0) text += i == 0 ? "\n\"" : "\"\n\"";
        text += '\\';
        for (const int shift : {6, 3, 0})
            text += static_cast<char>('0' + (bytes[i] >> shift & 7));
    }
    return text + "\";\nTONEWRIGHT_NAMESPACE_END\n";
}

}  // namespace

int main(int count, char** arguments) {
    using namespace tonewright;
    if (count != 2) return 2;
    const std::string text =
        text_of(agx_cube::cube_nodes(agx_cube::kEdge, agx_cube::rec709_node()));
    std::FILE* const file = std::fopen(arguments[1], "wb");
    if (!file) return 3;
    const bool is_written = std::fwrite(text.data(), 1, text.size(), file) == text.size();
    return std::fclose(file) == 0 && is_written ? 0 : 3;
}
