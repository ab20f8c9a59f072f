// SPDX-License-Identifier: Apache-2.0
//
// Runs `vec3 FUNCTION(vec3)` of a GLSL file on the colors of the table, with WebGL 2 (GLSL ES 3.00) in a browser.
// Uniforms of the engine are numbers: --uniform NAME=NUMBER.
//
//   node run_glsl.mjs tonemapping.glsl AgXToneMapping --uniform toneMappingExposure=1
import { colorsOf, inBrowser, pixelsOf } from './browser.mjs';
import { commandLine, finish, misuse, readText } from './compare.mjs';
import { draw } from './webgl.mjs';

const { words: [file, name], rows, codes, uniforms } =
    commandLine('run_glsl.mjs FILE FUNCTION [--uniform NAME=NUMBER]', 2);
const fragment = `#version 300 es
precision highp float;
precision highp int;
precision highp sampler2D;
uniform sampler2D kit_colors;
out vec4 kit_result;
#line 1
${readText(file).replace(/^\s*#version.*$/m, '')}
void main() { kit_result = vec4(${name}(texelFetch(kit_colors, ivec2(gl_FragCoord.xy), 0).rgb), 1.0); }
`;
const numbers = uniforms.map((text) => text.split('=')).map(([uniform, value]) => [uniform, Number(value)]);
if (numbers.some(([, value]) => !Number.isFinite(value))) misuse(`--uniform is ${uniforms}; expected NAME=NUMBER`);
finish(rows, colorsOf(await inBrowser(draw, { fragment, pixels: pixelsOf(rows), uniforms: numbers })), codes);
