// SPDX-License-Identifier: Apache-2.0
//
// Runs shader functions on Dawn, the implementation of WebGPU in Chromium, without a browser.
//
//   VK_ICD_FILENAMES=.../vk_swiftshader_icd.json node run_on_dawn.mjs NODE_MODULES JOB.json
//
// The job: input (a file of float32 RGB) and for each function source (WGSL text, or a SPIR-V file), textures (files
// NAME.rgba32f of float32 RGBA in a folder, with their size and the loader of the text, or none; at group 0) and out (a
// file of float32 RGB to write). The entry point is `main`, 64 colors to a group, input and output at group 1. Prints the
// adapter; messages of the compiler are an error.
import { createRequire } from 'node:module';
import { readFile, writeFile } from 'node:fs/promises';
import path from 'node:path';
import { pathToFileURL } from 'node:url';

const [modules, jobPath] = process.argv.slice(2);
const require = createRequire(path.join(modules, 'none.js'));
const load = async (name) => import(pathToFileURL(require.resolve(name)).href);
const { create, globals } = await load('webgpu');
Object.assign(globalThis, globals);
const job = JSON.parse(await readFile(jobPath, 'utf8'));

const floatsOf = async (file) => {
    const bytes = await readFile(file);
    return new Float32Array(bytes.buffer, bytes.byteOffset, bytes.length / 4);
};
const wgslOf = async (source) => {
    if (!source.endsWith('.spv')) return readFile(source, 'utf8');
    const { translate } = await load('naga-wasm');
    const bytes = await readFile(source);
    return translate({ from: 'spirv', to: 'wgsl', source: new Uint32Array(bytes.buffer, bytes.byteOffset, bytes.length / 4) });
};

const loaderOf = (lines) => new (async () => {}).constructor('device', 'fetch', `${lines}\nreturn texture;`);
const made = async (name, size, file) => {
    const texture = device.createTexture({
        dimension: '3d', size, format: 'rgba32float', usage: GPUTextureUsage.TEXTURE_BINDING | GPUTextureUsage.COPY_DST,
    });
    device.queue.writeTexture({ texture }, await file(`${name}.rgba32f`),
        { bytesPerRow: 16 * size[0], rowsPerImage: size[1] }, size);
    return texture;
};

// Dawn crashes when this object is collected, so a global holds it.
globalThis.gpu = create(['backend=vulkan']);
const adapter = await gpu.requestAdapter();
const device = await adapter.requestDevice();
device.addEventListener('uncapturederror', (event) => {
    console.error(event.error.message);
    process.exit(1);
});
const rgb = await floatsOf(job.input);
const groups = Math.ceil(rgb.length / 3 / 64);
const size = groups * 64 * 3 * 4;
const buffer = (usage) => device.createBuffer({ size, usage });
const input = buffer(GPUBufferUsage.STORAGE | GPUBufferUsage.COPY_DST);
const output = buffer(GPUBufferUsage.STORAGE | GPUBufferUsage.COPY_SRC);
const result = buffer(GPUBufferUsage.MAP_READ | GPUBufferUsage.COPY_DST);
device.queue.writeBuffer(input, 0, rgb);
console.log(`${adapter.info.vendor} ${adapter.info.architecture}`);

for (const { source, textures, out } of job.functions) {
    const module = device.createShaderModule({ code: await wgslOf(source) });
    const { messages } = await module.getCompilationInfo();
    if (messages.length > 0) {
        console.error(`${source}:${messages[0].lineNum}: ${messages[0].message}`);
        process.exit(1);
    }
    const pipeline = device.createComputePipeline({ layout: 'auto', compute: { module, entryPoint: 'main' } });
    const encoder = device.createCommandEncoder();
    const pass = encoder.beginComputePass();
    pass.setPipeline(pipeline);
    const bind = (group, resources) => pass.setBindGroup(group, device.createBindGroup({
        layout: pipeline.getBindGroupLayout(group),
        entries: resources.map((resource, binding) => ({ binding, resource })),
    }));
    const views = [];
    for (const { folder, name, size, loader } of textures) {
        const file = (url) => readFile(path.join(folder, url));
        const fetched = async (url) => ({ arrayBuffer: async () => new Uint8Array(await file(url)).buffer });
        views.push((await (loader ? loaderOf(loader)(device, fetched) : made(name, size, file))).createView());
    }
    if (views.length > 0) bind(0, views);
    bind(1, [{ buffer: input }, { buffer: output }]);
    pass.dispatchWorkgroups(groups);
    pass.end();
    encoder.copyBufferToBuffer(output, 0, result, 0, size);
    device.queue.submit([encoder.finish()]);
    await result.mapAsync(GPUMapMode.READ);
    await writeFile(out, new Uint8Array(result.getMappedRange(), 0, rgb.length * 4));
    result.unmap();
}
device.destroy();
process.exit(0);
