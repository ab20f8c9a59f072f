// SPDX-License-Identifier: Apache-2.0
//
// Draws pictures through the exported GLSL ES, with WebGL 2.
import { texels } from './reference.js';

const VERTEX = `#version 300 es
void main() { gl_Position = vec4(vec2(gl_VertexID & 1, gl_VertexID >> 1) * 4.0 - 1.0, 0.0, 1.0); }`;

// Means of 2 x 2 pixels: smaller pictures for views that do not show every pixel.
const HALVE = `#version 300 es
precision highp float;
uniform highp sampler2D light;
out vec4 mean;
void main() {
    ivec2 last = textureSize(light, 0) - 1;
    ivec2 at = 2 * ivec2(gl_FragCoord.xy);
    mean = vec4(0.0);
    for (int i = 0; i < 4; i++) {
        vec3 c = texelFetch(light, min(at + ivec2(i & 1, i >> 1), last), 0).rgb;
        mean.rgb += 0.25 * clamp(mix(c, vec3(0.0), isnan(c)), -65504.0, 65504.0);
    }
}`;

const drawn = (op) => op.drawn ?? op;
const PLACE = `
uniform vec3 page_view;    // picture's pixel at the target's top left corner, and pixels of it for a pixel of the target
uniform vec2 page_corner;  // of the target in the canvas
ivec2 page_place() {
    vec2 at = vec2(gl_FragCoord.x - page_corner.x, page_corner.y - gl_FragCoord.y);
    return ivec2(floor(page_view.xy + page_view.z * at));
}`;
const fragment = (op) => `#version 300 es
${drawn(op).glsl}
uniform highp sampler2D page_light;
${PLACE}
${op.uniforms.map((name) => `uniform float page_${name};`).join('\n')}
out vec4 page_shown;
void main() {
    vec3 scene = texelFetch(page_light, clamp(page_place(), ivec2(0), textureSize(page_light, 0) - 1), 0).rgb;
    scene = mix(scene, vec3(0.0), isnan(scene));
    page_shown = vec4(${op.function}(${['scene', ...op.uniforms.map((name) => `page_${name}`)].join(', ')}), 1.0);
}`;

// From what an operator gave, which has its bottom row first, onto the canvas. Software rendering takes half the time of
// texelFetch and a test of the place.
const PRESENT_HEAD = `#version 300 es
precision highp float;
uniform highp sampler2D page_result;
uniform vec2 page_scale;  // from pixels of the canvas to the result, from 0 to 1
uniform vec2 page_offset;
out vec4 page_shown;`;
const PRESENT = `${PRESENT_HEAD}
void main() {
    page_shown = texture(page_result, page_scale * gl_FragCoord.xy + page_offset);
}`;
const PRESENT_MARKED = `${PRESENT_HEAD}
void main() {
    vec3 shown = texture(page_result, page_scale * gl_FragCoord.xy + page_offset).rgb;
    bool is_stripe = mod(gl_FragCoord.x + gl_FragCoord.y, 8.0) < 4.0;
    if (max(max(shown.r, shown.g), shown.b) >= 254.5 / 255.0) shown = is_stripe ? vec3(1.0, 0.55, 0.0) : vec3(0.0);
    else if (max(max(shown.r, shown.g), shown.b) <= 0.5 / 255.0) shown = is_stripe ? vec3(0.35, 0.7, 0.9) : vec3(0.0);
    page_shown = vec4(shown, 1.0);
}`;

const MOST_RESULT_BYTES = 1 << 27;

