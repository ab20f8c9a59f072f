// SPDX-License-Identifier: Apache-2.0
//
// Runs `float3 FUNCTION(float3)` of an HLSL file on the colors of the table. dxc, or glslangValidator where there is no
// dxc, compiles it to SPIR-V; spirv-cross translates that to GLSL, which a browser draws with WebGL 2. All three
// programs are in the Vulkan SDK (Debian: glslang-tools, spirv-cross).
//
//   node run_hlsl.mjs Tonemap.hlsl ACESFitted
import { spawnSync } from 'node:child_process';
import { mkdtempSync, rmSync, writeFileSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { dirname, join, resolve } from 'node:path';

import { colorsOf, inBrowser, pixelsOf } from './browser.mjs';
import { commandLine, finish, misuse, readText } from './compare.mjs';
import { draw } from './webgl.mjs';

const { words: [file, name], rows, codes } = commandLine('run_hlsl.mjs FILE FUNCTION', 2);
const folder = mkdtempSync(join(tmpdir(), 'conformance-'));
const [source, spirv] = [join(folder, 'function.hlsl'), join(folder, 'function.spv')];
process.on('exit', () => rmSync(folder, { recursive: true, force: true }));

function run(program, ...words) {
    const done = spawnSync(program, words, { encoding: 'utf8' });
    if (done.error?.code === 'ENOENT') return null;
    if (done.status !== 0) misuse(`${program}: ${done.stdout}${done.stderr}`);
    return done.stdout;
}

writeFileSync(source, `${readText(file)}
[[vk::binding(0, 0)]] Texture2D<float4> kit_colors;
float4 kit_main(float4 at : SV_Position) : SV_Target { return float4(${name}(kit_colors.Load(int3(at.xy, 0)).rgb), 1.0); }
`);
const include = `-I${dirname(resolve(file))}`;
const glslang = ['-D', '-V', '--quiet', '--auto-map-bindings', '-S', 'frag', '-e', 'kit_main'];
if (run('dxc', '-spirv', '-T', 'ps_6_0', '-E', 'kit_main', include, source, '-Fo', spirv) === null &&
    run('glslangValidator', ...glslang, include, source, '-o', spirv) === null)
    misuse('found no dxc and no glslangValidator; expected one of them');
const fragment = run('spirv-cross', spirv, '--version', '300', '--es') ?? misuse('found no spirv-cross; expected it');
finish(rows, colorsOf(await inBrowser(draw, { fragment, pixels: pixelsOf(rows), uniforms: [] })), codes);
