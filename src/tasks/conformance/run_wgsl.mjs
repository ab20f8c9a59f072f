// SPDX-License-Identifier: Apache-2.0
//
// Runs `fn FUNCTION(color: vec3<f32>) -> vec3<f32>` of a WGSL file on the colors of the table, with WebGPU in a browser.
//
//   node run_wgsl.mjs tonemap.wgsl toneMap
import { colorsOf, inBrowser, pixelsOf } from './browser.mjs';
import { commandLine, finish, readText } from './compare.mjs';

/** Runs in the page: one invocation for each color. */
async function compute({ code, pixels }) {
    const adapter = await navigator.gpu?.requestAdapter();
    if (!adapter) throw new Error('found no adapter of WebGPU');
    const device = await adapter.requestDevice();
    device.pushErrorScope('validation');
    const module = device.createShaderModule({ code });
    const message = (await module.getCompilationInfo()).messages.find(({ type }) => type === 'error');
    if (message) throw new Error(`line ${message.lineNum}: ${message.message}`);
    const numbers = Float32Array.from(pixels, Number);
    const buffer = (usage) => device.createBuffer({ size: numbers.byteLength, usage });
    const input = buffer(GPUBufferUsage.STORAGE | GPUBufferUsage.COPY_DST);
    const output = buffer(GPUBufferUsage.STORAGE | GPUBufferUsage.COPY_SRC);
    const results = buffer(GPUBufferUsage.MAP_READ | GPUBufferUsage.COPY_DST);
    device.queue.writeBuffer(input, 0, numbers);
    const pipeline = await device.createComputePipelineAsync({ layout: 'auto', compute: { module, entryPoint: 'kit_main' } });
    const encoder = device.createCommandEncoder();
    const pass = encoder.beginComputePass();
    pass.setPipeline(pipeline);
    pass.setBindGroup(1, device.createBindGroup({
        layout: pipeline.getBindGroupLayout(1),
        entries: [input, output].map((used, binding) => ({ binding, resource: { buffer: used } })),
    }));
    pass.dispatchWorkgroups(numbers.length / 4);
    pass.end();
    encoder.copyBufferToBuffer(output, 0, results, 0, numbers.byteLength);
    device.queue.submit([encoder.finish()]);
    await results.mapAsync(GPUMapMode.READ);
    const error = await device.popErrorScope();
    if (error) throw new Error(error.message);
    return new Float32Array(results.getMappedRange());
}

const { words: [file, name], rows, codes } = commandLine('run_wgsl.mjs FILE FUNCTION', 2);
const code = `${readText(file)}
@group(1) @binding(0) var<storage, read> kit_colors: array<vec4<f32>>;
@group(1) @binding(1) var<storage, read_write> kit_results: array<vec4<f32>>;
@compute @workgroup_size(1) fn kit_main(@builtin(global_invocation_id) id: vec3<u32>) {
    kit_results[id.x] = vec4<f32>(${name}(kit_colors[id.x].rgb), 1.0);
}
`;
finish(rows, colorsOf(await inBrowser(compute, { code, pixels: pixelsOf(rows) })), codes);