export class Renderer {
    constructor(canvas) {
        this.canvas = canvas;
        this.gl = canvas.getContext('webgl2', { alpha: false, antialias: false, depth: false, preserveDrawingBuffer: true });
        if (!this.gl) throw new Error('this browser has no WebGL 2, which shows the pictures; curves and tables work');
        if (!this.gl.getExtension('EXT_color_buffer_float')) throw new Error('this machine cannot draw into floats');
        this.parallel = this.gl.getExtension('KHR_parallel_shader_compile');
        this.programs = new Map();
        this.results = new Map();  // the one that was used last is the last one
        this.resultBytes = 0;
        this.levels = [];
        this.textures = new Map();
        this.halve = this.finished(this.compiling(HALVE));
        this.present = this.finished(this.compiling(PRESENT));
        this.presentMarked = this.finished(this.compiling(PRESENT_MARKED));
        this.point = this.makeTexture(this.gl.TEXTURE_2D);
        this.gl.texImage2D(this.gl.TEXTURE_2D, 0, this.gl.RGBA32F, 1, 1, 0, this.gl.RGBA, this.gl.FLOAT, null);
    }

    // A program that may still be compiled elsewhere.
    compiling(text) {
        const gl = this.gl;
        const program = gl.createProgram();
        for (const [kind, source] of [[gl.VERTEX_SHADER, VERTEX], [gl.FRAGMENT_SHADER, text]]) {
            const shader = gl.createShader(kind);
            gl.shaderSource(shader, source);
            gl.compileShader(shader);
            gl.attachShader(program, shader);
        }
        gl.linkProgram(program);
        return { program, places: null };
    }

    // With the places of its uniforms; waits until it is compiled.
    finished(entry) {
        const gl = this.gl;
        if (entry.places) return entry;
        const { program } = entry;
        if (!gl.getProgramParameter(program, gl.LINK_STATUS))
            throw new Error(`the shader does not compile: ${gl.getProgramInfoLog(program)}`);
        entry.places = {};
        const count = gl.getProgramParameter(program, gl.ACTIVE_UNIFORMS);
        for (let i = 0; i < count; i++) {
            const { name } = gl.getActiveUniform(program, i);
            entry.places[name] = gl.getUniformLocation(program, name);
        }
        return entry;
    }

    programOf(op) {
        if (!this.programs.has(op.name)) this.programs.set(op.name, this.compiling(fragment(op)));
        return this.programs.get(op.name);
    }

    makeTexture(target) {
        const gl = this.gl;
        const texture = gl.createTexture();
        gl.bindTexture(target, texture);
        gl.texParameteri(target, gl.TEXTURE_MIN_FILTER, gl.NEAREST);
        gl.texParameteri(target, gl.TEXTURE_MAG_FILTER, gl.NEAREST);
        return texture;
    }

    setPicture({ width, height, rgba }) {
        const gl = this.gl;
        const most = gl.getParameter(gl.MAX_TEXTURE_SIZE);
        if (Math.max(width, height) > most)
            throw new Error(`${width} x ${height} pixels are too many for this machine's graphics; expected at most ${most} a side`);
        for (const level of this.levels) gl.deleteTexture(level.texture);
        this.forgetResults(0);
        const texture = this.makeTexture(gl.TEXTURE_2D);
        gl.texImage2D(gl.TEXTURE_2D, 0, gl.RGBA32F, width, height, 0, gl.RGBA, gl.FLOAT, rgba);
        this.levels = [{ texture, width, height }];
    }

    // The picture at 1 / 2^level of its size.
    level(level) {
        const gl = this.gl;
        while (this.levels.length <= level) {
            const from = this.levels.at(-1);
            const width = Math.max(1, Math.ceil(from.width / 2));
            const height = Math.max(1, Math.ceil(from.height / 2));
            const texture = this.makeTexture(gl.TEXTURE_2D);
            gl.texImage2D(gl.TEXTURE_2D, 0, gl.RGBA32F, width, height, 0, gl.RGBA, gl.FLOAT, null);
            this.into(texture, width, height, () => {
                gl.useProgram(this.halve.program);
                gl.activeTexture(gl.TEXTURE0);
                gl.bindTexture(gl.TEXTURE_2D, from.texture);
                gl.drawArrays(gl.TRIANGLES, 0, 3);
            });
            this.levels.push({ texture, width, height });
        }
        return this.levels[level];
    }

