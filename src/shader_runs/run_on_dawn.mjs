// SPDX-License-Identifier: Apache-2.0
//
// Runs shaders on Dawn, the implementation of WebGPU in Chromium, without a browser: for `tonewright verify` and tests.
//
//   node run_on_dawn.mjs NODE_MODULES <STEPS
//
// A step is a line of JSON. A source is a file of WGSL or SPIR-V (.spv).
//   {source, input, out, textures: [{file, size, loader}]}   calls the entry point `main`, 64 colors to a group. Input and
//       output are float32 RGB at group 1; the textures are float32 RGBA at group 0. A loader is the text that a shader has
//       of it, for its `device` and `fetch`; it may be missing.
//   {vertex, fragment, picture, size, out, bindings}   draws one triangle: vertex and fragment are {source, entryPoint,
//       constants}, the picture is RGBA in half floats, the output in floats. Bindings are the entries of group 0:
//       "picture", "sampler", a list of floats in a uniform buffer, or a texture {texels, size, format}: RGBA in half floats,
//       or in `format`.
// Prints the adapter, then `done` after each step. Messages of the compiler and other errors end it.
import { createRequire } from 'node:module';
import { readFile, writeFile } from 'node:fs/promises';
import path from 'node:path';
import { createInterface } from 'node:readline';
import { pathToFileURL } from 'node:url';

const [modules] = process.argv.slice(2);
const require = createRequire(path.join(modules, 'none.js'));
const load = async (name) => import(pathToFileURL(require.resolve(name)).href);
const { create, globals } = await load('webgpu');
Object.assign(globalThis, globals);

const gpu = create(['backend=vulkan']);  // stays referenced, because Dawn crashes where it is collected before its devices
const fail = (message) => {
    console.error(message);
    process.exit(1);
};
const adapter = await gpu.requestAdapter() ?? fail('Dawn finds no driver of Vulkan that it takes');
const device = await adapter.requestDevice();
device.addEventListener('uncapturederror', (event) => fail(event.error.message));
console.log(`${adapter.info.vendor} ${adapter.info.architecture}`);

async function wgslOf(source) {
    if (!source.endsWith('.spv')) return readFile(source, 'utf8');
    const { translate } = await load('naga-wasm');
    const bytes = await readFile(source);
    return translate({ from: 'spirv', to: 'wgsl', source: new Uint32Array(bytes.buffer, bytes.byteOffset, bytes.length / 4) });
}

async function moduleOf(source) {
    const module = device.createShaderModule({ code: await wgslOf(source) });
    const { messages } = await module.getCompilationInfo();
    if (messages.length > 0) fail(`${source}:${messages[0].lineNum}: ${messages[0].message}`);
    return module;
}

function bufferOf(size, usage, contents) {
    const buffer = device.createBuffer({ size, usage: usage | GPUBufferUsage.COPY_DST });
    if (contents) device.queue.writeBuffer(buffer, 0, contents);
    return buffer;
}

function textureOf(bytes, size, format, bytesPerTexel) {
    const texture = device.createTexture({
        dimension: `${size.length}d`, size, format, usage: GPUTextureUsage.TEXTURE_BINDING | GPUTextureUsage.COPY_DST,
    });
    device.queue.writeTexture({ texture }, bytes, { bytesPerRow: bytesPerTexel * size[0], rowsPerImage: size[1] }, size);
    return texture.createView();
}

function loaded(file, loader) {
    const load = new (async () => {}).constructor('device', 'fetch', `${loader}\nreturn texture;`);
    return load(device, async (url) => {
        const bytes = await readFile(path.join(path.dirname(file), url));
        return { arrayBuffer: async () => bytes.buffer.slice(bytes.byteOffset, bytes.byteOffset + bytes.length) };
    });
}

function bind(pass, pipeline, group, resources) {
    const entries = resources.map((resource, binding) => ({ binding, resource }));
    pass.setBindGroup(group, device.createBindGroup({ layout: pipeline.getBindGroupLayout(group), entries }));
}

/** Submits the commands and writes what the buffer then holds. */
async function finish(encoder, result, out, length) {
    device.queue.submit([encoder.finish()]);
    await result.mapAsync(GPUMapMode.READ);
    await writeFile(out, new Uint8Array(result.getMappedRange(), 0, length));
    result.destroy();
}

async function compute({ source, input, out, textures }) {
    const rgb = await readFile(input);
    const groups = Math.ceil(rgb.length / 12 / 64);
    const size = groups * 64 * 12;
    const colors = bufferOf(size, GPUBufferUsage.STORAGE, rgb);
    const shown = bufferOf(size, GPUBufferUsage.STORAGE | GPUBufferUsage.COPY_SRC);
    const result = bufferOf(size, GPUBufferUsage.MAP_READ);
    const pipeline = device.createComputePipeline({ layout: 'auto', compute: { module: await moduleOf(source) } });
    const views = [];
    for (const { file, size: texels, loader } of textures) {
        views.push(loader ? (await loaded(file, loader)).createView() : textureOf(await readFile(file), texels, 'rgba32float', 16));
    }
    const encoder = device.createCommandEncoder();
    const pass = encoder.beginComputePass();
    pass.setPipeline(pipeline);
    if (views.length > 0) bind(pass, pipeline, 0, views);
    bind(pass, pipeline, 1, [{ buffer: colors }, { buffer: shown }]);
    pass.dispatchWorkgroups(groups);
    pass.end();
    encoder.copyBufferToBuffer(shown, 0, result, 0, size);
    await finish(encoder, result, out, rgb.length);
    colors.destroy();
    shown.destroy();
}

async function draw({ vertex, fragment, picture, size, out, bindings }) {
    const stage = async ({ source, entryPoint, constants }) => ({ module: await moduleOf(source), entryPoint, constants });
    const pipeline = device.createRenderPipeline({
        layout: 'auto', vertex: await stage(vertex), fragment: { ...await stage(fragment), targets: [{ format: 'rgba32float' }] },
    });
    const target = device.createTexture({
        size, format: 'rgba32float', usage: GPUTextureUsage.RENDER_ATTACHMENT | GPUTextureUsage.COPY_SRC,
    });
    const known = {
        picture: textureOf(await readFile(picture), size, 'rgba16float', 8),
        // Without a filter: in the middle of a texel, SwiftShader mixes some of its neighbors in.
        sampler: device.createSampler(),
    };
    const resourceOf = async (binding) => {
        if (binding.texels) {
            const { texels, size: edges, format = 'rgba16float' } = binding;
            return textureOf(await readFile(texels), edges, format, format === 'rgba16float' ? 8 : 16);
        }
        return known[binding] ?? { buffer: bufferOf(4 * binding.length, GPUBufferUsage.UNIFORM, Float32Array.from(binding)) };
    };
    const resources = await Promise.all(bindings.map(resourceOf));
    const encoder = device.createCommandEncoder();
    const pass = encoder.beginRenderPass({ colorAttachments: [{ view: target.createView(), loadOp: 'clear', storeOp: 'store' }] });
    pass.setPipeline(pipeline);
    bind(pass, pipeline, 0, resources);
    pass.draw(3);
    pass.end();
    const length = 16 * size[0] * size[1];
    const result = bufferOf(length, GPUBufferUsage.MAP_READ);
    encoder.copyTextureToBuffer({ texture: target }, { buffer: result, bytesPerRow: 16 * size[0] }, size);
    await finish(encoder, result, out, length);
}

for await (const line of createInterface({ input: process.stdin })) {
    const step = JSON.parse(line);
    await (step.source ? compute(step) : draw(step));
    console.log('done');
}
process.exit(0);
