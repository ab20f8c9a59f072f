// SPDX-License-Identifier: Apache-2.0
#include "tools/npm_package.h"

#include <fmt/format.h>

#include <cmath>
#include <map>
#include <set>
#include <string_view>

#include "base/atomic_file.h"
#include "base/format_number.h"
#include "base/little_endian.h"
#include "base/strings.h"
#include "cli/messages.h"
#include "tasks/json.h"
#include "tonewright/generated_files.h"
#include "tonewright/registry.h"
#include "tonewright/shader.h"

TONEWRIGHT_NAMESPACE_BEGIN
namespace {

constexpr const char* kTypes =
    R"(/** A grid of colors that the text reads: edge^3 texels of four 32-bit floats. */
export interface Grid {
    /** Its name in the text. WGSL binds the textures of an operator at group 0, in their order. */
    name: string;
    edge: number;
    /** A file of little-endian floats, RGBA, x running fastest: `rgba32float`, without a filter. */
    url: URL;
}

interface Common {
    id: string;
    title: string;
    /** The function in the text: scene-linear Rec.709 to display-linear Rec.709. */
    functionName: string;
    grids: readonly Grid[];
    /** Largest errors of sRGB code values (0 to 1); null: no useful bound. */
    errors: { readonly float: number; readonly guaranteed: number | null };
}
/** GLSL ES 3.00. */
export interface Glsl extends Common { glsl: string }
export interface Wgsl extends Common { wgsl: string }
export interface Operator extends Glsl, Wgsl {}
)";

constexpr const char* kThreejs = R"(import { Data3DTexture, FloatType } from 'three';

export async function loadUniforms({ grids }) {
    const uniforms = {};
    for (const { name, edge, url } of grids) {
        const response = await fetch(url);
        if (!response.ok) throw new Error(`${url}: ${response.status} ${response.statusText}`);
        const texture = new Data3DTexture(new Float32Array(await response.arrayBuffer()), edge, edge, edge);
        texture.type = FloatType;
        texture.needsUpdate = true;
        uniforms[name] = { value: texture };
    }
    return uniforms;
}
)";

constexpr const char* kReadme = R"(# tonewright-shaders

Tone mapping operators as GLSL ES 3.00, WGSL and nodes of three.js. Tonewright @version wrote them, and measured the error of
each against a double-precision reference.

## three.js, WebGLRenderer

```js
import * as THREE from 'three';
import { agx_blender } from 'tonewright-shaders/three';

const renderer = new THREE.WebGLRenderer();
agx_blender(renderer);                          // Blender's AgX; before the first material is compiled
```

The call sets `renderer.toneMapping`. `renderer.toneMappingExposure` is a factor before the curve.

## three.js, WebGPURenderer

```js
import * as THREE from 'three/webgpu';
import { agx_blender } from 'tonewright-shaders/tsl';

const renderer = new THREE.WebGPURenderer();
renderer.library.addToneMapping(agx_blender, THREE.CustomToneMapping);
renderer.toneMapping = THREE.CustomToneMapping;
```

The same node works on its WebGL 2 backend.

## A pass of your own

```js
import * as THREE from 'three';
import { agx_blender } from 'tonewright-shaders';
import { loadUniforms } from 'tonewright-shaders/three';

const material = new THREE.ShaderMaterial({
    uniforms: { light: { value: null }, ...await loadUniforms(agx_blender) },
    fragmentShader: agx_blender.glsl + `
        uniform sampler2D light;
        void main() {
            vec3 scene = texelFetch(light, ivec2(gl_FragCoord.xy), 0).rgb;
            gl_FragColor = linearToOutputTexel(vec4(${agx_blender.functionName}(scene), 1.0));
        }`,
});
```

## Entries

| import from | entry |
|---|---|
| `tonewright-shaders` | `{ id, title, functionName, glsl, wgsl, grids, errors }` |
| `tonewright-shaders/glsl`, `tonewright-shaders/wgsl` | the same in one language |
| `tonewright-shaders/three` | `NAME(renderer)`, which sets its tone mapping; `loadUniforms(entry)`, the 3D textures of a material |
| `tonewright-shaders/threejs` | `use_NAME()`, which only installs `CustomToneMapping`; `loadUniforms(entry)` |
| `tonewright-shaders/tsl` | a node function of color and exposure |

Each function takes a scene-linear color in Rec.709 and returns a display-linear one; encode it for the display. Bundlers drop
the operators that are not imported.

| name | operator | largest error in float |
|---|---|---|
)";

/// Escaped for a template literal.
std::string template_literal(const std::string& text) {
    std::string quoted = "`\n";
    for (const char c : text) {
        if (c == '`' || c == '\\' || c == '$') quoted += '\\';
        quoted += c;
    }
    return quoted + "`";
}