    into(texture, width, height, draw) {
        const gl = this.gl;
        const frame = gl.createFramebuffer();
        gl.bindFramebuffer(gl.FRAMEBUFFER, frame);
        gl.framebufferTexture2D(gl.FRAMEBUFFER, gl.COLOR_ATTACHMENT0, gl.TEXTURE_2D, texture, 0);
        gl.viewport(0, 0, width, height);
        gl.disable(gl.SCISSOR_TEST);
        const result = draw();
        gl.bindFramebuffer(gl.FRAMEBUFFER, null);
        gl.deleteFramebuffer(frame);
        return result;
    }

    forgetResults(most) {
        for (const [key, { texture, bytes }] of this.results) {
            if (this.resultBytes <= most) break;
            this.gl.deleteTexture(texture);
            this.results.delete(key);
            this.resultBytes -= bytes;
        }
    }

    use(op, values, exposure, view, corner, level) {
        const gl = this.gl;
        const { program, places } = this.finished(this.programOf(op));
        gl.useProgram(program);
        gl.activeTexture(gl.TEXTURE0);
        gl.bindTexture(gl.TEXTURE_2D, this.level(level).texture);
        gl.uniform1i(places.page_light, 0);
        gl.uniform3fv(places.page_view, view);
        gl.uniform2fv(places.page_corner, corner);
        for (const name of op.uniforms) gl.uniform1f(places[`page_${name}`], name === 'exposure' ? exposure : values[name]);
        drawn(op).textures.forEach((texture, i) => {
            gl.activeTexture(gl.TEXTURE1 + i);
            if (!this.textures.has(texture.file)) {
                this.textures.set(texture.file, this.makeTexture(gl.TEXTURE_3D));
                gl.texImage3D(gl.TEXTURE_3D, 0, gl.RGBA32F, ...texture.size, 0, gl.RGBA, gl.FLOAT, texels(op, texture));
            }
            gl.bindTexture(gl.TEXTURE_3D, this.textures.get(texture.file));
            gl.uniform1i(places[texture.name], 1 + i);
        });
    }

    clear(gray = 0.1255) {
        const gl = this.gl;
        gl.disable(gl.SCISSOR_TEST);
        gl.clearColor(gray, gray, gray, 1);
        gl.clear(gl.COLOR_BUFFER_BIT);
    }

    // The part of the picture that a panel shows, computed once for each pixel of the picture or of the panel, whichever
    // are fewer; and where the panel shows it.
    planned(op, { values, exposure, rect, origin, zoom }) {
        const level = zoom < 1 ? Math.max(0, Math.floor(Math.log2(1 / zoom) + 1e-6)) : 0;
        const scale = 2 ** level;
        const { width, height } = this.level(level);
        const size = [width, height];
        const step = 1 / zoom / scale;
        const at = [origin[0] / scale, origin[1] / scale];
        // Pixels of the panel whose middle is inside of the picture.
        const pixelOf = (place, i) => Math.min(Math.max(Math.ceil((place - at[i]) / step - 0.5), 0), rect[2 + i]);
        const first = [0, 1].map((i) => pixelOf(0, i));
        const count = [0, 1].map((i) => pixelOf(size[i], i) - first[i]);
        const plan = { level, first, count, isEmpty: !(count[0] > 0 && count[1] > 0) };
        if (step <= 1) {
            const from = [0, 1].map((i) => Math.floor(at[i] + step * (first[i] + 0.5)));
            plan.size = [0, 1].map((i) => Math.floor(at[i] + step * (first[i] + count[i] - 0.5)) + 1 - from[i]);
            plan.view = [...from, 1];
            plan.shown = [...[0, 1].map((i) => at[i] + step * first[i] - from[i]), step];
        } else {
            plan.size = count;
            plan.view = [...[0, 1].map((i) => at[i] + step * first[i]), step];
            plan.shown = [0, 0, 1];
        }
        plan.key = JSON.stringify([op.name, op.uniforms.map((name) => (name === 'exposure' ? exposure : values[name])),
            level, plan.view, plan.size]);
        return plan;
    }

