// SPDX-License-Identifier: Apache-2.0
//
// Times WGSL functions `fn NAME(scene: vec3<f32>) -> vec3<f32>` on a GPU with Dawn (see docs/shaders.md): compute shaders, half
// floats to half floats. Prints microseconds for a picture of COUNT pixels (default: 3840 x 2160).
//
//   node shader_speed.mjs NODE_MODULES FOLDER_OF_WGSL [COUNT]
import { createRequire } from 'node:module';
import { readFileSync, readdirSync } from 'node:fs';
import path from 'node:path';
import { pathToFileURL } from 'node:url';

const [modules, folder, count = 3840 * 2160] = process.argv.slice(2);
const require = createRequire(path.join(path.resolve(modules), 'none.js'));
const { create, globals } = await import(pathToFileURL(require.resolve('webgpu')).href);
Object.assign(globalThis, globals);
globalThis.gpu = create(['backend=vulkan']);  // stays referenced, because Dawn crashes where it is collected before its devices
const adapter = await globalThis.gpu.requestAdapter();
const device = await adapter.requestDevice();
console.log(`# ${adapter.info.device}, ${adapter.info.description}`);

const colors = new Uint32Array(Number(count) * 2);  // pairs of half floats from 2^-10 to 2^6
const half = () => ((5 + Math.floor(Math.random() * 16)) << 10) | Math.floor(Math.random() * 1024);
colors.forEach((_, i) => { colors[i] = (half() << 16) | half(); });
const input = device.createBuffer({ size: colors.byteLength, usage: GPUBufferUsage.STORAGE | GPUBufferUsage.COPY_DST });
const output = device.createBuffer({ size: colors.byteLength, usage: GPUBufferUsage.STORAGE });
device.queue.writeBuffer(input, 0, colors);

async function measure(name, text) {
    const code = `${text}
@group(0) @binding(0) var<storage, read> bench_in: array<vec2u>;
@group(0) @binding(1) var<storage, read_write> bench_out: array<vec2u>;
@compute @workgroup_size(256)
fn main(@builtin(global_invocation_id) id: vec3u, @builtin(num_workgroups) groups: vec3u) {
    let i = id.x + id.y * groups.x * 256u;
    if (i >= arrayLength(&bench_in)) { return; }
    let c = ${[...text.matchAll(/^fn (\w+)\(scene: vec3<f32>\)/gm)].pop()[1]}(
        vec3f(unpack2x16float(bench_in[i].x), unpack2x16float(bench_in[i].y).x));
    bench_out[i] = vec2u(pack2x16float(c.xy), pack2x16float(vec2f(c.z, 1.0)));
}`;
    const compute = { module: device.createShaderModule({ code }), entryPoint: 'main' };
    const pipeline = await device.createComputePipelineAsync({ layout: 'auto', compute });
    const entries = [input, output].map((buffer, binding) => ({ binding, resource: { buffer } }));
    const group = device.createBindGroup({ layout: pipeline.getBindGroupLayout(0), entries });
    const timeOf = async (draws) => {
        const encoder = device.createCommandEncoder();
        const pass = encoder.beginComputePass();
        pass.setPipeline(pipeline);
        pass.setBindGroup(0, group);
        for (let i = 0; i < draws; ++i) pass.dispatchWorkgroups(240, Math.ceil(colors.length / 2 / 256 / 240));
        pass.end();
        const start = performance.now();
        device.queue.submit([encoder.finish()]);
        await device.queue.onSubmittedWorkDone();
        return (performance.now() - start) * 1e3 / draws;
    };
    await timeOf(1);  // drivers finish compiling at the first run
    let best = await timeOf(1);
    const draws = Math.max(1, Math.min(200, Math.floor(4e4 / best)));
    for (let i = 0; i < 5; ++i) best = Math.min(best, await timeOf(draws));
    console.log(`${name},${best.toFixed(1)}`);
}

await measure('copy', 'fn copy(scene: vec3<f32>) -> vec3<f32> { return scene; }');
for (const name of readdirSync(folder).sort()) await measure(name, readFileSync(path.join(folder, name), 'utf8'));
process.exit(0);
