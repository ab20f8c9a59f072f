// SPDX-License-Identifier: Apache-2.0
#include "verify/backends.h"

#include <gtest/gtest.h>

#include <cmath>
#include <set>
#include <string>
#include <vector>

#include "ocio/gpu.h"
#include "tonewright/engine.h"
#include "tonewright/registry.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

View view_of(const std::string& op) {
    return make_view(resolve_operator(op), "lin_rec709", 0, "srgb");
}

TEST(Backends, EachComputesTheView) {
    const View view = view_of("reinhard");
    const Pipeline pipeline = build_view(view);
    const std::vector<float> rgb = {0.18F, 0.18F, 0.18F, 1, 0.5F, 0.1F, 8, 4, 2};
    std::vector<double> truth(rgb.size());
    ReferenceEngine(pipeline).run_rgb(rgb.data(), truth.data(), rgb.size() / 3);
    std::size_t count = 0;
    for (const Backend& backend : all_backends()) {
        if (backend.id == Backend::Id::ocio_gpu && !OcioGpu::unavailable_reason().empty()) continue;
        const ColorRun run = backend.start({view, pipeline});
        if (!run) continue;
        ++count;
        std::vector<float> shown(rgb.size());
        run(rgb.data(), shown.data(), rgb.size() / 3);
        for (std::size_t i = 0; i < rgb.size(); ++i)
            EXPECT_NEAR(static_cast<double>(shown[i]), truth[i], 2e-3)
                << backend.name << backend.title;
    }
    EXPECT_GE(count, 5U);
}

TEST(Backends, HaveOneNameEach) {
    std::set<std::string> names;
    for (const Backend& backend : all_backends()) {
        EXPECT_EQ(&find_backend(backend.id), &backend);
        EXPECT_TRUE(names.insert(backend.name + backend.title).second) << backend.name;
        EXPECT_EQ(backend.name.empty(), backend.bound == nullptr) << backend.title;
    }
}

TEST(Backends, TheBuiltinTransformIsThatOfTheOperator) {
    const View view = view_of("reinhard");
    EXPECT_FALSE(find_backend(Backend::Id::ocio_builtin).start({view, build_view(view)}));
}

TEST(BackendBounds, GrowWithTheChain) {
    const auto bounds_of = [](const std::string& op) {
        const View view = view_of(op);
        const Pipeline pipeline = build_view(view);
        return backend_bounds(view, pipeline, lower_to_ocio(pipeline));
    };
    const BackendBounds clamp = bounds_of("clamp");
    EXPECT_EQ(clamp.cpu.error, BackendBounds{}.cpu.error);
    EXPECT_FALSE(clamp.cpu.is_declared);
    EXPECT_GT(bounds_of("reinhard:luminance").cpu.error, clamp.cpu.error)
        << "it subtracts luminances";
}

}  // namespace
TONEWRIGHT_NAMESPACE_END
