// SPDX-License-Identifier: Apache-2.0
//
// core_files FOLDER: what the core library writes, for comparison with another processor. LUTs in
// each format that needs no other library, read back where there is a reader; shaders; numbers of
// both engines.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <cstdio>
#include <exception>
#include <string>
#include <vector>

#include "base/atomic_file.h"
#include "tonewright/engine.h"
#include "tonewright/lut.h"
#include "tonewright/registry.h"
#include "tonewright/shader.h"

using namespace tonewright;

namespace {

View view_of(const char* op) { return make_view(resolve_operator(op), "lin_rec709", 0, "srgb"); }

/// Black, gray, colors inside and outside Rec.709, and the ends of the domain.
const std::vector<float> kColors = {0,     0,    0,    0.18F, 0.18F, 0.18F, 1,      1,      1,
                                    4,     0.5F, 0.1F, 0.02F, 0.6F,  0.03F, 0.001F, 0.002F, 0.3F,
                                    -0.1F, 0.2F, 0.7F, 12,    30,    80,    65504,  0,      1e-6F};

void write_numbers(const std::string& folder, const std::string& op) {
    const Pipeline pipeline = build_view(view_of(op.c_str()));
    const ReferenceEngine reference(pipeline);
    const SimdEngine simd(pipeline);
    std::vector<float> fast(kColors.size());
    simd.run_rgb(kColors.data(), fast.data(), kColors.size() / 3);
    std::string of_reference, of_simd;
    for (std::size_t i = 0; i < kColors.size(); i += 3) {
        const Vector3 exact =
            reference({static_cast<double>(kColors[i]), static_cast<double>(kColors[i + 1]),
                       static_cast<double>(kColors[i + 2])});
        for (std::size_t c = 0; c < 3; ++c) {
            of_reference += fmt::format("{:.9g}\n", exact[c]);
            of_simd += fmt::format("{:.9g}\n", static_cast<double>(fast[i + c]));
        }
    }
    write_text_atomically(folder + "/" + op + ".reference.txt", of_reference);
    write_text_atomically(folder + "/" + op + ".simd.txt", of_simd);
}

void write_luts(const std::string& folder, const std::string& op) {
    for (const LutFormat format :
         {LutFormat::cube, LutFormat::clf, LutFormat::ctf, LutFormat::spi3d, LutFormat::csp,
          LutFormat::resolve_cube, LutFormat::threedl, LutFormat::houdini, LutFormat::raw}) {
        LutRequest request;
        request.view = view_of(op.c_str());
        request.encoding = parse_input_encoding("log2");
        request.format = format;
        request.dimension = LutDimension::three;
        request.size = 17;
        Lut lut = sample_lut(request);
        quantize(lut, request);
        const std::string path = folder + "/" + op + "." + name_of(format);
        write_text_atomically(path, write_lut(lut, request, {}));
        if (format != LutFormat::cube && format != LutFormat::raw) continue;
        // A name that the reader knows.
        const std::string known = path + (format == LutFormat::cube ? ".cube" : ".raw");
        write_text_atomically(known, write_lut(lut, request, {}));
        (void)table_reader()(known);
    }
}

void write_curves(const std::string& folder) {
    for (const LutFormat format : {LutFormat::cube, LutFormat::clf, LutFormat::spi1d}) {
        LutRequest request;
        request.view = view_of("hable");
        request.encoding = parse_input_encoding("log2");
        request.format = format;
        request.dimension = LutDimension::one;
        request.size = 1024;
        write_text_atomically(folder + "/hable.1d." + name_of(format),
                              write_lut(sample_lut(request), request, {}));
    }
}

void write_shaders(const std::string& folder, const std::string& op) {
    const ShaderErrors none;
    for (const ShaderLanguageInfo& language : shader_languages()) {
        ShaderRequest request;
        request.view = view_of(op.c_str());
        request.language = language.language;
        write_text_atomically(folder + "/" + op + "." + language.id,
                              write_shader(request, &none).text);
    }
}

}  // namespace

int main(int argc, char** argv) {
    if (argc != 2) return 2;
    const std::string folder = argv[1];
    try {
        for (const char* op : {"agx_blender", "aces_20", "hable", "khronos_neutral"}) {
            write_numbers(folder, op);
            write_luts(folder, op);
        }
        write_curves(folder);
        for (const char* op : {"aces_hill", "hable", "khronos_neutral"})
            write_shaders(folder, op);
        fmt::print("{}\n", fmt::join(SimdEngine::targets(), " "));
    } catch (const std::exception& e) {
        fmt::print(stderr, "core_files: {}\n", e.what());
        return 1;
    }
    return 0;
}
