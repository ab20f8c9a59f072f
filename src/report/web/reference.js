// SPDX-License-Identifier: Apache-2.0
//
// The operators in 64-bit float: JavaScript that Tonewright printed from the expressions of its double reference.
import { texels } from './data.js';

const compiled = new Map();

function compile(op) {
    const fetches = op.textures.map((texture) => {
        const data = texels(texture);
        const [width, height] = texture.size;
        return (x, y, z) => {
            const i = 4 * (x + width * (y + height * z));
            return [data[i], data[i + 1], data[i + 2]];
        };
    });
    const make = new Function(...op.textures.map((texture) => texture.name), `${op.reference}\nreturn ${op.function};`);
    return make(...fetches);
}

// Of a scene-linear color: its sRGB code values from 0 to 1.
export function reference(op, color, exposure, values) {
    if (!compiled.has(op.name)) compiled.set(op.name, compile(op));
    const scene = color.map((x) => (Number.isNaN(x) ? 0 : x));
    return compiled.get(op.name)(scene, ...op.uniforms.map((name) => (name === 'exposure' ? exposure : values[name])));
}
