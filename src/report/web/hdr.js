// SPDX-License-Identifier: Apache-2.0
//
// HDR displays: the operator's HDR version as WGSL, on a WebGPU canvas that can exceed white. WebGL has no such canvas.
import { texels } from './reference.js';

const hasHdrDisplay = () => matchMedia('(dynamic-range: high)').matches;

// Why there is no HDR view; empty where there is one.
export function whyNot() {
    if (!hasHdrDisplay()) return 'This display is not HDR: the page shows SDR.';
    if (!navigator.gpu) return 'This display is HDR, but the browser has no WebGPU: the page shows SDR.';
    return '';
}

// Extended sRGB: the curve goes on above 1, and is odd.
const shaderOf = (hdr) => `
${hdr.wgsl}
struct PageView {
    origin: vec2<f32>,  // the picture's place at the canvas's corner
    step: f32,          // pixels of the picture for one of the canvas
    is_light: f32,
    values: array<vec4<f32>, ${Math.ceil(hdr.uniforms.length / 4) || 1}>,
};
@group(1) @binding(0) var page_light: texture_2d<f32>;
@group(1) @binding(1) var<uniform> page: PageView;
@vertex fn page_corners(@builtin(vertex_index) i: u32) -> @builtin(position) vec4<f32> {
    return vec4<f32>(f32(i & 1u) * 4.0 - 1.0, f32(i >> 1u) * 4.0 - 1.0, 0.0, 1.0);
}
fn page_encode(x: f32) -> f32 {
    let a = abs(x);
    return sign(x) * select(1.055 * pow(max(a, 0.0031308), 1.0 / 2.4) - 0.055, 12.92 * a, a <= 0.0031308);
}
@fragment fn page_show(@builtin(position) at: vec4<f32>) -> @location(0) vec4<f32> {
    let size = vec2<i32>(textureDimensions(page_light));
    let place = page.origin + page.step * at.xy;
    let first = vec2<i32>(floor(place));
    if (any(first < vec2<i32>(0)) || any(first >= size)) { return vec4<f32>(vec3<f32>(0.1255), 1.0); }
    // The mean of the pixels that one of the canvas covers.
    let n = clamp(i32(floor(page.step + 0.5)), 1, 8);
    var scene = vec3<f32>(0.0);
    for (var y = 0; y < n; y++) {
        for (var x = 0; x < n; x++) {
            scene += textureLoad(page_light, min(first + vec2<i32>(x, y), size - 1), 0).rgb;
        }
    }
    scene /= f32(n * n);
    let light = ${hdr.function}(${['scene', ...hdr.uniforms.map((_, i) => `page.values[${i >> 2}][${i & 3}]`)].join(', ')});
    if (page.is_light > 0.5) { return vec4<f32>(light, 1.0); }
    return vec4<f32>(page_encode(light.r), page_encode(light.g), page_encode(light.b), 1.0);
}`;

export class HdrRenderer {
    static async make(canvas, onLost) {
        const adapter = await navigator.gpu.requestAdapter();
        if (!adapter) throw new Error('this machine has no graphics for WebGPU');
        const { maxTextureDimension2D, maxBufferSize } = adapter.limits;
        const device = await adapter.requestDevice({ requiredLimits: { maxTextureDimension2D, maxBufferSize } });
        device.lost.then(onLost);
        return new HdrRenderer(canvas, device);
    }

    constructor(canvas, device) {
        this.canvas = canvas;
        this.device = device;
        this.context = canvas.getContext('webgpu');
        this.context.configure({ device, format: 'rgba16float', colorSpace: 'srgb', toneMapping: { mode: 'extended' } });
        this.pipelines = new Map();
        this.textures = new Map();
        this.picture = null;
    }

    upload(data, size, dimension) {
        const texture = this.device.createTexture({ size, dimension, format: 'rgba32float',
            usage: GPUTextureUsage.TEXTURE_BINDING | GPUTextureUsage.COPY_DST });
        this.device.queue.writeTexture({ texture }, data, { bytesPerRow: 16 * size[0], rowsPerImage: size[1] }, size);
        return texture;
    }

