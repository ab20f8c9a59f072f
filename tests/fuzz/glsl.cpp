// SPDX-License-Identifier: Apache-2.0
//
// libFuzzer: `tonewright import` takes any text. What it writes is read again as the same stages.
#include <cstdint>
#include <cstdlib>
#include <string>

#include "tonewright/definition.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    using namespace tonewright;  // NOLINT(google-build-using-namespace): this is its program
    const std::string_view text(reinterpret_cast<const char*>(data), size);
    ShaderImport settings;
    if (size > 0) settings.output = static_cast<ShaderImport::Output>(data[size - 1] % 4);
    try {
        const ImportedShader shader = import_shader(text, "x.glsl", settings);
        const std::shared_ptr<const Operator> op = parse_operator(shader.definition, "x.tone");
        const ResolvedOperator resolved = resolve(*op, nullptr, {}, "");
        if (resolved.build().size() != shader.stages.size()) std::abort();
        const std::string written = definition_of(resolved);
        const std::shared_ptr<const Operator> again = parse_operator(written, "y.tone");
        const auto a = compose(resolved.build());
        const auto b = compose(resolve(*again, nullptr, {}, "").build());
        for (std::size_t i = 0; i < 3; ++i) {
            if (!same(a[i], b[i])) std::abort();
        }
    } catch (const DefinitionError& e) {
        // One line, always, and the place in the shader.
        if (std::string_view(e.what()).find('\n') != std::string_view::npos) std::abort();
        if (e.excerpt().find('^') == std::string::npos) std::abort();
        if (std::string_view(e.what()).find("the definition:") != std::string_view::npos)
            std::abort();
    }
    return 0;
}
