// SPDX-License-Identifier: Apache-2.0
#include <algorithm>

#include "tonewright/engine.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

bool is_set(const ResolvedOperator& resolved, const std::string& name) {
    return resolved.settings.contains(name) ||
           (resolved.preset && resolved.preset->settings.contains(name));
}

}  // namespace

LiveUniforms live_statistics(const ResolvedOperator& resolved) {
    const std::vector<std::string> live = live_parameters(*resolved.op);
    LiveUniforms uniforms;
    for (const ParameterSpec& spec : resolved.op->parameters) {
        if (!spec.from_picture || is_set(resolved, spec.name)) continue;
        if (std::find(live.begin(), live.end(), spec.name) == live.end()) return {};
        uniforms[spec.name] = {spec.default_value, spec.min, spec.max, true};
    }
    return uniforms;
}

std::vector<std::string> uniform_names(const LiveUniforms& uniforms) {
    std::vector<std::string> names;
    for (const auto& [name, uniform] : uniforms)
        names.push_back(name);
    return names;
}

UniformValues statistic_values(const LiveUniforms& uniforms, const ResolvedOperator& resolved,
                               const SceneStatistics& statistics) {
    UniformValues values;
    for (const ParameterSpec& spec : resolved.op->parameters) {
        if (!spec.from_picture || !uniforms.contains(spec.name)) continue;
        values[spec.name] = std::clamp(spec.from_picture(statistics), spec.min, spec.max);
    }
    return values;
}

TONEWRIGHT_NAMESPACE_END