/// An operator in the package. The name of its export is that of the function without `tw_`.
struct NpmOperator {
    std::string title;
    Shader glsl;  // GLSL ES
    Shader wgsl;
    Shader threejs;
    Shader tsl;
};

NpmOperator npm_operator(const OperatorVariant& variant) {
    ShaderRequest request;
    request.view = make_view(resolve_operator(variant.name, {}, variant.look), "lin_rec709", 0,
                             std::string(kLinearOutput));  // three.js encodes its pictures itself
    const ShaderErrors errors = measure_shader(request);
    const ResolvedOperator& op = request.view.op;
    NpmOperator entry = {op.op->title, {}, {}, {}, {}};
    if (op.preset) entry.title += ", " + op.preset->title;
    if (!op.params.look().empty()) entry.title += ", look " + op.params.look();
    request.language = ShaderLanguage::glsl_es;
    entry.glsl = write_shader(request, &errors);
    request.language = ShaderLanguage::wgsl;
    entry.wgsl = write_shader(request, &errors);
    request.application = &find_shader_application("threejs");
    entry.threejs = write_shader(request, &errors);
    request.application = &find_shader_application("threejs-tsl");
    entry.tsl = write_shader(request, &errors);
    return entry;
}

class Package {
  public:
    void add(const NpmOperator& op) {
        const std::string id = op.glsl.function.substr(std::string_view("tw_").size());
        const std::string common = facts(op, id);
        add_language("glsl", id, "Glsl", common, op.glsl.text);
        add_language("wgsl", id, "Wgsl", common, op.wgsl.text);
        files_.push_back({"operators/" + id + ".js",
                          fmt::format("import {{ {0} as glsl }} from '../glsl/{0}.js';\n"
                                      "import {{ {0} as wgsl }} from '../wgsl/{0}.js';\n\n"
                                      "export const {0} = {{ ...glsl, ...wgsl }};\n",
                                      id)});
        add_export("index", "operators", id, id, "Operator");
        files_.push_back({"threejs/" + id + ".js", with_shared_grids(op.threejs.text)});
        add_export("threejs", "threejs", id, "use_" + op.threejs.function + " as use_" + id,
                   "() => void", "use_");
        files_.push_back({"three/" + id + ".js",
                          fmt::format("import {{ CustomToneMapping }} from 'three';\n"
                                      "import {{ use_{1} }} from '../threejs/{0}.js';\n\n"
                                      "export function {0}(renderer) {{\n"
                                      "    use_{1}();\n"
                                      "    renderer.toneMapping = CustomToneMapping;\n}}\n",
                                      id, op.threejs.function)});
        add_export("three", "three", id, id, "(renderer: WebGLRenderer) => void");
        files_.push_back({"tsl/" + id + ".js", with_shared_grids(op.tsl.text)});
        add_export("tsl", "tsl", id, op.tsl.function + " as " + id, "NodeFunction");
        rows_ +=
            fmt::format("| `{}` | {} | {} |\n", id, op.title, rounded_up(op.glsl.errors.in_float));
    }

    std::vector<GeneratedFile> finish() {
        for (const char* const module : {"three", "threejs"}) {
            modules_[module] += "export { loadUniforms } from './threejs/loadUniforms.js';\n";
            types_[module] =
                "import type { Data3DTexture, WebGLRenderer } from 'three';\n"
                "import type { Glsl } from './types.js';\n\n"
                "/** Loads the 3D textures that the text reads: uniforms of a material. */\n"
                "export declare function loadUniforms(entry: Pick<Glsl, 'grids'>): "
                "Promise<Record<string, { value: Data3DTexture }>>;\n" +
                types_[module];
        }
        types_["tsl"] =
            "import type { Node } from 'three/webgpu';\n\n"
            "/** The color shown for a scene-linear color and an exposure, which is a factor. */\n"
            "type NodeFunction = (color: Node, exposure: Node) => Node;\n" +
            types_["tsl"];
        Json exports = Json::object();
        for (const auto& [module, text] : modules_) {
            files_.push_back({module + ".js", text});
            const bool is_three = module.starts_with("three") || module == "tsl";
            files_.push_back(
                {module + ".d.ts",
                 (is_three ? ""
                           : "import type { Glsl, Operator, Wgsl } from './types.js';\n\n"
                             "export type * from './types.js';\n") +
                     types_[module]});
            exports.add(module == "index" ? "." : "./" + module,
                        {{"types", "./" + module + ".d.ts"}, {"default", "./" + module + ".js"}});
        }
        files_.push_back({"types.d.ts", kTypes});
        files_.push_back({"threejs/loadUniforms.js", kThreejs});
        std::string readme = kReadme;
        const std::string_view version = "@version";
        readme.replace(readme.find(version), version.size(), TONEWRIGHT_VERSION);
        files_.push_back({"README.md", readme + rows_});
        const Json package = {
            {"name", "tonewright-shaders"},
            {"version", TONEWRIGHT_VERSION},
            {"description", "Tone mapping operators as GLSL, WGSL and three.js, with known errors"},
            {"license", "Apache-2.0"},
            {"type", "module"},
            {"sideEffects", false},
            {"exports", exports},
            {"types", "./index.d.ts"},
            {"peerDependencies", {{"three", ">=0.170"}}},
            {"peerDependenciesMeta", {{"three", {{"optional", true}}}}},
            {"keywords", std::vector<std::string>{"tone mapping", "aces", "agx", "hdr", "glsl",
                                                  "wgsl", "three", "shader"}},
        };
        files_.push_back({"package.json", package.dump(2) + "\n"});
        return std::move(files_);
    }

