// SPDX-License-Identifier: Apache-2.0
//
// Draws a pixel for each color with WebGL 2.

/** Runs in the page: one pixel for each color. */
export function draw({ fragment, pixels, uniforms }) {
    const gl = new OffscreenCanvas(1, 1).getContext('webgl2');
    if (!gl?.getExtension('EXT_color_buffer_float')) throw new Error('found no WebGL 2 with EXT_color_buffer_float');
    const program = gl.createProgram();
    const vertex = '#version 300 es\nvoid main() { gl_Position = vec4(4 * (gl_VertexID & 1) - 1, 2 * (gl_VertexID & 2) - 1, 0, 1); }';
    for (const [type, source] of [[gl.VERTEX_SHADER, vertex], [gl.FRAGMENT_SHADER, fragment]]) {
        const shader = gl.createShader(type);
        gl.shaderSource(shader, source);
        gl.compileShader(shader);
        if (!gl.getShaderParameter(shader, gl.COMPILE_STATUS)) throw new Error(gl.getShaderInfoLog(shader));
        gl.attachShader(program, shader);
    }
    gl.linkProgram(program);
    if (!gl.getProgramParameter(program, gl.LINK_STATUS)) throw new Error(gl.getProgramInfoLog(program));
    gl.useProgram(program);
    for (const [name, value] of uniforms) gl.uniform1f(gl.getUniformLocation(program, name), value);
    const count = pixels.length / 4;
    const texture = (data) => {
        gl.bindTexture(gl.TEXTURE_2D, gl.createTexture());
        gl.texStorage2D(gl.TEXTURE_2D, 1, gl.RGBA32F, count, 1);
        if (data) gl.texSubImage2D(gl.TEXTURE_2D, 0, 0, 0, count, 1, gl.RGBA, gl.FLOAT, data);
        gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_MIN_FILTER, gl.NEAREST);
        gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_MAG_FILTER, gl.NEAREST);
        return gl.getParameter(gl.TEXTURE_BINDING_2D);
    };
    const target = texture(null);
    texture(Float32Array.from(pixels, Number));  // stays at unit 0, which samplers read without a setting
    gl.bindFramebuffer(gl.FRAMEBUFFER, gl.createFramebuffer());
    gl.framebufferTexture2D(gl.FRAMEBUFFER, gl.COLOR_ATTACHMENT0, gl.TEXTURE_2D, target, 0);
    gl.viewport(0, 0, count, 1);
    gl.drawArrays(gl.TRIANGLES, 0, 3);
    const results = new Float32Array(4 * count);
    gl.readPixels(0, 0, count, 1, gl.RGBA, gl.FLOAT, results);
    if (gl.getError()) throw new Error('WebGL reports an error');
    return results;
}
