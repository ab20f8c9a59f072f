// SPDX-License-Identifier: Apache-2.0
//
// What users take away: the shader, a LUT, an operator file, a picture with its recipe.
import { findOperator, page } from './data.js';
import { button, download, h, say, short } from './dom.js';
import { reference } from './reference.js';
import { activeSlot, link, shownSlots, state, valuesOf } from './state.js';

const recipe = (slot) => {
    const op = findOperator(slot.op);
    const set = Object.entries(slot.values).map(([name, value]) => `${name}=${short(value)}`);
    return [op.name, ...set].join(':');
};
const fileName = (slot) => recipe(slot).replaceAll(/[^a-z0-9_.=-]+/gi, '_');
const exposureText = () => `exposure ${state.exposure > 0 ? '+' : ''}${short(state.exposure)}`;

async function copy(text, what) {
    try {
        await navigator.clipboard.writeText(text);
        say(`${what} is on the clipboard.`);
    } catch {
        return false;
    }
    return true;
}

async function copyShader() {
    const op = findOperator(activeSlot().op);
    if (!await copy(op.glsl, `The shader of ${op.title}, GLSL ES 3.00,`)) download(`${fileName(activeSlot())}.glsl`, new Blob([op.glsl]));
}

// ACEScct (Academy S-2016-001) -> linear.
const decodeAcescct = (v) => (v <= 0.155251141552511 ? (v - 0.0729055341958355) / 10.5402377416545 : 2 ** (v * 17.52 - 9.72));

export function cubeOf(slot) {
    const op = findOperator(slot.op);
    const size = 33;
    const values = valuesOf(slot);
    const axis = Array.from({ length: size }, (_, i) => decodeAcescct(i / (size - 1)));
    const lines = [
        `# ${op.title}: ${recipe(slot)}, ${exposureText()}`,
        `# Tonewright ${page.version}, from the 64-bit reference of the report page`,
        '# Input: ACEScct curve on linear Rec.709; output: sRGB code values. Interpolate in tetrahedra.',
        `TITLE "${op.name}"`,
        `LUT_3D_SIZE ${size}`,
    ];
    for (const b of axis) {
        for (const g of axis) {
            for (const r of axis) lines.push(reference(op, [r, g, b], state.exposure, values).map((x) => x.toFixed(7)).join(' '));
        }
    }
    return lines.join('\n') + '\n';
}

// The operator's definition, with the parameters of the page as defaults.
export function toneOf(slot) {
    const op = findOperator(slot.op);
    let text = op.definition;
    for (const [name, value] of Object.entries(slot.values)) {
        const number = Number.isInteger(value) ? `${value}.0` : String(value);
        text = text.replace(new RegExp(`(\\[parameter\\.${name}\\][^[]*?\\ndefault = )[^\\n]*`), (_, before) => before + number);
    }
    return text;
}

const save = (extension, textOf) => download(`${fileName(activeSlot())}.${extension}`, new Blob([textOf(activeSlot())]));

function savePng(view) {
    view.draw();
    const source = view.canvas;
    const size = Math.max(14, Math.round(source.width / 70));
    const lines = [shownSlots().map((slot) => `${findOperator(slot.op).title} (${recipe(slot)})`).join('  |  '),
        `Tonewright ${page.version}, ${exposureText()}, ${view.picture.name}`];
    const canvas = h('canvas', { width: source.width, height: source.height + 3.4 * size });
    const ctx = canvas.getContext('2d');
    ctx.fillStyle = '#202020';
    ctx.fillRect(0, 0, canvas.width, canvas.height);
    ctx.drawImage(source, 0, 0);
    ctx.fillStyle = '#e4e4e4';
    ctx.font = `${size}px system-ui, sans-serif`;
    lines.forEach((text, i) => ctx.fillText(text, size, source.height + size * (1.3 + 1.4 * i), canvas.width - 2 * size));
    canvas.toBlob((blob) => download(`${fileName(activeSlot())}.png`, blob), 'image/png');
}

export function makeSave(view) {
    const buttons = {
        shader: button('Copy shader', copyShader),
        cube: button('Save .cube', () => save('cube', cubeOf)),
        tone: button('Save .tone', () => save('tone', toneOf)),
        png: button('Save PNG', () => savePng(view)),
        link: button('Copy link', () => copy(link(), 'The link')),
    };
    function update() {
        const op = findOperator(activeSlot().op);
        buttons.shader.disabled = buttons.cube.disabled = !op.glsl;
        buttons.tone.disabled = !op.definition;
        buttons.png.disabled = !view.canvas || !op.glsl;
    }
    return { element: h('div', { class: 'tools', role: 'group', 'aria-label': 'Save and copy' }, ...Object.values(buttons)), update };
}
