// SPDX-License-Identifier: Apache-2.0
#include "report/backends.h"

#include "tonewright/error.h"
#include "verify/backends.h"

TONEWRIGHT_NAMESPACE_BEGIN

std::vector<BackendResult> run_backends(const View& view, const std::vector<float>& rgb,
                                        const std::string& cache_folder) {
    const Pipeline pipeline = build_view(view);
    std::vector<BackendResult> results;
    for (const Backend& backend : all_backends()) {
        if (backend.title.empty()) continue;
        BackendResult& result = results.emplace_back();
        result.name = backend.title;
        try {
            const ColorRun run = backend.start({view, pipeline, nullptr, cache_folder});
            result.shown.resize(rgb.size());
            run(rgb.data(), result.shown.data(), rgb.size() / 3);
        } catch (const Error& e) {
            result.shown.clear();
            result.reason = e.what();
        }
    }
    return results;
}

TONEWRIGHT_NAMESPACE_END