    result(op, { values, exposure }, { key, level, view, size: [width, height] }) {
        const gl = this.gl;
        let result = this.results.get(key);
        if (result) {
            this.results.delete(key);
        } else {
            const bytes = 4 * width * height;
            this.forgetResults(MOST_RESULT_BYTES - bytes);
            result = { texture: this.makeTexture(gl.TEXTURE_2D), bytes };
            gl.texImage2D(gl.TEXTURE_2D, 0, gl.RGBA8, width, height, 0, gl.RGBA, gl.UNSIGNED_BYTE, null);
            this.level(level);  // makes it with a program and a target of its own
            this.into(result.texture, width, height, () => {
                this.use(op, values, exposure, view, [0, height], level);
                gl.drawArrays(gl.TRIANGLES, 0, 3);
            });
            this.resultBytes += bytes;
        }
        this.results.set(key, result);
        return result.texture;
    }

    // rect: left, top, width, height in pixels of the canvas; origin: the picture's place at its corner.
    draw(op, panel) {
        const { rect, clip = rect, marks = false } = panel;
        const gl = this.gl;
        const plan = this.planned(op, panel);
        if (plan.isEmpty) return;
        const texture = this.result(op, panel, plan);
        const { first, count, shown: [x, y, step], size: [width, height] } = plan;
        gl.viewport(0, 0, this.canvas.width, this.canvas.height);
        const { program, places } = marks ? this.presentMarked : this.present;
        gl.useProgram(program);
        gl.activeTexture(gl.TEXTURE0);
        gl.bindTexture(gl.TEXTURE_2D, texture);
        gl.uniform1i(places.page_result, 0);
        // At whole zooms, the middle of a pixel may lie on the edge of two of the result: it is the second, as for floor().
        const [px, py] = [x + 1 / 256, y + 1 / 256];
        const left = rect[0] + first[0];
        const top = this.canvas.height - rect[1] - first[1];  // counted from below, as the canvas does
        gl.uniform2f(places.page_scale, step / width, step / height);
        gl.uniform2f(places.page_offset, (px - step * left) / width, 1 - (py + step * top) / height);
        const [low, high] = [Math.max(left, clip[0]), Math.min(left + count[0], clip[0] + clip[2])];
        const bottom = Math.max(top - count[1], this.canvas.height - clip[1] - clip[3]);
        const end = Math.min(top, this.canvas.height - clip[1]);
        gl.enable(gl.SCISSOR_TEST);
        if (high > low && end > bottom) {
            gl.scissor(low, bottom, high - low, end - bottom);
            gl.drawArrays(gl.TRIANGLES, 0, 3);
        }
    }

    // Does a piece of the work that drawing this would take, and never waits. False: nothing is left to do.
    drawAhead(op, panel) {
        const gl = this.gl;
        if (this.ahead && gl.clientWaitSync(this.ahead, 0, 0) === gl.TIMEOUT_EXPIRED) return true;
        gl.deleteSync(this.ahead ?? null);
        this.ahead = null;
        const entry = this.programOf(op);
        if (!entry.places) {
            if (this.parallel && !gl.getProgramParameter(entry.program, this.parallel.COMPLETION_STATUS_KHR)) return true;
            this.finished(entry);
            return true;
        }
        const plan = this.planned(op, panel);
        if (plan.isEmpty || this.results.has(plan.key)) return false;
        this.result(op, panel, plan);
        this.ahead = gl.fenceSync(gl.SYNC_GPU_COMMANDS_COMPLETE, 0);
        gl.flush();
        return true;
    }

    // What the shader gives for one pixel, in 32-bit floats.
    probe(op, values, exposure, x, y) {
        const gl = this.gl;
        return this.into(this.point, 1, 1, () => {
            this.use(op, values, exposure, [x, y, 0], [0, 1], 0);
            gl.drawArrays(gl.TRIANGLES, 0, 3);
            const rgba = new Float32Array(4);
            gl.readPixels(0, 0, 1, 1, gl.RGBA, gl.FLOAT, rgba);
            return [...rgba.subarray(0, 3)];
        });
    }
}