    setPicture(picture) {
        if (this.picture === picture) return;
        this.picture = picture;
        this.light?.destroy();
        const rgba = picture.rgba.map((x) => (Number.isNaN(x) ? 0 : x));
        this.light = this.upload(rgba, [picture.width, picture.height], '2d');
    }

    pipeline(op, format) {
        const key = `${op.name} ${format}`;
        if (!this.pipelines.has(key)) {
            const module = this.device.createShaderModule({ code: shaderOf(op.hdr) });
            const isRead = { texture: { sampleType: 'unfilterable-float', viewDimension: '3d' }, visibility: GPUShaderStage.FRAGMENT };
            const layouts = [
                this.device.createBindGroupLayout({ entries: op.hdr.textures.map((_, binding) => ({ binding, ...isRead })) }),
                this.device.createBindGroupLayout({ entries: [
                    { binding: 0, visibility: GPUShaderStage.FRAGMENT, texture: { sampleType: 'unfilterable-float' } },
                    { binding: 1, visibility: GPUShaderStage.FRAGMENT, buffer: {} }] }),
            ];
            this.pipelines.set(key, { layouts, pipeline: this.device.createRenderPipeline({
                layout: this.device.createPipelineLayout({ bindGroupLayouts: layouts }),
                vertex: { module, entryPoint: 'page_corners' },
                fragment: { module, entryPoint: 'page_show', targets: [{ format }] },
            }) });
        }
        return this.pipelines.get(key);
    }

    // Into a texture of the format.
    drawInto(target, format, op, values, exposure, origin, step, isLight) {
        const { device } = this;
        const { layouts, pipeline } = this.pipeline(op, format);
        const textures = op.hdr.textures.map((texture) => {
            if (!this.textures.has(texture.file)) this.textures.set(texture.file, this.upload(texels(op.hdr, texture), texture.size, '3d'));
            return this.textures.get(texture.file);
        });
        const numbers = op.hdr.uniforms.map((name) => (name === 'exposure' ? exposure : values[name]));
        const data = new Float32Array(4 + 4 * (Math.ceil(numbers.length / 4) || 1));
        data.set([...origin, step, isLight ? 1 : 0, ...numbers]);
        const buffer = device.createBuffer({ size: data.byteLength, usage: GPUBufferUsage.UNIFORM | GPUBufferUsage.COPY_DST });
        device.queue.writeBuffer(buffer, 0, data);
        const encoder = device.createCommandEncoder();
        const pass = encoder.beginRenderPass({ colorAttachments: [{ view: target.createView(), loadOp: 'clear', storeOp: 'store' }] });
        pass.setPipeline(pipeline);
        pass.setBindGroup(0, device.createBindGroup({ layout: layouts[0],
            entries: textures.map((texture, binding) => ({ binding, resource: texture.createView() })) }));
        pass.setBindGroup(1, device.createBindGroup({ layout: layouts[1],
            entries: [{ binding: 0, resource: this.light.createView() }, { binding: 1, resource: { buffer } }] }));
        pass.draw(3);
        pass.end();
        return encoder;
    }

    draw(op, values, exposure, origin, zoom) {
        const encoder = this.drawInto(this.context.getCurrentTexture(), 'rgba16float', op, values, exposure, origin, 1 / zoom, false);
        this.device.queue.submit([encoder.finish()]);
    }

    // What the canvas gets for one pixel, as code values of extended sRGB or as light.
    async probe(op, values, exposure, x, y, isLight) {
        const { device } = this;
        const target = device.createTexture({ size: [1, 1], format: 'rgba32float', usage: GPUTextureUsage.RENDER_ATTACHMENT | GPUTextureUsage.COPY_SRC });
        const encoder = this.drawInto(target, 'rgba32float', op, values, exposure, [x, y], 1, isLight);
        const buffer = device.createBuffer({ size: 256, usage: GPUBufferUsage.MAP_READ | GPUBufferUsage.COPY_DST });
        encoder.copyTextureToBuffer({ texture: target }, { buffer, bytesPerRow: 256 }, [1, 1]);
        device.queue.submit([encoder.finish()]);
        await buffer.mapAsync(GPUMapMode.READ);
        return [...new Float32Array(buffer.getMappedRange()).subarray(0, 3)];
    }
}