  private:
    /// Properties that GLSL and WGSL share. Looks share 3D LUTs: each is one file.
    std::string facts(const NpmOperator& op, const std::string& id) {
        std::string grids;
        for (const ShaderTexture& texture : op.glsl.textures) {
            std::string bytes = little_endian_bytes(texture.rgba);
            const std::string path = "grids/" + content_hash(bytes) + ".rgba32f";
            grids += fmt::format(
                "\n        {{ name: '{}', edge: {}, url: new URL('../{}', import.meta.url) }},",
                texture.name, texture.size[0], path);
            if (written_.insert(path).second) files_.push_back({path, std::move(bytes)});
        }
        if (!grids.empty()) grids += "\n    ";
        const ShaderErrors& errors = op.glsl.errors;
        return fmt::format(
            "    id: '{}',\n    title: {},\n    functionName: '{}',\n    grids: [{}],\n"
            "    errors: {{ float: {}, guaranteed: {} }},\n",
            id, Json(op.title).dump(), op.glsl.function, grids, rounded_up(errors.in_float),
            std::isfinite(errors.guaranteed) ? rounded_up(errors.guaranteed) : "null");
    }
    /// The text with its data in modules, which operators share.
    std::string with_shared_grids(std::string text) {
        constexpr std::string_view kBegin = ", '";
        constexpr std::string_view kEnd = "'],\n";
        std::string imports;
        for (std::size_t end = text.find(kEnd); end != std::string::npos; end = text.find(kEnd)) {
            const std::size_t begin = text.rfind(kBegin, end) + kBegin.size();
            const std::string data = text.substr(begin, end - begin);
            const std::string hash = content_hash(data);
            const std::string path = "grids/" + hash + ".js";
            if (written_.insert(path).second)
                files_.push_back({path, "export default '" + data + "';\n"});
            imports += fmt::format("import grid_{0} from '../grids/{0}.js';\n", hash);
            text.replace(begin - 1, data.size() + 2, "grid_" + hash);
        }
        return imports + text;
    }
    void add_language(const std::string& language, const std::string& id, const std::string& type,
                      const std::string& common, const std::string& text) {
        files_.push_back({language + "/" + id + ".js",
                          fmt::format("export const {0} = {{\n{1}    {2}: /* {2} */{3},\n}};\n", id,
                                      common, language, template_literal(text))});
        add_export(language, language, id, id, type);
    }
    void add_export(const std::string& module, const std::string& folder, const std::string& id,
                    const std::string& what, const std::string& type,
                    const std::string& prefix = "") {
        modules_[module] += fmt::format("export {{ {} }} from './{}/{}.js';\n", what, folder, id);
        types_[module] += fmt::format("export declare const {}{}: {};\n", prefix, id, type);
    }

    std::vector<GeneratedFile> files_;
    std::map<std::string, std::string> modules_;  // by name: its exports
    std::map<std::string, std::string> types_;
    std::set<std::string> written_;  // grids
    std::string rows_;               // of the README's table
};

}  // namespace

void write_npm_package(const std::string& folder) {
    require_writable_folder(folder);
    Package package;
    const std::vector<OperatorVariant> variants = all_variants();
    for (const OperatorVariant& variant : variants)
        package.add(npm_operator(variant));
    std::vector<GeneratedFile> files = package.finish();
    // The next run removes files that it no longer writes.
    std::string manifest = "path\n";
    for (const GeneratedFile& file : files)
        manifest += file.path + "\n";
    files.push_back({"MANIFEST.csv", manifest});
    print_result(fmt::format("{}: npm package tonewright-shaders " TONEWRIGHT_VERSION
                             ", {} operators, presets and looks",
                             folder, variants.size()));
    write_generated_files(folder, files, "MANIFEST.csv");
}

TONEWRIGHT_NAMESPACE_END
