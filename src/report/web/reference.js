// SPDX-License-Identifier: Apache-2.0
//
// The operators in 64-bit float: JavaScript that Tonewright printed from the expressions of its double reference.
import { file, operators } from './data.js';

// The policy of the page has the hash of this text: no other script can run.
const script = document.createElement('script');
script.textContent = new TextDecoder().decode(file('references.js'));
document.head.append(script);

const compiled = new Map();
const lattices = new Map();  // by file, which operators share

// What a lattice or a table holds: RGB, x fastest. Computed from its formula row by row, or unpacked.
function* making(lattice, { size: [width, height, depth], name }, formula) {
    if (!formula) {
        const bytes = file(name);
        lattice.rgb = new Float32Array(bytes.buffer.slice(bytes.byteOffset, bytes.byteOffset + bytes.byteLength));
        return;
    }
    const rgb = new Float64Array(3 * width * height * depth);
    for (let z = 0, i = 0; z < depth; z++) {
        for (let y = 0; y < height; y++) {
            for (let x = 0; x < width; x++, i += 3) {
                const node = formula([z / (depth - 1), y / (height - 1), x / (width - 1)]);
                rgb[i] = node[0];
                rgb[i + 1] = node[1];
                rgb[i + 2] = node[2];
            }
            yield;
        }
    }
    lattice.rgb = rgb;
}

function latticeOf(op, texture) {
    if (!lattices.has(texture.file)) {
        const lattice = { rgb: null };
        const formula = texture.has_formula ? compile(op)[1][texture.name] : null;
        lattice.steps = making(lattice, { size: texture.size, name: texture.file }, formula);
        lattices.set(texture.file, lattice);
    }
    return lattices.get(texture.file);
}

function numbers(op, texture) {
    const lattice = latticeOf(op, texture);
    while (!lattice.rgb) lattice.steps.next();
    return lattice.rgb;
}

// The same for graphics: RGBA in 32-bit float.
export function texels(op, texture) {
    const rgb = numbers(op, texture);
    const rgba = new Float32Array(rgb.length / 3 * 4).fill(1);
    for (let i = 0, k = 0; i < rgb.length; i += 3, k += 4) {
        rgba[k] = rgb[i];
        rgba[k + 1] = rgb[i + 1];
        rgba[k + 2] = rgb[i + 2];
    }
    return rgba;
}

// Computes a few rows of a lattice that is still to be made. False: there is none.
export function computeSomeRows(isTimeLeft) {
    for (const op of operators) {
        for (const texture of op.textures ?? []) {
            const lattice = latticeOf(op, texture);
            while (!lattice.rgb) {
                lattice.steps.next();
                if (!isTimeLeft()) return true;
            }
        }
    }
    return false;
}

function compile(op) {
    if (!compiled.has(op.name)) {
        const fetches = op.textures.map((texture) => {
            let rgb = null;
            const [width, height] = texture.size;
            return (x, y, z) => {
                rgb ??= numbers(op, texture);
                const i = 3 * (x + width * (y + height * z));
                return [rgb[i], rgb[i + 1], rgb[i + 2]];
            };
        });
        compiled.set(op.name, globalThis.tonewrightReferences[op.name](...fetches));
    }
    return compiled.get(op.name);
}

// Of a scene-linear color: its sRGB code values from 0 to 1.
export function reference(op, color, exposure, values) {
    const scene = color.map((x) => (Number.isNaN(x) ? 0 : x));
    return compile(op)[0](scene, ...op.uniforms.map((name) => (name === 'exposure' ? exposure : values[name])));
}
